//! The report of bakes with fewer faces, as a user meets it.

#[allow(dead_code, reason = "shared with the other tests, which use other parts")]
mod support;

use serde_json::Value;
use support::{Workplace, text};

/// A closed room of 2 m with a lamp under its ceiling and a ball of 8 · 4³ faces in its middle, all one mesh.
fn room_with_ball() -> Workplace {
    let place = Workplace::new();
    let mut faces = vec![];
    for signs in 0..8 {
        let [x, y, z] = [0, 1, 2].map(|axis| if signs >> axis & 1 == 0 { 1.0f64 } else { -1.0 });
        let face = [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
        faces.push(if x * y * z > 0.0 { face } else { [face[0], face[2], face[1]] });
    }
    let middle = |a: [f64; 3], b: [f64; 3]| {
        let sum: [f64; 3] = std::array::from_fn(|n| a[n] + b[n]);
        let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
        sum.map(|x| x / length)
    };
    for _ in 0..3 {
        faces = faces
            .into_iter()
            .flat_map(|[a, b, c]| {
                let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    let mut obj = String::from("mtllib room.mtl\n");
    for [x, y, z] in
        [[-1, -1, -1], [1, -1, -1], [1, -1, 1], [-1, -1, 1], [-1, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]]
    {
        obj.push_str(&format!("v {x} {y} {z}\n"));
    }
    obj.push_str("v -0.5 0.95 -0.5\nv 0.5 0.95 -0.5\nv 0.5 0.95 0.5\nv -0.5 0.95 0.5\n");
    for [x, y, z] in faces.as_flattened() {
        obj.push_str(&format!("v {} {} {}\n", 0.6 * x, 0.6 * y, 0.6 * z));
    }
    obj.push_str("usemtl white\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 1 5 8 4\nf 2 3 7 6\n");
    for n in 0..faces.len() {
        obj.push_str(&format!("f {} {} {}\n", 13 + 3 * n, 14 + 3 * n, 15 + 3 * n));
    }
    obj.push_str("usemtl light\nf 9 10 11 12\n");
    place.write("room.obj", obj.as_bytes());
    place.write("room.mtl", support::ROOM_MTL.as_bytes());
    place
}

const SMALL: [&str; 6] = ["--grid", "5x5x5", "--photons", "40000", "--bakes", "3"];

#[test]
fn fewer_faces_are_compared_with_all_of_them() {
    let place = room_with_ball();
    // Tens of thousands of photons leave some per cent of noise, which is taken off.
    let output =
        place.ok(&[&["robustness", "room.obj", "--faces", "100%,25%,5%", "--json"][..], &SMALL].concat());
    let report: Value = serde_json::from_str(&text(&output)).unwrap();
    let rows = report["geometries"].as_array().unwrap();
    let number = |row: usize, key: &str| rows[row][key].as_f64().unwrap_or_else(|| panic!("{key}: {report}"));
    let found = |row: usize, key: &str| rows[row]["all"][key].as_f64().unwrap();
    assert_eq!(rows.len(), 4);
    assert!(rows[0]["all"].is_null() && number(0, "faces") == 526.0);
    // All faces: the same light, but for the order of equal hits; the same photons, so that there is no noise either.
    assert_eq!((number(1, "faces"), number(1, "surface_error_m")), (526.0, 0.0));
    assert!(found(1, "rmse") < 1e-3 && found(1, "noise") < 1e-2, "{report}");
    for (row, most) in [(2, 132.0), (3, 26.0)] {
        assert!(number(row, "faces") <= most && number(row, "faces") > 0.8 * most, "{report}");
        assert!(number(row, "surface_error_m") > number(row - 1, "surface_error_m"), "{report}");
        assert!(number(row, "geometry_bytes") < number(row - 1, "geometry_bytes"), "{report}");
    }
    // Of a ball of 512 faces about 8 are left: it is a good deal smaller, and vertices near it see more.
    assert!(found(3, "rmse") > 0.01, "{report}");
    // And the light is as before: walls and lamp are whole.
    assert!((found(3, "mean_ratio") - 1.0).abs() < 0.2, "{report}");
}

#[test]
fn the_table_names_what_was_compared() {
    let place = room_with_ball();
    let table = text(&place.ok(&[&["robustness", "room.obj", "--faces", "10%"][..], &SMALL].concat()));
    for part in
        ["3 bakes of each geometry", "40000 photons each", "5 x 5 x 5 vertices", "100.00 %", "interior"]
    {
        assert!(table.contains(part), "{part}: {table}");
    }
    let refused = place.run(&["robustness", "room.obj", "--faces", "200%"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("share of the faces"), "{}", text(&refused.stderr));
}
