"""Distances between surfaces by pymeshlab, which shares no code with the project. A process of its own for each original:
the random numbers of pymeshlab then start anew, and the figures are the same in every run.

    python distance.py distances ORIGINAL SAMPLES SURFACE...
    python distance.py directions ORIGINAL ROWS
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any, TypedDict

import numpy as np


class Distance(TypedDict):
    """Symmetric distance between two surfaces in % of the diagonal of the original's bounds."""

    mean: float
    max: float


class Direction(TypedDict):
    """How many faces were looked at, and the share that is turned over [%]."""

    faces: int
    flipped: float
    worst: float


def distances(original: Path, samples: int, surfaces: list[Path]) -> list[Distance]:
    """Mean of the two one-sided means, maximum of the two maxima, with so many random points of the faces each way."""
    return _called("distances", original, str(samples), *surfaces)


def directions(original: Path, rows: Path) -> Direction:
    """Share of the faces of `rows` (level, centre, normal: seven floats each) whose normal is turned by more than 90
    degrees from that of the nearest point of the original; `worst` is that of the worst level."""
    return _called("directions", original, rows)


def _called(*words: str | Path) -> Any:
    command = [sys.executable, __file__, *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip()[-2000:]}")
    return json.loads(done.stdout.splitlines()[-1])


def _measure_distances(original: str, samples: str, surfaces: list[str]) -> list[Distance]:
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(original)
    diagonal = meshes.current_mesh().bounding_box().diagonal()
    half = pymeshlab.PercentageValue(50)
    found: list[Distance] = []
    for surface in surfaces:
        meshes.load_new_mesh(surface)
        other = meshes.current_mesh_id()
        ways = [
            meshes.get_hausdorff_distance(
                sampledmesh=sampled,
                targetmesh=target,
                samplevert=False,
                sampleedge=False,
                sampleface=True,
                samplenum=int(samples),
                maxdist=half,
            )
            for sampled, target in ((0, other), (other, 0))
        ]
        mean = sum(way["mean"] for way in ways) / 2
        found.append({"mean": 100 * mean / diagonal, "max": 100 * max(way["max"] for way in ways) / diagonal})
        meshes.set_current_mesh(other)
        meshes.delete_current_mesh()
    return found


def _measure_directions(original: str, rows: str) -> Direction:
    import pymeshlab

    table = np.fromfile(rows, dtype="<f4").reshape(-1, 7).astype(np.float64)
    levels, centres, normals = table[:, 0], table[:, 1:4], table[:, 4:7]
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(original)
    meshes.compute_normal_per_vertex()
    meshes.add_mesh(pymeshlab.Mesh(vertex_matrix=centres, v_normals_matrix=np.zeros_like(normals)))
    meshes.transfer_attributes_per_vertex(
        sourcemesh=0,
        targetmesh=1,
        normaltransfer=True,
        colortransfer=False,
        upperbound=pymeshlab.PercentageValue(100),
    )
    there = meshes.current_mesh().vertex_normal_matrix()
    flipped = np.einsum("ij,ij->i", there, normals) < 0
    shares = [flipped[levels == level].mean() for level in np.unique(levels)]
    return {"faces": len(table), "flipped": 100 * float(flipped.mean()), "worst": 100 * float(max(shares))}


def _main() -> None:
    kind, original, *rest = sys.argv[1:]
    if kind == "distances":
        print(json.dumps(_measure_distances(original, rest[0], rest[1:])))
    else:
        print(json.dumps(_measure_directions(original, rest[0])))


if __name__ == "__main__":
    _main()
