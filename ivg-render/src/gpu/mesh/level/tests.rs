use super::*;

#[path = "../../../../tests/scenes/progressive.rs"]
mod progressive;

use progressive::{Sheet, sheet};

/// Arrays as a device would hold them.
#[derive(Debug, Clone, Default, PartialEq)]
struct Device([Vec<u8>; 5]);

impl Device {
    /// Carries writes out; returns how many bytes there were.
    fn write(&mut self, writes: &[Write]) -> usize {
        for write in writes {
            let array = &mut self.0[write.array as usize];
            let (start, end) = (write.offset as usize, write.offset as usize + write.bytes.len());
            array.resize(array.len().max(end), 0);
            array[start..end].copy_from_slice(&write.bytes);
        }
        writes.iter().map(|write| write.bytes.len()).sum()
    }

    /// What a picture of a level reads.
    fn of_level(&self, replay: &Replay) -> [&[u8]; 5] {
        let (wedges, faces) = (replay.wedge_count() as usize, replay.face_count() as usize);
        let prefix = |k: usize, bytes: usize| &self.0[k][..bytes.min(self.0[k].len())];
        [
            prefix(0, 12 * wedges),
            prefix(1, 12 * wedges),
            prefix(2, 8 * wedges),
            prefix(3, 12 * faces),
            prefix(4, 4 * faces),
        ]
    }
}

fn resident(replay: &Replay, scale: DVec3) -> Resident {
    let transform =
        DAffine3::from_scale_rotation_translation(scale, glam::DQuat::from_rotation_y(0.4), DVec3::Y);
    Resident::new(replay.header(), &[4, 7], &transform, DVec3::new(0.5, 0.0, -0.25)).unwrap()
}

/// Levels in no order: few and many vertices, up and down.
fn levels(replay: &Replay) -> impl Iterator<Item = u32> + use<> {
    let range = replay.levels().expect("levels");
    let count = range.end() - range.start() + 1;
    let first = *range.start();
    let far = (1..40u32).map(move |k| first + k.wrapping_mul(2_654_435_761) % count);
    far.flat_map(move |level| [level, (level + 3).min(first + count - 1), level.max(first + 1) - 1])
}

#[test]
fn after_any_steps_the_device_holds_what_a_fresh_upload_brings() {
    for (kind, scale) in [(Sheet::Plain, DVec3::ONE), (Sheet::Full, DVec3::new(-2.0, 1.0, 0.5))] {
        let mut replay = sheet(kind);
        let (mut kept, mut device) = (resident(&replay, scale), Device::default());
        let (mut highest, mut written) = (0, Vec::new());
        for level in levels(&replay) {
            let change = replay.set_level(level).unwrap();
            let first = kept.level() == 0;
            let writes = kept.advance(&replay, &change).unwrap();
            let bytes = device.write(&writes);
            assert_eq!((kept.level(), kept.faces()), (level, replay.face_count()));

            let mut fresh = Device::default();
            let none = LevelChange::default();
            let all = fresh.write(&resident(&replay, scale).advance(&replay, &none).unwrap());
            assert_eq!(device.of_level(&replay), fresh.of_level(&replay), "{kind:?}, level {level}");

            // Positions and what else a file has of wedges are written once each; corners as reported, and at most a gap
            // between two ranges.
            let wedges = replay.wedge_count();
            let of = |array: Array| writes.iter().filter(move |write| write.array == array);
            let sum = |array: Array| of(array).map(|write| write.bytes.len()).sum::<usize>();
            let new = wedges.saturating_sub(highest) as usize;
            highest = highest.max(wedges);
            assert_eq!(sum(Array::Positions), 12 * new);
            let changed: u32 = change.changed.iter().map(|range| range.end - range.start).sum();
            let gaps = GAP * (change.changed.len() as u32).saturating_sub(1);
            if !first {
                assert!(sum(Array::Corners) <= 12 * (changed + gaps) as usize, "level {level}");
                assert!(of(Array::Corners).count() <= change.changed.len());
            }
            if kind == Sheet::Full {
                assert_eq!((sum(Array::Normals), sum(Array::Uvs)), (12 * new, 8 * new));
            } else {
                assert_eq!((sum(Array::Uvs), sum(Array::Materials)), (0, 0));
            }
            if change.from.abs_diff(change.to) <= 4 && level > 500 {
                written.push(bytes as f64 / all as f64);
            }
        }
        // A vertex has six faces and as many neighbours, of 1,000: steps by four at most change 3 % of the corners and less of
        // the rest, and each of their ranges brings at most one gap of 16.
        assert!(written.len() > 20, "{written:?}");
        let mean = written.iter().sum::<f64>() / written.len() as f64;
        assert!(mean < 0.1, "{kind:?}: a small step writes {mean} of everything");
    }
}

#[test]
fn a_change_that_does_not_lead_here_writes_all_corners() {
    let mut replay = sheet(Sheet::Full);
    let mut kept = resident(&replay, DVec3::ONE);
    let mut device = Device::default();
    let change = replay.set_level(1000).unwrap();
    device.write(&kept.advance(&replay, &change).unwrap());
    // The report of a step is lost.
    replay.set_level(400).unwrap();
    let change = replay.set_level(410).unwrap();
    device.write(&kept.advance(&replay, &change).unwrap());
    let mut fresh = Device::default();
    fresh.write(&resident(&replay, DVec3::ONE).advance(&replay, &LevelChange::default()).unwrap());
    assert_eq!(device.of_level(&replay), fresh.of_level(&replay));
    // So does one after a failure, vertices included.
    kept.forget();
    let change = replay.set_level(410).unwrap();
    let mut again = Device::default();
    again.write(&kept.advance(&replay, &change).unwrap());
    assert_eq!(again, fresh);
}

#[test]
fn every_level_lies_in_the_bounds() {
    let replay = sheet(Sheet::Plain);
    let resident = resident(&replay, DVec3::new(3.0, -1.0, 2.0));
    let (low, high) = resident.bounds();
    let points = replay.positions().iter().map(|&p| resident.transform.transform_point3(p.into()));
    for p in points {
        // The corners of the box are rounded as the points are: each coordinate by three products and sums below 4.
        assert!((p - low).min_element() >= -2e-6 && (high - p).min_element() >= -2e-6, "{p}");
    }
}

#[test]
fn one_draw_for_each_material_that_is_there() {
    let mut replay = sheet(Sheet::Plain);
    let mut kept = resident(&replay, DVec3::ONE);
    assert_eq!(kept.draws(), []);
    let change = replay.set_level(500).unwrap();
    kept.advance(&replay, &change).unwrap();
    assert_eq!(kept.draws(), [Draw { material: 4, instance: 0 }]);
    let mut replay = sheet(Sheet::Full);
    let mut kept = resident(&replay, DVec3::ONE);
    let change = replay.set_level(500).unwrap();
    kept.advance(&replay, &change).unwrap();
    assert_eq!(kept.draws(), [Draw { material: 4, instance: 5 }, Draw { material: 7, instance: 8 }]);
    // Materials 4 and 7 of the scene.
    let dark = [false; 8];
    let origin = DVec3::new(0.5, 0.0, -0.25);
    assert_eq!(kept.check(origin, &dark), Ok(()));
    let problem = |result: Result<(), RenderError>| result.unwrap_err().to_string();
    assert!(problem(kept.check(origin, &dark[..7])).contains("a material that the scene does not have"));
    assert!(problem(kept.check(DVec3::ZERO, &dark)).contains("another origin"));
    let mut lit = dark;
    lit[7] = true;
    assert!(problem(kept.check(origin, &lit)).contains("emits light"));
    lit.swap(7, 5);
    assert_eq!(kept.check(origin, &lit), Ok(()), "a material of other meshes");
}

#[test]
fn levels_of_another_file_and_unknown_materials_are_refused() {
    let (plain, full) = (sheet(Sheet::Plain), sheet(Sheet::Full));
    let none = LevelChange::default();
    let error = resident(&plain, DVec3::ONE).advance(&full, &none).unwrap_err();
    assert!(error.to_string().contains("another file"), "{error}");
    for replay in [&plain, &full] {
        let few = usize::from(replay.header().attributes.materials);
        let mut kept =
            Resident::new(replay.header(), &[4, 7][..few], &DAffine3::IDENTITY, DVec3::ZERO).unwrap();
        let error = kept.advance(replay, &none).unwrap_err();
        assert!(error.to_string().contains("a material that the scene does not have"), "{error}");
    }
    let nowhere = DAffine3::from_translation(DVec3::NAN);
    assert!(Resident::new(plain.header(), &[0], &nowhere, DVec3::ZERO).is_err());
}

#[test]
fn ranges_with_small_gaps_are_one() {
    let join = |ranges: &[Range<u32>]| joined(ranges.iter().cloned(), 2);
    assert_eq!(join(&[0..1, 3..4, 4..5, 8..9, 9..9]), [0..5, 8..9]);
    assert_eq!(join(&[]), []);
}
