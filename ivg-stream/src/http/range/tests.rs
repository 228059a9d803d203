use super::*;

#[test]
fn ranges_follow_rfc_9110() {
    let part = |range| Asked::Part(range);
    for (field, expected) in [
        ("bytes=0-0", part(0..1)),
        ("bytes=2-4", part(2..5)),
        ("bytes=2-", part(2..10)),
        ("bytes=9-9", part(9..10)),
        ("bytes=5-1000", part(5..10)),
        ("bytes=0-18446744073709551615", part(0..10)),
        ("Bytes=-3", part(7..10)),
        ("bytes=-1000", part(0..10)),
        ("bytes=10-", Asked::Unsatisfiable),
        ("bytes=10-12", Asked::Unsatisfiable),
        ("bytes=-0", Asked::Unsatisfiable),
        // Malformed, of another unit, or several: ignored.
        ("bytes=4-2", Asked::Whole),
        ("bytes=+1-2", Asked::Whole),
        ("bytes=a-b", Asked::Whole),
        ("bytes=-", Asked::Whole),
        ("bytes=1", Asked::Whole),
        ("bytes", Asked::Whole),
        ("records=0-1", Asked::Whole),
        ("bytes=0-1,4-5", Asked::Whole),
        ("bytes=99999999999999999999-", Asked::Whole),
    ] {
        assert_eq!(parse_range(field, 10), expected, "{field}");
    }
}

#[test]
fn no_range_of_an_empty_file_can_be_satisfied() {
    for field in ["bytes=0-", "bytes=0-0", "bytes=-1"] {
        assert_eq!(parse_range(field, 0), Asked::Unsatisfiable, "{field}");
    }
}

#[test]
fn content_range_is_read_strictly() {
    let range = |bytes, total| Some(ContentRange { bytes, total });
    for (field, expected) in [
        ("bytes 0-0/1", range(0..1, Some(1))),
        ("bytes 5-9/10", range(5..10, Some(10))),
        ("bytes 5-9/*", range(5..10, None)),
        ("bytes 5-10/10", None),
        ("bytes 6-5/10", None),
        ("bytes */10", None),
        ("bytes 5-9", None),
        ("items 5-9/10", None),
        ("bytes 0-18446744073709551615/*", None),
    ] {
        assert_eq!(parse_content_range(field), expected, "{field}");
    }
}
