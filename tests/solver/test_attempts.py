"""Attempts: each alone finds what it is for, in places of the benchmark, with intermediate targets and tools."""

import numpy as np
import pytest

import sinuous as sn
from benchmarks.places import make
from sinuous.solver.options import ATTEMPTS

PLACES = [
    ("open pipe 1.6", 1, ("base_tube",)),
    ("two tubes", 2, ("base_tube",)),
    ("cells", 0, ("edges", "laid")),
    ("cells pipe", 4, ("edges", "side_tubes", "grown")),
    ("cells", 1, ("cells", "laid")),
    ("two tubes", 2, ("cells", "grown")),
    ("cells", 1, ("edges", "grown")),
    ("folded", 0, ("cells", "gates")),
    ("door in mesh", 54, ("edges", "gates")),
    ("door in mesh", 54, ("cells", "detours")),
]
"""Families, numbers, and attempts that are enough there."""


def alone(*names: str) -> list[str]:
    """All other attempts."""
    return [name for name in ATTEMPTS if name not in names]


@pytest.mark.parametrize(("family", "number", "names"), PLACES)
def test_each_attempt_leads_to_a_solution_by_itself(family: str, number: int, names: tuple[str, ...]) -> None:
    place = make(family, number)
    solver = sn.Solver(place.robot, place.scene, tolerance=place.tolerance, time=60.0, without=alone(*names))
    found = solver.solve(place.targets)
    assert found.solved
    assert found.verify().ok
    assert found.start == "route"
    assert found.route is not None
    np.testing.assert_allclose(found.route[0], place.robot.base[:3, 3], atol=1e-9)
    np.testing.assert_array_equal(solver.solve(place.targets).q, found.q)


@pytest.mark.parametrize("asked", ["position", "direction", "rotation", "elbow"])
@pytest.mark.parametrize("tool", [False, True])
@pytest.mark.parametrize(
    ("family", "number", "names"), [("two tubes", 2, ("cells", "grown")), ("door in mesh", 54, ("edges", "gates"))]
)
def test_chains_from_both_ends_meet_whatever_is_asked(
    family: str, number: int, names: tuple[str, ...], tool: bool, asked: str
) -> None:
    place = make(family, number)
    radius, middle = min(place.robot.radii), len(place.robot) // 2
    held = sn.pose((0.3 * radius, 0.0, 1.5 * radius), direction=(0.2, 0.0, 1.0)) if tool else np.eye(4)
    robot = place.robot.changed(tool=held)
    tip = robot.tip(place.hidden_q)
    targets = {
        "position": [sn.Target(tip[:3, 3])],
        "direction": [sn.Target(tip[:3, 3], direction=tip[:3, 2])],
        "rotation": [sn.Target(tip[:3, 3], rotation=tip[:3, :3])],
        "elbow": [sn.Target(robot.forward(place.hidden_q)[middle - 1, :3, 3], segment=middle), sn.Target(tip[:3, 3])],
    }[asked]
    found = sn.solve(robot, targets, place.scene, tolerance=place.tolerance, time=60.0, without=alone(*names))
    assert (found.solved, found.start) == (True, "route")
    assert found.verify().ok
