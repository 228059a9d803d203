//! The lattice of quantised positions: `spec/pmesh.md`, PMESH-POS-03.

/// Points at whole steps from the least corner of the bounding box.
pub(super) struct Lattice {
    least: [f64; 3],
    step: f64,
    /// The greatest number along each axis.
    pub(super) most: [i64; 3],
}

impl Lattice {
    pub(super) fn new(bounds: [[f32; 3]; 2], bits: u8) -> Self {
        let [least, greatest] = bounds.map(|corner| corner.map(f64::from));
        let extent = [0, 1, 2].map(|k| greatest[k] - least[k]);
        let longest = extent[0].max(extent[1]).max(extent[2]);
        let intervals = (1i64 << bits) - 1;
        let step = longest / intervals as f64;
        // Whole numbers nearest to extent / step, halves upwards; there is only 0 in a box without extent.
        let most =
            extent.map(
                |extent| {
                    if step == 0.0 { 0 } else { ((extent / step + 0.5).floor() as i64).min(intervals) }
                },
            );
        Self { least, step, most }
    }

    pub(super) fn position(&self, point: [i64; 3]) -> [f32; 3] {
        [0, 1, 2].map(|k| (self.least[k] + point[k] as f64 * self.step) as f32)
    }
}
