// One face of a shadow map in two passes: the depth of the first surface, then the limit depth. Twin: cpu/shadow.rs.

@group(0) @binding(0) var<uniform> face: FaceRecord;
@group(1) @binding(0) var first_depth: texture_depth_2d;

struct Covered {
    @builtin(position) @invariant position: vec4f,
}

struct Limit {
    @builtin(frag_depth) depth: f32,
}

@vertex
fn vertex_shadow(@location(0) position: vec3f) -> Covered {
    return Covered(face.matrix * vec4f(position, 1.0));
}

// One triangle that covers the picture, at depth 0.
@vertex
fn vertex_everywhere(@builtin(vertex_index) index: u32) -> Covered {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u));
    return Covered(vec4f(4.0 * corner - 1.0, 0.0, 1.0));
}

// The limit where no second surface is drawn over it.
@fragment
fn fragment_first(covered: Covered) -> Limit {
    let first = textureLoad(first_depth, vec2u(covered.position.xy), 0);
    return Limit(shadow_limit(first, 0.0));
}

// The limit rises with the depth of the second surface, so the depth test keeps the one of the nearest.
@fragment
fn fragment_second(covered: Covered) -> Limit {
    let first = textureLoad(first_depth, vec2u(covered.position.xy), 0);
    let second = covered.position.z;
    if second >= first * (1.0 - SAME_SURFACE) {
        discard;
    }
    return Limit(shadow_limit(first, second));
}

fn shadow_limit(first: f32, second: f32) -> f32 {
    if face.perspective != 0u {
        var middle = 0.0;
        if first > 0.0 {
            middle = 2.0 * first * second / (first + second);
        }
        return min(max(middle, first / (1.0 + face.cap)), first / (1.0 + face.bias));
    }
    var capped = first - face.cap;
    if second > 0.0 {
        capped = max(0.5 * (first + second), capped);
    }
    return max(min(capped, first - face.bias), 0.0);
}
