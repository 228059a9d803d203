//! Numbers that the documents print and those of `spec/tables/values.toml`, computed by this code.

use super::{read, rows};
use ivg_format::quant::{direction, rgb9e5};
use ivg_format::{
    Bundle, Decoder, EncodeOptions, Encoding, Event, GridSource, Header, Lattice, Limits, RecordId, encode,
};
use ivg_wire::{Step, seal, seal_header, splitmix64};
use std::fmt::Write;
use toml::Value;

fn integers(value: &Value) -> Vec<i64> {
    value.as_array().unwrap().iter().map(|n| n.as_integer().unwrap()).collect()
}

fn strings(value: &Value) -> Vec<&str> {
    value.as_array().unwrap().iter().map(|text| text.as_str().unwrap()).collect()
}

/// The table of one quantiser as it stands in the document.
pub(super) fn markdown(quantiser: &str) -> String {
    let list = |words: Vec<String>| words.join(", ");
    let numbers =
        |value: &Value| list(integers(value).iter().map(|n| n.to_string().replace('-', "−")).collect());
    let bits = |value: &Value| list(integers(value).iter().map(|n| format!("0x{n:08X}")).collect());
    let mut out = String::new();
    out.push_str(match quantiser {
        "rgb9e5" => "| colour | code | |\n|---|---|---|\n",
        "packing" => {
            "| encoding | scale_exponent | hemisphere | direction | colour |\n|---|---|---|---|---|\n"
        }
        "ratio" => "| c_0 | codes 1 to 8 | c_1 … c_8, as the bits of binary32 |\n|---|---|---|\n",
        _ => "| code | u, v | point | direction, as the bits of binary32 |\n|---|---|---|---|\n",
    });
    for row in rows("values", quantiser) {
        let code = |digits: usize| format!("0x{:0digits$X}", row["code"].as_integer().unwrap());
        let line = match quantiser {
            "rgb9e5" => {
                let texts = strings(&row["colour"]);
                let colour = texts.iter().map(|c| c.replace('-', "−").replace("nan", "NaN"));
                [list(colour.collect()), code(8), row["text"].as_str().unwrap().into()].join(" | ")
            }
            "packing" => {
                let words = |key: &str| list(strings(&row[key]).into_iter().map(String::from).collect());
                let encoding = format!("`{}`", row["encoding"].as_str().unwrap());
                let exponent = row["scale_exponent"].as_integer().unwrap().to_string().replace('-', "−");
                let hemisphere = row["hemisphere"].as_str().unwrap().replace('-', "−");
                [encoding, exponent, hemisphere, words("direction"), words("colour")].join(" | ")
            }
            "ratio" => {
                let mean = row["mean"].as_str().unwrap().to_string();
                [mean, numbers(&row["codes"]), bits(&row["coefficients"])].join(" | ")
            }
            _ => [code(6), numbers(&row["map"]), numbers(&row["point"]), bits(&row["direction"])].join(" | "),
        };
        writeln!(out, "| {line} |").unwrap();
    }
    out
}

#[test]
fn colours_have_the_printed_codes() {
    let table = rows("values", "rgb9e5");
    assert!(table.len() >= 8, "the table was not read");
    for row in table {
        let colour: Vec<f32> = strings(&row["colour"]).iter().map(|c| c.parse().unwrap()).collect();
        let code = rgb9e5::encode([colour[0], colour[1], colour[2]]);
        assert_eq!(Some(i64::from(code)), row["code"].as_integer(), "{colour:?} became {code:#010X}");
    }
}

#[test]
fn directions_have_the_printed_bits() {
    let table = rows("values", "direction");
    assert!(table.len() >= 7, "the table was not read");
    for row in table {
        let code = row["code"].as_integer().unwrap();
        let map = integers(&row["map"]);
        assert_eq!(code, (map[0] + 2047) + 4096 * (map[1] + 2047), "IVG-DIR-01");
        let decoded = direction::decode_octahedral24(code as u32).unwrap();
        let bits: Vec<i64> = decoded.iter().map(|c| i64::from(c.to_bits())).collect();
        assert_eq!(bits, integers(&row["direction"]), "{code:#08X}");
    }
}

/// The numbers in a clause's text that are written as `0x…`.
fn hexadecimal(document: &str, clause: &str) -> Vec<u64> {
    let text = read(document);
    let (_, after) = text.split_once(&format!("**{clause}**")).unwrap_or_else(|| panic!("{clause}"));
    let (clause, _) = after.split_once("\n\n**").unwrap_or((after, ""));
    clause
        .split("0x")
        .skip(1)
        .map(|rest| {
            let digits: String = rest.chars().take_while(char::is_ascii_hexdigit).collect();
            u64::from_str_radix(&digits, 16).unwrap()
        })
        .collect()
}

#[test]
fn the_generator_gives_the_printed_numbers() {
    let [_, _, _, first, second, seed, last] = hexadecimal("common.md", "COM-INT-02")[..] else {
        panic!("three constants, two numbers, a seed, a number")
    };
    assert_eq!([splitmix64(0, 0), splitmix64(0, 1), splitmix64(seed, 42)], [first, second, last]);
}

#[test]
fn positions_are_a_product_and_a_sum_each_rounded() {
    // The numbers of IVG-LAT-04. Fused, or with the step multiplied out differently, the result is 2^-55.
    let lattice = Lattice { dims: [4, 1, 1], origin: [-0.3, 0.0, 0.0], step: [0.1, 0.0, 0.0] };
    assert_eq!(lattice.check(), Ok(()));
    let x = lattice.position(3, 0, 0)[0];
    assert_eq!(x, 2f64.powi(-54));
    assert_eq!(0.1f64.mul_add(3.0, -0.3), 2f64.powi(-55), "otherwise the numbers show nothing");
    assert!(read("ivg.md").contains("2⁻⁵⁴"), "IVG-LAT-04 prints the result");
}

#[test]
fn harmonics_have_the_printed_bits() {
    let table = rows("values", "ratio");
    assert!(table.len() >= 3, "the table was not read");
    let lattice = Lattice::new([1, 1, 1], [0.0; 3], [0.0; 3]).unwrap();
    let radiance = [[[0.0; 9]; 3]];
    let options = EncodeOptions { encoding: Encoding::Sh2, ..EncodeOptions::new() };
    let file = encode(&GridSource::new(lattice, &radiance), &options).unwrap();
    for row in table {
        let mean: f32 = row["mean"].as_str().unwrap().parse().unwrap();
        let codes: Vec<u8> = integers(&row["codes"]).iter().map(|&code| code as i8 as u8).collect();
        // Red alone: its mean, and the first eight codes.
        let payload = [&rgb9e5::encode([mean, 0.0, 0.0]).to_le_bytes()[..], &codes].concat();
        let file = with_corner(&file, 0, &payload);
        let [red, ..] = of_corner(&file, |bundle| bundle.radiance(0));
        let bits: Vec<i64> = red[1..].iter().map(|c| i64::from(c.to_bits())).collect();
        assert_eq!((red[0], bits), (mean, integers(&row["coefficients"])), "{row:?}");
    }
}

/// The file of one vertex with another scale exponent, and bytes at the beginning of the corners' payload.
fn with_corner(file: &[u8], scale_exponent: i16, payload: &[u8]) -> Vec<u8> {
    let mut file = file.to_vec();
    file[114..116].copy_from_slice(&scale_exponent.to_le_bytes());
    seal_header(&mut file[..144]);
    let Ok(Step::Consumed(_, header)) = Header::read(&file, &Limits::default()) else { panic!("a header") };
    let range = header.record_range(RecordId::Corners);
    let record = &mut file[range.start as usize..range.end as usize];
    record[8..8 + payload.len()].copy_from_slice(payload);
    seal(record, header.content_id);
    file
}

/// What a bundle shows of the corners of a file.
fn of_corner<T>(file: &[u8], show: impl Fn(&Bundle<'_>) -> T) -> T {
    let (mut decoder, mut rest) = (Decoder::new(Limits::default()), file);
    while let Step::Consumed(used, event) = decoder.push(rest).unwrap() {
        rest = &rest[used..];
        if let Event::Corners(bundle) = event {
            return show(&bundle);
        }
    }
    panic!("no corners")
}

/// The x of red of the first hemisphere of a file of one vertex, `vectors-f32`, as read with a scale exponent.
fn scaled(number: f32, scale_exponent: i16) -> f32 {
    let lattice = Lattice::new([1, 1, 1], [0.0; 3], [0.0; 3]).unwrap();
    let vectors = [[[[0.0; 3]; 3]; 6]];
    let options = EncodeOptions { encoding: Encoding::VectorsF32, ..EncodeOptions::new() };
    let file = encode(&GridSource::new(lattice, &vectors), &options).unwrap();
    of_corner(&with_corner(&file, scale_exponent, &number.to_le_bytes()), |bundle| bundle.vectors(0)[0][0][0])
}

#[test]
fn scaled_vectors_are_rounded_once_to_nearest_with_ties_to_even() {
    let bits = |number: f32, exponent| scaled(number, exponent).to_bits();
    // Subnormal results: 2^-100 × 2^-49 is the least number there is, one and a half of it lies half-way between 1 and
    // 2 of it, two and a half half-way between 2 and 3.
    let unit = 2f32.powi(-100);
    assert_eq!(bits(unit, -49), 1);
    assert_eq!(bits(1.5 * unit, -49), 2);
    assert_eq!(bits(2.5 * unit, -49), 2);
    assert_eq!(bits(0.5 * unit, -49), 0, "half of the least number is even as 0");
    assert_eq!(bits(0.5 * unit * (1.0 + f32::EPSILON), -49), 1);
    assert_eq!(bits(-0.0, -49), (-0.0f32).to_bits(), "the sign of a zero is kept");
    assert_eq!(scaled(1.5, 112), 1.5 * 2f32.powi(112));
}

#[test]
fn the_file_of_the_overview_has_the_printed_sizes() {
    let lattice = Lattice::new([32; 3], [0.0; 3], [1.0; 3]).unwrap();
    let vectors = vec![[[[0.0; 3]; 3]; 6]; 32 * 32 * 32];
    let validity = vec![255; vectors.len()];
    let source = GridSource { validity: Some(&validity), ..GridSource::new(lattice, &vectors) };
    let file = encode(&source, &EncodeOptions::new()).unwrap();
    let Ok(Step::Consumed(_, header)) = Header::read(&file, &Limits::default()) else { panic!("a header") };
    let bytes = |id| {
        let range = header.record_range(id);
        range.end - range.start
    };
    let text = read("ivg.md");
    let (overview, _) = text.split_once("\n## 1. ").unwrap();
    let sizes = [
        (RecordId::Corners, "  348 B "),
        (RecordId::Validity(7), " 8 × 5,644 B "),
        (RecordId::Bundle(15), " 15 × 86,028 B "),
        (RecordId::Bundle(16), " 85,692 B "),
        (RecordId::End, " 20 B\n"),
    ];
    for (id, printed) in sizes {
        let number = printed.rsplit('×').next().unwrap().trim().trim_end_matches(" B").replace(',', "");
        assert!(overview.contains(printed), "{printed:?} is not printed");
        assert_eq!(number.parse(), Ok(bytes(id)), "{id:?}");
    }
    assert_eq!((header.validity_records, header.bundle_count), (8, 16));
}

/// Numbers of `width` bytes each, as they lie in the payload.
fn stored(payload: &[u8], width: usize) -> Vec<String> {
    let number = |bytes: &[u8]| bytes.iter().rev().fold(0u64, |n, &b| n << 8 | u64::from(b));
    payload
        .chunks_exact(width)
        .map(|bytes| format!("0x{:0digits$X}", number(bytes), digits = 2 * width))
        .collect()
}

#[test]
fn packed_hemispheres_have_the_printed_numbers() {
    let mut vertex = [[[0.0; 3]; 3]; 6];
    vertex[4] = [[1.0, 0.0, 2.0], [0.0, 0.5, 1.0], [0.25, 0.25, 0.125]];
    vertex[1] = [[-1.0 / 1024.0, 4.0, 0.0], [-0.5, -1.0, 0.0], [0.0; 3]];
    let lattice = Lattice::new([1; 3], [0.0; 3], [0.0; 3]).unwrap();
    let table = rows("values", "packing");
    assert_eq!(table.len(), 8, "the table was not read");
    for row in table {
        let encoding = Encoding::from_name(row["encoding"].as_str().unwrap()).unwrap();
        let options = EncodeOptions { encoding, ..EncodeOptions::default() };
        let file = encode(&GridSource::new(lattice, &[vertex]), &options).unwrap();
        let Ok(Step::Consumed(_, header)) = Header::read(&file, &Limits::default()) else {
            panic!("the header of {}", encoding.name())
        };
        assert_eq!(Some(i64::from(header.scale_exponent)), row["scale_exponent"].as_integer());
        let range = header.record_range(RecordId::Corners);
        let payload = &file[range.start as usize + 8..];
        let hemisphere = if row["hemisphere"].as_str() == Some("+z") { 4 } else { 1 };
        // Bytes of a colour and of a direction, and of one number of each.
        let (colour, colour_number, direction, direction_number) = match encoding {
            Encoding::PackedOct24 => (4, 4, 3, 3),
            Encoding::PackedXyz24 => (4, 4, 3, 1),
            Encoding::PairF16 => (6, 2, 6, 2),
            _ => (12, 4, 12, 4),
        };
        let part = |start: usize, size: usize| &payload[start + hemisphere * size..][..size];
        assert_eq!(stored(part(0, colour), colour_number), strings(&row["colour"]), "{}", encoding.name());
        let found = stored(part(6 * colour, direction), direction_number);
        assert_eq!(found, strings(&row["direction"]), "{}", encoding.name());
    }
}
