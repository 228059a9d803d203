use std::process::ExitCode;

use ivg_stream::blocking::Session;
use ivg_stream::{Event, EventKind, FetchOptions, Goal};
use serde_json::json;

use crate::args::FetchArguments;
use crate::failure::Failure;
use crate::{files, table};

pub(crate) fn run(arguments: &FetchArguments) -> Result<ExitCode, Failure> {
    let options = FetchOptions::with_schedule(arguments.schedule.0);
    let as_json = arguments.json;
    let mut printed = Ok(());
    let mut log = |event: &Event| {
        // After the first line that cannot be written there is no use in more.
        if printed.is_ok() {
            printed = files::print(&if as_json { json_line(event) } else { text_line(event) });
        }
    };
    let mut session = Session::open(&arguments.url, options, &mut log).map_err(Failure::new)?;
    let goal = Goal { geometry: arguments.geometry, light: arguments.light };
    let progress = session.fetch_until(goal, &mut log).map_err(Failure::new)?;
    printed?;
    let seconds = progress.elapsed.as_secs_f64();
    if as_json {
        let figures = json!({
            "scene_bytes": progress.scene_bytes,
            "geometry_bytes": progress.geometry_bytes,
            "light_bytes": progress.light_bytes,
            "geometry": progress.geometry,
            "light": progress.light,
            "seconds": seconds,
        });
        files::print(&format!("{figures}\n"))?;
    } else {
        files::print(&format!(
            "{seconds:.3} s: scene {}, geometry {} ({:.1} % of the vertices), light {} ({:.1} % of the vertices)\n",
            table::bytes(progress.scene_bytes),
            table::bytes(progress.geometry_bytes),
            100.0 * progress.geometry,
            table::bytes(progress.light_bytes),
            100.0 * progress.light,
        ))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn text_line(event: &Event) -> String {
    let what = match &event.what {
        EventKind::Scene { bytes } => format!("scene, {bytes} bytes"),
        EventKind::Request { start, end } => format!("ask for bytes {start} to {end}"),
        EventKind::Prefix { bytes } => format!("header, {bytes} bytes"),
        EventKind::Part { index, bytes, vertices } => {
            format!("part {index}: {vertices} vertices in {bytes} bytes")
        }
        EventKind::Complete => "complete, digest right".to_owned(),
        EventKind::Broken { failures, reason } => format!("broken off ({reason}), try {failures}"),
        EventKind::Damaged { reason } => format!("damaged ({reason}), asked for again"),
        EventKind::Retagged => "new entity tag, same content".to_owned(),
        EventKind::Restarted => "changed on the server, begun anew".to_owned(),
        _ => return String::new(),
    };
    format!("{:>9.4} s  {}: {what}\n", event.elapsed.as_secs_f64(), event.file)
}

fn json_line(event: &Event) -> String {
    let mut line = json!({ "seconds": event.elapsed.as_secs_f64(), "file": event.file });
    let (name, details) = match &event.what {
        EventKind::Scene { bytes } => ("scene", json!({ "bytes": bytes })),
        EventKind::Request { start, end } => ("request", json!({ "start": start, "end": end })),
        EventKind::Prefix { bytes } => ("prefix", json!({ "bytes": bytes })),
        EventKind::Part { index, bytes, vertices } => {
            ("part", json!({ "index": index, "bytes": bytes, "vertices": vertices }))
        }
        EventKind::Complete => ("complete", json!({})),
        EventKind::Broken { failures, reason } => {
            ("broken", json!({ "failures": failures, "reason": reason }))
        }
        EventKind::Damaged { reason } => ("damaged", json!({ "reason": reason })),
        EventKind::Retagged => ("retagged", json!({})),
        EventKind::Restarted => ("restarted", json!({})),
        _ => return String::new(),
    };
    line["event"] = name.into();
    if let (Some(line), Some(details)) = (line.as_object_mut(), details.as_object()) {
        line.extend(details.clone());
    }
    format!("{line}\n")
}
