//! The codec of meshoptimizer with zstd behind it, in the order of triangles that it packs best.

use meshopt::{
    decode_index_buffer, decode_vertex_buffer, encode_index_buffer, encode_vertex_buffer_level,
    optimize_vertex_cache_strip, optimize_vertex_fetch_in_place,
};
use serde_json::{Value, json};

use crate::Failure;
use crate::mesh::Mesh;
use crate::timing::median;

/// The strongest level of zstd that needs no option of its own to be read.
const ZSTD_LEVEL: i32 = 19;
/// Level and version of meshoptimizer's vertex codec: the strongest, the newest.
const VERTEX_LEVEL: i32 = 3;
const VERTEX_VERSION: i32 = 1;

/// Bytes and decoding time \[s\] of a mesh with positions of `bits` bits along its longest side; 0 for floats as they are.
pub(crate) fn measure(mesh: &Mesh, bits: u32, runs: usize) -> Result<Value, Failure> {
    let mut indices = optimize_vertex_cache_strip(&mesh.indices, mesh.positions.len());
    let mut positions = mesh.positions.clone();
    let vertices = optimize_vertex_fetch_in_place(&mut indices, &mut positions);
    positions.truncate(vertices);
    let (sizes, seconds) = if bits == 0 {
        pack(&indices, &positions, runs)?
    } else {
        pack(&indices, &on_lattice(&positions, mesh.bounds(), bits), runs)?
    };
    let [index_bytes, vertex_bytes, bytes] = sizes;
    Ok(json!({
        "vertices": vertices, "index_bytes": index_bytes, "vertex_bytes": vertex_bytes,
        "bytes": bytes, "decode_seconds": seconds,
    }))
}

/// Packs, checks that the same comes back, and times unpacking.
fn pack<V: Copy + Default + PartialEq>(
    indices: &[u32],
    vertices: &[V],
    runs: usize,
) -> Result<([usize; 3], f64), Failure> {
    let index_part = encode_index_buffer(indices, vertices.len())?;
    let vertex_part = encode_vertex_buffer_level(vertices, VERTEX_LEVEL, Some(VERTEX_VERSION))?;
    let both = [&index_part[..], &vertex_part[..]].concat();
    let packed = zstd::bulk::compress(&both, ZSTD_LEVEL)?;
    let unpack = || -> Result<(Vec<u32>, Vec<V>), Failure> {
        let both = zstd::bulk::decompress(&packed, both.len())?;
        let (index_part, vertex_part) = both.split_at(index_part.len());
        Ok((
            decode_index_buffer(index_part, indices.len())?,
            decode_vertex_buffer(vertex_part, vertices.len())?,
        ))
    };
    let (back, points) = unpack()?;
    // Corners may be rotated within a triangle.
    let rotated = |t: &[u32]| {
        let least = (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
        [t[least], t[(least + 1) % 3], t[(least + 2) % 3]]
    };
    if points != vertices || !back.chunks_exact(3).map(rotated).eq(indices.chunks_exact(3).map(rotated)) {
        return Err("meshoptimizer: another mesh came back".into());
    }
    Ok(([index_part.len(), vertex_part.len(), packed.len()], median(runs, unpack)))
}

/// Positions on a cubic lattice of 2^bits points along the longest side, as Draco has it; the fourth number is padding that
/// GPUs and the codec want.
fn on_lattice(positions: &[[f32; 3]], [least, greatest]: [[f32; 3]; 2], bits: u32) -> Vec<[u16; 4]> {
    let extent = (0..3).map(|axis| greatest[axis] - least[axis]).fold(0.0, f32::max);
    let steps = ((1_u32 << bits) - 1) as f32;
    let scale = if extent > 0.0 { steps / extent } else { 0.0 };
    let coordinate = |x: f32, least: f32| ((x - least) * scale + 0.5) as u16;
    positions
        .iter()
        .map(|p| [coordinate(p[0], least[0]), coordinate(p[1], least[1]), coordinate(p[2], least[2]), 0])
        .collect()
}
