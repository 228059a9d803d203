//! From the path of a request to a file inside one directory, and the rule for URIs inside `scene.glb`.

/// The names of a request path, decoded; `None` if the path could lead outside the directory it is resolved in,
/// names a hidden file, or is malformed.
///
/// Each name is non-empty, valid UTF-8 without control characters, slash and backslash, and does not begin with
/// a dot, which excludes `.` and `..`, however they were escaped. A colon is refused as well: it begins a drive
/// or a stream on some systems.
pub(crate) fn names(path: &str) -> Option<Vec<String>> {
    let path = path.strip_prefix('/')?;
    path.split('/').map(|part| decode(part).filter(|name| is_plain(name))).collect()
}

fn is_plain(name: &str) -> bool {
    let forbidden = |c: char| c.is_control() || matches!(c, '/' | '\\' | ':');
    !name.is_empty() && !name.starts_with('.') && !name.contains(forbidden)
}

/// Undoes percent-encoding once.
fn decode(part: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(part.len());
    let mut rest = part.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'%' => hex_digit(rest.next()?)? << 4 | hex_digit(rest.next()?)?,
            other => other,
        });
    }
    String::from_utf8(bytes).ok()
}

fn hex_digit(byte: u8) -> Option<u8> {
    char::from(byte).to_digit(16).and_then(|digit| u8::try_from(digit).ok())
}

/// Whether a URI inside `scene.glb` may be followed, `spec/gltf-extensions.md` GLT-URI-01: names of unreserved
/// characters divided by single slashes, none beginning with a dot.
pub(crate) fn is_safe_uri(uri: &str) -> bool {
    const LONGEST: usize = 1024;
    let unreserved = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'-' | b'.' | b'_' | b'~');
    uri.len() <= LONGEST
        && uri
            .split('/')
            .all(|name| !name.is_empty() && !name.starts_with('.') && name.bytes().all(unreserved))
}

#[cfg(test)]
mod tests;
