"""A batch is a loop, to the last bit, whatever it is read from, written to, cut into and solved by."""

import csv
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.studies.batch.batch import Batch
from sinuous.studies.batch.tables.results import STATUSES
from tests.helpers import present, refused
from tests.studies.batch.questions import BAD, BALL, OPTIONS, ROBOT, loop, points, write_csv

COUNT = 130


def solve(targets: Any, out: Path | None = None, **options: Any) -> Batch:
    return sn.studies.solve_batch(ROBOT, targets, [BALL], out, **OPTIONS, **options)


@pytest.mark.parametrize("workers", [1, 3])
@pytest.mark.parametrize("chunk", [7, 50, 1000])
def test_it_is_a_loop_to_the_last_bit(workers: int, chunk: int) -> None:
    batch = solve({"positions": points(COUNT)}, workers=workers, chunk=chunk)
    expected, rows = loop(COUNT)
    assert batch.results is not None
    np.testing.assert_array_equal(batch.results["q"][rows], expected.q)
    assert [STATUSES[code] for code in batch.results["status"][rows]] == [str(each) for each in expected.status]
    for name in ("position_error", "clearance", "iterations", "starts"):
        np.testing.assert_array_equal(batch.results[name][rows], getattr(expected, name))
    assert expected.actuators is not None
    np.testing.assert_allclose(batch.results["actuators"][rows].T, list(expected.actuators.values()), atol=1e-12)
    np.testing.assert_array_equal(batch.results["row"], np.arange(COUNT) + 1)


def test_rows_that_are_no_targets_are_reported_by_number_and_the_others_solved() -> None:
    batch = solve(points(COUNT))
    assert batch.invalid == tuple(row + 1 for row in BAD)
    assert batch.counts["invalid"] == len(BAD)
    assert sum(batch.counts.values()) == batch.rows == batch.total == COUNT
    assert not batch.solved
    assert "invalid    rows 4, 42" in str(batch)


@pytest.mark.parametrize("ending", ["csv", "npz", "parquet"])
def test_the_file_is_the_same_whatever_engine_and_interrupts(ending: str, tmp_path: Path) -> None:
    table = write_csv(tmp_path / "in.csv", points(COUNT))
    one = tmp_path / f"one.{ending}"
    solve(table, one, chunk=20)
    with ThreadPoolExecutor(2) as pool:
        other = tmp_path / f"other.{ending}"
        for shard in ((2, 3), (1, 3)):
            part = solve(table, other, chunk=20, engine=pool, shard=shard)
            assert not other.exists()
            assert part.rows < part.total
        whole = solve(table, other, chunk=20, engine=pool)
    assert whole.before == COUNT - 40
    assert one.read_bytes() == other.read_bytes()
    assert not other.with_name(other.name + ".parts").exists()


def test_tables_have_the_columns_that_are_chosen(tmp_path: Path) -> None:
    names = [ROBOT.actuators[1].name, "s1.length", "position_error"]
    for name, columns in (("whole", None), ("own", names)):
        solve(points(8), tmp_path / f"{name}.csv", columns=columns)
    texts = [(tmp_path / f"{name}.csv").read_text().splitlines() for name in ("whole", "own")]
    whole, own = (list(csv.DictReader(text)) for text in texts)
    assert list(own[0]) == ["row", "status", *names]
    assert own == [{name: row[name] for name in own[0]} for row in whole]
    refused("columns[0]", lambda: solve(points(8), tmp_path / "own.csv", columns=["s1.speed"]))
    for file in ("own.npz", "whole.csv"):  # one that has others
        refused("columns", partial(solve, points(8), tmp_path / file, columns=names))


def test_what_is_finished_is_not_done_again(tmp_path: Path) -> None:
    out = tmp_path / "out.npz"
    first = solve(points(30), out)
    stamp = out.stat().st_mtime_ns
    again = solve(points(30), out)
    assert again.before == again.rows == 30
    assert (again.counts, again.invalid) == (first.counts, first.invalid)
    assert out.stat().st_mtime_ns == stamp


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("seed", {"seed": 3}),
        ("tolerance", {"tolerance": sn.Tolerance(0.2)}),
        ("chunk", {"chunk": 11}),
        ("initial", {"initial": np.tile([0.1, 0.0, 50.0], (3, 1))}),
    ],
)
@pytest.mark.parametrize("finished", [False, True])
def test_what_was_begun_otherwise_is_refused_by_name(
    name: str, change: dict[str, Any], finished: bool, tmp_path: Path
) -> None:
    out = tmp_path / "out.npz"
    solve(points(30), out, chunk=10, shard=None if finished else (1, 3))
    refused(name, lambda: solve(points(30), out, **({"chunk": 10} | change)), "changed since this batch began")


def test_another_robot_scene_table_or_version_is_refused_by_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out.npz"
    solve(points(30), out)
    refused("robot", lambda: sn.studies.solve_batch(ROBOT.changed(name="other"), points(30), [BALL], out, **OPTIONS))
    refused("scene", lambda: sn.studies.solve_batch(ROBOT, points(30), [BALL, BALL], out, **OPTIONS))
    refused("targets", lambda: solve(points(30, seed=1), out))
    monkeypatch.setattr(sn, "__version__", "9.9")
    refused("version", lambda: solve(points(30), out))


def test_a_file_of_somebody_else_is_not_written_over(tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    out.write_text("mine", encoding="utf-8")
    refused("out", lambda: solve(points(5), out), "is there already")
    assert out.read_text(encoding="utf-8") == "mine"


def test_warm_starts_are_a_memory_now() -> None:
    with pytest.warns(DeprecationWarning, match=r"^solve_batch\(warm=\) is solve_batch\(memory=\) now$") as caught:
        sn.studies.solve_batch(ROBOT, points(2), warm=True)  # type: ignore[call-arg]
    assert caught[0].filename == __file__


def test_an_initial_configuration_is_where_every_solve_begins() -> None:
    q = np.tile([0.3, 0.1, 55.0], (3, 1))
    batch = solve(points(10), initial=q)
    rows = [row for row in range(10) if row not in BAD]
    expected = sn.Solver(ROBOT, [BALL], **OPTIONS).solve_many(positions=points(10)[rows], initial=q)
    np.testing.assert_array_equal(present(batch.results)["q"][rows], expected.q)


@pytest.mark.parametrize(
    ("options", "key"),
    [
        ({"chunk": 0}, "chunk"),
        ({"columns": ["s1.length"]}, "columns"),
        ({"workers": 0}, "workers"),
        ({"engine": "gpu"}, "engine"),
        ({"shard": (3, 2)}, "shard"),
        ({"shard": "1/2"}, "shard"),
        ({"shard": (1, 2)}, "shard"),  # without a file there is nothing to join
        ({"initial": [[0.0, 0.0, 1.0]]}, "initial"),
        ({"time": -1.0}, "time"),
    ],
)
def test_wrong_options_are_refused(options: dict[str, Any], key: str) -> None:
    refused(key, lambda: sn.studies.solve_batch(ROBOT, points(5), **options))
