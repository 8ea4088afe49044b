"""What a scanner, and what a triangulated model, makes of a place: points on all surfaces, or one mesh."""

import math

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.judges.clearances import least_clearance
from benchmarks.places.parts.surfaces import CORNERS, FACES, Faces, Surface, joined, solid
from benchmarks.places.place import ROOM, Draw, Sketch
from sinuous.base.checks import Floats
from sinuous.scene.obstacles import Obstacle
from sinuous.view.display.surfaces import obstacle_surface

THICKNESS = 0.15
"""Radius of a point."""

LATTICE, CELL = 0.25, 0.55
"""Points lie on triangles this close together; of those in one cubic cell, one is kept.

No place of a surface is then farther from a point than LATTICE / sqrt(3) + CELL * sqrt(3) + NOISE = 1.12, which is
less than body and point together, 1.15: the middle of the body cannot get through.
"""

AROUND, EDGE, WALL = 20, 6, 12
"""Facets of an obstacle around what is round, along the edge of a box, and along the wall of a cylinder or capsule."""

NOISE = 0.02
"""Most that a point is beside the surface. All in radii of the body."""


def scan(draw: Draw, seed: int, rng: Generator) -> Sketch | None:
    """Replace all obstacles of another family by one cloud."""
    sketch = draw(seed, rng)
    if sketch is None:
        return None
    radius = min(sketch.robot.radii)
    room = (ROOM + THICKNESS + NOISE) * radius
    if least_clearance(sketch.robot, sn.Scene(sketch.obstacles), sketch.q[None], room)[0] < room:
        return None
    points = np.concatenate([_on(triangles(obstacle), LATTICE * radius) for obstacle in sketch.obstacles])
    points = _thinned(points, CELL * radius)
    noise = rng.uniform(-1.0, 1.0, points.shape) * NOISE * radius / math.sqrt(3.0)
    return sketch._replace(obstacles=[sn.PointCloud(points + noise, THICKNESS * radius, name="scan")])


def triangles(obstacle: Obstacle) -> Floats:
    """Corners (f, 3, 3) of triangles that cover the surface of an obstacle, or nearly so where it is round."""
    pieces = EDGE if isinstance(obstacle, sn.Box) else WALL
    surface = obstacle_surface(obstacle, np.zeros(3), 0.0, AROUND, pieces)
    return surface.vertices[surface.triangles]


def _on(corners: Floats, spacing: float) -> Floats:
    """Points (m, 3) on triangles (f, 3, 3): a lattice on each, its neighbours no farther apart than `spacing`."""
    longest = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=-1).max(axis=1)
    pieces = np.ceil(longest / spacing).astype(int)
    found = []
    for count in np.unique(pieces):
        weights = _lattice(max(int(count), 1))
        found.append(np.einsum("wc,fcx->fwx", weights, corners[pieces == count]).reshape(-1, 3))
    return np.concatenate(found)


def _lattice(count: int) -> Floats:
    i, j = np.meshgrid(np.arange(count + 1), np.arange(count + 1), indexing="ij")
    i, j = i[i + j <= count], j[i + j <= count]
    return np.stack([i, j, count - i - j], axis=-1) / count


def _thinned(points: Floats, cell: float) -> Floats:
    """Keep one point of every cubic cell."""
    numbers: Faces = np.floor(points / cell).astype(np.int64)
    numbers -= numbers.min(axis=0)
    sizes = numbers.max(axis=0) + 1
    key = (numbers[:, 0] * sizes[1] + numbers[:, 1]) * sizes[2] + numbers[:, 2]
    return points[np.unique(key, return_index=True)[1]]


GAP = 0.01
"""By how much each box is smaller on every side, in radii of the body: bodies of one mesh may not touch."""


def meshed(draw: Draw, seed: int, rng: Generator) -> Sketch | None:
    """Replace all boxes of another family by one mesh."""
    sketch = draw(seed, rng)
    if sketch is None:
        return None
    boxes = [o for o in sketch.obstacles if isinstance(o, sn.Box)]
    others = [o for o in sketch.obstacles if not isinstance(o, sn.Box)]
    return sketch._replace(obstacles=[one_mesh(boxes, sketch.robot), *others])


def one_mesh(boxes: list[sn.Box], robot: sn.Robot) -> sn.Mesh:
    """Return boxes as one mesh."""
    gap = GAP * min(robot.radii)
    return solid(joined([_surface(box, gap) for box in boxes]), "walls")


def _surface(box: sn.Box, gap: float) -> Surface:
    return Surface((CORNERS * (box.size - 2.0 * gap)) @ box.rotation.T + box.center, FACES)
