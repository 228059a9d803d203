use super::*;
use quickcheck::quickcheck;

#[test]
fn the_checksum_is_crc_32_iso_hdlc() {
    // The check value of the CRC catalogue for "123456789".
    assert_eq!(crc32(&[b"123456789"]), 0xCBF4_3926);
    assert_eq!(crc32(&[b"1234", b"", b"56789"]), 0xCBF4_3926);
}

#[test]
fn the_content_id_goes_in_front_as_eight_little_endian_bytes() {
    let id = ContentId(u64::from_le_bytes(*b"12345678"));
    assert_eq!(id.crc32(b"9"), 0xCBF4_3926);
}

#[test]
fn the_content_id_tells_parts_apart() {
    let ids = [
        ContentId::of(&[]),
        ContentId::of(&[b""]),
        ContentId::of(&[b"\0"]),
        ContentId::of(&[b"ab"]),
        ContentId::of(&[b"a", b"b"]),
        ContentId::of(&[b"b", b"a"]),
        ContentId::of(&[b"ab", b""]),
    ];
    for (n, id) in ids.iter().enumerate() {
        assert!(!ids[..n].contains(id), "{n}: {id:?}");
    }
}

quickcheck! {
    fn any_flipped_bit_changes_the_content_id(bytes: alloc::vec::Vec<u8>, at: usize) -> bool {
        let mut other = bytes.clone();
        let Some(count) = (bytes.len() * 8).checked_sub(1) else { return true };
        let bit = at % (count + 1);
        other[bit / 8] ^= 1 << (bit % 8);
        ContentId::of(&[&bytes]) != ContentId::of(&[&other])
    }
}
