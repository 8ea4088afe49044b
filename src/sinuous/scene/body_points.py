"""Which points of a cloud belong to the body of the robot: a camera sees it, too."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.arguments import Rows
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.model.robot import Robot
from sinuous.statics.equilibrium import Equilibrium
from sinuous.statics.rest import bodies_at

if TYPE_CHECKING:
    import sinuous as sn

Belongs = Callable[[Floats, Floats], NDArray[np.bool_]]

SPACING = 0.1
"""Distance of places along a body that stand for it, in what is kept from it."""

FEWEST, MOST = 4, 200
"""Places along a segment."""


def nothing_of_it(points: Floats, radii: Floats) -> NDArray[np.bool_]:
    """No point belongs to the body."""
    return np.zeros(len(points), np.bool_)


def body_filter(shape: "sn.Solution | Equilibrium | tuple[Robot, Rows]", margin: float) -> Belongs:
    """From points (m, 3) and their radii (m,) to whether each belongs to the body of a robot in a shape (m,)."""
    if isinstance(shape, Equilibrium):
        body, arcs = shape.body, shape.arcs
    else:
        pair = (
            shape
            if isinstance(shape, tuple)
            else (getattr(shape, "robot", None), getattr(shape, "configuration", getattr(shape, "q", None)))
        )
        if len(pair) != 2 or not isinstance(pair[0], Robot):
            raise InputError("ignore_robot", "", shape, "a solution, robot.shape(q), or a robot and its configuration")
        with checks.inside("ignore_robot"):
            q = checks.array("q", pair[1], (len(pair[0]), 3))
        body, all_arcs = bodies_at(pair[0], q[None])
        arcs = all_arcs[0]
    widths = np.array(body.radii) + margin
    wanted = float(arcs[:, 2].max()) / (SPACING * max(float(widths.min()), 1e-3 * body.mean_length))
    samples = int(np.clip(math.ceil(wanted), FEWEST, MOST))
    places = body.backbone(arcs, samples)
    owners = np.minimum(np.arange(len(places)) // samples, len(body) - 1)

    def belongs(points: Floats, radii: Floats) -> NDArray[np.bool_]:
        from scipy.spatial import cKDTree  # noqa: PLC0415

        away, nearest = cKDTree(places).query(points)
        half_gap = 0.5 * arcs[owners[nearest], 2] / samples
        inside: NDArray[np.bool_] = away - half_gap <= widths[owners[nearest]] + radii
        return inside

    return belongs
