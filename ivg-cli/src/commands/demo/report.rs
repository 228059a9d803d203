//! The figures of the demo: a table for people, `demo.json` for programs.

use std::time::Duration;

use ivg_render::compare;
use ivg_stream::PackReport;
use serde_json::{Value, json};

use super::{Meshes, Shot};
use crate::baking::Baked;
use crate::failure::Failure;
use crate::table;

/// Bytes of a grid vertex as plain f32: six hemispheres, three channels, three components.
const PLAIN_VERTEX_BYTES: u64 = 6 * 3 * 3 * 4;

/// What the report is about.
#[derive(Debug)]
pub(super) struct Input<'a> {
    pub(super) scene: &'a str,
    pub(super) triangles: usize,
    pub(super) renderer: &'a str,
    pub(super) shots: &'a [Shot],
    pub(super) exposure: f32,
    pub(super) baked: &'a Baked,
    pub(super) meshes: &'a Meshes,
    pub(super) packed: &'a PackReport,
    pub(super) elapsed: Duration,
}

/// Figures, ready to be printed.
#[derive(Debug)]
pub(super) struct Report {
    json: Value,
    text: String,
}

/// How a picture differs from the last one.
struct Difference {
    /// Root mean square of the linear radiance differences \[W/(m² sr)\].
    rmse: f64,
    /// Mean CIE76 colour difference after the tone curve, divided by 100, as Web3D 2008 reports Lab differences.
    lab: f64,
}

impl Report {
    pub(super) fn new(input: &Input<'_>) -> Result<Self, Failure> {
        let reference = &input.shots.last().ok_or_else(|| Failure::new("no picture was drawn"))?.image;
        let mut rows = vec![
            ["", "geometry", "light", "vertices drawn", "streamed after", "RMSE", "Lab"]
                .map(str::to_owned)
                .to_vec(),
        ];
        let mut pictures = Vec::new();
        for shot in input.shots {
            let difference = Difference {
                rmse: compare::rmse(&shot.image, reference).map_err(Failure::new)?,
                lab: compare::cie76_exposed(&shot.image, reference, input.exposure).map_err(Failure::new)?,
            };
            rows.push(row(shot, &difference));
            pictures.push(picture(shot, &difference));
        }
        let files = FileSizes::new(input);
        let uploads: Vec<String> = input.shots.iter().filter_map(|s| s.uploaded).map(table::bytes).collect();
        let uploads = if uploads.is_empty() {
            String::new()
        } else {
            format!("Meshes uploaded for each picture: {}.\n", uploads.join(", "))
        };
        let text = format!(
            "\n{}\nRMSE [W/(m² sr)] and mean CIE76 difference / 100 are against d; drawn on {}.\n{uploads}\n{}\n{:.1} s in all.\n",
            table::layout(&rows, &[1, 2, 3, 4, 5, 6]),
            input.renderer,
            table::layout(&files.rows(), &[1, 2, 3]),
            input.elapsed.as_secs_f64(),
        );
        let json = json!({
            "scene": input.scene,
            "triangles": input.triangles,
            "renderer": input.renderer,
            "exposure": input.exposure,
            "pictures": pictures,
            "files": files.json(),
            "bake": {
                "photons": input.baked.stats.photons,
                "bounces": input.baked.plan.max_bounces,
                "seconds": input.baked.elapsed.as_secs_f64(),
            },
            "order_seconds": input.meshes.seconds,
            "seconds": input.elapsed.as_secs_f64(),
        });
        Ok(Self { json, text })
    }

    pub(super) fn json(&self) -> String {
        format!("{:#}\n", self.json)
    }

    pub(super) fn text(&self) -> String {
        self.text.clone()
    }
}

fn row(shot: &Shot, difference: &Difference) -> Vec<String> {
    let progress = &shot.progress;
    vec![
        shot.stage.caption.to_owned(),
        table::bytes(progress.geometry_bytes),
        table::bytes(progress.light_bytes),
        shot.vertices.to_string(),
        format!("{:.1} ms", progress.elapsed.as_secs_f64() * 1e3),
        format!("{:.4}", difference.rmse),
        format!("{:.4}", difference.lab),
    ]
}

fn picture(shot: &Shot, difference: &Difference) -> Value {
    let progress = &shot.progress;
    json!({
        "name": shot.stage.name,
        "file": format!("fig1-{}.png", shot.stage.name),
        "geometry_share": shot.stage.geometry,
        "light_share": shot.stage.light,
        "scene_bytes": progress.scene_bytes,
        "geometry_bytes": progress.geometry_bytes,
        "light_bytes": progress.light_bytes,
        "vertices_drawn": shot.vertices,
        "stream_seconds": progress.elapsed.as_secs_f64(),
        "uploaded_mesh_bytes": shot.uploaded,
        "render_seconds": shot.render_time.as_secs_f64(),
        "rmse": difference.rmse,
        "cie76_over_100": difference.lab,
    })
}

/// Files against what the same data take as plain arrays \[bytes\].
struct FileSizes {
    scene: u64,
    meshes: (u64, u64),
    grid: (u64, u64),
}

impl FileSizes {
    fn new(input: &Input<'_>) -> Self {
        let vertices = input.baked.grid.vertex_count() as u64;
        Self {
            scene: input.packed.scene_bytes,
            meshes: (input.packed.meshes.iter().map(|file| file.byte_length).sum(), input.meshes.plain_bytes),
            grid: (
                input.packed.grid.as_ref().map_or(0, |file| file.byte_length),
                vertices * PLAIN_VERTEX_BYTES,
            ),
        }
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let mut rows = vec![["file", "bytes", "plain arrays", "ratio"].map(str::to_owned).to_vec()];
        rows.push(vec!["scene.glb".to_owned(), table::bytes(self.scene), "-".to_owned(), "-".to_owned()]);
        for (name, (bytes, plain)) in [(".pmesh", self.meshes), ("light.ivg", self.grid)] {
            let ratio =
                if plain > 0 { format!("{:.3}", bytes as f64 / plain as f64) } else { "-".to_owned() };
            rows.push(vec![name.to_owned(), table::bytes(bytes), table::bytes(plain), ratio]);
        }
        rows
    }

    fn json(&self) -> Value {
        json!({
            "scene_glb": self.scene,
            "pmesh": { "bytes": self.meshes.0, "plain_bytes": self.meshes.1 },
            "ivg": { "bytes": self.grid.0, "plain_bytes": self.grid.1 },
        })
    }
}
