use super::*;

#[test]
fn a_directory_is_found_with_and_without_its_description() {
    for (text, shown, target) in [
        ("http://host", "http://host/", "/a.ivg"),
        ("http://host:8080/x", "http://host:8080/x/", "/x/a.ivg"),
        ("http://host/x/", "http://host/x/", "/x/a.ivg"),
        ("http://host/x/scene.glb", "http://host/x/", "/x/a.ivg"),
        ("http://host/myscene.glb", "http://host/myscene.glb/", "/myscene.glb/a.ivg"),
        ("http://[::1]:9/x/?key=1", "http://[::1]:9/x/?key=1", "/x/a.ivg?key=1"),
    ] {
        let url: SceneUrl = text.parse().unwrap();
        assert_eq!((url.to_string().as_str(), url.target("a.ivg").as_str()), (shown, target), "{text}");
    }
    let url: SceneUrl = "http://[::1]:9/".parse().unwrap();
    assert_eq!(url.address(), ("::1".to_owned(), 9));
}

#[test]
fn other_urls_are_refused_with_a_reason() {
    for (text, reason) in [
        ("https://host/", "https"),
        ("file:///x", "URL"),
        ("ftp://host/x", "only http"),
        ("host/x", "URL"),
        ("/x", "only http"),
        ("http://user:word@host/", "password"),
        ("http://", "URL"),
        ("http://ho st/", "URL"),
        ("", "URL"),
    ] {
        let error = text.parse::<SceneUrl>().unwrap_err().to_string();
        assert!(error.contains(reason), "{text}: {error}");
    }
}
