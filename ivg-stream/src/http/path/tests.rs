use super::*;

#[test]
fn plain_paths_are_split_and_decoded_once() {
    let names = |path| names(path).map(|names| names.join("|"));
    assert_eq!(names("/scene.glb").as_deref(), Some("scene.glb"));
    assert_eq!(names("/a/b/c.pmesh").as_deref(), Some("a|b|c.pmesh"));
    assert_eq!(names("/two%20words").as_deref(), Some("two words"));
    assert_eq!(names("/%C3%A4").as_deref(), Some("ä"));
    assert_eq!(names("/%2561").as_deref(), Some("%61"), "decoded once only");
}

#[test]
fn paths_that_could_lead_elsewhere_are_refused() {
    for path in [
        "/",
        "",
        "scene.glb",
        "*",
        "//etc/passwd",
        "/a//b",
        "/a/",
        "/..",
        "/../x",
        "/a/../b",
        "/.",
        "/./a",
        "/%2e%2e/x",
        "/%2E./x",
        "/.%2e/x",
        "/..%2fx",
        "/a%2fb",
        "/a%5Cb",
        "/a\\b",
        "/..\\x",
        "/a%00.glb",
        "/%0a",
        "/.git/config",
        "/%2egit",
        "/C:/x",
        "/a%3Ab",
        "/%",
        "/%4",
        "/%zz",
        "/%ff",
        "/%c0%ae%c0%ae/x",
    ] {
        assert_eq!(names(path), None, "{path}");
    }
}

#[test]
fn only_relative_uris_of_unreserved_characters_are_safe() {
    for uri in ["light.ivg", "a/b.pmesh", "x~y-z_1.pmesh"] {
        assert!(is_safe_uri(uri), "{uri}");
    }
    for uri in [
        "",
        "/a",
        "a/",
        "a//b",
        "../a",
        "a/../b",
        "./a",
        ".a",
        "http://h/a",
        "file:a",
        "a?b",
        "a#b",
        "a%2fb",
        "a b",
        "a\\b",
        "ä",
        "data:,x",
        "a\0",
    ] {
        assert!(!is_safe_uri(uri), "{uri}");
    }
    assert!(!is_safe_uri(&"a".repeat(1025)));
}
