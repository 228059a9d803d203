//! Simplification by meshoptimizer.

use std::path::Path;

use clap::ValueEnum;
use meshopt::{SimplifyOptions, VertexDataAdapter, simplify, simplify_sloppy, typed_to_bytes};
use serde_json::{Value, json};

use crate::Failure;
use crate::mesh::Mesh;
use crate::timing::median;

/// Which function of meshoptimizer.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Method {
    /// `meshopt_simplify`.
    Default,
    /// `meshopt_simplify` with `meshopt_SimplifyPrune`, which drops small components.
    Prune,
    /// `meshopt_simplifySloppy`.
    Sloppy,
}

/// No limit: the number of faces alone ends it.
const ANY_ERROR: f32 = 1e9;

/// Writes the simplified mesh.
pub(crate) fn run(mesh: &Mesh, faces: usize, method: Method, out: &Path) -> Result<Value, Failure> {
    let vertices = VertexDataAdapter::new(typed_to_bytes(&mesh.positions), 12, 0)?;
    let target = 3 * faces;
    let mut indices = Vec::new();
    let seconds = median(1, || {
        indices = match method {
            Method::Default => {
                simplify(&mesh.indices, &vertices, target, ANY_ERROR, SimplifyOptions::None, None)
            }
            Method::Prune => {
                simplify(&mesh.indices, &vertices, target, ANY_ERROR, SimplifyOptions::Prune, None)
            }
            Method::Sloppy => simplify_sloppy(&mesh.indices, &vertices, target, ANY_ERROR, None),
        };
    });
    let simple = Mesh { positions: mesh.positions.clone(), indices };
    simple.write(out)?;
    Ok(json!({ "faces": simple.faces(), "seconds": seconds }))
}
