"""Cells are closed but for their door, boxes touch without overlapping, and the shape goes through the door."""

import numpy as np
import pytest

from benchmarks.places import make
from benchmarks.places.parts.robots import various_robot
from benchmarks.places.parts.shapes import draw_shape
from benchmarks.places.traps.cells import Cell, cell_around, doorway, draw_half, in_frame, line_of
from sinuous.base.checks import Floats
from sinuous.measures.obstacles import measure
from sinuous.scene.obstacles import Box


def drawn(seed: int) -> tuple[Cell, Floats]:
    """A cell around the beginning of a shape, and that beginning."""
    rng = np.random.default_rng(seed)
    while True:
        robot = various_robot(0, rng)
        line = line_of(robot, draw_shape(robot, 4.0 * max(robot.radii), rng))
        k = len(line.poses) // 2
        cell = cell_around(line.before(k), doorway(line.poses[k], rng), draw_half(line.radius, rng), line.radius, rng)
        if cell is not None:
            return cell, line.before(k)


def least(boxes: list[Box], points: Floats) -> Floats:
    gaps: Floats = np.min([measure(box, points) for box in boxes], axis=0)
    return gaps


@pytest.mark.parametrize("seed", range(3))
def test_the_only_way_out_is_the_door(seed: int) -> None:
    """Straight ways from inside to far outside meet a wall, unless they leave through the door."""
    cell, _ = drawn(seed)
    boxes, rng = cell.boxes("cell"), np.random.default_rng(seed)
    inside = rng.uniform(cell.low, cell.high, (150, 3))
    direction = rng.normal(size=(150, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    far = inside + 2.0 * np.linalg.norm(cell.high - cell.low) * direction
    at = (cell.high[2] - inside[:, 2]) / (far - inside)[:, 2]
    through = inside + at[:, None] * (far - inside)
    by_door = (at > 0.0) & (np.abs(through[:, :2]) < cell.half).all(axis=1)
    shares = np.linspace(0.0, 1.0, 1500)[:, None]
    for a, b, leaves in zip(inside, far, by_door, strict=True):
        way = a + shares * (b - a)
        met = least(boxes, way @ cell.frame[:3, :3].T + cell.frame[:3, 3]).min() <= 0.0
        assert met or leaves


@pytest.mark.parametrize("seed", range(3))
def test_walls_do_not_overlap(seed: int) -> None:
    cell, _ = drawn(seed)
    boxes, rng = cell.boxes("cell"), np.random.default_rng(seed)
    points = rng.uniform(cell.low - cell.wall, cell.high + cell.wall, (20_000, 3)) @ cell.frame[:3, :3].T
    within = np.sum([measure(box, points + cell.frame[:3, 3]) < -1e-9 for box in boxes], axis=0)
    assert within.max() == 1


@pytest.mark.parametrize("seed", range(3))
def test_the_shape_begins_inside_and_all_of_its_beginning_is(seed: int) -> None:
    cell, points = drawn(seed)
    local = in_frame(cell.frame, points)
    assert (local >= cell.low).all()
    assert (local[:, 2] <= 1e-9).all()
    assert not cell.keeps_out(points[:1], 0.0)
    assert cell.keeps_out(points[-1:], 0.0)


def test_a_slit_is_too_narrow_and_the_door_is_not() -> None:
    for seed in range(6):
        made = make("two doors", seed)
        named = {str(obstacle.name): obstacle for obstacle in made.scene.obstacles}
        widths = {}
        for name in ("door", "slit"):
            left, right = named[f"{name} 1"], named[f"{name} 2"]
            assert isinstance(left, Box)
            assert isinstance(right, Box)
            between = (right.center - left.center) @ left.rotation[:, 0]
            widths[name] = between - 0.5 * (left.size[0] + right.size[0])
        assert widths["slit"] < 2.0 * min(made.robot.radii)
        assert widths["door"] > 2.0 * min(made.robot.radii)
