//! What is seen where there is no surface. It depends on the direction of a sample alone, so both renderers put it in when
//! they know which samples see nothing: pictures of a sky are the same on every device.

use glam::{DVec3, Vec3};
use ivg_scene::{Camera, SkyImage};

use crate::RenderError;
use crate::camera::Frame;

/// Radiance behind everything, sample by sample.
#[derive(Debug, Clone, Copy)]
pub struct Background<'scene> {
    /// Radiance from everywhere \[W/(m² sr)\], linear RGB.
    pub even: Vec3,
    /// An image of the radiance from each direction, which adds to it.
    pub image: Option<Panorama<'scene>>,
}

/// The image of a sky and the way from samples to directions.
#[derive(Debug, Clone, Copy)]
pub struct Panorama<'scene> {
    sky: &'scene SkyImage,
    /// Direction to the middle of the picture.
    forward: DVec3,
    /// From the middle of the picture to its right and its upper border, at distance 1.
    right: DVec3,
    up: DVec3,
    /// Width and height \[samples\].
    size: [u32; 2],
}

impl<'scene> Panorama<'scene> {
    /// The image `sky` as `camera` sees it in a picture of `size` samples.
    ///
    /// # Errors
    ///
    /// As [`view_projection`](crate::camera::view_projection).
    pub fn new(sky: &'scene SkyImage, camera: &Camera, size: [u32; 2]) -> Result<Self, RenderError> {
        let Frame { forward, up, angle } = Frame::new(camera)?;
        let right = forward.cross(up).normalize();
        let (aspect, half) = (f64::from(size[0]) / f64::from(size[1]), (0.5 * angle).tan());
        Ok(Self { sky, forward, right: right * (half * aspect), up: right.cross(forward) * half, size })
    }

    /// Radiance that a sample sees \[W/(m² sr)\]; samples are counted row by row from the upper left corner.
    fn radiance(&self, sample: usize) -> Vec3 {
        let [width, height] = self.size.map(|side| side as usize);
        let [x, y] = [(sample % width, width), (sample / width, height)]
            .map(|(at, side)| (at as f64 + 0.5) * 2.0 / side as f64 - 1.0);
        self.sky.radiance((self.forward + self.right * x - self.up * y).normalize().as_vec3())
    }
}

impl Background<'_> {
    /// Radiance that a sample sees where there is no surface \[W/(m² sr)\]; samples are counted row by row from the upper left
    /// corner.
    #[must_use]
    pub fn radiance(&self, sample: usize) -> Vec3 {
        self.even + self.image.map_or(Vec3::ZERO, |image| image.radiance(sample))
    }
}

#[cfg(test)]
mod tests;
