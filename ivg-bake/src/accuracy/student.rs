//! Quantiles of Student's t.

/// Steps of bisection: a double has 53 bits.
const STEPS: u32 = 60;

/// Terms of the continued fraction; it converges in about the square root of the degrees of freedom.
const TERMS: u32 = 10_000;

/// The t that a variable of Student's distribution with `freedom` degrees of freedom (at least 1) exceeds with
/// probability `beyond`, in (0, ½].
pub(crate) fn quantile(beyond: f64, freedom: f64) -> f64 {
    // P(T > t) = ½ I(ν / (ν + t²); ν/2, ½): ascending in x, which lies in (0, 1).
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..STEPS {
        let x = 0.5 * (low + high);
        if 0.5 * incomplete_beta(x, 0.5 * freedom, 0.5) < beyond { low = x } else { high = x }
    }
    (freedom * (1.0 - low) / low.max(f64::MIN_POSITIVE)).sqrt()
}

/// The regularised incomplete beta function I(x; a, b), by Lentz's method for its continued fraction (NIST Digital Library of
/// Mathematical Functions, 8.17.22).
fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    // The fraction converges fast below the mean of the distribution; above, the other tail is taken.
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(1.0 - x, b, a);
    }
    const TINY: f64 = 1e-300;
    let front = libm::exp(
        libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b) + a * libm::log(x) + b * libm::log1p(-x),
    ) / a;
    let (mut fraction, mut c, mut d) = (1.0, 1.0, 0.0);
    for term in 0..TERMS {
        let m = f64::from(term / 2);
        let number = if term == 0 {
            1.0
        } else if term % 2 == 0 {
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m))
        } else {
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0))
        };
        d = 1.0 + number * d;
        d = 1.0 / if d.abs() < TINY { TINY } else { d };
        c = 1.0 + number / c;
        c = if c.abs() < TINY { TINY } else { c };
        fraction *= c * d;
        if (1.0 - c * d).abs() < 1e-15 {
            break;
        }
    }
    front * (fraction - 1.0)
}

#[cfg(test)]
mod tests {
    use super::quantile;

    /// Values of printed tables.
    #[test]
    fn quantiles_are_those_of_tables() {
        for (beyond, freedom, expected) in [
            (0.05, 1.0, 6.313_751_5),
            (0.025, 2.0, 4.302_652_7),
            (0.05, 15.0, 1.753_050_4),
            (0.025, 15.0, 2.131_449_5),
            (0.005, 31.0, 2.744_041_9),
            (0.025, 63.0, 1.998_340_5),
            (0.05, 1e6, 1.644_855_2),
        ] {
            let t = quantile(beyond, freedom);
            assert!((t - expected).abs() < 1e-6 * expected, "{beyond} {freedom}: {t}");
        }
        assert!(quantile(0.5, 7.0).abs() < 1e-6);
    }
}
