"""The tables, and which targets are met."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from measure import BITS, DRACO_LEVEL, OTHERS, RAW_PACKETS, SHARES, Effort
from project import Figures
from tables import markdown

MESHOPT = "meshopt strip + zstd -19"
OTHERS_NOTE = " The last columns are means of tools that drop components, cluster, or move vertices, with the faces reached."
# What a cell says whose file `ivg mesh` did not write.
ABSENT = "not written"
DRACO = f"Draco cl{DRACO_LEVEL}"


@dataclass(frozen=True)
class Target:
    """What is asked of a figure on every mesh."""

    name: str
    values: dict[str, float]
    limit: float
    at_most: bool = True
    unit: str = ""
    stretch: bool = False

    def holds(self, value: float) -> bool:
        return value <= self.limit if self.at_most else value >= self.limit

    def as_json(self) -> dict[str, Any]:
        return {
            "name": self.name,
            "limit": self.limit,
            "at_most": self.at_most,
            "unit": self.unit,
            "stretch": self.stretch,
            "met": all(map(self.holds, self.values.values())),
            "median": _or_none(self.median()),
            "values": {name: _or_none(value) for name, value in self.values.items()},
        }

    def median(self) -> float:
        values = list(self.values.values())
        return math.nan if any(map(math.isnan, values)) else statistics.median(values)

    def row(self) -> list[str]:
        kind = "stretch" if self.stretch else "target"
        limit = f"{'<=' if self.at_most else '>='} {self.limit:g} {self.unit}".strip()
        if math.isnan(self.median()):
            return [self.name, kind, limit, ABSENT, "-", "-"]
        missed = [name for name, value in self.values.items() if not self.holds(value)]
        verdict = f"MISSED on {len(missed)} of {len(self.values)}" if missed else "met"
        worst = (max if self.at_most else min)(self.values, key=lambda name: self.values[name])
        return [
            self.name,
            kind,
            limit,
            verdict,
            f"{self.median():.3g}",
            f"{self.values[worst]:.3g} ({worst})",
        ]


def _or_none(value: float) -> float | None:
    """JSON has no NaN."""
    return None if math.isnan(value) else value


class Gap(dict[str, Any]):
    """Figures of a file that was not written: every one is NaN, and so is all that is computed from it."""

    def __missing__(self, key: str) -> float:
        return math.nan


def _with_gaps(forms: dict[str, Figures | None]) -> dict[str, Figures]:
    return {form: found or Gap() for form, found in forms.items()}


class Report:
    """Tables of all meshes, in the order of the targets."""

    def __init__(self, figures: dict[str, Figures], effort: Effort) -> None:
        self.figures = {name: m | {"project": _with_gaps(m["project"])} for name, m in figures.items()}
        self.effort = effort
        self.targets: list[Target] = []
        self.parts: list[str] = []
        self._meshes()
        self._bytes()
        self._first()
        self._speed()
        self._surfaces()
        self._overheads()

    def text(self, versions: dict[str, str]) -> str:
        """Everything as Markdown; the targets come last."""
        names = ", ".join(f"{name} {version}" for name, version in versions.items())
        head = f"# Progressive meshes and their peers\n\nVersions: {names}."
        columns = ["target", "kind", "limit", "verdict", "median", "worst"]
        note = "Stretch targets are wished for beyond the others. The command succeeds whether they are met or not."
        summary = f"## Targets\n\n{note}\n\n" + markdown(columns, [target.row() for target in self.targets])
        return "\n\n".join([head, *self.parts, summary]) + "\n"

    def _add(self, title: str, note: str, columns: list[str], cells: Callable[[Figures], list[str]]) -> None:
        rows = [
            [name, *(ABSENT if "nan" in cell else cell for cell in cells(figures))]
            for name, figures in self.figures.items()
        ]
        self.parts.append(f"## {title}\n\n{note}\n\n" + markdown(["mesh", *columns], rows))

    def _target(
        self, name: str, value: Callable[[Figures], float], limit: float, *, only: str = "", **how: Any
    ) -> None:
        values = {mesh: float(value(figures)) for mesh, figures in self.figures.items() if only in ("", mesh)}
        if values:
            self.targets.append(Target(name, values, limit, **how))

    def _meshes(self) -> None:
        def written(m: Figures) -> list[Figures]:
            return [form for form in m["project"].values() if form]

        self._add(
            "Meshes",
            "Vertices are those that a face names; the project and Draco store equal positions once. Bits per vertex below "
            "are bytes by the column V for all tools. Lost and foreign: triangles that the finest level of any file of the "
            "project lacks or adds, compared by the places of their corners. Plain bytes: 12 a vertex, 12 a face.",
            ["V", "F", "unreferenced", "V project", f"V {DRACO}", "plain bytes", "lost", "foreign"],
            lambda m: [
                f"{m['vertices']:,}",
                f"{m['faces']:,}",
                f"{m['unreferenced']:,}",
                f"{m['project']['raw f32']['vertices']:,}",
                f"{m['draco']['q14']['vertices']:,}",
                f"{m['plain_bytes']:,}",
                *(f"{max(form[key] for form in written(m)):,}" for key in ("lost", "foreign")),
            ],
        )
        self._target(
            "triangles of the finest level lost or foreign",
            lambda m: max(form["lost"] + form["foreign"] for form in written(m)),
            0,
        )

    def _bytes(self) -> None:
        for form in [*(f"q{bits}" for bits in BITS), "f32"]:
            coded = f"coded {form}"

            def size(m: Figures, coded: str = coded) -> int:
                return m["project"][coded]["bytes"]

            def cells(m: Figures, form: str = form) -> list[str]:
                sizes = [size(m), m["meshopt"][form]["bytes"], m["draco"][form]["bytes"]]
                bits = [f"{8 * count / m['vertices']:.2f}" for count in sizes]
                ratios = [f"{sizes[0] / other:.3f}" for other in sizes[1:]]
                return [*bits, *ratios, *(f"{count:,}" for count in sizes)]

            quantised = form != "f32"
            peer = DRACO if quantised else "Draco qp 0"
            title = (
                f"positions of {form[1:]} bits" if quantised else "positions as 32-bit floats, nothing lost"
            )
            self._add(
                f"Bits per vertex, {title}",
                "Coded packets of +30 % vertices, every level inside, against files that hold the finest mesh alone.",
                [coded, MESHOPT, peer, "/ meshopt", "/ Draco", "bytes", "bytes meshopt", "bytes Draco"],
                cells,
            )
            self._target(
                f"bits per vertex {form} / {MESHOPT}",
                lambda m, form=form: size(m) / m["meshopt"][form]["bytes"],
                1.0,
            )
            if quantised:
                self._target(
                    f"bits per vertex {form} / {DRACO}",
                    lambda m, form=form: size(m) / m["draco"][form]["bytes"],
                    1.35,
                    stretch=True,
                )

    def _first(self) -> None:
        def first(m: Figures) -> Figures:
            return m["project"]["coded q14"]

        self._add(
            "The first 1 % of the vertices, coded q14",
            "Bytes from the start of the file, headers and all, to the end of the packet with which 1 % of the vertices are "
            f"there; packets end where they end, so they bring more. Beside it a file of {DRACO} q14 with meshoptimizer's "
            "simplification to 1 % of the faces, and nothing after it.",
            ["1 %", "bytes", "vertices then", "bytes a vertex", f"bytes {DRACO} of 1 %"],
            lambda m: [
                f"{first(m)['hundredth']:,}",
                f"{first(m)['first_bytes']:,}",
                f"{first(m)['first_vertices']:,}",
                f"{first(m)['first_bytes'] / first(m)['first_vertices']:.2f}",
                f"{m['draco']['first_bytes']:,}",
            ],
        )
        for limit, stretch in ((20.0, False), (15.0, True)):
            self._target(
                "first 1 % of the dragon, coded q14",
                lambda m: first(m)["first_bytes"] / 1000,
                limit,
                only="dragon",
                unit="kB",
                stretch=stretch,
            )

    def _speed(self) -> None:
        def speed(m: Figures, tool: str, form: str) -> float:
            return m["faces"] / m[tool][form]["decode_seconds"] / 1e6

        def order(m: Figures, wall: bool = False) -> float:
            # The same mesh was ordered for each file that keeps floats.
            runs = [form for name, form in m["project"].items() if "f32" in name]
            times = [form["order_wall_seconds" if wall else "order_seconds"] for form in runs]
            return 1e6 * statistics.median(times) / m["vertices"]

        columns = {
            "coded q14": lambda m: speed(m, "project", "coded q14"),
            "raw f32": lambda m: speed(m, "project", "raw f32"),
            "raw f32, one packet": lambda m: speed(m, "project", "raw f32, one packet"),
            f"{MESHOPT} q14": lambda m: speed(m, "meshopt", "q14"),
            f"{DRACO} q14": lambda m: speed(m, "draco", "q14"),
        }
        self._add(
            "Speed",
            f"Decoding on one core in millions of triangles a second: processor time, median of {self.effort.runs} runs. The "
            "project's decoder reads a whole file and ends with the finest level, checked; what it takes to step to others it finds "
            "out at the first step. Ordering: cleaning the "
            "mesh and the whole chain of levels, processor time and wall clock, median of the files that keep floats.",
            [*columns, "coded / Draco", "order [us a vertex]", "wall clock [us a vertex]"],
            lambda m: [
                *(f"{value(m):.1f}" for value in columns.values()),
                f"{speed(m, 'project', 'coded q14') / speed(m, 'draco', 'q14'):.2f}",
                f"{order(m):.2f}",
                f"{order(m, wall=True):.2f}",
            ],
        )
        self._target(
            f"decode coded q14 / {DRACO} q14",
            lambda m: speed(m, "project", "coded q14") / speed(m, "draco", "q14"),
            1.0,
            at_most=False,
        )
        mtris = "Mtris/s"
        for form, limit, stretch in (
            ("coded q14", 40, True),
            ("raw f32", 100, False),
            ("raw f32", 150, True),
            ("raw f32, one packet", 100, False),
            ("raw f32, one packet", 150, True),
        ):
            self._target(
                f"decode {form}",
                lambda m, form=form: speed(m, "project", form),
                limit,
                at_most=False,
                unit=mtris,
                stretch=stretch,
            )
        self._target("order, whole chain", order, 15, unit="us a vertex")
        self._target("order, whole chain", order, 5, unit="us a vertex", stretch=True)

    def _surfaces(self) -> None:
        for share in SHARES:
            key = f"{share:g}"

            def at(m: Figures, tool: str, what: str, key: str = key) -> float:
                return m["surfaces"][key][tool][what]

            others = list(OTHERS) if self.effort.others else []

            def cells(m: Figures, others: list[str] = others, at: Callable[..., float] = at) -> list[str]:
                row = [f"{at(m, 'project', 'faces'):,}", f"{at(m, 'meshopt', 'faces'):,}"]
                for what, digits in (("mean", 4), ("max", 2)):
                    ours, theirs = at(m, "project", what), at(m, "meshopt", what)
                    row += [f"{ours:.{digits}f}", f"{theirs:.{digits}f}", f"{ours / theirs:.3f}"]
                row += [f"{at(m, tool, 'turned'):.1f} %" for tool in ("project", "meshopt")]
                return row + [f"{at(m, tool, 'mean'):.4f} ({at(m, tool, 'faces'):,})" for tool in others]

            self._add(
                f"Distance at {key} % of the faces",
                "Symmetric distance from the original in % of the diagonal of its bounds, by pymeshlab, "
                f"{self.effort.samples:,} random points of the faces each way. The project's level has at most as many "
                "faces as meshopt_simplify reached. Turned over: faces whose normal is more than 90 degrees off that of the "
                "nearest point of the original." + (OTHERS_NOTE if others else ""),
                [
                    "F",
                    "F meshopt",
                    "mean",
                    "meshopt",
                    "ratio",
                    "max",
                    "meshopt",
                    "ratio",
                    "turned over",
                    "meshopt",
                    *others,
                ],
                cells,
            )
            for what, limit, stretch in (
                ("mean", 1.0, False),
                ("max", 1.2, False),
                ("mean", 0.9, True),
                ("max", 1.0, True),
            ):
                self._target(
                    f"{what} distance at {key} % / meshopt_simplify",
                    lambda m, what=what, at=at: at(m, "project", what) / at(m, "meshopt", what),
                    limit,
                    stretch=stretch,
                )
        self._target(
            "mean distance of the dragon at 0.2 %",
            lambda m: m["surfaces"]["0.2"]["project"]["mean"],
            0.32,
            only="dragon",
            unit="% of the diagonal",
        )

    def _overheads(self) -> None:
        def coded(m: Figures) -> float:
            return 100 * (
                m["project"]["coded q14"]["bytes"] / m["project"]["coded q14, one packet"]["bytes"] - 1
            )

        def raw(m: Figures, packet: int) -> float:
            form = m["project"][f"raw f32, {packet} a packet"]
            return 100 * (form["bytes"] / (12 * form["vertices"] + 12 * form["faces"]) - 1)

        def memory(m: Figures, form: str, what: str) -> float:
            figures = m["project"][form]
            return (figures[f"{what}_bytes"] - figures["mesh_bytes"]) / figures["mesh_bytes"]

        kept = [(form, what) for form in ("raw f32", "coded q14") for what in ("replay", "peak")]
        self._add(
            "Overheads",
            "Bytes of coded q14 packets of +30 % vertices over one packet (less than 0: the one is longer); of raw packets over "
            "the plain indexed mesh (12 bytes a vertex, 12 a face); heap of the decoder beside the plain mesh, over the plain "
            "mesh, when all is in and at its peak.",
            ["coded over one packet", *(f"raw, {packet:,} a packet" for packet in RAW_PACKETS)]
            + [f"heap, {form}{', peak' if what == 'peak' else ''}" for form, what in kept],
            lambda m: [
                f"{coded(m):+.2f} %",
                *(f"{raw(m, packet):+.1f} %" for packet in RAW_PACKETS),
                *(f"{memory(m, form, what):.2f} x" for form, what in kept),
            ],
        )
        self._target("coded packets over one packet", coded, 8, unit="%")
        self._target("coded packets over one packet", coded, 3, unit="%", stretch=True)
        for packet, limit, stretch in ((250, 25, False), (5000, 18, False), (5000, 12, True)):
            self._target(
                f"raw packets of {packet:,} over the plain mesh",
                lambda m, packet=packet: raw(m, packet),
                limit,
                unit="%",
                stretch=stretch,
            )
        for form in ("raw f32", "coded q14"):
            self._target(
                f"heap of the replay beside the mesh, {form}",
                lambda m, form=form: memory(m, form, "replay"),
                1.5,
                unit="x the mesh",
            )
