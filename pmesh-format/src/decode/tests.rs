use std::string::String;
use std::vec::Vec;
use std::{format, vec};

use ivg_wire::Verdict;
use quickcheck::quickcheck;

use super::*;
use crate::encode::{EncodeOptions, encode};
use crate::mesh::check_level;
use crate::tests::{Kind, Parts, random_mesh, some_meshes};

fn files() -> Vec<Vec<u8>> {
    let options = EncodeOptions::fixed(3);
    some_meshes().iter().map(|mesh| encode(mesh, &options).unwrap()).collect()
}

#[test]
fn whole_files_are_valid() {
    for file in files() {
        assert_eq!(check(&file, &Limits::default()), Ok(()));
    }
}

#[test]
fn every_proper_prefix_needs_more() {
    for file in files() {
        for length in 0..file.len() {
            let error = check(&file[..length], &Limits::default()).unwrap_err();
            assert_eq!((error.verdict(), error.offset().0), (Verdict::NeedMore, length as u64), "{error}");
        }
    }
}

#[test]
fn bytes_after_the_end_are_refused() {
    for mut file in files() {
        let end = file.len() as u64;
        file.push(0);
        let error = check(&file, &Limits::default()).unwrap_err();
        assert_eq!((error.rule().name, error.offset().0), ("TRAILING_BYTES", end));
    }
}

/// Checksums cover everything: no change of one byte goes unnoticed, and none makes a reader wait for what never comes.
#[test]
fn any_changed_byte_is_noticed() {
    for file in files() {
        for at in 0..file.len() {
            for change in [0x01, 0x80, 0xFF] {
                let mut changed = file.clone();
                changed[at] ^= change;
                let error = check(&changed, &Limits::default()).expect_err("a changed file was accepted");
                assert!(
                    matches!(error.verdict(), Verdict::Invalid | Verdict::Unsupported),
                    "byte {at}: {error}"
                );
                assert!(error.offset().0 <= file.len() as u64);
            }
        }
    }
}

/// With right checksums a changed byte may go unnoticed, but then every level is a valid mesh all the same; and where a
/// packet is refused, the levels before it stay as they were.
#[test]
fn any_changed_byte_with_right_checksums_leaves_valid_levels() {
    let kinds = [(11, 12, true), (12, 14, false)];
    for (seed, vertices, seams) in kinds {
        let mesh = random_mesh(seed, Kind { vertices, seams, materials: seams });
        let parts = Parts::of(&encode(&mesh, &EncodeOptions::fixed(5)).unwrap());
        let (mut accepted, mut refused) = (0, 0);
        for k in 0..parts.packets.len() {
            for at in 0..parts.packets[k].2.len() {
                for change in [0x01, 0x02, 0x10, 0xFF] {
                    let mut changed = parts.clone();
                    changed.packets[k].2[at] ^= change;
                    match levels_stay_valid(&changed.build()) {
                        Ok(()) => accepted += 1,
                        Err(_) => refused += 1,
                    }
                }
            }
        }
        assert!(
            accepted > 20 && refused > 100,
            "{accepted} accepted, {refused} refused: the test tests nothing"
        );
    }
}

/// Reads a file to its end or first error, and checks every level after each packet.
fn levels_stay_valid(file: &[u8]) -> Result<(), Error> {
    let mut replay = Replay::default();
    let mut decoder = Decoder::new(Limits::default());
    let mut at = 0;
    loop {
        let before = (replay.levels(), replay.packets(), replay.mesh());
        let (used, event) = match decoder.push(&file[at..])? {
            Step::NeedMore(_) => panic!("the file has the length that it says"),
            Step::Consumed(used, event) => (used, event),
        };
        at += used;
        if let Err(error) = replay.accept(&event) {
            assert_eq!((replay.levels(), replay.packets(), replay.mesh()), before, "{error}");
            all_levels_are_valid(&mut replay);
            return Err(error);
        }
        if event == Event::End {
            all_levels_are_valid(&mut replay);
            return Ok(());
        }
    }
}

fn all_levels_are_valid(replay: &mut Replay) {
    for level in replay.levels().into_iter().flatten().rev() {
        replay.set_level(level).unwrap();
        check_level(&replay.mesh()).unwrap_or_else(|fault| panic!("level {level}: {fault}"));
    }
}

/// Everything that a caller sees of a file that arrives in pieces of these lengths (then at once).
fn transcript(file: &[u8], pieces: &[usize]) -> (Vec<String>, Result<(), Error>) {
    let mut decoder = BufferedDecoder::new(Limits::default());
    let mut seen = vec![];
    let mut start = 0;
    for length in pieces.iter().copied().chain([usize::MAX]) {
        let end = start + length.min(file.len() - start);
        if let Err(error) = decoder.feed(&file[start..end], |event| seen.push(format!("{event:?}"))) {
            let mut after = 0;
            let again = decoder.feed(&[1, 2, 3], |_| after += 1);
            assert_eq!((again, after), (Err(error), 0), "the error is not the same again");
            return (seen, Err(error));
        }
        start = end;
    }
    (seen, decoder.finish())
}

quickcheck! {
    fn any_split_gives_the_same_events_and_the_same_error(seed: u64, pieces: Vec<u8>, change: Option<(u16, u8)>) -> bool {
        let mesh = random_mesh(seed, Kind { vertices: 12, seams: seed.is_multiple_of(2), materials: seed.is_multiple_of(3) });
        let mut file = encode(&mesh, &EncodeOptions::fixed(4)).unwrap();
        if let Some((at, change)) = change {
            let at = usize::from(at) % file.len();
            file[at] ^= change;
        }
        let pieces: Vec<usize> = pieces.iter().map(|&n| usize::from(n)).collect();
        let bytes = vec![1; file.len()];
        let whole = transcript(&file, &[]);
        transcript(&file, &pieces) == whole && transcript(&file, &bytes) == whole
    }

    fn arbitrary_bytes_never_panic(bytes: Vec<u8>) -> bool {
        let mut file = b"\x89PMS\r\n\x1A\n\0\0\x01\0".to_vec();
        file.extend(&bytes);
        check(&file, &Limits::default()).is_err() && check(&bytes, &Limits::default()).is_err()
    }
}

#[test]
fn a_packet_alone_is_the_packet_in_its_file() {
    let mesh = random_mesh(7, Kind { vertices: 20, seams: true, materials: true });
    let file = encode(&mesh, &EncodeOptions::fixed(4)).unwrap();
    let header = crate::tests::header_of(&file);
    assert_eq!(header.packet_count(), 5);
    let mut in_file = vec![];
    decode_all(&file, &Limits::default(), |event| {
        if let Event::Packet(packet) = event {
            in_file.push((packet.index(), packet.payload().to_vec()));
        }
    })
    .unwrap();
    for (k, payload) in in_file {
        let range = header.packet_range(k);
        let bytes = &file[range.start as usize..range.end as usize];
        assert_eq!(decode_packet(&header, k, bytes).unwrap().payload(), payload);
        let short = decode_packet(&header, k, &bytes[..bytes.len() - 1]).unwrap_err();
        assert_eq!(short.verdict(), Verdict::NeedMore);
        let long = [bytes, &[0]].concat();
        assert_eq!(decode_packet(&header, k, &long).unwrap_err().rule().name, "RECORD_LENGTH");
        // In the place of another packet it is refused, whatever its length.
        let other = decode_packet(&header, (k + 1) % 5, bytes).unwrap_err();
        assert!(["RECORD_ID", "RECORD_CHECKSUM", "TRUNCATED", "RECORD_LENGTH"].contains(&other.rule().name));
    }
    assert_eq!(decode_packet(&header, 5, &[]).unwrap_err().rule().name, "PACKET_ORDER");
}

#[test]
fn the_buffers_for_a_graphics_processor_are_the_arrays_of_the_mesh() {
    let mesh = random_mesh(9, Kind { vertices: 10, seams: true, materials: true });
    let file = encode(&mesh, &EncodeOptions::fixed(100)).unwrap();
    decode_all(&file, &Limits::default(), |event| {
        let Event::Packet(packet) = event else { return };
        let floats = |array: &[[f32; 3]]| {
            array.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>()
        };
        assert_eq!(packet.position_bytes(), floats(&mesh.positions));
        assert_eq!(packet.normal_bytes(), floats(&mesh.wedges.normals));
        assert_eq!(packet.uv_bytes().len(), 8 * mesh.wedges.len());
        assert_eq!(packet.colour_bytes(), mesh.wedges.colours.as_flattened());
        assert_eq!(packet.corner_bytes().len(), 12 * mesh.faces.len());
        assert_eq!(packet.material_bytes().len(), 2 * mesh.faces.len());
        // Ten vertices: four bits a parent.
        assert_eq!(packet.parent_bytes().len(), mesh.collapse.len().div_ceil(2));
    })
    .unwrap();
}
