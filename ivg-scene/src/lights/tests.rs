use super::*;

fn applied(text: &str) -> Scene {
    let mut scene = Scene::default();
    apply(&mut scene, "l.toml", text).unwrap();
    scene.check().unwrap();
    scene
}

fn refused(text: &str) -> String {
    apply(&mut Scene::default(), "l.toml", text).expect_err(text).to_string()
}

#[test]
fn the_example_of_the_documentation_is_read_as_it_says() {
    let page = include_str!("../../LIGHTS.md");
    let example =
        page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("an example");
    let scene = applied(example);
    assert_eq!(scene.sky, Some(Vec3::new(0.3, 0.4, 0.6)));
    let camera = scene.camera.expect("a camera");
    assert_eq!((camera.eye.y, camera.eye.z), (1.6, 4.0));
    assert_eq!(camera.vertical_fov, 45f32.to_radians());
    assert_eq!(scene.meshes[0].name, "ceiling panel");
    let names: Vec<&str> = scene.lights.iter().map(|l| l.name.as_str()).collect();
    assert_eq!(names, ["light 2", "light 3", "light 4"]);
    let LightKind::Point { position, intensity } = scene.lights[0].kind else { panic!("a point") };
    assert_eq!((position.y, intensity), (2.0, Vec3::new(2.0, 2.0, 1.5)));
    let power = scene.lights[1].power().expect("a spot has a power");
    assert!((power - DVec3::splat(20.0)).abs().max_element() < 1e-5, "{power}");
    let LightKind::Directional { irradiance, .. } = scene.lights[2].kind else { panic!("directional") };
    assert_eq!(irradiance, Vec3::new(100.0, 95.0, 85.0));
}

#[test]
fn a_rect_becomes_a_black_one_sided_emissive_quad_facing_u_cross_v() {
    let scene = applied(
        "[[light]]\nkind = \"rect\"\ncenter = [0.8, 2.3, 0]\nu = [0.4, 0, 0]\nv = [0, 0, 0.4]\nradiance = [18, 16, 13]\n",
    );
    let material = &scene.materials[0];
    assert_eq!((material.albedo, material.two_sided), (Vec3::ZERO, false));
    assert_eq!(material.emission, Vec3::new(18.0, 16.0, 13.0));
    let flat = scene.flatten();
    assert_eq!([flat.geometric_normal(0), flat.geometric_normal(1)], [Vec3::NEG_Y; 2]);
    // Edges of 0.8 m: 0.64 m²; two roundings of f32 corners.
    assert!((flat.area(0) + flat.area(1) - 0.64).abs() < 1e-6);
    let (min, max) = scene.bounds();
    assert!(
        (min - DVec3::new(0.4, 2.3, -0.4)).length() < 1e-6
            && (max - DVec3::new(1.2, 2.3, 0.4)).length() < 1e-6
    );
}

#[test]
fn unit_scales_scene_and_lights_but_no_radiometric_figure() {
    let mut scene = Scene {
        lights: vec![Light {
            name: "own".into(),
            kind: LightKind::Point { position: DVec3::splat(1000.0), intensity: Vec3::ONE },
        }],
        ..Scene::default()
    };
    scene.meshes.push(Mesh { positions: vec![Vec3::X], ..Mesh::default() });
    scene.nodes.push(Node {
        name: "n".into(),
        mesh: 0,
        transform: DAffine3::from_translation(DVec3::splat(5.0)),
    });
    let text = "unit = 0.5\n[[light]]\nkind = \"point\"\nposition = [2, 0, 0]\nintensity = [1, 2, 3]\n";
    apply(&mut scene, "l.toml", text).unwrap();
    assert_eq!(scene.nodes[0].transform.transform_point3(DVec3::X), DVec3::new(3.0, 2.5, 2.5));
    let places: Vec<LightKind> = scene.lights.iter().map(|l| l.kind).collect();
    assert_eq!(places[0], LightKind::Point { position: DVec3::splat(500.0), intensity: Vec3::ONE });
    assert_eq!(places[1], LightKind::Point { position: DVec3::X, intensity: Vec3::new(1.0, 2.0, 3.0) });
}

#[test]
fn power_of_a_point_is_spread_over_the_sphere() {
    let scene =
        applied("[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\npower = [12.566370614359172, 0, 0]\n");
    assert_eq!(scene.lights[0].kind.strength(), Vec3::X);
}

#[test]
fn faults_are_named_with_their_line() {
    let check = |text: &str, line: usize, what: &str| {
        let message = refused(text);
        assert!(message.starts_with(&format!("l.toml:{line}: ")) && message.contains(what), "{message}");
    };
    check("\n\nlamp = 3\n", 3, "unknown field `lamp`");
    check("[[light]]\nkind = \"laser\"\n", 2, "laser");
    check("\n[[light]]\nkind = \"point\"\nposition = [0, 0]\n", 4, "");
    check("\n[[light]]\nkind = \"point\"\nintensity = [1, 1, 1]\n", 2, "needs `position`");
    check("[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\n", 1, "`power` in W");
    check("[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\nintensity = [1, -1, 1]\n", 1, "at least 0");
    check("[[light]]\nkind = \"point\"\nposition = [nan, 0, 0]\nintensity = [1, 1, 1]\n", 1, "finite");
    check("[[light]]\nkind = \"rect\"\nposition = [0, 0, 0]\n", 1, "a rect light has no `position`");
    check(
        "unit = 1\n[[light]]\nkind = \"rect\"\ncenter = [0, 0, 0]\nu = [1, 0, 0]\nv = [2, 0, 0]\nradiance = [1, 1, 1]\n",
        2,
        "span an area",
    );
    check(
        "[[light]]\nkind = \"spot\"\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\nintensity = [1, 1, 1]\nouter = 95\n",
        1,
        "90 degrees",
    );
    check(
        "[[light]]\nkind = \"directional\"\ndirection = [0, 0, 0]\nirradiance = [1, 1, 1]\n",
        1,
        "direction is zero",
    );
    check("unit = 0\n", 1, "positive");
    check("\nsky = [1, 1, inf]\n", 2, "sky");
    check("[camera]\neye = [0, 0, 0]\ntarget = [0, 0, 0]\n", 1, "same point");
    check("[camera]\neye = [0, 0, 0]\ntarget = [0, 0, 1]\nfov = 180\n", 1, "fov");
    check("this is not TOML", 1, "");
}
