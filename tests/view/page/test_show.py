"""`show` writes one page that holds everything, and refuses what it cannot show in one line."""

import sys
import types
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.view.display.contents import Arm, MovingArm
from sinuous.view.page.model import PLAYED_SECONDS
from sinuous.view.page.record import FEWEST_FRAMES, MOST_FRAMES, frames_of
from tests.helpers import refused
from tests.scene.shapes import EACH_KIND

ROBOT = sn.Robot.uniform(3, length=(0.8, 1.2), max_bend=2, radius=0.05)
SCENE = sn.Scene([sn.Sphere((0.5, 0, 1.5), radius=0.2, name="ball")])
TARGET = sn.Target((1, 0, 2))


def test_a_page_is_one_file_that_asks_the_net_for_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "x.html"
    sn.show(ROBOT, SCENE, TARGET, sn.solve(ROBOT, TARGET, SCENE), path=file)
    text = file.read_text(encoding="utf-8")
    assert text.lstrip().lower().startswith("<!doctype html")
    assert 'src="http' not in text
    assert "Solution: solved" in text
    assert "<title>Sinuous</title>" in text
    assert len(text) < 1_500_000
    assert capsys.readouterr().out == ""


def test_a_motion_is_recorded_knot_by_knot_or_between_them() -> None:
    knots = np.zeros((3, 3, 3))
    knots[:, :, 2] = [[0.8] * 3, [1.0] * 3, [1.2] * 3]
    q, times = frames_of(MovingArm(Arm(ROBOT, knots[0]), knots, np.arange(3.0)))
    assert len(q) == FEWEST_FRAMES
    np.testing.assert_allclose(q[[0, -1]], knots[[0, -1]])
    assert np.isclose(times[-1], 2.0)
    many = np.tile(knots[:1], (200, 1, 1))
    same, times = frames_of(MovingArm(Arm(ROBOT, many[0]), many, np.arange(200.0)))
    assert same is many
    assert np.isclose(times[-1], PLAYED_SECONDS)
    most = np.tile(knots[:1], (5000, 1, 1))
    assert len(frames_of(MovingArm(Arm(ROBOT, most[0]), most, np.arange(5000.0)))[0]) == MOST_FRAMES


def test_in_a_script_the_browser_opens_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    monkeypatch.delitem(sys.modules, "IPython", raising=False)
    sn.show(ROBOT)
    (address,) = opened
    file = Path(address.removeprefix("file://"))
    assert "</html>" in file.read_text(encoding="utf-8")
    file.unlink()


def test_in_a_notebook_the_page_is_inline(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[str] = []
    notebook: Any = types.ModuleType("IPython")
    notebook.get_ipython = lambda: types.SimpleNamespace(kernel=None)
    tools: Any = types.ModuleType("IPython.display")
    tools.HTML, tools.display = str, shown.append
    monkeypatch.setitem(sys.modules, "IPython", notebook)
    monkeypatch.setitem(sys.modules, "IPython.display", tools)
    sn.show(SCENE)
    assert shown[0].startswith("<div><iframe srcdoc=")
    assert "<script" not in shown[0]


def test_what_cannot_be_shown_is_refused_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    refused("path", lambda: sn.show(ROBOT, path=tmp_path / "x.png"), "expected a name that ends in .html, got")
    refused("things[1]", lambda: sn.show(ROBOT, "text", path=tmp_path / "x.html"), "expected a robot")
    refused("things", lambda: sn.show(path=tmp_path / "x.html"), "expected something to draw")
    refused("path", lambda: sn.show(ROBOT, path=tmp_path / "missing" / "x.html"), "cannot be written")
    monkeypatch.setitem(sys.modules, "viser", None)
    refused("path", lambda: sn.show(ROBOT, path=tmp_path / "x.html"), "pip install sinuous[view]")


def test_every_kind_of_obstacle_stands_on_a_page(tmp_path: Path) -> None:
    sn.show(sn.Scene([make() for make in EACH_KIND.values()]), ROBOT, path=tmp_path / "x.html")
    assert (tmp_path / "x.html").stat().st_size > 500_000
