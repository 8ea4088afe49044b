"""Tables of results: the same columns in every kind of file, and what is not known is nothing."""

import csv
from pathlib import Path

import numpy as np
from pyarrow import parquet

from sinuous.studies.batch.tables.results import CODES, STATUSES, Layout, write_results
from tests.studies.batch.questions import ROBOT

LAYOUT = Layout.of(ROBOT)


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
