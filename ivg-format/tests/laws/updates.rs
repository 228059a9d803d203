//! Records that come again with a higher generation.

use crate::files::{
    bundles, describe, full, full_explicit, header, lattice, one_shot, options, ordered, plain, radiance,
    samples, vectors,
};
use ivg_format::{
    Arrival, ContentId, EncodeError, EncodeOptions, Encoding, Event, Generations, GridSource, Header, Limits,
    Order, RecordId, UpdateError, codes, decode_record, encode, encode_record, replace_record,
};
use quickcheck::quickcheck;
use std::collections::BTreeMap;

fn stored(file: &[u8], id: RecordId) -> &[u8] {
    let range = header(file).record_range(id);
    &file[range.start as usize..range.end as usize]
}

/// The light of generation `generation`: dimmer, so that the scale exponent of the file still holds it.
fn dimmer(values: &[ivg_format::HemisphereVectors], generation: u32) -> Vec<ivg_format::HemisphereVectors> {
    let factor = 1.0 / (1 + generation) as f32;
    values.iter().map(|vertex| vertex.map(|h| h.map(|channel| channel.map(|c| c * factor)))).collect()
}

#[test]
fn a_record_written_alone_fits_into_its_file() {
    let lattice = lattice([4, 5, 3]);
    let (values, harmonics, explicit) =
        (vectors(&lattice), radiance(&lattice), bundles(&lattice, 2, |_| true));
    let validity: Vec<u8> = (0..60).collect();
    for &order in Order::ALL {
        for &encoding in Encoding::ALL {
            let source = match encoding.quantity() {
                ivg_format::Quantity::Vectors => GridSource::new(lattice, &values),
                ivg_format::Quantity::Radiance => GridSource::new(lattice, &harmonics),
            };
            let bundles = (order == Order::Explicit).then_some(&explicit[..]);
            let source = GridSource { bundles, validity: Some(&validity), ..source };
            let file = encode(&source, &EncodeOptions { order, ..options(encoding, 2) }).unwrap();
            let header = header(&file);
            for id in header.records() {
                let alone = encode_record(&source, &header, id, 0).unwrap();
                assert_eq!(alone, stored(&file, id), "{order:?} {encoding:?} {id:?}");
                let replaceable = matches!(id, RecordId::Corners | RecordId::Bundle(_));
                let newer = encode_record(&source, &header, id, 3);
                if !replaceable {
                    assert_eq!(newer, Err(EncodeError::NeverReplaced { id }));
                    continue;
                }
                let mut replaced = file.clone();
                let newer = newer.unwrap();
                assert_eq!(replace_record(&mut replaced, &newer, &Limits::default()), Ok(Arrival::Newer));
                assert_eq!((stored(&replaced, id), one_shot(&replaced).1), (&newer[..], None));
                // The older one does not come back.
                let held = replaced.clone();
                assert_eq!(replace_record(&mut replaced, &alone, &Limits::default()), Ok(Arrival::Stale));
                assert_eq!(replace_record(&mut replaced, &newer, &Limits::default()), Ok(Arrival::Same));
                assert_eq!(replaced, held);
            }
        }
    }
}

#[test]
fn records_of_several_generations_are_a_valid_file() {
    let lattice = lattice([3, 4, 5]);
    let values = vectors(&lattice);
    let mut file = encode(&GridSource::new(lattice, &values), &options(Encoding::PackedOct24, 2)).unwrap();
    let header = header(&file);
    let ids: Vec<RecordId> = header.records().filter(|id| *id != RecordId::End).collect();
    for (generation, &id) in (0..).zip(&ids) {
        let light = dimmer(&values, generation);
        let record = encode_record(&GridSource::new(lattice, &light), &header, id, generation).unwrap();
        replace_record(&mut file, &record, &Limits::default()).unwrap();
    }
    assert_eq!(one_shot(&file).1, None);
    // Each vertex stands for its own record.
    for (generation, &id) in (0..).zip(&ids) {
        let light = dimmer(&values, generation);
        let alone = encode_record(&GridSource::new(lattice, &light), &header, id, generation).unwrap();
        let of = |bytes| describe(&decode_record(&header, id, bytes).unwrap());
        assert_eq!(of(stored(&file, id)), of(&alone));
    }
    assert_eq!(crate::files::header(&file), header, "the content id stays");
}

#[test]
fn what_an_update_cannot_say_is_refused() {
    let lattice = lattice([3, 4, 3]);
    let (values, listed) = (vectors(&lattice), bundles(&lattice, 2, |_| true));
    let source = GridSource { bundles: Some(&listed), ..GridSource::new(lattice, &values) };
    let options = EncodeOptions { order: Order::Explicit, ..options(Encoding::PackedOct24, 2) };
    let mut file = encode(&source, &options).unwrap();
    let header = header(&file);
    let id = RecordId::Bundle(2);
    let other = |what| Err(EncodeError::OtherFile { what });

    // Light that is 2¹⁶ times as bright as the file's scale allows for.
    let bright: Vec<_> = values.iter().map(|v| v.map(|h| h.map(|k| k.map(|c| c * 65_536.0)))).collect();
    let brighter = GridSource { values: (&bright).into(), ..source };
    assert!(matches!(
        encode_record(&brighter, &header, id, 1),
        Err(EncodeError::ScaleExponent { file, needed }) if file == header.scale_exponent && needed > file
    ));
    // Another lattice, validity that the file does not have, a record and bundles that it does not have.
    let longer = crate::files::lattice([3, 4, 4]);
    let longer_values = vectors(&longer);
    assert_eq!(encode_record(&GridSource::new(longer, &longer_values), &header, id, 1), other("lattice"));
    let validity = [255; 36];
    assert_eq!(
        encode_record(&GridSource { validity: Some(&validity), ..source }, &header, id, 1),
        other("validity")
    );
    assert_eq!(encode_record(&source, &header, RecordId::Bundle(99), 1), other("record"));
    let fewer =
        [listed.concat()[..6].to_vec(), listed.concat()[6..12].to_vec(), listed.concat()[12..].to_vec()];
    let fewer: Vec<Vec<u64>> =
        fewer.into_iter().flat_map(|b| b.chunks(8).map(<[u64]>::to_vec).collect::<Vec<_>>()).collect();
    assert_eq!(
        encode_record(&GridSource { bundles: Some(&fewer), ..source }, &header, id, 1),
        other("bundles")
    );

    // A list of the same length with other vertices: the encoder cannot know, the file does.
    let mut swapped = listed.clone();
    (swapped[1][0], swapped[2][0]) = (listed[2][0], listed[1][0]);
    let record = encode_record(&GridSource { bundles: Some(&swapped), ..source }, &header, id, 1);
    let before = file.clone();
    let refusal = replace_record(&mut file, &record.unwrap(), &Limits::default());
    assert_eq!((refusal, &file), (Err(UpdateError::OtherVertices { bundle: 2 }), &before));
    // The end record, a damaged record, one of another file.
    let end = stored(&file, RecordId::End).to_vec();
    let never = replace_record(&mut file, &end, &Limits::default());
    assert_eq!(never, Err(UpdateError::NeverReplaced { id: RecordId::End }));
    let mut damaged = encode_record(&source, &header, id, 1).unwrap();
    damaged[9] ^= 1;
    let elsewhere = stored(&full_explicit(), id).to_vec();
    for record in [damaged, elsewhere, vec![1, 0]] {
        assert!(matches!(
            replace_record(&mut file, &record, &Limits::default()),
            Err(UpdateError::Format(_))
        ));
    }
    assert_eq!(file, before);
    let text = UpdateError::OtherVertices { bundle: 2 }.to_string();
    assert!(text.contains("bundle 2"), "{text}");
}

#[test]
fn another_file_begins_anew() {
    let mut held = Generations::new();
    assert_eq!(held.admit(ContentId(1), RecordId::Corners, 7), Arrival::New);
    assert_eq!(held.admit(ContentId(1), RecordId::Corners, 6), Arrival::Stale);
    assert_eq!(held.admit(ContentId(2), RecordId::Corners, 0), Arrival::New);
    assert_eq!((held.generation(RecordId::Corners), held.len()), (Some(0), 1));
}

#[test]
fn stored_ids_are_those_of_the_records() {
    for file in samples() {
        for id in header(&file).records() {
            assert_eq!(RecordId::from_stored(id.stored()), id);
        }
    }
    assert_eq!(RecordId::from_stored(0x7FFF_FFFF), RecordId::Bundle(0x7FFF_FFFF));
    assert_eq!(RecordId::from_stored(0xFFFF_FFFE), RecordId::Validity(0x7FFF_FFFE));
}

/// A reader: of each record what it shows, kept as the specification says.
fn shown(header: &Header, arrivals: &[(RecordId, Vec<u8>)]) -> BTreeMap<RecordId, String> {
    let (mut held, mut shown) = (Generations::new(), BTreeMap::new());
    for (id, bytes) in arrivals {
        let event = decode_record(header, *id, bytes).unwrap();
        let (Event::Corners(bundle) | Event::Bundle(bundle)) = &event else { panic!("{id:?}") };
        if held.admit(header.content_id, *id, bundle.generation()) != Arrival::Stale {
            shown.insert(*id, describe(&event));
        }
    }
    shown
}

quickcheck! {
    fn any_interleaving_of_generations_ends_in_the_newest(order: u8, draws: Vec<(u8, u32)>) -> bool {
        let order = Order::ALL[usize::from(order) % Order::ALL.len()];
        let lattice = lattice([3, 3, 4]);
        let (values, listed) = (vectors(&lattice), bundles(&lattice, 2, |_| true));
        let bundles = (order == Order::Explicit).then_some(&listed[..]);
        let file = ordered([3, 3, 4], order, 2);
        let header = header(&file);
        let ids: Vec<RecordId> = header.records().filter(|id| *id != RecordId::End).collect();
        let record = |id, generation| {
            let light = dimmer(&values, generation % 5);
            let source = GridSource { bundles, ..GridSource::new(lattice, &light) };
            encode_record(&source, &header, id, generation).unwrap()
        };
        let draws: Vec<_> = draws
            .into_iter()
            .map(|(which, generation)| (ids[usize::from(which) % ids.len()], generation))
            .chain([(RecordId::Corners, u32::MAX), (RecordId::Corners, 0)])
            .collect();
        let mut newest = BTreeMap::new();
        for &(id, generation) in &draws {
            let most = newest.entry(id).or_insert(generation);
            *most = generation.max(*most);
        }
        let arrivals: Vec<_> = draws.iter().map(|&(id, g)| (id, record(id, g))).collect();
        let backwards: Vec<_> = arrivals.iter().rev().cloned().collect();
        let expected: Vec<_> = newest.into_iter().map(|(id, g)| (id, record(id, g))).collect();
        let expected = shown(&header, &expected);
        shown(&header, &arrivals) == expected && shown(&header, &backwards) == expected
    }
}

#[test]
fn a_validity_record_is_not_replaced_and_still_read() {
    let mut file = full();
    let record = stored(&file, RecordId::Validity(0)).to_vec();
    let never = replace_record(&mut file, &record, &Limits::default());
    assert_eq!(never, Err(UpdateError::NeverReplaced { id: RecordId::Validity(0) }));
    let missing = RecordId::Bundle(99).stored().to_le_bytes();
    let Err(UpdateError::Format(error)) = replace_record(&mut file, &missing, &Limits::default()) else {
        panic!("a record that the file does not have")
    };
    assert_eq!(error.code(), ivg_wire::codes::RECORD_ID.number());
    assert_ne!(codes::ALL.len(), 0);
    let small = plain([2, 2, 2], Encoding::PackedOct24, 1);
    assert!(replace_record(&mut small[..100].to_vec(), &record, &Limits::default()).is_err());
}

#[test]
fn headroom_leaves_room_for_brighter_records_and_costs_no_precision() {
    let lattice = lattice([3, 4, 2]);
    let first = vectors(&lattice);
    let brighter: Vec<_> = first.iter().map(|v| v.map(|h| h.map(|c| c.map(|x| 7.9 * x)))).collect();
    for encoding in [Encoding::PackedOct24, Encoding::PackedXyz24, Encoding::PairF16, Encoding::PairF32] {
        let written = |headroom| {
            let options = EncodeOptions { headroom, ..options(encoding, 4) };
            encode(&GridSource::new(lattice, &first), &options).unwrap()
        };
        let (tight, roomy) = (written(0), written(3));
        let [tight_header, roomy_header] = [&tight, &roomy].map(|file| header(file));
        let update =
            |header| encode_record(&GridSource::new(lattice, &brighter), header, RecordId::Bundle(1), 1);
        let scaled = encoding != Encoding::PairF32;
        let more = if scaled { 3 } else { 0 };
        assert_eq!(roomy_header.scale_exponent, tight_header.scale_exponent + more);
        assert_eq!(update(&tight_header).is_ok(), !scaled, "{}", encoding.name());
        update(&roomy_header).unwrap();
        // The numbers span less than 2^30: they are the same with room and without.
        let shown = |file: &[u8]| -> Vec<String> {
            let (events, _) = one_shot(file);
            events.into_iter().filter(|e| e.starts_with("Bundle") || e.starts_with("Corners")).collect()
        };
        assert_eq!(shown(&tight), shown(&roomy), "{}", encoding.name());
    }
}
