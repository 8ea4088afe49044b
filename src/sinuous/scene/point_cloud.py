"""Obstacles made of points: what a scanner or a depth camera sees, also in PLY, PCD, NPY and text files."""

import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.arguments import Number, Orientation, Rows, Vector
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.scene.mesh import load_geometry
from sinuous.scene.obstacles import Obstacle, Origin, Placement, box_around, check_file


@dataclass(frozen=True, init=False, eq=False, repr=False)
class PointCloud(Obstacle):
    """The union of balls about points.

    Parameters
    ----------
    points : array_like (m, 3)
        In the world; at least one.
    radius : float or array_like (m,)
        Of the balls, at least 0: one for all, or one for each point. Half the spacing of a scan closes its gaps.
    name : str, optional

    Attributes
    ----------
    points : ndarray (m, 3)
    radii : ndarray (m,)

    Raises
    ------
    InputError
        When there is no point, or something is not finite, negative, or of the wrong shape.
    """

    radii: Floats

    def __init__(self, points: Rows, radius: Number | Vector, *, name: str | None = None) -> None:
        places = checks.points("points", points)
        self._keep(name, _points=places, radii=_radii(radius, len(places)))

    @property
    def points(self) -> Floats:
        """Centers (m, 3) of the balls, in the world."""
        own: Floats = vars(self)["_points"]
        return self._in_place(own)

    @property
    def kind(self) -> str:
        """See `Obstacle.kind`."""
        return "points"

    @property
    def _box(self) -> Floats:
        return box_around(self.points, self.radii[:, None])

    def _content(self) -> dict[str, Any]:
        return {**super()._content(), "points": self.points}

    @property
    def radius(self) -> float | Floats:
        """One radius where all balls have the same, or all of them (m,)."""
        return self.radii if (self.radii != self.radii[0]).any() else float(self.radii[0])

    @classmethod
    def load(
        cls,
        file: str | Path,
        radius: Number | Vector,
        scale: Number = 1.0,
        position: Vector | None = None,
        rotation: Orientation | None = None,
        name: str | None = None,
        *,
        xyzw: Vector | None = None,
    ) -> "PointCloud":
        """Read a cloud from a PLY (needs the extra `mesh`), PCD, NPY, XYZ, TXT or CSV file.

        A point p of the file comes to lie at `rotation @ (scale * p) + position`. A text has one point a line, three
        numbers or more between commas or spaces, of which the first three count; `#` starts a comment, and the first
        line may hold names. An NPY file has an array (m, 3).

        Parameters
        ----------
        file : path
        radius : float or array_like (m,)
            In the unit of the scene.
        scale : float
            Length unit of the scene over that of the file.
        position : array_like (3,), optional
            Where the origin of the file lies.
        rotation : array_like (3, 3) or (4,), or Rotation of SciPy, optional
            A matrix or a quaternion wxyz.
        name : str, optional
        xyzw : array_like (4,), optional
            A quaternion in the order of SciPy and ROS, instead of `rotation`.

        Raises
        ------
        InputError
            When the file cannot be read or holds no points, or as `PointCloud` does.
        """
        placement = Placement(scale, position, rotation, xyzw)
        try:
            points = checks.points("points", placement.apply(checks.points("points", read_points(Path(file)))))
        except InputError as error:
            raise error if error.key == "file" else error.in_file(file) from None
        cloud = cls(points, radius, name=name)
        cloud._set(_source=Origin.of(file, **placement.arguments, radius=cloud.radius))
        return cloud


def _radii(radius: Any, count: int) -> Floats:
    """Check one radius for all, or one for each of `count` points; return all of them, read-only."""
    if np.ndim(radius) == 0 or isinstance(radius, str):
        return checks.closed(np.full(count, checks.number("radius", radius, low=0.0)))
    radii = checks.array("radius", radius, (count,))
    if (radii < 0.0).any():
        first = int(radii.argmin())
        raise InputError(f"radius[{first}]", "", float(radii[first]), "a number of at least 0")
    return radii


TYPES = {"F": "f", "I": "i", "U": "u"}


def parse_pcd(content: bytes, file: str) -> NDArray[Any]:
    """Return the columns x, y, z (m, 3) of a PCD file; other fields are passed over.

    Raises
    ------
    InputError
        When the header or the data are not those of such a file.
    """
    header, data = _header(content, file)
    names, kind = header.get("FIELDS", []), header.get("DATA", [""])[0]
    for axis in "xyz":
        if axis not in names:
            _refuse(file, "FIELDS", f"has no {axis}", " ".join(names), "the fields x y z")
    if kind not in DECODERS:
        _refuse(file, "DATA", "", kind, "one of " + ", ".join(DECODERS))
    points = _number(header, "POINTS", file)
    try:
        layout = _layout(header, names)
        columns = DECODERS[kind](data, layout, points)
        return np.stack([columns[axis].reshape(points).astype(np.float64) for axis in "xyz"], axis=-1)
    except (ValueError, KeyError, IndexError, TypeError) as error:
        _refuse(file, "DATA", "cannot be read", " ".join(str(error).split()), f"{points} points as the header says")


def _header(content: bytes, file: str) -> tuple[dict[str, list[str]], bytes]:
    """Entries of the header by their names, and what follows it."""
    entries: dict[str, list[str]] = {}
    at = 0
    while "DATA" not in entries:
        end = content.find(b"\n", at)
        if end < 0 or at > 65536:
            _refuse(file, "file", "cannot be read: no PCD header", content[:20], "a PCD file")
        words = content[at:end].decode("ascii", "replace").split("#")[0].split()
        if words:
            entries[words[0].upper()] = words[1:] or [""]
        at = end + 1
    return entries, content[at:]


def _number(header: dict[str, list[str]], key: str, file: str) -> int:
    text = header.get(key, [""])[0]
    if not text.isdecimal() or len(text) > 12:
        _refuse(file, key, "", text, "a whole number")
    return int(text)


def _layout(header: dict[str, list[str]], names: list[str]) -> np.dtype[Any]:
    """Layout of one point: unused fields are all called `_`, so they get names of their own."""
    counts = header.get("COUNT", ["1"] * len(names))
    parts = zip(names, header["TYPE"], header["SIZE"], counts, strict=True)
    return np.dtype(
        [
            (name if name in ("x", "y", "z") else f"{i} {name}", f"<{TYPES[kind]}{int(size)}", (int(count),))
            for i, (name, kind, size, count) in enumerate(parts)
        ]
    )


def _ascii(data: bytes, layout: np.dtype[Any], points: int) -> dict[str, NDArray[Any]]:
    assert layout.names is not None
    widths = [int(np.prod(layout[name].shape)) for name in layout.names]
    table = np.array(data.split(), np.float64).reshape(points, sum(widths))
    return dict(zip(layout.names, np.split(table, np.cumsum(widths)[:-1], axis=1), strict=True))


def _compressed(data: bytes, layout: np.dtype[Any], points: int) -> dict[str, NDArray[Any]]:
    """Undo LZF, and the order of such files: all values of the first field, then all of the second."""
    assert layout.names is not None
    packed, full = (int(n) for n in np.frombuffer(data, "<u4", 2))
    if full != points * layout.itemsize:
        raise ValueError(f"{full} bytes of data")
    plain = expand_lzf(data[8 : 8 + packed], full)
    columns, at = {}, 0
    for name in layout.names:
        size = layout[name].itemsize * points
        columns[name] = np.frombuffer(plain[at : at + size], layout[name].base)
        at += size
    return columns


def expand_lzf(data: bytes, size: int) -> bytes:
    """Expand data of Lehmann's LZF to `size` bytes.

    A control byte c below 32 announces c + 1 bytes as they are; any other a copy of c // 32 + 2 bytes (for 7, another
    byte adds to the length) from as far back as its lower five bits and the next byte say, plus one.

    Raises
    ------
    ValueError
        When the data are not such, or of another size.
    """
    out, at = bytearray(), 0
    while at < len(data) and len(out) <= size:
        control = data[at]
        at += 1
        if control < 32:
            out += data[at : at + control + 1]
            at += control + 1
            continue
        length = control >> 5
        if length == 7:
            length += data[at]
            at += 1
        back = ((control & 31) << 8 | data[at]) + 1
        at += 1
        if back > len(out):
            raise ValueError("damaged compression")
        piece = out[len(out) - back : len(out) - back + length + 2]  # repeated where it runs into itself
        out += (piece * (length // back + 2))[: length + 2]
    if len(out) != size:
        raise ValueError(f"{len(out)} bytes after expanding, not {size}")
    return bytes(out)


DECODERS: dict[str, Callable[[bytes, np.dtype[Any], int], Any]] = {
    "ascii": _ascii,
    "binary": np.frombuffer,
    "binary_compressed": _compressed,
}


def _refuse(file: str, key: str, problem: str, value: Any, expected: str) -> NoReturn:
    raise InputError(key, problem, value, expected, file) from None


def read_points(file: Path) -> NDArray[Any]:
    """Return the points (m, 3) of a file, the kind of which its name says.

    Raises
    ------
    InputError
        When it cannot be read, is of another kind, or its content is no points.
    """
    check_file(file, tuple(READERS))
    points = READERS[file.suffix.lower()](file)
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError("points", f"shape {points.shape}", points, "three columns x, y, z", str(file))
    return points


def _ply(file: Path) -> NDArray[Any]:
    bodies = load_geometry(file).dump()
    return np.concatenate([np.zeros((0, 3)), *(np.asarray(body.vertices, np.float64) for body in bodies)])


def _npy(file: Path) -> NDArray[Any]:
    try:
        with file.open("rb") as stream:
            return np.asarray(np.lib.format.read_array(stream, allow_pickle=False))
    except (ValueError, EOFError) as error:
        reason = " ".join(str(error).split())
        raise InputError("file", f"cannot be read: {reason}", str(file), "an NPY file of numbers") from None


def _text(file: Path) -> NDArray[Any]:
    lines = file.read_bytes().decode("utf-8-sig", "replace").replace(",", " ").replace(";", " ").splitlines()
    first = next((i for i, line in enumerate(lines) if line.split("#")[0].strip()), 0)
    if first < len(lines) and not any(map(_is_number, lines[first].split())):
        lines[first] = ""
    filled = [line for line in lines if line.split("#")[0].strip()]
    if not filled:
        return np.zeros((0, 3))
    columns = len(filled[0].split("#")[0].split())
    if columns < 3:
        raise InputError("points", f"has {columns} of three columns", filled[0], "x, y, z on every line", str(file))
    try:
        return np.loadtxt(io.StringIO("\n".join(filled)), usecols=(0, 1, 2), ndmin=2)
    except ValueError as error:
        reason = " ".join(str(error).split()).split(";")[0]
        raise InputError("points", "", reason, "x, y, z on every line", str(file)) from None


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


READERS: dict[str, Callable[[Path], NDArray[Any]]] = {
    ".ply": _ply,
    ".pcd": lambda file: parse_pcd(file.read_bytes(), str(file)),
    ".npy": _npy,
    ".xyz": _text,
    ".txt": _text,
    ".csv": _text,
}
