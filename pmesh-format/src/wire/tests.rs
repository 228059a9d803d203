use std::string::String;
use std::vec::Vec;

use super::*;
use crate::storage::Mode;

fn rows(key: &str) -> Vec<toml::Table> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../spec/tables/pmesh.toml");
    let table: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    table[key].as_array().unwrap().iter().map(|row| row.as_table().unwrap().clone()).collect()
}

fn fields(key: &str) -> Vec<(String, u64)> {
    let field = |row: &toml::Table| {
        (row["name"].as_str().unwrap().into(), row["offset"].as_integer().unwrap().try_into().unwrap())
    };
    rows(key).iter().map(field).collect()
}

#[test]
fn every_field_lies_where_the_specification_says() {
    for (key, ours) in [("header", at::HEADER), ("entry", at::ENTRY)] {
        let spec = fields(key);
        assert!(
            spec.iter().map(|(name, at)| (name.as_str(), *at)).eq(ours.iter().copied()),
            "{key}: {spec:?}"
        );
    }
}

#[test]
fn the_arrays_of_a_packet_follow_each_other_as_the_specification_says() {
    let all = Attributes { normals: true, uvs: true, colours: true, materials: true, seams: true };
    let counts = PacketCounts { vertices: 5, wedges: 7, faces: 11, splits: 3, end_vertex: 9 };
    let layout = PacketLayout::new(counts, all, Positions::F32).unwrap();
    let ours = [
        ("switch_count", &layout.switch_count),
        ("positions", &layout.positions),
        ("normals", &layout.normals),
        ("uvs", &layout.uvs),
        ("colours", &layout.colours),
        ("corners", &layout.corners),
        ("materials", &layout.materials),
        ("parents", &layout.parents),
    ];
    let mut start = 0;
    let spec = rows("payload");
    // Lengths of what comes behind the parents do not follow from the directory.
    assert_eq!(spec[ours.len()]["name"].as_str(), Some("wedge_counts"));
    for (row, (name, range)) in spec.iter().zip(ours) {
        let (count, bits) = match row["count"].as_str().unwrap() {
            "1" => (1, 0),
            "v" => (5, 0),
            "w" => (7, 0),
            "f" => (11, 0),
            // ⌈log₂ 9⌉
            "s, b bits each" => (3, 4usize),
            other => panic!("{other}"),
        };
        let bytes = match row["type"].as_str().unwrap() {
            "f32[3]" | "u32[3]" => 12,
            "f32[2]" => 8,
            "u8[4]" | "u32" => 4,
            "u16" => 2,
            "packed" => 0,
            other => panic!("{other}"),
        };
        let length = count * bytes + (count * bits).div_ceil(8);
        assert_eq!((row["name"].as_str().unwrap(), range.clone()), (name, start..start + length));
        start += length;
    }
    assert_eq!(layout.parent_bits, 4);
    assert_eq!(layout.rest, start);
    // What a file does not have takes no room.
    let none = PacketLayout::new(counts, Attributes::default(), Positions::F32).unwrap();
    assert_eq!(none.rest, 4 + 5 * 12 + 11 * 12 + 2);
    // Quantised positions are four u16.
    let quantised = PacketLayout::new(counts, all, Positions::Quantised(10)).unwrap();
    assert_eq!((quantised.positions, quantised.rest), (4..4 + 5 * 8, layout.rest - 5 * 4));
}

#[test]
fn attribute_bits_are_those_of_the_specification() {
    let rows = rows("attributes");
    assert_eq!(rows.len(), 5);
    for (bit, row) in rows.iter().enumerate() {
        assert_eq!(row["bit"].as_integer(), Some(bit as i64));
        let one = Attributes::from_bits(1 << bit).unwrap();
        let set = [
            ("normals", one.normals),
            ("uvs", one.uvs),
            ("colours", one.colours),
            ("materials", one.materials),
            ("seams", one.seams),
        ];
        let named: Vec<&str> = set.into_iter().filter(|(_, set)| *set).map(|(name, _)| name).collect();
        assert_eq!(named, [row["name"].as_str().unwrap()]);
        assert_eq!(one.bits(), 1 << bit);
    }
    assert!((5..16).all(|bit| Attributes::from_bits(1 << bit).is_none()));
}

#[test]
fn registries_name_what_this_crate_reads() {
    let name = |key: &str, id: u8| match key {
        "modes" => Mode::from_id(id).map(Mode::name),
        _ => Positions::from_id(id).map(Positions::name),
    };
    for key in ["modes", "positions"] {
        let rows = rows(key);
        for (id, row) in (0u8..).zip(&rows) {
            assert_eq!(row["id"].as_integer(), Some(id.into()));
            let expected =
                (row["status"].as_str() != Some("forbidden")).then(|| row["name"].as_str().unwrap());
            assert_eq!(name(key, id), expected, "{key}: {row:?}");
        }
        assert_eq!(name(key, rows.len() as u8), None, "{key}: the next is reserved");
    }
    assert!(
        Mode::ALL.iter().all(|&m| Mode::from_name(m.name()) == Some(m) && Mode::from_id(m.id()) == Some(m))
    );
    for &positions in Positions::ALL {
        assert_eq!(Positions::from_name(positions.name()), Some(positions));
        assert_eq!(Positions::from_id(positions.id()), Some(positions));
    }
    assert_eq!((Positions::Quantised(9).id(), Positions::Quantised(17).name()), (0, "-"));
    let chunks = rows("chunks");
    let ours = [(DIRECTORY, true), (MATERIALS, false)];
    assert_eq!(chunks.len(), ours.len());
    for (row, (kind, critical)) in chunks.iter().zip(ours) {
        assert_eq!(row["type"].as_str().unwrap().as_bytes(), kind.0);
        assert_eq!(row["critical"].as_bool(), Some(critical));
    }
}
