use std::path::Path;
use std::process::ExitCode;

use ivg_format::RecordId;
use ivg_wire::Step;
use serde_json::{Value, json};

use crate::args::FileArguments;
use crate::failure::Failure;
use crate::kind::FileKind;
use crate::rounding::Rounding;
use crate::{files, table};

/// What a file says about itself: fields for people and for programs, and its parts.
struct Description {
    fields: Vec<(&'static str, Value)>,
    parts: Vec<Part>,
    /// What the header only says the place of: it is neither read nor verified.
    unread: &'static str,
}

/// A chunk or a run of records.
struct Part {
    what: String,
    offset: u64,
    bytes: u64,
}

pub(crate) fn run(arguments: &FileArguments) -> Result<ExitCode, Failure> {
    let bytes = files::read(&arguments.file)?;
    let description = match FileKind::of(&arguments.file, &bytes) {
        FileKind::Grid => grid(&arguments.file, &bytes)?,
        FileKind::Mesh => mesh(&arguments.file, &bytes)?,
    };
    if arguments.json {
        let mut report: serde_json::Map<String, Value> =
            description.fields.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
        let parts: Vec<Value> = description
            .parts
            .iter()
            .map(|part| json!({ "part": part.what, "offset": part.offset, "bytes": part.bytes }))
            .collect();
        report.insert("parts".to_owned(), parts.into());
        report.insert(format!("{}_verified", description.unread), false.into());
        files::print(&format!("{}\n", Value::from(report)))?;
        return Ok(ExitCode::SUCCESS);
    }
    for (name, value) in &description.fields {
        files::print(&format!("{name:20} {}\n", files::shown(&plain(value))))?;
    }
    let mut rows = vec![["part", "offset", "bytes"].map(str::to_owned).to_vec()];
    rows.extend(
        description
            .parts
            .iter()
            .map(|part| vec![part.what.clone(), part.offset.to_string(), part.bytes.to_string()]),
    );
    files::print(&format!(
        "\n{}\nThe {} are not verified; ivg check verifies them.\n",
        table::layout(&rows, &[1, 2]),
        description.unread,
    ))?;
    Ok(ExitCode::SUCCESS)
}

/// A value as a person writes it: no quotes, lists with spaces.
fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(items) => items.iter().map(plain).collect::<Vec<_>>().join(" "),
        Value::Object(pairs) => {
            pairs.iter().map(|(key, value)| format!("{key}={}", plain(value))).collect::<Vec<_>>().join(" ")
        }
        other => other.to_string(),
    }
}

fn grid(path: &Path, bytes: &[u8]) -> Result<Description, Failure> {
    let refused = |error: ivg_format::Error| Failure::file(path, error);
    let mut decoder = ivg_format::Decoder::new(ivg_format::Limits::default());
    let (mut lights, mut metadata) = (Vec::new(), serde_json::Map::new());
    let mut parts = Vec::new();
    let mut description: Option<Vec<(&'static str, Value)>> = None;
    // Header and chunks only: the records follow from the header and need neither have arrived nor be whole.
    while decoder.header().is_none_or(|header| decoder.offset().0 < header.data_offset) {
        let offset = decoder.offset().0;
        let step = decoder.push(&bytes[offset as usize..]).map_err(refused)?;
        let Step::Consumed(used, event) = step else { break };
        match event {
            ivg_format::Event::Header(header) => {
                let length = u64::from(header.header_bytes);
                parts.push(Part { what: "header".to_owned(), offset, bytes: length });
                // The directory of the order explicit is read with the header.
                if used as u64 > length {
                    let what = format!("chunk {}", ivg_format::DIRECTORY);
                    parts.push(Part { what, offset: offset + length, bytes: used as u64 - length });
                }
                description = Some(grid_fields(header, bytes.len()));
            }
            ivg_format::Event::Chunk(chunk) => {
                parts.push(Part { what: format!("chunk {}", chunk.kind), offset, bytes: used as u64 });
                if chunk.kind == ivg_format::LIGHTS {
                    for light in ivg_format::lights(&chunk).map_err(refused)? {
                        lights.push(json!({ "name": light.name, "direct_included": light.direct_included }));
                    }
                } else if chunk.kind == ivg_format::METADATA {
                    let pairs = ivg_format::metadata(&chunk).map_err(refused)?;
                    metadata.extend(pairs.map(|(key, value)| (key.to_owned(), value.into())));
                }
            }
            _ => break,
        }
    }
    let (Some(mut fields), Some(header)) = (description, decoder.header()) else {
        return Err(Failure::file(path, "the file ends inside its header"));
    };
    fields.push(("lights", lights.into()));
    fields.push(("metadata", metadata.into()));
    for id in header.records() {
        let range = header.record_range(id);
        let what = match id {
            RecordId::Corners => "corners".to_owned(),
            RecordId::Validity(j) => format!("validity {j}"),
            RecordId::Bundle(k) => format!("bundle {k}"),
            _ => "end".to_owned(),
        };
        parts.push(Part { what, offset: range.start, bytes: range.end - range.start });
    }
    Ok(Description { fields, parts, unread: "records" })
}

fn grid_fields(header: &ivg_format::Header, length: usize) -> Vec<(&'static str, Value)> {
    let lattice = &header.lattice;
    let index_bytes: u64 = header.records().map(|id| header.index_bytes(id)).sum();
    vec![
        ("format", "ivg".into()),
        ("version", format!("{}.{}", ivg_format::MAJOR, header.minor).into()),
        ("content_id", format!("{:016x}", header.content_id.0).into()),
        ("file_bytes", header.file_bytes.into()),
        ("bytes_here", length.into()),
        ("prefix_bytes", header.data_offset.into()),
        ("dims", json!(lattice.dims)),
        ("first_vertex", json!(lattice.origin)),
        ("step", json!(lattice.step)),
        ("vertices", lattice.vertex_count().into()),
        ("units", header.units.name().into()),
        ("encoding", header.encoding.name().into()),
        ("quantity", header.encoding.quantity().name().into()),
        ("bytes_per_vertex", header.encoding.bytes_per_vertex().into()),
        ("scale_exponent", header.scale_exponent.into()),
        ("order", header.order.name().into()),
        ("vertices_per_slice", header.vertices_per_slice.into()),
        ("seed", header.seed.into()),
        ("bundles", header.bundle_count.into()),
        ("index_bytes", index_bytes.into()),
        ("validity_records", header.validity_records.into()),
    ]
}

fn mesh(path: &Path, bytes: &[u8]) -> Result<Description, Failure> {
    let refused = |error: ivg_format::Error| Failure::file(path, error);
    let mut decoder = pmesh_format::Decoder::new(pmesh_format::Limits::default());
    let mut parts = Vec::new();
    while decoder.header().is_none_or(|header| decoder.offset().0 < header.data_offset) {
        let offset = decoder.offset().0;
        let step = decoder.push(&bytes[offset as usize..]).map_err(refused)?;
        let Step::Consumed(used, event) = step else { break };
        let what = match event {
            pmesh_format::Event::Header(_) => "header, directory".to_owned(),
            pmesh_format::Event::Chunk(chunk) => format!("chunk {}", chunk.kind),
            _ => break,
        };
        parts.push(Part { what, offset, bytes: used as u64 });
    }
    let Some(header) = decoder.header() else {
        return Err(Failure::file(path, "the file ends inside its header"));
    };
    for k in 0..header.packet_count() {
        let range = header.packet_range(k);
        let entry = &header.packets[k as usize];
        let what = format!("packet {k}: levels to {}, error {} m", entry.vertices.end, entry.error);
        parts.push(Part { what, offset: range.start, bytes: range.end - range.start });
    }
    let end = header.end_range();
    parts.push(Part { what: "end".to_owned(), offset: end.start, bytes: end.end - end.start });
    Ok(Description { fields: mesh_fields(header, bytes.len()), parts, unread: "packets" })
}

/// To a tenth.
fn rounded(value: f64) -> Value {
    ((10.0 * value).round() / 10.0).into()
}

fn mesh_fields(header: &pmesh_format::Header, length: usize) -> Vec<(&'static str, Value)> {
    let attributes = header.attributes;
    let rounding = Rounding::of(header);
    let named = [
        ("normals", attributes.normals),
        ("texture coordinates", attributes.uvs),
        ("colours", attributes.colours),
        ("materials", attributes.materials),
        ("seams", attributes.seams),
    ];
    let present: Vec<&str> = named.into_iter().filter(|&(_, there)| there).map(|(name, _)| name).collect();
    vec![
        ("format", "pmesh".into()),
        ("version", format!("{}.{}", pmesh_format::MAJOR, header.minor).into()),
        ("content_id", format!("{:016x}", header.content_id.0).into()),
        ("file_bytes", header.file_bytes.into()),
        ("bytes_here", length.into()),
        ("prefix_bytes", header.data_offset.into()),
        ("vertices", header.vertex_count.into()),
        ("wedges", header.wedge_count.into()),
        ("faces", header.face_count.into()),
        ("base_vertices", header.base_vertices.into()),
        ("mode", header.mode.name().into()),
        ("positions", header.positions.name().into()),
        ("position_error_m", rounding.position.into()),
        ("bits_per_vertex", rounded(8.0 * header.file_bytes as f64 / f64::from(header.vertex_count.max(1)))),
        ("attributes", json!(present)),
        ("normal_bits", header.normal_bits.into()),
        ("normal_error_degrees", rounding.normal.into()),
        ("uv_bits", header.uv_bits.into()),
        ("uv_error", rounding.uv.into()),
        ("origin", json!(header.origin)),
        ("lower_bound", json!(header.bounds[0])),
        ("upper_bound", json!(header.bounds[1])),
        ("packets", header.packet_count().into()),
    ]
}
