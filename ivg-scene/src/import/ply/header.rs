//! The header of a PLY file: text in all variants.

use super::values::{Encoding, Scalar};
use crate::SceneError;

/// Longest header \[bytes\]; real ones have a few hundred.
const MAX_HEADER_BYTES: usize = 1 << 16;

pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Lines of the header, so that the line of a value is known.
    pub(super) lines: usize,
    /// The image that a comment names, as MeshLab does.
    pub(super) texture: Option<String>,
}

pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

#[derive(Clone, Copy)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

/// The header and where the data begins.
pub(super) fn parse(file: &str, bytes: &[u8]) -> Result<(Header, usize), SceneError> {
    let mut header = Header { encoding: Encoding::Ascii, elements: Vec::new(), lines: 0, texture: None };
    let mut encoding = None;
    let mut at = 0;
    loop {
        let rest = &bytes[at..bytes.len().min(MAX_HEADER_BYTES)];
        let number = header.lines + 1;
        let bad = |what: String| SceneError::line(file, number, what);
        let Some(end) = rest.iter().position(|b| *b == b'\n') else {
            return Err(bad("header has no end_header".into()));
        };
        let line = String::from_utf8_lossy(&rest[..end]);
        at += end + 1;
        header.lines += 1;
        let words: Vec<&str> = line.split_whitespace().collect();
        match (number, &words[..]) {
            (1, ["ply"]) => {}
            (1, _) => return Err(bad("is not a PLY file: the first line is not \"ply\"".into())),
            (_, ["format", name, version]) => {
                encoding = Some(match *name {
                    "ascii" => Encoding::Ascii,
                    "binary_little_endian" => Encoding::LittleEndian,
                    "binary_big_endian" => Encoding::BigEndian,
                    other => return Err(bad(format!("format {other} is not known"))),
                });
                if *version != "1.0" {
                    return Err(bad(format!("version {version} is not 1.0")));
                }
            }
            (_, ["comment", "TextureFile", name @ ..]) => header.texture = Some(name.join(" ")),
            (_, ["comment" | "obj_info", ..] | []) => {}
            (_, ["element", name, count]) => {
                let count =
                    count.parse().map_err(|_| bad(format!("\"{count}\" is no number of elements")))?;
                header.elements.push(Element { name: (*name).into(), count, properties: Vec::new() });
            }
            (_, ["property", kind @ .., name]) => {
                let scalar = |word: &str| {
                    Scalar::from_name(word)
                        .ok_or_else(|| bad(format!("type {word} of property {name} is not known")))
                };
                let kind = match kind {
                    [one] => Kind::Scalar(scalar(one)?),
                    ["list", count, item] => Kind::List { count: scalar(count)?, item: scalar(item)? },
                    _ => return Err(bad(format!("property {name} is neither TYPE nor list TYPE TYPE"))),
                };
                let Some(element) = header.elements.last_mut() else {
                    return Err(bad(format!("property {name} before any element")));
                };
                element.properties.push(Property { name: (*name).into(), kind });
            }
            (_, ["end_header"]) => break,
            (_, [word, ..]) => return Err(bad(format!("header line \"{word}\" is not known"))),
        }
    }
    header.encoding =
        encoding.ok_or_else(|| SceneError::line(file, header.lines, "header has no format line"))?;
    Ok((header, at))
}
