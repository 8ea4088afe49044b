"""Diagrams show the numbers that independent code gives."""

from typing import Any, get_args

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.body import least_clearance, segment_ends
from sinuous.view.pictures.diagrams import Kind, diagram, diagrams_of
from tests.helpers import present, refused
from tests.view.pictures.arms import BALL, PATH, ROBOT

matplotlib = pytest.importorskip("matplotlib")


def test_every_kind_is_of_something(track: sn.Motion) -> None:
    from matplotlib import pyplot

    solved = sn.solve(ROBOT, PATH[0], BALL, method="dls")
    assert {*diagrams_of(track), *diagrams_of(solved)} == set(get_args(Kind))
    for answer in (track, solved):
        for kind in diagrams_of(answer):
            axes: Any = diagram(answer, kind)  # type: ignore[arg-type]
            axes.figure.canvas.draw()
            assert axes.get_title(loc="left")
            assert axes.get_xlabel()
            assert axes.has_data()
            pyplot.close(axes.figure)


def test_clearance_along_the_body(track: sn.Motion) -> None:
    solution = track.solutions[3]
    axes = diagram(solution, "clearance")
    drawn = np.concatenate([line.get_ydata() for line in axes.get_lines()[: 2 * len(ROBOT) : 2]])
    q = solution.q
    truth = least_clearance(ROBOT, solution.problem.scene, q, segment_ends(ROBOT, q)).distance
    assert np.min(drawn) == pytest.approx(truth, abs=1e-3)
    along = np.concatenate([line.get_xdata() for line in axes.get_lines()[: 2 * len(ROBOT) : 2]])
    assert along.max() == pytest.approx(q[:, 2].sum())
    assert np.isinf(np.asarray(drawn)[along < ROBOT.mount]).all()


def test_clearance_over_a_motion_is_never_less_than_was_proved(track: sn.Motion) -> None:
    axes = diagram(track, "clearance")
    least = np.asarray(axes.get_lines()[0].get_ydata())
    assert len(least) >= len(track.q)
    assert least.min() >= present(track.clearance)
    legend = present(axes.get_legend())
    assert [text.get_text() for text in legend.get_texts()] == ["proved all the way"]


def test_actuators_bends_and_lengths(track: sn.Motion) -> None:
    values = {
        "actuators": ROBOT.to_actuators(track.q),
        "bends": np.hypot(track.q[..., 0], track.q[..., 1]),
        "lengths": track.q[..., 2],
    }
    for kind, expected in values.items():
        lines = diagram(track, kind).get_lines()  # type: ignore[arg-type]
        np.testing.assert_allclose(np.stack([np.asarray(line.get_ydata()) for line in lines], axis=-1), expected)


def test_convergence_ends_within_the_tolerance() -> None:
    near = [[0.3, 0.2, 1.0]] * 3
    tip = ROBOT.tip(np.add(near, [0.2, -0.2, 0.05]))
    solved = sn.solve(ROBOT, sn.Target(tip[:3, 3], direction=tip[:3, 2]), method="dls", initial=near)
    lines = diagram(solved, "convergence").get_lines()
    position, least, angle, flat = (np.asarray(line.get_ydata()) for line in lines)
    assert solved.starts == 1
    assert len(position) == len(angle) > 2
    assert position[-1] == pytest.approx(solved.position_error)
    assert position[0] > position[-1]
    assert position[-1] <= least[0]
    assert angle[-1] <= flat[0]


@pytest.mark.parametrize("answer", [ROBOT, sn.Motion])
def test_wrong_answers_are_named(answer: Any) -> None:
    refused("answer", lambda: diagram(answer, "clearance"), "expected a Solution, a Motion or a Trajectory")


def test_what_an_answer_does_not_have_is_refused() -> None:
    free = sn.solve(ROBOT, PATH[0])
    refused("kind", lambda: diagram(free, "clearance"), "expected one that this Solution has: none")
    refused("kind", lambda: diagram(free, "colours"), "expected one of clearance")  # type: ignore[arg-type]
    alone = sn.track(sn.Robot.uniform(2, 1), [sn.Target((0, 0, 2))])
    other = sn.Motion(ROBOT, [[[0.0, 0.0, 1.0]] * 3, [[0.1, 0.0, 1.0]] * 3])
    assert diagrams_of(other) == ["actuators", "bends", "lengths"]
    refused("kind", lambda: diagram(alone, "bends"), "this Motion has: times")
