use super::{in_envelope, in_header, overwritten};
use ivg_wire::{ByteOffset, ContentId, Step, crc32, read_record, write_record};

#[test]
fn the_header_checksum_covers_all_but_itself() {
    let mut header = vec![7; 64];
    header[20..24].copy_from_slice(&40u32.to_le_bytes());
    let edited = in_header(&header, 33, &[1, 2]);
    assert_eq!(edited[33..35], [1, 2]);
    assert_eq!(edited[28..32], crc32(&[&edited[..28], &edited[32..40]]).to_le_bytes());
    assert_eq!(edited[40..], header[40..]);
}

#[test]
fn an_edited_record_is_read_and_one_with_the_old_checksum_is_not() {
    let content = ContentId(0x0123_4567_89ab_cdef);
    let mut file = vec![0; 40];
    file[32..40].copy_from_slice(&content.0.to_le_bytes());
    write_record(&mut file, 3, 0, b"payload!", content);
    let read = |file: &[u8]| {
        read_record(&file[40..], ByteOffset(40), 3, 8, content).map(|step| match step {
            Step::Consumed(_, record) => record.payload.to_vec(),
            Step::NeedMore(_) => Vec::new(),
        })
    };
    let length = file.len();
    assert_eq!(read(&in_envelope(&file, 40..length, 48, b"P")).unwrap(), b"Payload!");
    assert!(read(&overwritten(&file, 48, b"P")).is_err());
}
