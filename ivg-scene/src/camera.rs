use glam::DVec3;

/// A pinhole camera in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Position of the eye in world space \[m\].
    pub eye: DVec3,
    /// A point on the view axis in world space \[m\]; differs from `eye`.
    pub target: DVec3,
    /// Which way is up in the picture; need not be unit length nor perpendicular to the view axis.
    pub up: DVec3,
    /// Full vertical field of view \[rad\], in (0, pi).
    pub vertical_fov: f32,
}
