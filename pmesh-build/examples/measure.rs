//! Time and bytes of a progressive mesh: orders a generated surface, writes it, reads it back, and prints what each costs.
//!
//! `cargo run --release -p pmesh-build --example measure -- [SIDE] [PACKET]`: a closed bumpy surface of SIDE × SIDE vertices
//! (default 300), PACKET vertices a packet (default 5000).

use std::time::Instant;

use pmesh_build::{BuildOptions, Cost, build};
use pmesh_format::{EncodeOptions, IndexedMesh, Limits, Replay, check_level, decode_all, encode};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default: u32| arguments.next().map_or(Ok(default), |text| text.parse());
    let (side, packet) = (number(300)?, number(5000)?);
    let mesh = bumpy_torus(side.max(3));
    let plain = 12 * mesh.positions.len() + 12 * mesh.triangles.len();
    println!(
        "{} vertices, {} faces, {plain} bytes as plain arrays",
        mesh.positions.len(),
        mesh.triangles.len()
    );
    for cost in Cost::ALL {
        let start = Instant::now();
        let (progressive, report) =
            build(&mesh, &BuildOptions { cost, ..BuildOptions::default() }, &mut |_| {})?;
        let order = start.elapsed().as_secs_f64();

        let start = Instant::now();
        let file = encode(&progressive, &EncodeOptions::fixed(packet))?;
        let write = start.elapsed().as_secs_f64();

        let start = Instant::now();
        let mut replay = Replay::default();
        decode_all(&file, &Limits::default(), |event| replay.accept(&event).map(drop))?;
        let read = start.elapsed().as_secs_f64();
        for level in (report.base_vertices..report.vertices).step_by((report.levels() / 50).max(1)) {
            replay.set_level(level as u32)?;
            check_level(&replay.mesh())?;
        }
        println!(
            "{:8} order {order:.2} s ({:.1} us a vertex) to {} vertices, {} relaxed, {} forced; \
             file {} bytes ({:+.2} %), written {write:.2} s, read {read:.2} s; own error estimate at 1 % of the vertices {:.2e} of the diagonal",
            cost.name(),
            1e6 * order / report.vertices as f64,
            report.base_vertices,
            report.relaxed_collapses,
            report.forced_collapses,
            file.len(),
            100.0 * (file.len() as f64 / plain as f64 - 1.0),
            f64::from(progressive.errors[report.vertices / 100]) / report.diagonal,
        );
    }
    Ok(())
}

/// A torus with bumps, `side` vertices around either way.
fn bumpy_torus(side: u32) -> IndexedMesh {
    let turn = |k: u32| std::f32::consts::TAU * k as f32 / side as f32;
    let positions = (0..side * side)
        .map(|v| {
            let (a, b) = (turn(v / side), turn(v % side));
            let tube = 0.4 + 0.03 * (13.0 * a).sin() * (9.0 * b).cos();
            let radius = 1.0 + tube * b.cos();
            [radius * a.cos(), radius * a.sin(), tube * b.sin()]
        })
        .collect();
    let vertex = |i: u32, j: u32| i % side * side + j % side;
    let triangles = (0..side * side)
        .flat_map(|q| {
            let (i, j) = (q / side, q % side);
            let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    IndexedMesh::from_positions(positions, triangles)
}
