// Direct light with shadows. Twin: cpu/direct.rs. Needs `frame`, `lights` and `shadow_maps` of shade.wgsl.

// Irradiance from all lights at a point of a surface [W/m²].
fn direct_irradiance(position: vec3f, normal: vec3f, face_normal: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var index = 0u; index < frame.light_count; index++) {
        let irradiance = light_irradiance(index, position, normal, face_normal);
        if any(irradiance > vec3f(0.0)) {
            sum += irradiance * shadow_visibility(index, position, face_normal);
        }
    }
    return sum;
}

// Irradiance from one light without regard to what stands between [W/m²].
fn light_irradiance(index: u32, position: vec3f, normal: vec3f, face_normal: vec3f) -> vec3f {
    let light = lights[index];
    if light.kind == LIGHT_DIRECTIONAL {
        if dot(face_normal, light.axis) >= 0.0 {
            return vec3f(0.0);
        }
        return light.strength * max(-dot(normal, light.axis), 0.0);
    }
    let to_light = light.position - position;
    let squared = dot(to_light, to_light);
    if squared == 0.0 || dot(face_normal, to_light) <= 0.0 {
        return vec3f(0.0);
    }
    let direction = to_light / sqrt(squared);
    let cosine = max(dot(normal, direction), 0.0);
    let light_cosine = -dot(light.axis, direction);
    var emitted = 1.0;
    if light.kind == LIGHT_AREA {
        emitted = max(light_cosine, 0.0);
    } else if light.kind == LIGHT_SPOT {
        let falloff = clamp(light_cosine * light.cone_scale + light.cone_offset, 0.0, 1.0);
        emitted = falloff * falloff;
    }
    return light.strength * (cosine * emitted / (squared + light.disk));
}

// Share of a light that reaches a point of a surface, in [0, 1].
fn shadow_visibility(index: u32, position: vec3f, face_normal: vec3f) -> f32 {
    let light = lights[index];
    if light.layers == 0u {
        return 1.0;
    }
    let size = f32(frame.shadow_size);
    let scale = (size - 2.0 * f32(SHADOW_BORDER)) / size;
    let from_light = position - light.position;
    let point = vec3f(dot(from_light, light.tangent), dot(from_light, light.bitangent), dot(from_light, light.axis));
    let plane =
        vec3f(dot(face_normal, light.tangent), dot(face_normal, light.bitangent), dot(face_normal, light.axis));
    var face = 0u;
    // Clip space position, depth there, and how the depth of the surface's plane changes over clip space.
    var clip = vec2f(0.0);
    var depth = 0.0;
    var slope = vec2f(0.0);
    if light.kind == LIGHT_DIRECTIONAL {
        let tiles = f32(DIRECTIONAL_TILES);
        let spread = (point.xy / light.reach + 1.0) * (0.5 * tiles);
        let tile = clamp(floor(spread), vec2f(0.0), vec2f(tiles - 1.0));
        face = u32(tile.x) + DIRECTIONAL_TILES * u32(tile.y);
        clip = (2.0 * (spread - tile) - 1.0) * scale;
        depth = 0.5 - 0.5 * point.z / light.reach;
        slope = plane.xy / plane.z * (0.5 / (tiles * scale));
    } else {
        let distance = abs(point);
        var local = vec3f(point.xy, abs(point.z));
        var local_plane = vec3f(plane.xy, select(plane.z, -plane.z, point.z < 0.0));
        face = select(0u, 5u, point.z < 0.0);
        if distance.x >= distance.y && distance.x > distance.z {
            local = vec3f(point.yz, distance.x);
            local_plane = vec3f(plane.yz, select(plane.x, -plane.x, point.x < 0.0));
            face = select(1u, 2u, point.x < 0.0);
        } else if distance.y > distance.x && distance.y > distance.z {
            local = vec3f(point.xz, distance.y);
            local_plane = vec3f(plane.xz, select(plane.y, -plane.y, point.y < 0.0));
            face = select(3u, 4u, point.y < 0.0);
        }
        if face >= light.layers {
            return 0.0;
        }
        clip = local.xy / local.z * scale;
        depth = light.reach / local.z;
        slope = local_plane.xy * (light.reach / (dot(local_plane, local) * scale));
    }
    // From clip space to texels: y turns round.
    let texel = vec2f(0.5 + 0.5 * clip.x, 0.5 - 0.5 * clip.y) * size;
    let texel_slope = vec2f(slope.x, -slope.y) * (2.0 / size);
    return filtered_visibility(light.first_layer + face, texel, depth, texel_slope);
}

// Share of the filter's texels at which the surface's plane is not behind the limit depth.
fn filtered_visibility(layer: u32, texel: vec2f, depth: f32, texel_slope: vec2f) -> f32 {
    let corner = floor(texel - 0.5);
    let share = texel - 0.5 - corner;
    var sum = 0.0;
    for (var y = -SHADOW_FILTER_RADIUS; y <= SHADOW_FILTER_RADIUS + 1; y++) {
        var row = 0.0;
        for (var x = -SHADOW_FILTER_RADIUS; x <= SHADOW_FILTER_RADIUS + 1; x++) {
            let middle = corner + vec2f(f32(x), f32(y)) + 0.5;
            let limit = textureLoad(shadow_maps, vec2i(middle), layer, 0);
            if depth + dot(texel_slope, middle - texel) >= limit {
                row += filter_weight(x, share.x);
            }
        }
        sum += row * filter_weight(y, share.y);
    }
    let width = f32(2 * SHADOW_FILTER_RADIUS + 1);
    return sum / (width * width);
}

// Weight of a texel in a box of 2 radius + 1 texels that lies between texels.
fn filter_weight(offset: i32, share: f32) -> f32 {
    if offset == -SHADOW_FILTER_RADIUS {
        return 1.0 - share;
    }
    return select(1.0, share, offset == SHADOW_FILTER_RADIUS + 1);
}
