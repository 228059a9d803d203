//! The mathematics on a dense irradiance vector grid: reconstruction, interpolation, push-pull, metrics.
