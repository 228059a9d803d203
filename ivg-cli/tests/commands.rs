//! The commands as a user meets them: exit status, output, files.

#[allow(dead_code, reason = "shared with the other tests, which use other parts")]
mod support;

use std::fs;

use support::{ROOM_MTL, ROOM_OBJ, Workplace, text};

/// A bake that takes a moment.
const SMALL: [&str; 4] = ["--grid", "5x4x3", "--photons", "3000"];

#[test]
fn a_bake_is_the_same_for_any_number_of_threads_and_checks_as_ok() {
    let place = Workplace::with_room();
    let bake = |out: &str, threads: &str| {
        place.ok(&[&["bake", "room.obj", "-o", out, "--threads", threads][..], &SMALL].concat());
        place.read(out)
    };
    let one = bake("one.ivg", "1");
    assert_eq!(one, bake("two.ivg", "2"));
    assert_eq!(one, bake("five.ivg", "5"));
    let other_seed = [&["bake", "room.obj", "-o", "seed.ivg", "--seed", "7"][..], &SMALL].concat();
    place.ok(&other_seed);
    assert_ne!(one, place.read("seed.ivg"), "the seed counts");
    assert!(text(&place.ok(&["check", "one.ivg"])).contains(": ok: "));
}

#[test]
fn check_exits_by_verdict() {
    let place = Workplace::with_room();
    place.ok(&[&["bake", "room.obj", "-o", "light.ivg"][..], &SMALL].concat());
    place.ok(&["mesh", "room.obj", "-o", "room.pmesh"]);
    for file in ["light.ivg", "room.pmesh"] {
        let bytes = place.read(file);
        let status = |name: &str, bytes: &[u8]| {
            let name = format!("{name}-{file}");
            place.write(&name, bytes);
            let output = place.run(&["check", &name, "--json"]);
            let report = text(&output.stdout);
            assert!(report.contains("\"offset\":") && report.contains("\"warnings\":[]"), "{report}");
            output.status.code()
        };
        assert_eq!(status("whole", &bytes), Some(0));
        assert_eq!(status("cut", &bytes[..bytes.len() / 2]), Some(40));
        assert_eq!(status("empty", &[]), Some(40));
        let mut flipped = bytes.clone();
        let last = flipped.len() - 30;
        flipped[last] ^= 0x10;
        assert_eq!(status("flipped", &flipped), Some(41));
        assert_eq!(status("longer", &[&bytes[..], b"x"].concat()), Some(41));
        let mut newer = bytes.clone();
        newer[8] = 9;
        assert_eq!(status("newer", &newer), Some(42));
    }
    assert_eq!(place.run(&["check", "no-such.ivg"]).status.code(), Some(1));
    assert_eq!(place.run(&["check"]).status.code(), Some(2));
}

#[test]
fn info_tells_the_layout_of_a_file_with_damaged_records() {
    let place = Workplace::with_room();
    place.ok(&[&["bake", "room.obj", "-o", "light.ivg"][..], &SMALL].concat());
    place.ok(&["mesh", "room.obj", "-o", "room.pmesh"]);
    for (file, unread) in [("light.ivg", "records"), ("room.pmesh", "packets")] {
        let bytes = place.read(file);
        let whole = text(&place.ok(&["info", file]));
        assert!(
            whole.contains(&format!("The {unread} are not verified; ivg check verifies them.")),
            "{whole}"
        );
        let report: serde_json::Value =
            serde_json::from_slice(&place.ok(&["info", file, "--json"])).expect("JSON");
        assert_eq!(report[format!("{unread}_verified")], false);
        let first = report["prefix_bytes"].as_u64().expect("a number") as usize;
        // In the first record, in the last, in the end record.
        for at in [first + 20, bytes.len() - 60, bytes.len() - 2] {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1;
            place.write(file, &damaged);
            assert_eq!(text(&place.ok(&["info", file])), whole, "{file} at {at}");
            assert_eq!(place.run(&["check", file]).status.code(), Some(41));
        }
        let mut damaged = bytes.clone();
        damaged[first - 3] ^= 1;
        place.write(file, &damaged);
        assert_eq!(
            place.run(&["info", file]).status.code(),
            Some(1),
            "{file}: header and chunks are verified"
        );
    }
}

#[test]
fn extract_writes_nan_where_nothing_is_known_and_numbers_when_filled() {
    let place = Workplace::with_room();
    let bake = ["bake", "room.obj", "-o", "light.ivg", "--encoding", "vectors-f32", "--per-slice", "1"];
    place.ok(&[&bake[..], &SMALL].concat());
    let half = (place.read("light.ivg").len() / 2).to_string();
    place.ok(&["extract", "light.ivg", "-o", "half.npy", "--bytes", &half]);
    place.ok(&["extract", "light.ivg", "-o", "filled.npy", "--bytes", &half, "--fill"]);
    let numbers = |name: &str| {
        let bytes = place.read(name);
        let data = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        assert!(text(&bytes[..data]).contains("'shape': (3, 4, 5, 6, 3, 3,)"));
        bytes[data..]
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            .collect::<Vec<f32>>()
    };
    let (half, filled) = (numbers("half.npy"), numbers("filled.npy"));
    assert_eq!(half.len(), 60 * 54);
    let known = half.iter().filter(|v| v.is_finite()).count();
    assert!(known >= 54 && known < half.len(), "{known} numbers known");
    assert!(filled.iter().all(|v| v.is_finite()));
    let same = half.iter().zip(&filled).filter(|(h, _)| h.is_finite()).all(|(h, f)| h == f);
    assert!(same, "filling leaves what is known as it is");
}

#[test]
fn sample_appends_irradiance_to_its_points() {
    let place = Workplace::with_room();
    place.ok(&[&["bake", "room.obj", "-o", "light.ivg"][..], &SMALL].concat());
    place.write("points.csv", b"x,y,z,nx,ny,nz\n0.5,0.4,0.5,0,1,0\n0.5,0.4,0.5,0,0,-1\n");
    let output = text(&place.ok(&["sample", "light.ivg", "--points", "points.csv"]));
    let lines: Vec<&str> = output.lines().collect();
    assert_eq!(lines[0], "x,y,z,nx,ny,nz,r,g,b");
    assert_eq!(lines.len(), 3);
    let up: Vec<f64> = lines[1].split(',').map(|cell| cell.parse().expect("a number")).collect();
    assert_eq!(&up[..6], &[0.5, 0.4, 0.5, 0.0, 1.0, 0.0]);
    assert!(up[6..].iter().all(|&e| e > 0.0), "the room reflects light: {up:?}");
    for (bad, named) in [
        ("x,y,z\n0,0,0\n", "x,y,z,nx,ny,nz"),
        ("x,y,z,nx,ny,nz\n0,0,0,0,0,0\n", "line 2, columns nx,ny,nz"),
        ("x,y,z,nx,ny,nz\n0,0,0,0,1,0\n0,0,nan,0,1,0\n", "line 3, column z"),
    ] {
        place.write("bad.csv", bad.as_bytes());
        let output = place.run(&["sample", "light.ivg", "--points", "bad.csv"]);
        assert_eq!(output.status.code(), Some(1));
        assert!(output.stdout.is_empty(), "nothing is printed before the input is known to be right");
        assert!(text(&output.stderr).contains(named), "{}", text(&output.stderr));
    }
}

#[test]
fn a_mesh_has_as_many_vertices_as_its_level() {
    let place = Workplace::with_room();
    place.ok(&["mesh", "room.obj", "-o", "room.pmesh"]);
    for level in ["5", "8"] {
        place.ok(&["extract", "room.pmesh", "-o", "level.obj", "--level", level]);
        let obj = text(&place.read("level.obj"));
        let vertices = obj.lines().filter(|line| line.starts_with("v ")).count();
        assert_eq!(vertices.to_string(), level);
    }
    let output = place.run(&["extract", "room.pmesh", "-o", "level.obj", "--level", "4000"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("level 4000 is not there"));
}

#[test]
fn a_failure_is_one_line_and_leaves_no_file() {
    let place = Workplace::new();
    place.write("dark.obj", ROOM_OBJ.replace("usemtl light", "usemtl white").as_bytes());
    place.write("room.mtl", ROOM_MTL.as_bytes());
    let output = place.run(&[&["bake", "dark.obj", "-o", "light.ivg"][..], &SMALL].concat());
    assert_eq!(output.status.code(), Some(1));
    let message = text(&output.stderr);
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(message.contains("--lights"), "{message}");
    let left: Vec<_> =
        fs::read_dir(place.path()).expect("the folder").flatten().map(|e| e.file_name()).collect();
    assert_eq!(left.len(), 2, "{left:?}");

    let output = place.run(&["bake", "dark.obj", "-o", "light.ivg", "--grid", "0x1x1"]);
    assert_eq!(output.status.code(), Some(2), "a usage error");
    let output = place.run(&["bake", "dark.obj", "-o", "light.ivg", "--photons", "0"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("must be at least 1"), "{}", text(&output.stderr));
}

/// Linux's device that is always full stands for a disk that is.
#[cfg(target_os = "linux")]
#[test]
fn output_that_cannot_be_written_is_an_error() {
    let place = Workplace::with_room();
    place.ok(&[&["bake", "room.obj", "-o", "light.ivg"][..], &SMALL].concat());
    place.write("points.csv", b"x,y,z,nx,ny,nz\n0.5,0.4,0.5,0,1,0\n");
    let commands: [&[&str]; 5] = [
        &["sample", "light.ivg", "--points", "points.csv"],
        &["info", "light.ivg"],
        &["check", "light.ivg", "--json"],
        &["extract", "light.ivg", "-o", "light.npy"],
        &["--help"],
    ];
    for arguments in commands {
        let output = place.run_to(arguments, fs::File::create("/dev/full").expect("the device").into());
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        let message = text(&output.stderr);
        assert!(message.starts_with("ivg: stdout: ") && message.lines().count() == 1, "{message}");
        // A reader that has seen enough is none.
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let output = place.run_to(arguments, writer.into());
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
    }
}

#[test]
fn plan_names_what_a_scene_needs() {
    let place = Workplace::with_room();
    let report = text(&place.ok(&["plan", "room.obj", "--photons", "20000", "--json"]));
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    let need = |name: &str| {
        let effects = report["effects"].as_array().expect("a list");
        effects.iter().find(|e| e["effect"] == name).unwrap_or_else(|| panic!("{name}: {report}"))["need"]
            .clone()
    };
    assert_eq!(need("diffuse indirect light"), "needed");
    assert_eq!(need("textures"), "not needed");
    assert!(report["max_bounces"].as_u64().is_some_and(|bounces| bounces > 0));
}

#[test]
fn a_packed_scene_is_served_fetched_and_drawn() {
    let place = Workplace::with_room();
    place.ok(&[&["pack", "room.obj", "-o", "scene", "--coarse-vertices", "6"][..], &SMALL].concat());
    let server = place.serve("scene");
    let log = text(&place.ok(&["fetch", &server.url, "--json"]));
    let last: serde_json::Value = serde_json::from_str(log.lines().last().expect("a line")).expect("JSON");
    assert_eq!((last["geometry"].as_f64(), last["light"].as_f64()), (Some(1.0), Some(1.0)));
    let picture = ["--size", "40x30", "--renderer", "cpu", "--exposure", "1"];
    place.ok(&[&["render", &server.url, "-o", "fetched.png"][..], &picture].concat());
    place.ok(&[&["render", "scene", "-o", "local.png"][..], &picture].concat());
    assert_eq!(place.read("fetched.png"), place.read("local.png"), "the network changes nothing");
    place.ok(&[&["render", "scene", "-o", "direct.png", "--indirect", "none"][..], &picture].concat());
    assert_ne!(place.read("direct.png"), place.read("local.png"), "indirect light shows");
}

#[test]
fn light_gathered_from_the_grid_is_near_to_path_traced_light() {
    let place = Workplace::with_room();
    place.ok(&["bake", "room.obj", "-o", "light.ivg", "--grid", "6x6x6", "--photons", "100000"]);
    let mean = |indirect: &str| {
        let options = ["--ivg", "light.ivg", "--size", "32x24", "--exposure", "1", "--samples", "64"];
        let command = ["render", "room.obj", "-o", "picture.png", "--indirect", indirect];
        let said = text(&place.ok(&[&command[..], &options].concat()));
        assert_eq!(said.contains("gathering from the grid"), indirect == "gather", "{said}");
        let picture = image::load_from_memory(&place.read("picture.png")).expect("a PNG file").to_rgb8();
        picture.as_raw().iter().map(|&code| f64::from(code)).sum::<f64>() / picture.as_raw().len() as f64
    };
    let [gathered, traced, direct] = ["gather", "path", "none"].map(mean);
    // Of 49,152 paths the mean is right to 1 %, the bake to 3 %; codes go with less than the square root of the light.
    assert!((gathered / traced - 1.0).abs() < 0.03, "{gathered} for {traced}");
    assert!(direct < 0.8 * traced, "{direct}: indirect light shows");
}
