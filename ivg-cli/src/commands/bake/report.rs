//! What a bake says about its time and its error.

use std::time::Duration;

use ivg_bake::{AccuracyReport, CONFIDENCE, EndedBy};
use serde_json::{Value, json};

use crate::watch::StageTime;

pub(super) fn stage_json(time: &StageTime) -> Value {
    json!({
        "stage": time.name(),
        "seconds": time.wall.as_secs_f64(),
        "cpu_seconds": time.cpu.map(|cpu| cpu.as_secs_f64()),
    })
}

/// The parts of a bake that took so long in all, and what is left of that for what is no part of the bake.
pub(super) fn stages_text(times: &[StageTime], elapsed: Duration) -> String {
    let text = |time: &StageTime| {
        let cpu = time.cpu.map_or_else(String::new, |cpu| format!(" ({:.2} s of CPU)", cpu.as_secs_f64()));
        format!("{} {:.2} s{cpu}", time.name(), time.wall.as_secs_f64())
    };
    let rest = elapsed.saturating_sub(times.iter().map(|time| time.wall).sum());
    let parts = times.iter().map(text).collect::<Vec<_>>().join(", ");
    format!("{parts}, reading, planning and coding {:.2} s\n", rest.as_secs_f64())
}

pub(super) fn accuracy_json(report: &AccuracyReport) -> Value {
    json!({
        "asked": report.asked,
        "reached": report.reached,
        "confidence": CONFIDENCE,
        "noise": report.noise,
        "bias": report.bias,
        "ended_by": report.ended_by.name(),
        "batches": report.batches,
        "looks": report.looks,
        "vertices": report.vertices,
        "probes": report.probes,
        "gathered_biased": report.gathered_biased,
        "gathered_noisy": report.gathered_noisy,
        "noisy": report.noisy,
    })
}

pub(super) fn accuracy_text(report: &AccuracyReport) -> String {
    let percent = |share: f64| format!("{:.2} %", 100.0 * share);
    let [reached, asked, noise] = [report.reached, report.asked, report.noise].map(percent);
    let confidence = 100.0 * CONFIDENCE;
    let ended = report.ended_by.name();
    let mut text = match report.bias.map(percent) {
        Some(bias) => format!(
            "error at most {reached}, {asked} asked for, with {confidence:.0} % confidence: noise {noise}, bias {bias}; ended by {ended}\n"
        ),
        None => format!(
            "noise at most {reached}, {asked} asked for, with {confidence:.0} % confidence: noise {noise}, bias not known, since there \
             was no time to measure it; ended by {ended}\n"
        ),
    };
    text += &format!(
        "(root mean square over {} vertices, irradiance along the axes; noise from {} batches, bias from {} vertices)\n",
        report.vertices, report.batches, report.probes,
    );
    let vertices = [
        (report.gathered_biased, "path traced where averaging over cells is too biased"),
        (report.gathered_noisy, "path traced that photons left too noisy for their own brightness"),
        (report.noisy, "still too noisy for their own brightness"),
    ];
    for (count, what) in vertices.into_iter().filter(|(count, _)| *count > 0) {
        text += &format!("{count} vertices {what}\n");
    }
    text
}

/// What to do about a grid that is not as accurate as was asked for.
pub(super) fn advice(report: &AccuracyReport) -> String {
    let [reached, asked] = [report.reached, report.asked].map(|share| 100.0 * share);
    let what = match report.ended_by {
        EndedBy::Monitor => "the --time was up",
        _ => "the photons or paths allowed are spent",
    };
    if report.bias.is_none() {
        return format!(
            "noise alone is up to {reached:.2} %, {asked:.2} % was asked for, and bias is not known: {what}"
        );
    }
    format!("the error is up to {reached:.2} %, {asked:.2} % was asked for: {what}")
}
