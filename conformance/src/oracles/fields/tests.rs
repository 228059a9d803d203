use super::*;
use ivg_wire::{Step, splitmix64};

/// Inputs that are tried of each kind.
const INPUTS: u64 = 2000;

fn gets_past_the_header(format: Format, file: &[u8]) -> bool {
    match format {
        Format::Ivg => {
            matches!(ivg_format::Header::read(file, &Default::default()), Ok(Step::Consumed(..)))
        }
        Format::Pmesh => {
            matches!(pmesh_format::Header::read(file, &Default::default()), Ok(Step::Consumed(..)))
        }
    }
}

fn choices(seed: u64) -> Vec<u8> {
    let length = 8 + splitmix64(seed, 1000) % 60;
    (0..length).map(|n| splitmix64(seed, n) as u8).collect()
}

#[test]
fn without_edits_the_file_is_the_vector() {
    for format in [Format::Ivg, Format::Pmesh] {
        let accepted: Vec<Vec<u8>> = vectors()
            .into_iter()
            .filter(|vector| {
                vector.format == format && vector.code.is_none() && vector.bytes.len() <= LONGEST
            })
            .map(|vector| vector.bytes)
            .collect();
        assert_eq!(bases(format).len(), accepted.len());
        for (n, file) in (0u16..).zip(accepted) {
            assert_eq!(edited(format, &n.to_le_bytes()), file);
        }
    }
}

#[test]
fn most_edited_files_get_past_the_header() {
    for format in [Format::Ivg, Format::Pmesh] {
        let passed = (0..INPUTS)
            .filter(|&seed| gets_past_the_header(format, &edited(format, &choices(seed))))
            .count() as u64;
        println!("{}: {passed} of {INPUTS} past the header", format.name());
        assert!(3 * passed > INPUTS, "{passed} of {INPUTS} {} files get past the header", format.name());
    }
}
