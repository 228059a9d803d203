use std::process::ExitCode;

use serde_json::json;

use crate::args::{PackArguments, SCENE_POSITIONS};
use crate::baking::{self, LoadedScene};
use crate::failure::Failure;
use crate::{files, packing, table};

pub(crate) fn run(arguments: &PackArguments) -> Result<ExitCode, Failure> {
    // Before the bake, which takes long.
    arguments.storage.options(SCENE_POSITIONS)?;
    let loaded = LoadedScene::open(&arguments.scene)?;
    let baked = baking::bake(&loaded, &arguments.bake)?;
    let meshes = packing::order_meshes(&loaded.scene, arguments.coarse_vertices, &arguments.storage)?;
    let directory = &arguments.out;
    let report = packing::pack(&loaded.scene, &meshes, &baked.file, directory, arguments.coarse_vertices)?;
    if arguments.json {
        let entries = report.meshes.iter().chain(&report.grid);
        let files: Vec<_> = entries
            .map(|file| json!({ "uri": file.uri, "bytes": file.byte_length, "sha256": file.sha256_hex() }))
            .collect();
        let figures = json!({
            "directory": directory,
            "scene_bytes": report.scene_bytes,
            "files": files,
            "plain_mesh_bytes": meshes.plain_bytes,
            "rounding": meshes.rounding.json(),
            "seconds": { "bake": baked.elapsed.as_secs_f64(), "order": meshes.seconds },
        });
        files::print(&format!("{figures}\n"))?;
        return Ok(ExitCode::SUCCESS);
    }
    let mut rows = vec![vec!["file".to_owned(), "bytes".to_owned()]];
    rows.push(vec!["scene.glb".to_owned(), table::bytes(report.scene_bytes)]);
    rows.extend(
        report
            .meshes
            .iter()
            .chain(&report.grid)
            .map(|file| vec![file.uri.clone(), table::bytes(file.byte_length)]),
    );
    files::print(&format!(
        "{}\nmeshes: {}\nserve it with: ivg serve {}\n",
        table::layout(&rows, &[1]),
        meshes.rounding.text(),
        directory.display()
    ))?;
    Ok(ExitCode::SUCCESS)
}
