"""One segment: the exponential of a constant body twist, and its derivatives.

With the bending vector `u = (ux, uy)` and the length `l` the twist is `omega = (-uy, ux, 0)`, `v = (0, 0, l)`. With
`t = |u|` everything here is made of four functions of `t^2`, smooth at zero:

    S = sin t / t      G = (1 - cos t) / t^2      H = (t - sin t) / t^3      D = (S - 2 G) / t^2

point `(l G ux, l G uy, l S)`, rotation `I + S W + G W^2`, left Jacobian of the rotation `I + G W + H W^2`
(Lynch & Park, Modern Robotics, 3.2.3; Webster & Jones 2010 for constant curvature).
"""

import math

from sinuous.kernels.compile import kernel
from sinuous.kernels.vectors import Mat, Vec, add, cross, mat_vec, sub

Twist = tuple[Vec, Vec]


@kernel
def coefficients(x: float) -> tuple[float, float, float, float]:
    """S, G, H and D at `x = t^2`: power series up to t = 1/2, where the closed forms begin to cancel."""
    if x < 0.25:
        G = 1 - x * (1 / 90) * (1 - x * (1 / 132) * (1 - x * (1 / 182)))
        G = 0.5 - x * (1 / 24) * (1 - x * (1 / 30) * (1 - x * (1 / 56) * G))
        H = 1 - x * (1 / 110) * (1 - x * (1 / 156))
        H = 1 / 6 - x * (1 / 120) * (1 - x * (1 / 42) * (1 - x * (1 / 72) * H))
        D = 1 - x * (2 / 135) * (1 - x * (5 / 528) * (1 - x * (6 / 910) * (1 - x * (7 / 1440))))
        D = x * (1 / 180) * (1 - x * (3 / 112) * D) - 1 / 12
        return 1 - x * H, G, H, D
    t = math.sqrt(x)
    sine = math.sin(t)
    half = math.sin(0.5 * t) / t
    S = sine / t
    G = 2.0 * half * half
    return S, G, (1.0 - S) / x, (S - 2.0 * G) / x


@kernel
def pose(ux: float, uy: float, length: float) -> tuple[Mat, Vec]:
    """Rotation and position of the end of an arc in the frame of its beginning."""
    x = ux * ux + uy * uy
    S, G, _, _ = coefficients(x)
    xy = -G * ux * uy
    rotation = (
        (1.0 - G * ux * ux, xy, S * ux),
        (xy, 1.0 - G * uy * uy, S * uy),
        (-S * ux, -S * uy, 1.0 - G * x),
    )
    return rotation, (length * G * ux, length * G * uy, length * S)


@kernel
def columns(ux: float, uy: float, length: float) -> tuple[Twist, Twist, Vec]:
    """What a change of `ux`, `uy` and `length` does to the end: twists about the beginning of the arc.

    The twist `(omega, v)` moves a point `p` by `v + omega x p`. A change of length turns nothing, so its third column
    is the velocity alone.
    """
    S, G, H, D = coefficients(ux * ux + uy * uy)
    end = (length * G * ux, length * G * uy, length * S)
    turn_x = (-H * ux * uy, 1.0 - H * uy * uy, -G * uy)
    turn_y = (H * ux * ux - 1.0, H * ux * uy, G * ux)
    shift = length * (H - G)
    bow = length * D
    move_x = (length * G + bow * ux * ux, bow * ux * uy, shift * ux)
    move_y = (bow * ux * uy, length * G + bow * uy * uy, shift * uy)
    return (
        (turn_x, sub(move_x, cross(turn_x, end))),
        (turn_y, sub(move_y, cross(turn_y, end))),
        (G * ux, G * uy, S),
    )


@kernel
def carry(rotation: Mat, position: Vec, omega: Vec, v: Vec) -> Twist:
    """A twist about the origin of the frame `(rotation, position)`, seen from the frame that this one stands in."""
    turned = mat_vec(rotation, omega)
    return turned, add(mat_vec(rotation, v), cross(position, turned))
