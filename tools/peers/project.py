"""Calls of the project's command `ivg` and of the measuring programs beside this file."""

from __future__ import annotations

import resource
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from commands import called, run

Figures = dict[str, Any]


@dataclass(frozen=True)
class Programs:
    """Where the programs lie, and the folder for what they write."""

    ivg: Path
    peers: Path
    memory: Path
    out: Path

    def mesh(self, mesh: Path, name: str, *options: str) -> tuple[Path, Figures]:
        """`ivg mesh`: the file and its figures."""
        path = self.out / "pmesh" / f"{mesh.stem}.{name}.pmesh"
        path.parent.mkdir(parents=True, exist_ok=True)
        before = _processor_seconds()
        figures: Figures = called(self.ivg, "mesh", mesh, "-o", path, "--json", *options)
        # The command says how its time divides; the machine's other users lengthen each part alike.
        stages = figures["seconds"]
        order = stages.get("clean", 0) + stages["order"]
        processor = order / sum(stages.values()) * (_processor_seconds() - before)
        return path, figures | {"order_seconds": processor, "order_wall_seconds": order}

    def extract(self, file: Path, level: int | None, out: Path) -> None:
        """`ivg extract`: the mesh at a level, or at the finest."""
        run(self.ivg, "extract", file, "-o", out, *(() if level is None else ("--level", level)))

    def version(self) -> str:
        """What `ivg --version` says."""
        return run(self.ivg, "--version").strip()

    def measure(self, *words: object) -> Any:
        """One measurement by the Rust program."""
        return called(self.peers, *words)

    def replay_memory(self, file: Path) -> Figures:
        """Heap of the decoded file."""
        return called(self.memory, file)


def _processor_seconds() -> float:
    """Processor time of all commands that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime
