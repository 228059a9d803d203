use std::io::{self, Write};

use crate::Mesh;

/// Writes a mesh as OBJ text, without materials.
///
/// Positions are written as the f64 sum of origin and position, so a mesh far from the origin loses nothing. Texture
/// coordinates count upwards from the bottom row, as OBJ has it. A normal or texture coordinate has the number of its
/// vertex. Colours follow the position, from 0 to 1 and without alpha, as many programs read them.
///
/// # Errors
///
/// Those of `out`.
pub fn write_obj(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    let own: Vec<u32> = (0..).take(mesh.positions.len()).collect();
    write_obj_joined(mesh, &own, out)
}

/// As [`write_obj`], with one position for vertices that are the same place with different attributes: `places` has the
/// number of each vertex's place, counted from 0 without gaps, rising from vertex to vertex.
///
/// A place has the position and the colour of its first vertex. A corner has the number of the place, and that of the vertex for its
/// normal and texture coordinate.
///
/// # Errors
///
/// Those of `out`.
///
/// # Panics
///
/// If a triangle names a vertex that `places` does not have.
pub fn write_obj_joined(mesh: &Mesh, places: &[u32], out: &mut dyn Write) -> io::Result<()> {
    if !mesh.name.is_empty() {
        // A line break would end the name and begin a statement.
        writeln!(out, "o {}", mesh.name.replace(['\n', '\r'], " "))?;
    }
    let mut next = 0;
    for (i, (p, &place)) in mesh.positions.iter().zip(places).enumerate() {
        if place < next {
            continue;
        }
        next = place + 1;
        let p = mesh.origin + p.as_dvec3();
        write!(out, "v {} {} {}", p.x, p.y, p.z)?;
        if let Some([r, g, b, _]) = mesh.colours.get(i).map(|c| c.map(|byte| f32::from(byte) / 255.0)) {
            write!(out, " {r} {g} {b}")?;
        }
        writeln!(out)?;
    }
    for uv in &mesh.uvs {
        writeln!(out, "vt {} {}", uv.x, 1.0 - f64::from(uv.y))?;
    }
    for n in &mesh.normals {
        writeln!(out, "vn {} {} {}", n.x, n.y, n.z)?;
    }
    for t in &mesh.triangles {
        write!(out, "f")?;
        for i in t {
            let (v, i) = (u64::from(places[*i as usize]) + 1, u64::from(*i) + 1);
            match (mesh.uvs.is_empty(), mesh.normals.is_empty()) {
                (true, true) => write!(out, " {v}")?,
                (true, false) => write!(out, " {v}//{i}")?,
                (false, true) => write!(out, " {v}/{i}")?,
                (false, false) => write!(out, " {v}/{i}/{i}")?,
            }
        }
        writeln!(out)?;
    }
    Ok(())
}
