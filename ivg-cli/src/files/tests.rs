use std::fs;
use std::path::Path;

use super::{require_extension, shown, write};

#[test]
fn a_written_file_is_whole_and_replaces_the_old_one() {
    let place = tempfile::tempdir().expect("a folder");
    let path = place.path().join("out.ivg");
    for content in [&b"first"[..], b"second, longer"] {
        write(&path, content).expect("writable");
        assert_eq!(fs::read(&path).expect("there"), content);
    }
    assert_eq!(fs::read_dir(place.path()).expect("the folder").count(), 1, "no part file is left");
}

#[test]
fn a_missing_folder_is_named() {
    let failure = write(Path::new("no-such-folder/out.ivg"), b"x").expect_err("no folder");
    assert!(failure.to_string().contains("the folder no-such-folder does not exist"), "{failure}");
}

#[cfg(unix)]
#[test]
fn links_are_followed_and_what_is_no_file_is_left_alone() {
    let place = tempfile::tempdir().expect("a folder");
    let link = place.path().join("link.ivg");
    std::os::unix::fs::symlink("target.ivg", &link).expect("a link");
    for content in [&b"new"[..], b"newer"] {
        write(&link, content).expect("writable");
        assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
        assert_eq!(fs::read(place.path().join("target.ivg")).expect("there"), content);
    }
    let folder = place.path().join("folder.ivg");
    fs::create_dir(&folder).expect("a folder");
    assert!(write(&folder, b"x").expect_err("a folder").to_string().contains("not a file"));
    assert!(folder.is_dir());
    let to_folder = place.path().join("to-folder.ivg");
    std::os::unix::fs::symlink("folder.ivg", &to_folder).expect("a link");
    assert!(write(&to_folder, b"x").is_err());
}

#[test]
fn extensions_are_required() {
    assert_eq!(require_extension(Path::new("a/b.ivg"), &["ivg"]).expect("right"), "ivg");
    for wrong in ["scene.obj", "ivg", "x.ivg.bak", "/dev/null"] {
        assert!(require_extension(Path::new(wrong), &["ivg", "npy"]).is_err(), "{wrong}");
    }
}

#[test]
fn control_characters_are_shown_not_obeyed() {
    assert_eq!(shown("a\u{1b}[31mX\ny \u{e9}"), "a\\u{1b}[31mX\\ny \u{e9}");
}
