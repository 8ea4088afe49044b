"""Points from PCD files, version 0.7 of the Point Cloud Library: ascii, binary and binary_compressed."""

from collections.abc import Callable
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from sinuous.errors import InputError

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
