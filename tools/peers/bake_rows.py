"""What is measured of baked light, row by row of the targets."""

from __future__ import annotations

import glob
import importlib.metadata
import json
import math
import os
import platform
import re
import shutil
import statistics
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from commands import Ended, PeersError, called, progress, run, timed
from tables import markdown

# Photons of the rows of accuracy against time; the second is that of the first target.
PHOTONS = (250_000, 1_000_000, 2_000_000, 4_000_000, 8_000_000)
MILLION = 1_000_000
# Where the files are to be had that DIR lacks.
NEEDED = {
    "cornell_bunny.obj": "the measured Cornell box in metres, with the Stanford bunny for the short block",
    "kitchen.obj.zst": "the kitchen of obvhs' examples",
    "kitchen.lights.toml": "lights for the kitchen, see ivg-scene/LIGHTS.md",
    "dragon_vrip.ply.gz": "the Stanford dragon",
}
# The oldest LLVM with all instructions that Mitsuba's code asks for, and the one that is installed where there is none.
LLVM_OLDEST, LLVM_PACKAGE = 16, "libllvm19"


@dataclass(frozen=True)
class Setting:
    """Where things are, and how long to measure."""

    meshes: Path
    out: Path
    ivg: Path
    programs: Path
    quick: bool

    def file(self, name: str) -> Path:
        """A file of the folder with the scenes."""
        path = self.meshes / name
        if not path.is_file():
            raise PeersError(f"{self.meshes} lacks {name}: {NEEDED[name]}")
        return path

    def example(self, name: str) -> Path:
        """An example of the project's crates."""
        return self.programs / "examples" / name

    def bake(self, name: str, scene: Path, *options: object) -> tuple[Path, Ended]:
        """`ivg bake`: the file and what it took."""
        path = self.out / f"{name}.ivg"
        return path, timed(self.ivg, "bake", scene, "-o", path, "--json", *options)


@dataclass(frozen=True)
class Target:
    """A line of the table of targets."""

    what: str
    measured: str
    target: str
    met: bool


@dataclass(frozen=True)
class Part:
    """What a row measured: targets, all figures, and a section of text."""

    targets: list[Target]
    figures: Any
    text: str = field(default="")


def versions(setting: Setting) -> list[str]:
    """What was measured."""
    found = [run(setting.ivg, "--version").strip(), f"Python {platform.python_version()}"]
    for package in ("mitsuba", "drjit", "embreex"):
        try:
            found.append(f"{package} (PyPI) {importlib.metadata.version(package)}")
        except importlib.metadata.PackageNotFoundError:
            found.append(f"{package} (PyPI) not installed")
    return found


def error(setting: Setting) -> Part:
    """The error of a whole grid against the path-traced oracle, and what it takes."""
    figures = _errors(setting)
    scene = setting.file("cornell_bunny.obj")
    rows = figures["rows"]
    million = next(row for row in rows if row["photons"] == MILLION)
    commands = {}
    for photons in (MILLION, _photons_for(rows, 0.015)):
        _, ended = setting.bake("error", scene, "--photons", photons, "--threads", 1)
        commands[photons] = ended.cpu_seconds
    needed = {share: _seconds_for(rows, share) for share in (0.015, 0.01)}
    whole = list(commands.items())
    table = markdown(
        ["photons", "error of I_d.d", "of all components", "CPU-s", "of it photons"],
        [
            [
                f"{row['photons']:,}",
                _percent(row["axis"]),
                _percent(row["all"]),
                f"{row['cpu_seconds']:.2f}",
                f"{row['cpu_seconds'] - figures['before_photons']:.2f}",
            ]
            for row in rows
        ],
    )
    text = (
        "## Accuracy against time\n\n"
        f"The whole 16^3 grid of cornell_bunny on one thread; errors are relative root mean squares at {len(figures['points']):,} of "
        f"{figures['lit']:,} lit vertices, those half a cell or more from every surface, against path tracing (whose own "
        f"variance is taken off), median of {figures['seeds']} seeds. CPU-s are those of the call of the library, tree and visibility "
        f"included; the whole command `ivg bake` takes {whole[0][1]:.2f} CPU-s for {whole[0][0]:,} photons and {whole[1][1]:.2f} for "
        f"{whole[1][0]:,}. Times to reach an error are interpolated between rows.\n\n{table}"
    )
    targets = [
        Target(
            "16^3 grid of cornell_bunny, error of I_d.d with 1e6 photons",
            _percent(million["axis"]),
            "<= 2.6 %",
            million["axis"] <= 0.026,
        ),
        Target(
            "the same, CPU-seconds to 1.5 %", _seconds(needed[0.015]), "<= 8 CPU-s", needed[0.015] <= 8
        ),
        Target(
            "the same, CPU-seconds to 1 % (stretch)", _seconds(needed[0.01]), "<= 8 CPU-s", needed[0.01] <= 8
        ),
    ]
    return Part(targets, {"rows": rows, "commands": commands, "needed": {str(k): v for k, v in needed.items()}}, text)


def _errors(setting: Setting) -> Any:
    """What the example `oracle_error` measures; kept for rows that need it too."""
    path = setting.out / ("error-quick.json" if setting.quick else "error.json")
    marker = f"{_identity(setting.example('oracle_error'))} {_identity(setting.file('cornell_bunny.obj'))}"
    if path.is_file():
        kept = json.loads(path.read_text())
        if kept.get("marker") == marker:
            progress(f"error: as measured before, {path}")
            return kept
    photons = PHOTONS[:-1] if setting.quick else PHOTONS
    seeds = 2 if setting.quick else 3
    progress("error: oracle and bakes")
    run(
        setting.example("oracle_error"),
        setting.file("cornell_bunny.obj"),
        *("--vertices", 16**3, "--paths", 8192 if setting.quick else 16384, "--estimator", "track-length"),
        *("--seeds", seeds, "--photons", ",".join(map(str, photons)), "--json", path),
    )
    figures = json.loads(path.read_text()) | {"marker": marker, "seeds": seeds}
    path.write_text(json.dumps(figures))
    return figures


def _identity(path: Path) -> str:
    status = path.stat()
    return f"{path.name} {status.st_size} {status.st_mtime_ns}"


def _seconds_for(rows: list[Any], share: float) -> float:
    """Processor time at which an error is reached, on the straight line between rows in logarithms; beyond the last row by
    the square root of the time."""
    for a, b in zip(rows, rows[1:]):
        if a["axis"] >= share >= b["axis"]:
            along = math.log(share / a["axis"]) / math.log(b["axis"] / a["axis"])
            return a["cpu_seconds"] * (b["cpu_seconds"] / a["cpu_seconds"]) ** along
    last = rows[-1] if share < rows[-1]["axis"] else rows[0]
    return last["cpu_seconds"] * (last["axis"] / share) ** 2


def _photons_for(rows: list[Any], share: float) -> int:
    """Photons at which an error is reached, rounded up to a tenth of a million."""
    turned = [row | {"cpu_seconds": float(row["photons"])} for row in rows]
    return math.ceil(_seconds_for(turned, share) / 1e5) * 100_000


def mitsuba(setting: Setting) -> Part:
    """The same error by path tracing every vertex with Mitsuba 3."""
    figures = _errors(setting)
    library = _llvm()
    rows = figures["rows"]
    ours = next(row for row in rows if row["photons"] == MILLION)
    points = setting.out / ("error-quick.json" if setting.quick else "error.json")
    script = Path(__file__).parent / "bake_mitsuba.py"
    samples, runs = (1024, 2) if setting.quick else (4096, 2)
    command = (sys.executable, "-B", script, setting.file("cornell_bunny.obj"), points)
    progress(f"mitsuba: {samples} paths for each of {len(figures['points'])} points")
    ended = timed(
        *command, "--samples", samples, "--runs", runs, environment={"DRJIT_LIBLLVM_PATH": str(library)}
    )
    found = json.loads(ended.text)
    compared, lit, all_vertices = found["points"], figures["lit"], math.prod(figures["dims"])
    table = []
    at_lit, at_all = {}, {}
    for row in found["rows"]:
        to_same = row["cpu_seconds"] * (row["error"] / ours["axis"]) ** 2
        at_lit[row["sampler"]] = to_same * lit / compared
        at_all[row["sampler"]] = to_same * all_vertices / compared
        table.append(
            [
                row["sampler"],
                f"{row['samples']:,}",
                _percent(row["error"]),
                f"{row['cpu_seconds']:.2f}",
                f"{at_lit[row['sampler']]:.1f}",
                f"{at_lit[row['sampler']] / ours['cpu_seconds']:.1f} x",
                f"{at_all[row['sampler']]:.1f}",
                f"{at_all[row['sampler']] / ours['cpu_seconds']:.1f} x",
                f"{row['ratio']:.4f}",
                f"{_percent(row['difference'])} ({_percent(row['noise'])})",
            ]
        )
    columns = ["sampler", "paths", "error", "CPU-s", "CPU-s, lit", "ours", "CPU-s, all", "ours"]
    text = (
        "## Mitsuba 3, path tracing every vertex\n\n"
        f"llvm_ad_rgb on one thread, without the first call, which compiles; directions over the sphere, `path` to depth 64, light seen "
        f"directly hidden; measured at the {compared:,} vertices compared above. CPU-s to the error that ours has with 1e6 photons "
        f"({_percent(ours['axis'])} in {ours['cpu_seconds']:.2f} CPU-s) follow from 1 / sqrt(paths), for the {lit:,} vertices that light "
        f"reaches, which Mitsuba is told here and would have to find out, and for all {all_vertices:,}. Agreement: sum of Mitsuba's means over "
        "the oracle's, and the difference from the oracle beside what the noise of both would make of it.\n\n"
        + markdown([*columns, "mean / oracle", "difference (noise)"], table)
    )
    best = min(at_lit, key=lambda sampler: at_lit[sampler])
    first = found["rows"][0]["sampler"]
    agree = all(row["difference"] <= 1.1 * row["noise"] and abs(row["ratio"] - 1) < 0.005 for row in found["rows"])
    ratios = (at_lit[best] / ours["cpu_seconds"], at_all[first] / ours["cpu_seconds"])
    targets = [
        Target(
            f"Mitsuba 3 / ours, CPU-s to the same error, lit vertices, its best sampler ({best})",
            f"{ratios[0]:.1f} x",
            ">= 15 x",
            ratios[0] >= 15,
        ),
        Target(
            f"the same, all vertices, its usual sampler ({first})", f"{ratios[1]:.1f} x", ">= 15 x", ratios[1] >= 15
        ),
        Target(
            "Mitsuba and the oracle agree",
            ", ".join(f"{row['ratio']:.4f}" for row in found["rows"]),
            "1 within noise",
            agree,
        ),
    ]
    _plot(setting, figures, found)
    return Part(targets, found | {"cpu_seconds_lit": at_lit, "cpu_seconds_all": at_all}, text)


def _plot(setting: Setting, figures: Any, found: Any) -> None:
    """Error against time as a picture; without matplotlib there is none."""
    data = {
        "ours": [[row["cpu_seconds"], row["axis"]] for row in figures["rows"]],
        "mitsuba": {
            row["sampler"]: [row["cpu_seconds"] * figures["lit"] / found["points"], row["error"]]
            for row in found["rows"]
        },
    }
    path = setting.out / "bake.svg"
    script = Path(__file__).parent / "bake_plot.py"
    command = [sys.executable, "-B", str(script), str(path)]
    done = subprocess.run(command, input=json.dumps(data), text=True, check=False)
    progress(f"picture: {path}" if done.returncode == 0 else "mitsuba: no picture of error against time")


def _llvm() -> Path:
    """The newest LLVM that Mitsuba can use. On Debian, as root, it is installed where there is none."""
    chosen = os.environ.get("DRJIT_LIBLLVM_PATH")
    if chosen:
        return Path(chosen)
    found = _newest_llvm()
    if found is None and shutil.which("apt-get") and os.geteuid() == 0:
        progress(f"mitsuba: installing {LLVM_PACKAGE} with apt-get")
        for words in (("update",), ("install", "-y", "--no-install-recommends", LLVM_PACKAGE)):
            subprocess.run(["apt-get", "-qq", *words], check=False, stdout=sys.stderr)
        found = _newest_llvm()
    if found is None:
        raise PeersError(
            f"Mitsuba's llvm_ad_rgb needs libLLVM {LLVM_OLDEST} or newer: `apt-get install {LLVM_PACKAGE}`, or its path in "
            "DRJIT_LIBLLVM_PATH"
        )
    return found


def _newest_llvm() -> Path | None:
    newest: tuple[int, Path] | None = None
    for pattern in ("/usr/lib/*/libLLVM*.so*", "/usr/lib/libLLVM*.so*", "/usr/lib64/libLLVM*.so*", "/usr/lib/llvm-*/lib/libLLVM*.so*"):
        for path in glob.glob(pattern):
            numbers = re.findall(r"\d+", Path(path).name)
            version = max((int(number) for number in numbers), default=0)
            if version >= LLVM_OLDEST and (newest is None or version > newest[0]):
                newest = (version, Path(path))
    return newest[1] if newest else None


def rays(setting: Setting) -> Part:
    """Closest hits of photons' flights, beside Embree."""
    library = _embree()
    scenes = {
        "kitchen": (setting.file("kitchen.obj.zst"), "--lights", setting.file("kitchen.lights.toml")),
        "dragon": (_dragon_scene(setting),),
    }
    runs = 3 if setting.quick else 7
    figures: dict[str, Any] = {}
    targets, rows = [], []
    for name, scene in scenes.items():
        dump = setting.out / f"{name}.rays"
        progress(f"rays: {name}")
        ours = called(setting.example("rays"), *scene, "--runs", runs, "--dump", dump, "--json")
        theirs = called(setting.programs / "peers-embree", library, dump, "--runs", runs)
        dump.unlink()
        figures[name] = {"ours": ours, "embree": theirs}
        robust = next(mode for mode in theirs["modes"] if mode["mode"] == "robust, medium")
        used = ours["trees"][0]
        ratio = used["mrays"] / robust["mrays"]
        found = [(f"ours: {tree['tree']}", tree) for tree in ours["trees"]]
        found += [(f"Embree: {mode['mode']}", mode) for mode in theirs["modes"]]
        rows += [
            [
                f"{name}, {title}",
                f"{1e3 * of['build_seconds']:.0f}",
                f"{of['mrays']:.2f}",
                f"{of['mrays'] / robust['mrays']:.2f}",
                f"{of['differ']:,}",
            ]
            for title, of in found
        ]
        targets.append(
            Target(
                f"closest hits of {name}, watertight, ours / Embree robust",
                f"{ratio:.2f} x ({used['mrays']:.2f} / {robust['mrays']:.2f} Mray/CPU-s)",
                ">= 0.35 x",
                ratio >= 0.35,
            )
        )
    counts = ", ".join(f"{name}: {of['ours']['triangles']:,} triangles" for name, of in figures.items())
    text = (
        "## Closest hits\n\n"
        f"Flights of photons after the first, {figures['kitchen']['ours']['rays']:,} a scene ({counts}; the dragon stands in "
        "cornell_bunny's box), one ray at a time on one thread, median of "
        f"{runs} runs. The first tree of each scene is the baker's. Embree {_embree_version(figures)} as the wheel embreex brings it, called from "
        "a compiled loop; `robust` is its watertight mode. Other hits: rays whose hit lies elsewhere than the baker's.\n\n"
        + markdown(["scene and tree", "build [CPU-ms]", "Mray/CPU-s", "/ Embree robust", "other hits"], rows)
    )
    return Part(targets, figures, text)


def _embree() -> Path:
    """The library that the wheel embreex brings."""
    for folder in map(Path, sys.path):
        found = sorted(folder.glob("embreex.libs/libembree4*"))
        if found:
            return found[0]
    raise PeersError("embreex is not installed")


def _embree_version(figures: Any) -> str:
    number = figures["kitchen"]["embree"]["version"]
    return f"{number // 10000}.{number // 100 % 100}.{number % 100}"


def _dragon_scene(setting: Setting) -> Path:
    """The dragon in the place of the bunny."""
    path = setting.out / "dragon.glb"
    bunny, model = setting.file("cornell_bunny.obj"), setting.file("dragon_vrip.ply.gz")
    run(setting.example("replace"), bunny, model, "-o", path)
    return path


def threads(setting: Setting) -> Part:
    """Two threads against one: wall clock and bytes."""
    scene = setting.file("cornell_bunny.obj")
    photons, runs = (2 * MILLION, 3) if setting.quick else (6 * MILLION, 3)
    walls: dict[int, list[float]] = {1: [], 2: []}
    cpu: dict[int, list[float]] = {1: [], 2: []}
    contents = set()
    for _ in range(runs):
        for count in walls:
            path, ended = setting.bake(f"threads-{count}", scene, "--photons", photons, "--threads", count)
            walls[count].append(ended.wall_seconds)
            cpu[count].append(ended.cpu_seconds)
            contents.add(path.read_bytes())
    ratio = statistics.median(walls[1]) / statistics.median(walls[2])
    busy = statistics.median(cpu[2]) / statistics.median(cpu[1])
    text = (
        "## Threads\n\n"
        f"`ivg bake` with {photons:,} photons, one thread and two in turn, {runs} times each: wall clock "
        f"{statistics.median(walls[1]):.2f} and {statistics.median(walls[2]):.2f} s (median), processor time of two over one {busy:.3f}. "
        "A machine that others use, or that lends a core's siblings as cores, shows less than the code would give."
    )
    same = len(contents) == 1
    targets = [
        Target("wall clock, one thread / two", f"{ratio:.2f} x", ">= 1.8 x", ratio >= 1.8),
        Target("files of one thread and of two", "identical" if same else "DIFFERENT", "identical bytes", same),
    ]
    return Part(targets, {"wall_seconds": walls, "cpu_seconds": cpu, "identical": same}, text)


def surfaces(setting: Setting) -> Part:
    """Bias of vertices next to surfaces."""
    progress("surfaces: bakes and gathers 32^3 twice")
    effort = ("--photons", 1_000_000, "--paths", 256) if setting.quick else ()
    scene = setting.file("cornell_bunny.obj")
    printed = run(setting.example("near_surfaces"), scene, "--grid", "32x32x32", *effort)
    line = r"^(.+?)\s+([\d,]+)\s+([\d.]+) %\s+([\d.]+) %"
    found = {row[1]: float(row[3]) for row in re.finditer(line, printed, re.MULTILINE)}
    name = "on bounds or to a step"
    if name not in found:
        raise PeersError(f"`near_surfaces` printed no line {name!r}:\n{printed}")
    text = f"## Next to surfaces\n\n```text\n{printed.strip()}\n```"
    bias = found[name] / 100
    target = Target("bias within one cell of a surface or on the bounds, 32^3", _percent(bias), "<= 3 %", bias <= 0.03)
    return Part([target], found, text)


def memory(setting: Setting) -> Part:
    """The most memory of a large bake."""
    scene = setting.file("cornell_bunny.obj")
    peaks = {}
    for count in (8,) if setting.quick else (1, 8):
        progress(f"memory: 128^3 on {count} threads")
        options = ("--grid", "128x128x128", "--photons", MILLION // 10, "--threads", count)
        path, ended = setting.bake(f"memory-{count}", scene, *options)
        path.unlink()
        peaks[count] = ended.peak_bytes / 2**30
    measured = ", ".join(f"{peak:.2f}" for peak in peaks.values())
    most = max(peaks.values())
    counts = " and ".join(map(str, peaks))
    name = f"peak memory of a 128^3 bake, {counts} threads"
    return Part([Target(name, f"{measured} GiB", "<= 1.5 GiB", most <= 1.5)], peaks)


def dragon(setting: Setting) -> Part:
    """The dragon in the box, to an accuracy."""
    scene = _dragon_scene(setting)
    progress("dragon: 32^3 to 2 %")
    _, ended = setting.bake("dragon", scene, "--grid", "32x32x32", "--accuracy", "2%")
    figures = json.loads(ended.text)
    reached = figures["accuracy"]
    stages = ", ".join(f"{stage['stage']} {stage['cpu_seconds']:.1f}" for stage in figures["stages"])
    text = (
        "## The dragon in the bunny's place\n\n"
        f"`ivg bake --grid 32x32x32 --accuracy 2%`: {ended.wall_seconds:.1f} s wall, {ended.cpu_seconds:.1f} CPU-s ({stages}), peak "
        f"{ended.peak_bytes / 2**30:.2f} GiB; {figures['photons']:,} photons and {figures['paths']:,} paths; reached "
        f"{_percent(reached['reached'])} (noise {_percent(reached['noise'])}, bias {_percent(reached['bias'])}), ended by {reached['ended_by']}."
    )
    targets = [
        Target(
            "dragon for bunny, 32^3, --accuracy 2%, wall clock",
            f"{ended.wall_seconds:.1f} s ({ended.cpu_seconds:.1f} CPU-s)",
            "<= 60 s",
            ended.wall_seconds <= 60,
        ),
        Target("the same, accuracy reached", _percent(reached["reached"]), "<= 2 %", reached["reached"] <= 0.02),
    ]
    return Part(targets, figures, text)


def _percent(share: float) -> str:
    return f"{100 * share:.2f} %"


def _seconds(seconds: float) -> str:
    return f"{seconds:.1f} CPU-s"
