"""Clouds: files of every kind, radii, and bad input."""

import contextlib
import struct
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sinuous.base.errors import InputError, SuspiciousInput
from sinuous.scene.point_cloud import PointCloud, expand_lzf, parse_pcd
from tests.helpers import NOT_NUMBERS, Unpickled, present, random_rotation, refused, refused_each, with_each

POINTS = np.random.default_rng(0).normal(size=(20, 3)).round(3)


def save_las(file: Path, record: Any = None, withheld: int = 0) -> None:
    laspy = pytest.importorskip("laspy")
    head = laspy.LasHeader(point_format=6)
    head.scales, head.offsets = [1e-3] * 3, [1e3, -2e3, 3.0]
    head.vlrs.extend([] if record is None else [record])
    las = laspy.LasData(head)
    las.x, las.y, las.z = POINTS.T
    las.withheld = np.arange(20) < withheld
    las.write(str(file))


def save(folder: Path, kind: str) -> Path:
    file = folder / f"scan.{kind}"
    if kind == "npy":
        np.save(file, POINTS)
    elif kind == "ply":
        trimesh = pytest.importorskip("trimesh")
        trimesh.PointCloud(POINTS).export(file)
    elif kind in ("las", "laz"):
        save_las(file)
    elif kind == "pcd":
        head = "VERSION .7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nWIDTH 20\nHEIGHT 1\nPOINTS 20\nDATA ascii\n"
        file.write_text(head + "".join(f"{x} {y} {z}\n" for x, y, z in POINTS.tolist()))
    else:
        between = "," if kind == "csv" else " "
        rows = [between.join(map(str, [*row, 255])) for row in POINTS.tolist()]
        file.write_text("\n".join([f"x{between}y{between}z{between}red" if kind == "csv" else "# scan", *rows, "", ""]))
    return file


@pytest.mark.parametrize("kind", ["ply", "pcd", "las", "laz", "npy", "xyz", "txt", "csv"])
def test_files_of_every_kind(tmp_path: Path, kind: str) -> None:
    turn = random_rotation(np.random.default_rng(1))
    cloud = PointCloud.load(save(tmp_path, kind), 0.1, 1e-3, (1, 2, 3), turn, "scan")
    np.testing.assert_allclose(cloud.points, 1e-3 * POINTS @ turn.T + (1, 2, 3), atol=1e-9)
    assert cloud.radii.max() == 0.1
    assert cloud.name == "scan"
    np.testing.assert_allclose(PointCloud.load(save(tmp_path, kind), 0.1).points, POINTS, atol=1e-6)


@with_each("points", [np.zeros((4, 1)), np.zeros(4), np.zeros((2, 2, 3)), 3.0, "abc", None, {"x": 1}])
def test_what_is_no_list_of_points_is_refused(points: Any) -> None:
    refused("points", lambda: PointCloud(points, 1.0), "point")


def test_bad_points_are_refused() -> None:
    refused_each("points", ([], np.zeros((0, 3))), lambda value: PointCloud(value, 1.0), "at least one point")
    for bad in (np.nan, np.inf):
        wrong = POINTS.copy()
        wrong[7, 1] = bad
        refused("points[7]", partial(PointCloud, wrong, 1.0), "expected 3 finite numbers")
    refused("points", lambda: PointCloud([[0, 0, True]], 1.0), "rows of 3 finite numbers")


def test_bad_radii_are_refused() -> None:
    refused_each("radius", [*NOT_NUMBERS, -1.0], lambda value: PointCloud(POINTS, value))
    refused("radius", lambda: PointCloud(POINTS, np.ones(19)), "20 finite numbers")
    refused("radius[4]", lambda: PointCloud(POINTS, np.where(np.arange(20) == 4, -1.0, 1.0)), "at least 0")


def test_bad_files_are_refused(tmp_path: Path) -> None:
    def load(name: str, content: str) -> PointCloud:
        (tmp_path / name).write_text(content)
        return PointCloud.load(tmp_path / name, 1.0)

    for name, content, message in (
        ("one.xyz", "1\n2\n", r"one\.xyz: line 1: the table cannot be read; expected rows .*, got '1'"),
        ("two.xyz", "1 2\n3 4\n", r"two\.xyz: points: has 2 of three columns; expected x, y, z on every line"),
        ("two.csv", "x,y\n1,2\n", r"two\.csv: columns: there is no column z; columns= says which .*, got 'x y'"),
        ("words.txt", "1 2 3\n1 two 3\n", r"words\.txt: line 2\.column 2: expected a finite number, got 'two'"),
        ("short.txt", "1 2 3\n1 2 3\n1 2\n", r"short\.txt: line 3: has 2 cells; expected 3, got '1 2'"),
        ("nothing.xyz", "# no points\n\n", r"nothing\.xyz: points: expected at least one point"),
        ("hole.xyz", "1 2 3\n1 nan 3\n", r"hole\.xyz: points\[1\]: 1 of 2 points .*, got \[1\.0, nan"),
        ("a.npy", "no array", "^file: cannot be read: .*; expected "),
        ("a.ply", "no points", "^file: cannot be read: .*; expected "),
        ("a.pcd", "no points", r"a\.pcd: file: cannot be read: no PCD header; expected a PCD file, got .*"),
        ("a.e57", "", r"^file: expected a name that ends in \.ply"),
    ):
        with pytest.raises(InputError, match=message):
            load(name, content)
    refused("file", lambda: PointCloud.load(tmp_path / "none.xyz", 1.0), "No such file")
    refused_each("scale", (0.0, -1.0, "1"), lambda value: PointCloud.load(tmp_path / "none.xyz", 1.0, value))


def test_columns_are_told_by_their_names(tmp_path: Path) -> None:
    def load(content: str, **options: Any) -> np.ndarray:
        (tmp_path / "scan.csv").write_text(content)
        return PointCloud.load(tmp_path / "scan.csv", 1.0, **options).points

    for content in ("id,x,y,z\n7,1,2,3\n9,4,5,6\n", "z;y;x\n3,0;2,0;1,0\n6,0;5,0;4,0\n", "//Z X Y\n3 1 2\n6 4 5\n"):
        np.testing.assert_array_equal(load(content), [(1, 2, 3), (4, 5, 6)], err_msg=content)
    np.testing.assert_array_equal(load("a,b,c\n1,2,3\n", columns=("c", "a", "b")), [(3, 1, 2)])
    np.testing.assert_array_equal(load("1 2 3 4\n2 3 4 5\n", columns=(2, 3, 4)), [(2, 3, 4), (3, 4, 5)])
    with pytest.warns(SuspiciousInput, match=r"scan\.csv: the header says m; numbers are taken as they stand"):
        load("x [m],y [m],z [m]\n1,2,3\n")
    for content, told in (
        ("a,b,c\n1,2,3\n", "columns: there is no column x"),
        ("1 2 3 4\n2 3 4 5\n", "columns: the first column counts the rows; expected columns= with the numbers"),
        ("X,Y,Z,X\n1,2,3,4\n", "columns: x is there twice"),
        ("0,63,149,34,153,20\n", "line 1: commas may be separators or decimal signs"),
    ):
        with pytest.raises(InputError, match=told):
            load(content)
    refused_each("columns", ("xyz", (1, 2), (0, 1, 2), ("x", "y", 3), (1, 1, 2)), lambda c: load("1 2 3\n", columns=c))
    words = "there is no column 4; expected 2, 3, 4, got 'no names"
    refused("columns", lambda: load("1 2 3\n", columns=(2, 3, 4)), words, file=tmp_path / "scan.csv")


def test_points_that_are_not_finite_are_dropped_where_asked(tmp_path: Path) -> None:
    places, radii = POINTS.copy(), np.arange(20.0)
    places[3], places[8] = np.nan, np.inf
    kept = np.delete(np.arange(20), [3, 8])
    cloud = PointCloud(places, radii, invalid="drop")
    np.testing.assert_array_equal(cloud.points, POINTS[kept])
    np.testing.assert_array_equal(cloud.radii, radii[kept])
    refused("points[3]", lambda: PointCloud(places, 1.0), 'invalid="drop" leaves them out')
    refused("invalid", lambda: PointCloud(places, 1.0, invalid="keep"), "refuse or drop")  # type: ignore[arg-type]
    np.save(tmp_path / "scan.npy", places)
    loaded = PointCloud.load(tmp_path / "scan.npy", 1.0, invalid="drop")
    np.testing.assert_array_equal(loaded.points, POINTS[kept])
    assert present(loaded.source).arguments["invalid"] == "drop"
    refused("points", lambda: PointCloud(np.full((2, 3), np.nan), 1.0, invalid="drop"), "at least one point")


FEET = 'COMPD_CS["a",PROJCS["b",GEOGCS["c",UNIT["degree",0.0175]],UNIT["metre", 1]],VERT_CS["d",UNIT["foot",0.3048]]]'


def test_las_files_say_units_and_what_is_withheld(tmp_path: Path) -> None:
    known, file = pytest.importorskip("laspy").vlrs.known, tmp_path / "a.las"
    save_las(file, known.WktCoordinateSystemVlr(FEET), withheld=2)
    with pytest.warns(SuspiciousInput) as told:
        points = PointCloud.load(file, 0.1).points
    np.testing.assert_allclose(points, POINTS[2:] * (1.0, 1.0, 0.3048), atol=1e-9)
    for each, wanted in zip(
        told, ("2 withheld points", "its unit is 1 m", "z, the unit of which is 0.3048"), strict=True
    ):
        assert wanted in str(each.message)
    keys = known.GeoKeyDirectoryVlr()
    keys.geo_keys = [known.GeoKeyEntryStruct(id=1024, count=1, value_offset=2)]
    keys.geo_keys_header.number_of_keys = 1
    for record in (known.WktCoordinateSystemVlr('GEOGCS["c",UNIT["degree",0.0175]]'), keys):
        save_las(file, record)
        refused("file", lambda: PointCloud.load(file, 0.1), "degrees of longitude and latitude")
    save_las(file)
    whole = file.read_bytes()
    for size in (0, 100, 300, len(whole) - 30 * 5, len(whole) - 1):
        file.write_bytes(whole[:size])
        refused("file", lambda: PointCloud.load(file, 0.1), "truncated" if size == len(whole) - 150 else "file")


def test_organised_arrays_and_headers(tmp_path: Path) -> None:
    named = np.zeros(20, [("t", "f8"), ("z", "f8"), ("y", "f8"), ("x", "f8")])
    for i, axis in enumerate("xyz"):
        named[axis] = POINTS[:, i]
    for array in (POINTS.reshape(4, 5, 3), named):
        np.save(tmp_path / "a.npy", array)
        np.testing.assert_array_equal(PointCloud.load(tmp_path / "a.npy", 0.1).points, POINTS)
    (tmp_path / "a.xyz").write_text("# units: mm\n" + "".join("{} {} {}\n".format(*p) for p in POINTS.tolist()))
    with pytest.warns(SuspiciousInput, match="its header says UNITS=mm"):
        PointCloud.load(tmp_path / "a.xyz", 0.1)
    pcd = header("ascii").replace(b"VIEWPOINT 0", b"VIEWPOINT 4") + b"1 2 3 0 0 0 0 0\n" * 50
    with pytest.warns(SuspiciousInput, match="its VIEWPOINT 4 0 0 1 0 0 0 changed nothing"):
        parse_pcd(pcd, "a.pcd")
    refuse(pcd.replace(b"HEIGHT 1", b"HEIGHT 2"), r"a\.pcd: POINTS: WIDTH x HEIGHT is 100")


def test_arrays_of_objects_are_never_unpickled(tmp_path: Path) -> None:
    file = tmp_path / "evil.npy"
    np.save(file, np.array([Unpickled()], object), allow_pickle=True)
    refused("file", lambda: PointCloud.load(file, 1.0), "cannot be read")


IN_FILES = np.random.default_rng(0).normal(size=(50, 3)).astype("<f4")
RECORD = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("normal", "<f8", (3,)), ("rgb", "<u4"), ("_", "<i2")])


def table() -> np.ndarray:
    result = np.zeros(len(IN_FILES), RECORD)
    for i, axis in enumerate("xyz"):
        result[axis] = IN_FILES[:, i]
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
    np.testing.assert_allclose(points, IN_FILES, atol=1e-7)


@given(st.binary(max_size=300) | st.lists(st.sampled_from([b"abc", b"a" * 50, b"xyz123"])).map(b"".join))
def test_expanding_undoes_compressing(data: bytes) -> None:
    assert expand_lzf(compressed(data), len(data)) == data
    assert expand_lzf(literal(data), len(data)) == data


def refuse(content: bytes, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        parse_pcd(content, "a.pcd")
    assert "\n" not in str(caught.value)


def test_damage_is_refused() -> None:
    refuse(b"", r"a\.pcd: file: .*no PCD header")
    refuse(b"\x00" * 100_000, "no PCD header")
    refuse(header("ascii").replace(b"x y z", b"x y w") + b"", r"a\.pcd: FIELDS: has no z; expected .* x y z, got ")
    refuse(header("zip"), r"a\.pcd: DATA: expected one of ascii, binary, binary_compressed, got 'zip'")
    refuse(header("ascii").replace(b"POINTS 50", b"POINTS many"), r"POINTS: expected a whole number, got ")
    refuse(header("ascii").replace(b"POINTS 50\n", b""), r"POINTS: expected a whole number, got ")
    refuse(header("ascii").replace(b"COUNT 1 1 1 3 1 1", b"COUNT 1 1"), r"DATA: cannot be read; expected .*")
    refuse(header("ascii").replace(b"SIZE 4 4 4", b"SIZE 4 4 5"), r"DATA: cannot be read; expected .*")
    refuse(header("ascii").replace(b"TYPE F", b"TYPE C"), r"DATA: cannot be read; expected .*")
    refuse(header("ascii").replace(b"SIZE 4 4 4 8 4 2\n", b""), r"DATA: cannot be read; expected .*")
    refuse(header("ascii") + b"1 2 3\n", "50 points as the header says")
    refuse(header("ascii") + b"one two\n" * 200, r"DATA: cannot be read; expected .*")
    refuse(header("binary") + table().tobytes()[:-1], r"DATA: cannot be read; expected .*")
    refuse(header("binary_compressed") + b"\x00", r"DATA: cannot be read; expected .*")
    whole = packed(by_field(table()))
    refuse(header("binary_compressed") + whole[:-1], r"DATA: cannot be read; expected .*")
    refuse(header("binary_compressed", 49) + whole, r"DATA: cannot be read; expected .*")


@given(st.integers(0, 2**32), st.sampled_from(["ascii", "binary", "binary_compressed"]))
def test_no_damage_escapes(seed: int, kind: str) -> None:
    rng = np.random.default_rng(seed)
    data = {"ascii": ascii_rows(), "binary": table().tobytes()}.get(kind) or packed(by_field(table()))
    content = bytearray(header(kind) + data)
    for _ in range(5):
        content[rng.integers(len(content))] = rng.integers(256)
    with contextlib.suppress(InputError):
        partial(parse_pcd, bytes(content), "a.pcd")()
