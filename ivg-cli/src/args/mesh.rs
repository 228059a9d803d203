//! Arguments of the commands that write and read progressive meshes.

use std::path::PathBuf;

use clap::Args;
use pmesh_build::Cost;
use pmesh_format::{EncodeOptions, Mode, PacketSize, Positions};

use super::registry;
use crate::failure::Failure;

#[derive(Debug, Args)]
pub(crate) struct MeshArguments {
    /// Mesh file: .obj, .gltf, .glb or .ply, also .gz or .zst. All its meshes are joined into one.
    pub(crate) mesh: PathBuf,
    /// Output file.
    #[arg(short, long, value_name = "FILE.pmesh")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) storage: StorageArguments,
    /// The cost that orders the collapses.
    #[arg(long, default_value = "quadric", value_parser = registry::cost())]
    pub(crate) cost: Cost,
    /// How many metres of distance a unit of deviation of a normal is worth in the quadric cost and in the stored errors; 0
    /// orders by the surface alone.
    #[arg(long, value_name = "METRES", default_value_t = 0.0, value_parser = crate::scene_args::weight)]
    pub(crate) normal_weight: f64,
    /// The same for a texture coordinate, whose unit is the width of the image.
    #[arg(long, value_name = "METRES", default_value_t = 0.0, value_parser = crate::scene_args::weight)]
    pub(crate) uv_weight: f64,
    /// Vertices a packet, the same in each.
    #[arg(long, value_name = "N", value_parser = crate::scene_args::count::<u32>, conflicts_with = "growth")]
    pub(crate) packet: Option<u32>,
    /// Vertices a packet as a share of those before it, in percent, from the first hundredth of all on [default: 30].
    #[arg(long, value_name = "PERCENT", value_parser = crate::scene_args::count::<u32>)]
    pub(crate) growth: Option<u32>,
    /// Print figures as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// How progressive meshes are stored.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct StorageArguments {
    /// How positions are stored; with qN each coordinate is off by at most half a step, of which there are 2^N - 1 along the
    /// longest side of the mesh [default: q14 for a mesh, q16 in a scene].
    #[arg(long, value_parser = registry::positions())]
    pub(crate) positions: Option<Positions>,
    /// How packets are stored; coded mode rounds normals and texture coordinates, raw mode with f32 positions rounds nothing.
    #[arg(long, default_value = Mode::Coded.name(), value_parser = registry::mode())]
    pub(crate) mode: Mode,
    /// Bits of each of the two components of a normal, 4 to 16; coded mode only, raw mode stores them exactly [default: 10].
    #[arg(long, value_name = "BITS", value_parser = clap::value_parser!(u8).range(4..=16))]
    pub(crate) normal_bits: Option<u8>,
    /// Bits of each texture coordinate along the longer side of the box of all, 4 to 16; coded mode only, raw mode stores them
    /// exactly [default: 12].
    #[arg(long, value_name = "BITS", value_parser = clap::value_parser!(u8).range(4..=16))]
    pub(crate) uv_bits: Option<u8>,
}

/// Positions of a mesh unless others are asked for: half a step is 0.003 % of the longest side.
pub(crate) const MESH_POSITIONS: Positions = Positions::Quantised(14);

/// Positions of the meshes of a scene unless others are asked for: half a step is 0.0008 % of the longest side, less than a
/// pixel of a picture 65,000 pixels wide.
pub(crate) const SCENE_POSITIONS: Positions = Positions::Quantised(16);

impl StorageArguments {
    /// Nothing asked for.
    pub(crate) const DEFAULT: Self =
        Self { positions: None, mode: Mode::Coded, normal_bits: None, uv_bits: None };

    /// The encoder's options, `default` being how positions are stored unless the arguments say it.
    ///
    /// # Errors
    ///
    /// A usage error if bits are asked for that the mode does not have.
    pub(crate) fn options(&self, default: Positions) -> Result<EncodeOptions, Failure> {
        let Self { positions, mode, normal_bits, uv_bits } = *self;
        for (bits, name) in [(normal_bits, "--normal-bits"), (uv_bits, "--uv-bits")] {
            if bits.is_some() && mode != Mode::Coded {
                let what = format!("{name} is for --mode coded; raw mode stores these attributes exactly");
                return Err(Failure::usage(what));
            }
        }
        let options = EncodeOptions::default();
        Ok(EncodeOptions {
            positions: positions.unwrap_or(default),
            mode,
            normal_bits: normal_bits.unwrap_or(options.normal_bits),
            uv_bits: uv_bits.unwrap_or(options.uv_bits),
            ..options
        })
    }
}

impl MeshArguments {
    /// The encoder's options.
    ///
    /// # Errors
    ///
    /// As [`StorageArguments::options`].
    pub(crate) fn options(&self) -> Result<EncodeOptions, Failure> {
        let options = self.storage.options(MESH_POSITIONS)?;
        let packets = match (self.packet, self.growth, options.packets) {
            (Some(vertices), ..) => PacketSize::Fixed(vertices),
            (None, Some(percent), PacketSize::Growing { first, most, .. }) => {
                PacketSize::Growing { first, percent, most }
            }
            (None, _, packets) => packets,
        };
        Ok(EncodeOptions { packets, ..options })
    }
}

#[derive(Debug, Args)]
pub(crate) struct ExtractArguments {
    /// An .ivg or .pmesh file.
    pub(crate) file: PathBuf,
    /// Output. For a grid .npy: f32 of shape (nz, ny, nx, 6 hemispheres +x -x +y -y +z -z, 3 colours, 3 components), W/m²;
    /// if it stores radiance harmonics (nz, ny, nx, 3 colours, 9 coefficients), W/(m² sr). For a mesh .obj, whose faces have
    /// numbers of their own for normals and texture coordinates, or .ply, which has no such numbers: there a vertex on a seam
    /// is written once for each of its values.
    #[arg(short, long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// Use the first N bytes of the file only: what a client knows then.
    #[arg(long, value_name = "N")]
    pub(crate) bytes: Option<u64>,
    /// Number of vertices of the mesh [default: as many as there are]. Any number from that of the coarsest level on; inside a
    /// packet of a coded file (`ivg info` lists where packets end) a level is a valid mesh, but finer in one place than in
    /// another, and two of its faces may lie on the same vertices. Raw files are even at every level.
    #[arg(long, value_name = "N", group = "chosen_level")]
    pub(crate) level: Option<u32>,
    /// The coarsest level whose stored error is at most so many metres.
    #[arg(long, value_name = "METRES", group = "chosen_level", value_parser = crate::scene_args::positive)]
    pub(crate) error: Option<f32>,
    /// The finest level of at most so many faces.
    #[arg(long, value_name = "N", group = "chosen_level", value_parser = crate::scene_args::count::<u32>)]
    pub(crate) faces: Option<u32>,
    /// Fill missing and invalid vertices of a grid by push-pull instead of leaving them NaN.
    #[arg(long)]
    pub(crate) fill: bool,
}
