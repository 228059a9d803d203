extern crate std;
use super::*;
use quickcheck::quickcheck;
use std::vec;

fn list(vertices: &[u64]) -> Vec<u8> {
    let mut out = vec![];
    write_list(&mut out, vertices.iter().copied());
    assert_eq!(out.len() as u64, list_len(vertices.iter().copied()));
    out
}

fn listed(bytes: &[u8], count: usize) -> Vec<u64> {
    let mut listed = Listed::new(bytes, count);
    std::iter::from_fn(|| listed.next()).collect()
}

#[test]
fn lists_are_those_of_the_specification() {
    // The worked values of the clause IVG-EXP-06.
    let vertices = [1, 2, 130, 131, 16_515];
    let bytes = [0x01, 0x00, 0x7F, 0x00, 0xFF, 0x7F];
    assert_eq!(list(&vertices), bytes);
    assert_eq!(listed(&bytes, 5), vertices);
    assert_eq!((list(&[128]), listed(&[0x80, 0x01], 1)), (vec![0x80, 0x01], vec![128]));
}

#[test]
fn the_largest_index_takes_seven_bytes() {
    let last = 65_535u64.pow(3) - 1;
    let bytes = list(&[last]);
    assert_eq!((bytes.len() as u64, listed(&bytes, 1)), (INDEX_BYTES, vec![last]));
}

#[test]
fn a_number_has_one_form() {
    assert_eq!(number(&[0, 9]), Some((0, &[9][..])));
    assert_eq!(number(&[0x80, 1]), Some((128, &[][..])));
    // Not the shortest, without an end, and of eight bytes.
    for bad in
        [&[0x80, 0x00][..], &[0xFF, 0x80, 0x00], &[], &[0x80], &[0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 1]]
    {
        assert_eq!(number(bad), None, "{bad:x?}");
    }
    let most = [0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x7F];
    assert_eq!(number(&most), Some(((1 << 49) - 1, &[][..])));
}

quickcheck! {
    fn any_set_of_vertices_comes_back(vertices: std::collections::BTreeSet<u64>) -> bool {
        let vertices: Vec<u64> = vertices.into_iter().map(|v| v >> 16).collect::<std::collections::BTreeSet<_>>().into_iter().collect();
        listed(&list(&vertices), vertices.len()) == vertices
    }

    fn bytes_that_are_accepted_are_the_only_ones(bytes: Vec<u8>) -> bool {
        // Whatever bytes make a list, writing its vertices gives the same bytes.
        let lattice = Lattice::new([300, 200, 100], [0.0; 3], [1.0; 3]).unwrap();
        (1..=bytes.len()).all(|count| {
            check(&lattice, 1, &bytes, count, ByteOffset(0)).is_err()
                || list(&listed(&bytes, count)) == bytes
        })
    }
}
