"""The point of a triangle that is closest to another one, the part that it lies on, and on which side the other is."""

from sinuous.kernels.maths.vectors import Array, Vec, add_scaled, dot, norm, scale, sub
from sinuous.kernels.tables import NORMALS_SIZE, TRIANGLE_NORMAL, TRIANGLE_OFFSET

INSIDE, AB, BC, CA, A, B, C = range(7)


def read(store: Array, at: int) -> Vec:
    """Read three numbers."""
    return (store[at], store[at + 1], store[at + 2])


def offset(store: Array, at: int, p: Vec) -> tuple[Vec, int]:  # noqa: PLR0911
    """Vector from the closest point of the triangle at `at` to `p`, and the part that this point lies on.

    By the regions of Voronoi (Ericson 2005, Real-Time Collision Detection, 5.1.5).
    """
    a, b, c = read(store, at), read(store, at + 3), read(store, at + 6)
    ab, ac, ap = sub(b, a), sub(c, a), sub(p, a)
    d1, d2 = dot(ab, ap), dot(ac, ap)
    if d1 <= 0.0 and d2 <= 0.0:
        return ap, A
    bp = sub(p, b)
    d3, d4 = dot(ab, bp), dot(ac, bp)
    if d3 >= 0.0 and d4 <= d3:
        return bp, B
    cp = sub(p, c)
    d5, d6 = dot(ab, cp), dot(ac, cp)
    if d6 >= 0.0 and d5 <= d6:
        return cp, C
    area_c = d1 * d4 - d3 * d2
    if area_c <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        return add_scaled(ap, -d1 / (d1 - d3), ab), AB
    area_b = d5 * d2 - d1 * d6
    if area_b <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        return add_scaled(ap, -d2 / (d2 - d6), ac), CA
    area_a = d3 * d6 - d5 * d4
    if area_a <= 0.0 and d4 >= d3 and d5 >= d6:
        return add_scaled(bp, -(d4 - d3) / ((d4 - d3) + (d5 - d6)), sub(c, b)), BC
    # Along the normal: of a thin triangle the weights of the corners would be mostly rounding.
    n = read(store, at + TRIANGLE_NORMAL)
    return scale(dot(n, ap), n), INSIDE


def square_distance(store: Array, at: int, p: Vec, best: float) -> float:
    """Square of the distance of `p` to the triangle at `at`; at least `best` where it is not less than that."""
    height = dot(read(store, at + TRIANGLE_NORMAL), p) - store[at + TRIANGLE_OFFSET]
    if height * height >= best:  # so far from the plane already
        return best
    away, _ = offset(store, at, p)
    return dot(away, away)


def signed(store: Array, at: int, normals: int, item: int, p: Vec) -> tuple[float, Vec]:
    """Distance of `p` to triangle `item` at `at`, and its gradient: signed where `normals` begin in the store, else -1.

    By the angle-weighted normal of the part that is closest (Baerentzen & Aanaes 2005).
    """
    away, part = offset(store, at, p)
    d = norm(away)
    if normals >= 0:
        normal = read(store, normals + NORMALS_SIZE * item + 3 * part)
    else:
        normal = read(store, at + TRIANGLE_NORMAL)
    inside = normals >= 0 and dot(away, normal) < 0.0
    # So close to the surface the direction of `away` is made of rounding errors.
    if d <= 1e-12 * (norm(p) + norm(read(store, at))):
        return -d if inside else d, normal
    return (-d, scale(-1.0 / d, away)) if inside else (d, scale(1.0 / d, away))
