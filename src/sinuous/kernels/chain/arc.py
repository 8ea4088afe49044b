"""One segment: the exponential of a constant body twist, and its derivatives.

With the bending vector `u = (ux, uy)` and the length `l` the twist is `omega = (-uy, ux, 0)`, `v = (0, 0, l)`. With
`t = |u|` everything here is made of four functions of `t^2`, smooth at zero:

    S = sin t / t      G = (1 - cos t) / t^2      H = (t - sin t) / t^3      D = (S - 2 G) / t^2

point `(l G ux, l G uy, l S)`, rotation `I + S W + G W^2`, left Jacobian of the rotation `I + G W + H W^2`
(Lynch & Park, Modern Robotics, 3.2.3; Webster & Jones 2010 for constant curvature).
"""

import math

from sinuous.kernels.maths.vectors import Mat, Vec, add, cross, mat_vec, sub

Twist = tuple[Vec, Vec]

SERIES_END = 10.0
TERMS = 15
SERIES_G = tuple((-1) ** k / math.factorial(2 * k + 2) for k in range(TERMS))
SERIES_H = tuple((-1) ** k / math.factorial(2 * k + 3) for k in range(TERMS))
SERIES_D = tuple((-1) ** (k + 1) * (2 * k + 2) / math.factorial(2 * k + 4) for k in range(TERMS))


def _series(x: float, terms: tuple[float, ...]) -> float:
    """Sum of `terms[k] x^k`, an odd number of them: even and odd powers apart, so that each waits for half as many."""
    square = x * x
    even, odd = terms[-1], terms[-2]
    for k in range(len(terms) - 3, 0, -2):
        even, odd = terms[k] + square * even, terms[k - 1] + square * odd
    return terms[0] + square * even + x * odd


def coefficients(x: float) -> tuple[float, float, float, float]:
    """S, G, H and D at `x = t^2`: power series to a little beyond t = pi, quicker there; above, closed forms."""
    if x < SERIES_END:
        H = _series(x, SERIES_H)
        return 1.0 - x * H, _series(x, SERIES_G), H, _series(x, SERIES_D)
    t = math.sqrt(x)
    sine = math.sin(t)
    half = math.sin(0.5 * t) / t
    S = sine / t
    G = 2.0 * half * half
    return S, G, (1.0 - S) / x, (S - 2.0 * G) / x


def pose(ux: float, uy: float, length: float) -> tuple[Mat, Vec]:
    """Rotation and position of the end of an arc in the frame of its beginning."""
    x = ux * ux + uy * uy
    S, G, _, _ = coefficients(x)
    return _pose(ux, uy, length, x, S, G)


def _pose(ux: float, uy: float, length: float, x: float, S: float, G: float) -> tuple[Mat, Vec]:
    xy = -G * ux * uy
    rotation = ((1.0 - G * ux * ux, xy, S * ux), (xy, 1.0 - G * uy * uy, S * uy), (-S * ux, -S * uy, 1.0 - G * x))
    return rotation, (length * G * ux, length * G * uy, length * S)


def point(ux: float, uy: float, length: float) -> Vec:
    """Position of the end of an arc in the frame of its beginning."""
    x = ux * ux + uy * uy
    if x < SERIES_END:
        G = length * _series(x, SERIES_G)
        return G * ux, G * uy, length * (1.0 - x * _series(x, SERIES_H))
    S, G, _, _ = coefficients(x)
    return length * G * ux, length * G * uy, length * S


def pose_and_columns(ux: float, uy: float, length: float) -> tuple[Mat, Vec, Twist, Twist, Vec]:
    """The pose of the end, and what a change of `ux`, `uy` and `length` does to it, as twists about the beginning.

    The twist `(omega, v)` moves a point `p` by `v + omega x p`. A change of length turns nothing, so its third column
    is the velocity alone.
    """
    x = ux * ux + uy * uy
    S, G, H, D = coefficients(x)
    rotation, end = _pose(ux, uy, length, x, S, G)
    turn_x = (-H * ux * uy, 1.0 - H * uy * uy, -G * uy)
    turn_y = (H * ux * ux - 1.0, H * ux * uy, G * ux)
    shift = length * (H - G)
    bow = length * D
    move_x = (length * G + bow * ux * ux, bow * ux * uy, shift * ux)
    move_y = (bow * ux * uy, length * G + bow * uy * uy, shift * uy)
    return (
        rotation,
        end,
        (turn_x, sub(move_x, cross(turn_x, end))),
        (turn_y, sub(move_y, cross(turn_y, end))),
        (G * ux, G * uy, S),
    )


def carry(rotation: Mat, position: Vec, omega: Vec, v: Vec) -> Twist:
    """A twist about the origin of the frame `(rotation, position)`, seen from the frame that this one stands in."""
    turned = mat_vec(rotation, omega)
    return turned, add(mat_vec(rotation, v), cross(position, turned))
