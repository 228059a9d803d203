use std::process::ExitCode;

use ivg_wire::{Error, Verdict};
use serde_json::json;

use crate::args::FileArguments;
use crate::failure::Failure;
use crate::files;
use crate::kind::FileKind;

pub(crate) fn run(arguments: &FileArguments) -> Result<ExitCode, Failure> {
    let bytes = files::read(&arguments.file)?;
    let kind = FileKind::of(&arguments.file, &bytes);
    let result = match kind {
        FileKind::Grid => check_grid(&bytes),
        FileKind::Mesh => check_mesh(&bytes),
    };
    let verdict = result.as_ref().err().map_or(Verdict::Ok, Error::verdict);
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
            "warnings": result.as_ref().map_or(&[][..], |found| &found.warnings),
        });
        files::print(&format!("{report}\n"))?;
    } else {
        let name = arguments.file.display();
        match &result {
            Err(error) => files::print(&format!("{name}: {verdict}: {error} [{}]\n", error.code()))?,
            Ok(found) => {
                files::print(&format!(
                    "{name}: {verdict}: {} bytes, {} parts, every checksum and reader rule holds\n",
                    bytes.len(),
                    found.parts,
                ))?;
                for warning in &found.warnings {
                    files::print(&format!("{name}: warning: {warning}\n"))?;
                }
            }
        }
    }
    Ok(ExitCode::from(verdict.exit_code()))
}

/// What a valid file holds.
#[derive(Default)]
struct Found {
    /// Chunks and records.
    parts: usize,
    /// Broken rules that concern writers only and do not change the verdict (COM-VERD-01).
    warnings: Vec<String>,
}

fn check_grid(bytes: &[u8]) -> Result<Found, Error> {
    let mut found = Found::default();
    let mut coverage = None;
    ivg_format::decode_all(bytes, &ivg_format::Limits::default(), |event| {
        found.parts += 1;
        if let ivg_format::Event::Header(header) = event
            && header.order == ivg_format::Order::Explicit
        {
            coverage = Some(Coverage::new(header));
        }
        if let Some(coverage) = &mut coverage {
            coverage.take(&event);
        }
        if let ivg_format::Event::Corners(bundle) | ivg_format::Event::Bundle(bundle) = event
            && let Some((vertex, hemisphere)) = bundle.outside_hemisphere()
        {
            let axis = ["+x", "-x", "+y", "-y", "+z", "-z"][hemisphere];
            found.warnings.push(format!(
                "record {:#x}: the {axis} direction of vertex {vertex} is not inside its hemisphere (IVG-PACK-03)",
                bundle.id().stored(),
            ));
        }
    })?;
    if let Some(coverage) = coverage {
        coverage.warn(&mut found.warnings);
    }
    Ok(found)
}

/// Which vertices a file of the order explicit brings (IVG-EXP-04).
struct Coverage {
    vertices: Vec<Brought>,
}

/// Whether a vertex breaks a rule.
type Breaks = fn(&Brought) -> bool;

/// What is known of a vertex.
#[derive(Clone, Copy, Default)]
struct Brought {
    once: bool,
    again: bool,
    /// Light does not reach it: it need not be brought.
    inside: bool,
}

impl Coverage {
    fn new(header: &ivg_format::Header) -> Self {
        // The decoder has accepted the number, which is within its limits.
        Self { vertices: vec![Brought::default(); header.lattice.vertex_count() as usize] }
    }

    fn take(&mut self, event: &ivg_format::Event<'_>) {
        match event {
            ivg_format::Event::Corners(bundle) | ivg_format::Event::Bundle(bundle) => {
                for vertex in bundle.vertices() {
                    let vertex = &mut self.vertices[vertex as usize];
                    vertex.again = vertex.once;
                    vertex.once = true;
                }
            }
            ivg_format::Event::Validity(block) => {
                let vertices = &mut self.vertices[block.first_vertex() as usize..];
                for (vertex, &validity) in vertices.iter_mut().zip(block.validity()) {
                    vertex.inside = validity == 0;
                }
            }
            _ => {}
        }
    }

    fn warn(&self, warnings: &mut Vec<String>) {
        let rules: [(&str, Breaks); 2] = [
            ("in no bundle although not inside geometry", |vertex| !vertex.once && !vertex.inside),
            ("in more than one bundle", |vertex| vertex.again),
        ];
        for (what, breaks) in rules {
            if let Some(first) = self.vertices.iter().position(breaks) {
                let more = match self.vertices[first + 1..].iter().filter(|vertex| breaks(vertex)).count() {
                    0 => String::new(),
                    count => format!(", and {count} more"),
                };
                warnings.push(format!("vertex {first} is {what}{more} (IVG-EXP-04)"));
            }
        }
    }
}

/// Checks every packet by replaying it.
fn check_mesh(bytes: &[u8]) -> Result<Found, Error> {
    let mut found = Found::default();
    let mut replay = pmesh_format::Replay::default();
    pmesh_format::decode_all(bytes, &pmesh_format::Limits::default(), |event| {
        found.parts += 1;
        replay.accept(&event).map(drop)
    })?;
    Ok(found)
}
