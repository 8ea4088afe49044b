"""Solves of thick bodies near their own base: what is solved never runs through itself, by whatever method."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.body import least_self_clearance, segment_ends
from tests.helpers import Floats, present
from tests.kernels.body.test_self_proof import curled
from tests.self_gaps import gaps_of, sample_body

THICK = sn.Robot.uniform(4, (0.8, 1.4), 3.0, radius=0.16)
DRIVEN = sn.Robot.uniform(4, (0.8, 1.4), 3.0, radius=0.16, tendons=sn.Tendons(3, 0.1, displacement=(-0.7, 0.7)))
UNEVEN = sn.Robot([sn.Segment((0.8, 1.4), 3.0, radius=radius) for radius in (0.25, 0.2, 0.12, 0.06)])


FEW = 40
"""Places of a segment for a first look."""


def hidden(robot: sn.Robot, rng: np.random.Generator) -> Floats:
    """A curled shape that keeps all limits and does not run through itself."""
    while True:
        q = curled(rng, robot.radii, 2.8)
        q[:, 2] = np.clip(q[:, 2], 0.8, 1.4)
        if robot.excess(q) == 0.0 and rough_gap_of(robot, q) > 0.0 and gap_of(robot, q) > 0.0:
            return q


def rough_gap_of(robot: sn.Robot, q: Floats) -> float:
    """Of few places, so never less than the true one: quick enough to draw many shapes."""
    return float(gaps_of(sample_body(q, np.array(robot.radii), FEW)).min())


def gap_of(robot: sn.Robot, q: Floats) -> float:
    return least_self_clearance(robot, q, segment_ends(robot, q)).gap


def target_of(robot: sn.Robot, q: Floats) -> sn.Target:
    tip = robot.tip(q)
    return sn.Target(tip[:3, 3], direction=tip[:3, 2])


@pytest.mark.parametrize("robot", [THICK, DRIVEN, UNEVEN], ids=["thick", "driven", "uneven"])
def test_reachable_targets_are_solved_without_touching(robot: sn.Robot) -> None:
    solver, rng = sn.Solver(robot), np.random.default_rng(1)
    for _ in range(12):
        solution = solver.solve(target_of(robot, hidden(robot, rng)))
        assert solution.solved, str(solution)
        assert solution.verify().ok
        assert 0.0 < present(solution.self_clearance) <= gap_of(robot, solution.q) + 1e-9


@pytest.mark.parametrize("robot", [THICK, DRIVEN, UNEVEN], ids=["thick", "driven", "uneven"])
def test_a_shape_that_touches_opens_and_stays_what_it_was(robot: sn.Robot) -> None:
    """From an initial shape that runs through itself a little, with its tip where it is wanted."""
    solver, rng = sn.Solver(robot, max_starts=1, routes=False), np.random.default_rng(4)
    moved, tried = [], 0
    while tried < 12:
        q = curled(rng, robot.radii, 2.8)
        q[:, 2] = np.clip(q[:, 2], 0.85, 1.35)
        if robot.excess(q) > 0.0 or not -0.05 < rough_gap_of(robot, q) < -0.005:
            continue
        tried += 1
        solution = solver.solve(target_of(robot, q), initial=q)
        if solution.solved:
            assert gap_of(robot, solution.q) > 0.0
            moved.append(float(np.hypot(*(solution.q - q)[:, :2].T).max()))
    assert len(moved) >= 8
    assert np.median(moved) < 0.5


@pytest.mark.parametrize("prefer", [sn.Preferences(bends=1.0), sn.Preferences(start=1.0)], ids=["bends", "start"])
def test_preferred_shapes_do_not_touch_either(prefer: sn.Preferences) -> None:
    solver, rng = sn.Solver(THICK, prefer=prefer), np.random.default_rng(5)
    for _ in range(15):
        q = hidden(THICK, rng)
        solution = solver.solve(target_of(THICK, q), initial=curled(rng, THICK.radii, 2.0))
        assert solution.solved
        assert solution.verify().ok
        assert present(solution.self_clearance) <= gap_of(THICK, solution.q) + 1e-9


def test_a_failure_says_which_segments_touch() -> None:
    """One segment that can only close to a ring."""
    robot = sn.Robot.uniform(1, 1.0, 6.2, radius=0.1)
    solution = sn.solve(robot, sn.Target(sn.Robot.uniform(1, 1.0, 6.2).tip([[6.0, 0.0, 1.0]])[:3, 3]))
    assert str(solution.status) == "blocked"
    assert solution.to_dict()["worst"]["constraint"] == "self_clearance"
    assert "touches itself" in str(solution.worst)
    assert solution.to_dict()["self_clearance"] is None
