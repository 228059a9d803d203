use std::fs;
use std::io::Write as _;

use super::*;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn gzipped(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).expect("memory takes all bytes");
    encoder.finish().expect("memory takes all bytes")
}

fn loaded(name: &str, bytes: &[u8], options: &ImportOptions) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join(name);
    fs::write(&path, bytes).expect("a file is written");
    load(&path, options)
}

#[test]
fn compression_is_stripped_and_undone() {
    let plain = loaded("a.obj", TRIANGLE.as_bytes(), &ImportOptions::default()).unwrap();
    assert_eq!(plain.name, "a");
    let zstd = zstd::encode_all(TRIANGLE.as_bytes(), 1).expect("memory takes all bytes");
    for (name, bytes) in [("a.obj.gz", gzipped(TRIANGLE.as_bytes())), ("a.OBJ.ZST", zstd)] {
        let scene = loaded(name, &bytes, &ImportOptions::default()).unwrap();
        assert_eq!(scene.meshes, plain.meshes, "{name}");
        assert_eq!(scene.name, "a");
    }
}

#[test]
fn a_plain_library_beside_a_compressed_scene_is_found() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("m.mtl"), "newmtl red\nKd 1 0 0\n").expect("a file is written");
    let path = folder.path().join("a.obj.gz");
    fs::write(&path, gzipped(format!("mtllib m.mtl\nusemtl red\n{TRIANGLE}").as_bytes()))
        .expect("a file is written");
    let scene = load(&path, &ImportOptions::default()).unwrap();
    assert_eq!(scene.materials[0].name, "red");
    assert!(scene.warnings.is_empty());
}

#[test]
fn a_bomb_stops_at_the_limit() {
    let zeros = vec![0; 1 << 20];
    let input = gzipped(&zeros);
    let read = |limit| compress::read(&input[..], compress::Compression::Gzip, limit).expect("valid gzip");
    assert_eq!(read(1 << 20).map(|b| b.len()), Some(1 << 20));
    assert_eq!(read((1 << 20) - 1), None);
}

#[test]
fn damaged_compression_missing_files_and_unknown_formats_are_named() {
    let check = |result: Result<Scene, SceneError>, what: &str| {
        let message = result.expect_err(what).to_string();
        assert!(message.contains(what), "{message}");
    };
    check(loaded("a.obj.gz", b"no gzip", &ImportOptions::default()), "a.obj.gz");
    check(loaded("a.obj.zst", b"no zstd", &ImportOptions::default()), "a.obj.zst");
    check(loaded("a.fbx", b"", &ImportOptions::default()), "known are .obj");
    check(
        load(Path::new("/does/not/exist.obj"), &ImportOptions::default()),
        "cannot read /does/not/exist.obj",
    );
}

#[test]
fn a_lights_file_is_applied_and_its_faults_are_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let lights = folder.path().join("l.toml");
    let options = ImportOptions { lights: Some(lights.clone()) };
    fs::write(&lights, "unit = 2\nsky = [1, 1, 1]\n").expect("a file is written");
    let scene = loaded("a.obj", TRIANGLE.as_bytes(), &options).unwrap();
    scene.require_light().unwrap();
    assert_eq!(scene.bounds().1.x, 2.0);
    fs::write(&lights, "\nunit = -2\n").expect("a file is written");
    let message = loaded("a.obj", TRIANGLE.as_bytes(), &options).expect_err("unit").to_string();
    assert!(message.contains("l.toml:2: "), "{message}");
}

#[cfg(unix)]
#[test]
fn a_link_out_of_the_folder_is_not_followed() {
    let (inside, outside) = (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
    let secret = outside.path().join("secret.mtl");
    fs::write(&secret, "newmtl a\n").expect("a file is written");
    std::os::unix::fs::symlink(&secret, inside.path().join("link.mtl")).expect("a link");
    let folder = Folder::of(&inside.path().join("scene.obj"));
    assert!(folder.read("link.mtl", 100).is_err_and(|e| e.0.contains("link out")));
    for name in ["/etc/passwd", "../x.mtl", "a/../../x.mtl", "", "..\\x.mtl"] {
        assert!(folder.read(name, 100).is_err_and(|e| e.0.contains("outside")), "{name}");
    }
}

#[test]
fn memory_alone_gives_no_access_to_files() {
    let scene = from_bytes("a.obj", format!("mtllib /etc/passwd\n{TRIANGLE}").as_bytes()).unwrap();
    assert!(scene.warnings[0].contains("another file"), "{:?}", scene.warnings);
}

/// Words that scene files are made of, so that random input gets past the first line.
const WORDS: [&str; 44] = [
    "v ",
    "vt ",
    "vn ",
    "f ",
    "1 ",
    "-1 ",
    "2/1/3 ",
    "1//1 ",
    "0 ",
    "\n",
    "\\\n",
    "# ",
    "o x\n",
    "usemtl a\n",
    "l 1 2\n",
    "1e400 ",
    "nan ",
    "9999999999999999999999 ",
    "ply\n",
    "format ascii 1.0\n",
    "format binary_big_endian 1.0\n",
    "element vertex 3\n",
    "element face 99999999999\n",
    "element tristrips 1\n",
    "property float x\n",
    "property float y\n",
    "property double z\n",
    "property list uchar int vertex_indices\n",
    "end_header\n",
    "glTF",
    "\u{2}\0\0\0",
    "{\"asset\":{\"version\":\"2.0\"},",
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],",
    "\"accessors\":[",
    "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,1]}",
    "],",
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],",
    "\"buffers\":[{\"byteLength\":36,\"uri\":\"data:;base64,AAAA\"}]}",
    "\"nodes\":[{\"children\":[0]}],",
    "}",
    "\u{fffd}",
    "\0",
    "mtllib x.mtl\n",
    " ",
];

#[test]
fn random_words_never_panic_the_readers() {
    fn property(choices: Vec<u8>) -> bool {
        let text: String = choices.iter().map(|c| WORDS[usize::from(*c) % WORDS.len()]).collect();
        for name in ["x.obj", "x.ply", "x.glb"] {
            // Whether it is an error does not matter; that it returns does.
            let _ = from_bytes(name, text.as_bytes());
        }
        true
    }
    quickcheck::QuickCheck::new().tests(400).quickcheck(property as fn(Vec<u8>) -> bool);
}

#[test]
fn random_bytes_never_panic_the_readers() {
    fn property(bytes: Vec<u8>) -> bool {
        for name in ["x.obj", "x.ply", "x.gltf"] {
            let _ = from_bytes(name, &bytes);
        }
        true
    }
    quickcheck::QuickCheck::new().tests(400).quickcheck(property as fn(Vec<u8>) -> bool);
}

/// A sky of 4 x 2 texels as Radiance HDR and as OpenEXR.
fn sky_files() -> [(&'static str, Vec<u8>); 2] {
    let texels: Vec<f32> = (0..24).map(|n| (n % 3) as f32 + 0.5).collect();
    let pixels: Vec<::image::Rgb<f32>> = texels.chunks(3).map(|t| ::image::Rgb([t[0], t[1], t[2]])).collect();
    let mut hdr = Vec::new();
    ::image::codecs::hdr::HdrEncoder::new(&mut hdr).encode(&pixels, 4, 2).unwrap();
    let mut exr = std::io::Cursor::new(Vec::new());
    let image = ::image::DynamicImage::ImageRgb32F(::image::ImageBuffer::from_raw(4, 2, texels).unwrap());
    image.write_to(&mut exr, ::image::ImageFormat::OpenExr).unwrap();
    [("sky.hdr", hdr), ("sky.exr", exr.into_inner())]
}

#[test]
fn skies_are_images_beside_the_lights_file() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("s.obj");
    fs::write(&scene, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let load_with = |lights: &str| {
        let file = folder.path().join("l.toml");
        fs::write(&file, lights).unwrap();
        load(&scene, &ImportOptions { lights: Some(file) })
    };
    for (name, bytes) in sky_files() {
        fs::write(folder.path().join(name), bytes).unwrap();
        let read = load_with(&format!("[sky]\nimage = \"{name}\"\nrotation = 180\nscale = 2\n")).unwrap();
        read.require_light().unwrap();
        let sky = read.sky_image.expect("a sky");
        assert_eq!((sky.width, sky.height, sky.rotation), (4, 2, std::f32::consts::PI));
        // Halves, one and a half, two and a half are exact in RGBE and in halves, times two.
        assert!(sky.texels.iter().all(|t| *t == [1.0, 3.0, 5.0]), "{name}: {:?}", sky.texels);
    }
    fs::write(folder.path().join("flat.png"), b"\x89PNG\r\n\x1a\n").unwrap();
    for (lights, what) in [
        ("[sky]\nimage = \"../sky.hdr\"\n", "outside the folder"),
        ("[sky]\nimage = \"none.hdr\"\n", "none.hdr"),
        ("[sky]\nimage = \"flat.png\"\n", "neither a Radiance HDR nor an OpenEXR"),
        ("[sky]\nimage = \"sky.hdr\"\nscale = -1\n", "scale -1"),
        ("[sky]\nfile = \"sky.hdr\"\n", "sky is neither"),
    ] {
        let message = load_with(lights).expect_err(lights).to_string();
        assert!(message.contains("l.toml:1: ") && message.contains(what), "{message}");
    }
}
