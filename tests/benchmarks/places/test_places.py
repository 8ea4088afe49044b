"""Every family: the hidden shape is feasible by an independent check, and a seed makes its place again."""

from functools import cache

import numpy as np
import pytest

import sinuous as sn
from benchmarks.judges.clearances import least_clearance, overlaps
from benchmarks.motion import known
from benchmarks.places import FAMILIES, make
from benchmarks.problems import random_configurations

made_once = cache(make)
"""To prepare a place takes seconds: tests that only look at it share it."""

DRAWN = [name for name in FAMILIES if not name.startswith("p") and not name.endswith("scan")] + ["pipe 1.3", "plates"]
DRAWN += ["pipe between", "pipe 1.6 scan", "drum scan"]


@pytest.mark.parametrize("family", DRAWN)
def test_the_hidden_shape_is_feasible_and_meshes_are_solids(family: str) -> None:
    made = made_once(family, {"assembly": 15, "gyroid": 15}.get(family, 10))  # others of these take twice as long
    assert all(each.watertight and not each.defects for each in made.scene.obstacles if isinstance(each, sn.Mesh))
    found = sn.check(
        made.robot, made.hidden_q, made.scene, made.targets
    )  # shares no code with the judge that `make` asks
    assert found.ok
    assert found.position_error <= 1e-9 * made.robot.mean_length
    assert found.angle_error <= 1e-9


@pytest.mark.parametrize("family", ["pipe 2.2", "duct", "pipe 1.6 scan", "duct scan"])
def test_nobody_gets_out_of_what_is_closed(family: str) -> None:
    """Shapes drawn at random leave the pipe, through its wall: the judge sees every one."""
    made = made_once(family, 10)
    drawn = random_configurations(made.robot, 12, np.random.default_rng(0))
    assert overlaps(made.robot, made.scene, drawn).all()
    assert not overlaps(made.robot, made.scene, made.hidden_q[None]).any()


@pytest.mark.parametrize("family", ["spheres 12", "small world", "p4 pose"])
def test_a_seed_makes_its_place_again(family: str) -> None:
    first, again, other = made_once(family, 10), make(family, 10), made_once(family, 13)
    np.testing.assert_array_equal(first.hidden_q, again.hidden_q)
    np.testing.assert_array_equal(first.target.table, again.target.table)
    assert not np.array_equal(first.target.table, other.target.table)


@pytest.mark.parametrize(
    "family", ["40 balls, leading", "plates, wandering", "two doors", "door in, from another shape"]
)
def test_a_motion_is_hidden_in_places_to_plan_into(family: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What `make` has looked at with few samples is clear at others, too, and what stands around is near."""
    monkeypatch.setattr("benchmarks.judges.judge.A_STEP", 10)
    monkeypatch.setattr(known, "LOOKS", 4)
    place = known.make(family, 7)
    radius, gaps = max(place.robot.radii), least_clearance(place.robot, place.scene, place.knots)
    assert 0.1 * radius < gaps.min() < radius
