"""Tubes about the tip, pipes that branch, ducts of boxes: where the body can be, and where it cannot."""

import numpy as np
import pytest

from benchmarks.places import Place, make
from benchmarks.places.traps.cells import Line, line_of
from sinuous.measures.obstacles import measure
from sinuous.scene.obstacles import Box

SEEDS = (1, 2, 6, 8)


def line_in(place: Place) -> Line:
    return line_of(place.robot, place.hidden_q)


@pytest.mark.parametrize("seed", SEEDS)
def test_base_and_target_are_in_tubes_and_the_open_is_between(seed: int) -> None:
    place = make("two tubes", seed)
    line, radius = line_in(place), max(place.robot.radii)
    gaps = place.scene.distance(line.poses[:, :3, 3])
    assert gaps[0] < 2.6 * radius
    assert gaps[-1] < 2.6 * radius
    first, other = place.scene.obstacles
    along = np.linalg.norm(np.diff(line.poses[:, :3, 3], axis=0), axis=1).sum()
    assert measure(first, line.poses[-1:, :3, 3])[0] > 0.02 * along
    assert measure(other, line.poses[:1, :3, 3])[0] > 0.02 * along


@pytest.mark.parametrize("seed", SEEDS)
def test_a_funnel_is_wider_where_it_begins(seed: int) -> None:
    place = make("funnel", seed)
    (wall,) = place.scene.obstacles
    rings = wall.vertices.reshape(2, -1, 16, 3)  # type: ignore[attr-defined]
    outer, inner = (np.linalg.norm(skin - skin.mean(axis=1, keepdims=True), axis=-1).mean(axis=1) for skin in rings)
    inner = inner[::-1]
    assert (outer > inner).all()
    assert inner[0] > 1.4 * inner[-1]
    assert inner[len(inner) // 2 :] == pytest.approx(inner[-1])
    begins = rings[0, 0].mean(axis=0)
    assert np.linalg.norm(line_in(place).poses[0, :3, 3] - begins) > max(place.robot.radii)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_branch_is_a_dead_end(seed: int) -> None:
    """The hollow has one handle, from mouth to mouth, or none where the pipe is closed behind the base."""
    (pipe,) = make("branches", seed).scene.obstacles
    edges = 3 * len(pipe.faces) // 2  # type: ignore[attr-defined]
    handles = 1 - (len(pipe.vertices) - edges + len(pipe.faces)) // 2  # type: ignore[attr-defined]
    assert handles in (0, 1)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_duct_of_boxes_is_closed_all_around(seed: int) -> None:
    """From the shape no straight way leads out across the duct, in the middle of what it encloses."""
    place = make("box duct", seed)
    line, walls = line_in(place), [o for o in place.scene.obstacles if isinstance(o, Box)]
    assert {wall.name for wall in walls} == {"left", "right", "floor", "ceiling"}
    left = np.array([wall.center for wall in walls if wall.name == "left"])
    middle = left[len(left) // 2]
    frame = line.poses[np.linalg.norm(line.poses[:, :3, 3] - middle, axis=1).argmin()]
    rays = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
    far = 8.0 * max(place.robot.radii) * np.linspace(0.0, 1.0, 400)[:, None]
    for turn in rays:
        way = frame[:3, 3] + far * (frame[:3, :2] @ [np.cos(turn), np.sin(turn)])
        assert min(measure(wall, way).min() for wall in walls) <= 0.0
