"""The length of a tendon or a chamber in one arc, with first and second derivatives by the state of the arc.

A line at the place h in the frames of the body, an arc with bend v, torsion tau and length l. Its length is the root of

- straight, from frame to frame: `4 r^2 sin^2(tau / 2) + 2 G (l - v . y) (l - v . h)` with y = h turned by tau;
- along the arc, as a helix: `(l - v . g)^2 + r^2 tau^2` with g = h turned by tau / 2.

The first follows from the place `(y + G (l - v . y) v, S (l - v . y))` of y at the end of the arc, and
`G^2 |v|^2 + S^2 = 2 G`.
"""

import math

from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.statics.layout import HESSIAN
from sinuous.kernels.statics.profile import Profile

Slope = tuple[float, float, float, float]
Curved = tuple[float, float, float, float, float, float, float, float, float, float]
"""Second derivatives: vx vx, vx vy, vx tau, vx l, vy vy, vy tau, vy l, tau tau, tau l, l l."""


def _rooted(square: float, slope: Slope, curved: Curved, hx: float, hy: float) -> tuple[float, Slope, Curved]:
    """The root of a quantity, with its derivatives from those of the quantity; in an arc of no length `l - v . h`."""
    root = math.sqrt(square)
    if root == 0.0:
        return 0.0, (-hx, -hy, 0.0, 1.0), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    half = 0.5 / root
    a, b, c, d = half * slope[0], half * slope[1], half * slope[2], half * slope[3]
    over = 2.0 * half
    return (
        root,
        (a, b, c, d),
        (
            half * curved[0] - over * a * a,
            half * curved[1] - over * a * b,
            half * curved[2] - over * a * c,
            half * curved[3] - over * a * d,
            half * curved[4] - over * b * b,
            half * curved[5] - over * b * c,
            half * curved[6] - over * b * d,
            half * curved[7] - over * c * c,
            half * curved[8] - over * c * d,
            half * curved[9] - over * d * d,
        ),
    )


def straight(
    vx: float, vy: float, torsion: float, length: float, hx: float, hy: float, own: Profile
) -> tuple[float, Slope, Curved]:
    """Length of a straight line, and its derivatives; `own` is the profile of the end of the arc."""
    cosine, sine = math.cos(torsion), math.sin(torsion)
    yx, yy = cosine * hx - sine * hy, sine * hx + cosine * hy
    a, b = length - vx * yx - vy * yy, length - vx * hx - vy * hy
    turned, square = vx * yy - vy * yx, hx * hx + hy * hy  # the derivative of a by the torsion; r^2
    G, D, E = own[0], 2.0 * own[2], 4.0 * own[4]
    ab, both = a * b, a + b
    mx, my = b * yx + a * hx, b * yy + a * hy
    slope = (
        2.0 * (D * ab * vx - G * mx),
        2.0 * (D * ab * vy - G * my),
        2.0 * (square * sine + G * b * turned),
        2.0 * G * both,
    )
    nx, ny = turned * hx - b * yy, turned * hy + b * yx
    curved = (
        2.0 * (ab * (D + E * vx * vx) - 2.0 * D * vx * mx + 2.0 * G * yx * hx),
        2.0 * (ab * E * vx * vy - D * (vx * my + vy * mx) + G * (yx * hy + yy * hx)),
        2.0 * (D * vx * b * turned - G * nx),
        2.0 * (D * vx * both - G * (yx + hx)),
        2.0 * (ab * (D + E * vy * vy) - 2.0 * D * vy * my + 2.0 * G * yy * hy),
        2.0 * (D * vy * b * turned - G * ny),
        2.0 * (D * vy * both - G * (yy + hy)),
        2.0 * (square * cosine + G * b * (vx * yx + vy * yy)),
        2.0 * G * turned,
        4.0 * G,
    )
    return _rooted(4.0 * square * math.sin(0.5 * torsion) ** 2 + 2.0 * G * ab, slope, curved, hx, hy)


def along(vx: float, vy: float, torsion: float, length: float, hx: float, hy: float) -> tuple[float, Slope, Curved]:
    """Length of a line that follows the arc, and its derivatives."""
    cosine, sine = math.cos(0.5 * torsion), math.sin(0.5 * torsion)
    gx, gy = cosine * hx - sine * hy, sine * hx + cosine * hy
    a, turned, square = length - vx * gx - vy * gy, 0.5 * (vx * gy - vy * gx), hx * hx + hy * hy
    slope = (-2.0 * a * gx, -2.0 * a * gy, 2.0 * (a * turned + square * torsion), 2.0 * a)
    curved = (
        2.0 * gx * gx,
        2.0 * gx * gy,
        a * gy - 2.0 * turned * gx,
        -2.0 * gx,
        2.0 * gy * gy,
        -a * gx - 2.0 * turned * gy,
        -2.0 * gy,
        2.0 * (turned * turned + 0.25 * a * (vx * gx + vy * gy) + square),
        2.0 * turned,
        2.0,
    )
    return _rooted(a * a + square * torsion * torsion, slope, curved, hx, hy)


def add_curved(stages: Array, k: int, tension: float, curved: Curved) -> None:
    """Add second derivatives, times a tension, to those of arc `k`."""
    at = 0
    for i in range(4):
        for j in range(i, 4):
            stages[k, HESSIAN + 4 * i + j] += tension * curved[at]
            if j > i:
                stages[k, HESSIAN + 4 * j + i] += tension * curved[at]
            at += 1
