use std::process::ExitCode;

use ivg_bake::BakeOptions;
use ivg_scene::{Need, PlanOptions, PlannedEffect};
use serde_json::json;

use crate::args::PlanArguments;
use crate::baking::{self, LoadedScene};
use crate::failure::Failure;
use crate::{files, table};

/// Characters of a line.
const LINE: usize = 100;

pub(crate) fn run(arguments: &PlanArguments) -> Result<ExitCode, Failure> {
    let loaded = LoadedScene::open(&arguments.scene)?;
    let options = BakeOptions { photons: arguments.photons, ..BakeOptions::default() };
    let usual = baking::planning_for(arguments.effects, arguments.accuracy);
    let planning = match arguments.energy_cutoff {
        Some(energy_cutoff) => PlanOptions { energy_cutoff, ..usual },
        None => usual,
    };
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
        table::layout_within(&rows, &[2, 3], LINE)
    ))?;
    match pilot {
        Some(pilot) => files::print(&format!(
            "\nUp to {} bounces: the rest is below {} % of the light energy.\nCosts are for {} photons on a 16x16x16 grid, measured with {} photons;\nin brackets, what an effect left out would cost.\n",
            plan.max_bounces,
            (1e8 * plan.energy_cutoff).round() / 1e6,
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
