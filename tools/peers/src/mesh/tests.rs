use super::Mesh;

fn triangle() -> Mesh {
    Mesh {
        positions: vec![[9.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.5, -2.0, 1e-9]],
        indices: vec![3, 1, 2, 2, 1, 3],
    }
}

#[test]
fn reads_what_it_writes_without_unreferenced_vertices() {
    let path = std::env::temp_dir().join(format!("peers-mesh-{}.ply", std::process::id()));
    triangle().write(&path).unwrap();
    let read = Mesh::read(&path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
    let cut = Mesh::read(&path).unwrap_err();
    std::fs::remove_file(&path).unwrap();
    assert_eq!(read.positions, [[0.5, -2.0, 1e-9], [0.0; 3], [1.0, 0.0, 0.0]]);
    assert_eq!(read.indices, [0, 1, 2, 2, 1, 0]);
    assert!(cut.to_string().contains("its length"), "{cut}");
}

#[test]
fn bounds_hold_every_vertex() {
    assert_eq!(triangle().bounds(), [[0.0, -2.0, 0.0], [9.0; 3]]);
}
