"""Obstacles that move on a page: what is asked is asked at the time that is shown."""

from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from sinuous.errors import InputError
from sinuous.viewer.model import Model
from sinuous.viewer.saving import loaded, saved
from sinuous.viewer.solvers import Solvers

ROBOT = sn.Robot.uniform(3, length=(0.8, 1.2), max_bend=2, radius=0.05)
TARGET = sn.Target((1, 0, 2))
BALL = sn.Sphere((-0.9, 0, 1.5), radius=0.2, name="ball")
GATE = sn.Moving(sn.Sphere((0, 0, 0), 0.5, name="gate"), [1, 3], [(1, 0, 2), (1, 3, 2)])
RATES = sn.Rates(bend=0.8, length=0.3)


def model(**values: object) -> Model:
    parts: dict[str, object] = {"target": TARGET, "scene": [BALL, GATE], "rates": RATES}
    return Model(sn.Job(ROBOT, **(parts | values)))  # type: ignore[arg-type]


def test_what_is_asked_is_asked_at_the_time_that_is_shown() -> None:
    page, solvers = model(), Solvers(routes=False)
    assert page.window == (0.0, 3.0)
    assert page.there.equals(page.scene.at(0.0))
    blocked = solvers.solve(page.question())
    assert blocked.status is sn.Status.TARGET_BLOCKED
    assert page.accept(page.number, blocked)
    page.play(3.0)
    assert page.answer is None
    question = page.question()
    assert question.scene.equals(page.scene.at(3.0))
    free = solvers.solve(question)
    assert free.solved
    assert free.problem.scene.equals(page.scene.at(3.0))
    assert free.verify().ok
    assert page.accept(question.number, free)
    assert not page.accept(question.number - 1, blocked)


def test_what_is_bent_by_hand_stays_while_obstacles_move() -> None:
    page = model()
    page.bend(0, 0.1, 0.2, 0.9)
    before = page.q.copy()
    page.play(2.0)
    assert page.by_hand
    np.testing.assert_array_equal(page.q, before)
    with pytest.raises(InputError, match="time"):
        page.play(3.1)
    with pytest.raises(InputError, match="nothing moves"):
        model(scene=[BALL]).play(0.0)


def test_motions_begin_in_the_shape_and_at_the_time_on_the_page(tmp_path: Path) -> None:
    page = model(target=sn.Target((-1.0, 0.3, 2.0)), start=[[0.3, 0.0, 1.0]] * 3)
    page.play(1.5)
    page.begin_here()
    assert page.begin == 1.5
    text = saved(page)
    assert text.startswith("# sinuous plan FILE --method newton --seed 0 --time 1 --begin 1.5\n")
    again = loaded("saved.yaml", text.encode(), tmp_path)
    assert again.equals(page.job)
    motion = again.plan(begin=page.begin)
    assert motion.solved
    page.show_motion(motion)
    assert page.window == (motion.times[0], motion.times[-1])
    assert page.time == 1.5
    page.play(float(motion.times[-1]))
    assert page.there.equals(page.scene.at(float(motion.times[-1])))
    np.testing.assert_array_equal(page.shown, motion.q[-1])


def test_a_waypoint_is_asked_at_its_time() -> None:
    path = [TARGET, sn.Target((1, 0.1, 2)), sn.Target((1, 0.2, 2))]
    page = model(target=None, path=path, times=[0.5, 2.0, 4.0])
    assert page.window == (0.0, 4.0)
    page.go_to_waypoint(1)
    assert page.time == 2.0
    page = model(target=None, path=path, start=[[0.3, 0.0, 1.0]] * 3)
    page.go_to_waypoint(1)
    assert page.time == 2.0


def test_what_stands_still_among_what_moves_is_dragged_and_resized() -> None:
    page = model()
    page.grasp(0)
    assert page.grip is not None
    there = page.grip.copy()
    there[:3, 3] += (0.1, 0.0, 0.0)
    page.carry(there)
    ball = page.scene.obstacles[0]
    assert isinstance(ball, sn.Sphere)
    np.testing.assert_allclose(ball.center, BALL.center + np.array([0.1, 0.0, 0.0]))
    page.resize(radius=0.3)
    assert page.scene.moves
    page.grasp(1)
    assert page.grip is None
    with pytest.raises(InputError, match="cannot be moved"):
        page.carry(np.eye(4))
    page.add("box")
    assert len(page.there) == 3
    page.grasp(1)
    page.delete()
    assert not page.scene.moves
    assert page.window == (0.0, 0.0)
