use super::*;

#[test]
fn strong_and_weak_comparison_differ_as_in_rfc_9110() {
    let tag = "\"a\"";
    for (list, strong, weak) in [
        ("\"a\"", true, true),
        ("W/\"a\"", false, true),
        ("\"b\"", false, false),
        ("\"b\", \"a\"", true, true),
        ("\"b\",W/\"a\"", false, true),
        ("*", true, true),
        ("", false, false),
        ("a", false, false),
    ] {
        assert_eq!(any_strong_match(list, tag), strong, "strong: {list}");
        assert_eq!(any_weak_match(list, tag), weak, "weak: {list}");
    }
}
