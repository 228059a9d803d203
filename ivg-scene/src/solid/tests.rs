use glam::Vec3;

use super::*;

/// A tetrahedron whose triangles share no vertices; volume > 0 where its fronts are outside.
fn tetrahedron(flat: &mut FlatScene, at: Vec3, inside_out: bool) {
    let p = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|p| p + at);
    for [a, b, c] in [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] {
        let first = flat.positions.len() as u32;
        flat.positions.extend(if inside_out { [p[a], p[c], p[b]] } else { [p[a], p[b], p[c]] });
        flat.triangles.push([first, first + 1, first + 2]);
    }
}

#[test]
fn closed_bodies_are_solid_and_know_their_inside() {
    let mut flat = FlatScene::default();
    tetrahedron(&mut flat, Vec3::ZERO, false);
    tetrahedron(&mut flat, Vec3::splat(1000.0), true);
    let sides = flat.sides(|_| true);
    assert_eq!(sides[..4], [Side::SolidBehind; 4]);
    assert_eq!(sides[4..], [Side::SolidBefore; 4]);
}

#[test]
fn a_hole_or_a_turned_face_makes_a_sheet() {
    let mut flat = FlatScene::default();
    tetrahedron(&mut flat, Vec3::ZERO, false);
    tetrahedron(&mut flat, Vec3::splat(3.0), false);
    // Not all of the first belongs.
    let sides = flat.sides(|t| t != 2);
    assert_eq!(sides[..4], [Side::Sheet; 4]);
    assert_eq!(sides[4..], [Side::SolidBehind; 4]);
    flat.triangles[1].swap(0, 1);
    assert_eq!(flat.sides(|_| true)[..4], [Side::Sheet; 4]);
}

#[test]
fn triangles_without_area_do_not_open_a_body() {
    let mut flat = FlatScene::default();
    tetrahedron(&mut flat, Vec3::ZERO, false);
    flat.triangles.push([0, 1, 1]);
    assert_eq!(flat.sides(|_| true), [[Side::SolidBehind; 4].as_slice(), &[Side::Sheet]].concat());
}
