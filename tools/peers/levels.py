"""Random levels of every mesh, of raw and of coded files: are they valid meshes, and how many faces are turned over?"""

from __future__ import annotations

from pathlib import Path

import distance
import meshes
from commands import PeersError, progress
from project import Programs
from tables import markdown

COUNT = 200
SEED = 1
FORMS = {
    "raw f32": ("--mode", "raw", "--positions", "f32"),
    "coded f32": ("--mode", "coded", "--positions", "f32"),
    "coded q14": ("--mode", "coded", "--positions", "q14"),
    "coded q12": ("--mode", "coded", "--positions", "q12"),
}


def check(files: dict[str, Path], programs: Programs) -> tuple[str, int]:
    """The table, and how many files have a level that is not valid."""
    rows = []
    faults = 0
    for name, path in files.items():
        source = programs.out / "meshes" / f"{name}.ply"
        source.parent.mkdir(parents=True, exist_ok=True)
        meshes.write(source, meshes.read(path))
        for form, options in FORMS.items():
            progress(f"{name}: {form}")
            try:
                file, _ = programs.mesh(source, form.replace(" ", "-"), *options)
            except PeersError as error:
                progress(f"{name}: {form} is not there: {error}")
                rows.append([name, form, *["not written"] * 7])
                faults += 1
                continue
            sampled = file.with_suffix(".faces")
            found = programs.measure("levels", file, "--count", COUNT, "--seed", SEED, "-o", sampled)
            turned = distance.directions(source, sampled)
            faulty = [
                f"{fault} ({len(at)} levels, {min(at):,} to {max(at):,})"
                for fault, at in found["faults"].items()
            ]
            verdict = "; ".join(faulty) or "valid"
            inside = found["coincident_inside"]
            faults += bool(found["faults"])
            rows.append(
                [
                    name,
                    form,
                    f"{found['lowest']:,} to {found['highest']:,}, median {found['median']:,}",
                    f"{found['ends']:,}" if found["ends"] else "all are whole",
                    verdict,
                    f"{inside:,} of {COUNT}" if found["ends"] else "-",
                    f"{turned['turned']:.3f} %",
                    f"{turned['worst']:.1f} %",
                    f"{turned['faces']:,}",
                ]
            )
    columns = [
        "mesh",
        "file",
        "levels (vertices)",
        "ends of packets",
        "verdict",
        "coincident inside packets",
        "turned over",
        "worst level",
        "faces looked at",
    ]
    head = (
        f"# {COUNT} random levels of each file (seed {SEED})\n\n"
        "Valid: indices below the number of vertices, distinct corners, no corner that is a removed vertex; and, from 1 % of all "
        "vertices on, no two faces with the same corners at whole levels (PMESH-LVL-06): every level of a raw file; of a coded one "
        "the ends of its packets, each of which is looked at beside the random levels. Inside coded packets such faces are "
        "counted, not promised away. Turned over: the normal is more than 90 degrees off that of the nearest point of the "
        "original surface, by pymeshlab; at most 1,000 random faces of each level; thin parts count a face of the other "
        "side as turned over. The worst level is that of 100 faces or more.\n\n"
    )
    return head + markdown(columns, rows) + "\n", faults
