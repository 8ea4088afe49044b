"""The path that `opti_path` moves: points where arcs meet, and the arcs and tangents that follow from them.

An arc is given by its end points: it leaves `a` along the unit tangent `t`, and ends in `b`.

With the chord `d = b - a`, `D = |d|`, `e = d / D`, half of it `h = D / 2`, and half the bend `x`, `w = t . e = cos x`
is the signed weight of the rational Bezier form of the arc (Song et al. 2009): negative for a major arc. The form is
kept homogeneous, so that the control point `a + (h / w) t`, at infinity for a half turn, is never needed:

    y(u) = ((1 - u)^2 a + 2 u (1 - u) (w a + h t) + u^2 b) / ((1 - u)^2 + 2 u (1 - u) w + u^2)

The next arc leaves along `t' = 2 w e - t`, a reflection; the length is `D x / sin x`. A chain whose end points are
given is thereby a robot without steps in its tangent, as long as no bend reaches a whole turn and no chord vanishes.

The artificial potential of obstacles: zero from a distance on, then rising, with a continuous slope.

    c(d) = slope (reach / 2 - d)            where d < 0
           slope (d - reach)^2 / (2 reach)  where 0 <= d <= reach
           0                                farther away

as CHOMP has it (Ratliff et al. 2009); `d` is the distance of the body's surface. It is sampled on a grid beforehand and
interpolated linearly, or computed from the obstacles each time.
"""

import math
from collections import namedtuple

from sinuous.kernels.chain.arc import pose
from sinuous.kernels.chain.kinematics import compose, frame, put_frame
from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import Scene, nearest, obstacle, read_scene
from sinuous.kernels.maths.shapes import first_of
from sinuous.kernels.maths.vectors import (
    ZERO,
    Array,
    Vec,
    add,
    add_scaled,
    cross,
    dot,
    get_vec,
    norm,
    put_vec,
    scale,
    sub,
    vec_mat,
)
from sinuous.kernels.step.limits import bend_cap
from sinuous.kernels.tables import MAX_LENGTH, MIN_LENGTH

Arc = namedtuple("Arc", ["t", "d", "e", "chord", "w", "x", "g", "q", "length"])
"""An arc: tangent, chord (vector, unit vector, length), weight, half bend, x / sin x, minus its slope in w, length."""

LEAST_SINE = 1e-6
"""Sine of half the bend where an arc counts as closed: its length stays finite."""

LEAST_CHORD = 1e-30

SMALL = 0.02
"""Half bend below which power series are used."""


def stretch(x: float, w: float, sine: float) -> tuple[float, float]:
    """`x / sin x`, the length of an arc of chord one, and `(sin x - x cos x) / sin^3 x`, minus its slope in cos x."""
    if x < SMALL:
        y = x * x
        return 1.0 + y * (1.0 / 6.0 + y * (7.0 / 360.0)), 1.0 / 3.0 + y * (2.0 / 15.0 + y * (2.0 / 63.0))
    s = max(sine, LEAST_SINE)
    return x / s, (s - x * w) / (s * s * s)


def arc_between(a: Vec, b: Vec, t: Vec) -> Arc:
    """The arc from `a` along the unit tangent `t` to `b`; without a chord it is straight."""
    d = sub(b, a)
    chord = norm(d)
    if chord < LEAST_CHORD:
        return Arc(t, d, t, LEAST_CHORD, 1.0, 0.0, 1.0, 1.0 / 3.0, LEAST_CHORD)
    e = scale(1.0 / chord, d)
    w = dot(t, e)
    sine = norm(cross(t, e))
    x = math.atan2(sine, w)
    g, q = stretch(x, w, sine)
    return Arc(t, d, e, chord, w, x, g, q, chord * g)


def end_tangent(arc: Arc) -> Vec:
    """Unit tangent at the end of an arc: the reflection of the first one about the chord."""
    turned = sub(scale(2.0 * arc.w, arc.e), arc.t)
    return scale(1.0 / norm(turned), turned)


def offset(arc: Arc, u: float) -> Vec:
    """The point `y(u)` of the rational Bezier form, seen from the beginning of the arc; u is not arc length."""
    b = 2.0 * u * (1.0 - u)
    below = (1.0 - u) * (1.0 - u) + u * u + b * arc.w
    return scale(1.0 / max(below, LEAST_SINE), add_scaled(scale(0.5 * b * arc.chord, arc.t), u * u, arc.d))


def pull_point(arc: Arc, u: float, r: Vec, force: Vec) -> tuple[Vec, Vec]:
    """What a force at `y(u)`, which is at `r` from the beginning, does to the chord and to the tangent.

    The transposed derivatives of `offset` in `d` and in `t`, applied to `force`.
    """
    b = 2.0 * u * (1.0 - u)
    inverse = 1.0 / max((1.0 - u) * (1.0 - u) + u * u + b * arc.w, LEAST_SINE)
    along = dot(r, force)
    on_chord = add_scaled(scale(u * u, force), 0.5 * b * dot(arc.t, force), arc.e)
    on_chord = add_scaled(on_chord, -along * b / arc.chord, add_scaled(arc.t, -arc.w, arc.e))
    on_tangent = add_scaled(scale(0.5 * b * arc.chord, force), -along * b, arc.e)
    return scale(inverse, on_chord), scale(inverse, on_tangent)


def pull_length(arc: Arc, force: float) -> tuple[Vec, Vec]:
    """What a force on the length does to chord and tangent: `dl/dd = g e - q (t - w e)`, `dl/dt = -D q e`."""
    aside = add_scaled(arc.t, -arc.w, arc.e)
    return scale(force, add_scaled(scale(arc.g, arc.e), -arc.q, aside)), scale(-force * arc.chord * arc.q, arc.e)


def pull_weight(arc: Arc, force: float) -> tuple[Vec, Vec]:
    """What a force on the weight `w`, the cosine of half the bend, does to the chord and to the tangent."""
    return scale(force / arc.chord, add_scaled(arc.t, -arc.w, arc.e)), scale(force, arc.e)


def pull_tangent(arc: Arc, force: Vec) -> tuple[Vec, Vec]:
    """What a force on the tangent at the end does to the chord and to the first tangent.

    `dt'/dd = (2 / D) (w (I - e e') + e (t - w e)')`, `dt'/dt = 2 e e' - I`.
    """
    along = dot(arc.e, force)
    aside = add_scaled(arc.t, -arc.w, arc.e)
    on_chord = add_scaled(scale(arc.w, add_scaled(force, -along, arc.e)), along, aside)
    return scale(2.0 / arc.chord, on_chord), sub(scale(2.0 * along, arc.e), force)


def put_points(frames: Array, points: Array) -> None:
    """Fill `points` (n + 1, 3) with the positions of `frames` (n + 1, 12)."""
    for k in range(frames.shape[0]):
        put_vec(points, k, 0, get_vec(frames, k, 9))


def configuration_of(points: Array, frames: Array, q: Array) -> None:
    """Fill `q` (n, 3), and `frames` after the base in row 0, for the chain of arcs through `points` (n + 1, 3).

    In the frame that the tangent carries along, the chord `p` gives the bend `2 atan2(hypot(px, py), pz)` in its
    direction. Chords start where the robot really is, so that roundings do not add up.
    """
    for k in range(q.shape[0]):
        rotation, position = frame(frames, k)
        p = vec_mat(sub(get_vec(points, k + 1, 0), position), rotation)
        side = math.hypot(p[0], p[1])
        chord = math.hypot(side, p[2])
        x = math.atan2(side, p[2])
        bend, length = 2.0 * x, 0.0
        if chord > 0.0:
            length = chord * stretch(x, p[2] / chord, side / chord)[0]
        cosine, sine = (p[0] / side, p[1] / side) if side > 0.0 else (1.0, 0.0)
        put_vec(q, k, 0, (bend * cosine, bend * sine, length))
        turn, shift = pose(q[k, 0], q[k, 1], q[k, 2])
        rotation, position = compose(rotation, position, turn, shift)
        put_frame(frames, k + 1, rotation, position)


def along_arc(t: Vec, side: Vec, bend: float, length: float, s: float) -> Vec:
    """Where an arc along `t`, bending towards the unit vector `side` across it, is at arc length `s length`."""
    if bend < 1e-9:
        return scale(s * length, t)
    radius = length / bend
    half = math.sin(0.5 * s * bend)
    return add(scale(radius * math.sin(s * bend), t), scale(2.0 * radius * half * half, side))


Aim = namedtuple("Aim", ["position", "direction", "directed", "unit"])
"""The target: where the last point is, the tangent there if one is asked for, and the mean length of a segment."""

Path = namedtuple("Path", ["points", "kept", "tangents", "arcs", "update", "avoid", "wanted"])
"""A path: points (n + 1, 3), the best ones so far, tangents (n + 1, 3), arcs (n, 15), the gradient (n + 1, 3) without
and of the obstacles, and for every arc (n, 4) the lengths that cost nothing, the cap of its bend, and its body's part
that is in the mount."""

Work = namedtuple("Work", ["path", "q", "setting", "potential"])
"""Scratch of one solve: the path and a configuration (n, 3); and what stays as it is: the options of the method (see
`gradient.Setting`) and the potential of the obstacles."""


def want(limits: Array, band: float, mount: float, path: Path) -> None:
    """Fill what every arc wants: its mean length or, with a dead band, any in that share of the range about it.

    `limits` (n, 7) are those of the segments; `mount` is the length of backbone that obstacles do not concern.
    """
    for k in range(limits.shape[0]):
        low, high = limits[k, MIN_LENGTH], limits[k, MAX_LENGTH]
        inset = 0.5 * (1.0 - band)
        path.wanted[k, 0], path.wanted[k, 1] = low + inset * (high - low), high - inset * (high - low)
        path.wanted[k, 2] = bend_cap(limits, k, 0.5 * (low + high))
        path.wanted[k, 3] = mount
        mount = max(0.0, mount - 0.5 * (low + high))


def put_arc(arcs: Array, k: int, arc: Arc) -> None:
    """Write row `k` of `arcs` (n, 15)."""
    put_vec(arcs, k, 0, arc.t)
    put_vec(arcs, k, 3, arc.d)
    put_vec(arcs, k, 6, arc.e)
    arcs[k, 9], arcs[k, 10], arcs[k, 11] = arc.chord, arc.w, arc.x
    arcs[k, 12], arcs[k, 13], arcs[k, 14] = arc.g, arc.q, arc.length


def get_arc(arcs: Array, k: int) -> Arc:
    """Row `k` of `arcs` (n, 15)."""
    return Arc(get_vec(arcs, k, 0), get_vec(arcs, k, 3), get_vec(arcs, k, 6), *first_of(arcs[k, 9:], 6))


def trace(path: Path) -> None:
    """Fill arcs and tangents from the points and the first tangent."""
    t = get_vec(path.tangents, 0, 0)
    for k in range(path.arcs.shape[0]):
        arc = arc_between(get_vec(path.points, k, 0), get_vec(path.points, k + 1, 0), t)
        t = end_tangent(arc)
        put_arc(path.arcs, k, arc)
        put_vec(path.tangents, k + 1, 0, t)


BLOCK = 8
"""Nodes along the edge of a block that is looked at as a whole before its nodes are."""

Potential = namedtuple("Potential", ["scene", "values", "origin", "spacing", "slope", "reach", "radius"])
"""The obstacles; values (x, y, z) at the nodes of a grid, none: exact; where its first node is and how far nodes are
apart; the parameters of `c`; and the radius of the body."""


def hinge(d: float, slope: float, reach: float) -> tuple[float, float]:
    """c(d) and its derivative."""
    if d < 0.0:
        return slope * (0.5 * reach - d), -slope
    if d <= reach:
        return 0.5 * slope / reach * (d - reach) * (d - reach), slope / reach * (d - reach)
    return 0.0, 0.0


def read_potential(scene: Scene, sampled: Array, slope: float, reach: float) -> Potential:
    """Take the group `sampled` apart: shape (3), origin (3), spacing, radius of the body, then the values."""
    nx, ny, nz = int(sampled[0]), int(sampled[1]), int(sampled[2])
    origin = (sampled[3], sampled[4], sampled[5])
    return Potential(scene, sampled[8:].reshape((nx, ny, nz)), origin, sampled[6], slope, reach, sampled[7])


def exact(potential: Potential, p: Vec) -> tuple[float, Vec]:
    """Potential and its gradient at `p`, from the obstacles themselves."""
    d, which = nearest(potential.scene, p)
    c, slope = hinge(d - potential.radius, potential.slope, potential.reach)
    if c == 0.0:
        return 0.0, ZERO
    return c, scale(slope, obstacle(potential.scene, which, p, math.inf)[1])


def interpolated(potential: Potential, p: Vec) -> tuple[float, Vec]:
    """Potential at `p`, linear along each axis within a cell of the grid, and its gradient; zero outside the grid."""
    values, inverse = potential.values, 1.0 / potential.spacing
    x, y, z = scale(inverse, sub(p, potential.origin))
    i, j, k = math.floor(x), math.floor(y), math.floor(z)
    if i < 0 or j < 0 or k < 0:
        return 0.0, ZERO
    if i >= values.shape[0] - 1 or j >= values.shape[1] - 1 or k >= values.shape[2] - 1:
        return 0.0, ZERO
    x, y, z = x - i, y - j, z - k
    a, b = values[i, j, k], values[i, j, k + 1]
    c, d = values[i, j + 1, k], values[i, j + 1, k + 1]
    e, f = values[i + 1, j, k], values[i + 1, j, k + 1]
    g, h = values[i + 1, j + 1, k], values[i + 1, j + 1, k + 1]
    near, far = a + z * (b - a), c + z * (d - c)
    near_on, far_on = e + z * (f - e), g + z * (h - g)
    here, on = near + y * (far - near), near_on + y * (far_on - near_on)
    rise_y = (far - near) + x * ((far_on - near_on) - (far - near))
    rise, rise_on = (b - a) + y * ((d - c) - (b - a)), (f - e) + y * ((h - g) - (f - e))
    return here + x * (on - here), scale(inverse, (on - here, rise_y, rise + x * (rise_on - rise)))


def potential_at(potential: Potential, p: Vec) -> tuple[float, Vec]:
    """Potential and its gradient at `p`."""
    if potential.values.shape[0] > 0:
        return interpolated(potential, p)
    return exact(potential, p)


@entry
def sample(scene: Array, sampled: Array, shape: tuple[float, float], centre: Array, extent: float) -> None:
    """Fill the values of the group `sampled` with the potential at the nodes; zero where no body can be.

    `scene` is the group of the scene; `shape` holds slope and reach of the potential. A body can be within `extent` of
    `centre` (1, 3). Blocks of nodes that are farther from every obstacle than the potential reaches are filled at once.
    """
    slope, reach = shape
    obstacles = read_scene(scene)
    potential = read_potential(obstacles, sampled, slope, reach)
    values = potential.values
    middle = get_vec(centre, 0, 0)
    spacing = potential.spacing
    half = 0.5 * (BLOCK - 1) * spacing
    around = math.sqrt(3.0) * half
    for bi in range(0, values.shape[0], BLOCK):
        for bj in range(0, values.shape[1], BLOCK):
            for bk in range(0, values.shape[2], BLOCK):
                p = _node(potential, bi, bj, bk)
                p = (p[0] + half, p[1] + half, p[2] + half)
                d, _ = nearest(obstacles, p)
                clear = d > potential.radius + reach + around or norm(sub(p, middle)) > extent + around
                for i in range(bi, min(bi + BLOCK, values.shape[0])):
                    for j in range(bj, min(bj + BLOCK, values.shape[1])):
                        for k in range(bk, min(bk + BLOCK, values.shape[2])):
                            values[i, j, k] = 0.0
                            if not clear:
                                d, _ = nearest(obstacles, _node(potential, i, j, k))
                                values[i, j, k] = hinge(d - potential.radius, slope, reach)[0]


def _node(potential: Potential, i: int, j: int, k: int) -> Vec:
    origin, spacing = potential.origin, potential.spacing
    return (origin[0] + i * spacing, origin[1] + j * spacing, origin[2] + k * spacing)
