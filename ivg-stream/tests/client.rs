//! The client against servers that behave and servers that do not: whatever happens on the way, what is shown at
//! the end is what was packed, or there is an error that says why not.

mod support;

use std::time::Duration;

use ivg_grid::IrradianceGrid;
use ivg_scene::Scene;
use ivg_stream::blocking::{Server, Session};
use ivg_stream::{
    Event, EventKind, FetchError, FetchOptions, Goal, Kind, LocalScene, Progress, SceneLimits, Schedule,
    ServerOptions,
};
use quickcheck::{Arbitrary, Gen};
use support::faulty::{Ask, Fault, Faulty, Files};
use support::scene::{packed, write_files};

const VERTICES: u32 = 1500;

fn options() -> FetchOptions {
    FetchOptions {
        request_bytes: 2048,
        prefix_bytes: 512,
        backoff: Duration::from_millis(1),
        stall_timeout: Duration::from_secs(10),
        ..FetchOptions::default()
    }
}

/// All that can be seen of a scene.
#[derive(Debug, Clone, PartialEq)]
struct Shown {
    scene: Scene,
    grid: Option<IrradianceGrid>,
}

/// What reading the files from a disk shows.
fn expected(files: &Files) -> Shown {
    let directory = tempfile::tempdir().unwrap();
    write_files(files, directory.path());
    let mut local = LocalScene::open(directory.path(), SceneLimits::default()).unwrap();
    Shown { scene: local.scene_at(1.0), grid: local.grid().cloned() }
}

/// Fetches everything; what is then shown, and what happened.
fn fetch(url: &str, options: FetchOptions) -> (Result<(Shown, Progress), FetchError>, Vec<Event>) {
    let mut events = Vec::new();
    let mut log = |event: &Event| events.push(event.clone());
    let outcome = Session::open(url, options, &mut log).and_then(|mut session| {
        let progress = session.fetch_until(Goal::ALL, &mut log)?;
        Ok((Shown { scene: session.scene_at(1.0), grid: session.grid().cloned() }, progress))
    });
    (outcome, events)
}

fn count(events: &[Event], is: impl Fn(&EventKind) -> bool) -> usize {
    events.iter().filter(|event| is(&event.what)).count()
}

/// Fetches from a server with the given faults, and asserts that what was packed is shown.
fn arrives(plan: impl FnMut(&Ask, &mut Files) -> Fault + Send + 'static) -> (Vec<Event>, Vec<Ask>) {
    let files = packed(VERTICES, 1.0);
    let expected = expected(&files);
    let server = Faulty::start(files, plan);
    let (outcome, events) = fetch(&server.url(), options());
    assert!(outcome.unwrap().0 == expected, "another scene was shown than was packed");
    (events, server.asked())
}

/// Fetches from a server with the given faults, and gives the error.
fn fails(plan: impl FnMut(&Ask, &mut Files) -> Fault + Send + 'static) -> (FetchError, Vec<Ask>) {
    let server = Faulty::start(packed(VERTICES, 1.0), plan);
    let (outcome, _) = fetch(&server.url(), options());
    (outcome.map(drop).unwrap_err(), server.asked())
}

#[test]
fn every_schedule_ends_with_the_same_scene() {
    let files = packed(VERTICES, 1.0);
    let expected = expected(&files);
    let directory = tempfile::tempdir().unwrap();
    write_files(&files, directory.path());
    let server = Server::start(directory.path(), ServerOptions::default()).unwrap();
    let total: usize =
        files.iter().filter(|(name, _)| *name != "scene.glb").map(|(_, bytes)| bytes.len()).sum();
    for schedule in [
        Schedule::Alternate,
        Schedule::Proportion { light: 0.2 },
        Schedule::Proportion { light: 1.0 },
        Schedule::GeometryFirst,
        Schedule::LightFirst,
    ] {
        let (outcome, events) = fetch(&server.url(), FetchOptions { schedule, ..options() });
        let (shown, progress) = outcome.unwrap();
        assert!(shown == expected, "{schedule:?}");
        assert_eq!((progress.geometry, progress.light), (1.0, 1.0));
        assert_eq!(
            progress.geometry_bytes + progress.light_bytes,
            total as u64,
            "each byte once: {schedule:?}"
        );
        assert_eq!(progress.scene_bytes, files["scene.glb"].len() as u64);
        assert_eq!(count(&events, |what| *what == EventKind::Complete), 3);
    }
    server.stop();
}

#[test]
fn any_request_size_ends_with_the_same_scene() {
    let files = packed(300, 1.0);
    let expected = expected(&files);
    let server = Faulty::start(files, |_, _| Fault::None);
    let mut random = Gen::new(100);
    for _ in 0..20 {
        let (request, prefix) =
            (u64::from(u16::arbitrary(&mut random)), u64::from(u16::arbitrary(&mut random)));
        let share = f32::from(u8::arbitrary(&mut random)) / 255.0;
        let options = FetchOptions {
            request_bytes: request.max(64),
            prefix_bytes: prefix.max(1),
            schedule: Schedule::Proportion { light: share },
            ..options()
        };
        let arrived = fetch(&server.url(), options).0.is_ok_and(|(shown, _)| shown == expected);
        assert!(arrived, "requests of {request}, first {prefix}, share of light {share}");
    }
}

#[test]
fn goals_are_reached_one_after_the_other() {
    let files = packed(VERTICES, 1.0);
    let server = Faulty::start(files.clone(), |_, _| Fault::None);
    let mut quiet = |_: &Event| ();
    let mut session = Session::open(&server.url(), options(), &mut quiet).unwrap();
    assert!(session.grid().is_none() && session.grid_header().is_none() && session.replay(0).is_none());
    let coarse = session.scene_at(1.0);
    assert!(coarse == session.manifest().scene, "before the first packet the coarse meshes are shown");

    let mut before = session.progress();
    for goal in [
        Goal { geometry: 0.002, light: 0.0 },
        Goal { geometry: 0.002, light: 0.25 },
        Goal { geometry: 0.3, light: 0.25 },
        Goal::ALL,
    ] {
        let progress = session.fetch_until(goal, &mut quiet).unwrap();
        assert!(progress.geometry >= goal.geometry && progress.light >= goal.light, "{goal:?}: {progress:?}");
        for index in 0..2 {
            let replay = session.replay(index).unwrap();
            let all = f64::from(replay.header().vertex_count);
            assert!(f64::from(replay.max_level()) >= goal.geometry * all, "each mesh reaches {goal:?}");
        }
        if goal.light == 0.0 {
            assert_eq!(
                (progress.light_bytes, session.grid().is_none()),
                (0, true),
                "no byte of light was wanted"
            );
        } else {
            assert_eq!(session.grid_header().unwrap().encoding, ivg_format::Encoding::PackedOct24);
            let grid = session.grid().unwrap();
            assert!(grid.received_count() as f64 >= goal.light * grid.vertex_count() as f64);
        }
        if goal.geometry == before.geometry {
            assert_eq!(progress.geometry_bytes, before.geometry_bytes, "no more geometry was wanted");
        }
        // A goal that is reached asks for nothing.
        let asked = server.asked().len();
        session.fetch_until(goal, &mut quiet).unwrap();
        assert_eq!(server.asked().len(), asked);
        before = progress;
    }
    let light = files["light.ivg"].len() as u64;
    assert_eq!(before.light_bytes, light);
    assert!(session.scene_at(0.01).meshes[0].positions.len() < 20);
    assert!(session.scene_at(1.0) == expected(&files).scene);
}

#[test]
fn light_keeps_its_share_of_the_bytes_to_within_one_request() {
    let files = packed(6000, 1.0);
    let server = Faulty::start(files, |_, _| Fault::None);
    for share in [0.1f32, 0.5, 0.8] {
        let options = FetchOptions { schedule: Schedule::Proportion { light: share }, ..options() };
        let request = options.request_bytes.max(options.prefix_bytes);
        let mut events = Vec::new();
        let mut log = |event: &Event| events.push(event.clone());
        Session::open(&server.url(), options, &mut log).unwrap().fetch_until(Goal::ALL, &mut log).unwrap();
        let (mut geometry, mut light) = (0u64, 0u64);
        let complete = |kind: Kind, events: &[Event]| {
            events
                .iter()
                .any(|e| e.what == EventKind::Complete && e.file.ends_with(".ivg") == (kind == Kind::Light))
        };
        for (index, event) in events.iter().enumerate() {
            let EventKind::Request { start, end } = event.what else { continue };
            // Once one kind has nothing left, the other has the connection to itself.
            if complete(Kind::Light, &events[..index]) || complete(Kind::Geometry, &events[..index]) {
                break;
            }
            *(if event.file.ends_with(".ivg") { &mut light } else { &mut geometry }) += end - start;
            let deficit = f64::from(share) * (geometry + light) as f64 - light as f64;
            assert!(deficit.abs() <= request as f64, "share {share}: {light} of {}", geometry + light);
        }
        assert!(light > 0 && geometry > 0);
    }
}

#[test]
fn a_connection_that_breaks_is_taken_up_where_it_broke() {
    // Every other answer breaks, after a number of bytes that changes.
    let (events, asked) = arrives(|ask, _| match ask.number % 2 {
        1 => Fault::DropAfter(ask.number * 131 % 1500),
        _ => Fault::None,
    });
    assert!(count(&events, |what| matches!(what, EventKind::Broken { .. })) > 5);
    let resumed: Vec<&Ask> =
        asked.iter().filter(|ask| ask.file != "scene.glb" && ask.if_range.is_some()).collect();
    assert!(!resumed.is_empty(), "no request carried If-Range");
    // No byte is asked for before the one where the answer broke.
    for file in ["strip.pmesh", "strip-2.pmesh", "light.ivg"] {
        let starts: Vec<u64> =
            asked.iter().filter(|ask| ask.file == file).map(|ask| ask.range.clone().unwrap().start).collect();
        assert!(starts.windows(2).all(|pair| pair[0] <= pair[1]), "{file}: {starts:?}");
    }
}

#[test]
fn a_connection_that_always_breaks_is_given_up() {
    let (error, asked) =
        fails(|ask, _| if ask.file == "light.ivg" { Fault::DropAfter(0) } else { Fault::None });
    assert!(
        matches!(&error, FetchError::Connection { file, attempts: 6, .. } if file == "light.ivg"),
        "{error}"
    );
    assert_eq!(asked.iter().filter(|ask| ask.file == "light.ivg").count(), 6);
    let (error, _) = fails(|_, _| Fault::DropAfter(0));
    assert!(matches!(&error, FetchError::Connection { file, .. } if file == "scene.glb"), "{error}");
}

#[test]
fn nobody_there_is_an_error() {
    let addr = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let (outcome, _) = fetch(&format!("http://{addr}/"), options());
    assert!(matches!(outcome, Err(FetchError::Connection { .. })));
    assert!(matches!(fetch("https://localhost/", options()).0, Err(FetchError::Url(_))));
}

#[test]
fn a_damaged_byte_is_noticed_and_fetched_again() {
    for at in [3u64, 40, 300, 700, 1500, 4000] {
        for file in ["light.ivg", "strip.pmesh"] {
            let mut done = false;
            let (events, _) = arrives(move |ask, _| {
                let hit =
                    ask.file == file && ask.range.as_ref().is_some_and(|range| range.contains(&at)) && !done;
                done |= hit;
                if hit { Fault::Flip(at) } else { Fault::None }
            });
            assert_eq!(count(&events, |what| matches!(what, EventKind::Damaged { .. })), 1, "{file} at {at}");
        }
    }
}

#[test]
fn a_byte_that_stays_damaged_is_an_error() {
    for (file, at) in [("light.ivg", 3000), ("strip.pmesh", 6000)] {
        let (error, _) = fails(move |ask, _| {
            let hit = ask.file == file && ask.range.as_ref().is_some_and(|range| range.contains(&at));
            if hit { Fault::Flip(at) } else { Fault::None }
        });
        let found =
            matches!(&error, FetchError::Damaged { file: f, offset, .. } if f == file && *offset <= at);
        assert!(found, "{error}");
    }
    // In the header it means that the file is not the one that scene.glb states.
    let (error, _) = fails(|ask, _| if ask.file == "light.ivg" { Fault::Flip(60) } else { Fault::None });
    assert!(matches!(&error, FetchError::Inconsistent { file, .. } if file == "light.ivg"), "{error}");
}

#[test]
fn a_server_without_ranges_will_do() {
    let (_, asked) = arrives(|_, _| Fault::IgnoreRange);
    assert_eq!(asked.len(), 4, "each file comes whole in one answer");
    // What is in already is passed over.
    let (_, asked) = arrives(|ask, _| if ask.number < 8 { Fault::None } else { Fault::IgnoreRange });
    let last = |file: &str| asked.iter().rfind(|ask| ask.file == file).and_then(|ask| ask.range.clone());
    assert!(["strip.pmesh", "light.ivg"].iter().all(|file| last(file).is_some_and(|range| range.start > 0)));
}

#[test]
fn short_answers_will_do() {
    arrives(|ask, _| Fault::Shorten(1 + ask.number as u64 * 97 % 700));
}

#[test]
fn answers_that_are_no_answers_are_errors() {
    for (fault, part) in [
        (Fault::Shift, "asked for bytes"),
        (Fault::Coding, "content coding"),
        (Fault::OtherTotal, "stated are"),
        (Fault::Status(403), "403"),
        (Fault::Status(404), "404"),
        (Fault::Status(500), "500"),
        (Fault::Status(301), "301"),
    ] {
        let shown = format!("{fault:?}");
        let (error, asked) =
            fails(move |ask, _| if ask.file == "light.ivg" { fault.clone() } else { Fault::None });
        assert!(error.to_string().contains(part), "{shown}: {error}");
        assert!(asked.len() < 100, "{shown}: {} requests", asked.len());
    }
}

#[test]
fn a_server_that_is_busy_is_asked_again() {
    let (events, _) = arrives(|ask, _| if ask.number % 3 == 1 { Fault::Status(503) } else { Fault::None });
    assert!(count(&events, |what| matches!(what, EventKind::Broken { .. })) > 0);
}

#[test]
fn the_same_file_under_another_tag_is_gone_on_with() {
    // As when two machines take turns behind one name.
    let tags = ["\"one\"", "\"two\""];
    let (events, _) = arrives(move |ask, _| match ask.number {
        0..8 => Fault::Tag(Some(tags[0])),
        _ => Fault::Tag(Some(tags[1])),
    });
    assert!(count(&events, |what| *what == EventKind::Retagged) > 0);
    assert_eq!(count(&events, |what| *what == EventKind::Restarted), 0);
    // A server without tags.
    arrives(|_, _| Fault::Tag(None));
}

/// A server whose files become those of another scene before request `at`, with a fault in all answers.
fn replaced(at: usize, fault: Fault) -> (Vec<Event>, bool) {
    let (old, new) = (packed(VERTICES, 1.0), packed(VERTICES + 30, 2.0));
    let expected = expected(&new);
    let server = Faulty::start(old, move |ask, files| {
        if ask.number == at {
            files.clone_from(&new);
        }
        fault.clone()
    });
    let (outcome, events) = fetch(&server.url(), options());
    (events, outcome.unwrap().0 == expected)
}

#[test]
fn a_scene_that_changes_is_fetched_anew() {
    for at in [1, 2, 5, 12, 20] {
        for fault in [
            Fault::None,
            // Ranges of the new file under the new tag.
            Fault::IgnoreIfRange,
            // Ranges of the new file, and nothing but checksums to tell.
            Fault::Tag(None),
            Fault::IgnoreRange,
        ] {
            let shown = format!("before request {at}, {fault:?}");
            let (events, is_new) = replaced(at, fault.clone());
            // A server that sends whole files is asked four times only.
            assert!(is_new || (fault == Fault::IgnoreRange && at > 3), "{shown}: a mixture was shown");
            if at >= 5 && fault != Fault::IgnoreRange {
                assert!(count(&events, |what| *what == EventKind::Restarted) > 0, "{shown}");
            }
        }
    }
}

#[test]
fn only_the_file_that_changed_is_fetched_anew() {
    let (old, new) = (packed(VERTICES, 1.0), packed(VERTICES, 2.0));
    assert_eq!(old["strip.pmesh"], new["strip.pmesh"]);
    let expected = expected(&new);
    let server = Faulty::start(old, move |ask, files| {
        if ask.number == 20 {
            files.clone_from(&new);
        }
        Fault::None
    });
    let (outcome, events) = fetch(&server.url(), options());
    assert!(outcome.unwrap().0 == expected);
    let restarted: Vec<&str> =
        events.iter().filter(|e| e.what == EventKind::Restarted).map(|e| e.file.as_str()).collect();
    assert_eq!(restarted, ["light.ivg"]);
}

#[test]
fn a_file_that_changes_without_its_scene_is_an_error() {
    for at in [1, 9] {
        let new = packed(VERTICES, 2.0);
        let (error, _) = fails(move |ask, files| {
            if ask.number == at {
                files.insert("light.ivg".into(), new["light.ivg"].clone());
            }
            Fault::None
        });
        assert!(
            matches!(&error, FetchError::Inconsistent { file, .. } if file == "light.ivg"),
            "{at}: {error}"
        );
    }
}

#[test]
fn a_scene_beyond_the_limits_is_refused() {
    let files = packed(VERTICES, 1.0);
    let server = Faulty::start(files, |_, _| Fault::None);
    let all = SceneLimits::default();
    for (limits, name) in [
        (SceneLimits { scene_bytes: 100, ..all }, "scene.glb"),
        (SceneLimits { grid_vertices: 100, ..all }, "light.ivg"),
        (SceneLimits { mesh_counts: 100, ..all }, "strip.pmesh"),
    ] {
        let options = FetchOptions { limits, ..options() };
        let error = fetch(&server.url(), options).0.map(drop).unwrap_err();
        assert!(matches!(&error, FetchError::Refused { file, .. } if file == name), "{name}: {error}");
    }
}

#[test]
fn a_scene_that_is_none_is_an_error() {
    let mut cut = packed(VERTICES, 1.0);
    cut.get_mut("scene.glb").unwrap().truncate(1000);
    let server = Faulty::start(cut, |_, _| Fault::None);
    assert!(matches!(fetch(&server.url(), options()).0, Err(FetchError::Scene(_))));
    let server = Faulty::start(Files::new(), |_, _| Fault::None);
    assert!(matches!(fetch(&server.url(), options()).0, Err(FetchError::Status { status: 404, .. })));
}
