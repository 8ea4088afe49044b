"""The command explore."""

import json
from pathlib import Path

import pytest

import sinuous as sn
from sinuous.cli.app import main
from sinuous.studies.exploring.explore import _ExplorationRun

FILE = """
robot:
  segments: [{length: [0.8, 1.2], max_bend: 2.0, radius: 0.05}, {length: [0.8, 1.2], max_bend: 2.0, radius: 0.05}]
scene: [{sphere: {center: [0.6, 0, 1.2], radius: 0.3}}]
start: [[0, 0, 1], [0, 0.4, 1]]
target: {position: [-0.6, 0.2, 1.7]}
"""

OWN = ["explore", "arm.yaml", "--memory", "arm.npz", "--rounds", "1", "--max-starts", "4"]


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.yaml").write_text(FILE)


def test_a_memory_is_filled_and_a_plan_walks_in_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(OWN) == 0
    told = capsys.readouterr().out
    assert told.startswith("arm.yaml: ")
    assert " motions, " in told
    assert main([*OWN, "--json", "--workers", "1"]) == 0
    values = json.loads(capsys.readouterr().out)
    memory = sn.Memory.load("arm.npz")
    assert (values["rounds"], values["shapes"], values["motions"]) == (2, len(memory), len(memory.edges))
    assert main(["plan", "arm.yaml", "--memory", "arm.npz"]) == 0
    assert sn.Memory.load("arm.npz").fingerprint == memory.fingerprint  # nothing had to be searched


def test_what_was_done_is_kept_after_an_interrupt(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert main(OWN) == 0
    with monkeypatch.context() as patch:
        patch.setattr(_ExplorationRun, "round", lambda _: (_ for _ in ()).throw(KeyboardInterrupt))
        assert main(OWN) == 130
    told = "sinuous: interrupted; rounds that were done are in arm.npz, the same command goes on\n"
    assert capsys.readouterr().err == told
    assert main([*OWN, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["rounds"] == 2


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--rounds", "-1"], "--rounds: "),
        (["--spacing", "0"], "--spacing: "),
        (["--workers", "0"], "--workers: "),
        (["--engine", "steam"], "--engine: "),
        (["--time", "-1"], "--time: "),
        (["--memory", "arm.yaml"], "--memory: "),
        (["--memory", "no/arm.npz"], "--memory: "),
    ],
)
def test_what_cannot_be_meant_is_refused(options: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*OWN, *options]) == 2
    assert capsys.readouterr().err.startswith(told)
