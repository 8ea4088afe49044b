"""From waypoint to waypoint: the tip goes straight, and every step is proved."""

from itertools import pairwise

import numpy as np
import pytest

import sinuous as sn
from tests.helpers import Floats, refused, with_each

ROBOT = sn.Robot.uniform(4, (0.8, 1.2), max_bend=2.0, radius=0.05)
SPARSE = [sn.Target((2.0 * np.cos(turn), 2.0 * np.sin(turn), 2.5)) for turn in np.linspace(0.0, 4.0, 6)]
BALL = sn.Sphere((0.9, 0.0, 1.2), 0.3, name="ball")


def from_line(points: Floats, path: list[sn.Target]) -> float:
    """Largest distance of points from the line through all waypoints."""
    places = np.stack([target.position for target in path if target.position is not None])
    least = np.full(len(points), np.inf)
    for a, b in pairwise(places):
        share = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
        least = np.minimum(least, np.linalg.norm(points - a - share[:, None] * (b - a), axis=-1))
    return float(least.max())


@pytest.mark.parametrize("deviation", [None, 0.01, 0.2])
def test_the_tip_goes_straight(deviation: float | None) -> None:
    motion = sn.track(ROBOT, SPARSE, [BALL], deviation=deviation)
    assert motion.solved
    assert motion.reconfigured == ()
    tips = ROBOT.tip(motion.at(np.linspace(0.0, 5.0, 2000)))[:, :3, 3]
    most = 10 * 1e-4 * ROBOT.mean_length if deviation is None else deviation
    assert from_line(tips, SPARSE) <= most
    np.testing.assert_array_equal([motion.times[knot] for knot in motion.waypoint_knots if knot is not None], range(6))
    for way in (motion, motion.reversed()):
        for solution, knot in zip(way.solutions, way.waypoint_knots, strict=True):
            np.testing.assert_array_equal(way.q[knot], solution.q)


def test_directions_turn_on_the_way() -> None:
    path = [
        sn.Target((1.0, 0.0, 3.0), direction=(0.5, 0.0, 1.0)),
        sn.Target((0.0, 1.0, 3.0), direction=(0.0, 0.5, 1.0)),
    ]
    motion = sn.track(ROBOT, path, deviation=0.01)
    assert motion.solved
    for time in np.linspace(0.0, 1.0, 20):
        direction = ROBOT.tip(motion.at(time))[:3, 2]
        assert direction @ [0.0, 0.0, 1.0] > np.cos(np.arctan(0.5)) - 0.01


def test_an_update_of_the_scene_is_seen_at_the_next_waypoint() -> None:
    scene = sn.Scene([sn.PointCloud([[9.0, 0.0, 0.0]], 0.1, name="cloud")])
    seen: list[sn.Solution] = []

    def move(solution: sn.Solution) -> None:
        seen.append(solution)
        scene.update([[9.0, 0.0, float(len(seen))]])

    motion = sn.track(ROBOT, SPARSE[:3], scene, progress=move)
    assert len({id(solution.problem.scene) for solution in motion.solutions}) == 3
    assert motion.solved
    assert motion.scene is motion.solutions[-1].problem.scene


@pytest.mark.parametrize(("center", "between"), [((9.0, 0.0, 0.0), "proved"), ((2.0, 0.3, 2.5), "unproved")])
def test_a_motion_is_proved_in_the_scene_that_it_names(center: tuple[float, ...], between: str) -> None:
    """Steps were called proved in the last scene although they had been proved in an earlier one."""
    scene = sn.Scene([sn.Sphere((9.0, 9.0, 9.0), 0.5, name="ball")])
    seen: list[sn.Solution] = []

    def move(solution: sn.Solution) -> None:
        seen.append(solution)
        if len(seen) == 4:
            scene.move("ball", position=np.subtract(center, (9.0, 9.0, 9.0)))

    motion = sn.track(ROBOT, SPARSE, scene, progress=move)
    assert len({id(solution.problem.scene) for solution in motion.solutions}) == 2
    assert motion.scene is motion.solutions[-1].problem.scene
    assert motion.between == between
    assert motion.reversed().between == between
    q = np.concatenate([np.linspace(a, b, 40) for a, b in pairwise(motion.q)])
    assert bool(motion.scene.distance(ROBOT.backbone(q)).min() > 0.05) is (between == "proved")
    anew = sn.Motion(ROBOT, motion.q, motion.scene, motion.times)
    np.testing.assert_array_equal(anew.steps.proved, motion.steps.proved)


@with_each("wrong", [0, -1.0, "near", np.nan, True])
def test_a_deviation_below_the_tolerance_is_refused(wrong: object) -> None:
    refused("deviation", lambda: sn.track(ROBOT, SPARSE, deviation=wrong))  # type: ignore[arg-type]
