//! Directions drawn from the image of a sky, in proportion to what comes from them.

use glam::Vec3;
use ivg_scene::SkyImage;

use super::light::AliasTable;
use super::rng::{Purpose, Stream, unit};

/// An image of a sky ready for drawing.
#[derive(Debug)]
pub(crate) struct SkyTable {
    image: SkyImage,
    choice: AliasTable,
    /// Integral of the brightest channel over all directions \[W/m²\].
    brightest: f64,
}

impl SkyTable {
    /// The table of an image.
    pub(crate) fn new(image: &SkyImage) -> Self {
        let weights: Vec<f64> = (0..image.height)
            .flat_map(|row| (0..image.width).map(move |column| (column, row)))
            .map(|(column, row)| f64::from(image.texel(column, row).max_element()) * image.solid_angle(row))
            .collect();
        Self { image: image.clone(), choice: AliasTable::new(&weights), brightest: weights.iter().sum() }
    }

    /// Integral over all directions of each texel's brightest channel \[W/m²\].
    pub(crate) fn brightest(&self) -> f64 {
        self.brightest
    }

    /// Radiance from the unit direction `towards` \[W/(m² sr)\].
    pub(crate) fn radiance(&self, towards: Vec3) -> Vec3 {
        self.image.radiance(towards)
    }

    /// A direction that light comes from, with density in proportion to the brightest channel of its radiance, and that
    /// radiance divided by its brightest channel. The sky must not be black.
    pub(crate) fn draw(&self, stream: &Stream, step: u32) -> (Vec3, Vec3) {
        let [column, coin, x, y] = stream.words(step, Purpose::Sky);
        let texel = self.choice.draw(column, coin) as u32;
        let (column, row) = (texel % self.image.width, texel / self.image.width);
        let [upper, lower] = self.image.row_cosines(row);
        let across = (f64::from(column) + f64::from(unit(x))) / f64::from(self.image.width);
        let towards = self.image.direction(across, upper + (lower - upper) * f64::from(unit(y)));
        let radiance = self.image.texel(column, row);
        (towards, radiance / radiance.max_element().max(f32::MIN_POSITIVE))
    }
}

#[cfg(test)]
mod tests;
