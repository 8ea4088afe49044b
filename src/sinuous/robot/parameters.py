"""Bending vectors and the arc parameters of the literature: curvature, angle of the bending plane, length."""

import numpy as np

from sinuous import checks
from sinuous.arguments import Number, Stack
from sinuous.checks import Floats
from sinuous.errors import InputError


def from_arc_parameters(curvature: Number | Stack, plane_angle: Number | Stack, length: Number | Stack) -> Floats:
    """Configuration (..., 3) of segments with these curvatures (1 / length), bending-plane angles (rad) and lengths.

    Webster & Jones 2010: (kappa, phi, l). The arrays broadcast; `(n,)` arrays make one configuration (n, 3).
    """
    given = (("curvature", curvature), ("plane_angle", plane_angle), ("length", length))
    parts = [checks.stack(key, value, ()) for key, value in given]
    kappa, phi, arc = checks.broadcast("curvature", curvature, *parts)
    return np.stack([kappa * arc * np.cos(phi), kappa * arc * np.sin(phi), arc], axis=-1)


def arc_parameters(q: Stack) -> tuple[Floats, Floats, Floats]:
    """Curvature (1 / length), bending-plane angle (rad; 0 when straight) and length of every segment, each (..., n).

    A segment of length 0 has no curvature unless it is straight (then 0).
    """
    x = checks.stack("q", q, (3,))
    bend = np.hypot(x[..., 0], x[..., 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        curvature = np.where(bend == 0.0, 0.0, bend / x[..., 2])
    if not np.isfinite(curvature).all():
        raise InputError(
            "q", "has a bent segment of length 0", x.tolist(), "a length greater than 0 where there is a bend"
        )
    return curvature, np.arctan2(x[..., 1], x[..., 0]), x[..., 2].copy()
