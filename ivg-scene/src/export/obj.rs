use std::io::{self, Write};

use crate::Mesh;

/// Writes a mesh as OBJ text, without materials.
///
/// Positions are written as the f64 sum of origin and position, so a mesh far from the origin loses nothing. Texture
/// coordinates count upwards from the bottom row, as OBJ has it. A normal or texture coordinate has the number of its
/// vertex.
///
/// # Errors
///
/// Those of `out`.
pub fn write_obj(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    if !mesh.name.is_empty() {
        // A line break would end the name and begin a statement.
        writeln!(out, "o {}", mesh.name.replace(['\n', '\r'], " "))?;
    }
    for p in &mesh.positions {
        let p = mesh.origin + p.as_dvec3();
        writeln!(out, "v {} {} {}", p.x, p.y, p.z)?;
    }
    for uv in &mesh.uvs {
        writeln!(out, "vt {} {}", uv.x, 1.0 - f64::from(uv.y))?;
    }
    for n in &mesh.normals {
        writeln!(out, "vn {} {} {}", n.x, n.y, n.z)?;
    }
    for t in &mesh.triangles {
        write!(out, "f")?;
        for i in t.map(|i| u64::from(i) + 1) {
            match (mesh.uvs.is_empty(), mesh.normals.is_empty()) {
                (true, true) => write!(out, " {i}")?,
                (true, false) => write!(out, " {i}//{i}")?,
                (false, true) => write!(out, " {i}/{i}")?,
                (false, false) => write!(out, " {i}/{i}/{i}")?,
            }
        }
        writeln!(out)?;
    }
    Ok(())
}
