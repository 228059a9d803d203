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
from numpy.typing import NDArray

from commands import PeersError
from meshes import Mesh, write

# A level of fewer faces is not looked for as the worst one: a closed surface ends as two opposite triangles.
MANY_FACES = 100


class Distance(TypedDict):
    """Symmetric distance between two surfaces in % of the diagonal of the original's bounds, and the share of faces that are
    turned over [%]."""

    mean: float
    max: float
    turned: float


class Direction(TypedDict):
    """How many faces were looked at, and the share that is turned over [%]: of all, of the worst level."""

    faces: int
    turned: float
    worst: float


def distances(original: Path, samples: int, surfaces: list[Path]) -> list[Distance]:
    """Mean of the two one-sided means, with so many random points of the faces each way, and maximum of the two maxima, of these
    points, the vertices, and random points of the edges, as many as the original has vertices at least."""
    return _called("distances", original, str(samples), *surfaces)


def directions(original: Path, rows: Path) -> Direction:
    """Share of the faces of `rows` (level, centre, normal: seven floats each) that are turned over."""
    return _called("directions", original, rows)


def check(folder: Path) -> None:
    """Surfaces whose distance is known: a square, and the same lifted by a tenth of its diagonal and turned over.

    Raises PeersError if something else is measured: figures of this version of pymeshlab would not be what they are called.
    """
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
    square = Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]], np.uint32), 0)
    lift = np.float32(0.1 * np.sqrt(2))
    lifted = Mesh(corners + np.array([0, 0, lift], np.float32), square.triangles[:, ::-1], 0)
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / "square.ply", folder / "lifted.ply"]
    for path, mesh in zip(paths, (square, lifted)):
        write(path, mesh)
    found = distances(paths[0], 1000, paths)
    known: list[Distance] = [{"mean": 0, "max": 0, "turned": 0}, {"mean": 10, "max": 10, "turned": 100}]
    for measured, expected in zip(found, known):
        # Positions are 32-bit floats: six digits are right.
        if any(abs(measured[key] - expected[key]) > 1e-4 for key in ("mean", "max", "turned")):
            raise PeersError(f"distances are not what they should be: {measured} instead of {expected}")


def _called(*words: str | Path) -> Any:
    command = [sys.executable, __file__, *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip()[-2000:]}")
    return json.loads(done.stdout.splitlines()[-1])


def _measure_distances(original: str, samples: str, surfaces: list[str]) -> list[Distance]:
    import pymeshlab

    meshes = _loaded(original)
    diagonal = meshes.current_mesh().bounding_box().diagonal()
    vertices = meshes.current_mesh().vertex_number()
    half = pymeshlab.PercentageValue(50)
    found: list[Distance] = []
    for surface in surfaces:
        meshes.load_new_mesh(surface)
        other = meshes.current_mesh_id()
        # Means over the faces; what sticks out is small, so maxima count its vertices and edges too.
        faces, edges = (
            [
                meshes.get_hausdorff_distance(
                    sampledmesh=sampled,
                    targetmesh=target,
                    samplevert=not of_faces,
                    sampleedge=not of_faces,
                    sampleface=of_faces,
                    samplenum=int(samples) if of_faces else max(int(samples), vertices),
                    maxdist=half,
                )
                for sampled, target in ((0, other), (other, 0))
            ]
            for of_faces in (True, False)
        )
        mean, greatest = sum(way["mean"] for way in faces) / 2, max(way["max"] for way in faces + edges)
        meshes.set_current_mesh(other)
        mesh = meshes.current_mesh()
        corners = mesh.vertex_matrix()[mesh.face_matrix()]
        meshes.delete_current_mesh()
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        some = np.any(normals != 0, axis=1)
        turned = _turned(meshes, corners.mean(axis=1)[some], normals[some])
        share = 100 * float(turned.mean())
        found.append({"mean": 100 * mean / diagonal, "max": 100 * greatest / diagonal, "turned": share})
    return found


def _measure_directions(original: str, rows: str) -> Direction:
    table = np.fromfile(rows, dtype="<f4").reshape(-1, 7).astype(np.float64)
    levels = table[:, 0]
    turned = _turned(_loaded(original), table[:, 1:4], table[:, 4:7])
    shares = [
        turned[levels == level].mean() for level in np.unique(levels) if (levels == level).sum() >= MANY_FACES
    ]
    worst = 100 * float(max(shares, default=0))
    return {"faces": len(table), "turned": 100 * float(turned.mean()), "worst": worst}


def _loaded(original: str) -> Any:
    """The original as the first mesh of a set, with normals."""
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(original)
    meshes.compute_normal_per_vertex()
    return meshes


def _turned(meshes: Any, centres: NDArray[np.float64], normals: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which normals are more than 90 degrees off that of the nearest point of the original, the first mesh of the set."""
    import pymeshlab

    meshes.add_mesh(pymeshlab.Mesh(vertex_matrix=centres, v_normals_matrix=np.zeros_like(normals)))
    meshes.transfer_attributes_per_vertex(
        sourcemesh=0,
        targetmesh=meshes.current_mesh_id(),
        normaltransfer=True,
        colortransfer=False,
        upperbound=pymeshlab.PercentageValue(100),
    )
    there = meshes.current_mesh().vertex_normal_matrix()
    meshes.delete_current_mesh()
    return np.einsum("ij,ij->i", there, normals) < 0


def _main() -> None:
    kind, original, *rest = sys.argv[1:]
    if kind == "distances":
        print(json.dumps(_measure_distances(original, rest[0], rest[1:])))
    else:
        print(json.dumps(_measure_directions(original, rest[0])))


if __name__ == "__main__":
    _main()
