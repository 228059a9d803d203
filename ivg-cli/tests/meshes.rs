//! `mesh`, and `extract`, `info` and `check` of what it writes.

#[allow(dead_code, reason = "shared with the other tests, which use other parts")]
mod support;

use serde_json::Value;
use support::{Workplace, text};

/// A cube with a normal for each side and texture coordinates: 8 vertices, 24 wedges, 12 faces.
fn cube() -> String {
    let mut obj = String::new();
    for corner in 0..8 {
        obj += &format!("v {} {} {}\n", corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    }
    obj += "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    obj += "vn -1 0 0\nvn 1 0 0\nvn 0 -1 0\nvn 0 1 0\nvn 0 0 -1\nvn 0 0 1\n";
    let sides = [[1, 5, 7, 3], [2, 4, 8, 6], [1, 2, 6, 5], [3, 7, 8, 4], [1, 3, 4, 2], [5, 6, 8, 7]];
    for (side, [a, b, c, d]) in (1..).zip(sides) {
        obj +=
            &format!("f {a}/1/{side} {b}/2/{side} {c}/3/{side}\nf {a}/1/{side} {c}/3/{side} {d}/4/{side}\n");
    }
    obj
}

/// A bumpy sheet of n x n vertices.
fn sheet(n: usize) -> String {
    let mut obj = String::new();
    for k in 0..n * n {
        let (x, y) = (k % n, k / n);
        obj += &format!("v {x} {y} {}\n", k * k % 17);
    }
    for k in 0..(n - 1) * (n - 1) {
        let a = k / (n - 1) * n + k % (n - 1) + 1;
        obj += &format!("f {a} {} {}\nf {a} {} {}\n", a + 1, a + n + 1, a + n + 1, a + n);
    }
    obj
}

fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes).unwrap_or_else(|error| panic!("{error}: {}", text(bytes)))
}

fn lines(place: &Workplace, file: &str, start: &str) -> usize {
    text(&place.read(file)).lines().filter(|line| line.starts_with(start)).count()
}

#[test]
fn the_parts_of_a_mesh_add_up_to_its_file() {
    let place = Workplace::new();
    place.write("cube.obj", cube().as_bytes());
    place.write("sheet.obj", sheet(30).as_bytes());
    for (mesh, vertices, wedges) in [("cube", 8, 24), ("sheet", 900, 900)] {
        for storage in [&["--mode", "raw", "--positions", "f32"][..], &[]] {
            let (input, out) = (format!("{mesh}.obj"), format!("{mesh}.pmesh"));
            let arguments = [&["mesh", &input, "-o", &out, "--json"][..], storage].concat();
            let report = json(&place.ok(&arguments));
            let count = |key: &str| report[key].as_u64().unwrap_or_else(|| panic!("{key}: {report}"));
            assert_eq!((count("vertices"), count("wedges")), (vertices, wedges), "{report}");
            assert_eq!(count("levels"), vertices - count("base_vertices") + 1);
            let bytes = place.read(&out).len() as u64;
            let parts = report["parts"].as_object().expect("an object");
            let sum: u64 = parts.values().map(|part| part.as_u64().expect("bytes")).sum();
            assert_eq!((count("bytes"), sum), (bytes, bytes), "{report}");
            let bits = report["bits_per_vertex"].as_f64().expect("a number");
            assert!((bits - 8.0 * bytes as f64 / vertices as f64).abs() < 1e-9);
            for stage in ["read", "clean", "order", "encode", "write"] {
                assert!(report["seconds"][stage].is_f64(), "{stage}: {report}");
            }
            place.ok(&["check", &out]);
            // What is printed for people are the same figures.
            let shown = text(&place.ok(&[&["mesh", &input, "-o", &out][..], storage].concat()));
            assert!(shown.contains(&format!("{vertices} vertices, {wedges} wedges")), "{shown}");
            for (part, bytes) in parts {
                assert!(shown.contains(&format!("{bytes} B  {part}\n")), "{part}: {shown}");
            }
        }
    }
}

#[test]
fn what_was_welded_and_dropped_is_told() {
    let place = Workplace::new();
    // The first corner again under another number, a face without area, a vertex without a face.
    let soup = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 1 1 0\nv 5 5 5\nf 1 2 3\nf 4 3 5\nf 2 2 3\n";
    place.write("soup.obj", soup.as_bytes());
    let report = json(&place.ok(&["mesh", "soup.obj", "-o", "soup.pmesh", "--json"]));
    let found = |what: &str| report["findings"][what].as_u64();
    assert_eq!(found("vertices welded (equal positions)"), Some(1), "{report}");
    assert_eq!(found("degenerate faces dropped"), Some(1), "{report}");
    assert_eq!(found("duplicate faces dropped"), None, "{report}");
    let shown = text(&place.ok(&["mesh", "soup.obj", "-o", "soup.pmesh"]));
    assert!(shown.contains("1    vertices welded (equal positions)\n"), "{shown}");
    // Normals that only one of two objects has, a line, and a material library that is not there.
    let mixed =
        "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nl 1 2\no a\nf 1//1 2//1 3//1\no b\nf 1 3 2\n";
    place.write("mixed.obj", mixed.as_bytes());
    let output = place.run(&["mesh", "mixed.obj", "-o", "mixed.pmesh", "--json"]);
    let (report, said) = (json(&output.stdout), text(&output.stderr));
    for (key, what) in [
        ("warnings", "gone.mtl"),
        ("left_out", "normals, as not every mesh of the file has them"),
        ("left_out", "1 lines, points or curves"),
    ] {
        let list = report[key].as_array().expect("a list");
        assert!(list.iter().any(|item| item.as_str().expect("text").contains(what)), "{what}: {report}");
        assert!(said.contains(what), "{what}: {said}");
    }
}

#[test]
fn packets_have_the_wanted_number_of_vertices() {
    let place = Workplace::new();
    place.write("sheet.obj", sheet(30).as_bytes());
    let packets = |options: &[&str]| {
        let report =
            json(&place.ok(&[&["mesh", "sheet.obj", "-o", "sheet.pmesh", "--json"], options].concat()));
        report["packets"].as_u64().expect("a number")
    };
    assert_eq!(packets(&["--packet", "100"]), 9);
    assert_eq!(packets(&["--packet", "899"]), 2);
    assert!(packets(&["--growth", "100"]) < packets(&["--growth", "10"]));
    assert_eq!(packets(&[]), packets(&["--growth", "30"]));
    for (options, named) in [
        (&["--packet", "9", "--growth", "9"][..], "--growth"),
        (&["--packet", "0"], "must be at least 1"),
        (&["--positions", "q9"], "q10"),
        (&["--mode", "zip"], "raw"),
        (&["--normal-bits", "17"], "4..=16"),
        (&["--uv-bits", "3"], "4..=16"),
        (&["--mode", "raw", "--uv-bits", "8"], "--uv-bits is for --mode coded"),
        (&["--mode", "raw", "--normal-bits", "8"], "--normal-bits is for --mode coded"),
    ] {
        let output = place.run(&[&["mesh", "sheet.obj", "-o", "bad.pmesh"], options].concat());
        assert_eq!(output.status.code(), Some(2), "{options:?}");
        assert!(text(&output.stderr).contains(named), "{}", text(&output.stderr));
        assert!(!place.path().join("bad.pmesh").exists());
    }
}

#[test]
fn seams_keep_their_attributes_when_extracted() {
    let place = Workplace::new();
    place.write("cube.obj", cube().as_bytes());
    place.ok(&["mesh", "cube.obj", "-o", "cube.pmesh", "--mode", "raw", "--positions", "f32"]);
    place.ok(&["extract", "cube.pmesh", "-o", "whole.obj"]);
    let counts = ["v ", "vt ", "vn ", "f "].map(|start| lines(&place, "whole.obj", start));
    assert_eq!(counts, [8, 24, 24, 12]);
    let output = place.run(&["extract", "cube.pmesh", "-o", "whole.ply"]);
    assert!(text(&output.stderr).contains("8 of the 8 vertices lie on seams"), "{}", text(&output.stderr));
    assert!(text(&place.read("whole.ply")).contains("element vertex 24\n"));
    // Both say the same mesh as the source.
    for file in ["whole.obj", "whole.ply"] {
        let report = json(&place.ok(&["mesh", file, "-o", "again.pmesh", "--json"]));
        let count = |key: &str| report[key].as_u64();
        assert_eq!(
            (count("vertices"), count("wedges"), count("faces")),
            (Some(8), Some(24), Some(12)),
            "{file}"
        );
    }
    // A coarser level has the wedges of its vertices.
    place.ok(&["extract", "cube.pmesh", "-o", "coarse.obj", "--level", "6"]);
    let [positions, normals] = ["v ", "vn "].map(|start| lines(&place, "coarse.obj", start));
    assert!(positions == 6 && normals > 6, "{positions} positions, {normals} normals");
}

/// The vertices of a mesh file as text, sorted: position and colour.
fn coloured_vertices(place: &Workplace, file: &str) -> Vec<String> {
    let text = text(&place.read(file));
    let mut lines: Vec<String> =
        text.lines().filter(|line| line.starts_with("v ")).map(String::from).collect();
    lines.sort();
    lines
}

#[test]
fn colours_of_vertices_go_through_to_what_is_extracted() {
    let place = Workplace::new();
    let n = 12;
    let colour = |k: usize| [k * 7 % 256, k * k % 256, 255 - k].map(|byte| byte as f32 / 255.0);
    let (mut vertices, mut ply) = (Vec::new(), String::new());
    for k in 0..n * n {
        let ([r, g, b], [x, y, z]) = (colour(k), [k % n, k / n, k * k % 17]);
        vertices.push(format!("v {x} {y} {z} {r} {g} {b}"));
        ply += &format!("{x} {y} {z} {r} {g} {b} {}\n", if k == 5 { 0.2 } else { 1.0 });
    }
    let mut faces = Vec::new();
    for k in 0..(n - 1) * (n - 1) {
        let a = k / (n - 1) * n + k % (n - 1);
        faces.extend([[a, a + 1, a + n + 1], [a, a + n + 1, a + n]]);
    }
    let obj_faces: String =
        faces.iter().map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1)).collect();
    place.write("sheet.obj", (vertices.join("\n") + "\n" + &obj_faces).as_bytes());
    let properties: String =
        "x y z red green blue alpha".split(' ').map(|name| format!("property float {name}\n")).collect();
    let ply_faces: String = faces.iter().map(|[a, b, c]| format!("3 {a} {b} {c}\n")).collect();
    let (v, f) = (n * n, faces.len());
    place.write(
        "sheet.ply",
        format!(
            "ply\nformat ascii 1.0\nelement vertex {v}\n{properties}element face {f}\n\
             property list uchar int vertex_indices\nend_header\n{ply}{ply_faces}"
        )
        .as_bytes(),
    );
    vertices.sort();
    for storage in [&[][..], &["--mode", "raw"]] {
        let arguments = [&["mesh", "sheet.obj", "-o", "a.pmesh", "--positions", "f32"][..], storage].concat();
        place.ok(&arguments);
        let info = json(&place.ok(&["info", "a.pmesh", "--json"]));
        assert_eq!(info["attributes"], serde_json::json!(["colours"]));
        place.ok(&["extract", "a.pmesh", "-o", "back.obj"]);
        assert_eq!(coloured_vertices(&place, "back.obj"), vertices, "{storage:?}");
        // By way of .ply, whose colours have alpha, and with the alpha that .obj leaves out and says so.
        place.ok(&["extract", "a.pmesh", "-o", "back.ply"]);
        place.ok(&["mesh", "back.ply", "-o", "b.pmesh", "--positions", "f32"]);
        let output = place.run(&["extract", "b.pmesh", "-o", "again.obj"]);
        assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
        assert_eq!(coloured_vertices(&place, "again.obj"), vertices, "{storage:?}");
        place.ok(&[&["mesh", "sheet.ply", "-o", "c.pmesh", "--positions", "f32"][..], storage].concat());
        let output = place.run(&["extract", "c.pmesh", "-o", "clear.obj"]);
        assert!(
            text(&output.stderr).contains("alpha is left out; .ply holds them"),
            "{}",
            text(&output.stderr)
        );
        assert_eq!(coloured_vertices(&place, "clear.obj"), vertices, "{storage:?}");
        place.ok(&["extract", "c.pmesh", "-o", "clear.ply"]);
        // 0.2 of 255, in the four bytes of one vertex.
        let [r, g, b] = colour(5).map(|channel| (channel * 255.0).round() as u8);
        assert!(place.read("clear.ply").windows(4).any(|bytes| bytes == [r, g, b, 51]), "{storage:?}");
    }
}

#[test]
fn a_vertex_of_two_colours_is_two_wedges() {
    let place = Workplace::new();
    // Two triangles with a common edge, red and blue.
    let red = "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\n";
    let blue = "v 1 0 0 0 0 1\nv 1 1 0 0 0 1\nv 0 1 0 0 0 1\n";
    place.write("flag.obj", format!("{red}{blue}f 1 2 3\nf 4 5 6\n").as_bytes());
    let report = json(&place.ok(&["mesh", "flag.obj", "-o", "flag.pmesh", "--json"]));
    assert_eq!((report["vertices"].as_u64(), report["wedges"].as_u64()), (Some(4), Some(6)), "{report}");
    let output = place.run(&["extract", "flag.pmesh", "-o", "back.obj"]);
    let said = text(&output.stderr);
    assert!(said.contains("of the colours of 2 vertices the first is written; .ply holds them"), "{said}");
    place.ok(&["extract", "flag.pmesh", "-o", "back.ply"]);
    let again = json(&place.ok(&["mesh", "back.ply", "-o", "again.pmesh", "--json"]));
    assert_eq!((again["vertices"].as_u64(), again["wedges"].as_u64()), (Some(4), Some(6)), "{again}");
}

#[test]
fn a_level_is_chosen_by_vertices_by_faces_or_by_error() {
    let place = Workplace::new();
    place.write("sheet.obj", sheet(30).as_bytes());
    place.ok(&["mesh", "sheet.obj", "-o", "sheet.pmesh", "--packet", "50"]);
    let extract = |options: &[&str]| {
        let said = text(&place.ok(&[&["extract", "sheet.pmesh", "-o", "level.obj"], options].concat()));
        let (_, error) = said.split_once("error at most ").expect("the error");
        let error: f32 = error.split(' ').next().and_then(|e| e.parse().ok()).expect("a number");
        (lines(&place, "level.obj", "v "), lines(&place, "level.obj", "f "), error)
    };
    assert_eq!(extract(&["--level", "500"]).0, 500);
    let (vertices, faces, error) = extract(&["--faces", "600"]);
    assert!(faces <= 600 && error > 0.0, "{faces} faces");
    let next = (vertices + 1).to_string();
    assert!(extract(&["--level", &next]).1 > 600, "a finer level has more faces than asked for");
    let half = error / 2.0;
    let (finer, _, stored) = extract(&["--error", &half.to_string()]);
    assert!(finer > vertices && stored <= half, "{finer} vertices, error {stored}");
    let coarser = (finer - 1).to_string();
    assert!(extract(&["--level", &coarser]).2 > half, "a coarser level has a greater error than asked for");
    assert_eq!(extract(&["--error", "1e-30"]).0, 900, "the finest level has no error");
    for (options, status) in
        [(&["--level", "5", "--faces", "5"][..], 2), (&["--error", "-1"], 2), (&["--level", "901"], 1)]
    {
        let output = place.run(&[&["extract", "sheet.pmesh", "-o", "bad.obj"], options].concat());
        assert_eq!(output.status.code(), Some(status), "{options:?}");
        assert!(!place.path().join("bad.obj").exists());
    }
}

#[test]
fn a_level_inside_a_coded_packet_is_written_with_a_note() {
    let place = Workplace::new();
    place.write("sheet.obj", sheet(30).as_bytes());
    for (mode, levels) in
        [("coded", [("500", false), ("510", true)]), ("raw", [("500", false), ("510", false)])]
    {
        place.ok(&["mesh", "sheet.obj", "-o", "sheet.pmesh", "--packet", "50", "--mode", mode]);
        for (level, noted) in levels {
            let output = place.run(&["extract", "sheet.pmesh", "-o", "level.obj", "--level", level]);
            assert!(output.status.success());
            assert_eq!(lines(&place, "level.obj", "v ").to_string(), level);
            let said = text(&output.stderr);
            assert_eq!(said.contains("levels 500 and 550 are whole"), noted, "{mode}, level {level}: {said}");
        }
        // By a stored error nothing is said.
        let output = place.run(&["extract", "sheet.pmesh", "-o", "level.obj", "--error", "1"]);
        assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
    }
}

#[test]
fn info_tells_how_a_mesh_is_stored() {
    let place = Workplace::new();
    place.write("sheet.obj", sheet(30).as_bytes());
    let storage = ["--mode", "raw", "--positions", "f32", "--packet", "300"];
    place.ok(&[&["mesh", "sheet.obj", "-o", "sheet.pmesh"][..], &storage].concat());
    let report = json(&place.ok(&["info", "sheet.pmesh", "--json"]));
    assert_eq!((&report["mode"], &report["positions"]), (&"raw".into(), &"f32".into()));
    assert_eq!(report["position_error_m"].as_f64(), Some(0.0));
    let parts = report["parts"].as_array().expect("a list");
    let names: Vec<&str> = parts.iter().map(|part| part["part"].as_str().expect("a name")).collect();
    let [header, names, first, second, third, end] = names[..] else { panic!("{names:?}") };
    assert_eq!((header, names, end), ("header, directory", "chunk MTRL", "end"));
    for (name, start) in [
        (first, "packet 0: levels to 300, error "),
        (second, "packet 1: levels to 600, error "),
        (third, "packet 2: levels to 900, error "),
    ] {
        assert!(name.starts_with(start) && name.ends_with(" m"), "{name}");
    }
    let bytes: u64 = parts.iter().map(|part| part["bytes"].as_u64().expect("bytes")).sum();
    assert_eq!(report["file_bytes"].as_u64(), Some(bytes));
    let shown = text(&place.ok(&["info", "sheet.pmesh"]));
    assert!(shown.contains(&format!("bits_per_vertex      {}", report["bits_per_vertex"])), "{shown}");
}

#[test]
fn a_picture_takes_levels_as_coarse_as_its_pixels_allow() {
    let place = Workplace::new();
    let light = "usemtl light\nv 10 10 60\nv 20 10 60\nv 10 20 60\nf 901 903 902\n";
    place.write("room.mtl", support::ROOM_MTL.as_bytes());
    let scene = format!("mtllib room.mtl\nusemtl white\n{}o lamp\n{light}", sheet(30));
    place.write("sheet.obj", scene.as_bytes());
    place.ok(&[
        "pack",
        "sheet.obj",
        "-o",
        "scene",
        "--photons",
        "2000",
        "--grid",
        "3x3x3",
        "--coarse-vertices",
        "50",
    ]);
    let triangles = |options: &[&str]| {
        let picture = ["render", "scene", "-o", "picture.png", "--renderer", "cpu", "--size", "64x48"];
        let said = text(&place.ok(&[&picture[..], options].concat()));
        let words: Vec<&str> = said.split_whitespace().collect();
        let at = words.iter().position(|word| *word == "triangles,").expect("the number of triangles");
        words[at - 1].parse::<usize>().expect("a number")
    };
    let [all, fine, coarse] = [&[][..], &["--pixel-error", "0.4"], &["--pixel-error", "8"]].map(triangles);
    assert!(all > fine && fine > coarse, "{all}, {fine}, {coarse}");
    let output = place.run(&["render", "sheet.obj", "-o", "bad.png", "--pixel-error", "1"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("packed scenes"), "{}", text(&output.stderr));
}

#[test]
fn a_mesh_is_coded_unless_told_otherwise_and_says_what_is_rounded() {
    let place = Workplace::new();
    place.write("cube.obj", cube().as_bytes());
    place.write("sheet.obj", sheet(30).as_bytes());
    let report = |mesh: &str, options: &[&str]| {
        let out = format!("{mesh}.pmesh");
        let report =
            json(&place.ok(&[&["mesh", &format!("{mesh}.obj"), "-o", &out, "--json"], options].concat()));
        place.ok(&["check", &out]);
        report
    };
    let said = |report: &Value| (report["mode"].clone(), report["positions"].clone());
    let coded = report("sheet", &[]);
    assert_eq!(said(&coded), ("coded".into(), "q14".into()));
    // 29 m wide in 2^14 - 1 steps.
    let error = coded["position_error_m"].as_f64().expect("a number");
    assert!((error - 29.0 / 16383.0 / 2.0).abs() < 1e-9, "{error}");
    let raw = report("sheet", &["--mode", "raw", "--positions", "f32"]);
    assert!(2 * coded["bytes"].as_u64().unwrap() < raw["bytes"].as_u64().unwrap(), "{coded} {raw}");
    let cube = report("cube", &[]);
    assert_eq!(said(&cube), ("coded".into(), "q14".into()));
    let bounds = |report: &Value| {
        ["position_error_m", "normal_error_degrees", "uv_error"]
            .map(|key| report[key].as_f64().expect("a number"))
    };
    assert!(bounds(&cube).iter().all(|&bound| bound > 0.0), "{cube}");
    assert_eq!(bounds(&json(&place.ok(&["info", "cube.pmesh", "--json"]))), bounds(&cube));
    let shown = text(&place.ok(&["mesh", "cube.obj", "-o", "cube.pmesh"]));
    assert!(shown.contains("degrees in a normal") && shown.contains("--mode raw --positions f32"), "{shown}");
    let finer = report("cube", &["--normal-bits", "16", "--uv-bits", "16"]);
    assert!(bounds(&finer)[1] < bounds(&cube)[1] / 60.0 && bounds(&finer)[2] < bounds(&cube)[2] / 10.0);
    let exact = report("cube", &["--mode", "raw", "--positions", "f32"]);
    assert_eq!(bounds(&exact), [0.0; 3]);
    let shown =
        text(&place.ok(&["mesh", "cube.obj", "-o", "cube.pmesh", "--mode", "raw", "--positions", "f32"]));
    assert!(shown.contains("\nnothing is rounded\n"), "{shown}");

    // Exact positions come back as they were, whichever way they were stored.
    let exact = |mode: &str| {
        report("sheet", &["--mode", mode, "--positions", "f32"]);
        place.ok(&["extract", "sheet.pmesh", "-o", "out.obj"]);
        let obj = text(&place.read("out.obj"));
        let mut lines: Vec<String> = obj.lines().filter(|l| l.starts_with("v ")).map(String::from).collect();
        lines.sort();
        lines
    };
    assert_eq!(exact("coded"), exact("raw"));
}

/// Needs an adapter, as the tests of the renderer do, and fails without one.
#[cfg(feature = "gpu")]
#[test]
fn the_demo_uploads_to_a_gpu_what_each_picture_adds() {
    let place = Workplace::new();
    let light = "usemtl light\nv 10 10 60\nv 20 10 60\nv 10 20 60\nf 901 903 902\n";
    place.write("room.mtl", support::ROOM_MTL.as_bytes());
    let scene = format!("mtllib room.mtl\nusemtl white\n{}o lamp\n{light}", sheet(30));
    place.write("sheet.obj", scene.as_bytes());
    let demo = |renderer: &str| {
        let arguments = ["demo", "--scene", "sheet.obj", "--renderer", renderer, "--size", "64x48"];
        place.ok(&[&arguments[..], &["--photons", "2000", "--grid", "3x3x3", "--out", "out"]].concat());
        let report = json(&place.read("out/demo.json"));
        let pictures = report["pictures"].as_array().expect("a list").clone();
        let of = |key: &str| pictures.iter().map(|picture| picture[key].as_u64()).collect::<Vec<_>>();
        (of("vertices_drawn"), of("uploaded_mesh_bytes"))
    };
    let (on_cpu, nothing) = demo("cpu");
    assert_eq!(nothing, [None; 4]);
    let (on_gpu, uploaded) = demo("gpu");
    assert_eq!(on_gpu, on_cpu);
    let [Some(first), Some(same), Some(more), Some(all)] = uploaded[..] else { panic!("{uploaded:?}") };
    assert!(on_gpu[0] == on_gpu[1] && on_gpu[2] < on_gpu[3], "{on_gpu:?}");
    assert_eq!(same, 0, "the second picture shows the same level");
    // Position and normal of 24 bytes a vertex, three corners of 4 bytes a face, of which there are not quite two a vertex.
    let [coarse, fine] = [0, 3].map(|k| on_gpu[k].expect("vertices"));
    assert!(first <= 48 * coarse && more <= 48 * on_gpu[2].expect("vertices"), "{uploaded:?}");
    assert!(all > 24 * (fine - on_gpu[2].expect("vertices")) && all <= 48 * fine, "{uploaded:?}");
}

#[test]
fn weights_of_attributes_count_in_the_stored_errors() {
    let place = Workplace::new();
    // A flat sheet whose texture bends along x: without a weight no collapse costs anything; with one the eight columns, two
    // vertices each, do.
    let mut obj = String::new();
    for k in 0..64u32 {
        let (x, y) = (k % 8, k / 8);
        obj += &format!("v {x} {y} 0\nvt {} {}\n", f64::from(x * x) / 49.0, f64::from(y) / 7.0);
    }
    for k in 0..49 {
        let a = k / 7 * 8 + k % 7 + 1;
        let [a, b, c, d] = [a, a + 1, a + 9, a + 8].map(|v| format!("{v}/{v}"));
        obj += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
    }
    place.write("flat.obj", obj.as_bytes());
    let error = |weight: &str| {
        place.ok(&["mesh", "flat.obj", "-o", "flat.pmesh", "--uv-weight", weight, "--packet", "10"]);
        let report = json(&place.ok(&["info", "flat.pmesh", "--json"]));
        let packets = report["parts"].as_array().expect("a list").iter();
        let name =
            packets.map(|part| part["part"].as_str().expect("a name")).find(|n| n.starts_with("packet 1:"));
        let words: Vec<&str> = name.expect("a packet").split(' ').collect();
        words[words.len() - 2].parse::<f64>().expect("an error in metres")
    };
    let (without, with) = (error("0"), error("1"));
    assert!(with > 100.0 * without && with > 1e-4, "{without} and {with}");
    let output = place.run(&["mesh", "flat.obj", "-o", "bad.pmesh", "--uv-weight", "-1"]);
    assert_eq!(output.status.code(), Some(2));
}
