//! The lines of an OBJ file, each checked before tobj sees it.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io::{self, BufRead, Read};

use crate::SceneError;

/// A reader over checked lines. At the first bad line it stores [`CheckedLines::error`] and fails.
pub(super) struct CheckedLines<'a> {
    file: &'a str,
    rest: &'a str,
    /// Line number of the next line of `rest`, from 1.
    line: usize,
    current: Cow<'a, [u8]>,
    read: usize,
    /// How many `v`, `vt`, `vn` lines there were so far.
    counts: [u64; 3],
    /// Which vertices faces have named so far, as far as a file of this length can have vertices.
    named: Vec<bool>,
    /// The first face index beyond the counts of its time: the culprit if tobj finds one out of range at the end.
    beyond: Option<(usize, String)>,
    /// What went wrong, with its line.
    pub(super) error: Option<SceneError>,
    /// Polylines, points, curves and surfaces that were passed over.
    pub(super) skipped_elements: usize,
    /// Whether vertices have colours, `v x y z r g b`: all of them, as tobj wants it; those without become white.
    with_colours: bool,
    /// Vertices that have become white so.
    pub(super) plain_vertices: usize,
    /// Names after `usemtl`.
    pub(super) used_materials: BTreeSet<String>,
}

/// What tobj sees of a line.
enum Passed {
    /// All of it.
    Line,
    /// All of it and a white colour behind it.
    White,
    /// Only that there is one.
    Nothing,
}

/// Whether a vertex of a file has a colour, which is six numbers.
fn has_colours(text: &str) -> bool {
    text.lines().any(|line| {
        let line = line.split_once('#').map_or(line, |(line, _)| line);
        let mut words = line.split_whitespace();
        words.next() == Some("v") && words.count() == 6
    })
}

/// Bytes of the shortest line of a vertex that another line follows: `v 0 0 0` and its end.
const SHORTEST_VERTEX: usize = 8;

/// Kinds of index in a face corner `v/vt/vn`, as error messages name them.
const INDEX_KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

impl<'a> CheckedLines<'a> {
    pub(super) fn new(file: &'a str, text: &'a str) -> Self {
        Self {
            file,
            rest: text,
            line: 1,
            current: Cow::Borrowed(&[]),
            read: 0,
            counts: [0; 3],
            named: vec![false; text.len() / SHORTEST_VERTEX],
            beyond: None,
            error: None,
            skipped_elements: 0,
            with_colours: has_colours(text),
            plain_vertices: 0,
            used_materials: BTreeSet::new(),
        }
    }

    /// How many of the vertices no face names. tobj leaves them out.
    pub(super) fn unreferenced(&self) -> u64 {
        self.counts[0] - self.named.iter().filter(|named| **named).count() as u64
    }

    /// An error of tobj with the line that most likely caused it.
    pub(super) fn explain(&self, error: tobj::LoadError) -> SceneError {
        match &self.beyond {
            Some((line, what)) => SceneError::line(self.file, *line, what.clone()),
            None => SceneError::line(self.file, self.line.saturating_sub(1), error.to_string()),
        }
    }

    /// Takes the next logical line (`\` at the end continues it, `#` in a line of numbers ends it) into `current`.
    fn advance(&mut self) -> Result<(), SceneError> {
        self.read = 0;
        let number = self.line;
        let mut joined: Option<String> = None;
        let line: Cow<'a, str> = loop {
            let (line, rest) = self.rest.split_at(self.rest.find('\n').map_or(self.rest.len(), |at| at + 1));
            self.rest = rest;
            self.line += 1;
            let continued =
                line.trim_end_matches(['\r', '\n']).strip_suffix('\\').filter(|_| !rest.is_empty());
            match (continued, &mut joined) {
                (Some(part), text) => {
                    let text = text.get_or_insert_default();
                    text.push_str(part);
                    text.push(' ');
                }
                (None, Some(text)) => {
                    text.push_str(line);
                    break Cow::Owned(std::mem::take(text));
                }
                (None, None) => break Cow::Borrowed(line),
            }
        };
        let line = match line.find('#') {
            Some(at) if at > 0 && line.starts_with(['v', 'f']) => Cow::Owned(format!("{}\n", &line[..at])),
            _ => line,
        };
        self.current = match (self.check(&line, number)?, line) {
            (Passed::Nothing, _) => Cow::Borrowed(b"\n"),
            (Passed::White, line) => Cow::Owned(format!("{} 1 1 1\n", line.trim_end()).into_bytes()),
            (Passed::Line, Cow::Borrowed(line)) => Cow::Borrowed(line.as_bytes()),
            (Passed::Line, Cow::Owned(line)) => Cow::Owned(line.into_bytes()),
        };
        Ok(())
    }

    /// What of the line tobj may see.
    fn check(&mut self, line: &str, number: usize) -> Result<Passed, SceneError> {
        let bad = |what: String| Err(SceneError::line(self.file, number, what));
        let mut words = line.split_whitespace();
        match words.next() {
            Some(keyword @ ("v" | "vt" | "vn")) => {
                let (kind, needed) = match keyword {
                    "v" => (0, 3),
                    "vt" => (1, 2),
                    _ => (2, 3),
                };
                let mut found = 0;
                for word in words {
                    match word.parse::<f64>() {
                        Ok(value) if value.is_finite() => found += 1,
                        _ if keyword != "v" && found >= needed => break,
                        _ => return bad(format!("{} \"{word}\" is no finite number", INDEX_KINDS[kind])),
                    }
                }
                if found < needed {
                    return bad(format!("{} has {found} numbers instead of {needed}", INDEX_KINDS[kind]));
                }
                self.counts[kind] += 1;
                if keyword == "v" && self.with_colours {
                    match found {
                        3 => {
                            self.plain_vertices += 1;
                            return Ok(Passed::White);
                        }
                        6 => {}
                        _ => {
                            let what = "where some vertices have colours, each has 3 numbers or 6";
                            return bad(format!("vertex has {found} numbers; {what}"));
                        }
                    }
                }
            }
            Some("f") => {
                let mut corners = 0;
                for word in words {
                    self.check_corner(word, number)?;
                    corners += 1;
                }
                if corners < 3 {
                    return bad(format!("face has {corners} corners instead of at least 3"));
                }
            }
            Some("l" | "p" | "curv" | "curv2" | "surf") => {
                self.skipped_elements += 1;
                return Ok(Passed::Nothing);
            }
            Some("usemtl") => {
                let name = line.split_once(' ').unwrap_or_default().1.trim();
                if name.is_empty() {
                    return bad("usemtl without the name of a material".into());
                }
                if !self.used_materials.contains(name) {
                    self.used_materials.insert(name.to_owned());
                }
            }
            _ => {}
        }
        Ok(Passed::Line)
    }

    fn check_corner(&mut self, word: &str, number: usize) -> Result<(), SceneError> {
        let bad = |what: String| Err(SceneError::line(self.file, number, what));
        let mut parts = 0;
        for (kind, part) in word.split('/').enumerate() {
            parts += 1;
            if kind >= 3 {
                return bad(format!("face corner \"{word}\" has more than three indices"));
            }
            if part.is_empty() && kind > 0 {
                continue;
            }
            let Ok(index) = part.parse::<i64>() else {
                return bad(format!("face corner \"{word}\" is not of the form v, v/vt, v//vn or v/vt/vn"));
            };
            let count = self.counts[kind];
            let out_of_range =
                || format!("face names {} {index}, but there are only {count} so far", INDEX_KINDS[kind]);
            if index == 0 {
                return bad(format!("face names {} 0, but the first one is 1", INDEX_KINDS[kind]));
            }
            // tobj computes with twice and three times the index.
            if index.unsigned_abs() > u64::from(u32::MAX) || (index < 0 && index.unsigned_abs() > count) {
                return bad(out_of_range());
            }
            if kind == 0 {
                let place = if index > 0 { index as u64 - 1 } else { count - index.unsigned_abs() };
                let place = usize::try_from(place).ok().and_then(|place| self.named.get_mut(place));
                place.into_iter().for_each(|named| *named = true);
            }
            if index > 0 && index as u64 > count && self.beyond.is_none() {
                self.beyond = Some((number, out_of_range()));
            }
        }
        debug_assert!(parts > 0, "split yields at least one part");
        Ok(())
    }
}

impl Read for CheckedLines<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let bytes = self.fill_buf()?;
        let n = bytes.len().min(out.len());
        out[..n].copy_from_slice(&bytes[..n]);
        self.consume(n);
        Ok(n)
    }
}

impl BufRead for CheckedLines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.error.is_some() {
            return Err(io::Error::other("bad line"));
        }
        if self.read == self.current.len()
            && !self.rest.is_empty()
            && let Err(error) = self.advance()
        {
            self.error = Some(error);
            return Err(io::Error::other("bad line"));
        }
        Ok(&self.current[self.read..])
    }

    fn consume(&mut self, n: usize) {
        self.read += n;
    }
}
