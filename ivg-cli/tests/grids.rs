//! Commands that make and read grids, as a user meets them: every encoding and order.

#[allow(dead_code, reason = "shared with the other tests, which use other parts")]
mod support;

use ivg_format::{
    EncodeOptions, Encoding, Event, GridSource, Lattice, Limits, Order, RecordId, decode_record,
};
use serde_json::Value;
use support::{Workplace, text};

/// A bake that takes a moment.
const SMALL: [&str; 4] = ["--grid", "5x4x3", "--photons", "3000"];

/// Every encoding, with its bytes a vertex.
const ENCODINGS: [(&str, u64); 7] = [
    ("packed-oct24", 42),
    ("packed-xyz24", 42),
    ("pair-f16", 72),
    ("pair-f16x4", 96),
    ("pair-f32", 144),
    ("vectors-f32", 216),
    ("sh2-28", 28),
];

const ORDERS: [&str; 3] = ["slices", "octree", "explicit"];

const POINTS: &str = "x,y,z,nx,ny,nz\n0.5,0.4,0.5,0,1,0\n0.2,0.6,0.5,0.6,-0.8,0\n0.7,0.3,0.4,0,0,-1\n";

fn bake(place: &Workplace, out: &str, more: &[&str]) {
    place.ok(&[&["bake", "room.obj", "-o", out][..], &SMALL, more].concat());
}

fn json(bytes: &[u8]) -> Value {
    serde_json::from_str(&text(bytes)).unwrap_or_else(|error| panic!("{error}: {}", text(bytes)))
}

fn recode(place: &Workplace, from: &str, out: &str, more: &[&str]) -> Value {
    json(&place.ok(&[&["recode", from, "-o", out, "--json"][..], more].concat()))
}

/// The columns r,g,b of a sampled table.
fn sampled(place: &Workplace, file: &str, more: &[&str]) -> Vec<[f64; 3]> {
    place.write("points.csv", POINTS.as_bytes());
    let output = text(&place.ok(&[&["sample", file, "--points", "points.csv"][..], more].concat()));
    let row = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        [cells[6], cells[7], cells[8]]
    };
    output.lines().skip(1).map(row).collect()
}

/// The largest difference of two tables, as a share of the largest value.
fn difference(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let largest = b.as_flattened().iter().copied().fold(0.0, f64::max);
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
}

#[test]
fn bake_writes_every_encoding_in_every_order() {
    let place = Workplace::with_room();
    for (encoding, bytes) in ENCODINGS {
        for order in ORDERS {
            bake(&place, "light.ivg", &["--encoding", encoding, "--order", order, "--per-slice", "2"]);
            assert!(text(&place.ok(&["check", "light.ivg"])).contains(": ok: "), "{encoding} {order}");
            let info = json(&place.ok(&["info", "light.ivg", "--json"]));
            assert_eq!((&info["encoding"], &info["order"]), (&encoding.into(), &order.into()));
            assert_eq!(info["bytes_per_vertex"], bytes);
            let quantity = if encoding == "sh2-28" { "radiance harmonics" } else { "irradiance vectors" };
            assert_eq!(info["quantity"], quantity);
        }
    }
    let output = place.run(&["bake", "room.obj", "-o", "light.ivg", "--encoding", "sh2"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).contains("sh2-28"),
        "the message names what there is: {}",
        text(&output.stderr)
    );
}

#[test]
fn only_track_lengths_give_radiance() {
    let place = Workplace::with_room();
    let output = place.run(
        &[
            &["bake", "room.obj", "-o", "a.ivg", "--encoding", "sh2-28", "--estimator", "face-crossing"][..],
            &SMALL,
        ]
        .concat(),
    );
    assert_eq!(output.status.code(), Some(2));
    let message = text(&output.stderr);
    assert!(message.contains("sh2-28") && message.contains("--estimator track-length"), "{message}");
}

#[test]
fn recode_changes_how_a_grid_is_stored_and_keeps_the_rest() {
    let place = Workplace::with_room();
    bake(&place, "exact.ivg", &["--encoding", "vectors-f32"]);
    let exact = sampled(&place, "exact.ivg", &["--reconstruction", "three"]);
    let before = json(&place.ok(&["info", "exact.ivg", "--json"]));
    // Rounding of one vector: 24-bit directions and 9-bit mantissas 1 %, 8-bit coordinates 1 %, half precision 0.1 %; three
    // channels that share a direction bend by more. See the table of ivg-format's encodings.
    for (encoding, _) in &ENCODINGS[..6] {
        for order in ORDERS {
            let more = ["--encoding", encoding, "--order", order, "--per-slice", "3", "--seed", "9"];
            let report = recode(&place, "exact.ivg", "out.ivg", &more);
            assert_eq!((&report["encoding"], &report["order"]), (&Value::from(*encoding), &order.into()));
            assert_eq!((&report["vertices_per_slice"], &report["seed"]), (&3.into(), &9.into()));
            assert_eq!(report["from"]["encoding"], "vectors-f32");
            let loss = report["values_relative_rmse"].as_f64().expect("a number");
            assert_eq!(report["lossy"], *encoding != "vectors-f32", "{encoding}: {loss}");
            assert!(
                if *encoding == "vectors-f32" { loss == 0.0 } else { loss > 0.0 && loss < 0.25 },
                "{loss}"
            );
            assert!(text(&place.ok(&["check", "out.ivg"])).contains(": ok: "), "{encoding} {order}");
            let after = json(&place.ok(&["info", "out.ivg", "--json"]));
            for kept in ["dims", "first_vertex", "step", "units", "lights", "metadata", "validity_records"] {
                assert_eq!(after[kept], before[kept], "{kept}");
            }
            if *encoding == "vectors-f32" {
                assert_eq!(sampled(&place, "out.ivg", &["--reconstruction", "three"]), exact, "{order}");
            }
        }
    }
}

#[test]
fn recode_to_the_same_encoding_loses_nothing_or_a_second_rounding() {
    let place = Workplace::with_room();
    for (encoding, _) in ENCODINGS {
        bake(&place, "light.ivg", &["--encoding", encoding]);
        // A file may be replaced by its own recoding.
        let report = recode(&place, "light.ivg", "light.ivg", &["--order", "octree", "--per-slice", "1"]);
        assert_eq!(report["order"], "octree");
        let loss = report["values_relative_rmse"].as_f64().expect("a number");
        // Vectors of a direction that is not of unit length as stored are packed anew: at most half a step in each of three
        // coordinates, of 1/127, 2^-11 or 2^-24.
        let most = match encoding {
            "packed-xyz24" => 3.0_f64.sqrt() / 254.0,
            "pair-f16" | "pair-f16x4" => 3.0_f64.sqrt() / 4096.0,
            "pair-f32" => 3.0_f64.sqrt() * f64::from(f32::EPSILON),
            _ => 0.0,
        };
        assert!(loss <= most, "{encoding}: {report}");
        assert_eq!(report["lossy"], loss > 0.0, "{encoding}");
        if most == 0.0 {
            // Without options the file stays what it is.
            recode(&place, "light.ivg", "again.ivg", &[]);
            assert_eq!(place.read("again.ivg"), place.read("light.ivg"), "{encoding}");
        }
    }
}

#[test]
fn recode_says_what_cannot_be_had_and_what_is_lost() {
    let place = Workplace::with_room();
    bake(&place, "vectors.ivg", &["--encoding", "vectors-f32"]);
    bake(&place, "sh.ivg", &["--encoding", "sh2-28"]);
    let output = place.run(&["recode", "vectors.ivg", "-o", "no.ivg", "--encoding", "sh2-28"]);
    assert_eq!(output.status.code(), Some(1));
    let message = text(&output.stderr);
    assert!(message.contains("ivg bake --encoding sh2-28") && message.lines().count() == 1, "{message}");
    assert!(!place.path().join("no.ivg").exists());

    let output = place.run(&["recode", "sh.ivg", "-o", "six.ivg", "--encoding", "vectors-f32", "--json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let message = text(&output.stderr);
    assert!(message.contains("lossy") && message.contains("radiance harmonics"), "{message}");
    assert!(message.contains("irradiance differs by") && !message.contains("numbers"), "{message}");
    let report = json(&output.stdout);
    assert!(report["values_relative_rmse"].is_null(), "nothing to compare: {report}");
    assert_eq!((&report["lossy"], &report["quantity_changed"]), (&true.into(), &true.into()));
    // Six exact vectors of radiance of degree 2 give the irradiance of its harmonics, but for rounding to f32.
    assert!(report["irradiance_relative_rmse"].as_f64().expect("a number") < 1e-5, "{report}");
    let (from_sh, from_six) = (sampled(&place, "sh.ivg", &[]), sampled(&place, "six.ivg", &[]));
    assert!(difference(&from_six, &from_sh) < 1e-5, "{from_six:?} {from_sh:?}");

    let output = place.run(&["recode", "vectors.ivg", "-o", "less.ivg", "--encoding", "packed-xyz24"]);
    let message = text(&output.stderr);
    assert!(
        message.contains("irradiance differs by") && message.contains(" %, stored numbers by"),
        "{message}"
    );
    let help = text(&place.ok(&["recode", "--help"]));
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(help.contains("what is lost is printed") && help.contains("into sh2-28: bake with it"), "{help}");

    let output = place.run(&["recode", "vectors.ivg", "-o", "same.ivg", "--order", "octree"]);
    assert!(output.status.success() && output.stderr.is_empty(), "nothing is lost: {}", text(&output.stderr));
    place.ok(&["mesh", "room.obj", "-o", "room.pmesh"]);
    let output = place.run(&["recode", "room.pmesh", "-o", "no.ivg"]);
    assert!(text(&output.stderr).contains("recode is for .ivg files"), "{}", text(&output.stderr));
    assert_eq!(place.run(&["recode", "sh.ivg", "-o", "sh.bin"]).status.code(), Some(2));
}

#[test]
fn the_explicit_order_lists_its_vertices_in_front() {
    let place = Workplace::with_room();
    // All vertices are inside the room, in free air.
    let bounds = ["--bounds", "0.1,0.1,0.1,0.9,0.9,0.9"];
    bake(&place, "light.ivg", &[&["--order", "explicit", "--per-slice", "1"][..], &bounds].concat());
    let info = json(&place.ok(&["info", "light.ivg", "--json"]));
    // 60 vertices less 8 corners, whose indices and gaps take a byte each.
    assert_eq!(info["index_bytes"], 52, "{info}");
    let parts = info["parts"].as_array().expect("parts");
    let number = |part: &Value, name: &str| part[name].as_u64().expect("a number");
    let mut end = 0;
    for part in parts {
        assert_eq!(number(part, "offset"), end, "parts follow each other: {info}");
        end += number(part, "bytes");
    }
    assert_eq!(info["file_bytes"], end);
    assert_eq!((&parts[0]["bytes"], &parts[1]["part"]), (&144.into(), &"chunk DIRE".into()));

    // An order that is not asked for stays.
    recode(&place, "light.ivg", "same.ivg", &[]);
    assert_eq!(place.read("same.ivg"), place.read("light.ivg"));
    recode(&place, "light.ivg", "exact.ivg", &["--encoding", "vectors-f32"]);
    recode(&place, "exact.ivg", "back.ivg", &["--encoding", "packed-oct24"]);
    assert_eq!(place.read("back.ivg"), place.read("light.ivg"));
}

#[test]
fn a_file_cut_short_is_sampled_only_if_filled() {
    let place = Workplace::with_room();
    place.write("points.csv", POINTS.as_bytes());
    for order in ORDERS {
        let bounds = ["--bounds", "0.1,0.1,0.1,0.9,0.9,0.9"];
        bake(&place, "light.ivg", &[&["--order", order, "--per-slice", "1"][..], &bounds].concat());
        let whole = place.read("light.ivg");
        place.write("part.ivg", &whole[..whole.len() - 100]);
        let output = place.run(&["sample", "part.ivg", "--points", "points.csv"]);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0));
        assert!(text(&output.stderr).contains("--fill"), "{}", text(&output.stderr));
        let output = place.run(&["sample", "part.ivg", "--points", "points.csv", "--fill"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(text(&output.stderr).contains("of 60 vertices"), "{}", text(&output.stderr));
        assert!(sampled(&place, "part.ivg", &["--fill"]).as_flattened().iter().any(|&value| value > 0.0));
        // Vertices inside geometry, which the order explicit leaves out, are not missing.
        bake(&place, "light.ivg", &["--order", order]);
        let output = place.run(&["sample", "light.ivg", "--points", "points.csv", "--fill"]);
        assert!(output.status.success() && !text(&output.stderr).contains("missing"), "{order}");
    }
}

#[test]
fn points_that_touch_no_light_are_counted() {
    // Light of 1 W/m² at the first vertex of four; the others are inside geometry.
    let lattice = Lattice::new([4, 1, 1], [0.0; 3], [3.0, 0.0, 0.0]).expect("a row");
    let mut vectors = [[[[0.0; 3]; 3]; 6]; 4];
    vectors[0] = [[[1.0, 0.0, 0.0]; 3]; 6];
    let mut source = GridSource::new(lattice, &vectors);
    source.validity = Some(&[255, 0, 0, 0]);
    let options = EncodeOptions { encoding: Encoding::VectorsF32, ..EncodeOptions::default() };
    let place = Workplace::new();
    place.write("row.ivg", &ivg_format::encode(&source, &options).expect("a grid"));
    // In front of the light, in its cell, facing away from it, at a vertex without, in a cell without, beyond the end.
    let points = ["0,0,0,1", "0.9,0,0,1", "0.5,0,0,-1", "1,0,0,1", "2.5,0,0,1", "9,0,0,1"]
        .map(|p| p.to_owned() + ",0,0\n");
    place.write("points.csv", format!("x,y,z,nx,ny,nz\n{}", points.concat()).as_bytes());
    // The wider filter brings light to the vertex beside the first.
    for (filter, unlit) in [("trilinear", 3), ("tricubic", 2)] {
        let sample = ["sample", "row.ivg", "--points", "points.csv", "--filter", filter];
        let output = place.run(&sample);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let message = text(&output.stderr);
        let warning =
            format!("{unlit} of 6 points touch only vertices without light; --fill gives those a value");
        assert!(message.contains(&warning), "{message}");
        let filled = place.run(&[&sample[..], &["--fill"]].concat());
        assert!(!text(&filled.stderr).contains("touch"), "{}", text(&filled.stderr));
        let lit = text(&filled.stdout).lines().skip(1).filter(|line| !line.ends_with(",0,0,0")).count();
        assert_eq!(lit, 5, "all but the one that faces away: {}", text(&filled.stdout));
    }
}

#[test]
fn filling_from_nothing_says_so() {
    let place = Workplace::with_room();
    bake(&place, "light.ivg", &[]);
    let prefix = json(&place.ok(&["info", "light.ivg", "--json"]))["prefix_bytes"].to_string();
    place.write("cut.ivg", &place.read("light.ivg")[..prefix.parse().expect("a number")]);
    place.write("points.csv", POINTS.as_bytes());
    let output = place.run(&["sample", "cut.ivg", "--points", "points.csv", "--fill"]);
    let message = text(&output.stderr);
    assert!(
        output.status.success() && message.contains("nothing has arrived: all values are 0"),
        "{message}"
    );
    assert!(!message.contains("filled"), "{message}");
    let message = text(&place.ok(&["extract", "cut.ivg", "-o", "cut.npy", "--fill"]));
    assert!(message.contains("nothing has arrived") && !message.contains("filled"), "{message}");
    let message = text(&place.ok(&["extract", "light.ivg", "-o", "cut.npy", "--fill"]));
    assert!(message.contains("gaps are filled"), "{message}");
}

#[test]
fn check_warns_of_vertices_that_come_twice_or_never() {
    let lattice = Lattice::new([9, 1, 1], [0.0; 3], [1.0; 3]).expect("a lattice");
    let vectors = [[[[1.0, 0.0, 0.0]; 3]; 6]; 9];
    let bundles: Vec<Vec<u64>> = (1..8).map(|vertex| vec![vertex]).collect();
    let mut source = GridSource::new(lattice, &vectors);
    source.bundles = Some(&bundles);
    let options =
        EncodeOptions { encoding: Encoding::VectorsF32, order: Order::Explicit, ..EncodeOptions::default() };
    let mut file = ivg_format::encode(&source, &options).expect("a grid");
    let place = Workplace::new();
    place.write("good.ivg", &file);
    assert!(!text(&place.ok(&["check", "good.ivg"])).contains("warning"));

    let (_, header) = ivg_grid::IrradianceGrid::from_file(&file, &Limits::default()).expect("a grid");
    let range = header.record_range(RecordId::Bundle(2));
    let record = &mut file[range.start as usize..range.end as usize];
    let Ok(Event::Bundle(bundle)) = decode_record(&header, RecordId::Bundle(2), record) else {
        panic!("a bundle")
    };
    assert_eq!(bundle.index(), [2]);
    let list = bundle.index().as_ptr().addr() - record.as_ptr().addr();
    record[list] = 1;
    ivg_wire::seal(record, header.content_id);
    place.write("bad.ivg", &file);
    let report = json(&place.ok(&["check", "bad.ivg", "--json"]));
    let warnings = report["warnings"].as_array().expect("warnings");
    let names = |words: &str| {
        let line = |warning: &Value| warning.as_str().is_some_and(|text| text.contains(words));
        warnings.iter().any(line)
    };
    assert!(names("vertex 2 is in no bundle"), "{report}");
    assert!(names("vertex 1 is in more than one bundle"), "{report}");

    // Recoding mends it: the vertex that never came is not dark afterwards.
    let output = place.run(&["recode", "bad.ivg", "-o", "mended.ivg", "--order", "slices"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("in no bundle"), "{}", text(&output.stderr));
    place.write("points.csv", b"x,y,z,nx,ny,nz\n0.25,0,0,1,0,0\n");
    let table = text(&place.ok(&["sample", "mended.ivg", "--points", "points.csv"]));
    assert!(table.ends_with("1,0,0,1,1,1\n"), "light of 1 W/m² everywhere: {table}");
}

#[test]
fn sample_reads_every_encoding() {
    let place = Workplace::with_room();
    bake(&place, "exact.ivg", &["--encoding", "vectors-f32"]);
    let exact = sampled(&place, "exact.ivg", &[]);
    assert_eq!(exact, sampled(&place, "exact.ivg", &["--reconstruction", "six"]), "auto is six here");
    for (encoding, _) in ENCODINGS {
        bake(&place, "light.ivg", &["--encoding", encoding]);
        let auto = sampled(&place, "light.ivg", &[]);
        let (named, other) = match encoding {
            "vectors-f32" => ("six", "sh2"),
            "sh2-28" => ("sh2", "three"),
            _ => ("three", "sh2"),
        };
        assert_eq!(auto, sampled(&place, "light.ivg", &["--reconstruction", named]), "{encoding}");
        // Reconstructions and roundings of the same light: a fifth at most at these points, where n2 is off by a quarter.
        assert!(difference(&auto, &exact) < 0.2, "{encoding}: {auto:?} {exact:?}");
        let output = place.run(&["sample", "light.ivg", "--points", "points.csv", "--reconstruction", other]);
        assert_eq!(output.status.code(), Some(2));
        let message = text(&output.stderr);
        assert!(message.contains(encoding) && message.contains(named), "{message}");
        let smooth = sampled(&place, "light.ivg", &["--filter", "tricubic"]);
        assert_ne!(smooth, auto, "{encoding}");
    }
}

#[test]
fn sample_answers_outside_the_grid_and_says_so() {
    let place = Workplace::with_room();
    bake(&place, "light.ivg", &["--bounds", "0.1,0.1,0.1,0.9,0.9,0.9"]);
    let rows = "id,nx,ny,nz,x,y,z\nin,0,2,0,0.9,0.5,0.5\nout,0,1,0,0.95,0.5,0.5\n";
    place.write("points.csv", rows.as_bytes());
    let output = place.run(&["sample", "light.ivg", "--at", "points.csv", "-o", "out.csv"]);
    assert!(output.status.success() && output.stdout.is_empty(), "{}", text(&output.stderr));
    let message = text(&output.stderr);
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(message.contains("1 of 2 points"), "{message}");
    let table = text(&place.read("out.csv"));
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines[0], "id,nx,ny,nz,x,y,z,r,g,b");
    let results = |line: &str| line.split(',').skip(7).map(str::to_owned).collect::<Vec<_>>();
    assert!(lines[1].starts_with("in,0,2,0,0.9,0.5,0.5,") && lines[2].starts_with("out,"));
    assert_eq!(
        results(lines[1]),
        results(lines[2]),
        "the nearest point of the box answers, for normals of any length"
    );
}

#[test]
fn points_come_from_stdin_too() {
    let place = Workplace::with_room();
    bake(&place, "light.ivg", &[]);
    place.write("points.csv", POINTS.as_bytes());
    let from_file = place.run(&["sample", "light.ivg", "--points", "points.csv"]);
    let piped = place.run_with(&["sample", "light.ivg", "--points", "-"], POINTS.as_bytes());
    assert!(piped.status.success(), "{}", text(&piped.stderr));
    assert_eq!(piped.stdout, from_file.stdout);
    let refused = place.run_with(&["sample", "light.ivg", "--points", "-"], b"x\n");
    assert!(text(&refused.stderr).starts_with("ivg: stdin: line 1"), "{}", text(&refused.stderr));
}

#[test]
fn a_grid_of_radiance_is_extracted_packed_and_drawn() {
    let place = Workplace::with_room();
    bake(&place, "sh.ivg", &["--encoding", "sh2-28"]);
    place.ok(&["extract", "sh.ivg", "-o", "sh.npy"]);
    let array = place.read("sh.npy");
    let data = 10 + usize::from(u16::from_le_bytes([array[8], array[9]]));
    assert!(text(&array[..data]).contains("'shape': (3, 4, 5, 3, 9,)"));
    assert_eq!(array.len() - data, 60 * 27 * 4);

    let picture = ["--size", "40x30", "--renderer", "cpu", "--exposure", "1"];
    let render = |source: &[&str], out: &str| {
        place.ok(&[&["render"][..], source, &["-o", out], &picture].concat());
        place.read(out)
    };
    let pack = [&["pack", "room.obj", "-o", "scene", "--encoding", "sh2-28"][..], &SMALL].concat();
    place.ok(&pack);
    let packed = render(&["scene"], "packed.png");
    assert_eq!(
        packed,
        render(&["room.obj", "--ivg", "sh.ivg"], "file.png"),
        "the same grid, the same picture"
    );
    assert_ne!(packed, render(&["scene", "--indirect", "none"], "direct.png"), "indirect light shows");
    let baked = [&["room.obj", "--encoding", "sh2-28"][..], &SMALL].concat();
    assert_ne!(render(&baked, "baked.png"), render(&["scene", "--indirect", "none"], "direct.png"));
}
