use super::*;

const DRAWS: u32 = 40_000;

fn tilted(cos: f32) -> Vec3 {
    Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos)
}

/// The share sent away after one reflection: drawn, and integrated over directions from the formula. Both have a standard
/// deviation of at most 1/2 a draw (a probability) and, for even directions weighted by π f / cos, of a few times the mean.
#[test]
fn what_is_drawn_has_the_density_of_the_formula() {
    let stream = Stream::new(5, 1);
    for alpha in [0.2f32, 0.5, 1.0] {
        let facets = Facets::new(alpha);
        for cos in [0.95f32, 0.6, 0.2] {
            let towards = tilted(cos);
            let (mut drawn, mut integral, mut squares) = ([0.0f64; 2], [0.0f64; 2], [0.0f64; 2]);
            for n in 0..DRAWS {
                let [u, v, x, y] = stream.uniforms(n, Purpose::Gather);
                // The share, and its moment along the surface.
                if let Some((other, _, away)) = facets.draw(towards, Vec2::new(u, v)) {
                    drawn[0] += f64::from(away);
                    drawn[1] += f64::from(away * other.x);
                }
                let from = hemisphere::cosine(Vec3::Z, [x, y]);
                let value = f64::from(facets.evaluate(Vec3::Z, from, towards).0 * PI / from.z);
                for (k, value) in [value, value * f64::from(from.x)].into_iter().enumerate() {
                    integral[k] += value;
                    squares[k] += value * value;
                }
            }
            for k in 0..2 {
                let n = f64::from(DRAWS);
                let (drawn, integral) = (drawn[k] / n, integral[k] / n);
                let sigma = ((squares[k] / n + 1.0) / n).sqrt();
                assert!(
                    (drawn - integral).abs() < 5.0 * sigma,
                    "alpha {alpha}, cos {cos}, moment {k}: {drawn} {integral} ± {sigma}"
                );
                assert!(sigma < 0.06, "not sharp: {sigma}");
            }
        }
    }
}

/// Light reflected once or again, from even light: as much from every direction, for even light is what a rough mirror that
/// absorbs nothing must leave as it is. Arriving cosine-distributed, it leaves cosine-distributed: mean cosine 2/3, of
/// variance 1/18; five standard deviations.
#[test]
fn even_light_stays_even() {
    for alpha in [0.1f32, 0.4, 1.0] {
        let facets = Facets::new(alpha);
        let mut moments = [0.0f64; 2];
        for n in 0..DRAWS {
            let stream = Stream::new(7, u64::from(n));
            let [u, v, x, y] = stream.uniforms(0, Purpose::Gather);
            let from = hemisphere::cosine(Vec3::Z, [u, v]);
            let [choice, ..] = stream.uniforms(1, Purpose::Gather);
            let out = match facets.reflect(from, Vec3::Z, Vec2::new(x, y), choice) {
                Some((out, _)) => out,
                None => facets.reflect_again(Vec3::Z, &stream, 0),
            };
            moments[0] += f64::from(out.z) / f64::from(DRAWS);
            moments[1] += f64::from(out.z * out.z) / f64::from(DRAWS);
        }
        let sigma = (1.0 / 18.0 / f64::from(DRAWS)).sqrt();
        assert!((moments[0] - 2.0 / 3.0).abs() < 5.0 * sigma, "alpha {alpha}: {moments:?}");
        // cos² is uniform in [0, 1]: mean 1/2, variance 1/12.
        let sigma = (1.0 / 12.0 / f64::from(DRAWS)).sqrt();
        assert!((moments[1] - 0.5).abs() < 5.0 * sigma, "alpha {alpha}: {moments:?}");
    }
}

/// The sampled density of directions reflected again has the mean 1 over cosine-distributed directions.
#[test]
fn the_density_of_light_reflected_again_is_one_on_average() {
    for alpha in [0.3f32, 1.0] {
        let facets = Facets::new(alpha);
        let mut mean = 0.0;
        for n in 0..DRAWS {
            let stream = Stream::new(9, u64::from(n));
            let [u, v, ..] = stream.uniforms(0, Purpose::Gather);
            let from = hemisphere::cosine(Vec3::Z, [u, v]);
            mean += f64::from(facets.share_again(Vec3::Z, from, &stream, 3)) / f64::from(DRAWS);
        }
        // A share p of the draws counts 1/p: standard deviation 1/√(p N); and p itself is found from 16,384 draws.
        let p = f64::from(facets.again);
        let sigma = (1.0 / (p * f64::from(DRAWS)) + 1.0 / (p * f64::from(MEAN_DRAWS))).sqrt();
        assert!((mean - 1.0).abs() < 5.0 * sigma && sigma < 0.1, "alpha {alpha}: {mean} ± {sigma}");
    }
}

#[test]
fn a_narrow_lobe_is_a_mirror() {
    let facets = Facets::new(1e-3);
    let towards = tilted(0.8);
    let (other, cos) =
        facets.reflect(towards, Vec3::Z, Vec2::new(0.3, 0.6), 0.5).expect("nothing in the way");
    assert!((other - Vec3::new(-towards.x, 0.0, towards.z)).length() < 5e-3 && (cos - 0.8).abs() < 5e-3);
    assert!(facets.again < 1e-4);
}
