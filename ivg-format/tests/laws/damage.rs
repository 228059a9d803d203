//! Truncated, flipped and overlong files.

use crate::files::{describe, edited, envelopes, full, header, one_shot, plain, samples};
use ivg_format::{BufferedDecoder, Encoding, Limits, RecordId, Verdict, decode_all, decode_record};
use ivg_wire::{ByteOffset, codes};

#[test]
fn the_samples_are_valid() {
    for file in samples() {
        let (events, error) = one_shot(&file);
        assert_eq!(error, None);
        assert_eq!(events.last().unwrap(), "End");
        assert_eq!(file.len() as u64, header(&file).file_bytes);
    }
}

#[test]
fn every_truncation_needs_more_and_loses_only_what_is_incomplete() {
    for file in samples() {
        let (all, _) = one_shot(&file);
        for n in 0..file.len() {
            let (events, error) = one_shot(&file[..n]);
            let error = error.unwrap();
            assert_eq!(
                (error.verdict(), error.offset()),
                (Verdict::NeedMore, ByteOffset(n as u64)),
                "{n} bytes"
            );
            assert!(all.starts_with(&events), "{n} bytes");
            let mut pushed = vec![];
            let mut decoder = BufferedDecoder::new(Limits::default());
            decoder.feed(&file[..n], |event| pushed.push(describe(&event))).unwrap();
            assert_eq!((pushed, decoder.finish()), (events, Err(error)), "{n} bytes");
        }
    }
}

#[test]
fn no_flipped_bit_is_accepted() {
    // Every byte of a file is covered by a checksum, padding and reserved fields included: nothing is ignorable.
    for file in samples() {
        for bit in 0..file.len() * 8 {
            let mut damaged = file.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            let (_, error) = one_shot(&damaged);
            assert!(error.is_some(), "bit {} of byte {} was accepted", bit % 8, bit / 8);
        }
    }
}

#[test]
fn no_byte_makes_a_reader_panic_even_with_fitting_checksums() {
    for file in samples() {
        let mut refused = 0;
        for at in 0..file.len() {
            for flip in [0x01, 0x80, 0xFF] {
                let (_, error) = one_shot(&edited(&file, |bytes| bytes[at] ^= flip));
                refused += usize::from(error.is_some());
            }
        }
        // Of the header, only the fields that hold free numbers are harmless.
        assert!(refused > 144, "{refused} of {}", file.len() * 3);
    }
}

#[test]
fn a_record_is_judged_alone_as_inside_its_file() {
    let file = full();
    let header = header(&file);
    for id in header.records() {
        let range = header.record_range(id);
        let bytes = &file[range.start as usize..range.end as usize];
        let alone = describe(&decode_record(&header, id, bytes).unwrap());
        assert!(one_shot(&file).0.contains(&alone), "{id:?}");
        for n in 0..bytes.len() {
            let error = decode_record(&header, id, &bytes[..n]).unwrap_err();
            assert_eq!(
                (error.verdict(), error.offset().0),
                (Verdict::NeedMore, range.start + n as u64),
                "{id:?}"
            );
        }
        let longer = [bytes, &[0]].concat();
        let error = decode_record(&header, id, &longer).unwrap_err();
        assert_eq!((error.code(), error.offset().0), (codes::RECORD_LENGTH.number(), range.end), "{id:?}");
        for at in 0..bytes.len() {
            let mut damaged = bytes.to_vec();
            damaged[at] ^= 0x10;
            assert_eq!(
                decode_record(&header, id, &damaged).unwrap_err().verdict(),
                Verdict::Invalid,
                "{id:?}"
            );
        }
    }
    for id in [RecordId::Bundle(0), RecordId::Bundle(header.bundle_count + 1), RecordId::Validity(1)] {
        assert_eq!(header.record_range(id), 0..0);
        assert_eq!(decode_record(&header, id, &[]).unwrap_err().code(), codes::RECORD_ID.number(), "{id:?}");
    }
}

#[test]
fn a_record_in_the_place_of_another_is_refused() {
    let file = plain([1, 5, 5], Encoding::PackedOct24, 1);
    let header = header(&file);
    let [first, second] = [1, 2].map(|k| header.record_range(RecordId::Bundle(k)));
    assert_eq!(first.end - first.start, second.end - second.start, "the two must be of one length");
    let mut swapped = file.clone();
    swapped[first.start as usize..first.end as usize]
        .copy_from_slice(&file[second.start as usize..second.end as usize]);
    let (_, error) = one_shot(&swapped);
    assert_eq!((error.unwrap().code(), error.unwrap().offset().0), (codes::RECORD_ID.number(), first.start));
}

#[test]
fn a_record_of_another_version_of_the_file_is_refused() {
    let lattice = crate::files::lattice([1, 3, 4]);
    let mut vectors = crate::files::vectors(&lattice);
    let options = crate::files::options(Encoding::VectorsF32, 1);
    let file =
        |vectors: &[_]| ivg_format::encode(&ivg_format::GridSource::new(lattice, vectors), &options).unwrap();
    let old = file(&vectors);
    vectors[0][0][0][0] += 1.0;
    let new = file(&vectors);
    // Only a corner differs, and yet no record of one file is accepted in the other.
    let ranges: Vec<_> = envelopes(&old);
    assert_eq!(ranges, envelopes(&new));
    for range in ranges {
        let mut mixed = new.clone();
        mixed[range.clone()].copy_from_slice(&old[range]);
        assert_eq!(one_shot(&mixed).1.unwrap().code(), codes::RECORD_CHECKSUM.number());
    }
}

#[test]
fn bytes_after_the_end_are_refused_in_file_mode() {
    for file in samples() {
        let longer = [&file[..], &[0]].concat();
        let error = decode_all(&longer, &Limits::default(), |_| {}).unwrap_err();
        assert_eq!((error.code(), error.offset().0), (codes::TRAILING_BYTES.number(), file.len() as u64));
    }
}

#[test]
fn a_higher_generation_is_reported() {
    let file = plain([1, 3, 2], Encoding::PackedOct24, 1);
    let at = header(&file).record_range(RecordId::Bundle(1)).start as usize;
    let (events, error) = one_shot(&edited(&file, |bytes| bytes[at + 4] = 9));
    assert_eq!(error, None);
    assert!(events.iter().any(|event| event.starts_with("Bundle(1) 9 ")), "{events:?}");
    let end = file.len() - 20;
    let (_, error) = one_shot(&edited(&file, |bytes| bytes[end + 4] = 9));
    assert_eq!(error.unwrap().code(), codes::END_MISMATCH.number());
}
