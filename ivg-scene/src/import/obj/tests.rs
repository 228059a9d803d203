use std::fs;

use super::*;

/// Reads OBJ text beside files of the given names.
fn read_with(files: &[(&str, &[u8])], text: &str) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, bytes) in files {
        fs::write(folder.path().join(name), bytes).expect("a file is written");
    }
    let scene = read("t.obj", "t", text.as_bytes(), &Folder::of(&folder.path().join("t.obj")))?;
    scene.check()?;
    Ok(scene)
}

fn read_text(text: &str) -> Result<Scene, SceneError> {
    read_with(&[], text)
}

const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn polygons_negative_indices_continued_lines_and_comments_are_read() {
    let scene = read_text(&format!("{CORNERS}f 1 2 3 4 # a square\nf -4 -3 \\\n -2\n")).unwrap();
    assert_eq!(scene.meshes[0].name, "t");
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    assert_eq!(scene.materials, [Material::default()], "the stated grey");
}

#[test]
fn vertices_that_no_face_names_are_counted() {
    let warnings = |text: &str| read_text(text).unwrap().warnings;
    let dropped = |count: u32| vec![format!("t.obj: {count} vertices that no face uses: dropped")];
    assert_eq!(warnings(&format!("{CORNERS}f 1 2 3 4\n")), Vec::<String>::new());
    assert_eq!(warnings(&format!("{CORNERS}f -1 -2 -3\n")), dropped(1));
    assert_eq!(warnings(&format!("f 1 2 3\n{CORNERS}v 5 5 5\n")), dropped(2), "named before they are there");
    assert_eq!(warnings(&format!("vt 0 0\nvn 0 0 1\n{CORNERS}f 2/1/1 3/1/1 4/1/1\n")), dropped(1));
}

#[test]
fn lines_and_points_are_reported_and_never_become_triangles() {
    let scene = read_text(&format!("{CORNERS}l 1 2 3\np 1\nf 1 2 3\n")).unwrap();
    assert_eq!(scene.meshes[0].triangles.len(), 1);
    assert!(scene.unsupported[0].what.starts_with("2 lines"), "{:?}", scene.unsupported);
}

#[test]
fn a_missing_library_is_a_warning_and_a_stated_grey() {
    let scene = read_text(&format!("mtllib gone.mtl\n{CORNERS}usemtl paint\nf 1 2 3\n")).unwrap();
    assert_eq!(scene.materials, [Material::default()]);
    assert!(
        scene.warnings[0].contains("gone.mtl") && scene.warnings[0].contains("grey"),
        "{:?}",
        scene.warnings
    );
    assert!(scene.warnings[1].contains("\"paint\""), "{:?}", scene.warnings);
}

#[test]
fn files_outside_the_folder_are_not_read() {
    let scene = read_text(&format!("mtllib ../outside.mtl\n{CORNERS}f 1 2 3\n")).unwrap();
    assert!(scene.warnings[0].contains("outside the folder"), "{:?}", scene.warnings);
}

#[test]
fn materials_mean_what_the_documentation_says() {
    let library = "newmtl wall\nKd 0.5\nKs 0.9 0.9 0.9\nillum 1\n\
        newmtl lamp\nKd 0 0 0\nKe 18 14 7\n\
        newmtl mirror\nKd 0.1 0.1 0.1\nKs 0.2 0.8 0.2\nNs 198\nillum 3\n\
        newmtl glass\nKd 0.4 0.4 0.4\nTf 0.9 0.2 0.1\nNi 1.33\nillum 7\n\
        newmtl veil\nKd 0.8 0.8 0.8\nd -halo 0.25\n\
        newmtl highlight\nKd 0.5\nKs 0.5\nillum 2\n\
        newmtl opaque\nKd 0.8 0.8 0.8\nTf 1 1 1\nillum 4\n";
    let text = format!("mtllib m.mtl\n{CORNERS}usemtl lamp\nf 1 2 3\nusemtl wall\nf 1 3 4\n");
    let scene = read_with(&[("m.mtl", library.as_bytes())], &text).unwrap();
    let by_name =
        |name: &str| scene.materials.iter().find(|m| m.name == name).unwrap_or_else(|| panic!("{name}"));
    let wall = by_name("wall");
    assert_eq!((wall.albedo, wall.specular, wall.two_sided), (Vec3::splat(0.5), 0.0, true));
    let lamp = by_name("lamp");
    assert_eq!((lamp.emission, lamp.two_sided), (Vec3::new(18.0, 14.0, 7.0), false));
    let mirror = by_name("mirror");
    // sqrt(sqrt(2 / 200))
    assert_eq!((mirror.specular, mirror.metallic), (0.8, false));
    assert_eq!(mirror.specular_colour, Vec3::new(0.25, 1.0, 0.25));
    assert_eq!(by_name("highlight").specular, 0.0);
    assert!((mirror.roughness - 0.316_227_77).abs() < 1e-6);
    let glass = by_name("glass");
    assert_eq!((glass.transmission, glass.albedo, glass.refractive_index), (1.0, Vec3::ZERO, 1.33));
    assert_eq!(glass.transmission_colour, Vec3::new(0.9, 0.2, 0.1));
    assert_eq!((by_name("veil").transmission, by_name("veil").albedo), (0.75, Vec3::splat(0.2)));
    assert_eq!(by_name("opaque").transmission, 0.0);
    let used: Vec<&str> = scene.meshes[0]
        .triangle_materials
        .iter()
        .map(|m| scene.materials[*m as usize].name.as_str())
        .collect();
    assert_eq!(used, ["lamp", "wall"]);
    assert_eq!(scene.meshes.len(), 1, "one object, whatever its materials");
}

#[test]
fn images_are_read_once_with_v_turned_round() {
    let mut png = Vec::new();
    let encoder = ::image::codecs::png::PngEncoder::new(&mut png);
    ::image::ImageEncoder::write_image(
        encoder,
        &[255, 0, 0, 0, 0, 255],
        1,
        2,
        ::image::ExtendedColorType::Rgb8,
    )
    .expect("a small image");
    let library = "newmtl a\nmap_Kd -s 1 1 1 -clamp on my image.png\nnewmtl b\nmap_Kd my image.png\nmap_Ke x.png\n\
        newmtl c\nmap_Kd gone.png\n";
    let text = format!(
        "mtllib m.mtl\n{CORNERS}vt 0.5 0.75\nvt 0.5 0.25\nvn 0 0 5\nusemtl a\nf 1/1/1 2/1/1 3/1/1\nusemtl b\nf 1/2/1 3/2/1 4/2/1\n"
    );
    let scene = read_with(&[("m.mtl", library.as_bytes()), ("my image.png", &png)], &text).unwrap();
    assert_eq!(scene.textures.len(), 1);
    let textures: Vec<_> = scene.materials.iter().map(|m| m.albedo_texture).collect();
    assert_eq!(textures, [Some(0), Some(0), None]);
    let mesh = &scene.meshes[0];
    assert_eq!(scene.textures[0].sample(mesh.uvs[0]), Vec3::X, "high v is the upper, red texel");
    assert_eq!(scene.textures[0].sample(mesh.uvs[3]), Vec3::Z);
    assert!(mesh.normals.iter().all(|n| *n == Vec3::Z));
    assert!(
        scene.warnings.iter().any(|w| w.contains("gone.png") && w.contains("\"c\"")),
        "{:?}",
        scene.warnings
    );
    let reported: Vec<&str> = scene.unsupported.iter().map(|u| u.what.as_str()).collect();
    assert_eq!(reported, ["options of map_Kd: left out", "image of the emission: left out"]);
}

#[test]
fn objects_become_meshes_and_share_one_origin() {
    let far =
        "o a\nv 1000000.25 0 0\nv 1000001.25 0 0\nv 1000001.25 1 0\nf 1 2 3\no b\nv 1000003 0 0\nf 1 2 4\n";
    let scene = read_text(far).unwrap();
    let names: Vec<&str> = scene.nodes.iter().map(|n| n.name.as_str()).collect();
    assert_eq!(names, ["a", "b"]);
    assert_eq!(scene.meshes[0].origin, scene.meshes[1].origin);
    assert_eq!(scene.meshes[0].positions[0], scene.meshes[1].positions[0]);
}

#[test]
fn text_a_million_metres_away_is_the_same_shape_to_f32() {
    let shape = |offset: f64| {
        let v = |x: f64, y: f64, z: f64| format!("v {} {} {}\n", x + offset, y - offset, z + offset);
        let text = [v(0.125, 0.3, -0.7), v(1.1, 0.0, 0.2), v(0.4, 0.9, 0.65)].concat() + "f 1 2 3\n";
        read_text(&text).unwrap().flatten()
    };
    let (near, far) = (shape(0.0), shape(1_048_576.0));
    for (a, b) in near.positions.iter().zip(&far.positions) {
        let difference = (a.as_dvec3() + near.origin)
            - (b.as_dvec3() + far.origin - DVec3::new(1.0, -1.0, 1.0) * 1_048_576.0);
        // f64 at 2^20 resolves 2^-32; f32 below 2 m resolves 2^-23, half of it lost to rounding on each side.
        assert!(difference.abs().max_element() <= 2f64.powi(-23), "{a} {b}");
    }
}

#[test]
fn vertices_without_normals_stay_apart_where_the_file_keeps_them_apart() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\nf 4 5 6\n";
    assert_eq!(read_text(text).unwrap().meshes[0].positions.len(), 6);
}

#[test]
fn corners_alike_are_one_vertex_across_materials() {
    let text = format!("{CORNERS}vn 0 0 1\nusemtl a\nf 1//1 2//1 3//1\nusemtl b\nf 1//1 3//1 4//1\n");
    assert_eq!(read_text(&text).unwrap().meshes[0].positions.len(), 4);
}

#[test]
fn normals_that_only_some_corners_have_are_computed_instead() {
    let scene = read_text(&format!("{CORNERS}vn 1 0 0\nf 1//1 2 3\n")).unwrap();
    assert!(scene.meshes[0].normals.is_empty());
    assert!(scene.warnings[0].contains("no normal"), "{:?}", scene.warnings);
}

#[test]
fn vertices_have_colours_where_the_file_says_so_and_are_white_elsewhere() {
    let text = "v 0 0 0 1 0.5 0 # orange\nv 1 0 0 \\\n 0 0 1\nv 0 1 0\nf 1 2 3\n";
    let scene = read_text(text).unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.colours, [[255, 128, 0, 255], [0, 0, 255, 255], [255; 4]]);
    assert_eq!(mesh.positions[1..], [Vec3::X, Vec3::Y]);
    assert!(scene.unsupported.is_empty(), "{:?}", scene.unsupported);
    assert!(scene.warnings[0].contains("1 vertices without a colour are white"), "{:?}", scene.warnings);
    assert!(read_text(&format!("{CORNERS}f 1 2 3\n")).unwrap().meshes[0].colours.is_empty());
    // Corners of one position, normal and texture coordinate stay apart where their colours differ.
    let twice = "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nv 0 0 0 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 4//1 2//1 3//1\n";
    assert_eq!(read_text(twice).unwrap().meshes[0].positions.len(), 4);
    // Values beyond 1 are no colours of this kind; the shape is read all the same.
    let bright = read_text("v 0 0 0 255 0 0\nv 1 0 0 0 255 0\nv 0 1 0 0 0 255\nf 1 2 3\n").unwrap();
    assert!(bright.meshes[0].colours.is_empty());
    assert!(bright.unsupported[0].what.contains("not from 0 to 1: left out"), "{:?}", bright.unsupported);
}

#[test]
fn faults_are_named_with_their_line() {
    let check = |text: &str, line: usize, what: &str| {
        let message = read_text(text).expect_err(text).to_string();
        assert!(message.starts_with(&format!("t.obj:{line}: ")) && message.contains(what), "{message}");
    };
    check("v 0 0\n", 1, "2 numbers instead of 3");
    check("\nv 0 zero 0\n", 2, "\"zero\" is no finite number");
    check("v 0 nan 0\n", 1, "finite");
    check("v 0 0 inf\n", 1, "finite");
    check("v 1e999 0 0\n", 1, "finite");
    check("v 0 0 0 0\n", 1, "");
    check("v 0 0 0 1 1 1\nv 0 0 0 1\n", 2, "vertex has 4 numbers; where some vertices have colours");
    check("v 0 0 0 1 1\nv 0 0 0 1 1 1\n", 1, "vertex has 5 numbers");
    check("vt 1\n", 1, "1 numbers instead of 2");
    check(&format!("{CORNERS}f 1 2\n"), 5, "2 corners");
    check(&format!("{CORNERS}f 1 2 0\n"), 5, "the first one is 1");
    check(&format!("{CORNERS}f 1 2 3\nf 1 2 5\nf 1 2 3\n"), 6, "vertex 5, but there are only 4");
    check(&format!("{CORNERS}f 1 2 -5\n"), 5, "vertex -5");
    check(&format!("{CORNERS}vt 0 0\nf 1/1 2/2 3/1\n"), 6, "texture coordinate 2");
    check(&format!("{CORNERS}f 1//9223372036854775807 2 3\n"), 5, "normal 9223372036854775807");
    check(&format!("{CORNERS}f 1 2 x\n"), 5, "\"x\" is not of the form");
    check(&format!("{CORNERS}f 1/2/3/4 2 3\n"), 5, "more than three");
    check("usemtl \n", 1, "usemtl without");
}

#[test]
fn faults_of_libraries_are_named_with_their_line() {
    let check = |library: &str, line: usize, what: &str| {
        let files: [(&str, &[u8]); 1] = [("m.mtl", library.as_bytes())];
        let message = read_with(&files, "mtllib m.mtl\n").expect_err(library).to_string();
        assert!(message.starts_with(&format!("m.mtl:{line}: ")) && message.contains(what), "{message}");
    };
    check("newmtl a\nKd 1 2\n", 2, "2 numbers instead of 3");
    check("newmtl a\nKd 1 x 2\n", 2, "\"x\" is no finite number");
    check("newmtl a\nKe spectral f.rfl\n", 2, "not supported");
    check("newmtl a\nillum many\n", 2, "illumination model");
    check("newmtl a\nNs\n", 2, "without a number");
    check("newmtl \n", 1, "without a name");
    check("newmtl a\nmap_Kd\n", 2, "name of an image");
}

#[test]
fn a_colour_out_of_range_is_named_with_its_material() {
    let files: [(&str, &[u8]); 1] = [("m.mtl", b"newmtl glow\nKd 1.5 0 0\n")];
    let message = read_with(&files, "mtllib m.mtl\n").expect_err("albedo").to_string();
    assert!(message.contains("material \"glow\"") && message.contains("albedo"), "{message}");
}
