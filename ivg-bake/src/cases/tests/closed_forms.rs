//! Bakes against closed forms, and lattices in awkward places.

use core::f64::consts::PI;

use glam::{DAffine3, DVec3, Vec3};
use ivg_scene::{Light, LightKind, Material};

use super::check;
use crate::cases::{
    SceneBuilder, ball_under_sky, cavity_with_source, cross_coloured_grid, cross_coloured_walls, difference,
    furnace_on_lattice, lit_disk, parallel_plates, plan,
};
use crate::dual::{Boxes, Line};
use crate::{BakeError, BakeOptions, BakeResult, Silent, bake};

/// With those of `balls_under_an_even_sky_are_as_dark_as_they_absorb`, of albedo 0, 0.5 and 1.
#[test]
fn white_furnaces_under_a_sky_have_their_closed_form() {
    for albedo in [0.25, 0.75, 0.95] {
        let material = Material { albedo: Vec3::splat(albedo), ..Material::default() };
        let name = format!("ball of albedo {albedo} under an even sky");
        check(&ball_under_sky(&name, material, f64::from(albedo), 40_000).unwrap(), 0.1);
    }
}

#[test]
fn plates_between_mirrors_have_the_closed_form_of_infinite_ones() {
    for from_above in [true, false] {
        check(&parallel_plates(from_above, 20_000).unwrap(), 0.06);
    }
}

#[test]
fn a_disk_in_parallel_light_has_its_closed_form() {
    check(&lit_disk(150_000).unwrap(), 0.15);
}

/// A source of 1 mm and 10⁷ W/(m² sr) in a room of 1 m: as the others, and no vertex is brighter for it.
#[test]
fn a_tiny_bright_light_has_its_closed_form() {
    check(&cavity_with_source(0.8, 5e-4, 1e7, 30_000).unwrap(), 0.1);
}

/// Emitting walls on vertices, in edges and corners of the lattice; in planes between cells; in lattices of few vertices.
#[test]
fn lattices_may_lie_and_end_anywhere_in_a_furnace() {
    let whole = (DVec3::ZERO, DVec3::ONE);
    let inside = (DVec3::splat(0.25), DVec3::splat(0.75));
    let half_step = (DVec3::splat(0.125), DVec3::splat(0.875));
    for (name, dims, bounds) in [
        ("vertices on the walls", [5; 3], whole),
        ("walls between cells", [4; 3], half_step),
        ("1 x 3 x 4 vertices", [1, 3, 4], inside),
        ("2 x 2 x 2 vertices", [2; 3], inside),
        ("1 vertex", [1; 3], inside),
    ] {
        check(&furnace_on_lattice(name, dims, bounds, 10_000).unwrap(), 0.06);
    }
}

#[test]
fn cross_coloured_walls_cancel() {
    check(&cross_coloured_walls(20_000).unwrap(), 0.1);
    let grid = cross_coloured_grid(20_000, 1).unwrap();
    for vectors in grid.vectors() {
        // Nothing but red comes from +x, nothing but green from −x, and blue from nowhere.
        assert_eq!([vectors[0][1], vectors[1][0]], [[0.0; 3]; 2]);
        assert!(vectors.iter().all(|hemisphere| hemisphere[2] == [0.0; 3]));
        assert!(vectors[0][0][0] > 0.0 && vectors[1][1][0] < 0.0);
        for colour in [0, 1] {
            // The net flux is one, whichever axis divides it: sums of the same deposits, three in f32.
            let net = |axis: usize| {
                Vec3::from(vectors[2 * axis][colour]) + Vec3::from(vectors[2 * axis + 1][colour])
            };
            for axis in [1, 2] {
                let off = (net(axis) - net(0)).abs().max_element();
                assert!(off <= 1e-6 * net(0).length(), "{off} {}", net(0));
            }
        }
    }
}

fn baked(builder: SceneBuilder, options: &BakeOptions) -> Result<BakeResult, BakeError> {
    let (scene, flat) = builder.build();
    bake(&scene, &flat, &plan(&scene, 8), options, &Silent)
}

/// A floor without thickness fills one plane of its own bounds: the lattice grows around it. Above it there is what it
/// reflects, below it nothing.
#[test]
fn a_flat_scene_has_light_on_one_side() {
    let mut builder = SceneBuilder::default();
    let white = builder.material(0.5, 0.0, true);
    builder.quad(Vec3::ZERO, Vec3::Z * 2.0, Vec3::X * 2.0, white);
    builder.light(LightKind::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::ONE });
    let options = BakeOptions { dims: [4, 6, 4], photons: 20_000, ..BakeOptions::default() };
    let grid = baked(builder, &options).unwrap().grid;
    let lattice = *grid.lattice();
    for (index, vectors) in grid.vectors().iter().enumerate() {
        let [i, j, k] = lattice.coords(index as u64);
        let [x, y, z] = lattice.position(i, j, k);
        // Below, where no light comes to and only backs are seen, vertices may count as inside.
        assert!(y.abs() > 0.1 && (grid.is_valid(index) || y < 0.0), "{y}");
        if y > 0.0 {
            // Some thousand photons meet the floor; over it no cell is missed by all, beside it one may be.
            let over = [x, z].into_iter().all(|x| (0.0..=2.0).contains(&x));
            assert!(vectors[3][1][1] < 0.0 || !over, "from below at {x} {y} {z}");
            assert_eq!(vectors[2][1], [0.0; 3], "from above at y = {y}");
        } else {
            assert_eq!(*vectors, [[[0.0; 3]; 3]; 6], "y = {y}");
        }
    }
}

/// A sphere makes the vertices inside it invalid, as many as there are, and no others.
#[test]
fn a_sphere_makes_the_vertices_inside_it_invalid() {
    let between = Vec3::splat(0.1);
    for (middle, radius, inside) in [
        (between, 0.1, 0),
        (Vec3::ZERO, 0.15, 1),
        (Vec3::ZERO, 0.25, 7),
        (Vec3::ZERO, 0.32, 19),
        (Vec3::ZERO, 0.36, 27),
    ] {
        let mut builder = SceneBuilder::default();
        let wall = builder.material(0.7, 0.0, true);
        let lamp = builder.material(0.0, 9.0, true);
        builder.cuboid(Vec3::splat(-1.0), Vec3::splat(1.0), wall, true);
        builder.quad(Vec3::new(-0.3, 0.9, -0.3), Vec3::X * 0.6, Vec3::Z * 0.6, lamp);
        // Its polyhedron lies less than 0.5 % inside the round sphere; vertices are 0, 0.2, 0.28, 0.35 and 0.4 m from the middle.
        builder.sphere(middle, radius, 4, wall, false);
        let bounds = Some((DVec3::splat(-0.6), DVec3::splat(0.6)));
        let options = BakeOptions { dims: [7; 3], bounds, photons: 3000, ..BakeOptions::default() };
        let grid = baked(builder, &options).unwrap().grid;
        assert_eq!(grid.vertex_count() - grid.valid_count(), inside, "radius {radius}");
        for (index, vectors) in grid.vectors().iter().enumerate() {
            let [i, j, k] = grid.lattice().coords(index as u64);
            let distance = DVec3::from(grid.lattice().position(i, j, k)).distance(middle.as_dvec3());
            assert_eq!(grid.is_valid(index), distance > f64::from(radius), "{distance}");
            assert!(grid.is_valid(index) || *vectors == [[[0.0; 3]; 3]; 6], "{distance}");
        }
    }
}

/// A light that emits nothing sends no photon: the grid is, bit for bit, that of the scene without it. One whose photons
/// carry nothing in two colours lights the third.
#[test]
fn lights_without_power_change_nothing() {
    let room = |lights: &[Vec3]| {
        let mut builder = SceneBuilder::default();
        let wall = builder.material(0.7, 0.0, true);
        builder.cuboid(Vec3::ZERO, Vec3::ONE, wall, true);
        for (n, &intensity) in lights.iter().enumerate() {
            let position = DVec3::new(0.3 + 0.2 * n as f64, 0.6, 0.45);
            builder.light(LightKind::Point { position, intensity });
        }
        builder
    };
    let bounds = Some((DVec3::splat(0.2), DVec3::splat(0.8)));
    let options = BakeOptions { dims: [3; 3], bounds, photons: 5000, ..BakeOptions::default() };
    let alone = baked(room(&[Vec3::ONE]), &options).unwrap();
    let beside = baked(room(&[Vec3::ONE, Vec3::ZERO]), &options).unwrap();
    assert_eq!(alone.grid, beside.grid);
    assert!(alone.grid.largest_component() > 0.0);
    assert_eq!(baked(room(&[Vec3::ZERO]), &options).unwrap_err(), BakeError::NoLight);
    let blue = baked(room(&[Vec3::Z]), &options).unwrap();
    for vectors in blue.grid.vectors() {
        assert!(vectors.iter().all(|channels| channels[..2] == [[0.0; 3]; 2]));
        assert!(vectors[2][2][1] > 0.0);
    }
}

/// By numbers that are no powers of two positions are rounded anew, by 2⁻²⁴ of 4096 bake units: up to 1e-6 of a stretch in a
/// cell of some hundred, a few times that after some reflections, and of either sign, so that sums of many stretches are off
/// by less. None of the photons meets an edge so nearly that it goes another way, and no vertex lies on a wall, where what it
/// sees could change.
#[test]
fn any_scale_and_place_agree_to_1e_5() {
    let mut builder = SceneBuilder::default();
    let wall = builder.material(0.6, 0.0, false);
    builder.cuboid(Vec3::new(-0.75, -0.5, -0.25), Vec3::new(0.75, 0.5, 0.5), wall, true);
    let (scene, _) = builder.build();
    let grid = |transform: DAffine3| {
        let mut scene = scene.clone();
        scene.nodes[0].transform = transform;
        let place = |x, y, z| transform.transform_point3(DVec3::new(x, y, z));
        // As bright as its room is large.
        let intensity = Vec3::splat((transform.matrix3.x_axis.length_squared()) as f32);
        let kind = LightKind::Point { position: place(0.1, 0.2, 0.1), intensity };
        scene.lights.push(Light { name: "lamp".into(), kind });
        let flat = scene.flatten();
        let bounds = Some((place(-0.6, -0.4, -0.2), place(0.6, 0.4, 0.4)));
        let options = BakeOptions { dims: [4; 3], bounds, photons: 10_000, ..BakeOptions::default() };
        bake(&scene, &flat, &plan(&scene, 64), &options, &Silent).unwrap().grid
    };
    let here = grid(DAffine3::IDENTITY);
    for transform in [
        DAffine3::from_scale(DVec3::splat(1e-4)),
        DAffine3::from_scale(DVec3::splat(1e6)),
        DAffine3::from_translation(DVec3::new(1e6, -3e5, 1e6)),
    ] {
        let there = grid(transform);
        assert_eq!(here.validity(), there.validity());
        let off = difference(&there, &here);
        assert!(off <= 1e-5, "{off} with {transform:?}");
    }
}

/// Flights that run in a face between cells, along an edge of four or through corners belong to one cell at a time: lengths
/// are neither lost nor counted twice.
#[test]
fn flights_in_faces_edges_and_corners_of_cells_are_counted_once() {
    let boxes = Boxes { low: [0.0; 3], step: [1.0; 3], count: [4; 3] };
    let diagonal = [2.0f32, 3.0].map(f32::sqrt);
    for (what, origin, direction, length) in [
        ("in a face", Vec3::new(-1.0, 2.0, 1.5), Vec3::X, 4.0),
        ("along an edge", Vec3::new(-1.0, 2.0, 1.0), Vec3::X, 4.0),
        ("along an edge, backwards", Vec3::new(5.0, 2.0, 1.0), Vec3::NEG_X, 4.0),
        (
            "through edges",
            Vec3::new(0.0, 0.0, 0.5),
            Vec3::new(1.0, 1.0, 0.0) / diagonal[0],
            4.0 * diagonal[0],
        ),
        ("through corners", Vec3::ZERO, Vec3::ONE / diagonal[1], 4.0 * diagonal[1]),
        ("through corners, backwards", Vec3::splat(4.0), Vec3::NEG_ONE / diagonal[1], 4.0 * diagonal[1]),
        ("from a corner", Vec3::splat(2.0), Vec3::Y, 2.0),
    ] {
        let (mut sum, mut last) = (0.0, 0.0f32);
        boxes.walk(&Line::new(origin, direction), 0.0, 100.0, |_, t0, t1| {
            assert!(t0 >= last && t1 > t0, "{what}: one after the other");
            (sum, last) = (sum + f64::from(t1 - t0), t1);
        });
        // Roundings of f32 at lengths below 8, a few a cell.
        assert!((sum - f64::from(length)).abs() < 1e-5, "{what}: {sum} of {length}");
    }
}

/// What the sky's and the walls' closed forms have in common: radiance 1 everywhere gives π, to the last digit of its sum.
#[test]
fn outcomes_tell_what_was_expected_and_what_was_measured() {
    let outcome = parallel_plates(true, 500).unwrap();
    assert!((outcome.expected - 0.8 * PI / 0.6).abs() < 1e-7, "{outcome:?}");
    let relative = outcome.measured / outcome.expected - 1.0;
    assert!((relative - outcome.figure).abs() < 1e-12, "{outcome:?}");
}
