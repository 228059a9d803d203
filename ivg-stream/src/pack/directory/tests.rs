use super::*;

/// A `scene.glb` that names one file.
fn scene_glb(uri: &str) -> Vec<u8> {
    let sha = "0".repeat(64);
    let mut json = format!(
        r#"{{"scenes":[{{"extensions":{{"IVG_irradiance_grid":{{"uri":"{uri}","byteLength":1,"sha256":"{sha}"}}}}}}]}}"#
    );
    while json.len() % 4 != 0 {
        json.push(' ');
    }
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((20 + json.len() as u32).to_le_bytes());
    glb.extend((json.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(json.bytes());
    glb
}

fn put(place: &Path, uri: &str, content: &[u8]) -> Result<(), PackError> {
    let staged = Staged::create(place)?;
    staged.write(SCENE_FILE, &scene_glb(uri))?;
    staged.write(uri, content)?;
    staged.put_in_place()
}

/// Names in a directory, hidden ones included.
fn listing(directory: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(directory)
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn a_new_an_empty_and_an_earlier_directory_are_taken() {
    let home = tempfile::tempdir().unwrap();
    let place = home.path().join("deep/scene");
    put(&place, "a.ivg", b"1").unwrap();
    assert_eq!(listing(&place), ["a.ivg", "scene.glb"]);
    put(&place, "b.ivg", b"2").unwrap();
    assert_eq!(listing(&place), ["b.ivg", "scene.glb"]);
    let empty = home.path().join("empty");
    fs::create_dir(&empty).unwrap();
    put(&empty, "a.ivg", b"3").unwrap();
    assert_eq!(fs::read(empty.join("a.ivg")).unwrap(), b"3");
    assert_eq!(listing(home.path()), ["deep", "empty"]);
    assert_eq!(listing(&home.path().join("deep")), ["scene"], "nothing is left beside");
}

#[test]
fn a_directory_with_anything_else_is_left_alone() {
    let home = tempfile::tempdir().unwrap();
    let place = home.path().join("scene");
    put(&place, "a.ivg", b"1").unwrap();
    fs::write(place.join("thesis.txt"), b"mine").unwrap();
    let error = put(&place, "b.ivg", b"2").unwrap_err();
    assert!(matches!(&error, PackError::Occupied { name, .. } if name == "thesis.txt"), "{error}");
    assert_eq!(listing(&place), ["a.ivg", "scene.glb", "thesis.txt"]);

    let other = home.path().join("other");
    fs::create_dir(&other).unwrap();
    fs::write(other.join("a.ivg"), b"not packed").unwrap();
    assert!(matches!(put(&other, "a.ivg", b"2"), Err(PackError::Occupied { .. })));
    // A directory of the name of a packed file is not a packed file.
    fs::remove_file(place.join("thesis.txt")).unwrap();
    fs::remove_file(place.join("a.ivg")).unwrap();
    fs::create_dir(place.join("a.ivg")).unwrap();
    assert!(matches!(put(&place, "b.ivg", b"2"), Err(PackError::Occupied { .. })));
    assert_eq!(listing(home.path()), ["other", "scene"]);
}

#[test]
fn a_file_in_the_place_is_left_alone() {
    let home = tempfile::tempdir().unwrap();
    let place = home.path().join("scene");
    fs::write(&place, b"a file").unwrap();
    assert!(put(&place, "a.ivg", b"1").is_err());
    assert_eq!(fs::read(&place).unwrap(), b"a file");
}

#[test]
fn nothing_is_there_before_the_end_and_nothing_is_left_after_giving_up() {
    let home = tempfile::tempdir().unwrap();
    let place = home.path().join("scene");
    let staged = Staged::create(&place).unwrap();
    staged.write("a.ivg", b"1").unwrap();
    assert!(!place.exists());
    assert!(staged.write("no/such/directory", b"2").is_err());
    drop(staged);
    assert_eq!(listing(home.path()), Vec::<String>::new());
}

#[cfg(unix)]
#[test]
fn a_link_to_the_place_stays_a_link() {
    let home = tempfile::tempdir().unwrap();
    fs::create_dir(home.path().join("real")).unwrap();
    let link = home.path().join("link");
    std::os::unix::fs::symlink("real", &link).unwrap();
    put(&link, "a.ivg", b"1").unwrap();
    assert!(link.symlink_metadata().unwrap().is_symlink());
    assert_eq!(listing(&home.path().join("real")), ["a.ivg", "scene.glb"]);
}
