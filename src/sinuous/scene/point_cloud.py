"""Obstacles made of points: what a scanner or a depth camera sees, also in PLY, PCD, LAS, NPY and text files."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NoReturn, get_args

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.arguments import Number, Orientation, Rows, Vector
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, warn_of
from sinuous.base.text_tables import TableFormat, decode_table, read_table
from sinuous.scene.body_points import Belongs
from sinuous.scene.mesh_files import COMMENTS, load_geometry, said_of, said_of_file
from sinuous.scene.obstacles import Obstacle, Origin, Placement, box_around, check_file

Columns = Sequence[str] | Sequence[int]
"""Which columns of a text are x, y, z: names, or numbers, 1 = first."""

Invalid = Literal["refuse", "drop"]
"""What is done with points that are not finite: a sensor saw nothing there."""


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
    invalid : str
        What is done with points that are not finite, as organised clouds have them where nothing was seen: `refuse`, or
        `drop`, which leaves them out.

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

    def __init__(
        self, points: Rows, radius: Number | Vector, *, name: str | None = None, invalid: Invalid = "refuse"
    ) -> None:
        places, radii = _valid(points, radius, invalid)
        self._keep(name, _points=places, radii=radii)

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
    def _box(self) -> Floats | None:
        return box_around(self.points, self.radii[:, None]) if len(self.radii) else None

    def _content(self) -> dict[str, Any]:
        return {**super()._content(), "points": self.points}

    @property
    def radius(self) -> float | Floats:
        """One radius where all balls have the same, or all of them (m,); of an empty cloud that of the one before."""
        same = bool((self.radii == self.radii[:1]).all())
        return float((*self.radii[:1], vars(self).get("_radius_before", 0.0))[0]) if same else self.radii

    def seen_now(
        self, points: Rows, radius: Number | Vector | None, invalid: Invalid, ignored: Belongs
    ) -> "PointCloud":
        """The cloud that is seen in the place of this one; it may be empty.

        Parameters
        ----------
        points, radius, invalid
            As of `PointCloud`; by default the radius of this cloud.
        ignored : callable
            From points (m, 3) and radii (m,) to whether each is left out (m,).
        """
        given: Any = np.asarray(points, np.float64) if isinstance(points, list | tuple) and not len(points) else points
        own = self.radius if radius is None else radius
        if radius is None and not isinstance(own, float):
            raise InputError("radius", "missing", None, "one for every point: those before differ")
        empty = isinstance(given, np.ndarray) and given.size == 0
        if empty or (invalid == "drop" and isinstance(given, np.ndarray) and not np.isfinite(given).all(axis=-1).any()):
            checks.choice("invalid", invalid, get_args(Invalid))
            places, radii = np.empty((0, 3)), np.empty(0)
        else:
            places, radii = _valid(given, own, invalid)
            kept = ~ignored(places, radii)
            places, radii = places[kept], radii[kept]
        cloud = object.__new__(PointCloud)
        before = float(own) if isinstance(own, int | float) else 0.0
        cloud._keep(self.name, _points=checks.closed(places), radii=checks.closed(radii), _radius_before=before)
        return cloud

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
        columns: Columns | None = None,
        invalid: Invalid = "refuse",
    ) -> "PointCloud":
        """Read a cloud from a file: PLY (extra `mesh`), PCD, LAS, LAZ (extra `las`), NPY, XYZ, PTS, ASC, TXT, CSV, TSV.

        A point p of the file comes to lie at `rotation @ (scale * p) + position`. A text has one point a line, between
        commas, semicolons, tabs or spaces. Where its first line (or the comment before the rows) has names, the columns
        `x`, `y`, `z` are read, wherever they stand; without names the first three. `#` starts a comment, a whole number
        alone on a line counts the rows that follow, and decimals may have a comma. An NPY file has an array (..., 3)
        or fields x, y, z. Scales and offsets of a LAS file are applied, and its withheld points left out; its unit is
        told in a warning, as is what other headers say that changed nothing.

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
        columns : sequence of 3 str or int, optional
            Which columns of a text are x, y, z: their names, or their numbers (1 = first).
        invalid : str
            As of `PointCloud`; an empty cell is not finite, either.

        Raises
        ------
        InputError
            When the file cannot be read or holds no points, or as `PointCloud` does; when a text can be read in two
            ways, or has names and no x, y, z among them.
        """
        placement = Placement(scale, position, rotation, xyzw)
        if columns is not None:
            _check_columns(columns)
        try:
            read = read_points(Path(file), columns)
            if read.dtype.kind in "iu":
                read = read.astype(np.float64)
            kept, radii = _valid(read, radius, invalid)
            points = checks.points("points", placement.apply(kept))
        except InputError as error:
            raise error if error.key == "file" else error.in_file(file) from None
        cloud = cls(points, radii, name=name)
        said = {"columns": columns, "invalid": None if invalid == "refuse" else invalid}
        cloud._set(
            _source=Origin.of(file, **placement.arguments, radius=cloud.radius if kept is read else radius, **said)
        )
        return cloud


def _valid(points: Any, radius: Any, invalid: Any) -> tuple[Floats, Floats]:
    """Check points (m, 3) and radii (m,); those that are not finite are refused, or dropped from both."""
    checks.choice("invalid", invalid, get_args(Invalid))
    given = np.asarray(points) if not isinstance(points, str | bytes) else points
    if not isinstance(given, np.ndarray) or given.dtype.kind != "f" or given.ndim != 2 or given.shape[1] != 3:
        places = checks.points("points", points)
        return places, _radii(radius, len(places))
    finite = np.isfinite(given).all(axis=1)
    radii = _radii(radius, len(given))
    if finite.all():
        return checks.points("points", given), radii
    if invalid == "refuse":
        first = int(np.flatnonzero(~finite)[0])
        problem = f'{np.count_nonzero(~finite)} of {len(given)} points are not finite; invalid="drop" leaves them out'
        raise InputError(f"points[{first}]", problem, given[first].tolist(), "3 finite numbers")
    return checks.points("points", given[finite]), checks.closed(radii[finite])


def _check_columns(columns: Any) -> None:
    """Refuse what does not say three columns, by names or by numbers."""
    listed = isinstance(columns, list | tuple) and len(columns) == 3 and len(set(columns)) == 3
    if not listed or not (
        all(isinstance(each, str) for each in columns)
        or all(isinstance(each, int) and not isinstance(each, bool) and each > 0 for each in columns)
    ):
        raise InputError("columns", "", columns, "three names, or three numbers of columns (1 = first), of x, y, z")


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
        _organised(header, points, file)
        layout = _layout(header, names)
        columns = DECODERS[kind](data, layout, points)
        return np.stack([columns[axis].reshape(points).astype(np.float64) for axis in "xyz"], axis=-1)
    except InputError:
        raise
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


def _organised(header: dict[str, list[str]], points: int, file: str) -> None:
    """Refuse sizes that contradict each other, and say where a sensor stood if points are not as it saw them."""
    width, height = (_number(header, key, file) if key in header else None for key in ("WIDTH", "HEIGHT"))
    if width is not None and width * (height or 1) != points:
        _refuse(file, "POINTS", f"WIDTH x HEIGHT is {width * (height or 1)}", points, "as many")
    stood = " ".join(header.get("VIEWPOINT", []))
    if stood and [float(x) for x in stood.split()] != [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]:
        warn_of([f"{file}: its VIEWPOINT {stood} changed nothing: coordinates are as they stand"])


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


def read_points(file: Path, columns: Columns | None = None) -> NDArray[Any]:
    """Return the points (m, 3) of a file, the kind of which its name says; NaN where it has none.

    `columns` says which of a text are x, y, z: names, or numbers, 1 = first.

    Raises
    ------
    InputError
        When it cannot be read, is of another kind, or its content is no points.
    """
    check_file(file, (*READERS, *TEXTS))
    ending = file.suffix.lower()
    if columns is not None and ending not in TEXTS:
        raise InputError("columns", f"{ending} files say their own", columns, "none")
    points = _text(file, columns) if ending in TEXTS else READERS[ending](file)
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError("points", f"shape {points.shape}", points, "three columns x, y, z", str(file))
    return points


def _ply(file: Path) -> NDArray[Any]:
    warn_of(f"{file}: {note}" for note in said_of_file(file, COMMENTS[".ply"]))
    bodies = load_geometry(file)
    return np.concatenate([np.zeros((0, 3)), *(np.asarray(body.vertices, np.float64) for body in bodies)])


def _npy(file: Path) -> NDArray[Any]:
    try:
        with file.open("rb") as stream:
            array = np.asarray(np.lib.format.read_array(stream, allow_pickle=False))
    except (ValueError, EOFError) as error:
        reason = " ".join(str(error).split())
        raise InputError("file", f"cannot be read: {reason}", str(file), "an NPY file of numbers") from None
    if {"x", "y", "z"} <= set(array.dtype.names or ()):
        return np.stack([array[axis].ravel() for axis in "xyz"], axis=-1)
    return array.reshape(-1, 3) if array.ndim > 2 and array.shape[-1] == 3 else array


METRES = {"9001": 1.0, "9002": 0.3048, "9003": 1200.0 / 3937.0}
"""Metres in a unit of length, by its EPSG number: the metre, the foot, the survey foot."""

GEOGRAPHIC, UNIT, UNIT_OF_HEIGHT = 1024, 3076, 4099
"""Keys of GeoTIFF: what coordinates are (2: longitude and latitude), unit of x and y, and unit of z."""


def _las(file: Path) -> NDArray[Any]:
    """Points of a LAS or LAZ file, scaled and shifted as its header says, in its unit of x and y."""
    laspy = checks.needed("laspy", "las", "file", str(file))
    try:
        las = laspy.read(str(file))
        said, there = int(las.header.point_count), len(las.points)
        points = np.stack([np.asarray(axis, np.float64) for axis in (las.x, las.y, las.z)], axis=-1)
        kept = ~np.asarray(las.withheld, np.bool_)
        flat, units = _units_of_las(las.header.vlrs)
    except Exception as error:  # whatever a reader trips over, one in Rust included
        reason = " ".join(str(error).split())[:100] or type(error).__name__
        raise InputError("file", f"cannot be read: {reason}", str(file), "a LAS file") from None
    if said != there:
        raise InputError("file", f"truncated: its header says {said} points, and it has {there}", str(file), str(said))
    if not flat:
        problem = "x and y are degrees of longitude and latitude"
        raise InputError("file", problem, str(file), "coordinates of a map projection, which are lengths")
    notes = [f"{there - kept.sum()} withheld points were left out"] if not kept.all() else []
    if units:
        notes.append(f"its unit is {units[0]:.7g} m; numbers were multiplied by scale, and by nothing else")
    if len(set(units)) > 1:
        points[:, 2] *= units[1] / units[0]
        notes.append(f"z, the unit of which is {units[1]:.7g} m, was brought into that of x and y")
    warn_of(f"{file}: {note}" for note in notes)
    return points[kept]


def _units_of_las(records: Any) -> tuple[bool, list[float]]:
    """Whether x and y are lengths, and the metres in their unit, and in that of z, where records of a LAS file say it.

    In a text (WKT) the last unit is that of the projection; of a compound system, one for each part.
    """
    for record in records:
        if record.record_id == 34735:
            keys = {key.id: str(key.value_offset) for key in record.geo_keys}
            units = [METRES[keys[key]] for key in (UNIT, UNIT_OF_HEIGHT) if keys.get(key) in METRES]
            return keys.get(GEOGRAPHIC) != "2", units if keys.get(UNIT) in METRES else []
        if record.record_id == 2112:
            text = str(record.string)
            system, _, height = re.sub(r"\s+", "", text).partition("VERT")
            found = [re.findall(r'(?<![A-Z])(?:LENGTH)?UNIT\["[^"]*",([-+.0-9eE]+)', part) for part in (system, height)]
            flat = re.search(r"\b(PROJ|LOCAL_|ENG)", system) is not None
            return flat or "GEO" not in system, [float(each[-1]) for each in found if each] if flat else []
    return True, []


def _text(file: Path, columns: Columns | None) -> NDArray[Any]:
    text = decode_table(file.read_bytes())
    told = [each for each in columns or () if isinstance(each, str)]
    table, rows = read_table(text, told) if told else read_table(text)
    if not rows:
        return np.zeros((0, 3))
    head = text.splitlines()[: rows[0][0] - 1]
    warn_of(f"{file}: {note}" for note in said_of("\n".join(head)))
    places = _places(table, columns) if table.names or columns else _first_three(table, rows)
    table.warn_of_units(places, file)
    return table.read(rows, places)


def _places(table: TableFormat, columns: Columns | None) -> list[int]:
    """Where the columns x, y, z are, or those that are said: by their names or, 1 = first, by their numbers."""
    wanted: tuple[str | int, ...] = ("x", "y", "z") if columns is None else tuple(columns)
    names = " ".join(table.names or ()) or f"no names, {table.width} columns"
    places = []
    for each in wanted:
        place = table.place(each) if isinstance(each, str) else each - 1
        if place is None or not 0 <= place < table.width:
            problem = f"there is no column {each}" + ("" if columns else "; columns= says which are x, y, z")
            raise InputError("columns", problem, names, ", ".join(map(str, wanted)))
        places.append(place)
    return places


def _first_three(table: TableFormat, rows: list[tuple[int, str]]) -> list[int]:
    """The first three columns, where nothing says which are x, y, z: unless the first one counts the rows."""
    if table.width < 3:
        raise InputError("points", f"has {table.width} of three columns", rows[0][1], "x, y, z on every line")
    first = table.read(rows, [0])[:, 0]
    if table.width > 3 and len(first) > 1 and (np.diff(first) == 1.0).all():
        problem = "the first column counts the rows"
        raise InputError("columns", problem, rows[0][1], "columns= with the numbers of x, y, z, like (2, 3, 4)")
    return [0, 1, 2]


READERS: dict[str, Callable[[Path], NDArray[Any]]] = {
    ".ply": _ply,
    ".pcd": lambda file: parse_pcd(file.read_bytes(), str(file)),
    ".npy": _npy,
    ".las": _las,
    ".laz": _las,
}

TEXTS = (".xyz", ".txt", ".csv", ".pts", ".asc", ".tsv")
