use std::process::ExitCode;

use ivg_format::{Quantity, Values};
use ivg_grid::{FillOptions, IrradianceGrid};
use ivg_scene::export;
use pmesh_format::{Header, IndexedMesh, Replay, Wedges};

use crate::args::ExtractArguments;
use crate::failure::Failure;
use crate::kind::FileKind;
use crate::{files, npy, reading};

pub(crate) fn run(arguments: &ExtractArguments) -> Result<ExitCode, Failure> {
    let mut bytes = files::read(&arguments.file)?;
    let kind = FileKind::of(&arguments.file, &bytes);
    if let Some(limit) = arguments.bytes {
        bytes.truncate(usize::try_from(limit).unwrap_or(usize::MAX));
    }
    match kind {
        FileKind::Grid => grid(arguments, &bytes),
        FileKind::Mesh => mesh(arguments, &bytes),
    }
}

fn grid(arguments: &ExtractArguments, bytes: &[u8]) -> Result<ExitCode, Failure> {
    if arguments.level.is_some() || arguments.error.is_some() || arguments.faces.is_some() {
        return Err(Failure::usage(
            "--level, --error and --faces are for .pmesh files; a grid is cut with --bytes",
        ));
    }
    files::require_extension(&arguments.out, &["npy"])?;
    let (header, mut grid, used) = reading::grid(&arguments.file, bytes)?;
    let known = grid.received_count();
    if arguments.fill {
        grid = ivg_grid::fill(&grid, &FillOptions::default());
    }
    let [nx, ny, nz] = header.lattice.dims.map(usize::from);
    let mut shape = vec![nz, ny, nx];
    shape.extend_from_slice(match grid.quantity() {
        Quantity::Vectors => &[6, 3, 3],
        Quantity::Radiance => &[3, 9],
    });
    let numbers = Numbers { grid: &grid, keep_all: arguments.fill, next: 0 };
    let array = npy::encode(&shape, numbers).map_err(|error| Failure::file(&arguments.out, error))?;
    files::write(&arguments.out, &array)?;
    let invalid = grid.vertex_count() - grid.valid_count();
    let gaps = match (arguments.fill, known) {
        (false, _) => "gaps are NaN",
        (true, 0) => "nothing has arrived: all values are 0",
        (true, _) => "gaps are filled",
    };
    files::print(&format!(
        "{}: {} f32, {known} of {} vertices received, {invalid} invalid; {gaps}; {used} bytes used\n",
        arguments.out.display(),
        shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(" x "),
        grid.vertex_count(),
    ))?;
    Ok(ExitCode::SUCCESS)
}

/// All numbers of a grid in file order: NaN for vertices that have not arrived or that light does not reach.
struct Numbers<'a> {
    grid: &'a IrradianceGrid,
    keep_all: bool,
    next: usize,
}

impl Numbers<'_> {
    fn per_vertex(&self) -> usize {
        match self.grid.quantity() {
            Quantity::Vectors => 54,
            Quantity::Radiance => 27,
        }
    }
}

impl Iterator for Numbers<'_> {
    type Item = f32;

    fn next(&mut self) -> Option<f32> {
        let (vertex, number) = (self.next / self.per_vertex(), self.next % self.per_vertex());
        let value = match self.grid.values() {
            Values::Vectors(vectors) => vectors.get(vertex)?.as_flattened().as_flattened()[number],
            Values::Radiance(radiance) => radiance.get(vertex)?.as_flattened()[number],
        };
        self.next += 1;
        let known = self.keep_all || (self.grid.is_received(vertex) && self.grid.is_valid(vertex));
        Some(if known { value } else { f32::NAN })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = self.grid.vertex_count() * self.per_vertex() - self.next;
        (left, Some(left))
    }
}

impl ExactSizeIterator for Numbers<'_> {}

fn mesh(arguments: &ExtractArguments, bytes: &[u8]) -> Result<ExitCode, Failure> {
    if arguments.fill {
        return Err(Failure::usage("--fill is for .ivg files"));
    }
    let extension = files::require_extension(&arguments.out, &["ply", "obj"])?;
    let (mut replay, used) = reading::mesh(&arguments.file, bytes)?;
    let (Some(range), finest) = (replay.levels(), replay.header().vertex_count) else {
        return Err(Failure::file(
            &arguments.file,
            "the first packet has not arrived whole; there is no level yet",
        ));
    };
    let level = wanted_level(arguments, &replay).unwrap_or(*range.end());
    if !range.contains(&level) {
        let what = format!("level {level} is not there: {} to {} are", range.start(), range.end());
        return Err(Failure::file(&arguments.file, what));
    }
    replay.set_level(level).map_err(|error| Failure::file(&arguments.file, error))?;
    // A stored error names levels one split behind the end of a packet: nothing to speak of.
    if arguments.error.is_none() && !replay.header().is_whole_level(level) {
        eprintln!("ivg: note: {}", inside_a_packet(replay.header(), level));
    }
    let mesh = replay.mesh();
    let name =
        arguments.file.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let out = ivg_stream::scene_mesh(&mesh, name, u32::from);
    let mut bytes = Vec::new();
    let written = match extension {
        "ply" => export::write_ply(&out, &mut bytes),
        _ => export::write_obj_joined(&out, &mesh.wedges.vertices, &mut bytes),
    };
    written.map_err(|error| Failure::file(&arguments.out, error))?;
    files::write(&arguments.out, &bytes)?;
    if extension == "obj" {
        let lost = colours_lost(&mesh);
        if !lost.is_empty() {
            eprintln!("ivg: note: {}: {lost}; .ply holds them", arguments.out.display());
        }
    }
    if extension == "ply" && mesh.wedges.len() > mesh.positions.len() {
        eprintln!(
            "ivg: note: {}: {} of the {} vertices lie on seams twice or more often and are written once for each of their \
             attributes; .obj has them once",
            arguments.out.display(),
            on_seams(&mesh),
            mesh.positions.len(),
        );
    }
    files::print(&format!(
        "{}: level {level} of {finest}: {} vertices, {} faces, estimated error at most {} m; {used} bytes used\n",
        arguments.out.display(),
        mesh.positions.len(),
        mesh.triangles.len(),
        replay.error(),
    ))?;
    Ok(ExitCode::SUCCESS)
}

/// The level that the arguments ask for, in whichever way.
fn wanted_level(arguments: &ExtractArguments, replay: &Replay) -> Option<u32> {
    let by_error = || arguments.error.and_then(|error| replay.level_of_error(error));
    let by_faces = || arguments.faces.and_then(|faces| replay.level_of_faces(faces));
    arguments.level.or_else(by_error).or_else(by_faces)
}

/// What a level inside a coded packet lacks (PMESH-LVL-06), for people, and which levels near it lack nothing.
fn inside_a_packet(header: &Header, level: u32) -> String {
    let ends = || header.packets.iter().map(|entry| entry.vertices.end).chain([header.base_vertices]);
    let below = ends().filter(|&end| end < level).max().unwrap_or_default();
    let above = ends().filter(|&end| end > level).min().unwrap_or_default();
    format!(
        "level {level} lies inside a coded packet: it is finer in one place than in another, and faces may lie on each \
         other; levels {below} and {above} are whole"
    )
}

/// Which colours .obj cannot hold, for people: it has one a position, without alpha. Nothing if there is no such colour.
fn colours_lost(mesh: &IndexedMesh) -> String {
    let Wedges { vertices, colours, .. } = &mesh.wedges;
    let pairs: Vec<(u32, [u8; 4])> = vertices.iter().copied().zip(colours.iter().copied()).collect();
    let several = pairs
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|wedges| wedges.iter().any(|wedge| wedge.1[..3] != wedges[0].1[..3]))
        .count();
    let clear = colours.iter().any(|colour| colour[3] != u8::MAX);
    let several = (several > 0).then(|| format!("of the colours of {several} vertices the first is written"));
    let clear = clear.then(|| "alpha is left out".to_owned());
    several.into_iter().chain(clear).collect::<Vec<_>>().join(", ")
}

/// Vertices with more than one wedge.
fn on_seams(mesh: &IndexedMesh) -> usize {
    mesh.wedges.vertices.chunk_by(|a, b| a == b).filter(|wedges| wedges.len() > 1).count()
}
