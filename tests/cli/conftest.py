"""A folder with problem files, and the command line as one calls it there."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from sinuous.cli.app import main

ROBOT = "robot: {segments: {count: 3, length: [0.8, 1.2], max_bend: 2}, radius: 0.05}\n"
TARGET = "target: {position: [1, 0, 2]}\n"
START = "start: [[0.5, 0, 1], [0, 0.4, 1], [0.3, 0, 1]]\n"
GOAL = "goal: [[-0.5, 0, 1], [0, 0.4, 1], [0.3, 0, 1]]\n"
BALL = "scene: [{sphere: {center: [0.5, 0, 1.5], radius: 0.2, name: ball}}]\n"
IN_THE_WAY = "scene: [{sphere: {center: [0.1, 0, 2], radius: 0.2, name: ball}}]\n"
PATH = "path: [{position: [1, 0, 2]}, {position: [1, 0.1, 2]}, {position: [1, 0.2, 2]}]\n"
PROBLEMS = {
    "easy.yaml": ROBOT + TARGET,
    "scene.yaml": ROBOT + TARGET + BALL,
    "far.yaml": ROBOT + "target: {position: [0, 0, 9]}\n",
    "path.yaml": ROBOT + PATH,
    "half.yaml": ROBOT + "path: [{position: [1, 0, 2]}, {position: [0, 0, 9]}, {position: [1, 0.2, 2]}]\n",
    "shell.yaml": ROBOT
    + TARGET
    + "scene: [{mesh: {file: sheet.obj, scale: 1e-1, position: [9, 0, 0], name: sheet}}]\n",
    "bad.yaml": ROBOT + "target: {position: [1, 0]}\n",
    "plan.yaml": ROBOT + START + IN_THE_WAY + GOAL,
    "plan_to_target.yaml": ROBOT + START + IN_THE_WAY + "target: {position: [-1, 0, 2]}\n",
    "sheet.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 2\n",
}


class Said(NamedTuple):
    """What a command printed."""

    out: str
    err: str

    @property
    def results(self) -> list[dict[str, Any]]:
        """The objects on its lines, without NaN and infinity."""
        return [json.loads(line, parse_constant=pytest.fail) for line in self.out.splitlines()]


Run = Callable[..., Said]
"""Runs what is typed after `sinuous`, where the problem files are, demands the exit code, and returns what is said."""


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Write the problem files into a folder of the test, and go there."""
    monkeypatch.chdir(tmp_path)
    for name, text in PROBLEMS.items():
        Path(name).write_text(text)

    def run(typed: str, code: int = 0) -> Said:
        capsys.readouterr()
        assert main(typed.split()) == code
        return Said(*capsys.readouterr())

    return run
