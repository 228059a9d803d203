//! What goes to a GPU, as bytes: pure functions without wgpu.

use bytemuck::{Pod, Zeroable};
use half::f16;
use ivg_format::Quantity;
use ivg_grid::{FLAG_USABLE, IrradianceGrid, texture_count};
use ivg_scene::Texture;

use crate::geometry::Geometry;

/// Dynamic uniforms lie at multiples of this many bytes: WebGPU's default `minUniformBufferOffsetAlignment`.
pub const UNIFORM_ALIGNMENT: usize = 256;

/// Number of textures that a grid is put in.
const TEXTURES: usize = 3;

/// Slabs stacked along z in each of the three textures of a grid: for irradiance vectors two hemispheres of three
/// channels, for radiance harmonics one group of coefficients of three channels.
#[must_use]
pub const fn slabs(quantity: Quantity) -> usize {
    texture_count(quantity) / TEXTURES
}

/// Bit of [`grid_flags`]: the eight vertices of the cell that begins at the vertex are usable and none of its twelve
/// edges is blocked.
pub const FLAG_CLEAR_CELL: u8 = 0b1_0000;

/// Bit of [`grid_flags`]: the same for the 4 x 4 x 4 vertices around that cell.
pub const FLAG_CLEAR_BLOCK: u8 = 0b10_0000;

/// Half-precision values are scaled so that the largest is at most this: the largest power of two below the largest
/// half-precision number, 65504. Values down to a five hundred millionth of the largest keep their full precision.
const LARGEST_HALF: f32 = 32768.0;

/// A corner of a triangle as the shading pass reads it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct CornerRecord {
    /// Position in scene space \[m\].
    pub position: [f32; 3],
    /// Shading normal, unit length or zero.
    pub normal: [f32; 3],
    /// Texture coordinates.
    pub uv: [f32; 2],
    /// Normal of the triangle, unit length, zero for a triangle without area.
    pub face_normal: [f32; 3],
}

/// Three corners for each triangle, in the order of [`Geometry::triangles`].
#[must_use]
pub fn corner_records(geometry: &Geometry) -> Vec<CornerRecord> {
    let mut records = Vec::with_capacity(3 * geometry.triangles.len());
    for (triangle, corners) in (0u32..).zip(&geometry.triangles) {
        let [a, b, c] = geometry.corners(triangle);
        let face_normal = (b - a).cross(c - a).normalize_or_zero().to_array();
        records.extend(corners.map(|corner| CornerRecord {
            position: geometry.positions[corner as usize].to_array(),
            normal: geometry.normals[corner as usize].to_array(),
            uv: geometry.uvs[corner as usize].to_array(),
            face_normal,
        }));
    }
    records
}

/// Records one after another, each at the next multiple of [`UNIFORM_ALIGNMENT`]; one zero record if there is none.
#[must_use]
pub fn aligned_uniforms<T: Pod>(records: &[T]) -> Vec<u8> {
    let stride = size_of::<T>().next_multiple_of(UNIFORM_ALIGNMENT);
    let mut bytes = vec![0; stride * records.len().max(1)];
    for (chunk, record) in bytes.chunks_exact_mut(stride).zip(records) {
        chunk[..size_of::<T>()].copy_from_slice(bytemuck::bytes_of(record));
    }
    bytes
}

/// RGBA texels of an image, four bytes each, sRGB.
#[must_use]
pub fn rgba_texels(texture: &Texture) -> Vec<u8> {
    texture.texels.chunks_exact(3).flat_map(|texel| [texel[0], texel[1], texel[2], 255]).collect()
}

/// The three textures of a grid and what their values must be multiplied by \[W/m² or W/(m² sr)\].
///
/// A texture has [`slabs`] times as many slices as the lattice. Of irradiance vectors, the textures are those of the
/// hemispheres along x, y and z, and slab `3 s + channel` holds the vectors of the positive (s = 0) or negative (s = 1)
/// one. Of radiance harmonics, they are those of coefficients 0 to 2, 3 to 5 and 6 to 8, and slab `channel` holds a
/// channel's. A texel is what [`IrradianceGrid::texture_layer`](ivg_grid::IrradianceGrid::texture_layer) gives: three
/// numbers times a weight, and the weight; the numbers are divided by the scale.
#[must_use]
pub fn grid_textures(grid: &IrradianceGrid) -> ([Vec<f16>; TEXTURES], f32) {
    let largest = grid.largest_component();
    // A power of two: dividing by it loses nothing.
    let exponent = if largest > 0.0 { (largest / LARGEST_HALF).log2().ceil() } else { 0.0 };
    let scale = exponent.clamp(-126.0, 127.0).exp2();
    let slabs = slabs(grid.quantity());
    let textures = [0, 1, 2].map(|texture| {
        let mut texels = Vec::with_capacity(4 * slabs * grid.vertex_count());
        for slab in 0..slabs {
            for [x, y, z, weight] in grid.texture_layer(texture * slabs + slab) {
                texels.extend([x / scale, y / scale, z / scale, weight].map(f16::from_f32));
            }
        }
        texels
    });
    (textures, scale)
}

/// One byte a vertex: its [`IrradianceGrid::texture_flags`], [`FLAG_CLEAR_CELL`] and [`FLAG_CLEAR_BLOCK`].
#[must_use]
pub fn grid_flags(grid: &IrradianceGrid) -> Vec<u8> {
    let flags = grid.texture_flags();
    let dims = grid.lattice().dims.map(usize::from);
    let index = |at: [usize; 3]| at[0] + dims[0] * (at[1] + dims[1] * at[2]);
    // Whether all vertices from `before` steps before `base` to `after` steps after it, cut to the lattice, are usable
    // and joined.
    let is_clear = |base: [usize; 3], before: usize, after: usize| {
        let low = base.map(|coordinate| coordinate.saturating_sub(before));
        let high = [0, 1, 2].map(|axis| (base[axis] + after).min(dims[axis] - 1));
        (low[2]..=high[2]).all(|k| {
            (low[1]..=high[1]).all(|j| {
                (low[0]..=high[0]).all(|i| {
                    let at = [i, j, k];
                    let inner = |axis: usize| at[axis] < high[axis];
                    let blocked = (0..3).any(|axis| inner(axis) && flags[index(at)] >> axis & 1 == 1);
                    flags[index(at)] & FLAG_USABLE != 0 && !blocked
                })
            })
        })
    };
    let mut result = flags.clone();
    for k in 0..dims[2] {
        for j in 0..dims[1] {
            for i in 0..dims[0] {
                let base = [i, j, k];
                let vertex = &mut result[index(base)];
                if is_clear(base, 0, 1) {
                    *vertex |= FLAG_CLEAR_CELL;
                    if is_clear(base, 1, 2) {
                        *vertex |= FLAG_CLEAR_BLOCK;
                    }
                }
            }
        }
    }
    result
}

#[cfg(test)]
mod tests;
