//! How far the light of one geometry is from that of another.

use glam::DVec3;
use ivg_format::Lattice;
use ivg_grid::IrradianceGrid;
use ivg_scene::FlatScene;

/// How far bakes of a geometry are from those of the reference. All but `mean` in shares of the root mean square of the
/// reference's I_d·d, at vertices that are valid in both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Comparison {
    /// Vertices compared.
    pub(super) vertices: usize,
    /// Root mean square of the difference of I_d·d, what noise adds to it taken off.
    pub(super) error: f64,
    /// What noise added: errors far below it cannot be told from none.
    pub(super) noise: f64,
    /// Mean of I_d·d over that of the reference.
    pub(super) mean: f64,
    /// The largest difference of the means of all bakes, noise included, as a share of the reference's largest value.
    pub(super) largest: f64,
}

/// Compares bakes with those of the reference at the `vertices`; bake n of one has the seed of bake n of the other, so that
/// what their photons have in common is no noise.
///
/// With d the mean difference of K bakes and s² their variance, d² − s²/K has the expectation of the squared difference
/// without noise.
///
/// # Panics
///
/// If there are not as many bakes of one as of the other, and at least two.
pub(super) fn compare(
    bakes: &[IrradianceGrid],
    reference: &[IrradianceGrid],
    vertices: &[usize],
) -> Comparison {
    assert!(bakes.len() == reference.len() && bakes.len() > 1, "bakes in pairs");
    let count = bakes.len() as f64;
    let (mut square, mut noise, mut unit) = (0.0, 0.0, 0.0);
    let (mut mean, mut of_reference, mut largest, mut brightest) = (0.0, 0.0, 0.0_f64, 0.0_f64);
    for &vertex in vertices {
        for component in 0..18 {
            let value = |grid: &IrradianceGrid| axis_component(grid, vertex, component);
            let [sum, exact] = [bakes, reference].map(|grids| grids.iter().map(value).sum::<f64>() / count);
            let differences = bakes.iter().zip(reference).map(|(a, b)| value(a) - value(b));
            let difference = sum - exact;
            let variance = differences.map(|d| (d - difference).powi(2)).sum::<f64>() / (count - 1.0);
            square += difference * difference;
            noise += variance / count;
            unit += exact * exact;
            mean += sum;
            of_reference += exact;
            largest = largest.max(difference.abs());
            brightest = brightest.max(exact);
        }
    }
    let share = |of: f64, whole: f64| if whole > 0.0 { of / whole } else { 0.0 };
    Comparison {
        vertices: vertices.len(),
        error: share((square - noise).max(0.0), unit).sqrt(),
        noise: share(noise, unit).sqrt(),
        mean: share(mean, of_reference),
        largest: share(largest, brightest),
    }
}

/// I_d·d of hemisphere `component` / 3 and colour `component` modulo 3 \[W/m²\].
fn axis_component(grid: &IrradianceGrid, vertex: usize, component: usize) -> f64 {
    let hemisphere = component / 3;
    f64::from(grid.vectors()[vertex][hemisphere][component % 3][hemisphere / 2]).abs()
}

/// Marks the vertices that lie in the box of a triangle grown by half a step: all that are nearer to a surface than that,
/// and some beside slanted ones.
pub(super) fn mark_near(flat: &FlatScene, lattice: &Lattice, near: &mut [bool]) {
    let [first, step] = [DVec3::from(lattice.origin), DVec3::from(lattice.step)];
    let half = 0.5 * step.max_element();
    for triangle in 0..flat.triangles.len() {
        let corners = flat.corners(triangle).map(|corner| flat.origin + corner.as_dvec3() - first);
        let low = corners[0].min(corners[1]).min(corners[2]) - half;
        let high = corners[0].max(corners[1]).max(corners[2]) + half;
        let ranges = [0, 1, 2].map(|axis| {
            let end = u64::from(lattice.dims[axis]);
            // An axis of one vertex has no step.
            let index = |x: f64| if step[axis] > 0.0 { x / step[axis] } else { x.signum() };
            let from = index(low[axis]).ceil().max(0.0) as u64;
            // A triangle that ends before the first vertex is near none.
            from..((index(high[axis]).floor() + 1.0).max(0.0) as u64).min(end)
        });
        let [xs, ys, zs] = ranges;
        for k in zs {
            for j in ys.clone() {
                for i in xs.clone() {
                    let row = k * u64::from(lattice.dims[1]) + j;
                    near[(row * u64::from(lattice.dims[0]) + i) as usize] = true;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
