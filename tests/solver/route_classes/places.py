"""Places whose classes are known, and the sides on which a body passes, by other code than the library's."""

import itertools

import numpy as np

import sinuous as sn
from benchmarks.judges.kinematics import body_points
from sinuous.scene.obstacles import Obstacle
from tests.helpers import Floats

ROBOT = sn.Robot.uniform(6, (40.0, 60.0), 2.4, radius=4.0)
TARGET = sn.Target((0.0, 0.0, 250.0))

BARS = (-50.0, 0.0, 50.0)
DOORS = ((-70.0, -45.0), (40.0, 65.0))
ACROSS, HALF = 30.0, 500.0


def bar(x: float, z: float, radius: float, name: str) -> sn.Cylinder:
    """A pillar along y that nobody can go round."""
    return sn.Cylinder((x, -HALF, z), (x, HALF, z), radius, name=name)


def pillar() -> list[Obstacle]:
    return [bar(0.0, 150.0, 25.0, "pillar")]


def bars() -> list[Obstacle]:
    return [bar(x, 140.0, 8.0, f"bar {i}") for i, x in enumerate(BARS)]


def wall(z: float = 150.0) -> list[Obstacle]:
    """A wall across z with two doors along x."""
    edges = [-HALF, *DOORS[0], *DOORS[1], HALF]
    found: list[Obstacle] = []
    for name, low, high in zip(("left", "post", "right"), edges[::2], edges[1::2], strict=True):
        found.append(sn.Box((0.5 * (low + high), 0.0, z), (high - low, 2.0 * HALF, 8.0), name=name))
    for low, high in DOORS:
        for side in (-1.0, 1.0):
            y = side * 0.5 * (ACROSS + HALF)
            found.append(sn.Box((0.5 * (low + high), y, z), (high - low, HALF - ACROSS, 8.0), name="lintel"))
    return found


def thin_wall(doors: Floats, middle: float, thickness: float) -> list[Obstacle]:
    """A wall across z with doors (k, 2, 2), their corners in x and y: the cells that their edges divide it into."""
    xs, ys = (np.unique([-HALF, *doors[:, :, axis].ravel(), HALF]) for axis in (0, 1))
    found: list[Obstacle] = []
    for (x0, x1), (y0, y1) in itertools.product(itertools.pairwise(xs), itertools.pairwise(ys)):
        place = np.array([0.5 * (x0 + x1), 0.5 * (y0 + y1)])
        if not ((doors[:, 0] < place) & (place < doors[:, 1])).all(axis=1).any():
            found.append(sn.Box((*place, middle), (x1 - x0, y1 - y0, thickness)))
    return found


def ball() -> list[Obstacle]:
    return [sn.Sphere((0.0, 0.0, 140.0), 40.0, name="ball")]


def crossing(q: Floats, z: float) -> list[float]:
    """Where along x the backbone crosses a height, each time."""
    line = body_points(ROBOT, q[None], 200)[0].reshape(-1, 3)
    return [float(line[i, 0]) for i in np.flatnonzero(np.diff(line[:, 2] > z))]
