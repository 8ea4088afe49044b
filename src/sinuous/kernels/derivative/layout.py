"""What a derivative is asked for and answers, as flat groups, and what it works on.

A *row* `a . dq = b . dtheta` says what a small change of the answer has to do when parameters change: a target that
is met, or a limit or contact that is active and stays so. Its *wrench* `(torque, force)`, about the base in world axes,
says what a small motion of the world beyond its place does to it; limits, and contacts of the body with itself, have
none.

`asked` (14,) int64 says which parameters there are, `answer` (w,) is flat, see `answer_size`.
"""

from collections import namedtuple

from sinuous.kernels.body.rows import carve_rows, pick_rows, rows_size
from sinuous.kernels.body.self_contacts import MOST_PAIRS, pair_width
from sinuous.kernels.body.self_pairs import SPAN_WIDTH
from sinuous.kernels.chain.kinematics import put_base
from sinuous.kernels.maths.buffers import cut, cut_whole
from sinuous.kernels.maths.vectors import Array

TARGET, BASE, TOOL, LENGTHS, BENDS, CURVATURES, RADII, TENDONS, ACTUATORS, OBSTACLES, INITIAL = range(11)
"""Groups of parameters, as places in `asked`: where the columns of each begin, -1 where it is not asked for."""

TARGET_COLUMNS = 6
"""Columns of each target: its position, and its orientation as a small rotation in world axes; those of what is not
asked for are zero."""

COLUMNS, ROWS, ANSWER = 11, 12, 13
"""Places in `asked` of the number of all columns, of the most rows, and of the numbers of an answer."""

ASKED_WIDTH = 14

ROW_KIND, ROW_SEGMENT, ROW_OTHER, ROW_SIDE, ROW_SLACK, ROW_FACTOR, ROW_WRENCH = range(7)
"""Columns of what is known about a row: TARGET_ROW, or the kind of constraint as `velocity.layout` numbers them; its
segment, and the obstacle, actuator limit, target or other segment; 0 for a lower and 1 for an upper end; what is left
of a limit or gap beyond what is kept (length, rad); what the row was multiplied by, so that it has length 1 in the
metric; and its wrench (6)."""

ABOUT_WIDTH = 12

TARGET_ROW = -1

STATUS, ROW_COUNT, TARGET_ROWS, WORST_RESIDUAL = range(4)
"""Header of an answer: how it ended, bits of `SINGULAR`, `KINK` and `FULL`; rows in all; rows of targets, which come
first; and the largest residual of these (rad, robot lengths)."""

ANSWER_HEADER = 4

SINGULAR, KINK, TOO_MANY, PREFERRED = 1, 2, 4, 8
"""Rows of targets depend on each other; an active row is in the way of some changes and not of the opposite ones; there
were more active rows than there is room for; preferences have chosen the answer, which kernels do not know."""

MOST_ACTIVE = 256
"""Most rows of limits and contacts."""

Workspace = namedtuple(
    "Workspace", "q frames columns near spans pairs asked rows about sides forces system moved way values"
)
"""A configuration (n, 3), frames (n + 1, 12), columns (n, 18); numbers of obstacles (m,) int64; spans and self-contacts
as `body.self_contacts` has them; what targets ask, as the `Rows` of a step; rows (r, 3 n), what is known about them
(r, 12), and their right sides (r, p); what
becomes of these while the system is solved (r, p); the triangular factor of the system (r, r); what a unit of each
parameter moves (3 n, p); and the way to targets that are not quite met (3 n, 1), with the right side of it (r, 1)."""


def most_rows(segments: int, targets: int) -> int:
    """Most rows of a derivative."""
    return 6 * targets + min(MOST_ACTIVE, 4 * segments + 32)


def answer_size(segments: int, targets: int, columns: int) -> int:
    """Numbers of one answer: header, `moved` (3 n, p), rows (r, 3 n), about (r, 12), sides (r, p)."""
    r = most_rows(segments, targets)
    return ANSWER_HEADER + 3 * segments * columns + r * (3 * segments + ABOUT_WIDTH + columns)


def workspace_size(segments: int, obstacles: int, targets: int, columns: int) -> int:
    """Numbers (float64) of workspace beside the answer."""
    n, r = segments, most_rows(segments, targets)
    own = 36 * n + 12 + obstacles + SPAN_WIDTH * (n + 1) + rows_size(n, 6 * targets)
    return own + MOST_PAIRS * pair_width(n) + r * (r + 1 + columns)


def carve_workspace(
    buffer: Array, answer: Array, base: Array, obstacles: int, targets: int, sizes: tuple[int, int, int]
) -> Workspace:
    """Lay out a workspace in `buffer`, and the answer behind its header; `base` (1, 12).

    `sizes`: segments, most rows, columns of all parameters.
    """
    n, r, p = sizes
    q, rest = cut(buffer, n, 3)
    frames, rest = cut(rest, n + 1, 12)
    put_base(frames, base)
    columns, rest = cut(rest, n, 18)
    near, rest = cut_whole(rest, obstacles)
    spans, rest = cut(rest, n + 1, SPAN_WIDTH)
    pairs, rest = cut(rest, MOST_PAIRS, pair_width(n))
    system, rest = cut(rest, r, r)
    way, rest = cut(rest, 3 * n, 1)
    values, rest = cut(rest, r, 1)
    forces, rest = cut(rest, r, p)
    asked = pick_rows(carve_rows(rest, 1, n, 6 * targets), 0)
    moved, told = cut(answer[ANSWER_HEADER:], 3 * n, p)
    rows, told = cut(told, r, 3 * n)
    about, told = cut(told, r, ABOUT_WIDTH)
    sides, told = cut(told, r, p)
    return Workspace(
        q, frames, columns, near, spans, pairs, asked, rows, about, sides, forces, system, moved, way, values
    )
