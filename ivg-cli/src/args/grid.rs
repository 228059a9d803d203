//! Arguments of the commands that make and read grids.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use ivg_format::{Encoding, Order};

use super::registry;
use crate::scene_args::{Bounds, GridArgument};

/// How a grid is baked.
#[derive(Debug, Args)]
pub(crate) struct BakeSettings {
    /// Number of grid vertices along x, y and z; auto: as the scene asks for: from an eighth of the distance that light flies
    /// between surfaces, finer or coarser along each axis so that light changes by 7 % a step, with at most 262144 vertices,
    /// those that --budget leaves room for, and those that the photons of --time bring enough light to. The reason is printed.
    #[arg(long, value_name = "NXxNYxNZ", default_value = "16x16x16")]
    pub(crate) grid: GridArgument,
    /// With --grid auto: the most bytes that the file may have, such as 500kB or 2MB.
    #[arg(long, value_name = "BYTES", value_parser = crate::scene_args::bytes)]
    pub(crate) budget: Option<u64>,
    /// First and last vertex of the grid, in metres; default: the scene's bounds and a margin.
    #[arg(long, value_name = "X0,Y0,Z0,X1,Y1,Z1", allow_hyphen_values = true)]
    pub(crate) bounds: Option<Bounds>,
    /// Number of photons traced [default: 1000000]; with --accuracy or --time, the most [default: as many as it takes].
    #[arg(long, value_name = "N", value_parser = crate::scene_args::count::<u64>)]
    pub(crate) photons: Option<u64>,
    /// Trace until the error of the grid is at most so much, such as 2% (root mean square of the irradiance along the axes,
    /// relative, noise and bias together, with 95 % confidence), and say what was reached. Light is followed until what is cut is
    /// a tenth of that; without, until it is a hundredth of the light.
    #[arg(long, value_name = "PERCENT", value_parser = crate::scene_args::percent)]
    pub(crate) accuracy: Option<f64>,
    /// End early after so many seconds. The result then depends on how fast the machine is; the photons traced are printed
    /// and stored in the file.
    #[arg(long, value_name = "SECONDS", value_parser = crate::scene_args::seconds)]
    pub(crate) time: Option<f64>,
    /// How light becomes what the grid holds; sh2-28 needs track-length or gather.
    #[arg(long, value_enum, default_value_t = EstimatorArgument::TrackLength)]
    pub(crate) estimator: EstimatorArgument,
    /// Paths of each vertex for --estimator gather [default: 4096]; with --accuracy, the most [default: as many as it takes].
    #[arg(long, value_name = "N", value_parser = crate::scene_args::count::<u32>)]
    pub(crate) paths: Option<u32>,
    /// How the file stores a vertex.
    #[arg(long, value_parser = registry::encoding(), default_value = "packed-oct24")]
    pub(crate) encoding: Encoding,
    /// In which order the file brings the vertices.
    #[arg(long, value_parser = registry::order(), default_value = "slices")]
    pub(crate) order: Order,
    /// Which light effects are simulated.
    #[arg(long, value_enum, default_value_t = EffectsArgument::Needed)]
    pub(crate) effects: EffectsArgument,
    /// Seed of the random numbers: the same seed gives the same bytes.
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Number of threads [default: one a core]; the result does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Vertices of each slice across the longest axis that one bundle brings; bundles of octree have S × (vertices
    /// along the longest axis), those of explicit at most so many.
    #[arg(long, value_name = "S", default_value_t = 64, value_parser = crate::scene_args::count::<u32>)]
    pub(crate) per_slice: u32,
}

/// How a grid made of accumulators is stored; give what the undivided bake would be given.
#[derive(Debug, Args)]
pub(crate) struct GridStorage {
    /// How the file stores a vertex [default: packed-oct24, or sh2-28 if the shards were baked for it].
    #[arg(long, value_parser = registry::encoding())]
    pub(crate) encoding: Option<Encoding>,
    /// In which order the file brings the vertices.
    #[arg(long, value_parser = registry::order(), default_value = "slices")]
    pub(crate) order: Order,
    /// Vertices of each slice across the longest axis that one bundle brings; bundles of octree have S × (vertices
    /// along the longest axis), those of explicit at most so many.
    #[arg(long, value_name = "S", default_value_t = 64, value_parser = crate::scene_args::count::<u32>)]
    pub(crate) per_slice: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum EffectsArgument {
    /// Those that the scene calls for.
    Needed,
    /// All there are, with light followed as far as it is followed at all: to see what leaving some out saves.
    All,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum EstimatorArgument {
    /// Flight length in the dual cell of a vertex: unbiased, least noise.
    TrackLength,
    /// Crossings of dual faces, divided by the cosine: unbiased, noisy at grazing angles.
    FaceCrossing,
    /// Crossings as RR-6983 prints them: biased by -1/3 in uniform light, for comparison.
    #[value(name = "face-crossing-rr6983")]
    FaceCrossingRr6983,
    /// Every vertex path traced: unbiased and slow, no photons.
    Gather,
}

impl From<EstimatorArgument> for ivg_bake::Estimator {
    fn from(argument: EstimatorArgument) -> Self {
        match argument {
            EstimatorArgument::TrackLength => Self::TrackLength,
            EstimatorArgument::FaceCrossing => Self::FaceCrossing,
            EstimatorArgument::FaceCrossingRr6983 => Self::FaceCrossingRr6983,
            EstimatorArgument::Gather => Self::Gather,
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct RecodeArguments {
    /// The .ivg file to read, of any encoding and order.
    pub(crate) file: PathBuf,
    /// Output file; may be the file itself.
    #[arg(short, long, value_name = "FILE.ivg")]
    pub(crate) out: PathBuf,
    /// How the output stores a vertex [default: as the input].
    #[arg(long, value_parser = registry::encoding())]
    pub(crate) encoding: Option<Encoding>,
    /// In which order the output brings the vertices [default: as the input].
    #[arg(long, value_parser = registry::order())]
    pub(crate) order: Option<Order>,
    /// Vertices of each slice across the longest axis that one bundle brings; bundles of octree have S × (vertices
    /// along the longest axis), those of explicit at most so many [default: as in the input].
    #[arg(long, value_name = "S", value_parser = crate::scene_args::count::<u32>)]
    pub(crate) per_slice: Option<u32>,
    /// Seed of the order [default: as in the input].
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Print figures as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct SampleArguments {
    /// An .ivg file of any encoding.
    pub(crate) file: PathBuf,
    /// CSV file whose header names the columns x,y,z (positions in metres) and nx,ny,nz (normals, of any length) in any
    /// order; further columns are kept. - reads stdin.
    #[arg(long, value_name = "POINTS.csv", alias = "at")]
    pub(crate) points: PathBuf,
    /// Output: the same rows and the columns r,g,b, irradiance in W/m² [default: stdout].
    #[arg(short, long, value_name = "FILE.csv")]
    pub(crate) out: Option<PathBuf>,
    /// How irradiance for a normal is made from what the file stores.
    #[arg(long, value_enum, default_value_t = ReconstructionArgument::Auto)]
    pub(crate) reconstruction: ReconstructionArgument,
    /// How values between grid vertices are made.
    #[arg(long, value_enum, default_value_t = FilterArgument::Trilinear)]
    pub(crate) filter: FilterArgument,
    /// First give a value to vertices inside geometry and to those a truncated file lacks (push-pull, as clients do).
    /// Without it, points near only such vertices are 0.
    #[arg(long)]
    pub(crate) fill: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ReconstructionArgument {
    /// The papers' blend by squared normal components.
    N2,
    /// Three irradiance vectors, corrected: exact on the axes and in uniform light.
    Three,
    /// All six irradiance vectors.
    Six,
    /// Spherical harmonics.
    Sh2,
    /// The most accurate one for the encoding: `six` for vectors-f32, `sh2` for sh2-28, `three` for all others.
    Auto,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FilterArgument {
    /// Linear along each axis.
    Trilinear,
    /// Cubic B-spline: smoother, and smooths.
    Tricubic,
}
