use ivg_format::{
    Decoder, EncodeOptions, Encoding, Lattice, RecordId, Step, Values, Verdict, decode_record, encode,
    encode_record,
};

use super::*;
use crate::{HemisphereVectors, relative_rmse};

/// 5 × 4 × 3 vertices, some invalid, some edges blocked, with light that the packed encoding stores well: each
/// hemisphere's three channels in one direction.
fn grid() -> IrradianceGrid {
    let lattice = Lattice::new([5, 4, 3], [-1.0, 0.0, 2.0], [1.0, 3.0, 2.5]).expect("a box");
    let mut grid = IrradianceGrid::new(lattice).expect("small");
    for index in 0..60usize {
        let mut vectors: HemisphereVectors = [[[0.0; 3]; 3]; 6];
        for (hemisphere, channels) in vectors.iter_mut().enumerate() {
            let mut direction = [0.3, -0.2, 0.1 * (index % 7) as f32];
            direction[hemisphere / 2] = if hemisphere.is_multiple_of(2) { 1.0 } else { -1.0 };
            for (channel, vector) in channels.iter_mut().enumerate() {
                *vector = direction.map(|c| c * (1.0 + channel as f32) * (1.0 + index as f32));
            }
        }
        grid.set(index, &vectors);
        grid.set_validity(index, if index % 13 == 5 { 0 } else { 255 - (index % 3) as u8 });
        grid.set_blocked_edges(index, (index % 8) as u8);
    }
    grid
}

fn file(grid: &IrradianceGrid, encoding: Encoding) -> Vec<u8> {
    let options = EncodeOptions { encoding, vertices_per_slice: 3, ..EncodeOptions::default() };
    encode(&grid.as_source(), &options).expect("a sound grid")
}

#[test]
fn floats_come_back_bit_for_bit_with_validity_and_edges() {
    let grid = grid();
    let (read, header) = IrradianceGrid::from_file(&file(&grid, Encoding::VectorsF32), &Limits::default())
        .expect("a whole file");
    assert_eq!(read, grid);
    assert_eq!(header.encoding, Encoding::VectorsF32);
    assert_eq!(header.lattice, *grid.lattice());
}

#[test]
fn packed_light_comes_back_within_its_quantisation() {
    let grid = grid();
    let (read, _) = IrradianceGrid::from_file(&file(&grid, Encoding::PackedOct24), &Limits::default())
        .expect("a whole file");
    assert_eq!(read.validity(), grid.validity());
    assert_eq!(read.blocked_edges(), grid.blocked_edges());
    assert_eq!(read.received_count(), 60);
    // Direction codes are off by up to 0.059° = 1.03e-3; a mantissa of RGB9E5 has 9 bits of which the leading one may
    // be missing three times over for the weakest of three channels 1 : 2 : 3, 3 / 2^9 / 2 = 2.9e-3.
    let error = relative_rmse(read.vectors(), grid.vectors());
    assert!(error < 4e-3 && error > 0.0, "{error}");
}

#[test]
fn an_open_grid_has_no_validity_section() {
    let lattice = Lattice::new([2; 3], [0.0; 3], [1.0; 3]).expect("a box");
    let open = IrradianceGrid::new(lattice).expect("small");
    assert!(open.as_source().validity.is_none() && open.as_source().blocked_edges.is_none());
    let mut invalid = open.clone();
    invalid.set_validity(3, 254);
    assert!(invalid.as_source().validity.is_some() && invalid.as_source().blocked_edges.is_none());
    let mut blocked = open;
    blocked.set_blocked_edges(0, 1);
    assert!(blocked.as_source().validity.is_none() && blocked.as_source().blocked_edges.is_some());
}

#[test]
fn events_in_order_and_records_backwards_give_the_same_grid() {
    let grid = grid();
    let bytes = file(&grid, Encoding::PackedOct24);
    let mut decoder = Decoder::new(Limits::default());
    let mut forwards = IrradianceGrid::new(*grid.lattice()).expect("small");
    let mut received = vec![0];
    while !decoder.is_finished() {
        let rest = &bytes[decoder.offset().0 as usize..];
        let Step::Consumed(_, event) = decoder.push(rest).expect("a sound file") else {
            panic!("a whole file")
        };
        forwards.accept(&event).expect("its own lattice");
        received.push(forwards.received_count());
    }
    assert!(received.contains(&8), "after the corners: {received:?}");
    assert!(received.windows(2).all(|pair| pair[0] <= pair[1]) && received.ends_with(&[60]));

    let header = decoder.header().expect("read");
    let mut records: Vec<RecordId> = header.records().collect();
    records.reverse();
    let mut backwards = IrradianceGrid::new(*grid.lattice()).expect("small");
    for id in records {
        let range = header.record_range(id);
        let event =
            decode_record(header, id, &bytes[range.start as usize..range.end as usize]).expect("sound");
        backwards.accept(&event).expect("its own lattice");
    }
    assert_eq!(forwards, backwards);
}

#[test]
fn a_bundle_of_another_lattice_is_refused_and_changes_nothing() {
    let bytes = file(&grid(), Encoding::VectorsF32);
    let other = Lattice::new([5, 4, 3], [0.0; 3], [1.0; 3]).expect("a box");
    let smaller = Lattice::new([5, 4, 2], [0.0; 3], [1.0; 3]).expect("a box");
    for lattice in [other, smaller] {
        let untouched = IrradianceGrid::new(lattice).expect("small");
        let mut grid = untouched.clone();
        let mut tried = 0;
        decode_all(&bytes, &Limits::default(), |event| {
            if let Event::Chunk(_) | Event::End = event {
                return;
            }
            let expected = Err(GridError::OtherLattice);
            assert_eq!(grid.accept(&event), expected, "{event:?}");
            tried += 1;
        })
        .expect("a sound file");
        assert!(tried >= 4, "header, corners, validity and bundles: {tried}");
        assert_eq!(grid.received_count(), 0);
        assert_eq!(grid, untouched);
    }
}

#[test]
fn a_file_that_ends_early_needs_more_at_every_length() {
    let bytes = file(&grid(), Encoding::PackedOct24);
    for length in 0..bytes.len() {
        match IrradianceGrid::from_file(&bytes[..length], &Limits::default()) {
            Err(GridError::Format(error)) => assert_eq!(error.verdict(), Verdict::NeedMore, "{length}"),
            other => panic!("{length}: {other:?}"),
        }
    }
}

#[test]
fn limits_hold() {
    let bytes = file(&grid(), Encoding::PackedOct24);
    let limits = Limits { vertices: 59, ..Limits::default() };
    match IrradianceGrid::from_file(&bytes, &limits) {
        Err(GridError::Format(error)) => assert_eq!(error.verdict(), Verdict::Limit),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_stale_record_is_ignored_and_a_newer_one_replaces() {
    let old = grid();
    let options =
        EncodeOptions { encoding: Encoding::VectorsF32, vertices_per_slice: 3, ..EncodeOptions::default() };
    let file = encode(&old.as_source(), &options).expect("a sound grid");
    let (mut read, header) = IrradianceGrid::from_file(&file, &Limits::default()).expect("a whole file");
    let mut new = old.clone();
    let halved: Vec<HemisphereVectors> =
        old.vectors().iter().map(|v| v.map(|h| h.map(|c| c.map(|x| 0.5 * x)))).collect();
    halved.iter().enumerate().for_each(|(index, vectors)| new.set(index, vectors));
    let record = |source: &IrradianceGrid, generation| {
        let id = RecordId::Bundle(2);
        let bytes = encode_record(&source.as_source(), &header, id, generation).expect("the same file");
        move |header: &Header, grid: &mut IrradianceGrid| {
            grid.accept(&decode_record(header, id, &bytes).expect("a sound record"))
        }
    };
    let in_bundle: Vec<u64> = header.bundle_vertices(2).expect("a bundle").collect();
    for (source, generation, expected) in [(&new, 5, &new), (&old, 4, &new), (&old, 0, &new), (&old, 6, &old)]
    {
        record(source, generation)(&header, &mut read).expect("the same lattice");
        for index in 0..60 {
            let expected = if in_bundle.contains(&(index as u64)) { expected } else { &old };
            assert_eq!(read.get(index), expected.get(index), "generation {generation}, vertex {index}");
        }
    }
    // The same generation again is the same content: whatever comes under it changes nothing.
    record(&new, 6)(&header, &mut read).expect("the same lattice");
    assert_eq!(read.get(in_bundle[0] as usize), old.get(in_bundle[0] as usize));
}

#[test]
fn a_record_of_another_file_is_refused_and_changes_nothing() {
    let options = EncodeOptions { encoding: Encoding::VectorsF32, ..EncodeOptions::default() };
    let old = grid();
    let (mut read, _) = IrradianceGrid::from_file(
        &encode(&old.as_source(), &options).expect("a sound grid"),
        &Limits::default(),
    )
    .expect("a whole file");
    let mut new = old.clone();
    new.set(7, &[[[0.5; 3]; 3]; 6]);
    let other = encode(&new.as_source(), &options).expect("a sound grid");
    let mut refused = 0;
    decode_all(&other, &Limits::default(), |event| match read.accept(&event) {
        Err(GridError::OtherFile) => refused += 1,
        other => assert!(matches!(event, Event::End | Event::Chunk(_)), "{other:?} of {event:?}"),
    })
    .expect("a whole file");
    assert!(refused > 2, "header, corners and bundles");
    assert_eq!(read, old);
}

#[test]
fn bundles_longer_than_a_block_are_received_whole() {
    // 504 vertices less eight corners in one bundle: seven blocks and a part of one.
    let lattice = Lattice::new([9, 8, 7], [0.0; 3], [1.0; 3]).expect("a box");
    let vectors: Vec<HemisphereVectors> = (0..504).map(|n| [[[n as f32; 3]; 3]; 6]).collect();
    let radiance: Vec<RadianceHarmonics> =
        (1..505).map(|n| [[n as f32, 0., 0., 0., 0., 0., 0., 0., 0.]; 3]).collect();
    let read = |values: Values<'_>, encoding| {
        let options = EncodeOptions { encoding, vertices_per_slice: 64, ..EncodeOptions::default() };
        let file = encode(&GridSource::new(lattice, values), &options).expect("a sound grid");
        IrradianceGrid::from_file(&file, &Limits::default()).expect("a whole file").0
    };
    assert_eq!(read((&vectors).into(), Encoding::VectorsF32).vectors(), vectors);
    // Means below 512 are exact in nine bits.
    assert_eq!(read((&radiance).into(), Encoding::Sh2).radiance()[..], radiance[..]);
}
