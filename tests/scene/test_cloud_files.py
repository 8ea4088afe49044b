"""PCD files: three kinds of data, other fields beside the coordinates, and damage."""

import contextlib
import struct
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sinuous.errors import InputError
from sinuous.scene.cloud_files import expand_lzf, parse_pcd

POINTS = np.random.default_rng(0).normal(size=(50, 3)).astype("<f4")
RECORD = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("normal", "<f8", (3,)), ("rgb", "<u4"), ("_", "<i2")])


def table() -> np.ndarray:
    result = np.zeros(len(POINTS), RECORD)
    for i, axis in enumerate("xyz"):
        result[axis] = POINTS[:, i]
    result["rgb"], result["_"] = np.arange(50) + 1000, -7
    return result


def header(kind: str, points: int = 50) -> bytes:
    return (
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z normal rgb _\nSIZE 4 4 4 8 4 2\n"
        f"TYPE F F F F U I\nCOUNT 1 1 1 3 1 1\nWIDTH {points}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
        f"POINTS {points}\nDATA {kind}\n"
    ).encode()


def literal(data: bytes) -> bytes:
    """The plainest LZF: no copies at all."""
    return b"".join(bytes([len(data[i : i + 32]) - 1]) + data[i : i + 32] for i in range(0, len(data), 32))


def compressed(data: bytes) -> bytes:
    """Greedy LZF: the longest copy of what came before, else one byte as it is."""
    out, at = bytearray(), 0
    while at < len(data):
        best, back = 0, 0
        for start in range(max(0, at - 8192), at):
            length = 0
            while at + length < len(data) and length < 264 and data[start + length] == data[at + length]:
                length += 1
            if length > best:
                best, back = length, at - start - 1
        if best < 3:
            out += bytes([0, data[at]])
            at += 1
        elif best < 9:
            out += bytes([(best - 2) << 5 | back >> 8, back & 255])
            at += best
        else:
            out += bytes([7 << 5 | back >> 8, best - 9, back & 255])
            at += best
    return bytes(out)


def by_field(records: np.ndarray) -> bytes:
    assert records.dtype.names is not None
    return b"".join(np.ascontiguousarray(records[name]).tobytes() for name in records.dtype.names)


def ascii_rows() -> bytes:
    rows = [[*row[:3], *map(float, row[3]), *row[4:]] for row in table().tolist()]
    return "".join(" ".join(map(repr, row)) + "\n" for row in rows).encode()


def packed(plain: bytes, squeeze: object = literal) -> bytes:
    data = compressed(plain) if squeeze is compressed else literal(plain)
    return struct.pack("<II", len(data), len(plain)) + data


@pytest.mark.parametrize(
    ("kind", "data"),
    [
        ("ascii", ascii_rows()),
        ("binary", table().tobytes()),
        ("binary_compressed", packed(by_field(table()))),
        ("binary_compressed", packed(by_field(table()), compressed)),
    ],
)
def test_every_kind_of_data(kind: str, data: bytes) -> None:
    points = parse_pcd(header(kind) + data, "a.pcd")
    assert points.dtype == np.float64
    np.testing.assert_allclose(points, POINTS, atol=1e-7)


@given(st.binary(max_size=300) | st.lists(st.sampled_from([b"abc", b"a" * 50, b"xyz123"])).map(b"".join))
def test_expanding_undoes_compressing(data: bytes) -> None:
    assert expand_lzf(compressed(data), len(data)) == data
    assert expand_lzf(literal(data), len(data)) == data


@given(st.binary(max_size=60), st.integers(0, 100))
def test_damaged_compression_is_an_error_and_no_crash(data: bytes, size: int) -> None:
    with contextlib.suppress(ValueError, IndexError):
        assert len(expand_lzf(data, size)) == size


def refuse(content: bytes, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        parse_pcd(content, "a.pcd")
    assert "\n" not in str(caught.value)


def test_damage_is_refused() -> None:
    refuse(b"", r"a\.pcd: file: .*no PCD header")
    refuse(b"\x00" * 100_000, "no PCD header")
    refuse(
        header("ascii").replace(b"x y z", b"x y w") + b"",
        r"a\.pcd: FIELDS: expected .* x y z, got .*no z\)",
    )
    refuse(header("zip"), r"a\.pcd: DATA: expected one of ascii, binary, binary_compressed, got 'zip'")
    refuse(header("ascii").replace(b"POINTS 50", b"POINTS many"), r"POINTS: expected a whole number, got ")
    refuse(header("ascii").replace(b"POINTS 50\n", b""), r"POINTS: expected a whole number, got ")
    refuse(header("ascii").replace(b"COUNT 1 1 1 3 1 1", b"COUNT 1 1"), r"DATA: expected .* \(cannot be read\)")
    refuse(header("ascii").replace(b"SIZE 4 4 4", b"SIZE 4 4 5"), r"DATA: expected .* \(cannot be read\)")
    refuse(header("ascii").replace(b"TYPE F", b"TYPE C"), r"DATA: expected .* \(cannot be read\)")
    refuse(header("ascii").replace(b"SIZE 4 4 4 8 4 2\n", b""), r"DATA: expected .* \(cannot be read\)")
    refuse(header("ascii") + b"1 2 3\n", "50 points as the header says")
    refuse(header("ascii") + b"one two\n" * 200, r"DATA: expected .* \(cannot be read\)")
    refuse(header("binary") + table().tobytes()[:-1], r"DATA: expected .* \(cannot be read\)")
    refuse(header("binary_compressed") + b"\x00", r"DATA: expected .* \(cannot be read\)")
    whole = packed(by_field(table()))
    refuse(header("binary_compressed") + whole[:-1], r"DATA: expected .* \(cannot be read\)")
    refuse(header("binary_compressed", 49) + whole, r"DATA: expected .* \(cannot be read\)")


@given(st.integers(0, 2**32), st.sampled_from(["ascii", "binary", "binary_compressed"]))
def test_no_damage_escapes(seed: int, kind: str) -> None:
    rng = np.random.default_rng(seed)
    data = {"ascii": ascii_rows(), "binary": table().tobytes()}.get(kind) or packed(by_field(table()))
    content = bytearray(header(kind) + data)
    for _ in range(5):
        content[rng.integers(len(content))] = rng.integers(256)
    with contextlib.suppress(InputError):
        partial(parse_pcd, bytes(content), "a.pcd")()
