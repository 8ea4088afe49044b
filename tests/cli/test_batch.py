"""The command batch; what ends it is looked at in tests/batch/test_deaths.py."""

import json
from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from sinuous.cli.app import main
from tests.studies.batch.questions import BALL, ROBOT, points, write_csv

FAST = ("--max-starts", "4", "--no-routes")


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    sn.Job(ROBOT, sn.Target((0, 0, 150)), [BALL], tolerance=sn.Tolerance(0.5)).save("arm.yaml")
    write_csv(Path("in.csv"), points(12))
    write_csv(Path("good.csv"), np.array([[0.0, 10.0, 160.0], [20.0, 0.0, 150.0]]))


def test_all_solved(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["batch", "arm.yaml", "--targets", "good.csv", "--out", "out.csv"]) == 0
    told = capsys.readouterr().out
    assert told.startswith("arm.yaml: 2 rows: 2 solved")
    assert "out.csv" in told
    assert main(["batch", "arm.yaml", "--targets", "good.csv", "--out", "out.csv", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["before"] == 2


def test_rows_that_are_no_targets_make_it_exit_with_1(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["batch", "arm.yaml", "--targets", "in.csv", "--out", "out.npz", *FAST]) == 1
    assert "invalid    rows 4" in capsys.readouterr().out


def test_a_robot_alone_and_a_problem_without_targets_will_do() -> None:
    ROBOT.save("robot.yaml")
    Path("bare.yaml").write_text("robot: robot.yaml\nstart: [[0, 0, 50], [0, 0, 50], [0, 0, 50]]\n", encoding="utf-8")
    for file in ("robot.yaml", "bare.yaml"):
        assert main(["batch", file, "--targets", "good.csv", "--out", f"{file}.csv"]) == 0


def test_shards_are_joined_by_the_command_without_one(capsys: pytest.CaptureFixture[str]) -> None:
    own = ["batch", "arm.yaml", "--targets", "good.csv", "--out", "out.csv", "--chunk", "1"]
    for shard in ("2/2", "1/2"):
        assert main([*own, "--shard", shard]) == 0
        assert not Path("out.csv").exists()
    capsys.readouterr()
    assert main([*own, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["before"] == 2


def test_other_ways_to_solve_give_the_same_file() -> None:
    own = ["batch", "arm.yaml", "--targets", "good.csv"]
    ways = {"a": ["--workers", "1"], "b": ["--chunk", "1"], "c": ["--warm", "--engine", "threads"]}
    for name, options in ways.items():
        assert main([*own, "--out", f"{name}.csv", *options]) == 0
    assert Path("a.csv").read_bytes() == Path("b.csv").read_bytes()


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--engine", "gpu"], "--engine: expected one of threads, processes"),
        (["--dask", "here"], "--dask: expected tcp://HOST:PORT"),
        (["--dask", "local", "--engine", "processes"], "--dask: "),
        (["--shard", "3/2"], "--shard: expected I/N"),
        (["--chunk", "0"], "--chunk: "),
        (["--workers", "0"], "--workers: "),
        (["--out", "out.txt"], "--out: expected a name that ends in .csv"),
        (["--targets", "no.csv"], "--targets: "),
        (["--targets", "arm.yaml"], "--targets: expected a name that ends in .csv"),
        (["--out", "no/where/out.csv"], ""),
    ],
)
def test_bad_input_is_one_line(options: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    Path("no").write_text("", encoding="utf-8")
    assert main(["batch", "arm.yaml", "--targets", "good.csv", "--out", "out.csv", *options]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert error.startswith(told)
    assert not list(Path().glob("*.parts"))


def test_an_address_where_no_scheduler_is(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sinuous.studies.batch.cluster.PATIENCE", 1.0)
    own = ["batch", "arm.yaml", "--targets", "good.csv", "--out", "out.csv", "--dask", "tcp://127.0.0.1:9"]
    assert main(own) == 2
    assert "the address of a scheduler that runs, got 'tcp://127.0.0.1:9'" in capsys.readouterr().err
