"""Points from PLY, PCD, NPY and text files."""

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from sinuous.errors import InputError
from sinuous.scene.meshes.mesh import load_geometry
from sinuous.scene.reading import check_file

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


def _pcd(file: Path) -> NDArray[Any]:
    return parse_pcd(file.read_bytes(), str(file))


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
    ".pcd": _pcd,
    ".npy": _npy,
    ".xyz": _text,
    ".txt": _text,
    ".csv": _text,
}
