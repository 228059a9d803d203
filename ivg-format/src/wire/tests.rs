extern crate std;
use super::*;
use std::string::String;
use std::vec::Vec;

#[test]
fn every_field_lies_where_the_specification_says() {
    macro_rules! fields {
        ($($field:ident)*) => {
            [$((stringify!($field), COMMON_HEADER_BYTES + offset_of!(Specific, $field))),*]
        };
    }
    let ours = fields! {
        dims encoding origin step order scale_exponent vertices_per_slice seed bundle_count validity_records units
        reserved
    };
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../spec/tables/ivg.toml");
    let table: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    let spec: Vec<(String, usize)> = table["header"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| (row["name"].as_str().unwrap().into(), row["offset"].as_integer().unwrap() as usize))
        .collect();
    assert!(spec.iter().map(|(name, at)| (name.as_str(), *at)).eq(ours), "{spec:?}");
}
