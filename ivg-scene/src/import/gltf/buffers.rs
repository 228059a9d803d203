//! Buffers, and buffer views with `EXT_meshopt_compression` undone.

use std::borrow::Cow;

use ::gltf::json::Root;
use serde::Deserialize;

use super::super::compress::MAX_FILE_BYTES;
use super::super::folder::Folder;
use crate::SceneError;

/// Both names of the extension; they differ in what the encoder may use, which the decoder finds out by itself.
const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Most bytes that one compressed byte may stand for. The codec can state 256 vertices of 256 bytes in four bytes of
/// control data a block, 64 times as much with its per-block headers; real data stays below 100.
const MAX_EXPANSION: usize = 16_384;

/// The bytes of each buffer; `None` for one that has none, which is right only if all its views are compressed.
pub(super) type Buffers<'a> = Vec<Option<Cow<'a, [u8]>>>;

/// Reads all buffers: the binary chunk, `data:` URIs, and files beside the scene.
pub(super) fn load<'a>(
    name: &str,
    root: &Root,
    blob: Option<&'a [u8]>,
    folder: &Folder,
) -> Result<Buffers<'a>, SceneError> {
    let mut buffers = Vec::new();
    for (i, buffer) in root.buffers.iter().enumerate() {
        let bad = |what: String| SceneError::file(name, format!("buffers[{i}]: {what}"));
        let bytes = match &buffer.uri {
            None if i == 0 => blob.map(Cow::Borrowed),
            None => None,
            Some(uri) => Some(Cow::Owned(fetch(uri, folder).map_err(bad)?)),
        };
        if let Some(bytes) = &bytes
            && (bytes.len() as u64) < buffer.byte_length.0
        {
            return Err(bad(format!("has {} bytes instead of {}", bytes.len(), buffer.byte_length.0)));
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}

/// The bytes that a URI names.
pub(super) fn fetch(uri: &str, folder: &Folder) -> Result<Vec<u8>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (kind, text) = data.split_once(',').ok_or("data: URI without a comma")?;
        if !kind.ends_with(";base64") {
            return Err("data: URI that is not base64".into());
        }
        return base64(text).ok_or_else(|| "data: URI with broken base64".into());
    }
    let path = percent_decoded(uri).ok_or_else(|| format!("URI \"{uri}\" has a broken %-escape"))?;
    if path.contains(':') {
        return Err(format!("URI \"{uri}\" is not a file beside the scene; download it there"));
    }
    folder.read(&path, MAX_FILE_BYTES).map_err(|e| e.0)
}

fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = uri.bytes();
    let mut out = Vec::with_capacity(uri.len());
    while let Some(b) = bytes.next() {
        let digit = |d: Option<u8>| char::from(d?).to_digit(16);
        out.push(if b == b'%' { (digit(bytes.next())? << 4 | digit(bytes.next())?) as u8 } else { b });
    }
    String::from_utf8(out).ok()
}

/// RFC 4648, section 4; padding may be missing.
fn base64(text: &str) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count) = (0u32, 0);
    for b in text.trim_end_matches('=').bytes() {
        let value = match b {
            b'A'..=b'Z' => b - b'A',
            b'a'..=b'z' => b - b'a' + 26,
            b'0'..=b'9' => b - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            out.push((bits >> count) as u8);
        }
    }
    (count < 6).then_some(out)
}

/// The extension object of a compressed buffer view.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Compressed {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: usize,
    count: usize,
    mode: String,
    #[serde(default)]
    filter: Option<String>,
}

/// The bytes of a buffer view.
///
/// # Errors
///
/// Says what is wrong with the view.
pub(super) fn view<'a>(root: &Root, buffers: &'a Buffers<'_>, index: usize) -> Result<Cow<'a, [u8]>, String> {
    let view = root.buffer_views.get(index).ok_or("does not exist")?;
    let extension =
        view.extensions.as_ref().and_then(|e| MESHOPT.iter().find_map(|name| e.others.get(*name)));
    if let Some(extension) = extension {
        let c = Compressed::deserialize(extension).map_err(|e| format!("meshopt extension: {e}"))?;
        let bytes = range(buffers, c.buffer, c.byte_offset as u64, c.byte_length as u64)?;
        return decode(&c, bytes).map(Cow::Owned);
    }
    range(buffers, view.buffer.value(), view.byte_offset.map_or(0, |o| o.0), view.byte_length.0)
        .map(Cow::Borrowed)
}

fn range<'a>(buffers: &'a Buffers<'_>, buffer: usize, offset: u64, length: u64) -> Result<&'a [u8], String> {
    let bytes = buffers.get(buffer).ok_or_else(|| format!("buffer {buffer} does not exist"))?;
    let bytes = bytes.as_ref().ok_or_else(|| format!("buffer {buffer} has no data"))?;
    let end = offset.checked_add(length).filter(|end| *end <= bytes.len() as u64);
    let end = end.ok_or_else(|| {
        format!("bytes {offset} to {offset} + {length} lie beyond the {} of buffer {buffer}", bytes.len())
    })?;
    Ok(&bytes[offset as usize..end as usize])
}

fn decode(c: &Compressed, encoded: &[u8]) -> Result<Vec<u8>, String> {
    let stride_ok = match c.mode.as_str() {
        "ATTRIBUTES" => c.byte_stride.is_multiple_of(4) && (4..=256).contains(&c.byte_stride),
        "TRIANGLES" => matches!(c.byte_stride, 2 | 4) && c.count.is_multiple_of(3),
        "INDICES" => matches!(c.byte_stride, 2 | 4),
        other => return Err(format!("meshopt mode {other} is not known")),
    };
    if !stride_ok {
        return Err(format!("meshopt mode {} with stride {} and count {}", c.mode, c.byte_stride, c.count));
    }
    let size = c.count.checked_mul(c.byte_stride).filter(|n| *n / MAX_EXPANSION <= encoded.len());
    if size.is_none() {
        return Err(format!("meshopt data of {} bytes cannot hold {} elements", encoded.len(), c.count));
    }
    let failed = |e: meshopt::Error| format!("meshopt data is damaged ({e})");
    let mut bytes = match (c.mode.as_str(), c.byte_stride) {
        ("ATTRIBUTES", stride) => attributes(encoded, c.count, stride).map_err(failed)?,
        ("TRIANGLES", 2) => little16(&meshopt::decode_index_buffer(encoded, c.count).map_err(failed)?),
        ("TRIANGLES", _) => little32(&meshopt::decode_index_buffer(encoded, c.count).map_err(failed)?),
        (_, 2) => little16(&meshopt::decode_index_sequence(encoded, c.count).map_err(failed)?),
        (_, _) => little32(&meshopt::decode_index_sequence(encoded, c.count).map_err(failed)?),
    };
    match c.filter.as_deref() {
        None | Some("NONE") => {}
        Some(filter) if c.mode != "ATTRIBUTES" => return Err(format!("meshopt filter {filter} on indices")),
        Some(filter) => apply(filter, c.byte_stride, &mut bytes)?,
    }
    Ok(bytes)
}

fn little16(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn little32(values: &[u32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// A vertex of `N` words, as the decoder takes its size from the type. The words hold the bytes as they lie in memory.
#[derive(Clone, Copy)]
struct Words<const N: usize>([u32; N]);

impl<const N: usize> Default for Words<N> {
    fn default() -> Self {
        Self([0; N])
    }
}

fn attributes(encoded: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, meshopt::Error> {
    fn of<const N: usize>(encoded: &[u8], count: usize) -> Result<Vec<u8>, meshopt::Error> {
        let vertices: Vec<Words<N>> = meshopt::decode_vertex_buffer(encoded, count)?;
        Ok(vertices.iter().flat_map(|v| v.0).flat_map(u32::to_ne_bytes).collect())
    }
    macro_rules! by_words {
        ($($n:literal)*) => {
            match stride / 4 {
                $($n => of::<$n>(encoded, count),)*
                _ => Err(meshopt::Error::Parse(format!("stride {stride}"))),
            }
        };
    }
    by_words!(
        1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32
        33 34 35 36 37 38 39 40 41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57 58 59 60 61 62 63 64
    )
}

/// Undoes a filter in place.
fn apply(filter: &str, stride: usize, bytes: &mut [u8]) -> Result<(), String> {
    match (filter, stride) {
        ("OCTAHEDRAL", 4) => {
            in_place(bytes, |b| b.map(|v| v as i8), |v| v.map(|v| v as u8), meshopt::decode_filter_oct);
        }
        ("OCTAHEDRAL", 8) => in_place(bytes, shorts, short_bytes, meshopt::decode_filter_oct),
        ("QUATERNION", 8) => in_place(bytes, shorts, short_bytes, meshopt::decode_filter_quat),
        ("COLOR", 4) => in_place(bytes, |b: [u8; 4]| b, |v| v, meshopt::decode_filter_color),
        ("COLOR", 8) => in_place(
            bytes,
            |b| shorts(b).map(|v| v as u16),
            |v| short_bytes(v.map(|v| v as i16)),
            meshopt::decode_filter_color,
        ),
        ("EXPONENTIAL", _) => {
            in_place(
                bytes,
                |b: [u8; 4]| [u32::from_le_bytes(b)],
                |[v]| v.to_le_bytes(),
                |d| {
                    meshopt::decode_filter_exp::<1>(d);
                },
            );
        }
        _ => return Err(format!("meshopt filter {filter} with stride {stride} is not known")),
    }
    Ok(())
}

fn in_place<const N: usize, T>(
    bytes: &mut [u8],
    read: impl Fn([u8; N]) -> T,
    write: impl Fn(T) -> [u8; N],
    filter: impl Fn(&mut [T]),
) where
    T: Copy,
{
    let mut values: Vec<T> = bytes.as_chunks::<N>().0.iter().map(|chunk| read(*chunk)).collect();
    filter(&mut values);
    for (chunk, value) in bytes.as_chunks_mut::<N>().0.iter_mut().zip(values) {
        *chunk = write(value);
    }
}

fn shorts(b: [u8; 8]) -> [i16; 4] {
    [0, 2, 4, 6].map(|i| i16::from_le_bytes([b[i], b[i + 1]]))
}

fn short_bytes(v: [i16; 4]) -> [u8; 8] {
    let [a, b, c, d] = v.map(i16::to_le_bytes);
    [a[0], a[1], b[0], b[1], c[0], c[1], d[0], d[1]]
}

#[cfg(test)]
mod tests;
