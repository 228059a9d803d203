//! Which wedge of the parent each wedge of a removed vertex becomes.

use std::ops::Range;

use pmesh_format::Wedges;

use crate::surface::Surface;

/// Fills `targets` with one wedge of `v` for each wedge in `wedges`, the wedges of `u`.
///
/// A face that vanishes has a corner on either vertex: these two wedges lie on the same side of any seam, so one becomes
/// the other (the first face around `u` decides). A wedge that no such face has becomes the wedge of `v` that is most
/// like it, among those that faces use; ties go to the lowest.
pub(crate) fn pair(
    surface: &Surface,
    attributes: &Wedges,
    (u, wedges): (u32, Range<u32>),
    (v, parents): (u32, Range<u32>),
    targets: &mut Vec<u32>,
) {
    targets.clear();
    if parents.len() == 1 {
        targets.resize(wedges.len(), parents.start);
        return;
    }
    targets.resize(wedges.len(), u32::MAX);
    let corner = |f: u32, x: u32| {
        let at = surface.faces[f as usize].iter().position(|&y| y == x)?;
        Some(surface.corners[f as usize][at])
    };
    for &f in surface.around(u) {
        if let (Some(from), Some(to)) = (corner(f, u), corner(f, v)) {
            let target = &mut targets[(from - wedges.start) as usize];
            if *target == u32::MAX {
                *target = to;
            }
        }
    }
    let mut candidates: Vec<u32> = surface.around(v).iter().filter_map(|&f| corner(f, v)).collect();
    candidates.sort_unstable();
    candidates.dedup();
    if candidates.is_empty() {
        candidates.extend(parents);
    }
    for (wedge, target) in wedges.zip(targets.iter_mut()).filter(|(_, target)| **target == u32::MAX) {
        let nearest = candidates
            .iter()
            .min_by(|&&a, &&b| difference(attributes, wedge, a).total_cmp(&difference(attributes, wedge, b)));
        *target = *nearest.expect("every vertex has a wedge");
    }
}

/// How unlike two wedges are: the sum of squared differences of normals, texture coordinates, and colours as fractions
/// of 255.
fn difference(attributes: &Wedges, a: u32, b: u32) -> f64 {
    let (a, b) = (a as usize, b as usize);
    let squares = |x: &[f32], y: &[f32]| -> f64 {
        x.iter().zip(y).map(|(&x, &y)| (f64::from(x) - f64::from(y)) * (f64::from(x) - f64::from(y))).sum()
    };
    let mut sum = 0.0;
    if !attributes.normals.is_empty() {
        sum += squares(&attributes.normals[a], &attributes.normals[b]);
    }
    if !attributes.uvs.is_empty() {
        sum += squares(&attributes.uvs[a], &attributes.uvs[b]);
    }
    if !attributes.colours.is_empty() {
        let fraction = |c: [u8; 4]| c.map(|x| f32::from(x) / 255.0);
        sum += squares(&fraction(attributes.colours[a]), &fraction(attributes.colours[b]));
    }
    sum
}

#[cfg(test)]
mod tests;
