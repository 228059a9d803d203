//! The seeds of the fuzz targets: small accepted vectors for the readers of our formats, small scene files, and bytes that
//! stand for choices.

use super::{Format, Vector};
use ivg_wire::splitmix64;
use std::path::PathBuf;

/// Largest vector that becomes a seed \[bytes\]: fuzzers are slow on long inputs.
const LONGEST: usize = 2048;
/// Targets whose inputs stand for choices, and lengths of these inputs \[bytes\].
const CHOICE_TARGETS: [&str; 6] =
    ["ivg_roundtrip", "pmesh_roundtrip", "mesh_build", "pmesh_packets", "ivg_fields", "pmesh_fields"];
const CHOICE_LENGTHS: [usize; 4] = [8, 64, 300, 1200];

/// Paths relative to the corpus, and contents.
pub(super) fn seeds(vectors: &[Vector]) -> Vec<(PathBuf, Vec<u8>)> {
    let mut seeds = Vec::new();
    for (format, targets) in [
        (Format::Ivg, &["ivg_decode", "ivg_chunks", "ivg_vs_c"][..]),
        (Format::Pmesh, &["pmesh_decode", "pmesh_chunks", "pmesh_lod", "pmesh_vs_c"]),
    ] {
        let short = vectors.iter().filter(|vector| {
            vector.format == format && vector.code.is_none() && vector.bytes.len() <= LONGEST
        });
        for (vector, target) in short.flat_map(|vector| targets.iter().map(move |target| (vector, target))) {
            seeds.push((PathBuf::from(target).join(&vector.name), vector.bytes.clone()));
        }
    }
    for (seed, target) in (0..).zip(CHOICE_TARGETS) {
        for length in CHOICE_LENGTHS {
            seeds.push((PathBuf::from(target).join(format!("choices-{length}")), choices(seed, length)));
        }
    }
    // The first byte chooses the format: OBJ, PLY, GLB, glTF.
    for (name, format, file) in [
        ("obj", 0, OBJ.to_vec()),
        ("obj-negative-indices", 0, OBJ_NEGATIVE.to_vec()),
        ("ply-ascii", 1, PLY_ASCII.to_vec()),
        ("ply-binary", 1, ply_binary()),
        ("glb", 2, glb()),
        ("gltf", 3, GLTF.to_vec()),
        ("lights", 0, LIGHTS.to_vec()),
    ] {
        seeds.push((PathBuf::from("scene_import").join(name), [&[format], &file[..]].concat()));
    }
    seeds
}

const OBJ: &[u8] = b"o square\nv 0 0 0\nv 1 0 0 1\nv 1 1e0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n\
    usemtl red\ns off\nf 1/1/1 2/2/1 3/3/1 4/1/1\nf 1//1 2//1 3//1\n";
const OBJ_NEGATIVE: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\ng a\nf -3 -2 -1\n";
const PLY_ASCII: &[u8] = b"ply\nformat ascii 1.0\ncomment a seed\nelement vertex 3\nproperty float x\nproperty float y\n\
    property double z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0 255\n1 0 0 0\n0 1 0 7\n3 0 1 2\n";
const PLY_BINARY_HEADER: &[u8] = b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\n\
    property float y\nproperty float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n";
const GLTF: &[u8] = br#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
"nodes":[{"mesh":0},{"extensions":{"KHR_lights_punctual":{"light":0}}}],
"extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[{"type":"point"}]}},
"materials":[{"emissiveFactor":[1,1,1]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
"buffers":[{"byteLength":42,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA"}]}"#;
const GLB_JSON: &[u8] =
    br#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"scale":[1,2,1]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36}]}"#;
const LIGHTS: &[u8] =
    b"unit = 0.001\n[[light]]\nkind = \"rect\"\ncenter = [0.0, 2.0, 0.0]\nu = [0.5, 0.0, 0.0]\n\
    v = [0.0, 0.0, 0.5]\nradiance = [20.0, 18.0, 15.0]\n";

/// The corners of a unit square.
const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];

fn ply_binary() -> Vec<u8> {
    let vertices = CORNERS.iter().flatten().flat_map(|x| x.to_le_bytes());
    // A strip of two triangles, its end, and one triangle more.
    let strip = [8i32, 0, 1, 2, 3, -1, 0, 1, 2].into_iter().flat_map(i32::to_le_bytes);
    PLY_BINARY_HEADER.iter().copied().chain(vertices).chain(strip).collect()
}

fn glb() -> Vec<u8> {
    let mut json = GLB_JSON.to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let binary: Vec<u8> = CORNERS[..3].iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let length = 12 + 8 + json.len() + 8 + binary.len();
    let word = |value: usize| (value as u32).to_le_bytes();
    let head = [*b"glTF", word(2), word(length)].concat();
    let chunks = [(*b"JSON", json), (*b"BIN\0", binary)];
    let chunks = chunks.into_iter().flat_map(|(kind, data)| [&word(data.len())[..], &kind, &data].concat());
    head.into_iter().chain(chunks).collect()
}

/// Bytes without a pattern, the same on every machine.
fn choices(seed: u64, length: usize) -> Vec<u8> {
    (0..).flat_map(|n| splitmix64(seed, n).to_le_bytes()).take(length).collect()
}
