"""Problem files that the tests of the command line share."""

from collections.abc import Callable
from pathlib import Path

import pytest

ROBOT = "robot: {segments: {count: 3, length: [0.8, 1.2], max_bend: 2}, radius: 0.05}\n"
PROBLEMS = {
    "easy.yaml": ROBOT + "target: {position: [1, 0, 2]}\n",
    "scene.yaml": ROBOT
    + "target: {position: [1, 0, 2]}\nscene: [{sphere: {center: [0.5, 0, 1.5], radius: 0.2, name: ball}}]\n",
    "far.yaml": ROBOT + "target: {position: [0, 0, 9]}\n",
    "torn.yaml": ROBOT + "targets: [{position: [1, 0, 2]}, {position: [-1, 0, 2]}]\n",
    "path.yaml": ROBOT + "path: [{position: [1, 0, 2]}, {position: [1, 0.1, 2]}, {position: [1, 0.2, 2]}]\n",
    "half.yaml": ROBOT + "path: [{position: [1, 0, 2]}, {position: [0, 0, 9]}, {position: [1, 0.2, 2]}]\n",
    "shell.yaml": ROBOT
    + "target: {position: [1, 0, 2]}\n"
    + "scene: [{mesh: {file: sheet.obj, scale: 1e-1, position: [9, 0, 0], name: sheet}}]\n",
    "bad.yaml": ROBOT + "target: {position: [1, 0]}\n",
}
SHEET = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 2\n"


@pytest.fixture
def problem(tmp_path: Path) -> Callable[[str], str]:
    """Write one of the problems into a folder of the test and return its name."""

    def write(name: str) -> str:
        file = tmp_path / name
        file.write_text(PROBLEMS[name])
        if "sheet.obj" in PROBLEMS[name]:
            (tmp_path / "sheet.obj").write_text(SHEET)
        return str(file)

    return write
