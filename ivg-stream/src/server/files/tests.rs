use super::*;

/// Finds a file that was last written at the given time, and says whether its tag was kept for the next request.
fn keeps_tag(modified: SystemTime) -> bool {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.ivg");
    std::fs::write(&path, b"content").unwrap();
    std::fs::File::options().write(true).open(&path).unwrap().set_modified(modified).unwrap();
    let files = Files::open(directory.path()).unwrap();
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    let opened = runtime.block_on(files.find("/a.ivg")).unwrap().unwrap();
    assert_eq!(opened.length, 7);
    let tags = files.tags.lock().unwrap();
    let known = tags[&opened.path].try_lock().unwrap();
    known.as_ref().is_some_and(|(_, tag)| *tag == opened.tag)
}

#[test]
fn a_tag_is_kept_only_once_the_times_of_the_file_can_tell_a_change() {
    let (now, hour) = (SystemTime::now(), Duration::from_secs(3600));
    assert!(keeps_tag(now - hour));
    // A time ahead of the clock stands for one that is too young, however slowly this test runs.
    assert!(!keeps_tag(now + hour));
}
