use super::Invocation;
use std::path::Path;

#[test]
fn is_shown_as_a_line_for_a_shell() {
    let invocation = Invocation::cargo("doc --locked")
        .argument("two words")
        .environment("RUSTDOCFLAGS", "-Dwarnings")
        .path_front(Path::new("target/tools/bin"));
    assert_eq!(
        invocation.to_string(),
        "PATH=target/tools/bin:$PATH RUSTDOCFLAGS=-Dwarnings cargo doc --locked 'two words'"
    );
    assert_eq!(Invocation::new("echo", "").argument("it's").to_string(), r"echo 'it'\''s'");
}

#[test]
fn a_failing_program_is_named() {
    let here = Path::new(".");
    let failed = Invocation::new("sh", "-c").argument("echo reason >&2; exit 3").output(here).unwrap_err();
    assert!(failed.contains("sh -c") && failed.contains('3') && failed.ends_with("reason"), "{failed}");
    let missing = Invocation::new("no-such-program-here", "").run(here).unwrap_err();
    assert!(missing.contains("no-such-program-here"), "{missing}");
}

#[test]
fn environment_and_folder_reach_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let shown = Invocation::new("sh", "-c")
        .argument("echo $GREETING; pwd")
        .environment("GREETING", "hello")
        .output(folder.path())
        .unwrap();
    let mut lines = shown.lines();
    assert_eq!(lines.next(), Some("hello"));
    assert_eq!(Path::new(lines.next().unwrap()), folder.path().canonicalize().unwrap());
}
