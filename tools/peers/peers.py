"""Progressive meshes beside the tools that a user would pick instead. `cargo xtask peers` builds and installs what this
needs and calls it."""

from __future__ import annotations

import argparse
import importlib.metadata
import json
import platform
import re
import sys
from pathlib import Path

import meshes
from commands import PeersError, progress
from project import Programs

PACKAGES = ("DracoPy", "pymeshlab", "fast_simplification", "numpy")
CRATES = ("meshopt", "zstd", "zstd-sys")


def main() -> int:
    options = _arguments()
    folder = options.programs.resolve()
    programs = Programs(options.ivg.resolve(), folder / "peers", folder / "peers-memory", options.out)
    options.out.mkdir(parents=True, exist_ok=True)
    try:
        files = meshes.find(options.meshes, meshes.chosen(options.only))
        {"mesh": _mesh, "picture": _picture, "levels": _levels}[options.what](files, programs, options)
    except PeersError as error:
        print(f"peers: {error}", file=sys.stderr)
        return 1
    return 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("mesh", "picture", "levels"))
    parser.add_argument("--meshes", type=Path, required=True, help="folder with the meshes")
    parser.add_argument(
        "--only", action="append", default=[], metavar="NAME", help="this mesh alone; may be repeated"
    )
    parser.add_argument("--quick", action="store_true", help="fewer repetitions and samples")
    parser.add_argument("--out", type=Path, required=True, help="folder for what is written")
    parser.add_argument("--ivg", type=Path, required=True, help="the command ivg")
    parser.add_argument("--programs", type=Path, required=True, help="folder with the programs built here")
    return parser.parse_args()


def _versions(programs: Programs) -> dict[str, str]:
    """What was measured."""
    name, version = programs.version().split(maxsplit=1)
    versions = {name: version}
    lock = (Path(__file__).parent / "Cargo.lock").read_text()
    for crate in CRATES:
        found = re.search(rf'name = "{crate}"\nversion = "([^"]+)"', lock)
        versions[f"{crate} (crate)"] = found.group(1) if found else "?"
    versions |= {f"{package} (PyPI)": importlib.metadata.version(package) for package in PACKAGES}
    return versions | {"Python": platform.python_version()}


def _mesh(files: dict[str, Path], programs: Programs, options: argparse.Namespace) -> None:
    import distance
    import measure
    import report

    distance.check(programs.out / "check")
    effort = measure.Effort.quick() if options.quick else measure.Effort()
    figures = {}
    for count, (name, path) in enumerate(files.items(), 1):
        progress(f"{name}: mesh {count} of {len(files)}")
        figures[name] = measure.mesh(name, path, programs, effort)
    versions = _versions(programs)
    made = report.Report(figures, effort)
    targets = [target.as_json() for target in made.targets]
    text = made.text(versions)
    (programs.out / "mesh.md").write_text(text)
    document = {"versions": versions, "meshes": figures, "targets": targets}
    (programs.out / "mesh.json").write_text(json.dumps(document, indent=1) + "\n")
    print(text, end="")
    progress(f"written: {programs.out / 'mesh.md'}, mesh.json")
    absent = [
        f"{name}: {form}" for name, m in figures.items() for form, found in m["project"].items() if not found
    ]
    if absent:
        raise PeersError(f"`ivg mesh` did not write {', '.join(absent)}")


def _picture(files: dict[str, Path], programs: Programs, options: argparse.Namespace) -> None:
    import picture

    for name, path in files.items():
        if name == "dragon" or options.only:
            print(picture.draw(name, path, programs))


def _levels(files: dict[str, Path], programs: Programs, options: argparse.Namespace) -> None:
    import levels

    text, faults = levels.check(files, programs)
    (programs.out / "levels.md").write_text(text)
    print(text, end="")
    if faults:
        raise PeersError(f"{faults} files are not there or have levels that are not valid")


if __name__ == "__main__":
    sys.exit(main())
