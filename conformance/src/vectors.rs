//! The conformance vectors: small files, right and wrong, each with what a reader must say of it. They are made here,
//! from nothing but this code, so that `cargo run -p conformance --bin generate` writes the same bytes on every machine.

pub(crate) mod both;
pub mod edit;
mod ivg;
pub mod levels;
pub mod parts;
mod pmesh;
mod prefix;
mod seeds;

pub use prefix::{PrefixRow, prefix_rows, table};

use ivg_wire::{Code, Rule, Verdict};
use std::ops::Range;
use std::path::PathBuf;

/// Which format a vector is in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Format {
    /// `.ivg`: irradiance vector grids.
    Ivg,
    /// `.pmesh`: progressive meshes.
    Pmesh,
}

impl Format {
    /// The extension of its files, which is also the name of the folder of its vectors.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ivg => "ivg",
            Self::Pmesh => "pmesh",
        }
    }
}

/// A file and what a reader must say of it.
#[derive(Debug, Clone)]
pub struct Vector {
    /// The format that it is, or pretends to be, in.
    pub format: Format,
    /// Its name without extension, unique in its format; that of a file to refuse begins with `x-`.
    pub name: String,
    /// The file.
    pub bytes: Vec<u8>,
    /// What a reader with the default limits says of it.
    pub verdict: Verdict,
    /// The error code, if it is refused.
    pub code: Option<u16>,
    /// What it shows, or what is wrong with it.
    pub why: &'static str,
    /// For a file to refuse: the name of the right one that it differs from in one place.
    pub twin: Option<&'static str>,
    /// For a file with two mistakes: which.
    pub both: Option<Both>,
}

/// Two mistakes in one file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Both {
    /// The names of the files with one of them: of that which is reported, and of the other.
    pub names: [String; 2],
    /// The clause that says which is judged first.
    pub clause: &'static str,
}

/// A file to refuse: name of the right one that it differs from, what to call the mistake, its code, the file, what is wrong.
type Refused = (&'static str, &'static str, Code, Vec<u8>, &'static str);

impl Vector {
    fn accepted(format: Format, name: &str, bytes: Vec<u8>, why: &'static str) -> Self {
        let name = name.to_owned();
        Self { format, name, bytes, verdict: Verdict::Ok, code: None, why, twin: None, both: None }
    }

    fn refused(format: Format, (twin, mistake, code, bytes, why): Refused) -> Self {
        let Rule { number, verdict, .. } = *code.rule();
        let name = format!("x-{number}-{mistake}");
        Self { format, name, bytes, verdict, code: Some(number), why, twin: Some(twin), both: None }
    }

    /// Path relative to the folder of the vectors.
    #[must_use]
    pub fn file(&self) -> String {
        let format = self.format.name();
        format!("{format}/{}.{format}", self.name)
    }
}

/// All vectors, those of one format together.
#[must_use]
pub fn vectors() -> Vec<Vector> {
    let with_both = |format, mut vectors: Vec<Vector>| {
        vectors.extend(both::refused(format, &vectors));
        vectors
    };
    [with_both(Format::Ivg, ivg::vectors()), with_both(Format::Pmesh, pmesh::vectors())].concat()
}

/// What the records of an accepted `.ivg` file are called, and where they lie.
#[must_use]
pub(crate) fn ivg_records(file: &[u8]) -> Vec<(String, Range<usize>)> {
    ivg::records(file)
}

/// What the records of an accepted `.pmesh` file are called, and where they lie.
#[must_use]
pub(crate) fn pmesh_records(file: &[u8]) -> Vec<(String, Range<usize>)> {
    pmesh::records(file)
}

/// Everything that the generator writes: paths relative to the workspace, and contents.
#[must_use]
pub fn generated_files() -> Vec<(PathBuf, Vec<u8>)> {
    let folder = PathBuf::from("conformance/vectors");
    let vectors = vectors();
    let mut files: Vec<(PathBuf, Vec<u8>)> =
        vectors.iter().map(|vector| (folder.join(vector.file()), vector.bytes.clone())).collect();
    let (manifest, expected) = crate::suite::generate(&vectors);
    files.push((folder.join("manifest.json"), manifest.into_bytes()));
    files.extend(expected.into_iter().map(|(path, bytes)| (folder.join(path), bytes)));
    files.extend(
        seeds::seeds(&vectors)
            .into_iter()
            .map(|(path, bytes)| (PathBuf::from("fuzz/corpus").join(path), bytes)),
    );
    files
}

/// The folders, relative to the workspace, that hold nothing but what the generator writes.
pub const GENERATED_FOLDERS: [&str; 2] = ["conformance/vectors", "fuzz/corpus"];
