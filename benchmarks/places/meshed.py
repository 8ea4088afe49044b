"""What a triangulated model makes of a place of boxes: one mesh of many bodies."""

import itertools

import numpy as np
from numpy.random import Generator

from benchmarks.places.parts.surfaces import Surface, joined, solid
from benchmarks.places.place import Draw, Sketch
from sinuous.model.robot import Robot
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.obstacles import Box

GAP = 0.01
"""By how much each box is smaller on every side, in radii of the body: bodies of one mesh may not touch."""

CORNERS = 0.5 * np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
FACES = np.array(
    [
        *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)),
        *((2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
    ]
)
"""Of the cube of edge 1 about the origin, faces counterclockwise as seen from outside."""


def meshed(draw: Draw, seed: int, rng: Generator) -> Sketch | None:
    """Replace all boxes of another family by one mesh."""
    sketch = draw(seed, rng)
    if sketch is None:
        return None
    boxes = [o for o in sketch.obstacles if isinstance(o, Box)]
    others = [o for o in sketch.obstacles if not isinstance(o, Box)]
    return sketch._replace(obstacles=[one_mesh(boxes, sketch.robot), *others])


def one_mesh(boxes: list[Box], robot: Robot) -> Mesh:
    """Return boxes as one mesh."""
    gap = GAP * min(robot.radii)
    return solid(joined([_surface(box, gap) for box in boxes]), "walls")


def _surface(box: Box, gap: float) -> Surface:
    return Surface((CORNERS * (box.size - 2.0 * gap)) @ box.rotation.T + box.center, FACES)
