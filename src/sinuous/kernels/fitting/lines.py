"""Lines of points, whole: evenly spaced, how long they are, and how far they are from the obstacles."""

from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import closest, read_scene
from sinuous.kernels.fields.solids import EXACT
from sinuous.kernels.freespace.band import respace
from sinuous.kernels.maths.vectors import Array, get_vec, norm, sub


@entry
def respace_line(line: Array, out: Array) -> None:
    """Fill `out` (M, 3), two points at least, with points that are evenly spaced along `line` (K, 3)."""
    respace(line, line.shape[0], out, out.shape[0])


@entry
def measure_line(line: Array, along: Array) -> None:
    """Fill `along` (K,) with the length of `line` (K, 3), one point at least, up to each of its points."""
    along[0] = 0.0
    for i in range(1, line.shape[0]):
        along[i] = along[i - 1] + norm(sub(get_vec(line, i, 0), get_vec(line, i - 1, 0)))


@entry
def room_along(scene: Array, points: Array, reach: float, distances: Array) -> None:
    """Fill `distances` (K,) with those of `points` (K, 3) from the obstacles of the group `scene`, in the length unit.

    Beyond `reach` they may be anything that is not less.
    """
    obstacles = read_scene(scene)
    for i in range(points.shape[0]):
        distances[i], _ = closest(obstacles, get_vec(points, i, 0), reach, EXACT)
