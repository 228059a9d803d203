"""Coarse levels beside meshoptimizer's simplification to the same number of faces, in one picture."""

from __future__ import annotations

from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

import distance
import meshes
from commands import progress
from meshes import Mesh
from project import Programs

# Shares of the faces [%].
SHARES = (0.2, 1.0)
SIZE = (900, 680)
CAPTION = 56
# Turn about the vertical axis and tilt [degrees].
TURN, TILT = -20.0, 12.0
SAMPLES = 100_000


def draw(name: str, path: Path, programs: Programs) -> str:
    """One row for each share: the project's level, meshoptimizer's, the original. Says where the picture lies."""
    folder = programs.out / "picture"
    folder.mkdir(parents=True, exist_ok=True)
    plain = folder / f"{name}.ply"
    source = meshes.read(path)
    meshes.write(plain, source)
    progress(f"{name}: ordering")
    file, _ = programs.mesh(plain, "raw-f32", "--mode", "raw", "--positions", "f32")
    cells: list[tuple[Path, str]] = []
    for share in SHARES:
        # A surface has about half as many vertices as faces.
        level = max(4, int(source.faces * share / 200) + 3)
        theirs, ours = folder / f"{name}.meshopt.{share:g}.ply", folder / f"{name}.project.{share:g}.ply"
        programs.extract(file, level, ours)
        # The same form of file as all others here.
        extracted = meshes.read(ours)
        meshes.write(ours, extracted)
        reached = programs.measure("simplify", plain, "--faces", extracted.faces, "-o", theirs)["faces"]
        found = distance.distances(plain, SAMPLES, [ours, theirs])
        titles = (
            f"ivg extract --level {level}: {extracted.faces:,} faces",
            f"meshopt_simplify: {reached:,} faces",
        )
        for mesh, title, far in zip((ours, theirs), titles, found):
            progress(f"{name}: {title}")
            caption = f"{title}\nmean {far['mean']:.3f} %, max {far['max']:.2f} % of the diagonal"
            cells.append((_drawn(mesh, source, programs), caption))
        cells.append(
            (
                _drawn(plain, source, programs),
                f"original: {source.faces:,} faces\nbeside it about {share:g} % of them",
            )
        )
    out = programs.out / f"{name}.png"
    _sheet(cells, 3).save(out)
    return f"picture: {out}"


def _drawn(mesh: Path, source: Mesh, programs: Programs) -> Path:
    low, high = source.points.min(axis=0), source.points.max(axis=0)
    centre = ",".join(f"{x:.8g}" for x in (low + high) / 2)
    radius = float((high - low).max()) * 0.42
    picture = mesh.with_suffix(".ppm")
    view = ("--turn", TURN, "--tilt", TILT, "--centre", centre, "--radius", radius)
    programs.measure("draw", mesh, *view, "--size", f"{SIZE[0]},{SIZE[1]}", "-o", picture)
    return picture


def _sheet(cells: list[tuple[Path, str]], columns: int) -> Image.Image:
    rows = -(-len(cells) // columns)
    width, height = SIZE[0], SIZE[1] + CAPTION
    sheet = Image.new("RGB", (columns * width, rows * height), (16, 17, 20))
    pen = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(size=20)
    for k, (picture, caption) in enumerate(cells):
        left, top = k % columns * width, k // columns * height
        with Image.open(picture) as image:
            sheet.paste(image, (left, top + CAPTION))
        pen.multiline_text((left + 12, top + 4), caption, fill=(235, 235, 235), font=font)
    return sheet
