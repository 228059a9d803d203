//! Direct light with shadows: the twin of `shaders/direct.wgsl`, function for function.

use glam::{Vec2, Vec3};

use crate::layout::{
    DIRECTIONAL_TILES, LIGHT_AREA, LIGHT_DIRECTIONAL, LIGHT_SPOT, LightRecord, SHADOW_FILTER_RADIUS,
};
use crate::plan::inner_scale;

/// Limit depths of the shadow map layers that are in memory.
#[derive(Debug)]
pub(crate) struct ShadowMaps {
    /// Texels along a side.
    pub(crate) size: u32,
    /// Layer of the first map.
    pub(crate) first_layer: u32,
    /// One map a layer, row by row from the top.
    pub(crate) layers: Vec<Vec<f32>>,
}

/// Irradiance \[W/m²\] from `lights`, whose shadow maps are in `maps`, at a point of a surface.
pub(crate) fn direct_irradiance(
    lights: &[LightRecord],
    maps: &ShadowMaps,
    position: Vec3,
    normal: Vec3,
    face_normal: Vec3,
) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for light in lights {
        let irradiance = light_irradiance(light, position, normal, face_normal);
        if irradiance.cmpgt(Vec3::ZERO).any() {
            sum += irradiance * shadow_visibility(light, maps, position, face_normal);
        }
    }
    sum
}

/// Irradiance from one light without regard to what stands between \[W/m²\].
pub(crate) fn light_irradiance(light: &LightRecord, position: Vec3, normal: Vec3, face_normal: Vec3) -> Vec3 {
    let axis = Vec3::from(light.axis);
    let strength = Vec3::from(light.strength);
    if light.kind == LIGHT_DIRECTIONAL {
        if face_normal.dot(axis) >= 0.0 {
            return Vec3::ZERO;
        }
        return strength * (-normal.dot(axis)).max(0.0);
    }
    let to_light = Vec3::from(light.position) - position;
    let squared = to_light.dot(to_light);
    if squared == 0.0 || face_normal.dot(to_light) <= 0.0 {
        return Vec3::ZERO;
    }
    let direction = to_light / squared.sqrt();
    let cosine = normal.dot(direction).max(0.0);
    let light_cosine = -axis.dot(direction);
    let emitted = match light.kind {
        LIGHT_AREA => light_cosine.max(0.0),
        LIGHT_SPOT => {
            let falloff = (light_cosine * light.cone_scale + light.cone_offset).clamp(0.0, 1.0);
            falloff * falloff
        }
        _ => 1.0,
    };
    strength * (cosine * emitted / (squared + light.disk))
}

/// Share of a light that reaches a point of a surface, in [0, 1].
///
/// The surface's plane through the point is compared with the map at each texel of the filter, so a flat surface
/// passes the test everywhere or nowhere, however it is inclined.
pub(crate) fn shadow_visibility(
    light: &LightRecord,
    maps: &ShadowMaps,
    position: Vec3,
    face_normal: Vec3,
) -> f32 {
    if light.layers == 0 {
        return 1.0;
    }
    let size = maps.size as f32;
    let scale = inner_scale(maps.size);
    let frame = [Vec3::from(light.tangent), Vec3::from(light.bitangent), Vec3::from(light.axis)];
    let from_light = position - Vec3::from(light.position);
    let point = Vec3::from(frame.map(|axis| from_light.dot(axis)));
    let plane = Vec3::from(frame.map(|axis| face_normal.dot(axis)));
    let (face, clip, depth, slope);
    if light.kind == LIGHT_DIRECTIONAL {
        let tiles = DIRECTIONAL_TILES as f32;
        let spread = (point.truncate() / light.reach + 1.0) * (0.5 * tiles);
        let tile = spread.floor().clamp(Vec2::ZERO, Vec2::splat(tiles - 1.0));
        face = tile.x as u32 + DIRECTIONAL_TILES * tile.y as u32;
        clip = (2.0 * (spread - tile) - 1.0) * scale;
        depth = 0.5 - 0.5 * point.z / light.reach;
        slope = plane.truncate() / plane.z * (0.5 / (tiles * scale));
    } else {
        let turned = |axis: usize| if point[axis] < 0.0 { -plane[axis] } else { plane[axis] };
        let side = |axis: usize, positive: u32, negative: u32| {
            if point[axis] < 0.0 { negative } else { positive }
        };
        let distance = point.abs();
        let (local, local_plane);
        if distance.x >= distance.y && distance.x > distance.z {
            local = Vec3::new(point.y, point.z, distance.x);
            local_plane = Vec3::new(plane.y, plane.z, turned(0));
            face = side(0, 1, 2);
        } else if distance.y > distance.x && distance.y > distance.z {
            local = Vec3::new(point.x, point.z, distance.y);
            local_plane = Vec3::new(plane.x, plane.z, turned(1));
            face = side(1, 3, 4);
        } else {
            local = Vec3::new(point.x, point.y, distance.z);
            local_plane = Vec3::new(plane.x, plane.y, turned(2));
            face = side(2, 0, 5);
        }
        if face >= light.layers {
            return 0.0;
        }
        clip = local.truncate() / local.z * scale;
        depth = light.reach / local.z;
        slope = local_plane.truncate() * (light.reach / (local_plane.dot(local) * scale));
    }
    let texel = Vec2::new(0.5 + 0.5 * clip.x, 0.5 - 0.5 * clip.y) * size;
    let texel_slope = Vec2::new(slope.x, -slope.y) * (2.0 / size);
    let map = &maps.layers[(light.first_layer + face - maps.first_layer) as usize];
    filtered_visibility(map, maps.size, texel, depth, texel_slope)
}

/// Share of the filter's texels at which the surface's plane is not behind the limit depth.
fn filtered_visibility(map: &[f32], size: u32, texel: Vec2, depth: f32, texel_slope: Vec2) -> f32 {
    let corner = (texel - 0.5).floor();
    let share = texel - 0.5 - corner;
    let last = size as i32 - 1;
    let mut sum = 0.0;
    for y in -SHADOW_FILTER_RADIUS..=SHADOW_FILTER_RADIUS + 1 {
        let start = (corner.y as i32 + y).clamp(0, last) as usize * size as usize;
        let mut row = 0.0;
        for x in -SHADOW_FILTER_RADIUS..=SHADOW_FILTER_RADIUS + 1 {
            let middle = corner + Vec2::new(x as f32, y as f32) + 0.5;
            let limit = map[start + (corner.x as i32 + x).clamp(0, last) as usize];
            if depth + texel_slope.dot(middle - texel) >= limit {
                row += filter_weight(x, share.x);
            }
        }
        sum += row * filter_weight(y, share.y);
    }
    let width = (2 * SHADOW_FILTER_RADIUS + 1) as f32;
    sum / (width * width)
}

/// Weight of a texel in a box of `2 radius + 1` texels that lies between texels.
fn filter_weight(offset: i32, share: f32) -> f32 {
    if offset == -SHADOW_FILTER_RADIUS {
        1.0 - share
    } else if offset == SHADOW_FILTER_RADIUS + 1 {
        share
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests;
