//! The files that the specification prints byte by byte.

use super::read;
use ivg_format::{BakedLight, EncodeOptions, Event, GridSource, Lattice, Limits, decode_all, encode};
use std::collections::BTreeMap;

/// The grid of the section "A file, byte by byte".
fn example() -> Vec<u8> {
    let lattice = Lattice::new([1, 1, 3], [0.0; 3], [0.0, 0.0, 2.0]).unwrap();
    let mut vectors = vec![[[[0.0; 3]; 3]; 6]; 3];
    vectors[0][4] = [[0.0, 0.0, 1.0]; 3];
    vectors[1][0] = [[0.5, 0.0, 0.0], [0.25, 0.0, 0.0], [0.0; 3]];
    let source = GridSource { meta: &[("generator", "by hand")], ..GridSource::new(lattice, &vectors) };
    encode(&source, &EncodeOptions { vertices_per_slice: 1, ..EncodeOptions::new() }).unwrap()
}

/// The bytes printed there: lines of offset, two spaces, bytes, two spaces, meaning.
fn printed() -> Vec<u8> {
    let text = read("ivg.md");
    let (_, after) = text.split_once("<!-- example -->\n```\n").expect("the example's mark");
    let (block, _) = after.split_once("```\n<!-- end -->").expect("the example's end");
    let mut bytes = vec![];
    for line in block.lines() {
        let (offset, rest) = line.split_once("  ").unwrap();
        let (hex, _meaning) = rest.split_once("  ").unwrap_or((rest, ""));
        assert_eq!(usize::from_str_radix(offset, 16), Ok(bytes.len()), "{line}");
        bytes.extend(hex.split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap()));
    }
    bytes
}

#[test]
fn the_worked_example_is_what_the_encoder_writes_and_the_decoder_reads() {
    let bytes = printed();
    let ours = example();
    let differing: Vec<usize> = (0..ours.len()).filter(|&at| bytes.get(at) != ours.get(at)).collect();
    assert!(differing.is_empty() && bytes.len() == ours.len(), "the encoder differs at {differing:x?}");
    let mut received = BTreeMap::new();
    decode_all(&bytes, &Limits::default(), |event| {
        if let Event::Corners(bundle) | Event::Bundle(bundle) = event {
            received.extend(bundle.vertices().zip((0..bundle.len()).map(|n| bundle.vectors(n))));
        }
    })
    .unwrap();
    assert_eq!(received[&0][4], [[0.0, 0.0, 1.0]; 3]);
    assert_eq!(received[&1][0], [[0.5, 0.0, 0.0], [0.25, 0.0, 0.0], [0.0; 3]]);
    assert_eq!(received[&2], [[[0.0; 3]; 3]; 6]);
}

#[test]
fn the_light_entry_is_laid_out_as_its_clause_says() {
    let lattice = Lattice::new([1, 1, 1], [0.0; 3], [0.0; 3]).unwrap();
    let vectors = [[[[0.0; 3]; 3]; 6]];
    let lights = [BakedLight { name: "sun", direct_included: true }];
    let source = GridSource { lights: &lights, ..GridSource::new(lattice, &vectors) };
    let file = encode(&source, &EncodeOptions::new()).unwrap();
    let payload = [1, 0, 0, 0, 1, 0, 3, 0, b's', b'u', b'n'];
    assert_eq!(file[144..][..8], *b"LITE\0\0\0\0");
    assert_eq!(file[152..][..8], 11u64.to_le_bytes());
    assert_eq!(file[160..][..11], payload);
}
