// Indirect light from the grid: the rule of ivg-grid's module `spatial`, on half-precision textures.
// Twin: cpu/irradiance.rs. Needs `frame`, `grid_x`, `grid_y`, `grid_z`, `grid_flags` and `grid_sampler` of shade.wgsl.
//
// A vertex holds, for each channel, parts of three numbers: six irradiance vectors, two in each of the textures, or three
// groups of radiance coefficients, one in each. The irradiance of a surface is the sum of the parts times weights.
//
// Where a cell, or for tricubic lookups the block of 4 x 4 x 4 vertices, is clear of obstacles, the hardware filters.
// Elsewhere every vertex is read and weighted by itself.

const FLAG_USABLE: u32 = 8u;
const FLAG_CLEAR_CELL: u32 = 16u;
const FLAG_CLEAR_BLOCK: u32 = 32u;
const RECONSTRUCT_N_SQUARED: u32 = 0u;
const RECONSTRUCT_THREE_VECTOR: u32 = 1u;
const RECONSTRUCT_SIX_VECTOR: u32 = 2u;
const RECONSTRUCT_HARMONICS: u32 = 3u;
const HARMONIC_CONSTANT: f32 = 0.8862269;
const HARMONIC_LINEAR: f32 = 1.0233267;
const HARMONIC_MIXED: f32 = 0.8580855;
const HARMONIC_ZONAL: f32 = 0.24770795;
const HARMONIC_SQUARE: f32 = 0.42904276;
const TANGENTIAL_LOSS: f32 = 0.5;

// Vertices that a careful lookup reads: sets of them are the bits of two words.
struct Support {
    // Vertices along a side: 2 or 4.
    width: u32,
    // Vertex with local coordinates 0, 0, 0; may lie outside the lattice.
    first: vec3i,
    // Weights along each axis, one column for each local coordinate.
    weights: mat4x3f,
    // Trilinear weights of the two middle vertices of each axis.
    linear: mat2x3f,
}

// What a careful lookup works on.
var<private> support: Support;
// For each axis the vertices of the support from which light passes to the next one.
var<private> open: array<vec2u, 3>;

// Irradiance at a point of a surface [W/m²].
fn indirect_irradiance(position: vec3f, normal: vec3f, face_normal: vec3f) -> vec3f {
    let moved = position + face_normal * frame.normal_bias;
    let from_origin = moved - frame.lattice_origin;
    let last = vec3f(frame.lattice_dims - vec3u(1u));
    let at = clamp(from_origin * frame.lattice_inverse_step, vec3f(0.0), last);
    let base = min(floor(at), max(last - 1.0, vec3f(0.0)));
    let fraction = at - base;
    let flags = textureLoad(grid_flags, vec3u(base), 0).r;
    var sum = vec3f(0.0);
    if frame.filter_kind == 0u {
        if (flags & FLAG_CLEAR_CELL) != 0u {
            sum = filtered_irradiance(at, normal);
        } else {
            support.width = 2u;
            support.first = vec3i(base);
            support.linear = mat2x3f(1.0 - fraction, fraction);
            support.weights = mat4x3f(1.0 - fraction, fraction, vec3f(0.0), vec3f(0.0));
            sum = careful_irradiance(from_origin, normal);
        }
    } else {
        let weights = cubic_weights(fraction);
        if (flags & FLAG_CLEAR_BLOCK) != 0u {
            sum = cubic_irradiance(base, last, weights, normal);
        } else {
            support.width = 4u;
            support.first = vec3i(base) - 1;
            support.linear = mat2x3f(1.0 - fraction, fraction);
            support.weights = weights;
            sum = careful_irradiance(from_origin, normal);
        }
    }
    return max(sum * frame.value_scale, vec3f(0.0));
}

// The uniform cubic B-spline's weights of the vertices -1, 0, 1, 2 along each axis.
fn cubic_weights(f: vec3f) -> mat4x3f {
    let g = 1.0 - f;
    return mat4x3f(
        g * g * g / 6.0,
        (4.0 - 6.0 * f * f + 3.0 * f * f * f) / 6.0,
        (4.0 - 6.0 * g * g + 3.0 * g * g * g) / 6.0,
        f * f * f / 6.0,
    );
}

// Tricubic lookup by eight trilinear ones (Sigg and Hadwiger 2005).
fn cubic_irradiance(base: vec3f, last: vec3f, weights: mat4x3f, normal: vec3f) -> vec3f {
    let low_weight = weights[0] + weights[1];
    let high_weight = weights[2] + weights[3];
    let low = base - 1.0 + weights[1] / low_weight;
    let high = base + 1.0 + weights[3] / high_weight;
    var sum = vec3f(0.0);
    for (var corner = 0u; corner < 8u; corner++) {
        let is_high = (vec3u(corner) >> vec3u(0u, 1u, 2u) & vec3u(1u)) == vec3u(1u);
        let share = select(low_weight, high_weight, is_high);
        let at = clamp(select(low, high, is_high), vec3f(0.0), last);
        sum += share.x * share.y * share.z * filtered_irradiance(at, normal);
    }
    return sum;
}

// Parts of a vertex that lie in one texture.
fn parts_in_texture() -> u32 {
    return select(2u, 1u, frame.reconstruction == RECONSTRUCT_HARMONICS);
}

// What a part counts in the irradiance of a surface: all reconstructions are linear.
fn part_weight(part: u32, n: vec3f) -> vec3f {
    if frame.reconstruction == RECONSTRUCT_HARMONICS {
        return group_weight(part, n);
    }
    return hemisphere_weight(part, n);
}

// Irradiance, not cut at zero, from values that the hardware interpolates at lattice coordinates `at`.
fn filtered_irradiance(at: vec3f, normal: vec3f) -> vec3f {
    let dims = vec3f(frame.lattice_dims);
    let each = parts_in_texture();
    let size = dims * vec3f(1.0, 1.0, f32(3u * each));
    var sum = vec3f(0.0);
    for (var part = 0u; part < 3u * each; part++) {
        let weight = part_weight(part, normal);
        if all(weight == vec3f(0.0)) {
            continue;
        }
        for (var channel = 0u; channel < 3u; channel++) {
            let slab = f32((part % each) * 3u + channel);
            let texel = vec3f(at.xy, at.z + slab * dims.z) + 0.5;
            let coordinates = texel / size;
            var numbers = vec3f(0.0);
            switch part / each {
                case 0u: { numbers = textureSampleLevel(grid_x, grid_sampler, coordinates, 0.0).xyz; }
                case 1u: { numbers = textureSampleLevel(grid_y, grid_sampler, coordinates, 0.0).xyz; }
                default: { numbers = textureSampleLevel(grid_z, grid_sampler, coordinates, 0.0).xyz; }
            }
            sum[channel] += dot(weight, numbers);
        }
    }
    return sum;
}

// Irradiance, not cut at zero, from the values of one vertex.
fn vertex_irradiance(vertex: vec3i, normal: vec3f) -> vec3f {
    let each = parts_in_texture();
    var sum = vec3f(0.0);
    for (var part = 0u; part < 3u * each; part++) {
        let weight = part_weight(part, normal);
        if all(weight == vec3f(0.0)) {
            continue;
        }
        for (var channel = 0u; channel < 3u; channel++) {
            let slab = i32((part % each) * 3u + channel);
            let texel = vertex + vec3i(0, 0, slab * i32(frame.lattice_dims.z));
            var stored = vec4f(0.0);
            switch part / each {
                case 0u: { stored = textureLoad(grid_x, texel, 0); }
                case 1u: { stored = textureLoad(grid_y, texel, 0); }
                default: { stored = textureLoad(grid_z, texel, 0); }
            }
            if stored.w > 0.0 {
                sum[channel] += dot(weight, stored.xyz / stored.w);
            }
        }
    }
    return sum;
}

// What three radiance coefficients of a group count, in the order (0,0) (1,-1) (1,0), (1,1) (2,-2) (2,-1), (2,0) (2,1)
// (2,2): the basis convolved with the cosine.
fn group_weight(group: u32, n: vec3f) -> vec3f {
    switch group {
        case 0u: {
            return vec3f(HARMONIC_CONSTANT, HARMONIC_LINEAR * n.y, HARMONIC_LINEAR * n.z);
        }
        case 1u: {
            return vec3f(HARMONIC_LINEAR * n.x, HARMONIC_MIXED * n.x * n.y, HARMONIC_MIXED * n.y * n.z);
        }
        default: {
            return vec3f(
                HARMONIC_ZONAL * (3.0 * n.z * n.z - 1.0),
                HARMONIC_MIXED * n.x * n.z,
                HARMONIC_SQUARE * (n.x * n.x - n.y * n.y),
            );
        }
    }
}

// What a hemisphere's irradiance vector counts in the irradiance of a surface.
fn hemisphere_weight(hemisphere: u32, n: vec3f) -> vec3f {
    let axis = hemisphere >> 1u;
    let negative = (hemisphere & 1u) == 1u;
    var own = vec3f(0.0);
    own[axis] = 1.0;
    let component = n[axis];
    if frame.reconstruction == RECONSTRUCT_SIX_VECTOR {
        let difference = component * component * own + 0.5 * component * (n - component * own);
        return 0.5 * (component * own + select(difference, -difference, negative));
    }
    if negative != (component < 0.0) {
        return vec3f(0.0);
    }
    let squared = component * component;
    if frame.reconstruction == RECONSTRUCT_N_SQUARED {
        return squared * n;
    }
    let tangential = n * (1.0 - TANGENTIAL_LOSS * abs(n));
    return squared * (select(own, -own, negative) + tangential - tangential[axis] * own);
}

// Lookup where geometry obstructs: only vertices on the lookup's side count.
fn careful_irradiance(from_origin: vec3f, normal: vec3f) -> vec3f {
    let count = support.width * support.width * support.width;
    let middle = support.width / 2u - 1u;
    var usable = vec2u(0u);
    var corners = vec2u(0u);
    open = array<vec2u, 3>(vec2u(0u), vec2u(0u), vec2u(0u));
    for (var local = 0u; local < count; local++) {
        let at = split(local);
        let vertex = vertex_of(at);
        let next = vertex_of(at + vec3u(1u));
        let flags = textureLoad(grid_flags, vertex, 0).r;
        let bit = single(local);
        if (flags & FLAG_USABLE) != 0u {
            usable |= bit;
            if all(at - vec3u(middle) < vec3u(2u)) {
                corners |= bit;
            }
        }
        for (var axis = 0u; axis < 3u; axis++) {
            // Beyond the border the same vertex is repeated.
            let passes = vertex[axis] == next[axis] || ((flags >> axis) & 1u) == 0u;
            if at[axis] + 1u < support.width && passes {
                open[axis] |= bit;
            }
        }
    }
    var left = corners;
    var best = vec2u(0u);
    var best_score = vec2f(-1.0);
    while any(left != vec2u(0u)) {
        let group = reach(corners, lowest(left));
        left &= ~group;
        var score = vec2f(0.0);
        for (var local = 0u; local < count; local++) {
            if any((group & single(local)) != vec2u(0u)) {
                let at = split(local);
                let share = vec3f(
                    support.linear[at.x - middle].x,
                    support.linear[at.y - middle].y,
                    support.linear[at.z - middle].z,
                );
                let weight = share.x * share.y * share.z;
                score += weight * vec2f(facing(vertex_of(at), from_origin, normal), 1.0);
            }
        }
        if score.x > best_score.x || (score.x == best_score.x && score.y > best_score.y) {
            best = group;
            best_score = score;
        }
    }
    let reached = weighted_irradiance(reach(usable, best), normal);
    if reached.w > 0.0 {
        return reached.xyz / reached.w;
    }
    let all = weighted_irradiance(vec2u(0xffffffffu), normal);
    return all.xyz / all.w;
}

// Sum of the irradiances of a set of vertices times their weights, and the sum of the weights.
fn weighted_irradiance(members: vec2u, normal: vec3f) -> vec4f {
    let count = support.width * support.width * support.width;
    var sum = vec4f(0.0);
    for (var local = 0u; local < count; local++) {
        let at = split(local);
        let share = vec3f(support.weights[at.x].x, support.weights[at.y].y, support.weights[at.z].z);
        let weight = share.x * share.y * share.z;
        if weight > 0.0 && any((members & single(local)) != vec2u(0u)) {
            sum += weight * vec4f(vertex_irradiance(vertex_of(at), normal), 1.0);
        }
    }
    return sum;
}

// The cosine, at least 0, of the angle between the normal and the direction to a vertex.
fn facing(vertex: vec3i, from_origin: vec3f, normal: vec3f) -> f32 {
    let step = select(vec3f(0.0), 1.0 / frame.lattice_inverse_step, frame.lattice_inverse_step > vec3f(0.0));
    let way = vec3f(vertex) * step - from_origin;
    let squared = dot(way, way);
    if squared == 0.0 {
        return 0.0;
    }
    return max(dot(way, normal) / sqrt(squared), 0.0);
}

// The vertices of `within` that open edges join to those of `start`.
fn reach(within: vec2u, start: vec2u) -> vec2u {
    let strides = vec3u(1u, support.width, support.width * support.width);
    var reached = start & within;
    var before = vec2u(0u);
    while any(reached != before) {
        before = reached;
        for (var axis = 0u; axis < 3u; axis++) {
            let onward = raised(reached & open[axis], strides[axis]);
            let back = lowered(reached, strides[axis]) & open[axis];
            reached |= (onward | back) & within;
        }
    }
    return reached;
}

fn split(local: u32) -> vec3u {
    let width = support.width;
    return vec3u(local % width, local / width % width, local / (width * width));
}

fn vertex_of(at: vec3u) -> vec3i {
    return clamp(support.first + vec3i(at), vec3i(0), vec3i(frame.lattice_dims) - 1);
}

fn single(local: u32) -> vec2u {
    return select(vec2u(0u, 1u << (local & 31u)), vec2u(1u << local, 0u), local < 32u);
}

fn lowest(members: vec2u) -> vec2u {
    if members.x != 0u {
        return vec2u(members.x & (~members.x + 1u), 0u);
    }
    return vec2u(0u, members.y & (~members.y + 1u));
}

// Both words as one number, moved by 1 to 31 bits.
fn raised(members: vec2u, bits: u32) -> vec2u {
    return vec2u(members.x << bits, (members.y << bits) | (members.x >> (32u - bits)));
}

fn lowered(members: vec2u, bits: u32) -> vec2u {
    return vec2u((members.x >> bits) | (members.y << (32u - bits)), members.y >> bits);
}
