use super::encode;

#[test]
fn header_is_aligned_and_values_follow() {
    let bytes =
        encode(&[2, 3], [0.0, 1.0, 2.0, 3.0, 4.0, f32::NAN].into_iter()).expect("memory for six numbers");
    assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
    let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    assert_eq!((10 + length) % 64, 0);
    let header = std::str::from_utf8(&bytes[10..10 + length]).expect("ascii");
    assert!(header.starts_with("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3,), }"), "{header}");
    assert!(header.ends_with('\n'));
    let values = &bytes[10 + length..];
    assert_eq!(values.len(), 24);
    assert_eq!(&values[4..8], &1.0f32.to_le_bytes());
    assert!(f32::from_le_bytes([values[20], values[21], values[22], values[23]]).is_nan());
}
