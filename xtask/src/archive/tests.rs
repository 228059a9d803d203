use super::{crc32, files, zip};
use std::process::Command;

#[test]
fn the_checksum_is_that_of_zip() {
    assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
}

/// Unpacked by another program, the archive holds the files, and the suite in it is found.
#[test]
fn the_archive_unpacks_to_the_suite() {
    let files = files(&crate::workspace_root()).unwrap();
    let archive = zip(&files).unwrap();
    assert_eq!(archive, zip(&files).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("suite.zip");
    std::fs::write(&path, &archive).unwrap();
    let python = |arguments: &[&str]| {
        let output = Command::new("python3").args(arguments).current_dir(folder.path()).output().unwrap();
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    assert!(python(&["-m", "zipfile", "-t", "suite.zip"]).contains("Done testing"));
    python(&["-m", "zipfile", "-e", "suite.zip", "."]);
    for (name, bytes) in &files {
        assert_eq!(std::fs::read(folder.path().join(name)).unwrap(), *bytes, "{name}");
    }
    let listed = python(&["ivg-conformance/conformance/run.py", "list", "--only", "numeric"]);
    assert_eq!(listed.lines().count(), 4, "{listed}");
    let explained = python(&["ivg-conformance/conformance/run.py", "explain", "ivg/x-303-step-zero"]);
    assert!(explained.contains("header.step") && explained.contains("**IVG-LAT-03**"), "{explained}");
}
