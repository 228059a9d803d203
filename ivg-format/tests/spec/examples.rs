//! The files that the specification prints byte by byte.

use super::{path, read};
use ivg_format::{
    Arrival, BakedLight, EncodeOptions, Encoding, Event, GridSource, Header, Lattice, Limits, Order,
    RadianceHarmonics, RecordId, Step, decode_all, encode, encode_record, replace_record,
};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The first grid of the section "Two files, byte by byte".
fn example() -> Vec<u8> {
    let lattice = Lattice::new([1, 1, 3], [0.0; 3], [0.0, 0.0, 2.0]).unwrap();
    let mut vectors = vec![[[[0.0; 3]; 3]; 6]; 3];
    vectors[0][4] = [[0.0, 0.0, 1.0]; 3];
    vectors[1][0] = [[0.5, 0.0, 0.0], [0.25, 0.0, 0.0], [0.0; 3]];
    let source = GridSource { meta: &[("generator", "by hand")], ..GridSource::new(lattice, &vectors) };
    encode(&source, &EncodeOptions { vertices_per_slice: 1, ..EncodeOptions::new() }).unwrap()
}

/// The bytes printed there: lines of offset, two spaces, bytes, two spaces, meaning.
fn printed(mark: &str) -> Vec<u8> {
    let text = read("ivg.md");
    let mut bytes = vec![];
    for line in block(&text, mark).lines() {
        let (offset, rest) = line.split_once("  ").unwrap();
        let (hex, _meaning) = rest.split_once("  ").unwrap_or((rest, ""));
        assert_eq!(usize::from_str_radix(offset, 16), Ok(bytes.len()), "{line}");
        bytes.extend(hex.split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap()));
    }
    bytes
}

/// The lines between a mark and its end.
fn block<'a>(text: &'a str, mark: &str) -> &'a str {
    let (_, after) = text.split_once(&format!("<!-- {mark} -->\n```\n")).expect("the example's mark");
    after.split_once("```\n<!-- end -->").expect("the example's end").0
}

#[test]
fn the_worked_example_is_what_the_encoder_writes_and_the_decoder_reads() {
    let bytes = printed("example");
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

/// Light of one channel from the direction +x alone, with a mean coefficient of `mean`.
fn from_x(mean: f32) -> [f32; 9] {
    [1.0, 0.0, 0.0, 3f32.sqrt(), 0.0, 0.0, -(5f32.sqrt()) / 2.0, 0.0, 15f32.sqrt() / 2.0].map(|c| c * mean)
}

/// The same radiance from everywhere.
fn uniform(mean: f32) -> [f32; 9] {
    let mut coefficients = [0.0; 9];
    coefficients[0] = mean;
    coefficients
}

/// Values of the second grid: before its update, and after.
fn second_values() -> [[RadianceHarmonics; 8]; 2] {
    let dark = [uniform(0.0); 3];
    let mut values = [dark; 8];
    values[0] = [uniform(1.0); 3];
    values[4] = [from_x(1.0), from_x(0.5), uniform(0.0)];
    let before = values;
    values[2] = [uniform(0.25); 3];
    values[5] = [from_x(0.25), uniform(0.0), uniform(0.0)];
    [before, values]
}

/// The second grid of the section: order `explicit`, harmonics, validity, a light, a bundle that was replaced.
fn second() -> Vec<u8> {
    let lattice = Lattice::new([2, 1, 4], [0.0; 3], [1.0, 0.0, 3.0]).unwrap();
    let [before, after] = second_values();
    let bundles = [vec![4], vec![2, 5]];
    let source = |values| GridSource {
        validity: Some(&[255, 255, 255, 0, 128, 255, 255, 255]),
        blocked_edges: Some(&[0, 0b100, 0b001, 0b100, 0, 0, 0, 0]),
        bundles: Some(&bundles),
        lights: &[BakedLight { name: "sun", direct_included: true }],
        ..GridSource::new(lattice, values)
    };
    let options = EncodeOptions {
        encoding: Encoding::Sh2,
        order: Order::Explicit,
        vertices_per_slice: 1,
        ..EncodeOptions::new()
    };
    let mut file = encode(&source(&before), &options).unwrap();
    let Ok(Step::Consumed(_, header)) = Header::read(&file, &Limits::default()) else { panic!("a header") };
    let newer = encode_record(&source(&after), &header, RecordId::Bundle(2), 1).unwrap();
    assert_eq!(replace_record(&mut file, &newer, &Limits::default()), Ok(Arrival::Newer));
    file
}

/// What the bytes of the second file are: lengths and meanings, one after the other.
fn second_meanings() -> Vec<(usize, String)> {
    let mut all: Vec<(usize, String)> = [
        (8, "magic"),
        (4, "version 0.1"),
        (8, "required, optional features"),
        (4, "header_bytes"),
        (4, "reserved"),
        (4, "header_crc"),
        (8, "content_id"),
        (8, "data_offset"),
        (8, "file_bytes"),
        (6, "dims"),
        (2, "encoding sh2-28"),
        (24, "origin"),
        (24, "step"),
        (2, "order explicit"),
        (2, "scale_exponent = -15"),
        (4, "vertices_per_slice: at most 1 × 4 in a bundle"),
        (8, "seed, without a meaning"),
        (4, "bundle_count"),
        (4, "validity_records"),
        (1, "units radiometric"),
        (7, "reserved"),
        (4, "chunk type DIRE"),
        (4, "flags: critical; reserved"),
        (8, "length = 16"),
        (8, "bundle 1: 1 vertex, 1 index byte"),
        (8, "bundle 2: 2 vertices, 2 index bytes"),
        (4, "padding"),
        (4, "crc"),
        (4, "chunk type LITE"),
        (4, "flags: ancillary; reserved"),
        (8, "length = 11"),
        (4, "1 light"),
        (4, "its direct light is in the grid; reserved; name length"),
        (3, "name \"sun\""),
        (1, "padding"),
        (4, "crc"),
    ]
    .map(|(length, meaning)| (length, meaning.to_string()))
    .to_vec();
    let mut record = |id: &str, generation: &str, parts: Vec<(usize, String)>| {
        let payload: usize = parts.iter().map(|(length, _)| length).sum();
        all.extend([(4, format!("record id: {id}")), (4, generation.to_string())]);
        all.extend(parts);
        let padding = payload.next_multiple_of(4) - payload;
        all.extend((padding > 0).then(|| (padding, "padding".to_string())));
        all.push((4, "crc".to_string()));
    };
    let values = |vertices: &[u64]| {
        let means = vertices.iter().map(|v| (4, format!("vertex {v} c0 of red, green, blue")));
        let ratios = vertices.iter().flat_map(|v| {
            ["red", "green", "blue"].map(|channel| (8, format!("vertex {v} ratios 1 to 8 of {channel}")))
        });
        means.chain(ratios).collect::<Vec<_>>()
    };
    let list = |length: usize, text: &str| vec![(length, format!("list: {text}"))];
    record("corners", "generation", values(&[0, 1, 6, 7]));
    let validity = [(8, "validity of vertices 0 to 7"), (3, "blocked edges: 3 bits a vertex")];
    record("validity 0", "generation", validity.map(|(length, text)| (length, text.to_string())).to_vec());
    record("bundle 1", "generation", [list(1, "4"), values(&[4])].concat());
    record("bundle 2", "generation: replaced once", [list(2, "2, then 5 - 2 - 1"), values(&[2, 5])].concat());
    record("end", "generation", vec![(8, "file_bytes".to_string())]);
    all
}

/// The file as it is printed: at most 12 bytes a line.
fn hexadecimal(bytes: &[u8], meanings: &[(usize, String)]) -> String {
    let (mut out, mut at) = (String::new(), 0);
    for (length, meaning) in meanings {
        let (end, lines) = (at + length, length.div_ceil(12));
        for (n, line) in bytes[at..end].chunks(12).enumerate() {
            let hex: Vec<String> = line.iter().map(|byte| format!("{byte:02X}")).collect();
            let hex = hex.join(" ");
            let offset = at + 12 * n;
            // The meaning stands beside the last line.
            let meaning = if n + 1 == lines { meaning.as_str() } else { "" };
            writeln!(out, "{}", format!("{offset:03X}  {hex:35}   {meaning}").trim_end()).unwrap();
        }
        at = end;
    }
    assert_eq!(at, bytes.len(), "the meanings do not cover the file");
    out
}

#[test]
fn the_second_example_is_what_the_encoder_writes_and_the_decoder_reads() {
    let file = second();
    let expected = hexadecimal(&file, &second_meanings());
    if std::env::var_os("IVG_BLESS").is_some() {
        let text = read("ivg.md");
        let old = block(&text, "second example").to_string();
        let mark = "<!-- second example -->\n```\n";
        std::fs::write(path("ivg.md"), text.replace(&format!("{mark}{old}"), &format!("{mark}{expected}")))
            .unwrap();
        return;
    }
    assert_eq!(block(&read("ivg.md"), "second example"), expected);
    assert_eq!(printed("second example"), file);
    let [_, values] = second_values();
    let (mut received, mut generations) = (BTreeMap::new(), vec![]);
    let (mut validity, mut edges): (Vec<u8>, Vec<u8>) = (vec![], vec![]);
    decode_all(&file, &Limits::default(), |event| match event {
        Event::Corners(bundle) | Event::Bundle(bundle) => {
            generations.push(bundle.generation());
            received.extend((0..bundle.len()).zip(bundle.vertices()).map(|(n, v)| (v, bundle.radiance(n))));
        }
        Event::Validity(block) => {
            validity.extend(block.validity());
            edges.extend((0..block.len()).map(|n| block.blocked_edges(n)));
        }
        _ => {}
    })
    .unwrap();
    assert_eq!(generations, [0, 0, 1]);
    assert_eq!(validity, [255, 255, 255, 0, 128, 255, 255, 255]);
    assert_eq!(edges, [0, 0b100, 0b001, 0b100, 0, 0, 0, 0]);
    assert!(received.keys().copied().eq([0, 1, 2, 4, 5, 6, 7]), "all but the one inside geometry");
    for (vertex, found) in received {
        let pairs = found.iter().flatten().zip(values[vertex as usize].iter().flatten());
        // Means are powers of two and ratios at their bounds, so what is left are the roundings of products.
        assert!(pairs.clone().all(|(a, b)| (a - b).abs() <= 3.0 * f32::EPSILON * b.abs()), "vertex {vertex}");
    }
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
