"""What is called impossible among obstacles of which lower bounds of distances are known, or distances cut off."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import sinuous as sn
from tests.helpers import Floats, refused, with_each

LOW, HIGH, SPACING = (-1.0, -1.0, -0.5), (1.0, 1.0, 1.5), 0.05
ROBOT = sn.Robot.uniform(3, (0.2, 0.5), 1.5, radius=0.04)
CENTER = np.array([0.5, 0.0, 0.8])


def ball(points: Floats) -> Floats:
    return np.asarray(np.linalg.norm(points - CENTER, axis=-1) - 0.1)


def grid_of(values: NDArray[Any], **said: object) -> sn.Grid:
    return sn.Grid(values, LOW, SPACING, **said)  # type: ignore[arg-type]


def field_of(share: float, **said: object) -> sn.Field:
    return sn.Field(lambda points: share * ball(points), LOW, HIGH, SPACING, **said)  # type: ignore[arg-type]


def samples() -> Floats:
    return field_of(1.0).values.copy()


FREE = sn.Target((-0.4, 0.0, 0.7))


@pytest.mark.parametrize("said", [{}, {"exact": False}])
def test_a_lower_bound_blocks_no_target(said: dict[str, object]) -> None:
    """0.05 of a distance: near a target in the open it is less than the radius."""
    for obstacle in (field_of(0.05, **said), grid_of(0.05 * samples(), exact=False)):
        solution = sn.solve(ROBOT, FREE, [obstacle], time=0.3)
        assert solution.status not in ("target_blocked", "base_blocked", "no_route")


def test_distances_that_are_cut_off_block_no_target() -> None:
    cut = np.minimum(samples(), 0.02)
    for obstacle in (grid_of(cut), grid_of(cut, truncated=0.02)):
        assert not impossible(sn.solve(ROBOT, FREE, [obstacle], time=0.2))
    whole = sn.Field(lambda points: np.minimum(ball(points), 0.02), LOW, HIGH, SPACING, truncated=0.02)
    assert not impossible(sn.solve(ROBOT, FREE, [whole], time=0.2))


def impossible(solution: sn.Solution) -> bool:
    return str(solution.status) in ("target_blocked", "base_blocked", "no_route", "out_of_reach")


@with_each(
    "obstacle",
    [
        field_of(1.0),
        field_of(0.25),
        field_of(1.0, exact=True),
        grid_of(samples()),
        grid_of(0.5 * samples(), exact=False),
        grid_of(np.minimum(samples(), 0.02), truncated=0.02),
    ],
)
def test_a_target_within_an_obstacle_is_blocked_whatever_is_known(obstacle: sn.Field | sn.Grid) -> None:
    solution = sn.solve(ROBOT, sn.Target(CENTER), [obstacle])
    assert str(solution.status) == "target_blocked"


def test_only_distances_block_a_target_beside_an_obstacle() -> None:
    beside = sn.Target(CENTER + np.array([0.0, 0.0, 0.12]))  # 0.02 off, which is less than the radius
    for obstacle, blocks in (
        (field_of(1.0), False),
        (field_of(1.0, exact=True), True),
        (field_of(1.0, truncated=0.5), True),
        (grid_of(samples()), True),
        (grid_of(samples(), exact=False), False),
    ):
        status = str(sn.solve(ROBOT, beside, [obstacle], time=0.2).status)
        assert status != "solved"
        assert blocks or status != "target_blocked"
    exact = sn.Field(ball, LOW, HIGH, 0.02, exact=True)
    assert str(sn.solve(ROBOT, beside, [exact]).status) == "target_blocked"


def test_what_is_said_of_values_is_checked_and_kept(tmp_path: object) -> None:
    grid = grid_of(samples(), exact=False, truncated=0.3)
    assert (grid.exact, grid.truncated, grid.exact_below) == (False, 0.3, 0.0)
    assert grid_of(samples(), truncated=0.3).exact_below == 0.3
    assert grid_of(samples(), exact=True).exact_below == np.inf
    assert grid_of(samples()).exact_below == samples().max()
    assert field_of(1.0).exact_below == 0.0
    for wrong in ({"exact": "yes"}, {"truncated": 0.0}, {"truncated": "far"}):
        with pytest.raises(sn.InputError, match=next(iter(wrong))):
            grid_of(samples(), **wrong)
    refused("exact", lambda: grid_of(samples() < 0.0, exact=True))
