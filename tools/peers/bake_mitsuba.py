"""The indirect light of points in a box by Mitsuba 3: every point is path-traced, as someone without a baker would do it.

    bake_mitsuba.py SCENE.obj POINTS.json --samples N [--runs N]

POINTS.json holds `points`, `vectors` and `standard_error` as the example `oracle_error` of ivg-bake writes them. Prints JSON. A
program of its own, because a missing or unfit LLVM ends the process, and so that processor time is that of Mitsuba alone."""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import time
from pathlib import Path
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

# Reflections followed, and those after which Russian roulette may end a path.
DEPTH, ROULETTE = 64, 5
# The most rays of a wavefront: beyond, memory is waited for.
WAVEFRONT = 1 << 21
# The seed of each run.
SEEDS = (1, 2, 3, 4, 5)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", type=Path)
    parser.add_argument("points", type=Path)
    parser.add_argument("--samples", type=int, required=True, help="paths of a point, a power of 4")
    parser.add_argument("--runs", type=int, default=1, help="how often, with other seeds")
    options = parser.parse_args()
    mi.set_variant("llvm_ad_rgb")
    dr.set_thread_count(1)
    data = json.loads(options.points.read_text())
    points = np.array(data["points"])
    truth, error = _axes(np.array(data["vectors"])), _axes(np.array(data["standard_error"]))
    scene = mi.load_dict(_scene(options.scene))
    figures: dict[str, Any] = {"version": mi.__version__, "drjit": dr.__version__, "points": len(points)}
    rows = []
    for sampler in ("independent", "multijitter"):
        # The first call compiles.
        start = time.process_time()
        _irradiance(scene, points, options.samples, sampler, 0)
        first = time.process_time() - start
        seconds, squares, ratios, found = [], [], [], []
        for seed in SEEDS[: options.runs]:
            start = time.process_time()
            found.append(_irradiance(scene, points, options.samples, sampler, seed))
            seconds.append(time.process_time() - start)
            # The oracle's own variance is not Mitsuba's error.
            squares.append(float(((found[-1] - truth) ** 2 - error**2).sum() / (truth**2).sum()))
        mean = np.mean(found, axis=0)
        ratios = mean.sum() / truth.sum()
        rows.append(
            {
                "sampler": sampler,
                "samples": options.samples,
                "cpu_seconds": statistics.median(seconds),
                "first_cpu_seconds": first,
                "error": max(statistics.mean(squares), 0.0) ** 0.5,
                "ratio": float(ratios),
                **_agreement(np.array(found), truth, error),
            }
        )
    print(json.dumps(figures | {"rows": rows}))


def _agreement(found: NDArray[Any], truth: NDArray[Any], error: NDArray[Any]) -> dict[str, float]:
    """How far Mitsuba's mean is from the oracle, and how far noise alone would put it; relative, as root mean squares."""
    mean = found.mean(axis=0)
    own = found.var(axis=0, ddof=1) / len(found) if len(found) > 1 else np.zeros_like(mean)
    signal = (truth**2).sum()
    return {
        "difference": float((((mean - truth) ** 2).sum() / signal) ** 0.5),
        "noise": float(((own + error**2).sum() / signal) ** 0.5),
    }


def _axes(vectors: NDArray[Any]) -> NDArray[Any]:
    """Irradiance along the axes: of hemisphere h the component of axis h / 2, for each colour, without its sign."""
    return np.stack([np.abs(vectors[:, h, :, h // 2]) for h in range(6)], axis=1)


def _irradiance(scene: Any, points: NDArray[Any], samples: int, kind: str, seed: int) -> NDArray[Any]:
    """Indirect irradiance along +x -x +y -y +z -z, shape (points, 6, 3) [W/m2]. Directions are even over the sphere, so that
    each serves three of the six; the light that a ray sees itself is left out."""
    integrator = mi.load_dict(
        {"type": "path", "max_depth": DEPTH, "rr_depth": ROULETTE, "hide_emitters": True}
    )
    at_once = max(1, WAVEFRONT // samples)
    parts = []
    for first in range(0, len(points), at_once):
        some = points[first : first + at_once].astype(np.float32)
        count = len(some)
        sampler = mi.load_dict({"type": kind, "sample_count": samples, "seed": seed * 65536 + first})
        sampler.set_samples_per_wavefront(samples)
        sampler.seed(seed * 65536 + first, count * samples)
        index = dr.arange(mi.UInt32, count * samples) // samples
        origin = dr.gather(mi.Point3f, mi.Point3f(*(mi.Float(some[:, a].copy()) for a in range(3))), index)
        direction = mi.warp.square_to_uniform_sphere(sampler.next_2d())
        radiance, _, _ = integrator.sample(scene, sampler, mi.RayDifferential3f(mi.Ray3f(origin, direction)))
        sums = [dr.zeros(mi.Color3f, count) for _ in range(6)]
        for side in range(6):
            cosine = direction[side // 2] * (1 if side % 2 == 0 else -1)
            dr.scatter_add(sums[side], radiance * dr.maximum(cosine, 0), index)
        dr.eval(sums)
        parts.append(np.stack([np.array(s).T for s in sums], axis=1) * (4 * np.pi / samples))
    return np.concatenate(parts)


def _scene(path: Path) -> dict[str, Any]:
    """A Wavefront scene of triangles with its .mtl file, for Mitsuba: even reflection on both sides, lights on the front."""
    materials = _materials(path)
    points: list[list[float]] = []
    faces: dict[str, list[list[int]]] = {}
    current: list[list[int]] = faces.setdefault("", [])
    for line in path.read_text().splitlines():
        words = line.split()
        match words[:1]:
            case ["v"]:
                points.append([float(word) for word in words[1:4]])
            case ["usemtl"]:
                current = faces.setdefault(words[1], [])
            case ["f"]:
                corners = [int(word.split("/")[0]) - 1 for word in words[1:]]
                current += [[corners[0], b, c] for b, c in zip(corners[1:], corners[2:])]
    scene: dict[str, Any] = {"type": "scene"}
    for name, triangles in faces.items():
        if triangles:
            reflected, emitted = materials[name]
            scene[f"shape-{name}"] = _mesh(np.array(points), np.array(triangles), reflected, emitted)
    return scene


def _mesh(points: NDArray[Any], triangles: NDArray[Any], reflected: list[float], emitted: list[float]) -> Any:
    bsdf = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": reflected}}}
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(bsdf)
    if any(emitted):
        properties["emitter"] = mi.load_dict(
            {"type": "area", "radiance": {"type": "rgb", "value": emitted}}
        )
    mesh = mi.Mesh("mesh", len(points), len(triangles), props=properties)
    values = mi.traverse(mesh)
    values["vertex_positions"] = points.astype(np.float32).ravel()
    values["faces"] = triangles.astype(np.uint32).ravel()
    values.update()
    return mesh


def _materials(path: Path) -> dict[str, tuple[list[float], list[float]]]:
    """Kd and Ke of each material; colours are linear RGB."""
    found: dict[str, tuple[list[float], list[float]]] = {}
    library = next(line.split()[1] for line in path.read_text().splitlines() if line.startswith("mtllib"))
    name = ""
    for line in (path.parent / library).read_text().splitlines():
        words = line.split()
        if words[:1] == ["newmtl"]:
            name = words[1]
            found[name] = ([0.5] * 3, [0.0] * 3)
        elif words[:1] in (["Kd"], ["Ke"]):
            found[name][words[0] == "Ke"][:] = [float(word) for word in words[1:4]]
    return found


if __name__ == "__main__":
    sys.exit(main())
