"""`inputs`: files of points and meshes in every dialect, whole and broken, read right, refused, or noted.

What a file means is known, for it is written here: shuffled columns, separators, decimal commas, counts, names, axes,
units in headers, kinds of numbers, points that were not seen, files that were cut off. A file that is read as other
geometry without a note is wrong, and so is any exception but an `InputError`.
"""

import struct
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.harness.experiment import Part
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from sinuous.base.checks import Floats

FILES = 5000
"""Files of a whole run."""

ALIKE = 2e-3
"""How far a point may be from where it was written, in units of the file: texts have few digits, some files 32 bits."""

AXES = ("x", "y", "z")


class Written(NamedTuple):
    """A file, and what it means.

    Attributes
    ----------
    name : str
    content : bytes
    points : ndarray (m, 3)
        Where all is that the file holds, z up; of a mesh its corners.
    options : dict
        How it is read.
    whole : bool
        Whether it must be read; one that is not whole may be refused, or noted.
    """

    name: str
    content: bytes
    points: Floats
    options: dict[str, Any]
    whole: bool


def table(rng: Generator) -> Written:
    """A text of points, in one of many dialects."""
    points, form = (
        rng.normal(scale=100.0, size=(int(rng.integers(3, 30)), 3)),
        str(rng.choice(["%.6f", "%.5e", "%.4f"])),
    )
    names = list(AXES) + [str(each) for each in rng.choice(["id", "r", "g", "b", "nx", "intensity", "t"], 3, False)]
    names = names[: 3 + int(rng.integers(0, 4))]
    columns: dict[str, Any] = {"x": points[:, 0], "y": points[:, 1], "z": points[:, 2]}
    columns |= {name: np.arange(len(points)) * (1.0 if name == "id" else 0.5) for name in names[3:]}
    titled = rng.random() < 0.7
    order = rng.permutation(len(names)) if titled else np.arange(len(names))
    separator = str(rng.choice([",", ";", "\t", " ", ", ", "   "]))
    comma = rng.random() < 0.3
    rows = [[form % columns[names[i]][k] for i in order] for k in range(len(points))]
    lost = np.flatnonzero(rng.random(len(points)) < 0.2) if rng.random() < 0.2 else np.empty(0, np.intp)
    for k in lost:
        rows[k] = ["nan" if names[i] in AXES else cell for i, cell in zip(order, rows[k], strict=True)]
    if comma:
        rows = [[cell.replace(".", ",") for cell in row] for row in rows]
    lines = [separator.join(row) for row in rows]
    if titled:
        said = [str(rng.choice([names[i], names[i].upper()])) if names[i] in AXES else names[i] for i in order]
        lines.insert(0, str(rng.choice(["", "#", "//", "# "])) + separator.join(said))
    whole = not lost.size and not (comma and "," in separator)
    if rng.random() < 0.2:
        wrong = int(rng.random() < 0.3)
        lines.insert(int(titled and lines[0][:1] in "#/"), str(len(rows) + wrong))
        whole = whole and not wrong
    text = str(rng.choice(["\n", "\r\n"])).join(lines) + "\n"
    if rng.random() < 0.1:
        text, whole = text[: int(rng.integers(1, len(text)))], False
    options = {"radius": 1.0, "invalid": "drop"}
    kept = np.delete(points, lost, axis=0)
    ending = str(rng.choice(["csv", "txt", "xyz", "pts", "asc", "tsv"]))
    return Written(f"scan.{ending}", text.encode("utf-16" if rng.random() < 0.05 else "utf-8"), kept, options, whole)


def ply(rng: Generator) -> Written:
    """A PLY file of points, as text or binary, with properties in any order."""
    points, kind = _cloud(rng), str(rng.choice(["ascii", "binary_little_endian", "binary_big_endian"]))
    names = [str(each) for each in rng.permutation([*AXES, "quality"])]
    head = "".join(f"property float {name}\n" for name in names)
    columns = np.stack([points[:, AXES.index(n)] if n in AXES else np.ones(len(points)) for n in names], axis=1)
    sign = ">" if "big" in kind else "<"
    data = "".join(" ".join(f"{x:.6f}" for x in row) + "\n" for row in columns).encode()
    data = data if kind == "ascii" else columns.astype(sign + "f4").tobytes()
    header = f"ply\nformat {kind} 1.0\nelement vertex {len(points)}\n{head}end_header\n".encode()
    return _cut(rng, Written("scan.ply", header + data, _finite(points), _dropped(), True))


def pcd(rng: Generator) -> Written:
    """An organised PCD file, as text or binary, with fields in any order."""
    points, kind = _cloud(rng), str(rng.choice(["ascii", "binary"]))
    names = [str(each) for each in rng.permutation([*AXES, "intensity"])]
    size = int(rng.choice([4, 8]))
    columns = np.stack([points[:, AXES.index(n)] if n in AXES else np.ones(len(points)) for n in names], axis=1)
    data = "".join(" ".join(f"{x:.6f}" for x in row) + "\n" for row in columns).encode()
    data = data if kind == "ascii" else columns.astype(f"<f{size}").tobytes()
    fields = f"FIELDS {' '.join(names)}\nSIZE {' '.join([str(size)] * 4)}\nTYPE F F F F\nCOUNT 1 1 1 1\n"
    head = f"# .PCD v0.7\nVERSION 0.7\n{fields}WIDTH {len(points)}\nHEIGHT 1\nPOINTS {len(points)}\nDATA {kind}\n"
    return _cut(rng, Written("scan.pcd", head.encode() + data, _finite(points), _dropped(), True))


def npy(rng: Generator) -> Written:
    """An NPY file of points, of any kind of number."""
    kind = str(rng.choice(["f4", "f8", ">f8", "i2", "i8", "f2"]))
    points = _cloud(rng).astype(kind) if kind[-2] == "f" else rng.integers(-999, 999, (20, 3)).astype(kind)
    with tempfile.TemporaryFile() as file:
        np.save(file, np.asfortranarray(points) if rng.random() < 0.5 else points)
        file.seek(0)
        content = file.read()
    return _cut(rng, Written("scan.npy", content, _finite(points.astype(float)), _dropped(), True))


def stl(rng: Generator) -> Written:
    """An STL file, as text or binary, with a header that may say axes or units."""
    corners, faces = _box(rng)
    triangles = corners[faces]
    said = str(rng.choice(["", "SPACE=LPS", "UNITS=mm"], p=[0.6, 0.2, 0.2]))
    if rng.random() < 0.5:
        facets = "".join(
            "facet normal 0 0 0\nouter loop\n"
            + "".join(f"vertex {x:.6f} {y:.6f} {z:.6f}\n" for x, y, z in triangle)
            + "endloop\nendfacet\n"
            for triangle in triangles
        )
        end = str(rng.choice(["endsolid", "end solid", "ENDSOLID part"]))
        content = f"solid part {said}\n{facets}{end}\n".encode()
    else:
        content = said.encode().ljust(80) + struct.pack("<I", len(faces))
        for triangle in triangles:
            content += struct.pack("<12fH", 0, 0, 0, *triangle.ravel(), 0)
    return _cut(rng, Written("part.stl", content, corners, {"scale": 1.0}, True))


def of_trimesh(ending: str, rng: Generator) -> Written:
    """A mesh that trimesh writes; in a GLB file y is up, unless told otherwise."""
    import trimesh  # noqa: PLC0415

    corners, faces = _box(rng)
    y_up = ending == "glb"
    own = corners[:, [0, 2, 1]] * (1.0, 1.0, -1.0) if y_up else corners
    content: Any = trimesh.Trimesh(own, faces, process=False).export(file_type=ending)
    content = content.encode() if isinstance(content, str) else content
    return _cut(rng, Written(f"part.{ending}", content, corners, {"scale": 1.0}, True))


KINDS: dict[str, Callable[[Generator], Written]] = {
    "tables": table,
    "ply of points": ply,
    "pcd": pcd,
    "npy": npy,
    "stl": stl,
    "obj": partial(of_trimesh, "obj"),
    "ply of a mesh": partial(of_trimesh, "ply"),
    "glb": partial(of_trimesh, "glb"),
}


def _cloud(rng: Generator) -> Floats:
    points = rng.normal(scale=100.0, size=(int(rng.integers(3, 30)), 3))
    points[rng.random(len(points)) < (0.3 if rng.random() < 0.3 else 0.0)] = np.nan
    return points


def _box(rng: Generator) -> tuple[Floats, Any]:
    unit = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([face for a, b, c, d in sides for face in ((a, b, c), (a, c, d))])
    return unit * rng.uniform(1.0, 50.0, 3) + rng.normal(scale=50.0, size=3), faces


def _finite(points: Floats) -> Floats:
    return points[np.isfinite(points).all(axis=1)]


def _dropped() -> dict[str, Any]:
    return {"radius": 1.0, "invalid": "drop"}


def _cut(rng: Generator, own: Written) -> Written:
    """The same file, or in one of ten cases one that was cut off."""
    if rng.random() > 0.1:
        return own
    return own._replace(content=own.content[: int(rng.integers(1, len(own.content)))], whole=False)


def read(own: Written, folder: Path) -> str:
    """What becomes of a file: `right`, `noted`, `refused`, `refused whole`, `wrong` or `exception`."""
    file = folder / own.name
    file.write_bytes(own.content)
    kind: Any = sn.Mesh if "scale" in own.options else sn.PointCloud
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            found = kind.load(file, **own.options)
        except sn.InputError:
            return "refused whole" if own.whole and len(own.points) else "refused"
        except Exception:
            return "exception"
    places: Floats = found.vertices if kind is sn.Mesh else found.points
    noted = bool(said) or bool(getattr(found, "defects", ()))
    wanted = own.points
    if own.name.startswith("scan") and not own.whole:  # what a text that was cut off has lost cannot be known
        wanted, places = wanted[: len(places) - 1], places[:-1]
    if len(places) == len(wanted) and bool((_gaps(places, wanted) < ALIKE).all()):
        return "right"
    return "noted" if noted else "wrong"


def _gaps(places: Floats, points: Floats) -> Floats:
    gaps: Floats = np.linalg.norm(points[:, None] - places[None], axis=2).min(axis=1, initial=np.inf)
    return gaps


def read_all(kind: str, plan: Plan) -> Iterator[Line]:
    """Read files of a kind, half of all if these are tables, and count what becomes of them."""
    files = plan.count(FILES, 400) // (2 if kind == "tables" else 2 * (len(KINDS) - 1))
    found: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        for number in plan.track(range(files), kind, files):
            found[read(KINDS[kind](plan.rng(number, list(KINDS).index(kind))), Path(folder))] += 1
    for key, what in (("wrong", "other geometry without a note"), ("exception", "an exception but InputError")):
        yield Line(kind, f"{what}, of {files} files", float(found[key]), "files", Goal(0.0, correctness=True))
    told = ", ".join(f"{found[key]} {key}" for key in ("right", "noted", "refused", "refused whole"))
    yield Line(kind, "read right", 100.0 * found["right"] / files, "%", note=told)


PARTS: dict[str, Part] = {kind: partial(read_all, kind) for kind in KINDS}
"""What is measured, by name."""
