//! The command line: names, defaults, units. Nothing here computes.

mod conformance;
mod grid;
mod mesh;
mod registry;
mod robustness;

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

pub(crate) use self::conformance::{ConformanceArguments, ConformanceCommand, RunArguments};
pub(crate) use self::grid::{
    BakeSettings, EffectsArgument, EstimatorArgument, FilterArgument, GridStorage, RecodeArguments,
    ReconstructionArgument, SampleArguments,
};
pub(crate) use self::mesh::{ExtractArguments, MeshArguments, SCENE_POSITIONS, StorageArguments};
pub(crate) use self::robustness::RobustnessArguments;
use crate::scene_args::{Bounds, GridSize, PictureSize, ScheduleArgument, ShardArgument};

/// Streams lit 3D scenes: bakes indirect light into an irradiance vector grid, orders meshes coarse-to-fine, serves both,
/// and renders what has arrived.
#[derive(Debug, Parser)]
#[command(name = "ivg", version, propagate_version = true, max_term_width = 110)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// The whole way in one command: bake, order, serve on loopback, stream, four pictures and a table.
    Demo(DemoArguments),
    /// Which light effects a scene calls for, which are left out, why, and what each costs.
    Plan(PlanArguments),
    /// Bake the indirect light of a scene into an irradiance vector grid (.ivg).
    Bake(BakeArguments),
    /// Add up the accumulator files of a bake that was divided: the same .ivg file, byte for byte, as if it had not been.
    Merge(MergeArguments),
    /// Geometric robustness: bake the same grid with fewer faces, and tell how far its light is off and what is saved.
    ///
    /// Every mesh is ordered once and taken at the level that all share by their error; faces that emit light stay whole.
    Robustness(RobustnessArguments),
    /// Order a mesh coarse-to-fine and write it as a progressive mesh (.pmesh).
    Mesh(MeshArguments),
    /// Write a scene directory that any HTTP server can stream: scene.glb, light.ivg, one .pmesh a mesh.
    Pack(PackArguments),
    /// Header and parts of an .ivg or .pmesh file.
    Info(FileArguments),
    /// Validate an .ivg or .pmesh file; the exit status is the verdict: 0 ok, 40 need-more, 41 invalid, 42 unsupported, 43 limit.
    Check(FileArguments),
    /// Write an .ivg file in another encoding or order.
    ///
    /// Most encodings lose something; what is lost is printed. No other encoding can be turned into sh2-28: bake with it.
    /// Recoding packs the light again, also into the encoding that it has: in packed-xyz24 and the pair encodings this can
    /// change the last bits.
    Recode(RecodeArguments),
    /// Irradiance at points with normals, from an .ivg file, as CSV.
    Sample(SampleArguments),
    /// What a client knows: a grid as .npy, a mesh at a level as .ply or .obj.
    Extract(ExtractArguments),
    /// Render a picture of a scene, a scene directory, or a URL.
    Render(RenderArguments),
    /// Serve a scene directory over HTTP/1.1 with ranges.
    Serve(ServeArguments),
    /// Stream a scene without showing it, and log what arrived when.
    Fetch(FetchArguments),
    /// Run the conformance suite of .ivg and .pmesh on any decoder.
    Conformance(ConformanceArguments),
}

/// A scene and what may be added to it.
#[derive(Debug, Args)]
pub(crate) struct SceneArguments {
    /// Scene file: .obj, .gltf, .glb or .ply, also .gz or .zst.
    pub(crate) scene: PathBuf,
    /// Adds lights, a camera and the unit of length to the scene (TOML; see ivg-scene/LIGHTS.md).
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) lights: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct DemoArguments {
    /// Scene to show instead of the embedded one.
    #[arg(long)]
    pub(crate) scene: Option<PathBuf>,
    /// Adds lights, a camera and the unit of length to the scene (TOML; see ivg-scene/LIGHTS.md).
    #[arg(long, value_name = "FILE.toml", requires = "scene")]
    pub(crate) lights: Option<PathBuf>,
    /// Folder for the pictures, demo.json and the scene directory; made if missing.
    #[arg(long, value_name = "DIR", default_value = "demo-out")]
    pub(crate) out: PathBuf,
    /// Which renderer draws the pictures.
    #[arg(long, value_enum, default_value_t = RendererArgument::Auto)]
    pub(crate) renderer: RendererArgument,
    /// Size of each picture, in pixels.
    #[arg(long, value_name = "WxH", default_value = "480x480")]
    pub(crate) size: PictureSize,
    /// Number of photons traced.
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = crate::scene_args::count::<u64>)]
    pub(crate) photons: u64,
    /// Number of grid vertices along x, y and z.
    #[arg(long, value_name = "NXxNYxNZ", default_value = "16x16x16")]
    pub(crate) grid: GridSize,
}

#[derive(Debug, Args)]
pub(crate) struct PlanArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Number of photons of the bake whose cost is estimated; the pilot traces 1 % of them.
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = crate::scene_args::count::<u64>)]
    pub(crate) photons: u64,
    /// Share of the light energy that may be left out by cutting bounces, in (0, 1) [default: 0.01].
    #[arg(long, value_name = "SHARE", value_parser = crate::scene_args::share, conflicts_with = "accuracy")]
    pub(crate) energy_cutoff: Option<f64>,
    /// Plan for ivg bake --accuracy: bounces are cut where what is left is a tenth of the error asked for.
    #[arg(long, value_name = "PERCENT", value_parser = crate::scene_args::percent)]
    pub(crate) accuracy: Option<f64>,
    /// Which light effects are planned.
    #[arg(long, value_enum, default_value_t = EffectsArgument::Needed)]
    pub(crate) effects: EffectsArgument,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct BakeArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Output file.
    #[arg(short, long, value_name = "FILE.ivg")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) bake: BakeSettings,
    /// Trace only part K of N of the photons, and write their sums for ivg merge: the output is an accumulator file (.acc). With the
    /// estimator track-length.
    #[arg(long, value_name = "K/N", conflicts_with_all = ["accuracy", "time", "checkpoint", "resume"])]
    pub(crate) shard: Option<ShardArgument>,
    /// Write the sums to this accumulator file every minute, and at the end. Not with --accuracy; with the estimator track-length.
    #[arg(long, value_name = "FILE.acc")]
    pub(crate) checkpoint: Option<PathBuf>,
    /// Go on from this accumulator file, up to --photons, with as many reflections as it has; the file may be that of --checkpoint.
    /// Not with --accuracy.
    #[arg(long, value_name = "FILE.acc")]
    pub(crate) resume: Option<PathBuf>,
    /// Print figures as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct MergeArguments {
    /// The accumulator files of all shards of a bake, in any order.
    #[arg(required = true, value_name = "FILE.acc")]
    pub(crate) files: Vec<PathBuf>,
    /// Output file.
    #[arg(short, long, value_name = "FILE.ivg")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) storage: GridStorage,
}

#[derive(Debug, Args)]
pub(crate) struct PackArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Scene directory to write.
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) bake: BakeSettings,
    #[command(flatten)]
    pub(crate) storage: StorageArguments,
    /// Vertices of each mesh in scene.glb, for viewers that know nothing of the streams.
    #[arg(long, value_name = "N", default_value_t = 500)]
    pub(crate) coarse_vertices: u32,
    /// Print figures as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct FileArguments {
    /// An .ivg or .pmesh file.
    pub(crate) file: PathBuf,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum RendererArgument {
    /// The GPU when there is one, else the CPU.
    Auto,
    /// Always the CPU.
    Cpu,
    /// The GPU, or an error.
    #[cfg(feature = "gpu")]
    Gpu,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum IndirectArgument {
    /// From the irradiance vector grid.
    Grid,
    /// Gathered at each pixel from surfaces lit by the grid: slower, its errors are blurred.
    Gather,
    /// Path traced: slowest, the reference.
    Path,
    /// No indirect light.
    None,
}

impl IndirectArgument {
    /// Whether the picture is made from an irradiance vector grid.
    pub(crate) fn needs_grid(self) -> bool {
        matches!(self, Self::Grid | Self::Gather)
    }
}

#[derive(Debug, Args)]
pub(crate) struct RenderArguments {
    /// A scene file, a scene directory (written by `ivg pack`), or the http:// address of one.
    pub(crate) source: String,
    /// Adds lights, a camera and the unit of length to a scene file.
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) lights: Option<PathBuf>,
    /// Output picture.
    #[arg(short, long, value_name = "FILE.png")]
    pub(crate) out: PathBuf,
    /// Which renderer draws.
    #[arg(long, value_enum, default_value_t = RendererArgument::Auto)]
    pub(crate) renderer: RendererArgument,
    /// Where indirect light comes from. A scene file is baked first unless --ivg names a grid.
    #[arg(long, value_enum, default_value_t = IndirectArgument::Grid)]
    pub(crate) indirect: IndirectArgument,
    /// Grid to use with a scene file.
    #[arg(long, value_name = "FILE.ivg")]
    pub(crate) ivg: Option<PathBuf>,
    /// Camera: eye and target in metres as X,Y,Z,X,Y,Z; default: the scene's, or one that frames it.
    #[arg(long, value_name = "EYE,TARGET", allow_hyphen_values = true)]
    pub(crate) camera: Option<Bounds>,
    /// Size of the picture, in pixels.
    #[arg(long, value_name = "WxH", default_value = "640x480")]
    pub(crate) size: PictureSize,
    /// Brightness: factor on radiance before the tone curve [default: from the picture; to compare pictures, give
    /// all the same].
    #[arg(long, value_name = "FACTOR", value_parser = crate::scene_args::positive)]
    pub(crate) exposure: Option<f32>,
    /// Packed scenes: take of each mesh the coarsest level that is off by at most so many pixels, by the errors stored in its
    /// file [default: the finest level].
    #[arg(long, value_name = "PIXELS", value_parser = crate::scene_args::positive)]
    pub(crate) pixel_error: Option<f32>,
    /// Samples a pixel where light is gathered or path traced.
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = crate::scene_args::count::<u32>)]
    pub(crate) samples: u32,
    #[command(flatten)]
    pub(crate) bake: BakeSettings,
}

#[derive(Debug, Args)]
pub(crate) struct ServeArguments {
    /// Scene directory.
    pub(crate) directory: PathBuf,
    /// Address and port to listen on; port 0 picks a free one.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8080")]
    pub(crate) listen: SocketAddr,
}

#[derive(Debug, Args)]
pub(crate) struct FetchArguments {
    /// Address of a scene directory, e.g. <http://127.0.0.1:8080/>.
    pub(crate) url: String,
    /// In which order geometry and light are asked for: alternate, geometry, light, or the share of light in (0, 1).
    #[arg(long, value_name = "SCHEDULE", default_value = "alternate")]
    pub(crate) schedule: ScheduleArgument,
    /// Stop when this share of the vertices of every mesh has arrived.
    #[arg(long, value_name = "SHARE", default_value_t = 1.0, value_parser = crate::scene_args::share_or_all)]
    pub(crate) geometry: f64,
    /// Stop when this share of the grid's vertices has arrived.
    #[arg(long, value_name = "SHARE", default_value_t = 1.0, value_parser = crate::scene_args::share_or_all)]
    pub(crate) light: f64,
    /// Print the log as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
