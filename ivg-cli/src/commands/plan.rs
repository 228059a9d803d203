use std::process::ExitCode;

use ivg_bake::BakeOptions;
use ivg_scene::{Need, PlanOptions, PlannedEffect};
use serde_json::json;

use crate::args::PlanArguments;
use crate::baking::{self, LoadedScene};
use crate::failure::Failure;
use crate::{files, table};

pub(crate) fn run(arguments: &PlanArguments) -> Result<ExitCode, Failure> {
    let loaded = LoadedScene::open(&arguments.scene)?;
    let options = BakeOptions { photons: arguments.photons, ..BakeOptions::default() };
    let planning =
        PlanOptions { energy_cutoff: arguments.energy_cutoff, ..baking::planning(arguments.effects) };
    let (plan, pilot) = baking::plan(&loaded, planning, &options)?;
    if arguments.json {
        let effects: Vec<_> = plan
            .effects
            .iter()
            .map(|planned| {
                json!({
                    "effect": planned.effect.name(),
                    "need": need(planned.need),
                    "reason": planned.reason,
                    "cpu_seconds": planned.cost.map(|cost| cost.seconds),
                    "energy_share": planned.cost.map(|cost| cost.energy_share),
                })
            })
            .collect();
        let report = json!({
            "scene": loaded.scene.name,
            "triangles": loaded.flat.triangles.len(),
            "effects": effects,
            "max_bounces": plan.max_bounces,
            "energy_cutoff": plan.energy_cutoff,
            "energy_by_bounce": pilot.as_ref().map(|pilot| &pilot.energy_by_bounce),
            "photons": arguments.photons,
            "pilot_photons": pilot.as_ref().map(|pilot| pilot.photons),
            "unsupported": loaded.scene.unsupported.iter()
                .map(|item| json!({ "object": item.object, "what": item.what })).collect::<Vec<_>>(),
        });
        files::print(&format!("{report}\n"))?;
        return Ok(ExitCode::SUCCESS);
    }
    let mut rows = vec![["effect", "", "CPU s", "energy", "why"].map(str::to_owned).to_vec()];
    rows.extend(plan.effects.iter().map(row));
    files::print(&format!(
        "{}: {} triangles\n\n{}",
        loaded.scene.name,
        loaded.flat.triangles.len(),
        table::layout(&rows, &[2, 3])
    ))?;
    match pilot {
        Some(pilot) => files::print(&format!(
            "\nUp to {} bounces: the rest is below {} % of the light energy.\nCosts are for {} photons on a 16x16x16 grid, measured with {} photons; in brackets, what an effect left out would cost.\n",
            plan.max_bounces,
            100.0 * plan.energy_cutoff,
            arguments.photons,
            pilot.photons,
        ))?,
        None => {
            files::print(
                "\nThe scene has no light; add one with --lights FILE.toml. No cost was measured.\n",
            )?;
        }
    }
    for item in &loaded.scene.unsupported {
        files::print(&format!(
            "not supported: {}: {}\n",
            files::shown(&item.object),
            files::shown(&item.what)
        ))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn row(planned: &PlannedEffect) -> Vec<String> {
    let cost =
        |text: fn(&ivg_scene::Cost) -> String| planned.cost.as_ref().map_or_else(|| "-".to_owned(), text);
    vec![
        planned.effect.name().to_owned(),
        need(planned.need).to_owned(),
        match (planned.need, planned.cost) {
            (Need::NotNeeded, Some(cost)) => format!("({:.2})", cost.seconds),
            _ => cost(|cost| format!("{:.2}", cost.seconds)),
        },
        cost(|cost| format!("{:.1} %", 100.0 * cost.energy_share)),
        planned.reason.clone(),
    ]
}

fn need(need: Need) -> &'static str {
    match need {
        Need::Needed => "needed",
        Need::NotNeeded => "not needed",
        Need::Unsupported => "unsupported",
    }
}
