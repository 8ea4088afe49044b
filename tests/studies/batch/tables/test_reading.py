"""Tables of targets: the same rows from every kind of file, in chunks, and what is wrong with one is said.

Tables of results: the same columns in every kind of file, and what is not known is nothing.
"""

import csv
import zipfile
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pytest
from pyarrow import parquet

import sinuous as sn
from sinuous.studies.batch.batch import valid
from sinuous.studies.batch.tables.reading import open_source
from sinuous.studies.batch.tables.results import CODES, STATUSES, Layout, write_results
from tests.helpers import Unpickled, refused
from tests.studies.batch.questions import ROBOT, write_csv

ROWS = np.random.default_rng(0).normal(size=(23, 7))
COLUMNS = "x", "y", "z", "qw", "qx", "qy", "qz"


def write(file: Path, names: tuple[str, ...], rows: Any) -> Path:
    if file.suffix == ".csv":
        return write_csv(file, rows, ",".join(names))
    if file.suffix == ".parquet":
        parquet.write_table(pyarrow.table(dict(zip(names, rows.T, strict=True))), file, row_group_size=5)
        return file
    groups = {"positions": ("x", "y", "z"), "directions": ("dx", "dy", "dz"), "rotations": ("qw", "qx", "qy", "qz")}
    arrays = {key: rows[:, [names.index(n) for n in own]] for key, own in groups.items() if own[0] in names}
    np.savez(file, **arrays)
    return file


@pytest.mark.parametrize("ending", ["csv", "npz", "parquet"])
@pytest.mark.parametrize("chunk", [1, 4, 23, 100])
def test_chunks_are_the_rows(ending: str, chunk: int, tmp_path: Path) -> None:
    with closing(open_source(write(tmp_path / f"in.{ending}", COLUMNS, ROWS))) as source:
        assert source.rows == len(ROWS)
        spans = [(first, min(source.rows, first + chunk)) for first in range(0, source.rows, chunk)]
        found = [source.read(*span) for span in spans if span[0] != 4]  # one that was done before
    for key, columns in {"positions": slice(0, 3), "rotations": slice(3, 7)}.items():
        expected = np.concatenate([ROWS[a:b, columns] for a, b in spans if a != 4])
        np.testing.assert_array_equal(np.concatenate([each[key] for each in found]), expected)


@pytest.mark.parametrize("rows", [ROWS[:, :3].copy(order="F"), np.asfortranarray(ROWS[:18].reshape(-1, 3, 3)[:, :, :])])
@pytest.mark.parametrize("packed", [False, True])
def test_arrays_of_any_order_packed_or_not(rows: Any, packed: bool, tmp_path: Path) -> None:
    key = "positions" if rows.ndim == 2 else "rotations"
    (np.savez_compressed if packed else np.savez)(tmp_path / "in.npz", **{key: rows.astype(np.float32)})
    with closing(open_source(tmp_path / "in.npz")) as source:
        for first in range(0, len(rows), 7):
            last = min(len(rows), first + 7)
            np.testing.assert_array_equal(source.read(first, last)[key], rows[first:last].astype(np.float32))


def test_other_columns_are_not_read_which_is_said_and_order_does_not_matter(tmp_path: Path) -> None:
    table = tmp_path / "in.csv"
    table.write_text("id, z ,name,x,y\n7,3,a,1,2\n\n8,6,b,4,5\n", encoding="utf-8")
    with pytest.warns(sn.SuspiciousInput, match=r"^targets: columns that are not read: id, name; known are x, y, z, "):
        source = open_source(table)
    with closing(source):
        np.testing.assert_array_equal(source.read(0, 2)["positions"], [[1, 2, 3], [4, 5, 6]])
    table.write_text("x,y,z,r,g,b,unit\n1,2,3,9,9,9,1\n", encoding="utf-8")  # r is no radius among columns
    with pytest.warns(sn.SuspiciousInput, match=r"^targets: columns that are not read: r, g, b, unit; known are x, "):
        open_source(table).close()
    np.savez(tmp_path / "in.npz", positions=ROWS[:, :3], direction=ROWS[:, :3])
    with pytest.warns(sn.SuspiciousInput, match=r"^targets: arrays that are not read: direction; known are positions"):
        open_source(tmp_path / "in.npz").close()


@pytest.mark.parametrize("cell", ["", "abc", "nan", "inf", "0x10", "1_000"])
def test_a_cell_that_is_no_number_makes_its_row_invalid(cell: str, tmp_path: Path) -> None:
    table = tmp_path / "in.csv"
    table.write_text(f"x,y,z\n1,2,3\n4,{cell},6\n7,8\n10,11,12\n", encoding="utf-8")
    with closing(open_source(table)) as source:
        rows, goals = valid(source.read(0, source.rows))
    assert rows.tolist() == [0, 3]
    np.testing.assert_array_equal(goals.positions, [[1, 2, 3], [10, 11, 12]])


def test_directions_of_no_length_and_matrices_that_are_no_rotations_are_invalid() -> None:
    directions = np.eye(3)[[0, 1, 2]] * [[1.0], [0.0], [5.0]]
    assert valid({"directions": directions})[0].tolist() == [0, 2]
    matrices = np.stack([np.eye(3), 2.0 * np.eye(3), -np.eye(3), np.eye(3)])
    assert valid({"rotations": matrices})[0].tolist() == [0, 3]


@pytest.mark.parametrize(
    ("header", "told"),
    [
        ("a,b,c", "expected columns x,y,z"),
        ("x,y", "there is no z"),
        ("x,y,z,qw,qx,qy", "there is no qz"),
        ("x,y,z,x", "x is there twice"),
        ("x,y,z,nx,ny,nz", "unknown column 'nx'; did you mean dx,dy,dz, the direction of the tangent"),
        ("x,y,z,roll,pitch,yaw", "unknown column 'roll'; did you mean qw,qx,qy,qz"),
        ("dx,dy,dz,qw,qx,qy,qz", "expected columns"),
        ("", "expected columns"),
    ],
)
def test_a_table_without_the_columns_is_refused(header: str, told: str, tmp_path: Path) -> None:
    table = tmp_path / "in.csv"
    table.write_text(header + "\n", encoding="utf-8")
    refused("columns", lambda: open_source(table), told, file=table)


def test_files_that_are_none_are_refused(tmp_path: Path) -> None:
    for name in ("in.npz", "in.parquet"):
        (tmp_path / name).write_bytes(b"nothing like it")
        with pytest.raises(sn.InputError, match=f"{name}: .*; expected "):
            open_source(tmp_path / name)
    (tmp_path / "in.csv").write_bytes(b"x,y,z\n\xff\xfe")
    with pytest.raises(sn.InputError, match="UTF-8"):
        open_source(tmp_path / "in.csv")
    refused("targets", lambda: open_source(tmp_path / "in.xlsx"), "ends in")
    refused("targets", lambda: open_source(tmp_path / "no.csv"), "cannot be read")


@pytest.mark.parametrize(
    ("arrays", "key", "words"),
    [
        ({"points": ROWS}, "arrays", "expected arrays positions"),
        ({"positions": ROWS}, "positions", r"expected an array \(m, 3\)"),
        ({"positions": ROWS[:, :3], "directions": ROWS[:4, :3]}, "arrays", "as many rows"),
        ({"directions": ROWS[:, :3], "xyzw": ROWS[:, :4]}, "arrays", "expected arrays positions"),
        ({"positions": np.array([["a", "b", "c"]])}, "positions", "expected an array of numbers"),
        ({"positions": np.array([[1, 2, Unpickled()]], object)}, "positions", "an array of numbers"),
    ],
)
def test_npz_files_without_the_arrays_are_refused(arrays: dict[str, Any], key: str, words: str, tmp_path: Path) -> None:
    np.savez(tmp_path / "in.npz", **arrays)
    with pytest.raises(sn.InputError, match=rf"in\.npz: {key}: .*{words}"):
        open_source(tmp_path / "in.npz")


def test_an_archive_without_an_array_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "other.npz"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("positions.npy", b"no array")
    with pytest.raises(sn.InputError, match=r"other\.npz: positions: "):
        open_source(file)


@pytest.mark.parametrize(
    ("targets", "key", "words"),
    [
        ({"position": [[0, 0, 1]]}, "position", ""),
        ({"positions": [[0, 1]]}, "positions", ": expected an array"),
        ({"positions": [["a", 0, 1]]}, "positions", ": expected rows of numbers"),
        ({}, "targets", ""),
        (7, "targets", ": expected a file"),
    ],
)
def test_wrong_arrays_are_refused(targets: Any, key: str, words: str) -> None:
    refused(key, lambda: open_source(targets), words)


def test_a_fingerprint_differs_when_a_row_does(tmp_path: Path) -> None:
    def look(rows: Any) -> set[str]:
        sources = [write(tmp_path / f"in.{ending}", COLUMNS, rows) for ending in ("csv", "npz", "parquet")]
        opened = [*map(open_source, sources), open_source({"positions": rows[:, :3]})]
        found = {source.fingerprint() for source in opened}
        for source in opened:
            source.close()
        return found

    changed = ROWS.copy()
    changed[7, 1] += 1e-15
    assert not look(ROWS) & look(changed)
    assert look(ROWS) == look(ROWS.copy())


LAYOUT = Layout(ROBOT)


def test_all_kinds_say_the_same(tmp_path: Path) -> None:
    blocks = [LAYOUT.nothing(0, 3, "skipped"), LAYOUT.nothing(3, 2, "invalid")]
    rng = np.random.default_rng(0)
    blocks[0]["q"][:2] = rng.normal(size=(2, 3, 3))
    blocks[0]["status"][:2] = CODES["solved"]
    blocks[0]["self_clearance"][0] = np.inf
    for ending in ("csv", "npz", "parquet"):
        write_results(tmp_path / f"out.{ending}", lambda *names: blocks, LAYOUT, 5)
    with (tmp_path / "out.csv").open(encoding="utf-8") as text:
        header, *rows = csv.reader(text)
    table = parquet.read_table(tmp_path / "out.parquet")
    assert header == LAYOUT.names == table.column_names
    assert header[:3] == ["row", "status", "s1.bend_x"]
    assert header[11] == "s1.t1"
    columns = table.to_pydict()
    for i, row in enumerate(rows):
        for name, cell in zip(header, row, strict=True):
            value = columns[name][i]
            assert cell == "" if value is None else cell == str(value)
    with np.load(tmp_path / "out.npz") as data:
        assert data["statuses"][data["status"]].tolist() == columns["status"]
        np.testing.assert_array_equal(data["q"][:2], blocks[0]["q"][:2])
        assert data["row"].tolist() == [1, 2, 3, 4, 5]
        assert data["actuator_names"].tolist() == [actuator.name for actuator in ROBOT.actuators]
        assert tuple(data["statuses"]) == STATUSES
