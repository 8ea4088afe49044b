"""Where points are nearest to the obstacles, by the compiled distances: for what is told of a failure.

The values are those of `sinuous.measures`, which shares nothing with the kernels and judges what is called solved;
tests hold both together. Only out of a `Grid` of distances, where bounds are all that is known, one of them may prove
more. Here they come in milliseconds, also among large meshes.
"""

import math
from typing import NamedTuple

import numpy as np

from sinuous import packing
from sinuous.checks import Floats
from sinuous.scene.grids.field import Field, evaluate
from sinuous.scene.snapshot import Snapshot


class Nearest(NamedTuple):
    """A least distance, and where it is.

    Attributes
    ----------
    distance : float
        Infinite without obstacles.
    place : int or None
        Index of the point.
    obstacle : str or None
        Name of the obstacle.
    """

    distance: float
    place: int | None
    obstacle: str | None


def least_gap(points: Floats, radii: Floats, scene: Snapshot) -> Nearest:
    """Least of `distance - radius` over points (m, 3) with radii (m,), and where it is: along a body it is quickest."""
    return _least(points, radii, scene, False)


def room_at(place: Floats, scene: Snapshot) -> Nearest:
    """Upper bound of the distance of a place (3,) to the obstacles, and the obstacle that gives it."""
    return _least(place[None], np.zeros(1), scene, True)


def _least(points: Floats, radii: Floats, scene: Snapshot, above: bool) -> Nearest:
    from sinuous.kernels.fields import distances  # noqa: PLC0415

    fields = {i: obstacle for i, obstacle in enumerate(scene.obstacles) if isinstance(obstacle, Field)}
    rows, store = packing.scene_parts(scene._kernel_group)
    others = np.array([i for i in range(len(rows)) if i not in fields], np.int64)
    plain = np.require(points, np.float64, ["C", "W"]), np.require(radii, np.float64, ["C", "W"])
    least, place, which = distances.least_gap(rows[others], store, *plain, above)
    best = least, place, int(others[which]) if which >= 0 else -1
    for i, field in fields.items():
        gaps = (field.at_most(points) if above else evaluate(field.function, points)) - radii
        if gaps.min(initial=math.inf) < best[0]:
            best = float(gaps.min()), int(gaps.argmin()), i
    return Nearest(best[0], best[1], scene.name(best[2])) if best[2] >= 0 else Nearest(math.inf, None, None)
