"""The command reach."""

import json
from pathlib import Path

import pytest

import sinuous as sn
from sinuous.cli.app import main
from tests.studies.workspace.maps import ROBOT, WALL


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    ROBOT.save("robot.yaml")
    sn.Job(ROBOT, sn.Target((0, 0, 100)), WALL).save("arm.yaml")


def test_a_map_is_told_written_and_drawn(capsys: pytest.CaptureFixture[str]) -> None:
    own = ["reach", "arm.yaml", "--spacing", "60", "--directions", "6"]
    assert main([*own, "--out", "map.npz", "--plot", "map.html"]) == 0
    assert capsys.readouterr().out.startswith("arm.yaml: 5 x 5 x 5 voxels of 60, 6 directions each")
    assert sn.Reach.load("map.npz").voxels.shape == (5, 5, 5)
    assert Path("map.html").exists()
    assert main([*own, "--json", "--workers", "1"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["volumes"]["reachable"]["found"] == sn.Reach.load("map.npz").volume().found
    assert main(["reach", "robot.yaml", "--spacing", "60", "--directions", "1", "--max-starts", "3"]) == 0


def test_interrupted_it_goes_on_where_there_is_a_file(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    own = ["reach", "arm.yaml", "--spacing", "60", "--directions", "6"]
    with monkeypatch.context() as patch:
        patch.setattr(sn.Reach, "save", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
        assert main([*own, "--out", "map.npz"]) == 130
        assert capsys.readouterr().err == "sinuous: interrupted; what was found is kept, the same command goes on\n"
    assert main([*own, "--directions", "3", "--out", "map.npz"]) == 2
    assert capsys.readouterr().err.startswith("--directions: expected 6, ")
    with monkeypatch.context() as patch:
        patch.setattr(sn.Solver, "solve_many", lambda *_, **__: (_ for _ in ()).throw(KeyboardInterrupt))
        assert main([*own, "--out", "map.npz"]) == 0  # all is there
        capsys.readouterr()
        assert main(own) == 130
        assert capsys.readouterr().err == "sinuous: interrupted; nothing is written\n"


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--spacing", "0"], "--spacing: "),
        (["--directions", "0"], "--directions: "),
        (["--workers", "0"], "--workers: "),
        (["--time", "-1"], "--time: "),
        (["--out", "map.csv"], "--out: expected a name that ends in .npz"),
        (["--out", "no/map.npz"], "--out: "),
        (["--plot", "map.doc"], "--plot: "),
    ],
)
def test_bad_input_is_one_line(options: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["reach", "arm.yaml", *options]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert error.startswith(told)
