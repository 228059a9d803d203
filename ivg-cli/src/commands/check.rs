use std::process::ExitCode;

use ivg_wire::{Error, Verdict};
use serde_json::json;

use crate::args::FileArguments;
use crate::failure::Failure;
use crate::files;
use crate::kind::FileKind;

pub(crate) fn run(arguments: &FileArguments) -> Result<ExitCode, Failure> {
    let bytes = files::read(&arguments.file)?;
    let kind = FileKind::of(&arguments.file, &bytes)?;
    let result = match kind {
        FileKind::Grid => check_grid(&bytes),
        FileKind::Mesh => check_mesh(&bytes),
    };
    let (verdict, parts) = match &result {
        Ok(parts) => (Verdict::Ok, Some(*parts)),
        Err(error) => (error.verdict(), None),
    };
    if arguments.json {
        let report = json!({
            "file": arguments.file,
            "format": match kind { FileKind::Grid => "ivg", FileKind::Mesh => "pmesh" },
            "verdict": verdict.name(),
            "bytes": bytes.len(),
            "code": result.as_ref().err().map(Error::code),
            "clause": result.as_ref().err().map(Error::clause),
            "offset": result.as_ref().err().map(|error| error.offset().0),
            "message": result.as_ref().err().map(ToString::to_string),
        });
        files::print(&format!("{report}\n"));
    } else {
        let name = arguments.file.display();
        match (&result, parts) {
            (Err(error), _) => files::print(&format!("{name}: {verdict}: {error} [{}]\n", error.code())),
            (Ok(_), parts) => files::print(&format!(
                "{name}: {verdict}: {} bytes, {} parts, every checksum and rule holds\n",
                bytes.len(),
                parts.unwrap_or(0),
            )),
        }
    }
    Ok(ExitCode::from(verdict.exit_code()))
}

/// Number of chunks and records of a grid file, all checked.
fn check_grid(bytes: &[u8]) -> Result<usize, Error> {
    let mut parts = 0;
    ivg_format::decode_all(bytes, &ivg_format::Limits::default(), |_| parts += 1)?;
    Ok(parts)
}

/// Number of chunks and packets of a mesh file, all checked, and every packet replayed.
fn check_mesh(bytes: &[u8]) -> Result<usize, Error> {
    let limits = pmesh_format::Limits::default();
    pmesh_format::check(bytes, &limits)?;
    let mut parts = 0;
    pmesh_format::decode_all(bytes, &limits, |_| parts += 1)?;
    Ok(parts)
}
