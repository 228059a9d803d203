//! From a camera to a projection matrix.

use glam::dcamera::rh::{proj::directx, view};
use glam::{DVec3, Mat4};
use ivg_scene::Camera;

use crate::RenderError;

/// Where a camera looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    /// Unit direction to the middle of the picture.
    pub(crate) forward: DVec3,
    /// A unit direction to the upper side of the picture, not perpendicular to `forward`.
    pub(crate) up: DVec3,
    /// Vertical angle of view \[rad\].
    pub(crate) angle: f64,
}

impl Frame {
    /// # Errors
    ///
    /// As [`view_projection`].
    pub(crate) fn new(camera: &Camera) -> Result<Self, RenderError> {
        if !(camera.eye.is_finite() && camera.target.is_finite() && camera.up.is_finite()) {
            return Err(RenderError::NotFinite { what: "the camera".into() });
        }
        let forward = (camera.target - camera.eye)
            .try_normalize()
            .ok_or(RenderError::Camera { problem: "has its target at its eye" })?;
        let angle = f64::from(camera.vertical_fov);
        if !(angle > 0.0 && angle < std::f64::consts::PI) {
            return Err(RenderError::Camera { problem: "has a field of view outside (0, pi)" });
        }
        // An up direction along the view axis says nothing: any perpendicular one will do.
        let up = if forward.cross(camera.up.normalize_or_zero()).length_squared() > 1e-12 {
            camera.up.normalize()
        } else {
            forward.any_orthonormal_vector()
        };
        Ok(Self { forward, up, angle })
    }
}

/// The matrix from scene space (relative to `origin`) to clip space: right-handed, x right, y up, depth reversed
/// (1 at distance `near`, 0 at infinity), as WebGPU has it.
///
/// Reversed depth is `near / distance`: a float then has the same relative precision at every distance, so `near`
/// \[m\] may be as small as the scene likes.
///
/// # Errors
///
/// [`RenderError::Camera`] if eye and target coincide or the angle is not in (0, pi), [`RenderError::NotFinite`].
pub fn view_projection(camera: &Camera, origin: DVec3, aspect: f64, near: f64) -> Result<Mat4, RenderError> {
    let Frame { forward, up, angle } = Frame::new(camera)?;
    let eye = camera.eye - origin;
    let view = view::look_to_mat4(eye, forward, up);
    Ok((directx::perspective_infinite_reverse(angle, aspect, near) * view).as_mat4())
}

#[cfg(test)]
mod tests;
