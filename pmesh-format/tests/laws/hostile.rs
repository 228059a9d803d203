//! Streams that lie: every one is refused with a code and a place, and the levels received so far stay as they were.

use crate::files::{
    ENTRY, Parts, STORED, attributes_too, file, header, levels, packet, put, put32, random, replayed, seam,
    stored, strip, u32_at,
};
use ivg_wire::{Code, Error, codes as common};
use pmesh_format::{Decoder, Event, Header, IndexedMesh, Limits, ProgressiveMesh, Replay, Step, codes};

/// Reads a file as a client does, up to the error; the packets that came before it.
fn read(file: &[u8]) -> (Replay, Error) {
    let mut replay = Replay::default();
    let mut decoder = Decoder::new(Limits::default());
    let mut rest = file;
    loop {
        match decoder.push(rest) {
            Err(error) => return (replay, error),
            Ok(Step::NeedMore(more)) => panic!("{more} bytes are missing"),
            Ok(Step::Consumed(used, event)) => {
                if let Err(error) = replay.accept(&event) {
                    return (replay, error);
                }
                assert_ne!(event, Event::End, "a file that lies is accepted");
                rest = &rest[used..];
            }
        }
    }
}

/// Reads `bad`, a file of which packet `k` is at fault: the error is this one at this byte of the payload; all levels of the packets
/// before are those of the right file, whichever was shown; and with the right packet in place of the bad one the mesh gets whole.
fn refused_in_packet(right: &[u8], bad: &Parts, k: u32, code: Code, at: usize) {
    let file = bad.build();
    let (_, error) = read(&file);
    let expected = (code.number(), bad.payload_offset(k as usize) + at as u64);
    assert_eq!((error.code(), error.offset().0), expected, "{error}");

    let (right_header, bad_header) = (header(right), header(&file));
    let bad_packet = packet(&file, &bad_header, k);
    let expected = levels(&mut replayed(right, k));
    let shown: Vec<Option<u32>> = match replayed(right, k).levels() {
        None => vec![None],
        Some(levels) => {
            vec![Some(*levels.start()), Some((levels.start() + levels.end()) / 2), Some(*levels.end())]
        }
    };
    for level in shown {
        let mut replay = replayed(right, k);
        if let Some(level) = level {
            replay.set_level(level).unwrap();
        }
        let before = state(&replay);
        // Twice: nothing may pile up either.
        for _ in 0..2 {
            assert_eq!(replay.apply(&bad_packet).unwrap_err(), error);
            assert_eq!(state(&replay), before, "{error}");
            assert_eq!(levels(&mut replay), expected, "{error}");
        }
        for k in k..right_header.packet_count() {
            replay.apply(&packet(right, &right_header, k)).unwrap();
        }
        assert_eq!(levels(&mut replay), levels(&mut replayed(right, right_header.packet_count())));
    }
}

/// All that a caller sees.
fn state(replay: &Replay) -> (u32, u32, u32, u32, IndexedMesh, f32) {
    let counts = (replay.packets(), replay.level(), replay.max_level(), replay.face_count());
    (counts.0, counts.1, counts.2, counts.3, replay.mesh(), replay.error())
}

/// Packets of a random mesh, and where their parents and corners begin.
fn spoiled(k: usize, spoil: impl FnOnce(&mut Vec<u8>, [usize; 8])) -> (Vec<u8>, Parts) {
    let right = file(&random(3, 14, true), 4);
    let mut parts = Parts::of(&right);
    let arrays = parts.arrays(k);
    let mut payload = parts.packets[k].1.clone();
    spoil(&mut payload, arrays);
    parts.set_payload(k, payload);
    (right, parts)
}

/// The file of [`spoiled`] with other parents in packet `k`, from the `nth` on, and the byte in which the first of them begins.
fn with_parents(k: usize, nth: usize, parents: &[u32]) -> (Vec<u8>, Parts, usize) {
    let (right, mut bad) = spoiled(k, |_, _| ());
    bad.set_parents(k, nth, parents);
    let bits = bad.parent_bits(k);
    let at = bad.arrays(k)[6];
    (right, bad, at + nth * bits / 8)
}

#[test]
fn a_cycle_in_the_collapse_table_is_refused() {
    // Packets of 4: vertex 3 and 4 to 7, then 8 to 11. A vertex onto itself; two vertices onto each other.
    for (k, parents) in [(1, &[4][..]), (1, &[5, 4]), (2, &[8]), (0, &[3])] {
        let (right, bad, at) = with_parents(k, 0, parents);
        refused_in_packet(&right, &bad, k as u32, codes::PARENT, at);
    }
    // The third of packet 2, of four bits each: the second byte.
    let (right, bad, at) = with_parents(2, 2, &[10]);
    assert_eq!(at, bad.arrays(2)[6] + 1);
    refused_in_packet(&right, &bad, 2, codes::PARENT, at);
}

#[test]
fn a_forward_reference_in_the_collapse_table_is_refused() {
    // The second vertex of each packet: onto a later one of the packet, one of the next packet, the last, none at all, as far as
    // there are bits for that.
    for (k, own) in [(1, 5), (2, 9)] {
        for parent in [own + 1, own + 2, 13, 14, 15] {
            let (right, bad, at) = with_parents(k, 1, &[parent]);
            refused_in_packet(&right, &bad, k as u32, codes::PARENT, at);
        }
    }
}

#[test]
fn a_face_that_names_a_later_vertex_is_refused() {
    // Wedges of packets 0 and 1 end at 6 and 12; the file has 21.
    for (k, end) in [(0, 6), (1, 12), (2, 18)] {
        for wedge in [end, end + 1, 20, 21, u32::MAX] {
            let (right, bad) = spoiled(k, |payload, arrays| put32(payload, arrays[4] + 4, &[wedge]));
            assert_eq!(u32_at(&bad.chunks[0].2, ENTRY * k + 4), end);
            let at = bad.arrays(k)[4];
            refused_in_packet(&right, &bad, k as u32, codes::CORNER, at);
        }
    }
}

#[test]
fn a_face_with_a_vertex_twice_is_refused() {
    let right = file(&strip(), 1);
    for corners in [[4, 3, 4], [4, 4, 3], [3, 4, 4], [0, 0, 0]] {
        let mut bad = Parts::of(&right);
        let at = bad.arrays(2)[4];
        put32(&mut bad.packets[2].1, at, &corners);
        refused_in_packet(&right, &bad, 2, codes::FACE_VERTICES, at);
    }
}

/// A face in the wrong place is no fault: it is there with the face before it, or with the first level of its packet
/// (PMESH-FACE-05).
#[test]
fn a_face_out_of_order_is_there_later_and_levels_stay_valid() {
    let right = file(&strip(), 1);
    for corners in [[1, 2, 3], [0, 1, 2], [1, 2, 4]] {
        let mut bad = Parts::of(&right);
        let at = bad.arrays(2)[4];
        put32(&mut bad.packets[2].1, at, &corners);
        let mut replay = replayed(&bad.build(), 3);
        assert_eq!(replay.indices()[2], corners);
        for mesh in levels(&mut replay) {
            pmesh_format::check_level(&mesh).unwrap();
            assert_eq!(mesh.triangles.len(), mesh.positions.len() - 2);
        }
    }
}

#[test]
fn a_number_that_is_none_is_refused() {
    let right = file(&random(3, 14, true), 4);
    for (array, size, code) in [(0, 12, codes::POSITION), (1, 12, codes::ATTRIBUTE), (2, 8, codes::ATTRIBUTE)]
    {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for k in 0..3 {
                let mut bad = Parts::of(&right);
                let [start, end] = [bad.arrays(k)[array], bad.arrays(k)[array + 1]];
                // The last number of the last element.
                put(&mut bad.packets[k].1, end - 4, &value.to_le_bytes());
                assert!(end - start >= size);
                refused_in_packet(&right, &bad, k as u32, code, end - size);
            }
        }
    }
}

#[test]
fn wedge_counts_that_lie_are_refused() {
    // Packet 1 has wedge counts 1 2 1 2 and wedges 6 to 12.
    for (at, count, fault) in [(0, 0, 0), (1, 3, 3), (3, 1, 4), (0, 7, 0)] {
        let (right, bad) = spoiled(1, |payload, arrays| {
            assert_eq!(payload[arrays[7]..arrays[7] + 4], [1, 2, 1, 2]);
            payload[arrays[7] + at] = count;
        });
        let rest = bad.arrays(1)[7];
        refused_in_packet(&right, &bad, 1, codes::WEDGE_COUNT, rest + fault);
    }
}

#[test]
fn wedge_targets_that_the_parent_does_not_have_are_refused() {
    for target in [2, 3, 0x7F] {
        let (right, bad) = spoiled(1, |payload, arrays| payload[arrays[7] + 4 + 5] = target);
        let at = bad.arrays(1)[7] + 4 + 5;
        refused_in_packet(&right, &bad, 1, codes::WEDGE_TARGET, at);
    }
}

/// Packet 1 of the seam ends with low and high bits of slots 2 and 5 of 6.
#[test]
fn slots_that_no_wedge_descends_to_are_refused() {
    let right = file(&seam(), 3);
    let end = Parts::of(&right).packets[1].1.len();
    assert_eq!(Parts::of(&right).packets[1].1[end - 2..], [0b10, 0b1010]);
    // Slots 0, 1, 3, 4 lie on vertices 0 and 1: in place of the first, of the last.
    for slots in [[0b10, 0b1001], [0b11, 0b1001], [0b11, 0b0101], [0b00, 0b1010]] {
        let mut bad = Parts::of(&right);
        bad.packets[1].1[end - 2..].copy_from_slice(&slots);
        refused_in_packet(&right, &bad, 1, codes::SWITCH, end);
    }
}

#[test]
fn lists_of_slots_that_are_none_are_refused() {
    let right = file(&seam(), 3);
    let end = Parts::of(&right).packets[1].1.len();
    for slots in [[0b00, 0b0000], [0b00, 0b0110], [0b01, 0b0110], [0b00, 0b1110], [0b01, 0b1_0010]] {
        let mut bad = Parts::of(&right);
        bad.packets[1].1[end - 2..].copy_from_slice(&slots);
        refused_in_packet(&right, &bad, 1, codes::SWITCH_SLOTS, end - 2);
    }
    // More than there are slots of earlier faces; in the first packet there are none.
    for (k, count) in [(1, 7), (1, u32::MAX), (0, 1)] {
        let mut bad = Parts::of(&right);
        put32(&mut bad.packets[k].1, 0, &[count]);
        refused_in_packet(&right, &bad, k as u32, codes::SWITCH_SLOTS, 0);
    }
    // All six of them: two bits less one each, which are there, but not the right ones.
    let mut bad = Parts::of(&right);
    put32(&mut bad.packets[1].1, 0, &[6]);
    refused_in_packet(&right, &bad, 1, codes::SWITCH_SLOTS, end - 2);
}

#[test]
fn packets_that_end_too_early_or_too_late_are_refused() {
    let right = file(&random(3, 14, true), 4);
    for k in 0..4 {
        let whole = Parts::of(&right).packets[k].1.clone();
        let end = whole.len();
        let mut bad = Parts::of(&right);
        bad.set_payload(k, [&whole[..], &[0]].concat());
        refused_in_packet(&right, &bad, k as u32, codes::PACKET_LENGTH, end);
        // A part that lacks its last byte is reported where it begins.
        bad.set_payload(k, whole[..end - 1].to_vec());
        let file = bad.build();
        let bad_header = header(&file);
        let error = replayed(&right, k as u32).apply(&packet(&file, &bad_header, k as u32)).unwrap_err();
        assert_eq!(error.code(), codes::PACKET_LENGTH.number());
        let at = (error.offset().0 - bad.payload_offset(k)) as usize;
        assert!(at < end && at >= bad.arrays(k)[7], "{at} of {end}");
        refused_in_packet(&right, &bad, k as u32, codes::PACKET_LENGTH, at);
    }
}

/// Whatever byte of whatever packet is wrong: refused, and all is as before; or accepted, and so are the packets behind it unless
/// they need what is wrong.
#[test]
fn any_byte_of_a_packet_may_lie() {
    for &way in STORED {
        let right = stored(&random(5, 12, attributes_too(way)), 4, way);
        let (mut accepted, mut refused) = (0, 0);
        for k in 0..3 {
            for at in 0..Parts::of(&right).packets[k].1.len() {
                for change in [0x01, 0xFF] {
                    let mut bad = Parts::of(&right);
                    bad.packets[k].1[at] ^= change;
                    let file = bad.build();
                    let bad_header = header(&file);
                    let mut replay = replayed(&right, k as u32);
                    match replay.apply(&packet(&file, &bad_header, k as u32)) {
                        Ok(_) => accepted += 1,
                        Err(error) => {
                            refused += 1;
                            let place = error.offset().0.checked_sub(bad.payload_offset(k)).unwrap();
                            refused_in_packet(&right, &bad, k as u32, code_of(&error), place as usize);
                        }
                    }
                }
            }
        }
        assert!(accepted > 20 && refused > 50, "{way:?}: {accepted} accepted, {refused} refused");
    }
}

fn code_of(error: &Error) -> Code {
    *codes::ALL.iter().find(|code| code.number() == error.code()).expect("a code of this format")
}

#[test]
fn counts_of_header_and_directory_that_lie_are_refused_before_any_packet() {
    type Spoil = fn(&mut Parts);
    let cases: [(Code, Spoil); 8] = [
        // One vertex more, with its wedge, than the packets bring; one face less.
        (codes::DIRECTORY_COUNTS, |p| put32(&mut p.header, 56, &[15, 22])),
        (codes::DIRECTORY_COUNTS, |p| {
            let faces = u32_at(&p.header, 64);
            put32(&mut p.header, 64, &[faces - 1]);
        }),
        (codes::DIRECTORY_COUNTS, |p| {
            let faces = u32_at(&p.header, 64);
            put32(&mut p.header, 64, &[faces + 1]);
        }),
        // A packet that brings nothing, one that takes away.
        (codes::DIRECTORY_COUNTS, |p| put32(p.directory(), ENTRY, &[4])),
        (codes::DIRECTORY_COUNTS, |p| put32(p.directory(), ENTRY, &[3])),
        // Faces for which its bytes do not suffice.
        (codes::DIRECTORY_BYTES, |p| {
            let last = u32_at(&p.header, 64);
            put32(p.directory(), 8, &[last]);
        }),
        (codes::DIRECTORY_LENGTH, |p| put32(&mut p.header, 72, &[3])),
        (codes::DIRECTORY_LENGTH, |p| put32(&mut p.header, 72, &[5])),
    ];
    for (number, (code, spoil)) in cases.into_iter().enumerate() {
        let mut parts = Parts::of(&file(&random(3, 14, true), 4));
        spoil(&mut parts);
        let (replay, error) = read(&parts.build());
        assert_eq!((error.code(), replay.packets()), (code.number(), 0), "case {number}: {error}");
        assert!(error.offset().0 < parts.data_offset());
    }
}

/// The strip has packets that end at vertices 3, 4, 5; without seams each vertex has one wedge.
#[test]
fn entries_that_contradict_the_header_are_refused_at_their_field() {
    for (k, field, value) in [
        // Before the base, as many as before, more than there are.
        (0, 0, 2),
        (1, 0, 3),
        (2, 0, 6),
        // Fewer wedges than vertices, more.
        (0, 1, 2),
        (1, 1, 5),
        (2, 1, 4),
        // Fewer faces than before, more than there are.
        (1, 2, 0),
        (1, 2, 4),
    ] {
        let mut parts = Parts::of(&file(&strip(), 1));
        put32(parts.directory(), ENTRY * k + 4 * field, &[value]);
        let at = (parts.header.len() + 16 + ENTRY * k + 4 * field) as u64;
        let (_, error) = read(&parts.build());
        let expected = (codes::DIRECTORY_COUNTS.number(), at);
        assert_eq!((error.code(), error.offset().0), expected, "packet {k}, field {field}: {error}");
    }
}

#[test]
fn counts_without_vertices_are_refused() {
    let empty = Parts::of(&file(&ProgressiveMesh::default(), 1));
    for at in [56, 60, 64, 68, 72] {
        let mut parts = empty.clone();
        put32(&mut parts.header, at, &[1]);
        let (_, error) = read(&parts.build());
        // A vertex alone lacks its wedge; that is found first.
        let expected = if at == 56 { 60 } else { at as u64 };
        assert_eq!((error.code(), error.offset().0), (codes::COUNTS.number(), expected), "{error}");
    }
}

/// The directory moves the border between two packets, whose payloads stay: what the first is then missing, or has too much.
#[test]
fn a_directory_that_moves_a_vertex_to_another_packet_is_refused() {
    for (k, end) in [(0, 3), (0, 5), (1, 7), (1, 9)] {
        let right = file(&random(6, 14, false), 4);
        let mut parts = Parts::of(&right);
        put32(parts.directory(), ENTRY * k, &[end, end]);
        let (mut replay, error) = read(&parts.build());
        assert_eq!(
            replay.packets() as usize,
            if error.code() == codes::DIRECTORY_BYTES.number() { 0 } else { k }
        );
        let before = replay.packets();
        if before > 0 {
            assert_eq!(levels(&mut replay), levels(&mut replayed(&right, before)), "{error}");
        }
    }
}

/// What a client that fetches by ranges may do wrong: the replay refuses, at the payload of the packet.
#[test]
fn packets_out_of_order_twice_or_missing_leave_all_levels_as_they_were() {
    let file = file(&random(3, 14, true), 4);
    let header = header(&file);
    for applied in 0..=header.packet_count() {
        for next in (0..header.packet_count()).filter(|&next| next != applied) {
            let mut replay = replayed(&file, applied);
            let expected = levels(&mut replay);
            let packet = packet(&file, &header, next);
            let error = replay.apply(&packet).unwrap_err();
            let place = header.packet_range(next).start + 8;
            assert_eq!((error.code(), error.offset().0), (codes::PACKET_ORDER.number(), place));
            assert_eq!((replay.packets(), levels(&mut replay)), (applied, expected));
        }
    }
}

#[test]
fn a_packet_of_another_file_leaves_all_levels_as_they_were() {
    let mut mesh = random(3, 14, true);
    let file_a = file(&mesh, 4);
    mesh.positions[13] = [0.5; 3];
    let file_b = file(&mesh, 4);
    let (a, b) = (header(&file_a), header(&file_b));
    assert_eq!(a.packets, b.packets, "the same places and lengths");
    for k in 0..4 {
        let mut replay = replayed(&file_a, k);
        let expected = levels(&mut replay);
        // With its own header, the file's id tells; with that of the file at hand, the checksum does.
        let error = replay.apply(&packet(&file_b, &b, k)).unwrap_err();
        assert_eq!(
            (error.code(), error.offset().0),
            (codes::PACKET_ORDER.number(), a.packet_range(k).start + 8)
        );
        let bytes = a.packet_range(k);
        let foreign = &file_b[bytes.start as usize..bytes.end as usize];
        let error = pmesh_format::decode_packet(&a, k, foreign).unwrap_err();
        assert_eq!((error.code(), error.offset().0), (common::RECORD_CHECKSUM.number(), bytes.end - 4));
        assert_eq!((replay.packets(), levels(&mut replay)), (k, expected));
    }
}

/// The same four mistakes in a stream, where the record that comes is known by its id.
#[test]
fn a_stream_with_records_swapped_repeated_or_left_out_is_refused() {
    let right = file(&random(6, 16, false), 4);
    for ids in [[0, 2, 1, 3], [0, 1, 1, 3], [0, 0, 2, 3], [0, 2, 3, 3], [1, 0, 2, 3]] {
        let mut parts = Parts::of(&right);
        parts.packets = ids.map(|k| parts.packets[k].clone()).to_vec();
        let wrong = ids.iter().enumerate().position(|(k, &id)| k != id).unwrap();
        // The directory tells the length of what comes, so that it is not a checksum at the wrong place that fails.
        for k in 0..4 {
            let length = parts.packets[k].1.len() as u32;
            let at = ENTRY * k + 12;
            if u32_at(parts.directory(), at) < length {
                put32(parts.directory(), at, &[length]);
            } else {
                let longest = u32_at(parts.directory(), at) as usize;
                parts.packets[k].1.resize(longest, 0);
            }
        }
        let (mut replay, error) = read(&parts.build());
        let place = parts.payload_offset(wrong) - 8;
        assert_eq!((error.code(), error.offset().0), (common::RECORD_ID.number(), place), "{ids:?}");
        assert_eq!(replay.packets() as usize, wrong);
        assert_eq!(levels(&mut replay), levels(&mut replayed(&right, wrong as u32)));
    }
}

/// Records are what a cache may mix up between two versions of a file.
#[test]
fn a_stream_with_a_record_of_another_file_is_refused() {
    let mut mesh = random(3, 14, true);
    let right = file(&mesh, 4);
    mesh.positions[13] = [0.5; 3];
    let other = file(&mesh, 4);
    let header: Header = header(&right);
    for k in 0..4 {
        let range = header.packet_range(k);
        let (start, end) = (range.start as usize, range.end as usize);
        let mixed = [&right[..start], &other[start..end], &right[end..]].concat();
        let (mut replay, error) = read(&mixed);
        assert_eq!((error.code(), error.offset().0), (common::RECORD_CHECKSUM.number(), range.end - 4));
        assert_eq!(levels(&mut replay), levels(&mut replayed(&right, k)));
    }
}

/// A table that passes is no cycle: every vertex reaches the base in at most as many steps as there are vertices.
#[test]
fn what_is_accepted_has_no_cycle() {
    let mesh: ProgressiveMesh = random(9, 40, false);
    let file = file(&mesh, 7);
    let parts = Parts::of(&file);
    let parents: Vec<u32> =
        [4, 7, 7, 7, 7, 5].into_iter().enumerate().flat_map(|(k, count)| parts.parents(k, count)).collect();
    assert_eq!(parents, mesh.collapse);
    for (v, &parent) in (3..).zip(&parents) {
        assert!(parent < v);
    }
}
