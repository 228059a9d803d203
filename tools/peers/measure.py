"""All figures of one mesh, of the project and of its peers."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import DracoPy
import fast_simplification
import numpy as np

import distance
import meshes
from commands import PeersError, progress
from meshes import Mesh
from project import Figures, Programs

# Positions of so many bits along the longest side; Draco's rule, the same for all.
BITS = (12, 14)
# Shares of the faces at which surfaces are compared [%].
SHARES = (10.0, 2.0, 1.0, 0.2)
# Vertices of the raw packets whose bytes are compared with plain arrays.
RAW_PACKETS = (250, 5000)
DRACO_LEVEL = 7
# Simplifiers beside meshopt_simplify, which do something else: drop components, cluster, move vertices.
OTHERS = ("meshopt-prune", "meshopt-sloppy", "fast-simplification")
# Random points of the faces for a distance, each way.
SAMPLES = 100_000
# How often decoding is timed; the median counts.
RUNS = 15


@dataclass(frozen=True)
class Effort:
    """How long to measure."""

    runs: int = RUNS
    samples: int = SAMPLES
    others: bool = True

    @staticmethod
    def quick() -> Effort:
        """For a look: a tenth of the samples, few repetitions, no further simplifiers."""
        return Effort(runs=3, samples=SAMPLES // 10, others=False)


def mesh(name: str, path: Path, programs: Programs, effort: Effort) -> Figures:
    """Measures one mesh; what each part holds is said by the function of its name."""
    source = meshes.read(path)
    meant = next(known.size for known in meshes.SOURCES if known.name == name)
    if meant != (source.vertices, source.faces):
        progress(f"{name}: not the version that published figures are of, which has {meant[0]:,} vertices")
    plain = programs.out / "meshes" / f"{name}.ply"
    plain.parent.mkdir(parents=True, exist_ok=True)
    meshes.write(plain, source)
    figures: Figures = {
        "vertices": source.vertices,
        "faces": source.faces,
        "unreferenced": source.unreferenced,
        "plain_bytes": source.plain_bytes,
    }
    parts: list[tuple[str, Callable[[], Any]]] = [
        ("project", lambda: _project(plain, programs, effort)),
        ("meshopt", lambda: _meshopt(plain, programs, effort)),
        ("draco", lambda: _draco(source, effort)),
        ("surfaces", lambda: _surfaces(plain, source, programs, effort)),
    ]
    for part, measured in parts:
        start = time.monotonic()
        figures[part] = measured()
        progress(f"{name}: {part} in {time.monotonic() - start:.0f} s")
    first = programs.out / "simple" / f"{name}.meshopt.1.ply"
    figures["draco"]["first_bytes"] = len(_draco_bytes(meshes.read(first), 14))
    return figures


def _project(plain: Path, programs: Programs, effort: Effort) -> Figures:
    """Each way of writing the mesh: bytes, decoding time, order time, memory of the replay. A way that `ivg mesh` refuses is
    `None`."""
    forms: dict[str, list[str]] = {
        f"coded q{bits}": ["--mode", "coded", "--positions", f"q{bits}"] for bits in BITS
    }
    forms["coded f32"] = ["--mode", "coded", "--positions", "f32"]
    forms["raw q14"] = ["--mode", "raw", "--positions", "q14"]
    forms["coded q14, one packet"] = [*forms["coded q14"], "--packet", str(2**30)]
    forms["raw f32"] = ["--mode", "raw", "--positions", "f32"]
    forms["raw f32, one packet"] = [*forms["raw f32"], "--packet", str(2**30)]
    for packet in RAW_PACKETS:
        forms[f"raw f32, {packet} a packet"] = [*forms["raw f32"], "--packet", str(packet)]
    figures: Figures = {}
    for form, options in forms.items():
        try:
            path, written = programs.mesh(plain, form.replace(", ", ".").replace(" ", "-"), *options)
        except PeersError as error:
            # The other forms are worth having.
            progress(f"{plain.stem}: {form} is not there: {error}")
            figures[form] = None
            continue
        bits = next((bits for bits in BITS if f"q{bits}" in form), 0)
        timed = form in ("coded q14", "raw f32", "raw f32, one packet")
        read = programs.measure("stream", path, "--runs", effort.runs if timed else 1)
        figures[form] = read | {key: written[key] for key in ("order_seconds", "order_wall_seconds")}
        figures[form] |= _same(plain, path, bits, programs)
        if timed:
            figures[form] |= programs.replay_memory(path)
    return figures


def _same(plain: Path, file: Path, bits: int, programs: Programs) -> Figures:
    """Whether the finest level is the mesh that went in."""
    finest = programs.out / "finest.ply"
    programs.extract(file, None, finest)
    # The one form that the measuring program reads.
    meshes.write(finest, meshes.read(finest))
    return programs.measure("same", plain, finest, "--bits", bits)


def _meshopt(plain: Path, programs: Programs, effort: Effort) -> Figures:
    """Bytes and decoding time in strip order with zstd -19."""
    return {
        form: programs.measure("codec", plain, "--bits", bits, "--runs", effort.runs)
        for form, bits in _forms().items()
    }


def _forms() -> dict[str, int]:
    """Bits of positions by name; zero keeps them as floats."""
    return {**{f"q{bits}": bits for bits in BITS}, "f32": 0}


def _draco_bytes(source: Mesh, bits: int) -> bytes:
    return DracoPy.encode(
        source.points,
        source.triangles,
        quantization_bits=bits,
        compression_level=DRACO_LEVEL,
        preserve_order=False,
    )


def _draco(source: Mesh, effort: Effort) -> Figures:
    """Bytes and decoding time; zero bits keep positions as floats."""
    figures: Figures = {}
    for form, bits in _forms().items():
        data = _draco_bytes(source, bits)
        seconds = []
        for _ in range(effort.runs):
            start = time.process_time()
            decoded = DracoPy.decode(data)
            seconds.append(time.process_time() - start)
        figures[form] = {
            "bytes": len(data),
            "vertices": len(decoded.points),
            "faces": len(decoded.faces),
            "decode_seconds": statistics.median(seconds),
        }
    return figures


def _surfaces(plain: Path, source: Mesh, programs: Programs, effort: Effort) -> Figures:
    """Distances from the original at shares of the faces: meshoptimizer first, the others at the count that it reached."""
    folder = programs.out / "simple"
    folder.mkdir(parents=True, exist_ok=True)
    file = programs.out / "pmesh" / f"{plain.stem}.raw-f32.pmesh"
    rows: list[tuple[str, str, int, Path]] = []
    for share in SHARES:
        key = f"{share:g}"
        target = max(4, int(source.faces * share / 100))
        tools = ["meshopt", "project", *(OTHERS if effort.others else ())]
        paths = {tool: folder / f"{plain.stem}.{tool}.{key}.ply" for tool in tools}
        words = ("simplify", plain, "--faces", target, "-o")
        counts = {"meshopt": programs.measure(*words, paths["meshopt"])["faces"]}
        level = programs.measure("level", file, "--faces", counts["meshopt"])[0]
        programs.extract(file, level["level"], paths["project"])
        counts["project"] = level["faces"]
        for tool in tools[2:]:
            if tool == "fast-simplification":
                removed = 1 - target / source.faces
                triangles = source.triangles.astype(np.int32)
                points, faces = fast_simplification.simplify(source.points, triangles, removed)
                meshes.write(paths[tool], Mesh(points.astype(np.float32), faces.astype(np.uint32), 0))
                counts[tool] = len(faces)
            else:
                method = tool.removeprefix("meshopt-")
                counts[tool] = programs.measure(*words, paths[tool], "--method", method)["faces"]
        rows += [(key, tool, counts[tool], paths[tool]) for tool in tools]
    measured = distance.distances(plain, effort.samples, [path for *_, path in rows])
    figures: Figures = {f"{share:g}": {} for share in SHARES}
    for (key, tool, faces, _), found in zip(rows, measured):
        figures[key][tool] = {"faces": faces, **found}
    return figures
