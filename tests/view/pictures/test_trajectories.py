"""A trajectory is plotted, animated, shown and drawn as a diagram like a motion."""

from pathlib import Path

import numpy as np
import pytest

import sinuous as sn

ROBOT = sn.Robot.uniform(2, length=(40, 60), max_bend=1.6, radius=4, tendons=sn.Tendons(count=3, radius=3))
Q = np.array([[[0, -0.5, 50], [0, 0, 50]], [[0, 0.5, 50], [0, 0, 50]]], float)
RATES = sn.Rates(bend=1.0, length=9.0, acceleration=sn.Rates(bend=2.0, length=20.0))


def test_it_is_drawn_wherever_a_motion_is(tmp_path: Path) -> None:
    timed = sn.Motion(ROBOT, Q).timed(RATES)
    sn.plot(timed, path=tmp_path / "way.png")
    sn.view.animate(timed, path=tmp_path / "way.gif", seconds=0.2, fps=10)
    assert (tmp_path / "way.gif").read_bytes().startswith(b"GIF")
    axes = sn.view.diagram(timed, "bends")
    times = np.asarray(axes.lines[0].get_xdata())
    assert times[-1] == pytest.approx(timed.duration)
    assert len(times) > 100
    pytest.importorskip("viser")
    sn.show(timed, path=tmp_path / "way.html")
    assert (tmp_path / "way.html").stat().st_size > 1000
