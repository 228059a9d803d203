// What the camera sees: emission plus reflected direct and indirect light. Twin: cpu/shade.rs.

@group(0) @binding(0) var<uniform> frame: FrameRecord;
@group(0) @binding(1) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(2) var shadow_maps: texture_depth_2d_array;
@group(0) @binding(3) var grid_x: texture_3d<f32>;
@group(0) @binding(4) var grid_y: texture_3d<f32>;
@group(0) @binding(5) var grid_z: texture_3d<f32>;
@group(0) @binding(6) var grid_flags: texture_3d<u32>;
@group(0) @binding(7) var grid_sampler: sampler;
@group(1) @binding(0) var<uniform> material: MaterialRecord;
@group(1) @binding(1) var albedo_texture: texture_2d<f32>;

struct Corner {
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) face_normal: vec3f,
}

struct Surface {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) @interpolate(flat) face_normal: vec3f,
}

@vertex
fn vertex_shade(corner: Corner) -> Surface {
    let clip = frame.view_projection * vec4f(corner.position, 1.0);
    return Surface(clip, corner.position, corner.normal, corner.uv, corner.face_normal);
}

@fragment
fn fragment_shade(surface: Surface) -> @location(0) vec4f {
    let front = dot(surface.face_normal, frame.eye - surface.position) >= 0.0;
    let face_normal = select(-surface.face_normal, surface.face_normal, front);
    let normal = shading_normal(surface.normal, surface.face_normal, front);
    return vec4f(radiance(surface, front, normal, face_normal), 1.0);
}

// The normal to shade with: `smooth_normal` made unit length on the seen side, or the triangle's own where there is
// none.
fn shading_normal(smooth_normal: vec3f, out: vec3f, front: bool) -> vec3f {
    var normal = out;
    if dot(smooth_normal, smooth_normal) > 1e-12 {
        normal = normalize(smooth_normal);
    }
    return select(-normal, normal, front);
}

// Radiance that a surface sends to the eye [W/(m² sr)].
fn radiance(surface: Surface, front: bool, normal: vec3f, face_normal: vec3f) -> vec3f {
    var albedo = material.albedo;
    if material.textured != 0u {
        albedo *= texture_colour(surface.uv);
    }
    var irradiance = direct_irradiance(surface.position, normal, face_normal);
    if frame.indirect != 0u {
        irradiance += indirect_irradiance(surface.position, normal, face_normal);
    }
    let emission = select(vec3f(0.0), material.emission, front || material.two_sided != 0u);
    return emission + albedo * irradiance / PI;
}

// Bilinear lookup with repeat wrapping, as ivg-scene's `Texture::sample` defines it.
fn texture_colour(uv: vec2f) -> vec3f {
    let size = vec2i(textureDimensions(albedo_texture));
    let at = (uv - floor(uv)) * vec2f(size) - 0.5;
    let low = floor(at);
    let share = at - low;
    let first = (vec2i(low) + size) % size;
    let second = (first + 1) % size;
    let upper = mix(
        textureLoad(albedo_texture, first, 0).rgb,
        textureLoad(albedo_texture, vec2i(second.x, first.y), 0).rgb,
        share.x,
    );
    let lower = mix(
        textureLoad(albedo_texture, vec2i(first.x, second.y), 0).rgb,
        textureLoad(albedo_texture, second, 0).rgb,
        share.x,
    );
    return mix(upper, lower, share.y);
}
