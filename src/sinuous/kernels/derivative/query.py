"""The derivative of an answer by the implicit function theorem on its active rows.

Let A be the rows at the answer, W the metric of a step, squared and inverted (rad, and mean lengths of segments), and
`b` the right sides. The least motion that keeps all rows is `dq = m + W A' (A W A')^-1 (b - A m)`, where m is what a
parameter moves by itself: the derivative of the nearest answer, and the step of a control loop as its time goes to 0.
The system has as many unknowns as there are rows, so all of it is linear in the number of segments.

An active limit or contact only pushes. What it does is linear in the parameters just where it is not called upon: where
all rows of the targets alone would leave it as it is. Else the answer has a kink there.

`asked` (14,) int64 and `answer` (w,) are those of `layout`; `sides` (r, p) has the right sides of r rows for p
parameters, `moved` (3 n, p) what these move.
"""

import math

from sinuous.kernels.chain.kinematics import forward_with_columns
from sinuous.kernels.compile import entry, shared
from sinuous.kernels.derivative import layout as d
from sinuous.kernels.derivative.layout import Workspace, carve_workspace
from sinuous.kernels.derivative.rows import (
    add_contacts,
    add_equalities,
    add_limits,
    add_self_contacts,
    add_targets,
    normalise,
)
from sinuous.kernels.derivative.sides import fill_sides, move_directly
from sinuous.kernels.fields.distances import number_of
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import Array, copy
from sinuous.kernels.problem import Problem, read_problem
from sinuous.kernels.tables import BEND_SCALE, LENGTH_SCALE

SINGULAR_BELOW = 1e-10
"""Square of the sine between a row and those before it from which on it counts as one of theirs."""

STILL = 1e-9
"""What an active row may be asked for without being called upon, relative to the largest that any row is asked for."""

CONVERGED = 1e-9
"""Residual (rad, robot lengths) of the targets below which the way to where they are met makes no difference."""


def weight(limits: Array, i: int) -> float:
    """Entry `i` of the metric's inverse: squares of rad, and of lengths."""
    scale = limits[i // 3, BEND_SCALE] if i % 3 < 2 else limits[i // 3, LENGTH_SCALE]
    return float(scale * scale)


def factorise(limits: Array, work: Workspace, count: int, targets: int) -> int:
    """Fill the lower triangle of `work.system` with the root of A W A'.

    A row that depends on earlier ones has a zero on the diagonal, and plays no part. Says how many of those there are
    among the first `targets` rows.
    """
    rows, system, dependent = work.rows, work.system, 0
    for a in range(count):
        for b in range(a + 1):
            total = 0.0
            for i in range(rows.shape[1]):
                total += rows[a, i] * weight(limits, i) * rows[b, i]
            for c in range(b):
                total -= system[a, c] * system[b, c]
            if b < a:
                system[a, b] = total / system[b, b] if system[b, b] > 0.0 else 0.0
            else:
                system[a, a] = math.sqrt(total) if total > SINGULAR_BELOW else 0.0
                dependent += a < targets and system[a, a] == 0.0
    return dependent


def _is_idle(sides: Array, moved: Array, count: int, c: int) -> bool:
    """Whether a parameter asks for nothing and moves nothing: of many obstacles few are touched."""
    used = False
    for a in range(count):
        used |= sides[a, c] != 0.0
    for i in range(0 if used else moved.shape[0]):
        used |= moved[i, c] != 0.0
    return not used


def add_least_motions(limits: Array, work: Workspace, count: int, targets: int, sides: Array, moved: Array) -> float:
    """Add to the motions `moved` (3 n, p) the least ones with which the rows have their right sides (r, p).

    The first `targets` of the `count` rows are those of targets. Returns the most that another row is asked for.
    """
    rows, system, forces, most = work.rows, work.system, work.forces, 0.0
    for c in range(moved.shape[1]):
        if _is_idle(sides, moved, count, c):
            continue
        for a in range(count):
            total = sides[a, c]
            for i in range(rows.shape[1]):
                total -= rows[a, i] * moved[i, c]
            for b in range(a):
                total -= system[a, b] * forces[b, c]
            if a >= targets:
                most = max(most, abs(total))
            forces[a, c] = total / system[a, a] if system[a, a] > 0.0 else 0.0
        for a in range(count - 1, -1, -1):
            total = forces[a, c]
            for b in range(a + 1, count):
                total -= system[b, a] * forces[b, c]
            forces[a, c] = total / system[a, a] if system[a, a] > 0.0 else 0.0
        for i in range(rows.shape[1]):
            total = 0.0
            for a in range(count):
                total += rows[a, i] * forces[a, c]
            moved[i, c] += weight(limits, i) * total
    return most


def _find_rows(problem: Problem, work: Workspace, keep: float) -> tuple[int, int, float, int]:
    """Fill the rows at `work.q`; returns all, those of targets, their largest residual, and bits of a status.

    With a finite `keep` they are those of contacts alone, see `derive`.
    """
    forward_with_columns(problem.limits, work.q, work.frames, work.columns)
    if keep < math.inf:
        count, told = add_contacts(problem, work, 0, keep)
        normalise(problem.limits, work, count)
        return count, 0, 0.0, told
    targets, residual = add_targets(problem, work)
    targets, full = add_equalities(problem, work, targets)
    count, told = add_limits(problem, work, targets)
    told |= full
    count, more = add_contacts(problem, work, count, problem.margin)
    told |= more
    count, more = add_self_contacts(problem, work, count, problem.margin)
    normalise(problem.limits, work, count)
    return count, targets, residual, told | more


def _correct(problem: Problem, work: Workspace, count: int, targets: int) -> None:
    """Go on to where the targets are met: one Newton step that keeps all other rows."""
    for a in range(count):
        work.values[a, 0] = work.about[a, d.ROW_FACTOR] * work.about[a, d.ROW_SLACK] if a < targets else 0.0
    for i in range(work.way.shape[0]):
        work.way[i, 0] = 0.0
    add_least_motions(problem.limits, work, count, targets, work.values, work.way)
    for i in range(work.way.shape[0]):
        work.q[i // 3, i % 3] += work.way[i, 0]


def _largest(sides: Array) -> float:
    most = 0.0
    for a in range(sides.shape[0]):
        for c in range(sides.shape[1]):
            most = max(most, abs(sides[a, c]))
    return most


def _follow(problem: Problem, asked: Array, lines: Array, work: Workspace, count: int, targets: int) -> int:
    """Move `work.moved` on as the first `count` rows ask, `targets` of them those of targets; returns a status.

    KINK where a limit or a contact that is active, but does not push, is called upon.
    """
    status = 0
    fill_sides(problem, asked, lines, work, count)
    if factorise(problem.limits, work, count, targets) > 0:
        status |= d.SINGULAR
    called = add_least_motions(problem.limits, work, count, targets, work.sides, work.moved)
    if called > STILL * (1.0 + _largest(work.sides[:count])):
        status |= d.KINK
    return status


@shared
def _derive(
    robot: Array,
    scene: Array,
    settings: Array,
    targets: Array,
    asked: Array,
    lines: Array,
    q: Array,
    keep: float,
    workspace: Array,
    answer: Array,
) -> None:
    """Fill the answer for `q`; arguments as for `derive`, and see there.

    Where targets are not quite met, Newton's way from there to where they are is derived as well: its first step D b
    leaves what its second one adds, D' (b' - A' D b).
    """
    problem = read_problem(robot, scene, settings, targets)
    sizes = q.shape[0], asked[d.ROWS], asked[d.COLUMNS]
    work = carve_workspace(workspace, answer, problem.base, number_of(problem.scene), targets.shape[0], sizes)
    copy(q, work.q)
    count, met, residual, status = _find_rows(problem, work, keep)
    if keep < math.inf:
        fill_sides(problem, asked, lines, work, count)
    else:
        move_directly(problem, asked, work.moved)
        status |= _follow(problem, asked, lines, work, count, met)
        if residual > CONVERGED and status == 0:
            _correct(problem, work, count, met)
            count, met, _, status = _find_rows(problem, work, keep)
            status |= _follow(problem, asked, lines, work, count, met)
    answer[d.STATUS], answer[d.ROW_COUNT], answer[d.TARGET_ROWS] = status, count, met
    answer[d.WORST_RESIDUAL] = residual


@entry
def derive(
    robot: Array,
    scene: Array,
    settings: Array,
    targets: Array,
    asked: Array,
    lines: Array,
    q: Array,
    keep: float,
    workspace: Array,
    answer: Array,
) -> None:
    """Derive the answer `q` (n, 3) to targets (t, 15); fills `answer`, see `layout.answer_size`.

    With a finite `keep` nothing is derived: the rows of the answer are those of the places whose gaps to obstacles are
    at most about `keep`, and what is left of a gap is counted from there.

    `asked` (14,) int64: the first column of each group of parameters, or -1, and sizes, see `layout`.
    `lines` (p, 3): see `sides`. `workspace`: see `layout.workspace_size`.
    """
    _derive(robot, scene, settings, targets, asked, lines, q, keep, workspace, answer)


@entry
def derive_many(
    robot: Array,
    scene: Array,
    settings: Array,
    targets: Array,
    asked: Array,
    lines: Array,
    q: Array,
    workspace: Array,
    moved: Array,
    status: Array,
) -> None:
    """Derive m answers `q` (m, n, 3) to targets (m, t, 15) as `derive` does one.

    Fills what a unit of each parameter moves, `moved` (m, 3 n, p), and how each ended, `status` (m,). The workspace
    also holds an answer, at its end.
    """
    answer = workspace[workspace.shape[0] - asked[d.ANSWER] :]
    found, _ = cut(answer[d.ANSWER_HEADER :], moved.shape[1], moved.shape[2])
    for i in range(q.shape[0]):
        _derive(robot, scene, settings, targets[i], asked, lines, q[i], math.inf, workspace, answer)
        copy(found, moved[i])
        status[i] = answer[d.STATUS]
