use super::*;

fn sample() -> DisplayImage {
    DisplayImage::new(3, 2, vec![[0, 1, 2], [255, 254, 253], [7; 3], [9, 0, 0], [0, 9, 0], [0, 0, 9]])
}

#[test]
fn a_picture_survives_writing_and_reading() {
    assert_eq!(decode(&encode(&sample()).unwrap()).unwrap(), sample());
}

#[test]
fn a_file_appears_complete_and_alone() {
    let folder = std::env::temp_dir().join(format!("ivg-render-png-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join("picture.png");
    write(&path, &sample()).unwrap();
    assert_eq!(read(&path).unwrap(), sample());
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn errors_name_the_file() {
    let path = Path::new("no-such-folder/picture.png");
    assert!(write(path, &sample()).unwrap_err().to_string().contains("no-such-folder/picture.png"));
    assert!(read(path).unwrap_err().to_string().contains("no-such-folder/picture.png"));
}

#[test]
fn bytes_that_are_no_picture_are_an_error() {
    let mut bytes = encode(&sample()).unwrap();
    bytes.truncate(bytes.len() / 2);
    assert!(decode(&bytes).is_err());
    assert!(decode(b"no picture").is_err());
}
