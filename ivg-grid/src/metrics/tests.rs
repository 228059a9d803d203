use super::*;

#[test]
fn the_errors_of_two_values_are_computed_by_hand() {
    let mut error = IrradianceError::default();
    // Differences -1, 1, 0 and, after the cut, -2, 0, -4; exact values sum to 24, mean 4.
    error.add(Vec3::new(3.0, 5.0, 4.0), DVec3::splat(4.0));
    error.add(Vec3::new(2.0, 4.0, -9.0), DVec3::splat(4.0));
    assert_eq!(error.count(), 6);
    assert!((error.relative_rmse() - (22.0_f64 / 6.0).sqrt() / 4.0).abs() < 1e-15);
    // Of the mean square 22/6, 10/6 is noise of the exact values.
    assert!((error.relative_rmse_less(10.0 / 6.0) - 2.0_f64.sqrt() / 4.0).abs() < 1e-15);
    assert_eq!(error.relative_rmse_less(4.0), 0.0);
    assert!((error.relative_bias() + 6.0 / 24.0).abs() < 1e-15);
    assert!((error.relative_maximum() - 1.0).abs() < 1e-15);
    assert!((error.negative_share() - 1.0 / 6.0).abs() < 1e-15);
}

#[test]
fn errors_are_relative_to_the_root_mean_square_and_bias_to_the_mean() {
    let mut error = IrradianceError::default();
    error.add(Vec3::new(1.0, 8.0, 0.0), DVec3::new(1.0, 7.0, 0.0));
    assert!((error.relative_rmse() - (1.0_f64 / 50.0).sqrt()).abs() < 1e-15);
    assert!((error.relative_bias() - 1.0 / 8.0).abs() < 1e-15);
    assert!((error.relative_maximum() - 3.0 / 8.0).abs() < 1e-15);
}

#[test]
fn equal_vectors_have_no_error_and_scaled_ones_their_scale() {
    let vectors = [[[[1.0, -2.0, 3.0]; 3]; 6]; 5];
    let scaled = vectors.map(|v| v.map(|h| h.map(|c| c.map(|x| x * 1.25))));
    assert_eq!(relative_rmse(&vectors, &vectors), 0.0);
    assert!((relative_rmse(&scaled, &vectors) - 0.25).abs() < 1e-12);
}

#[test]
fn one_wrong_component_is_seen_and_dark_grids_are_defined() {
    let exact = [[[[1.0; 3]; 3]; 6]; 2];
    let mut wrong = exact;
    wrong[1][5][2][2] = 2.0;
    assert!((relative_rmse(&wrong, &exact) - (1.0_f64 / 108.0).sqrt()).abs() < 1e-12);
    let dark = [[[[0.0; 3]; 3]; 6]; 2];
    assert_eq!(relative_rmse(&dark, &dark), 0.0);
    assert_eq!(relative_rmse(&exact, &dark), f64::INFINITY);
}

#[test]
#[should_panic(expected = "one approximate vertex for each exact one")]
fn different_lengths_are_a_mistake_of_the_caller() {
    let _ = relative_rmse(&[[[[0.0; 3]; 3]; 6]; 2], &[[[[0.0; 3]; 3]; 6]; 3]);
}
