//! Arguments of the command that compares light baked with fewer faces.

use std::str::FromStr;

use clap::Args;

use super::SceneArguments;
use crate::scene_args::{Bounds, GridSize, count};

#[derive(Debug, Args)]
pub(crate) struct RobustnessArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Shares of the faces to bake with beside all of them.
    #[arg(long, value_name = "PERCENT,...", value_delimiter = ',', default_value = "10%,1%")]
    pub(crate) faces: Vec<FaceShare>,
    /// Number of grid vertices along x, y and z.
    #[arg(long, value_name = "NXxNYxNZ", default_value = "16x16x16")]
    pub(crate) grid: GridSize,
    /// First and last vertex of the grid, in metres; default: the scene's bounds and a margin, with all faces.
    #[arg(long, value_name = "X0,Y0,Z0,X1,Y1,Z1", allow_hyphen_values = true)]
    pub(crate) bounds: Option<Bounds>,
    /// Number of photons of each bake.
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = count::<u64>)]
    pub(crate) photons: u64,
    /// Bakes of each geometry, at least 2: how they differ among each other is noise, which is taken off the error.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u16).range(2..=64))]
    pub(crate) bakes: u16,
    /// Seed of the first bake of each geometry; the others count on from it.
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Number of threads [default: one a core]; the light does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// A share of the faces of a scene, in (0, 1\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FaceShare(pub(crate) f64);

impl FromStr for FaceShare {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = text.strip_suffix('%').and_then(|number| number.trim().parse::<f64>().ok());
        match number {
            Some(value) if value > 0.0 && value <= 100.0 => Ok(Self(value / 100.0)),
            _ => Err(format!(
                "'{text}' is not a share of the faces; give more than 0% up to 100%, such as 10%"
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::FaceShare;

    #[test]
    fn shares_are_per_cent_above_zero() {
        assert_eq!("100%".parse(), Ok(FaceShare(1.0)));
        assert_eq!("0.5 %".parse(), Ok(FaceShare(0.005)));
        for wrong in ["", "1", "0%", "101%", "nan%", "-1%"] {
            assert!(wrong.parse::<FaceShare>().is_err(), "{wrong}");
        }
    }
}
