use super::difference;
use crate::manifest::Test;

fn test(op: &str, format: &str) -> Test {
    let json = format!(
        r#"{{"id": "", "kind": "positive", "op": "{op}", "format": "{format}", "verdict": "ok", "why": "", "origin": ""}}"#
    );
    serde_json::from_str(&json).unwrap()
}

fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

/// A grid of 1 × 1 × 2 vertices of which one is there, with a light and no metadata.
fn grid() -> Vec<u8> {
    let mut out = words(&[1, 1, 2]);
    out.extend([0.5f64; 6].iter().flat_map(|x| x.to_le_bytes()));
    out.extend(words(&[0, 1, 1, 1, 2]));
    out.extend(b"ab");
    out.extend(words(&[0xFFFF_FFFF]));
    out.extend([1, 0, 255, 255, 0, 0]);
    out.extend(words(&[0x3F80_0000; 27]));
    out
}

#[test]
fn the_first_number_that_differs_is_named() {
    let (grid, ivg) = (grid(), test("decode", "ivg"));
    assert_eq!(difference(&ivg, &grid, &grid), None);
    let cases = [
        (8, "dims[2] (byte 8): expected 2, found 3"),
        (
            12,
            "origin[0] (byte 12): expected 5.000000e-1 (0x3FE0000000000000), found 5.000000e-1 (0x3FE0000000000001)",
        ),
        (64, "quantity (byte 64): expected 1, found 0"),
        (76, "bytes of the name"),
        (81, "light 0, name[1] (byte 81): expected 98, found 99"),
        (87, "received[1] (byte 87): expected 0, found 1"),
        (89, "validity[1] (byte 89): expected 255, found 254"),
        (
            97,
            "values[1], vertex 0, R, coefficient 1 (byte 96): expected 1.000000e0 (0x3F800000), found 1.000031e0 (0x3F800100)",
        ),
        (196, "values[26], vertex 0, B, coefficient 8 (byte 196)"),
    ];
    for (at, expected) in cases {
        let mut other = grid.clone();
        other[at] ^= 1;
        let found = difference(&ivg, &grid, &other).unwrap();
        assert!(found.contains(expected), "{at}: {found}");
    }
    let short = difference(&ivg, &grid, &grid[..grid.len() - 4]).unwrap();
    assert_eq!(short, "OUT has 196 bytes, expected 200; the same up to there");
}

/// A grid of irradiance vectors, whose first vertex has not arrived.
#[test]
fn values_are_named_by_vertex_hemisphere_channel_and_coordinate() {
    let mut grid = grid();
    grid[64] = 0;
    grid[86..88].copy_from_slice(&[0, 1]);
    grid.extend(words(&[0xBF80_0000; 27]));
    for (number, name) in [
        (0, "values[0], vertex 1, hemisphere +x, R, x ("),
        (17, "values[17], vertex 1, hemisphere -x, B, z ("),
        (31, "values[31], vertex 1, hemisphere -y, G, y ("),
        (53, "values[53], vertex 1, hemisphere -z, B, z ("),
    ] {
        let mut other = grid.clone();
        other[92 + 4 * number] ^= 1;
        let found = difference(&test("decode", "ivg"), &grid, &other).unwrap();
        assert!(found.starts_with(name), "{found}");
    }
}

#[test]
fn rows_of_prefixes_are_named_by_their_length() {
    let test = test("prefixes", "ivg");
    let (a, b) = (words(&[40, 0, 40, 1]), words(&[40, 0, 40, 2]));
    assert_eq!(difference(&test, &a, &b).unwrap(), "after 1 bytes: records (byte 12): expected 1, found 2");
}

#[test]
fn a_mesh_that_lies_about_its_counts_is_no_trouble() {
    let test = test("lod", "pmesh");
    let out = vec![0xEE; 400];
    let mut other = out.clone();
    other[399] = 0;
    assert!(difference(&test, &out, &other).is_some());
    assert!(difference(&test, &[], &other).is_some());
}
