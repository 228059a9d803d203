//! `cargo xtask conformance-zip`: the conformance suite as one file, for people who have neither this repository nor Rust. The same
//! sources give the same bytes: files are sorted, stored as they are, and have no dates.

use std::io;
use std::path::Path;
use std::process::Command;

/// The folder that the archive unpacks into.
pub const FOLDER: &str = "ivg-conformance";

/// The page that one reads first.
const PAGE: &str = "conformance/ARCHIVE.md";

/// What else goes into the archive: paths from the root of the repository, which are the same there, so that what one document says
/// of another is true. A folder is taken whole.
const PARTS: [&str; 11] = [
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "conformance/LICENSE",
    "conformance/PROTOCOL.md",
    "conformance/README.md",
    "conformance/adapters/",
    "conformance/manifest.schema.json",
    "conformance/ports/",
    "conformance/run.py",
    "conformance/vectors/",
    "spec/",
];

/// The files of the archive, by name: those that git knows.
///
/// # Errors
///
/// git cannot list them; one of them cannot be read.
pub fn files(root: &Path) -> io::Result<Vec<(String, Vec<u8>)>> {
    let listed =
        Command::new("git").arg("-C").arg(root).args(["ls-files", "-z", PAGE]).args(PARTS).output()?;
    if !listed.status.success() {
        return Err(io::Error::other(String::from_utf8_lossy(&listed.stderr).into_owned()));
    }
    let mut files = Vec::new();
    for path in String::from_utf8_lossy(&listed.stdout).split_terminator('\0') {
        let name = if path == PAGE { "README.md" } else { path };
        files.push((format!("{FOLDER}/{name}"), std::fs::read(root.join(path))?));
    }
    files.sort();
    Ok(files)
}

/// Version 1.0 of the format is enough to store files; the date is the first that it has, 1 January 1980.
const VERSION: u16 = 10;
const DATE: u16 = 1 << 5 | 1;
/// The upper half of the attributes is that of Unix: a regular file that everyone may read, and run if it says with what.
const MADE_ON_UNIX: u16 = 3 << 8 | VERSION;
const PLAIN: u32 = 0o100_644 << 16;
const PROGRAM: u32 = 0o100_755 << 16;

/// A ZIP archive of these files, stored as they are.
///
/// # Errors
///
/// More files or bytes than the format has place for.
pub fn zip(files: &[(String, Vec<u8>)]) -> io::Result<Vec<u8>> {
    let long = |what: usize| u32::try_from(what).map_err(|_| io::Error::other("too long for an archive"));
    let short = |what: usize| u16::try_from(what).map_err(|_| io::Error::other("too many for an archive"));
    let (mut archive, mut directory) = (Vec::new(), Vec::new());
    for (name, bytes) in files {
        let offset = long(archive.len())?;
        let mut common = Vec::new();
        // Version needed, flags, method, time, date.
        common.extend([VERSION, 0, 0, 0, DATE].into_iter().flat_map(u16::to_le_bytes));
        common.extend(
            [crc32(bytes), long(bytes.len())?, long(bytes.len())?].into_iter().flat_map(u32::to_le_bytes),
        );
        // Lengths of the name and of nothing more.
        common.extend([short(name.len())?, 0].into_iter().flat_map(u16::to_le_bytes));
        archive.extend(b"PK\x03\x04");
        archive.extend(&common);
        archive.extend(name.bytes());
        archive.extend(bytes);
        directory.extend(b"PK\x01\x02");
        directory.extend(MADE_ON_UNIX.to_le_bytes());
        directory.extend(&common);
        // Length of a remark, number of the disk, attributes inside.
        directory.extend([0; 6]);
        let attributes = if bytes.starts_with(b"#!") { PROGRAM } else { PLAIN };
        directory.extend([attributes, offset].into_iter().flat_map(u32::to_le_bytes));
        directory.extend(name.bytes());
    }
    let (offset, length, count) = (long(archive.len())?, long(directory.len())?, short(files.len())?);
    archive.extend(directory);
    archive.extend(b"PK\x05\x06");
    archive.extend([0, 0, count, count].into_iter().flat_map(u16::to_le_bytes));
    archive.extend([length, offset].into_iter().flat_map(u32::to_le_bytes));
    archive.extend([0; 2]);
    Ok(archive)
}

/// CRC-32/ISO-HDLC, bit by bit: there are few megabytes.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| crc >> 1 ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 })
    };
    !bytes.iter().fold(!0, step)
}

#[cfg(test)]
mod tests;
