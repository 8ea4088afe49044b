"""The Newton step of few rows, by a dense system of one equation a row.

Sweeps carry what the robot can still do, a 6 x 6 covariance of twists, past every row. Six rows see no more than six
numbers of a twist, or of the motion of their own segment. So of few rows the covariance of what they see is enough: it
is a sum over segments, to which `extend` adds one after the other, in whatever order the rows are. With J what rows see
of the motion of each segment, the damped Gauss-Newton step of `sweeps` is

    dq = mean + L L' J' x,     (J L L' J' + variances) x = values - J mean

J stays when limits bind and the step is computed once more, with another L and another mean, as half of all steps are.
"""

from sinuous.kernels.body.rows import END, SOFT, Rows
from sinuous.kernels.compile import apart
from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import (
    NOTHING,
    ZERO,
    Array,
    Vec,
    add,
    dot,
    get_mat,
    get_vec,
    mat_vec,
    put_vec,
    vec_mat,
)
from sinuous.kernels.step.sweeps import SOFT_VARIANCE, extend_here
from sinuous.kernels.tables import LENGTH_SCALE, LINK, RIGID

MOST_ROWS = 6
"""Most rows of a dense system."""

JACOBIAN_WIDTH = 18
"""Columns of what is seen of a segment: of each of its coordinates, what rows 3 to 5 see, then rows 0 to 2."""

MOST_SEGMENTS = 12
"""Most segments: with more, it takes longer to find what rows see of each than to carry a covariance past them."""


def dense_size(segments: int) -> int:
    """Numbers of scratch: what is seen (n, 18), and the system (6, 7)."""
    return JACOBIAN_WIDTH * segments + MOST_ROWS * (MOST_ROWS + 1)


def carve_dense(buffer: Array, n: int) -> tuple[Array, Array]:
    """Lay out scratch for n segments."""
    size = JACOBIAN_WIDTH * n
    system = buffer[size : size + MOST_ROWS * (MOST_ROWS + 1)]
    return shaped(buffer[:size], (n, JACOBIAN_WIDTH)), shaped(system, (MOST_ROWS, MOST_ROWS + 1))


def are_few(rows: Rows, n: int) -> bool:
    """Whether there are so few rows and segments that this is quicker than sweeps."""
    return bool(n <= MOST_SEGMENTS and rows.start[n] <= MOST_ROWS)


def fill_constraint_jacobian(limits: Array, columns: Array, rows: Rows, jacobian: Array) -> None:
    """Fill `jacobian` (n, 18) for `columns` (n, 18) as `kinematics` fills them; no row is HARD or IDLE."""
    n = columns.shape[0]
    count = rows.start[n]
    for k in range(n):
        if limits[k, RIGID] != 0.0:
            _fill_rigid(limits, columns, rows, k, jacobian)
            continue
        x, u = get_vec(columns, k, 0), get_vec(columns, k, 3)
        y, v = get_vec(columns, k, 6), get_vec(columns, k, 9)
        z, w = get_vec(columns, k, 12), get_vec(columns, k, 15)
        for i in range(MOST_ROWS):
            at = (i + 3) % 6
            own = ZERO
            if rows.start[k] <= i < count:  # what comes before in the chain sees nothing of this segment
                a, c = get_vec(rows.twist, i, 0), get_vec(rows.twist, i, 3)
                own = (dot(a, x) + dot(c, u), dot(a, y) + dot(c, v), dot(a, z) + dot(c, w))
                if i < rows.start[k + 1] and rows.kind[i] != END:
                    own = add(own, get_vec(rows.inner, i, 0))
            jacobian[k, at], jacobian[k, 6 + at], jacobian[k, 12 + at] = own


@apart
def _fill_rigid(limits: Array, columns: Array, rows: Rows, k: int, jacobian: Array) -> None:
    """The same of a joint, which moves in one coordinate, or a link, in none; rows of places of a link see no more."""
    for at in range(JACOBIAN_WIDTH):
        jacobian[k, at] = 0.0
    if limits[k, RIGID] != LINK:
        own = 0 if limits[k, LENGTH_SCALE] == 0.0 else 6 * 2
        x, u = get_vec(columns, k, own), get_vec(columns, k, own + 3)
        for i in range(rows.start[k], rows.start[columns.shape[0]]):
            jacobian[k, own + (i + 3) % 6] = dot(get_vec(rows.twist, i, 0), x) + dot(get_vec(rows.twist, i, 3), u)


def dense_step(jacobian: Array, root: Array, mean: Array, rows: Rows, mu: float, system: Array, step: Array) -> None:
    """Fill `step` (n, 3) with dq, for what `see` has filled; `system` (6, 7) is scratch."""
    n = root.shape[0]
    m = rows.start[n]
    reach = (NOTHING, NOTHING, NOTHING, ZERO, ZERO)
    for k in range(n):
        reach, _, _ = extend_here(reach, jacobian, k, get_mat(root, k, 0), get_vec(mean, k, 0))
    last, mixed, first, late, early = reach
    for i in range(3):
        put_vec(system, i, 0, first[i])
        system[0, 3 + i], system[1, 3 + i], system[2, 3 + i] = mixed[i]
        put_vec(system, 3 + i, 3, last[i])
    for i in range(m):
        system[i, i] += SOFT_VARIANCE if rows.kind[i] == SOFT else mu
        system[i, m] = rows.value[i] - (early[i] if i < 3 else late[i - 3])
    solve_symmetric(system, m)
    early, late = _side(system, 0, m), _side(system, 3, m)
    for k in range(n):
        L = get_mat(root, k, 0)
        pull = (
            dot(get_vec(jacobian, k, 0), late) + dot(get_vec(jacobian, k, 3), early),
            dot(get_vec(jacobian, k, 6), late) + dot(get_vec(jacobian, k, 9), early),
            dot(get_vec(jacobian, k, 12), late) + dot(get_vec(jacobian, k, 15), early),
        )
        put_vec(step, k, 0, add(get_vec(mean, k, 0), mat_vec(L, vec_mat(pull, L))))


def _side(system: Array, first: int, m: int) -> Vec:
    """Three numbers of the right side from row `first` on; zero where there is no row."""
    x = system[first, m] if first < m else 0.0
    y = system[first + 1, m] if first + 1 < m else 0.0
    return x, y, system[first + 2, m] if first + 2 < m else 0.0


def solve_symmetric(system: Array, m: int) -> None:
    """Solve the positive definite m x m system in `system` (m, m + 1 or wider), whose column m is the right side.

    The answer takes the place of the right side. What is below the diagonal is never read.
    """
    for a in range(m):
        system[a, a] = 1.0 / system[a, a]
        for b in range(a + 1, m):
            f = system[a, b] * system[a, a]
            for c in range(b, m + 1):
                system[b, c] -= f * system[a, c]
    for a in range(m - 1, -1, -1):
        for c in range(a + 1, m):
            system[a, m] -= system[a, c] * system[c, m]
        system[a, m] *= system[a, a]
