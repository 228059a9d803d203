//! Makes the tests: the manifest, and the files that say what OUT must hold.

use super::clauses::{Clauses, bug_class, of_command};
use super::diff::compare;
use super::fields::{envelopes, header_bytes};
use super::line::line;
use super::needs::needs;
use super::shown::{Shown, grid, mesh};
use super::tables::TABLES;
use crate::vectors::{Format, PrefixRow, Vector, prefix_rows, table};
use conformance_runner::manifest::{Expected, Form, Kind, Manifest, Needs, Op, Test, VERSION, Verdict};
use conformance_runner::sha256;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// The folder of what OUT must hold, relative to that of the manifest.
pub const EXPECTED: &str = "expected";
/// The folder of the tables of prefixes.
const PREFIX: &str = "prefix";
/// The folder of the hashes of the rows of tables.
const NUMERIC: &str = "numeric";

/// The longest file of which every beginning is judged \[bytes\].
const LONGEST_TABLE: usize = 4096;
/// The longest file to refuse of which every beginning is judged \[bytes\]; one of each code.
const LONGEST_REFUSED: usize = 1024;
/// More of them: what is wrong is there before the bytes that another reader might wait for.
const JUDGED_EARLY: [&str; 1] = ["x-106-chunk-room"];
/// Sizes of pieces, for files to accept; for files to refuse, the first and the last.
const PIECES: [&str; 6] = ["1", "2", "3", "7", "4096", "5,1,300,2,64,17"];
/// A mesh of at most so many vertices is shown at every level, another at [`SOME_LEVELS`].
const ALL_LEVELS: u32 = 12;
const SOME_LEVELS: u32 = 4;

/// Files that are cut at the ends of header, chunks and records, a byte before, and a byte behind.
const CUT: [&str; 12] = [
    "ivg/0005-validity",
    "ivg/0006-lights",
    "ivg/0013-generation",
    "ivg/0015-harmonics",
    "ivg/0016-octree",
    "ivg/0018-explicit-small",
    "pmesh/0001-empty",
    "pmesh/0003-octahedron",
    "pmesh/0005-seam",
    "pmesh/0011-raw-attributes",
    "pmesh/0035-coded-q14",
    "pmesh/0057-coded-wedges",
];

/// What a newer writer may write, in names of accepted files.
const FORWARD: [&str; 6] = ["chunk", "newer-minor", "optional-feature", "known-", "minor", "generation"];
/// The first number of files about the order of vertices.
const ORDERS: &str = "ivg/01";

/// What is being made.
struct Generator {
    clauses: Clauses,
    tests: Vec<Test>,
    /// Files beside the vectors: paths relative to the manifest, and contents.
    files: BTreeMap<PathBuf, Vec<u8>>,
}

/// The manifest, and the files that it names beside the vectors.
///
/// # Panics
///
/// If a vector that is listed here is not there, or is no such file as it is listed as.
#[must_use]
pub fn generate(vectors: &[Vector]) -> (String, Vec<(PathBuf, Vec<u8>)>) {
    let mut generator = Generator { clauses: Clauses::read(), tests: Vec::new(), files: BTreeMap::new() };
    vectors.iter().for_each(|vector| generator.whole(vector, vectors));
    let whole: BTreeMap<String, Test> =
        generator.tests.iter().map(|test| (test.id.clone(), test.clone())).collect();
    let of = |vector: &Vector| &whole[&id(vector)];
    let mut codes = BTreeSet::new();
    for vector in vectors {
        generator.prefixes(vector, of(vector), &mut codes);
    }
    for vector in vectors.iter().filter(|vector| CUT.contains(&id(vector).as_str())) {
        generator.cut(vector, of(vector));
    }
    for vector in vectors {
        generator.chunks(of(vector), vector.code.is_some());
    }
    for vector in vectors.iter().filter(|vector| vector.format == Format::Pmesh && vector.code.is_none()) {
        generator.levels(vector, of(vector));
    }
    generator.tables();
    let manifest = Manifest {
        manifest: VERSION,
        specification: "draft 0".to_owned(),
        licence: "CC0-1.0".to_owned(),
        tests: generator.tests,
    };
    (text(&manifest), generator.files.into_iter().collect())
}

fn id(vector: &Vector) -> String {
    format!("{}/{}", vector.format.name(), vector.name)
}

fn verdict(verdict: ivg_wire::Verdict) -> Verdict {
    Verdict::from_status(verdict.exit_code().into()).expect("the exit codes of the specification")
}

fn show(format: Format, data: &[u8]) -> Shown {
    match format {
        Format::Ivg => grid(data, &[]),
        Format::Pmesh => mesh(data, &[], None),
    }
}

impl Generator {
    /// The test of a whole file.
    fn whole(&mut self, vector: &Vector, vectors: &[Vector]) {
        let (format, id) = (vector.format, id(vector));
        let kind = match verdict(vector.verdict) {
            _ if vector.both.is_some() => Kind::Precedence,
            Verdict::Invalid => Kind::Negative,
            Verdict::Unsupported => Kind::Forward,
            Verdict::Limit => Kind::Limits,
            _ if id.starts_with(ORDERS) => Kind::Order,
            _ if FORWARD.iter().any(|part| vector.name.contains(part)) => Kind::Forward,
            _ => Kind::Positive,
        };
        let twin = vector.twin.map(|name| {
            let twin = vectors.iter().find(|twin| twin.format == format && twin.name == name);
            twin.unwrap_or_else(|| panic!("{id}: no {name}"))
        });
        let recipe = twin.map(|twin| compare(format, &self::id(twin), &twin.bytes, &vector.bytes).0);
        let out = vector.code.is_none().then(|| self.expect(show(format, &vector.bytes).out));
        self.tests.push(Test {
            kind,
            format: Some(format.name().to_owned()),
            op: Op::Decode,
            args: None,
            file: Some(vector.file()),
            bytes: Some(vector.bytes.len() as u64),
            sha256: Some(sha256(&vector.bytes)),
            verdict: verdict(vector.verdict),
            code: vector.code,
            also: if kind == Kind::Limits { vec![without_limits(vector)] } else { Vec::new() },
            needs: needs(format, &vector.bytes),
            out,
            clauses: self.clauses.of(vector, kind),
            twin: twin.map(self::id),
            both: vector
                .both
                .as_ref()
                .map(|both| both.names.each_ref().map(|name| format!("{}/{name}", format.name()))),
            of: None,
            recipe,
            why: vector.why.to_owned(),
            bug_class: vector.code.map(|code| bug_class(code).to_owned()),
            origin: "generated".to_owned(),
            id,
        });
    }

    /// Another command with the file of a test.
    fn push(&mut self, whole: &Test, kind: Kind, op: Op, args: Option<String>, edit: impl FnOnce(&mut Test)) {
        let format = if whole.format.as_deref() == Some("ivg") { Format::Ivg } else { Format::Pmesh };
        let suffix = match (op, args.as_deref()) {
            // A mixed list would make a long name.
            (Op::Chunks, Some(sizes)) if sizes.contains(',') => "-mixed".to_owned(),
            (_, Some(args)) => format!("-{args}"),
            (_, None) => String::new(),
        };
        let refused = whole.code.is_some();
        let mut test = Test {
            id: format!("{}/{}{suffix}", whole.id, op.name()),
            kind,
            op,
            args,
            clauses: of_command(format, op, refused),
            of: Some(whole.id.clone()),
            twin: None,
            both: None,
            recipe: None,
            ..whole.clone()
        };
        edit(&mut test);
        self.tests.push(test);
    }

    /// The verdict on every beginning of a file.
    fn prefixes(&mut self, vector: &Vector, whole: &Test, codes: &mut BTreeSet<(Format, u16)>) {
        let rows = match vector.code {
            None if vector.bytes.len() <= LONGEST_TABLE => prefix_rows(vector),
            Some(_) if vector.bytes.len() > LONGEST_REFUSED => return,
            Some(code)
                if codes.insert((vector.format, code)) || JUDGED_EARLY.contains(&vector.name.as_str()) =>
            {
                judged(vector)
            }
            _ => return,
        };
        let table = table(&rows);
        let out: Vec<u8> = rows
            .iter()
            .flat_map(|row| {
                let words =
                    [u32::from(row.verdict.exit_code()), row.records as u32].map(u32::to_le_bytes).concat();
                words.repeat(row.to + 1 - row.from)
            })
            .collect();
        let file = format!("{PREFIX}/{}-{}.tsv", vector.format.name(), vector.name);
        let expected =
            Expected { form: Form::Runs, file: file.clone(), bytes: out.len() as u64, sha256: sha256(&out) };
        self.files.insert(PathBuf::from(file), table.into_bytes());
        self.push(whole, Kind::Prefix, Op::Prefixes, None, |test| {
            test.why = format!("every beginning of: {}", whole.why);
            (test.verdict, test.code, test.out) = (Verdict::Ok, None, Some(expected));
            test.also.clear();
            test.bug_class = Some("partial-state".to_owned());
        });
    }

    /// What is known of a file that ends at, before or behind the end of each of its parts.
    fn cut(&mut self, vector: &Vector, whole: &Test) {
        let (format, file) = (vector.format, &vector.bytes);
        let mut lengths = BTreeSet::from([0, 1]);
        for envelope in envelopes(format, file) {
            let end = envelope.range.end;
            lengths.extend([end - 1, end, end + 1]);
        }
        // IVG-STR-01: the header may be shown before the directory is whole, or not.
        let directory = envelopes(format, file).into_iter().find(|envelope| envelope.name == "chunk DIRE");
        let free = directory.map_or(0..0, |directory| header_bytes(file)..directory.range.end);
        for length in lengths.into_iter().filter(|length| *length < file.len() && !free.contains(length)) {
            let data = &file[..length];
            let shown = show(format, data);
            assert_eq!(shown.verdict(), ivg_wire::Verdict::NeedMore, "{}, {length} bytes", whole.id);
            let expected = self.expect(shown.out);
            self.push(whole, Kind::Prefix, Op::Prefix, Some(length.to_string()), |test| {
                test.why = format!("what is known after {length} bytes of: {}", whole.why);
                (test.verdict, test.out, test.needs) =
                    (Verdict::NeedMore, Some(expected), needs(format, data));
                test.bug_class = Some("partial-state".to_owned());
            });
        }
    }

    /// A file in pieces.
    fn chunks(&mut self, whole: &Test, refused: bool) {
        let sizes = if refused { vec![PIECES[0], PIECES[5]] } else { PIECES.to_vec() };
        for sizes in sizes {
            self.push(whole, Kind::Chunked, Op::Chunks, Some(sizes.to_owned()), |test| {
                test.why = format!("in pieces: {}", whole.why);
                test.bug_class = Some("split".to_owned());
            });
        }
    }

    /// Levels of a mesh.
    fn levels(&mut self, vector: &Vector, whole: &Test) {
        let word = |at: usize| u32::from_le_bytes(*vector.bytes[at..].first_chunk().expect("a header"));
        // `vertex_count` and `base_vertices`.
        let (finest, coarsest) = (word(56), word(68));
        let mut levels: Vec<u32> = match finest {
            0..=ALL_LEVELS => (coarsest..=finest).collect(),
            _ => (0..SOME_LEVELS).map(|n| coarsest + (finest - coarsest) * n / (SOME_LEVELS - 1)).collect(),
        };
        levels.dedup();
        for level in levels {
            let expected = self.expect(mesh(&vector.bytes, &[], Some(level)).out);
            self.push(whole, Kind::Levels, Op::Lod, Some(level.to_string()), |test| {
                test.why = format!("level {level} of: {}", whole.why);
                test.out = Some(expected);
                test.bug_class = Some("levels".to_owned());
            });
        }
    }

    fn tables(&mut self) {
        for table in TABLES {
            let (rows, sha256, bytes) = table.hashes();
            let file = format!("{NUMERIC}/{}.rows", table.name);
            self.files.insert(PathBuf::from(&file), rows);
            self.tests.push(Test {
                id: format!("numeric/{}", table.name),
                kind: Kind::Numeric,
                format: None,
                op: Op::Numeric,
                args: Some(table.name.to_owned()),
                file: None,
                bytes: None,
                sha256: None,
                verdict: Verdict::Ok,
                code: None,
                also: Vec::new(),
                needs: Needs::default(),
                out: Some(Expected { form: Form::Rows, file, bytes, sha256 }),
                clauses: table.clauses.iter().map(|&clause| clause.to_owned()).collect(),
                twin: None,
                both: None,
                of: None,
                recipe: None,
                why: table.why.to_owned(),
                bug_class: Some("rounding".to_owned()),
                origin: "generated".to_owned(),
            });
        }
    }

    /// Keeps what OUT must hold, once.
    fn expect(&mut self, out: Vec<u8>) -> Expected {
        let sha256 = sha256(&out);
        let file = format!("{EXPECTED}/{}.bin", &sha256[..16]);
        let bytes = out.len() as u64;
        self.files.insert(PathBuf::from(&file), out);
        Expected { form: Form::Bytes, file, bytes, sha256 }
    }
}

/// What a reader with the greatest limits says of a file beyond the default ones.
fn without_limits(vector: &Vector) -> Verdict {
    let wire = ivg_wire::Limits {
        header_bytes: ivg_wire::Maximum::HEADER_BYTES,
        chunk_bytes: ivg_wire::Maximum::CHUNK_BYTES,
        chunks: ivg_wire::Maximum::CHUNKS,
        record_bytes: ivg_wire::Maximum::RECORD_BYTES,
    };
    let read = match vector.format {
        Format::Ivg => {
            ivg_format::decode_all(&vector.bytes, &ivg_format::Limits { wire, vertices: u64::MAX }, |_| {})
        }
        Format::Pmesh => pmesh_format::decode_all(
            &vector.bytes,
            &pmesh_format::Limits { wire, counts: pmesh_format::MAX_COUNT },
            |_| {},
        ),
    };
    match read.map_err(|error| error.verdict()) {
        Ok(()) => Verdict::Ok,
        Err(ivg_wire::Verdict::NeedMore) => Verdict::NeedMore,
        Err(other) => panic!("{}: {other} with the greatest limits", vector.name),
    }
}

/// The verdicts on all beginnings of a file to refuse, by our decoder.
fn judged(vector: &Vector) -> Vec<PrefixRow> {
    let mut rows: Vec<PrefixRow> = Vec::new();
    for length in 0..=vector.bytes.len() {
        let shown = show(vector.format, &vector.bytes[..length]);
        let (verdict, records) = (shown.verdict(), shown.records as usize);
        match rows.last_mut() {
            Some(row) if (row.verdict, row.records) == (verdict, records) => row.to = length,
            _ => rows.push(PrefixRow { from: length, to: length, verdict, records }),
        }
    }
    rows
}

/// One line a test, so that what changes can be seen.
fn text(manifest: &Manifest) -> String {
    let tests: Vec<String> = manifest.tests.iter().map(line).collect();
    format!(
        "{{\n\"manifest\": {},\n\"specification\": {},\n\"licence\": {},\n\"tests\": [\n{}\n]\n}}\n",
        manifest.manifest,
        line(&manifest.specification),
        line(&manifest.licence),
        tests.join(",\n")
    )
}
