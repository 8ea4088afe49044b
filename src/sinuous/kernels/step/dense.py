"""The Newton step of few rows, by a dense system of one equation a row.

Sweeps carry what the robot can still do, a 6 x 6 covariance of twists, past every row. Six rows see no more than six
numbers of a twist, or of the motion of their own segment. So of few rows the covariance of what they see is enough: it
is a sum over segments, to which `extend` adds one after the other, in whatever order the rows are. With J what rows see
of the motion of each segment, the damped Gauss-Newton step of `sweeps` is

    dq = mean + L L' J' x,     (J L L' J' + variances) x = values - J mean

J stays when limits bind and the step is computed once more, with another L and another mean, as half of all steps are.

`columns` (n, 18) are those of `chain.kinematics`, `jacobian` (n, 18) is J, `mean` (n, 3) a motion that is decided
beforehand.
"""

from sinuous.kernels.body.rows import END, SOFT, Rows
from sinuous.kernels.compile import apart
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
    transpose,
    vec_mat,
)
from sinuous.kernels.step.sweeps import SOFT_VARIANCE, Reach, extend_here
from sinuous.kernels.tables import LENGTH_SCALE, LINK, RIGID

MOST_ROWS = 6
"""Most rows of a dense system."""

Equation = tuple[float, float, float, float, float, float, float]
"""A row of it, and its right side."""

JACOBIAN_WIDTH = 18
"""Columns of what is seen of a segment: of each of its coordinates, what rows 3 to 5 see, then rows 0 to 2."""

MOST_SEGMENTS = 12
"""Most segments: with more, it takes longer to find what rows see of each than to carry a covariance past them."""


def dense_size(segments: int) -> int:
    """Numbers of scratch: what is seen (n, 18)."""
    return JACOBIAN_WIDTH * segments


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
    if limits[k, RIGID] == LINK:
        return
    own = 0 if limits[k, LENGTH_SCALE] == 0.0 else 12
    x, u = get_vec(columns, k, own), get_vec(columns, k, own + 3)
    for i in range(MOST_ROWS):
        if rows.start[k] <= i < rows.start[columns.shape[0]]:
            jacobian[k, own + (i + 3) % 6] = dot(get_vec(rows.twist, i, 0), x) + dot(get_vec(rows.twist, i, 3), u)


def dense_step(jacobian: Array, root: Array, mean: Array, rows: Rows, mu: float, step: Array) -> None:
    """Fill `step` (n, 3) with dq, for what `fill_constraint_jacobian` has filled."""
    n = root.shape[0]
    m = rows.start[n]
    reach = (NOTHING, NOTHING, NOTHING, ZERO, ZERO)
    for k in range(n):
        reach, _, _ = extend_here(reach, jacobian, k, get_mat(root, k, 0), get_vec(mean, k, 0))
    early, late = _solve_six(reach, rows, m, mu)
    for k in range(n):
        L = get_mat(root, k, 0)
        pull = (
            dot(get_vec(jacobian, k, 0), late) + dot(get_vec(jacobian, k, 3), early),
            dot(get_vec(jacobian, k, 6), late) + dot(get_vec(jacobian, k, 9), early),
            dot(get_vec(jacobian, k, 12), late) + dot(get_vec(jacobian, k, 15), early),
        )
        put_vec(step, k, 0, add(get_vec(mean, k, 0), mat_vec(L, vec_mat(pull, L))))


def _solve_six(reach: Reach, rows: Rows, m: int, mu: float) -> tuple[Vec, Vec]:
    """Solve the system of m rows, as `solve_symmetric` would, in registers; rows beyond are 0. First three, last three.

    What has no row is an equation of its own, whose answer is 0.
    """
    last, mixed, first, late, early = reach
    b0, b1, b2 = transpose(mixed)
    r0 = (first[0][0] + _variance(rows, 0, m, mu), first[0][1], first[0][2], *b0, _asked(rows, 0, m, early[0]))
    r1 = (0.0, first[1][1] + _variance(rows, 1, m, mu), first[1][2], *b1, _asked(rows, 1, m, early[1]))
    r2 = (0.0, 0.0, first[2][2] + _variance(rows, 2, m, mu), *b2, _asked(rows, 2, m, early[2]))
    d3, d4, d5 = _variance(rows, 3, m, mu), _variance(rows, 4, m, mu), _variance(rows, 5, m, mu)
    r3 = (*ZERO, last[0][0] + d3, last[0][1], last[0][2], _asked(rows, 3, m, late[0]))
    r4 = (*ZERO, 0.0, last[1][1] + d4, last[1][2], _asked(rows, 4, m, late[1]))
    r5 = (*ZERO, 0.0, 0.0, last[2][2] + d5, _asked(rows, 5, m, late[2]))
    d0 = 1.0 / r0[0]
    r1, r2, r3 = _less(r1, r0[1] * d0, r0), _less(r2, r0[2] * d0, r0), _less(r3, r0[3] * d0, r0)
    r4, r5, d1 = _less(r4, r0[4] * d0, r0), _less(r5, r0[5] * d0, r0), 1.0 / r1[1]
    r2, r3 = _less(r2, r1[2] * d1, r1), _less(r3, r1[3] * d1, r1)
    r4, r5, d2 = _less(r4, r1[4] * d1, r1), _less(r5, r1[5] * d1, r1), 1.0 / r2[2]
    r3, r4, r5 = _less(r3, r2[3] * d2, r2), _less(r4, r2[4] * d2, r2), _less(r5, r2[5] * d2, r2)
    d3 = 1.0 / r3[3]
    r4, r5 = _less(r4, r3[4] * d3, r3), _less(r5, r3[5] * d3, r3)
    d4 = 1.0 / r4[4]
    r5 = _less(r5, r4[5] * d4, r4)
    x5 = r5[6] * (1.0 / r5[5])
    x4 = (r4[6] - r4[5] * x5) * d4
    x3 = (r3[6] - r3[4] * x4 - r3[5] * x5) * d3
    x2 = (r2[6] - r2[3] * x3 - r2[4] * x4 - r2[5] * x5) * d2
    x1 = (r1[6] - r1[2] * x2 - r1[3] * x3 - r1[4] * x4 - r1[5] * x5) * d1
    x0 = (r0[6] - r0[1] * x1 - r0[2] * x2 - r0[3] * x3 - r0[4] * x4 - r0[5] * x5) * d0
    return (x0, x1, x2), (x3, x4, x5)


def _variance(rows: Rows, i: int, m: int, mu: float) -> float:
    if i >= m:
        return 1.0
    return SOFT_VARIANCE if rows.kind[i] == SOFT else mu


def _asked(rows: Rows, i: int, m: int, seen: float) -> float:
    return float(rows.value[i] - seen) if i < m else 0.0


def _less(row: Equation, f: float, other: Equation) -> Equation:
    """row - f other."""
    return (
        row[0] - f * other[0],
        row[1] - f * other[1],
        row[2] - f * other[2],
        row[3] - f * other[3],
        row[4] - f * other[4],
        row[5] - f * other[5],
        row[6] - f * other[6],
    )


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
