//! Fresnel's equations for smooth dielectrics, unpolarised light.

/// Share reflected where light meets a smooth border at cosine `cos` in (0, 1], and the cosine at which the rest goes on behind
/// it; `None` for total reflection. `eta` is the index of refraction before the border divided by that behind.
pub(super) fn interface(cos: f32, eta: f32) -> (f32, Option<f32>) {
    let cos = cos.clamp(0.0, 1.0);
    let sin2 = eta * eta * (1.0 - cos * cos);
    if sin2 >= 1.0 {
        return (1.0, None);
    }
    let behind = (1.0 - sin2).sqrt();
    let share = |a: f32, b: f32| if a + b > 0.0 { ((a - b) / (a + b)).powi(2) } else { 1.0 };
    (0.5 * (share(eta * cos, behind) + share(cos, eta * behind)), Some(behind))
}

/// Share reflected by a pane of index `n`, which lets the rest through without a bend. A pane that is a single sheet
/// stands for its two faces with all that goes to and fro between them: R + T² R (1 + R² + …) = 2 R / (1 + R) (Pharr,
/// Jakob, Humphreys, "Physically based rendering", 4th edition, section 9.5.1); one whose faces are both there, for one.
pub(super) fn pane(cos: f32, n: f32, both_faces: bool) -> f32 {
    let (one, _) = interface(cos, 1.0 / n);
    if both_faces { 2.0 * one / (1.0 + one) } else { one }
}

#[cfg(test)]
mod tests;
