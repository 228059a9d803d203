//! Skies that are images: light from outside that differs from direction to direction.

use core::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

/// An equirectangular image of the radiance from all directions; nothing is interpolated between its texels.
///
/// Rows lead from straight up (+y) to straight down, columns around: the middle of the image lies towards -z, its right
/// half towards +x.
#[derive(Debug, Clone, PartialEq)]
pub struct SkyImage {
    /// The file it came from.
    pub name: String,
    /// Width \[texels\], >= 1.
    pub width: u32,
    /// Height \[texels\], >= 1.
    pub height: u32,
    /// Angle by which the sky is turned about +y, counter-clockwise seen from above \[rad\].
    pub rotation: f32,
    /// Radiance \[W/(m² sr)\], linear RGB, each channel >= 0; `width * height` texels, row by row from the top.
    pub texels: Vec<[f32; 3]>,
}

impl SkyImage {
    /// Radiance that arrives from the unit direction `towards` \[W/(m² sr)\], linear RGB.
    ///
    /// # Panics
    ///
    /// Panics if there are fewer texels than the size says ([`Scene::check`](crate::Scene::check)).
    #[must_use]
    pub fn radiance(&self, towards: Vec3) -> Vec3 {
        let w = towards.as_dvec3();
        let row = (w.y.clamp(-1.0, 1.0).acos() / PI * f64::from(self.height)) as u32;
        // Columns are counted against the turn of the sky.
        let round = (w.x.atan2(-w.z) + f64::from(self.rotation)) / TAU + 0.5;
        let column = ((round - round.floor()) * f64::from(self.width)) as u32;
        self.texel(column.min(self.width - 1), row.min(self.height - 1))
    }

    /// The unit direction to a place of the image: `x` from 0 to 1 over its columns, `cos` the cosine from straight up.
    #[must_use]
    pub fn direction(&self, x: f64, cos: f64) -> Vec3 {
        let round = (x - 0.5) * TAU - f64::from(self.rotation);
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        DVec3::new(sin * round.sin(), cos, -sin * round.cos()).as_vec3()
    }

    /// Radiance of a texel \[W/(m² sr)\].
    ///
    /// # Panics
    ///
    /// Panics if the texel is out of range.
    #[must_use]
    pub fn texel(&self, column: u32, row: u32) -> Vec3 {
        Vec3::from_array(self.texels[row as usize * self.width as usize + column as usize])
    }

    /// Cosines from straight up of the upper and the lower border of a row of texels.
    #[must_use]
    pub fn row_cosines(&self, row: u32) -> [f64; 2] {
        [row, row + 1].map(|border| (f64::from(border) / f64::from(self.height) * PI).cos())
    }

    /// Solid angle of each texel of a row \[sr\].
    #[must_use]
    pub fn solid_angle(&self, row: u32) -> f64 {
        let [upper, lower] = self.row_cosines(row);
        TAU / f64::from(self.width) * (upper - lower)
    }

    /// Mean radiance over all directions \[W/(m² sr)\].
    #[must_use]
    pub fn mean(&self) -> Vec3 {
        let rows = self.texels.chunks_exact(self.width.max(1) as usize);
        let sum: DVec3 = (0..)
            .zip(rows)
            .map(|(row, texels)| {
                self.solid_angle(row) * texels.iter().map(|t| Vec3::from_array(*t).as_dvec3()).sum::<DVec3>()
            })
            .sum();
        (sum / (4.0 * PI)).as_vec3()
    }

    /// The image with at most `widest` columns: the means of square blocks of texels.
    pub(crate) fn reduced(self, widest: u32) -> Self {
        let block = self.width.div_ceil(widest);
        if block <= 1 {
            return self;
        }
        let (width, height) = (self.width.div_ceil(block), self.height.div_ceil(block));
        let texels = (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| {
                let columns = x * block..((x + 1) * block).min(self.width);
                let rows = y * block..((y + 1) * block).min(self.height);
                let count = columns.len() * rows.len();
                let all = rows.flat_map(|row| columns.clone().map(move |column| (column, row)));
                let sum: DVec3 = all.map(|(column, row)| self.texel(column, row).as_dvec3()).sum();
                (sum / count as f64).as_vec3().to_array()
            })
            .collect();
        Self { width, height, texels, ..self }
    }
}

#[cfg(test)]
mod tests;
