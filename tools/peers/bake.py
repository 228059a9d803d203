"""Baked light beside what a user would run instead, and which targets are met. `cargo xtask peers bake` builds what this needs
and calls it; peers from PyPI are installed here, so that what cannot be installed costs its rows alone."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import bake_rows
from bake_rows import Part, Setting
from commands import PeersError, progress
from tables import markdown

ROWS: dict[str, Callable[[Setting], Part]] = {
    "error": bake_rows.error,
    "mitsuba": bake_rows.mitsuba,
    "rays": bake_rows.rays,
    "threads": bake_rows.threads,
    "surfaces": bake_rows.surfaces,
    "memory": bake_rows.memory,
    "dragon": bake_rows.dragon,
}
REQUIREMENTS = Path(__file__).parent / "requirements-bake.txt"


def main() -> int:
    options = _arguments()
    unknown = [row for row in options.only if row not in ROWS]
    if unknown:
        print(f"peers: no row is named {unknown[0]!r}; there are {' '.join(ROWS)}", file=sys.stderr)
        return 1
    options.out.mkdir(parents=True, exist_ok=True)
    setting = Setting(
        options.meshes, options.out / "bake", options.ivg.resolve(), options.programs.resolve(), options.quick
    )
    setting.out.mkdir(parents=True, exist_ok=True)
    _install()
    parts: dict[str, Part] = {}
    failures: dict[str, str] = {}
    for name in (name for name in ROWS if not options.only or name in options.only):
        start = time.monotonic()
        try:
            parts[name] = ROWS[name](setting)
        except (PeersError, OSError, ValueError, KeyError) as error:
            # The other rows are worth having.
            failures[name] = str(error) or repr(error)
            progress(f"{name}: NOT MEASURED: {failures[name]}")
        progress(f"{name}: {time.monotonic() - start:.0f} s")
    text = _text(parts, failures, setting)
    (setting.out / "bake.md").write_text(text)
    figures = {name: part.figures for name, part in parts.items()}
    (setting.out / "bake.json").write_text(json.dumps(figures | {"not measured": failures}, indent=1) + "\n")
    print(text, end="")
    progress(f"written: {setting.out / 'bake.md'}, bake.json")
    return 1 if failures else 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--meshes", type=Path, required=True, help="folder with the scenes")
    parser.add_argument("--only", action="append", default=[], metavar="ROW", help=f"of {' '.join(ROWS)}")
    parser.add_argument("--quick", action="store_true", help="fewer repetitions, photons and paths")
    parser.add_argument("--out", type=Path, required=True, help="folder for what is written")
    parser.add_argument("--ivg", type=Path, required=True, help="the command ivg")
    parser.add_argument("--programs", type=Path, required=True, help="folder with the programs built here")
    return parser.parse_args()


def _install() -> None:
    """Installs the peers one by one; what is missing afterwards is said by the rows that need it."""
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    if subprocess.run([*pip, "--requirement", str(REQUIREMENTS)], check=False).returncode == 0:
        return
    for line in REQUIREMENTS.read_text().splitlines():
        if line and not line.startswith("#") and subprocess.run([*pip, line], check=False).returncode != 0:
            progress(f"CANNOT INSTALL {line}")


def _text(parts: dict[str, Part], failures: dict[str, str], setting: Setting) -> str:
    """Everything as Markdown; the targets come last."""
    versions = bake_rows.versions(setting)
    sections = ["# Baked light and its peers", "Versions: " + ", ".join(versions) + "."]
    sections += [part.text for part in parts.values() if part.text]
    rows = []
    for name in ROWS:
        if name in parts:
            rows += [
                [target.what, target.measured, target.target, "met" if target.met else "MISSED"]
                for target in parts[name].targets
            ]
        elif name in failures:
            rows.append([f"{name}: NOT MEASURED, see below", "-", "-", "-"])
    sections += ["## Targets", markdown(["what", "measured", "target", "met?"], rows)]
    sections += [f"**{name} was not measured:** {reason}" for name, reason in failures.items()]
    return "\n\n".join(sections) + "\n"


if __name__ == "__main__":
    sys.exit(main())
