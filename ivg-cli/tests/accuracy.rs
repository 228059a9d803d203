//! Bakes to an accuracy or a time, and by path tracing alone, as a user meets them.

#[allow(dead_code, reason = "shared with the other tests, which use other parts")]
mod support;

use serde_json::Value;
use support::{Workplace, text};

fn json(bytes: &[u8]) -> Value {
    serde_json::from_str(&text(bytes)).unwrap_or_else(|error| panic!("{error}: {}", text(bytes)))
}

fn bake(place: &Workplace, out: &str, more: &[&str]) -> Value {
    let common = ["bake", "room.obj", "-o", out, "--grid", "5x4x4", "--bounds", "0.1,0.1,0.1,0.9,0.9,0.9"];
    json(&place.ok(&[&common[..], more, &["--json"]].concat()))
}

#[test]
fn a_bake_to_an_accuracy_says_what_it_reached_and_threads_do_not_matter() {
    let place = Workplace::with_room();
    let report = bake(&place, "one.ivg", &["--accuracy", "8%", "--threads", "1"]);
    let accuracy = &report["accuracy"];
    assert_eq!(accuracy["ended_by"], "accuracy", "{report}");
    let reached = accuracy["reached"].as_f64().expect("a number");
    assert!(reached > 0.0 && reached <= 0.08 && accuracy["confidence"] == 0.95, "{report}");
    let stages: Vec<_> = report["stages"].as_array().expect("a list").iter().map(|s| &s["stage"]).collect();
    assert_eq!(stages, ["preparation", "photons", "gathering"]);
    bake(&place, "two.ivg", &["--accuracy", "8%", "--threads", "2"]);
    assert_eq!(place.read("one.ivg"), place.read("two.ivg"));

    let text = text(&place.ok(&["bake", "room.obj", "-o", "x.ivg", "--grid", "4x4x4", "--accuracy", "20%"]));
    assert!(text.contains("with 95 % confidence: noise "), "{text}");
}

#[test]
fn what_is_not_reached_is_said_and_is_no_failure() {
    let place = Workplace::with_room();
    let output = place.run(&["bake", "room.obj", "-o", "x.ivg", "--accuracy", "1%", "--photons", "3000"]);
    assert!(output.status.success());
    assert!(text(&output.stderr).contains("1.00 % was asked for: the photons or paths allowed are spent"));
    let report = bake(&place, "time.ivg", &["--time", "0.01"]);
    assert!(report["photons"].as_u64().expect("a count") >= 65_536 && report["accuracy"].is_null());
    for (argument, value) in [("--accuracy", "2"), ("--accuracy", "0%"), ("--time", "-1"), ("--paths", "0")] {
        let output = place.run(&["bake", "room.obj", "-o", "x.ivg", argument, value]);
        assert_eq!(output.status.code(), Some(2), "{argument} {value}");
    }
}

#[test]
fn every_vertex_can_be_path_traced_for_vectors_and_harmonics() {
    let place = Workplace::with_room();
    for encoding in ["packed-oct24", "sh2-28"] {
        let gather = ["--estimator", "gather", "--encoding", encoding];
        let report = bake(&place, "x.ivg", &[&gather[..], &["--paths", "640"]].concat());
        let valid = report["valid_vertices"].as_u64().expect("a count");
        assert!(report["paths"] == 640 * valid && report["photons"] == 0, "{report}");
        assert!(text(&place.ok(&["check", "x.ivg"])).contains(": ok: "));
        let report = bake(&place, "x.ivg", &[&gather[..], &["--accuracy", "5%"]].concat());
        assert!(report["accuracy"]["reached"].as_f64().expect("a number") <= 0.05, "{report}");
    }
    let output = place.run(&[
        "bake",
        "room.obj",
        "-o",
        "x.ivg",
        "--encoding",
        "sh2-28",
        "--estimator",
        "face-crossing",
    ]);
    assert!(text(&output.stderr).contains("track-length or gather"));
}

/// The light of a bake that was divided, or ended and gone on with, is that of the whole one, byte for byte.
#[test]
fn shards_merge_and_checkpoints_resume_to_the_same_bytes() {
    let place = Workplace::with_room();
    let common = ["bake", "room.obj", "--grid", "4x4x4"];
    let more = |rest: &[&str]| place.ok(&[&common[..], rest].concat());
    for encoding in ["packed-oct24", "sh2-28"] {
        more(&["-o", "whole.ivg", "--photons", "9000", "--encoding", encoding]);
        for k in ["1", "2", "3"] {
            let (shard, file) = (format!("{k}/3"), format!("{k}.acc"));
            more(&["-o", &file, "--shard", &shard, "--photons", "9000", "--encoding", encoding]);
        }
        place.ok(&["merge", "2.acc", "3.acc", "1.acc", "-o", "merged.ivg"]);
        assert_eq!(place.read("whole.ivg"), place.read("merged.ivg"), "{encoding}");
        more(&["-o", "short.ivg", "--photons", "5000", "--encoding", encoding, "--checkpoint", "x.acc"]);
        more(&["-o", "long.ivg", "--photons", "9000", "--encoding", encoding, "--resume", "x.acc"]);
        assert_eq!(place.read("whole.ivg"), place.read("long.ivg"), "{encoding}");
    }
    let fails = |arguments: &[&str], message: &str| {
        let output = place.run(arguments);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        assert!(text(&output.stderr).contains(message), "{}", text(&output.stderr));
    };
    fails(&["merge", "1.acc", "2.acc", "-o", "x.ivg"], "shard 3 of 3 is missing");
    fails(&["merge", "1.acc", "1.acc", "-o", "x.ivg"], "shard 1 of 3 is there twice");
    place.write("cut.acc", &place.read("1.acc")[..500]);
    fails(&["merge", "cut.acc", "-o", "x.ivg"], "cut.acc: not a usable accumulator file");
    for file in ["--resume", "--checkpoint"] {
        let output = place.run(&["bake", "room.obj", "-o", "x.ivg", "--accuracy", "9%", file, "x.acc"]);
        let said = text(&output.stderr);
        assert!(output.status.code() == Some(2) && said.contains("go on with --resume"), "{said}");
    }
    let output = place.run(&["bake", "room.obj", "-o", "x.acc", "--shard", "4/3"]);
    assert_eq!(output.status.code(), Some(2));
    more(&["-o", "seed.acc", "--shard", "2/3", "--photons", "9000", "--encoding", "sh2-28", "--seed", "2"]);
    let seeds = "seed.acc: does not belong to 1.acc: the accumulators have different seeds: 1 and 2";
    fails(&["merge", "1.acc", "seed.acc", "3.acc", "-o", "x.ivg"], seeds);
    let resumed =
        |grid: &'static str| ["bake", "room.obj", "--grid", grid, "-o", "y.ivg", "--resume", "x.acc"];
    fails(&resumed("4x4x4"), "x.acc: the accumulators have different quantities: ");
    fails(&resumed("5x4x4"), "x.acc: the accumulators have different numbers of vertices: 5x4x4 and 4x4x4");
}

/// Photons that find another number of reflections in the room than 5000 do.
const MORE_PHOTONS: &str = "400000";

/// More photons measure how far light is worth following better, and may find another number of reflections.
#[test]
fn a_bake_that_is_gone_on_with_keeps_its_reflections() {
    let place = Workplace::with_room();
    let bounces = |photons: &str, rest: &[&str]| {
        let bake = ["bake", "room.obj", "--grid", "4x4x4", "-o", "x.ivg", "--json", "--photons", photons];
        json(&place.ok(&[&bake[..], rest].concat()))["bounces"].as_u64()
    };
    let few = bounces("5000", &["--checkpoint", "x.acc"]);
    assert_ne!(
        bounces(MORE_PHOTONS, &[]),
        few,
        "or this test shows nothing: choose another number of photons"
    );
    assert_eq!(bounces(MORE_PHOTONS, &["--resume", "x.acc"]), few);
}

#[test]
fn the_scene_decides_the_grid_and_says_why() {
    let place = Workplace::with_room();
    let auto = ["bake", "room.obj", "-o", "x.ivg", "--grid", "auto", "--photons", "2000"];
    let said = text(&place.ok(&auto));
    let report = json(&place.ok(&[&auto[..], &["--json"]].concat()));
    let dims: Vec<u64> =
        report["dims"].as_array().expect("a list").iter().filter_map(Value::as_u64).collect();
    assert!(dims.iter().all(|n| (4..40).contains(n)), "{report}");
    let reason = said.lines().find(|line| line.starts_with("grid ")).expect("a line about the grid");
    assert!(reason.contains("over an eighth of that light changes by"), "{said}");
    assert!(reason.starts_with(&format!("grid {}x", dims[0])), "{said}");
    let output = place.run(&["bake", "room.obj", "-o", "x.ivg", "--grid", "automatic"]);
    assert!(output.status.code() == Some(2) && text(&output.stderr).contains("or auto"));
}

#[test]
fn files_keep_to_their_budget_and_short_times_make_coarse_grids() {
    let place = Workplace::with_room();
    let auto = ["bake", "room.obj", "-o", "x.ivg", "--grid", "auto", "--json"];
    let free = json(&place.ok(&[&auto[..], &["--photons", "2000"]].concat()));
    let count = |report: &Value| report["vertices"].as_u64().expect("a count");
    for (encoding, order) in [("packed-oct24", "slices"), ("vectors-f32", "explicit"), ("sh2-28", "octree")] {
        let budget = ["--photons", "2000", "--budget", "20kB", "--encoding", encoding, "--order", order];
        let report = json(&place.ok(&[&auto[..], &budget].concat()));
        let bytes = place.read("x.ivg").len();
        assert!(bytes <= 20_000 && count(&report) < count(&free), "{bytes} {report}");
        let reason = report["grid_reason"].as_str().expect("a reason");
        assert!(reason.contains("the file is to be no larger"), "{reason}");
    }
    let short = json(&place.ok(&[&auto[..], &["--time", "0.001"]].concat()));
    assert!(count(&short) < count(&free), "{short}");
    assert!(short["grid_reason"].as_str().expect("a reason").contains("there is time for"), "{short}");
    for (arguments, said) in [
        (["--budget", "100B"].as_slice(), "even the smallest grid"),
        (&["--budget", "much"], "give bytes, or kB, MB or GB"),
    ] {
        let output = place.run(&[&auto[..], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).contains(said), "{}", text(&output.stderr));
    }
    let output = place.run(&["bake", "room.obj", "-o", "x.ivg", "--budget", "1MB"]);
    assert!(text(&output.stderr).contains("give --grid auto"), "{}", text(&output.stderr));
}
