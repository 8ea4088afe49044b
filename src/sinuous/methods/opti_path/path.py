"""The path that `opti_path` moves: points where arcs meet, and the arcs and tangents that follow from them."""

from collections import namedtuple

from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import Array, get_vec, put_vec
from sinuous.kernels.step.limits import bend_cap
from sinuous.kernels.tables import MAX_LENGTH, MIN_LENGTH
from sinuous.methods.opti_path.bezier import Arc, arc_between, end_tangent

Aim = namedtuple("Aim", ["position", "direction", "directed", "unit"])
"""The target: where the last point is, the tangent there if one is asked for, and the mean length of a segment."""

Path = namedtuple("Path", ["points", "kept", "tangents", "arcs", "update", "avoid", "wanted"])
"""A path: points (n + 1, 3), the best ones so far, tangents (n + 1, 3), arcs (n, 15), the gradient (n + 1, 3) without
and of the obstacles, and for every arc (n, 4) the lengths that cost nothing, the cap of its bend, and its body's part
that is in the mount."""

Work = namedtuple("Work", ["path", "q", "setting", "potential"])
"""Scratch of one solve: the path and a configuration (n, 3); and what stays as it is: the options of the method (see
`costs.Setting`) and the potential of the obstacles."""


@kernel
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


@kernel
def put_arc(arcs: Array, k: int, arc: Arc) -> None:
    """Write row `k` of `arcs` (n, 15)."""
    put_vec(arcs, k, 0, arc.t)
    put_vec(arcs, k, 3, arc.d)
    put_vec(arcs, k, 6, arc.e)
    arcs[k, 9], arcs[k, 10], arcs[k, 11] = arc.chord, arc.w, arc.x
    arcs[k, 12], arcs[k, 13], arcs[k, 14] = arc.g, arc.q, arc.length


@kernel
def get_arc(arcs: Array, k: int) -> Arc:
    """Row `k` of `arcs` (n, 15)."""
    return Arc(
        get_vec(arcs, k, 0),
        get_vec(arcs, k, 3),
        get_vec(arcs, k, 6),
        arcs[k, 9],
        arcs[k, 10],
        arcs[k, 11],
        arcs[k, 12],
        arcs[k, 13],
        arcs[k, 14],
    )


@kernel
def trace(path: Path) -> None:
    """Fill arcs and tangents from the points and the first tangent."""
    t = get_vec(path.tangents, 0, 0)
    for k in range(path.arcs.shape[0]):
        arc = arc_between(get_vec(path.points, k, 0), get_vec(path.points, k + 1, 0), t)
        t = end_tangent(arc)
        put_arc(path.arcs, k, arc)
        put_vec(path.tangents, k + 1, 0, t)
