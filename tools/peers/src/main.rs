//! Measures one thing and prints it as JSON; `peers.py` calls it for every mesh and makes the tables.

mod codec;
mod draw;
mod levels;
mod mesh;
mod same;
mod simplify;
mod stream;
mod timing;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr;

use clap::{Args, Parser, Subcommand};
use serde_json::{Value, json};

use crate::mesh::Mesh;

/// Any error; its text says what and where.
type Failure = Box<dyn std::error::Error>;

/// Measures one thing and prints it as JSON. Meshes are .ply files as peers.py writes them.
#[derive(Debug, Parser)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Vertices, faces, bounds and plain bytes of a mesh.
    Mesh {
        /// The mesh.
        mesh: PathBuf,
    },
    /// Bytes and decoding time by meshoptimizer (strip order) and zstd -19.
    Codec {
        /// The mesh.
        mesh: PathBuf,
        /// Bits of positions along the longest side, at most 16; 0 keeps them as floats.
        #[arg(long, value_parser = clap::value_parser!(u32).range(0..=16))]
        bits: u32,
        /// How often it is decoded; the time is the median.
        #[arg(long, default_value_t = 9)]
        runs: usize,
    },
    /// Simplify with meshoptimizer.
    Simplify {
        /// The mesh.
        mesh: PathBuf,
        /// Faces to reach.
        #[arg(long)]
        faces: usize,
        /// Which function.
        #[arg(long, value_enum, default_value = "default")]
        method: simplify::Method,
        /// The simplified mesh.
        #[arg(short, long)]
        out: PathBuf,
    },
    /// Bytes of a progressive mesh, of its first hundredth, and decoding time.
    Stream {
        /// The .pmesh file.
        file: PathBuf,
        /// How often it is decoded; the time is the median.
        #[arg(long, default_value_t = 9)]
        runs: usize,
    },
    /// Compare the triangles of two meshes by the places of their corners.
    Same {
        /// The original.
        mesh: PathBuf,
        /// What became of it.
        other: PathBuf,
        /// Bits of the lattice along the longest side, at most 16; 0 for positions as they are.
        #[arg(long, value_parser = clap::value_parser!(u32).range(0..=16))]
        bits: u32,
    },
    /// The finest level of a progressive mesh with at most so many faces.
    Level {
        /// The .pmesh file.
        file: PathBuf,
        /// The most faces; may be repeated.
        #[arg(long, required = true)]
        faces: Vec<u32>,
    },
    /// Check random levels of a progressive mesh.
    Levels(LevelsArguments),
    /// Draw a mesh with flat faces, as .ppm.
    Draw(DrawArguments),
}

#[derive(Debug, Args)]
struct LevelsArguments {
    /// The .pmesh file.
    file: PathBuf,
    /// How many levels.
    #[arg(long, default_value_t = 200)]
    count: u32,
    /// Seed of the random numbers.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Gets level, centre and normal of some faces, as seven 32-bit floats each.
    #[arg(short, long)]
    out: PathBuf,
}

#[derive(Debug, Args)]
struct DrawArguments {
    /// The mesh.
    mesh: PathBuf,
    /// Turn about the vertical axis \[degrees\].
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    turn: f32,
    /// Tilt towards the viewer \[degrees\].
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    tilt: f32,
    /// Centre of the picture: X,Y,Z in the mesh's units.
    #[arg(long, value_parser = numbers::<f32, 3>, allow_hyphen_values = true)]
    centre: [f32; 3],
    /// Half of the picture's smaller side, in the mesh's units.
    #[arg(long)]
    radius: f32,
    /// Pixels: width,height.
    #[arg(long, value_parser = numbers::<usize, 2>, default_value = "900,700")]
    size: [usize; 2],
    /// The picture.
    #[arg(short, long)]
    out: PathBuf,
}

fn main() -> ExitCode {
    match run(CommandLine::parse().command) {
        Ok(value) => {
            println!("{value}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("peers: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(command: Command) -> Result<Value, Failure> {
    match command {
        Command::Mesh { mesh } => {
            let mesh = Mesh::read(&mesh)?;
            Ok(json!({
                "vertices": mesh.positions.len(), "faces": mesh.faces(),
                "bounds": mesh.bounds(), "plain_bytes": mesh.plain_bytes(),
            }))
        }
        Command::Codec { mesh, bits, runs } => codec::measure(&Mesh::read(&mesh)?, bits, runs),
        Command::Simplify { mesh, faces, method, out } => {
            simplify::run(&Mesh::read(&mesh)?, faces, method, &out)
        }
        Command::Same { mesh, other, bits } => {
            Ok(same::compare(&Mesh::read(&mesh)?, &Mesh::read(&other)?, bits))
        }
        Command::Stream { file, runs } => stream::measure(&file, &bytes_of(&file)?, runs),
        Command::Level { file, faces } => {
            let mut replay = stream::load(&file, &bytes_of(&file)?)?;
            faces.iter().map(|&faces| stream::level_of_faces(&mut replay, faces)).collect()
        }
        Command::Levels(options) => {
            let mut replay = stream::load(&options.file, &bytes_of(&options.file)?)?;
            let choice = levels::Choice { count: options.count, seed: options.seed };
            levels::check(&mut replay, choice, &options.out)
        }
        Command::Draw(options) => {
            let DrawArguments { mesh, turn, tilt, centre, radius, size: [width, height], out } = options;
            let view = draw::View { turn, tilt, centre, radius, width, height };
            draw::run(&Mesh::read(&mesh)?, view, &out)?;
            Ok(json!({ "file": out }))
        }
    }
}

/// Numbers separated by commas.
fn numbers<T: FromStr, const N: usize>(text: &str) -> Result<[T; N], String> {
    let numbers =
        text.split(',').map(|part| part.trim().parse().map_err(|_| format!("{part:?} is no number")));
    let numbers: Vec<T> = numbers.collect::<Result<_, _>>()?;
    <[T; N]>::try_from(numbers).map_err(|numbers| format!("{} numbers instead of {N}", numbers.len()))
}

fn bytes_of(path: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()).into())
}
