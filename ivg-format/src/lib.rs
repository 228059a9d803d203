//! The .ivg format: irradiance vector grids as bundles that can be streamed in any order.
