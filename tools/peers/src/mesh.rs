//! Indexed triangle meshes in the one form of PLY that `peers.py` writes.

use std::fs;
use std::path::Path;

use crate::Failure;

#[cfg(test)]
mod tests;

/// Vertices and triangles, as they stand in the file.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Mesh {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) indices: Vec<u32>,
}

/// Bytes of a triangle in the file: a count and three indices.
const TRIANGLE: usize = 13;

/// What stands between the numbers of vertices and faces in the header.
const HEADER: [&str; 3] = [
    "ply\nformat binary_little_endian 1.0\nelement vertex ",
    "\nproperty float x\nproperty float y\nproperty float z\nelement face ",
    "\nproperty list uchar int vertex_indices\nend_header\n",
];

impl Mesh {
    pub(crate) fn faces(&self) -> usize {
        self.indices.len() / 3
    }

    /// Bytes of plain arrays: 12 a vertex, 12 a face.
    pub(crate) fn plain_bytes(&self) -> usize {
        12 * self.positions.len() + 4 * self.indices.len()
    }

    /// Reads binary little-endian PLY with vertices of three floats and faces of one byte and three 32-bit indices.
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        let fail = |what: &str| Failure::from(format!("{}: {what}", path.display()));
        let bytes = fs::read(path).map_err(|error| fail(&error.to_string()))?;
        let (mut rest, mut counts) = (&bytes[..], [0_usize; 2]);
        for (k, part) in HEADER.iter().enumerate() {
            rest = rest.strip_prefix(part.as_bytes()).ok_or_else(|| fail("not PLY as peers.py writes it"))?;
            if let Some(count) = counts.get_mut(k) {
                let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
                let (number, after) = rest.split_at(digits);
                *count = String::from_utf8_lossy(number).parse().map_err(|_| fail("a count is no number"))?;
                rest = after;
            }
        }
        let [vertices, faces] = counts;
        if rest.len() != 12 * vertices + TRIANGLE * faces {
            return Err(fail("its length is not what its header says"));
        }
        let (points, triangles) = rest.split_at(12 * vertices);
        let word = |bytes: &[u8]| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        let positions = points
            .chunks_exact(12)
            .map(|point| [0, 4, 8].map(|at| f32::from_bits(word(&point[at..]))))
            .collect();
        let indices: Vec<u32> =
            triangles.chunks_exact(TRIANGLE).flat_map(|face| [1, 5, 9].map(|at| word(&face[at..]))).collect();
        let triangular = triangles.chunks_exact(TRIANGLE).all(|face| face[0] == 3);
        if !triangular || indices.iter().any(|&index| index as usize >= vertices) {
            return Err(fail("a face is no triangle of its vertices"));
        }
        Ok(Self { positions, indices })
    }

    /// Writes what [`Mesh::read`] reads, without vertices that no triangle has.
    pub(crate) fn write(&self, path: &Path) -> Result<(), Failure> {
        let mesh = self.referenced();
        let [first, between, last] = HEADER;
        let mut bytes =
            format!("{first}{}{between}{}{last}", mesh.positions.len(), mesh.faces()).into_bytes();
        bytes.extend(mesh.positions.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        for triangle in mesh.indices.chunks_exact(3) {
            bytes.push(3);
            bytes.extend(triangle.iter().flat_map(|index| index.to_le_bytes()));
        }
        fs::write(path, bytes).map_err(|error| format!("{}: {error}", path.display()).into())
    }

    /// The same triangles, with the vertices in the order in which they are first used.
    fn referenced(&self) -> Self {
        let mut new_index = vec![u32::MAX; self.positions.len()];
        let mut positions = Vec::new();
        let indices = self.indices.iter().map(|&index| {
            let new = &mut new_index[index as usize];
            if *new == u32::MAX {
                *new = positions.len() as u32;
                positions.push(self.positions[index as usize]);
            }
            *new
        });
        Self { indices: indices.collect(), positions }
    }

    /// Least and greatest coordinates.
    pub(crate) fn bounds(&self) -> [[f32; 3]; 2] {
        let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
        for point in &self.positions {
            for axis in 0..3 {
                bounds[0][axis] = bounds[0][axis].min(point[axis]);
                bounds[1][axis] = bounds[1][axis].max(point[axis]);
            }
        }
        bounds
    }
}
