"""Walls with doors: what is known of them is true, and a solver that misses a door is found out."""

from functools import cache

import numpy as np
import pytest

from benchmarks.judges.collisions import Body
from benchmarks.wild import doors
from sinuous.answer.solution import Solution
from sinuous.solver.solver import Solver


@cache
def wall() -> doors.Wall:
    """A wall with doors; not made when tests are collected, since that compiles."""
    return doors.make(0, 1)


def test_walls_are_the_same_each_time_and_have_only_their_doors() -> None:
    again = doors.make(0, 1)
    np.testing.assert_array_equal(again.doors, wall().doors)
    rng = np.random.default_rng(0)
    places = np.column_stack([rng.uniform(-150.0, 150.0, (4000, 2)), np.full(4000, wall().middle)])
    inside = np.zeros(len(places), bool)
    for low, high in wall().doors:
        inside |= ((low < places[:, :2]) & (places[:, :2] < high)).all(axis=1)
    np.testing.assert_array_equal(wall().scene.distance(places) > 0.0, inside)
    assert inside.any()


def test_a_shape_goes_through_what_it_crosses() -> None:
    (door,) = wall().doors[:1]
    straight = np.zeros((len(doors.ROBOT), 3))
    straight[:, 2] = 50.0
    at_axis = np.array([[[-9.0, -9.0], [9.0, 9.0]]])
    assert doors.gates_of(straight, 100.0, at_axis) == [0]
    assert doors.gates_of(straight, 100.0, at_axis + 50.0) == [-1]
    assert doors.gates_of(straight, 1000.0, at_axis) == []
    assert (door[1] - door[0] >= doors.OPEN[0] * doors.RADIUS).all()


def test_a_solver_that_misses_a_door_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    found = Solver(doors.ROBOT, wall().scene, tolerance=doors.TOLERANCE, time=60.0).solve_all(wall().target, count=3)

    def compare(answer: list[Solution]) -> doors.Passed:
        monkeypatch.setattr(Solver, "solve_all", lambda *a, **k: answer)
        return doors.compare(wall())

    whole, lacking, doubled = compare(found), compare(found[:1]), compare(found * 2)
    assert whole[:5] == (3, 3, 0, 0, 0)
    assert (lacking.found, doubled.again, doubled.alike) == (1, 3, 3)
    monkeypatch.setattr(Body, "overlaps", lambda self, q: np.ones(len(q), bool))
    assert compare(found).false == 3
    share, again, alike, false, *_ = doors.lines_of([lacking, doubled], 0)
    assert share.held is False
    assert "0: 1 of 3" in share.note
    assert (again.reached, alike.reached, false.reached) == (3, 3, 0)
