"""A tip that leaves the line between two waypoints, and what a motion says of it."""

import json
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

import sinuous as sn
from tests.helpers import Floats, refused, with_each

ROBOT = sn.Robot.uniform(4, (0.8, 1.2), max_bend=2.0, radius=0.05)
PLATE = sn.Box((0.0, 0.0, 2.6), (0.02, 3.0, 1.4))
ACROSS = [sn.Target((x, 0.0, 2.8)) for x in (-1.5, -1.2, 1.2, 1.5)]
"""A thin plate between two waypoints, each of which is clear of it."""


def seam(number: int) -> tuple[sn.Robot, list[sn.Target], list[sn.Capsule]]:
    """A weld around a pipe, by the normals of it, perhaps with the pipe; an arm of 4 to 8 segments."""
    rng = np.random.default_rng([11, number])
    count = int(rng.integers(4, 9))
    robot = sn.Robot.uniform(count, (80, 120), max_bend=2.0, radius=8.0)
    size = rng.uniform(12, 25) * count
    center = 100 * count * np.array([rng.uniform(0.2, 0.55), rng.uniform(-0.15, 0.15), rng.uniform(0.2, 0.6)])
    angles = rng.uniform(0.0, 2.0 * np.pi) + np.linspace(0.0, rng.uniform(1.2, 2.0) * np.pi, 12)
    normals = np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=-1)
    path = [sn.Target(center + size * normal, direction=-normal) for normal in normals]
    pipe = sn.Capsule(center - np.array([0, 0, size]), center + np.array([0, 0, size]), 0.6 * size)
    return robot, path, [pipe] if number % 2 else []


def off_line(motion: sn.Motion, begin: int, end: int) -> Floats:
    """Distances of the tip between two waypoints, 0 = first, from the line between them."""
    knots = [motion.waypoint_knots[i] for i in (begin, end)]
    assert knots[0] is not None
    assert knots[1] is not None
    a, b = (motion.solutions[i].problem.targets[0].position for i in (begin, end))
    assert a is not None
    assert b is not None
    tips = motion.robot.tip(motion.at(np.linspace(motion.times[knots[0]], motion.times[knots[1]], 500)))[:, :3, 3]
    share = np.clip((tips - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
    distances: Floats = np.linalg.norm(tips - a - share[:, None] * (b - a), axis=-1)
    return distances


@pytest.mark.parametrize(("number", "leaves"), [(4, False), (35, True)])
def test_a_tip_that_leaves_a_weld_is_told(number: int, leaves: bool) -> None:
    robot, path, pipe = seam(number)
    motion = sn.track(robot, path, pipe, deviation=1.0, time=0.5)
    reached = [i for i, knot in enumerate(motion.waypoint_knots) if knot is not None]
    most = [off_line(motion, a, b).max() for a, b in pairwise(reached)]
    assert bool(motion.left_steps) is leaves
    assert bool(max(most) > 1.0 + 1e-4 * robot.mean_length) is leaves
    seen = motion.verify().left_steps
    assert {*seen} <= {*motion.left_steps}  # in the others, the tip is turned
    assert bool(seen) is leaves
    if leaves:
        assert not motion.solved
        assert max(most) == pytest.approx(motion.largest_deviation[0], rel=1e-2)


@cache
def left() -> sn.Motion:
    """The motion around the plate; not led when tests are collected, since that compiles."""
    return sn.track(ROBOT, ACROSS, [PLATE])


def test_a_motion_that_leaves_its_path_says_so() -> None:
    motion = left()
    assert motion.status is sn.Status.LEFT_PATH
    assert not motion.solved
    assert motion.between == "proved"
    assert motion.reconfigured == (3,)
    off, turned = motion.largest_deviation
    assert off == pytest.approx(off_line(motion, 1, 2).max(), rel=1e-2)
    assert turned == 0.0
    said = f"the tip is up to {off:.3g} off the line between two waypoints"
    assert said in str(motion).splitlines()[0]
    with pytest.raises(sn.NotSolvedError, match="left_path .*" + said):
        motion.raise_for_status()
    verification = motion.verify()
    assert all(each.ok for each in verification)
    assert not verification.ok
    assert verification.left_steps == motion.left_steps
    back = motion.reversed()
    assert back.status is sn.Status.LEFT_PATH
    assert back.left_steps == tuple(len(motion.q) - step for step in motion.left_steps[::-1])
    values = json.loads(json.dumps(motion.to_dict()))
    assert values["left_steps"] == list(motion.left_steps)
    assert values["largest_deviation"] == {"position": off, "angle": 0.0}
    again = sn.Motion.from_dict(values, [solution.problem for solution in motion.solutions])
    assert (again.status, again.left_steps) == (motion.status, motion.left_steps)


def test_where_it_is_allowed_the_path_may_be_left() -> None:
    asked, motion = left(), sn.track(ROBOT, ACROSS, [PLATE], reconfigure="allow")
    assert motion.solved
    assert motion.verify().ok
    assert motion.left_steps == asked.left_steps
    assert "off the line between two waypoints" in str(motion)
    np.testing.assert_array_equal(motion.q, asked.q)
    old = {key: value for key, value in asked.to_dict().items() if key not in ("reconfigure", "deviation")}
    problems = [solution.problem for solution in motion.solutions]
    assert sn.Motion.from_dict({**old, "status": "solved"}, problems).solved  # written before anything was said of it


@with_each("wrong", ["never", "", True, None])
def test_what_may_be_said_of_leaving_is_checked(wrong: object) -> None:
    expected = "expected refuse or allow"
    refused("reconfigure", lambda: sn.track(ROBOT, ACROSS, reconfigure=wrong), expected)  # type: ignore[arg-type]
    refused("reconfigure", lambda: sn.Job(ROBOT, path=ACROSS, reconfigure=wrong), expected)  # type: ignore[arg-type]
