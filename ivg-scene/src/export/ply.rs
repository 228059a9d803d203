use std::io::{self, Write};

use glam::DVec3;

use crate::Mesh;

/// Writes a mesh as binary little-endian PLY, without materials.
///
/// Positions are `float` if the mesh has its origin at zero, else `double`, so nothing is lost. Texture coordinates are
/// named `s` and `t` and count upwards from the bottom row. Colours are four `uchar`.
///
/// # Errors
///
/// Those of `out`.
pub fn write_ply(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    let double = mesh.origin != DVec3::ZERO;
    let place = if double { "double" } else { "float" };
    write!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.positions.len())?;
    write!(out, "property {place} x\nproperty {place} y\nproperty {place} z\n")?;
    if !mesh.normals.is_empty() {
        out.write_all(b"property float nx\nproperty float ny\nproperty float nz\n")?;
    }
    if !mesh.uvs.is_empty() {
        out.write_all(b"property float s\nproperty float t\n")?;
    }
    if !mesh.colours.is_empty() {
        for name in ["red", "green", "blue", "alpha"] {
            writeln!(out, "property uchar {name}")?;
        }
    }
    write!(
        out,
        "element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        mesh.triangles.len()
    )?;
    for (i, p) in mesh.positions.iter().enumerate() {
        if double {
            for v in (mesh.origin + p.as_dvec3()).to_array() {
                out.write_all(&v.to_le_bytes())?;
            }
        } else {
            write_floats(out, p.to_array())?;
        }
        if let Some(n) = mesh.normals.get(i) {
            write_floats(out, n.to_array())?;
        }
        if let Some(uv) = mesh.uvs.get(i) {
            write_floats(out, [uv.x, 1.0 - uv.y])?;
        }
        if let Some(colour) = mesh.colours.get(i) {
            out.write_all(colour)?;
        }
    }
    for t in &mesh.triangles {
        out.write_all(&[3])?;
        for i in t {
            out.write_all(&i.to_le_bytes())?;
        }
    }
    Ok(())
}

fn write_floats<const N: usize>(out: &mut dyn Write, values: [f32; N]) -> io::Result<()> {
    values.iter().try_for_each(|v| out.write_all(&v.to_le_bytes()))
}
