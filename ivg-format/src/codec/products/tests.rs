use super::*;

#[test]
fn a_zero_has_the_sign_of_the_product() {
    let chunk = Chunk::<1> { direction: [[-0.5], [0.5], [0.0]], colour: [[0.0]; 3] };
    let mut out = [[[1.0; 3]; 3]];
    chunk.multiply(&mut out);
    assert_eq!(out[0][0].map(f32::to_bits), [(-0.0f32).to_bits(), 0, 0], "IVG-PACK-05");
}
