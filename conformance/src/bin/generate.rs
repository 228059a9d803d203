//! Writes the conformance vectors, their manifest, and the seeds of the fuzz targets:
//! `cargo run -p conformance --bin generate`. Files that it no longer makes are removed.

#![forbid(unsafe_code)]

use conformance::vectors::{GENERATED_FOLDERS, generated_files};
use std::path::Path;
use std::process::ExitCode;
use std::{fs, io};

fn main() -> ExitCode {
    match write() {
        Ok(summary) => {
            println!("{summary}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("cannot write the vectors: {error}");
            ExitCode::FAILURE
        }
    }
}

fn write() -> io::Result<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new(""));
    let files = generated_files();
    for folder in GENERATED_FOLDERS {
        match fs::remove_dir_all(root.join(folder)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
    }
    for (path, bytes) in &files {
        let path = root.join(path);
        fs::create_dir_all(path.parent().unwrap_or(root))?;
        fs::write(path, bytes)?;
    }
    let bytes: usize = files.iter().map(|(_, bytes)| bytes.len()).sum();
    Ok(format!("{} files, {bytes} bytes, in {}", files.len(), GENERATED_FOLDERS.join(" and ")))
}
