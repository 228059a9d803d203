//! What `vectors/manifest.json` holds: one entry a test, flat, in the order in which they are run.

use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::{fs, io};

/// The version of the manifest's form that this program reads.
pub const VERSION: u32 = 2;

/// The list of all tests.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// The version of this form: [`VERSION`].
    pub manifest: u32,
    /// The version of the specification that the files belong to.
    pub specification: String,
    /// The licence of files and manifest.
    pub licence: String,
    /// The tests.
    pub tests: Vec<Test>,
}

/// One test: a command to the adapter, and what must come of it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Test {
    /// Its name, never used again for another test: `ivg/0003-packed`, `ivg/0003-packed/chunks-7`, `numeric/oct24`.
    pub id: String,
    /// What it is about.
    pub kind: Kind,
    /// `ivg` or `pmesh`; none for a table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub format: Option<String>,
    /// The command of PROTOCOL.md.
    pub op: Op,
    /// What stands behind IN and OUT on the command line: a number, sizes between commas; for `numeric` the name of the table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub args: Option<String>,
    /// IN, relative to the folder of the manifest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Length of the file \[bytes\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bytes: Option<u64>,
    /// SHA-256 of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
    /// The verdict.
    pub verdict: Verdict,
    /// The error code, with the verdicts that have one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub code: Option<u16>,
    /// Verdicts that are right too, for a decoder with greater limits.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub also: Vec<Verdict>,
    /// What a decoder must have to come to this verdict.
    #[serde(default, skip_serializing_if = "Needs::is_empty")]
    pub needs: Needs,
    /// What OUT must hold.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub out: Option<Expected>,
    /// The clauses of the specification that it is about.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clauses: Vec<String>,
    /// For a file to refuse: the test of the accepted file that it differs from in one place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub twin: Option<String>,
    /// For a file with two mistakes: the test of a file with the one that is reported, and of one with the other.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub both: Option<[String; 2]>,
    /// The test of the whole file, for other commands with the same file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// How the file is made of its twin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recipe: Option<Recipe>,
    /// What it shows, or what is wrong.
    pub why: String,
    /// The kind of mistake that it finds, in one word.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bug_class: Option<String>,
    /// Where it comes from: `generated`, or the finding of a fuzzer.
    pub origin: String,
}

/// What a test is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// A file to accept.
    Positive,
    /// A file to refuse as invalid.
    Negative,
    /// The beginning of a file.
    Prefix,
    /// A file in pieces.
    Chunked,
    /// A file beyond the default limits.
    Limits,
    /// Something that a newer writer may write: to be skipped, or to be refused as unsupported.
    Forward,
    /// All values of a code.
    Numeric,
    /// The order of vertices on an awkward lattice.
    Order,
    /// A level of a mesh.
    Levels,
    /// A file with two mistakes: which of them is reported.
    Precedence,
}

impl Kind {
    /// Its name in the manifest.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Positive => "positive",
            Self::Negative => "negative",
            Self::Prefix => "prefix",
            Self::Chunked => "chunked",
            Self::Limits => "limits",
            Self::Forward => "forward",
            Self::Numeric => "numeric",
            Self::Order => "order",
            Self::Levels => "levels",
            Self::Precedence => "precedence",
        }
    }
}

/// A command of PROTOCOL.md.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Op {
    /// The whole file.
    Decode,
    /// Its first bytes.
    Prefix,
    /// The file in pieces.
    Chunks,
    /// All beginnings of it.
    Prefixes,
    /// A level of a mesh.
    Lod,
    /// A table.
    Numeric,
}

impl Op {
    /// Its name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Decode => "decode",
            Self::Prefix => "prefix",
            Self::Chunks => "chunks",
            Self::Prefixes => "prefixes",
            Self::Lod => "lod",
            Self::Numeric => "numeric",
        }
    }
}

/// What a decoder says of bytes (`spec/common.md`, COM-VERD-01).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// A whole valid file.
    Ok,
    /// A proper beginning of a valid one so far.
    NeedMore,
    /// Not a valid file.
    Invalid,
    /// Needs another reader.
    Unsupported,
    /// More than the reader's limits.
    Limit,
}

impl Verdict {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Ok, Self::NeedMore, Self::Invalid, Self::Unsupported, Self::Limit];

    /// The exit status that says so.
    #[must_use]
    pub fn status(self) -> i32 {
        match self {
            Self::Ok => 0,
            Self::NeedMore => 40,
            Self::Invalid => 41,
            Self::Unsupported => 42,
            Self::Limit => 43,
        }
    }

    /// The verdict that an exit status says, if it says one.
    #[must_use]
    pub fn from_status(status: i32) -> Option<Self> {
        Self::ALL.into_iter().find(|verdict| verdict.status() == status)
    }

    /// Its name in the manifest.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::NeedMore => "need-more",
            Self::Invalid => "invalid",
            Self::Unsupported => "unsupported",
            Self::Limit => "limit",
        }
    }
}

/// What of the registries a file needs for the verdict of its test.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Needs {
    /// An encoding of `.ivg`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub encoding: Option<String>,
    /// An order of `.ivg`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<String>,
    /// A mode of `.pmesh`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mode: Option<String>,
}

impl Needs {
    /// Whether every decoder has what it takes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// What OUT must hold.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Expected {
    /// What `file` is.
    pub form: Form,
    /// Relative to the folder of the manifest.
    pub file: String,
    /// Length of OUT \[bytes\].
    pub bytes: u64,
    /// SHA-256 of OUT.
    pub sha256: String,
}

/// How a file says what OUT must hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    /// It is OUT.
    Bytes,
    /// Lines `from`, `to`, verdict, records, with tabs between: the table of prefixes.
    Runs,
    /// OUT is rows of equal length; the first eight bytes of the SHA-256 of each.
    Rows,
}

/// How a file to refuse is made of its twin: the edits, at places of the twin, are made from the last to the first.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// The twin's test.
    pub from: String,
    /// Ascending by place; they do not overlap.
    pub edits: Vec<Edit>,
    /// Checksums that differ from the twin's because they were made anew, and are right.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub checksums: Vec<String>,
}

/// A run of bytes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Edit {
    /// Where in the twin \[bytes\].
    pub at: u64,
    /// So many bytes of the twin go.
    pub delete: u64,
    /// These come, hexadecimal.
    pub insert: String,
    /// So many times; once if it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeat: Option<u32>,
    /// The field that it hits.
    pub field: String,
}

impl Recipe {
    /// The file that is made of `twin`; `None` if the edits do not fit.
    #[must_use]
    pub fn apply(&self, twin: &[u8]) -> Option<Vec<u8>> {
        let mut file = twin.to_vec();
        for edit in self.edits.iter().rev() {
            let at = usize::try_from(edit.at).ok()?;
            let end = at.checked_add(usize::try_from(edit.delete).ok()?)?;
            if end > file.len() {
                return None;
            }
            let bytes = unhex(&edit.insert)?.repeat(edit.repeat.unwrap_or(1) as usize);
            file.splice(at..end, bytes);
        }
        Some(file)
    }
}

fn unhex(text: &str) -> Option<Vec<u8>> {
    let digits: Vec<u8> = text.chars().map(|c| c.to_digit(16).map(|d| d as u8)).collect::<Option<_>>()?;
    digits.len().is_multiple_of(2).then(|| digits.chunks(2).map(|two| two[0] << 4 | two[1]).collect())
}

impl Test {
    /// The words behind the command of the decoder.
    #[must_use]
    pub fn arguments(&self, input: &str, out: &str) -> Vec<String> {
        let args = self.args.iter().cloned();
        match &self.format {
            None => [self.op.name().to_owned()].into_iter().chain(args).chain([out.to_owned()]).collect(),
            Some(format) => {
                [self.op.name(), format, input, out].map(str::to_owned).into_iter().chain(args).collect()
            }
        }
    }
}

/// A folder with a manifest and the files that it names.
#[derive(Debug, Clone)]
pub struct Suite {
    /// The folder.
    pub folder: PathBuf,
    /// Its manifest.
    pub manifest: Manifest,
}

/// Where the suite lies from the working folder on, unless a user says otherwise: in the repository, in its archive.
const PLACES: [&str; 2] = ["conformance/vectors", "vectors"];

impl Suite {
    /// Opens the suite that a user names, or the one that lies near the working folder.
    ///
    /// # Errors
    ///
    /// There is none; or those of [`Suite::open`].
    pub fn find(named: Option<&Path>) -> Result<Self, String> {
        let near = || PLACES.map(Path::new).into_iter().find(|folder| folder.join("manifest.json").exists());
        let folder = named.or_else(near).ok_or("no suite here: name its folder of vectors with --suite")?;
        Self::open(folder)
    }

    /// Reads the manifest in a folder.
    ///
    /// # Errors
    ///
    /// There is none, it is no manifest, or one of another version; one line that says which.
    pub fn open(folder: &Path) -> Result<Self, String> {
        let path = folder.join("manifest.json");
        let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let manifest: Manifest =
            serde_json::from_str(&text).map_err(|error| format!("{}: {error}", path.display()))?;
        if manifest.manifest != VERSION {
            return Err(format!(
                "{}: form {}, this program reads {VERSION}",
                path.display(),
                manifest.manifest
            ));
        }
        Ok(Self { folder: folder.to_owned(), manifest })
    }

    /// A file that the manifest names.
    ///
    /// # Errors
    ///
    /// Those of reading it.
    pub fn read(&self, file: &str) -> io::Result<Vec<u8>> {
        fs::read(self.folder.join(file))
    }

    /// What OUT must hold, byte by byte; `None` where only hashes of rows are known.
    ///
    /// # Errors
    ///
    /// Those of reading the file; a table that is not one.
    pub fn expected(&self, expected: &Expected) -> Result<Option<Vec<u8>>, String> {
        let bytes = self.read(&expected.file).map_err(|error| format!("{}: {error}", expected.file))?;
        match expected.form {
            Form::Bytes => Ok(Some(bytes)),
            Form::Runs => expand(&String::from_utf8_lossy(&bytes))
                .map(Some)
                .ok_or(format!("{}: no table", expected.file)),
            Form::Rows => Ok(None),
        }
    }

    /// The test of this id.
    #[must_use]
    pub fn test(&self, id: &str) -> Option<&Test> {
        self.manifest.tests.iter().find(|test| test.id == id)
    }
}

/// The table of prefixes that runs of equal rows stand for.
fn expand(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split('\t').collect();
        let [from, to, verdict, records] = cells[..] else { return None };
        let (from, to, records): (u32, u32, u32) =
            (from.parse().ok()?, to.parse().ok()?, records.parse().ok()?);
        let verdict = Verdict::ALL.into_iter().find(|known| known.name() == verdict)?;
        for _ in from..=to {
            bytes.extend((verdict.status() as u32).to_le_bytes());
            bytes.extend(records.to_le_bytes());
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests;
