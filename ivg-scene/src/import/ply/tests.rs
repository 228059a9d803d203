use super::*;

fn read_text(text: &str) -> Result<Scene, SceneError> {
    read("t.ply", "t", text.as_bytes())
}

const QUAD: &str = "ply\nformat ascii 1.0\ncomment four corners, one face\nelement vertex 4\nproperty float x\n\
    property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

#[test]
fn polygons_become_fans() {
    let scene = read_text(QUAD).unwrap();
    scene.check().unwrap();
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(scene.meshes[0].positions[2], Vec3::new(1.0, 1.0, 0.0));
}

/// A file in binary with a skipped element, doubles, normals, texture coordinates, colours and strips.
fn binary(big_endian: bool) -> Vec<u8> {
    let name = if big_endian { "big" } else { "little" };
    let mut bytes = format!(
        "ply\r\nformat binary_{name}_endian 1.0\r\nelement camera 2\r\nproperty short id\r\n\
         property list uchar float knobs\r\nelement vertex 5\r\nproperty double x\r\nproperty double y\r\n\
         property double z\r\nproperty float nx\r\nproperty float ny\r\nproperty float nz\r\nproperty float s\r\n\
         property float t\r\nproperty uchar red\r\nelement tristrips 1\r\nproperty list int int vertex_indices\r\n\
         end_header\r\n"
    )
    .into_bytes();
    let mut put = |le: &[u8]| {
        if big_endian {
            bytes.extend(le.iter().rev());
        } else {
            bytes.extend(le);
        }
    };
    for knobs in [1u8, 3] {
        put(&7i16.to_le_bytes());
        put(&[knobs]);
        (0..knobs).for_each(|_| put(&1.5f32.to_le_bytes()));
    }
    for i in 0..5 {
        for v in [1e6 + f64::from(i % 2), -2e6 + f64::from(i / 2), 0.25] {
            put(&v.to_le_bytes());
        }
        for v in [0.0, 0.0, 2.0, 0.25, 0.75] {
            put(&f32::to_le_bytes(v));
        }
        put(&[200]);
    }
    let strip = [0i32, 1, 2, 3, -1, 2, 3, 4, -1];
    put(&(strip.len() as i32).to_le_bytes());
    strip.iter().for_each(|i| put(&i.to_le_bytes()));
    bytes
}

#[test]
fn binary_strips_of_both_byte_orders_are_read_alike() {
    let little = read("t.ply", "t", &binary(false)).unwrap();
    assert_eq!(little, read("t.ply", "t", &binary(true)).unwrap());
    let mesh = &little.meshes[0];
    // The second triangle of a strip turns round, a new strip starts afresh.
    assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
    assert_eq!(mesh.normals[0], Vec3::Z, "normals are made unit length");
    assert_eq!(mesh.uvs[0], Vec2::new(0.25, 0.25), "t counts upwards");
    let world = mesh.origin + mesh.positions[3].as_dvec3();
    assert_eq!(world, DVec3::new(1e6 + 1.0, -2e6 + 1.0, 0.25));
    let left_out: Vec<&str> = little.unsupported.iter().map(|u| u.what.as_str()).collect();
    assert_eq!(
        left_out,
        [
            "element \"camera\": left out",
            "vertex colours that are no red, green and blue of a known type: left out"
        ]
    );
}

/// The square with a colour of these properties, one value a channel for each vertex.
fn coloured(properties: &str, values: [&str; 4]) -> Scene {
    let mut text = QUAD.replace("element face", &format!("{properties}element face"));
    for (place, value) in ["0 0 0\n", "1 0 0\n", "1 1 0\n", "0 1 0\n"].into_iter().zip(values) {
        text = text.replace(&format!("\n{place}"), &format!("\n{} {value}\n", place.trim_end()));
    }
    read_text(&text).unwrap()
}

#[test]
fn vertices_have_the_colours_of_every_common_form() {
    let named = |kind: &str, names: &str| -> String {
        names.split(' ').map(|name| format!("property {kind} {name}\n")).collect()
    };
    let opaque = [[255, 0, 51, 255], [0, 255, 0, 255], [1, 2, 3, 255], [128, 128, 128, 255]];
    let bytes = ["255 0 51", "0 255 0", "1 2 3", "128 128 128"];
    for names in ["red green blue", "diffuse_red diffuse_green diffuse_blue", "r g b"] {
        let scene = coloured(&named("uchar", names), bytes);
        assert_eq!(scene.meshes[0].colours, opaque, "{names}");
        assert!(scene.unsupported.is_empty(), "{:?}", scene.unsupported);
    }
    let with_alpha = coloured(
        &named("uchar", "red green blue alpha"),
        ["255 0 51 7", "0 255 0 0", "1 2 3 255", "9 9 9 9"],
    );
    assert_eq!(with_alpha.meshes[0].colours[..2], [[255, 0, 51, 7], [0, 255, 0, 0]]);
    // 0.2 is 51 of 255, 0.5 rounds up to 128; 257 of 65535 is 1 of 255.
    let floats = coloured(
        &named("float", "red green blue"),
        ["1 0 0.2", "0 1 0", "0.0040 0.0078 0.0118", "0.5 0.5 0.5"],
    );
    assert_eq!(floats.meshes[0].colours, opaque);
    let wide = coloured(
        &named("ushort", "red green blue"),
        ["65535 0 13107", "0 65535 0", "257 514 771", "32896 32896 32896"],
    );
    assert_eq!(wide.meshes[0].colours, opaque);
    // Floats that are no shares, and types that no program means colours by: the shape is read all the same.
    let bright = coloured(&named("float", "red green blue"), ["0 0 0", "255 0 0", "0 0 0", "0 0 0"]);
    assert!(bright.meshes[0].colours.is_empty());
    let what = &bright.unsupported[0].what;
    assert_eq!(what, "vertex colours, as that of vertex 1 is out of range: left out");
    let signed = coloured(&named("int", "red green blue"), bytes);
    assert!(
        signed.meshes[0].colours.is_empty() && signed.unsupported[0].what.ends_with("known type: left out")
    );
}

#[test]
fn faults_are_named_with_line_or_byte() {
    let check = |text: &str, place: &str, what: &str| {
        let message = read_text(text).expect_err(what).to_string();
        assert!(message.starts_with(place) && message.contains(what), "{message}");
    };
    check("plyx\n", "t.ply:1: ", "first line");
    check("ply\nformat ascii 1.0\n", "t.ply:3: ", "end_header");
    check("ply\nformat ascii 2.0\n", "t.ply:2: ", "version");
    check("ply\nformat morse 1.0\n", "t.ply:2: ", "morse");
    check("ply\nelement vertex many\n", "t.ply:2: ", "number of elements");
    check("ply\nproperty float x\n", "t.ply:2: ", "before any element");
    check("ply\nelement vertex 1\nproperty complex x\n", "t.ply:3: ", "complex");
    check("ply\nend_header\n", "t.ply:2: ", "no format");
    check(&QUAD.replace("1 1 0\n", "1 one 0\n"), "t.ply:13: ", "\"one\" is no number");
    check(&QUAD.replace("4 0 1 2 3", "4 0 1 2 4"), "t.ply:15: ", "face 0 names vertex 4");
    check(&QUAD.replace("4 0 1 2 3", "4 0 1 2 -3"), "t.ply:15: ", "names vertex -3");
    check(&QUAD.replace("4 0 1 2 3", "4 0 1 2"), "t.ply:16: ", "too early");
    check(&QUAD.replace("float z", "float w"), "t.ply:11: ", "without x, y, z");
    check(&QUAD.replace("1 1 0\n", "1 nan 0\n"), "mesh \"t\": ", "vertex 2 is not finite");
    check(&QUAD.replace("face 1", "face 0"), "t.ply: ", "no faces");
    let cut = binary(false);
    let message = read("t.ply", "t", &cut[..cut.len() - 1]).expect_err("cut").to_string();
    assert!(message.contains("too early at byte 0x"), "{message}");
}

#[test]
fn declared_counts_alone_allocate_nothing() {
    // Billions of vertices, of elements without properties, of list items: refused or passed over at once.
    let header = |rest: &str| format!("ply\nformat binary_little_endian 1.0\n{rest}end_header\n");
    let many = u64::MAX;
    for rest in [
        format!("element vertex {many}\nproperty float x\nproperty float y\nproperty float z\n"),
        format!("element nothing {many}\n"),
        "element nothing 1\nproperty list double char items\n".to_owned(),
    ] {
        let mut bytes = header(&rest).into_bytes();
        bytes.extend(1e300f64.to_le_bytes());
        assert!(read("t.ply", "t", &bytes).is_err());
    }
}
