"""Newton's method for the equilibrium of a body of arcs: damped, with pivots that are kept positive.

A step goes as far as the work along it does not turn round. That needs no energy, so it holds for moments that stay as
they are in the world, too.
"""

from collections import namedtuple

from sinuous.kernels.chain.kinematics import put_base
from sinuous.kernels.compile import shared
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import ZERO, Array, Vec, copy, norm
from sinuous.kernels.statics import layout as t
from sinuous.kernels.statics.assembly import assemble
from sinuous.kernels.statics.pulls import find_tensions, solve_taut
from sinuous.kernels.statics.sweeps import factorise, move, solve

MOST_ITERATIONS = 60
"""Newton steps from one start."""

LARGEST_TURN = 1.5
"""Most that a step turns any place of the body, rad."""

LARGEST_STRETCH = 0.3
"""Most that an arc changes its length in a step, relative to its length without load."""

FIRST_STIFFER = 0.1
"""By what share of their stiffness all arcs are made stiffer at first, where a step leads up or too far."""

STIFFER = 3.0
"""By how many times as much they are made stiffer then, until it does not."""

MOST_STIFFER = 1e6
"""The largest share."""

CONVERGED = 1e-9
"""Change, rad and relative lengths, that ends it: what is left then is rounding, as steps end quadratically."""

SURE = 1e-5
"""Change below which a step is not damped."""

RETURNED_WORK = 0.5
"""Share of the work along a step that may come back at its end."""

MOST_HALVINGS = 12

HUGE = 1e300
"""What no step of finite numbers reaches."""

LARGEST_BEND = 6.3
"""Bend of one arc beyond which a body of arcs stands for nothing, rad."""

SHORTEST, LONGEST = 0.2, 3.0
"""The same of its length, relative to that without load."""

Body = namedtuple("Body", ["arcs", "loads", "lines"])
"""Tables of a body, its loads and its lines, see `layout`."""

Workspace = namedtuple("Workspace", "frames stages slopes changes step trial none kept matrix scratch small")
"""Frames (N + 1, 12), `stages` (N, 128), lengths of lines in arcs (s, 5), what each line changes (t N, 4), the step,
the state that is tried, no change and the state that is kept (N, 4), the system of tensions (t, t), scratch, and seven
rows of t numbers: lengths, right-hand side, tensions that are tried, who is taut, change of length, tensions before,
and those that are kept."""

LENGTHS, WANTED, TENSIONS, TAUT, TENSION_CHANGE, TENSION_BEFORE, TENSION_KEPT = range(7)


def carve(buffer: Array, base: Array, arcs: int, lines: int, slopes: int) -> tuple[Workspace, Array]:
    """Lay out the space in a buffer, its first frame the base (1, 12); returns what is left of the buffer, too."""
    frames, rest = cut(buffer, arcs + 1, 12)
    put_base(frames, base)
    stages, rest = cut(rest, arcs, t.STAGE_WIDTH)
    along, rest = cut(rest, slopes, 5)
    changes, rest = cut(rest, lines * arcs, t.STATE_WIDTH)
    step, rest = cut(rest, arcs, t.STATE_WIDTH)
    trial, rest = cut(rest, arcs, t.STATE_WIDTH)
    none, rest = cut(rest, arcs, t.STATE_WIDTH)
    none[:] = 0.0
    kept, rest = cut(rest, arcs, t.STATE_WIDTH)
    matrix, rest = cut(rest, lines, lines)
    scratch, rest = cut(rest, lines + 1 + 11, max(lines + 1, 12))
    small, rest = cut(rest, 7, lines)
    return Workspace(frames, stages, along, changes, step, trial, none, kept, matrix, scratch, small), rest


def workspace_size(arcs: int, lines: int, slopes: int) -> int:
    """Numbers that `carve` takes."""
    fixed = 12 * (arcs + 1) + (t.STAGE_WIDTH + 16) * arcs + 5 * slopes + 4 * lines * arcs + lines * lines
    return fixed + (lines + 12) * max(lines + 1, 12) + 7 * lines


def lay_out(base: Array, arcs: Array, loads: Array, lines: Array, slopes: int, buffer: Array) -> tuple[Body, Workspace]:
    """A body, and a space laid out in a buffer of `workspace_size` numbers whose first frame is the base (1, 12)."""
    space, _ = carve(buffer, base, arcs.shape[0], lines.shape[0], slopes)
    return Body(arcs, loads, lines), space


def copy_state(x: Array, tensions: Array, to_x: Array, to_tensions: Array) -> None:
    """Copy states and tensions `to_x` (N, 4) and `to_tensions` (t,)."""
    copy(x, to_x)
    for i in range(tensions.shape[0]):
        to_tensions[i] = tensions[i]


def find_taut(lines: Array, tensions: Array, space: Workspace) -> None:
    """Fill which lines are taut, and the tensions (t,) that are held."""
    for i in range(lines.shape[0]):
        taut = lines[i, t.HELD] > 0.0 and (lines[i, t.PUSHES] > 0.0 or tensions[i] > 0.0)
        space.small[TAUT, i] = 1.0 if taut else 0.0
        if lines[i, t.HELD] == 0.0:
            tensions[i] = lines[i, t.LINE_VALUE]


@shared
def evaluate_state(x: Array, tensions: Array, body: Body, load_factor: float, space: Workspace) -> tuple[int, Vec, Vec]:
    """Fill frames, stages, slopes and lengths of lines in this state; see `factorise` for what is returned."""
    assemble(x, body.arcs, body.lines, tensions, load_factor, space.frames, space.stages, space.slopes)
    _sum_lengths(body.lines, space)
    return _factorise(x, body, load_factor, 0.0, space)


def _factorise(x: Array, body: Body, load_factor: float, more: float, space: Workspace) -> tuple[int, Vec, Vec]:
    scratch = space.scratch[space.scratch.shape[0] - 11 :]
    return factorise(x, space.frames, body.arcs, body.loads, load_factor, more, space.stages, scratch)


def _sum_lengths(lines: Array, space: Workspace) -> None:
    """Sum up the lengths of the lines."""
    for i in range(lines.shape[0]):
        first, total = int(lines[i, t.FIRST_SLOPE]), 0.0
        for k in range(int(lines[i, t.LAST_ARC] - lines[i, t.FIRST_ARC]) + 1):
            total += space.slopes[first + k, 0]
        space.small[LENGTHS, i] = total


def elongation(lines: Array, i: int, change: Array, space: Workspace) -> float:
    """How the length of line i changes with a `change` (N, 4) of states."""
    first, begin, total = int(lines[i, t.FIRST_SLOPE]), int(lines[i, t.FIRST_ARC]), 0.0
    for k in range(begin, int(lines[i, t.LAST_ARC]) + 1):
        for j in range(4):
            total += space.slopes[first + k - begin, 1 + j] * change[k, j]
    return total


def fill_replies(lines: Array, count: int, space: Workspace) -> None:
    """Fill what a tension of each held line changes, and the matrix of all."""
    for i in range(lines.shape[0]):
        if lines[i, t.HELD] > 0.0:
            own = space.changes[i * count : (i + 1) * count]
            own[:] = 0.0
            first, begin = int(lines[i, t.FIRST_SLOPE]), int(lines[i, t.FIRST_ARC])
            for k in range(begin, int(lines[i, t.LAST_ARC]) + 1):
                for j in range(4):
                    own[k, j] = space.slopes[first + k - begin, 1 + j]
            solve(own, space.none, space.stages, own)
            for j in range(lines.shape[0]):
                space.matrix[j, i] = elongation(lines, j, own, space) if lines[j, t.HELD] > 0.0 else 0.0
            space.matrix[i, i] += lines[i, t.COMPLIANCE]


def hold_taut(lines: Array, space: Workspace, column: Array, pulls: Array) -> None:
    """Let taut lines answer the change `column` (N, 4) of states; `pulls` (t,) of their lengths become tensions."""
    for i in range(lines.shape[0]):
        space.small[WANTED, i] = elongation(lines, i, column, space) + pulls[i] if space.small[TAUT, i] > 0.0 else 0.0
        pulls[i] = 0.0
    solve_taut(space.matrix, space.small[WANTED], space.small[TAUT], pulls, space.scratch[: lines.shape[0]])
    for i in range(lines.shape[0]):
        _subtract_reply(i, pulls[i], space, column)


def _subtract_reply(i: int, tension: float, space: Workspace, column: Array) -> None:
    """Take off `column` (N, 4), a change of states, what so much more tension of line i changes."""
    count = column.shape[0]
    if tension != 0.0:
        for k in range(count):
            for j in range(4):
                column[k, j] -= tension * space.changes[i * count + k, j]


def find_step(tensions: Array, body: Body, space: Workspace) -> int:
    """Fill the step, and the tensions after it, from what was seen at a state.

    Returns how many falling directions the taut lines hold.
    """
    count, lines, small = space.step.shape[0], body.lines, space.small
    for k in range(count):
        for j in range(4):
            space.step[k, j] = -space.stages[k, t.RESIDUAL + j]
    solve(space.step, space.none, space.stages, space.step)
    for i in range(lines.shape[0]):
        small[TENSIONS, i] = tensions[i]
    fill_replies(lines, count, space)
    held = 0
    for i in range(lines.shape[0]):
        if lines[i, t.HELD] > 0.0:
            held += 1
            wanted = small[LENGTHS, i] - lines[i, t.LINE_VALUE] + elongation(lines, i, space.step, space)
            for j in range(lines.shape[0]):
                if lines[j, t.HELD] > 0.0:
                    own = space.matrix[i, j] - (lines[i, t.COMPLIANCE] if i == j else 0.0)
                    wanted += own * tensions[j]
            small[WANTED, i] = wanted
    if held == 0:
        return 0
    scratch = space.scratch[: lines.shape[0]]
    holding = find_tensions(lines, space.matrix, small[WANTED], small[TAUT], small[TENSIONS], scratch)
    for i in range(lines.shape[0]):
        if lines[i, t.HELD] > 0.0:
            _subtract_reply(i, small[TENSIONS, i] - tensions[i], space, space.step)
    return holding


def _size_of_step(arcs: Array, space: Workspace) -> tuple[float, float]:
    """Largest change of a step (rad, relative lengths), and the share of it that is not too large."""
    step = space.step
    turn = stretch = far = 0.0
    omega, v = ZERO, ZERO
    for k in range(step.shape[0]):
        for j in range(3):
            turn = max(turn, abs(step[k, j]))
        if step[k, t.LENGTH] != 0.0:
            stretch = max(stretch, abs(step[k, t.LENGTH]) / arcs[k, t.REST_LENGTH])
        omega, v = move(k, step, omega, v, space.stages)
        far = max(far, norm(omega))
    most = max(far / LARGEST_TURN, stretch / LARGEST_STRETCH)
    return max(turn, stretch), 1.0 / most if most > 1.0 else 1.0


def _work_along_step(tensions: Array, body: Body, space: Workspace) -> float:
    """Derivative along the step of what it lowers, in the state that was examined with these tensions."""
    total = 0.0
    for k in range(space.step.shape[0]):
        for j in range(4):
            total += space.step[k, j] * space.stages[k, t.RESIDUAL + j]
    for i in range(body.lines.shape[0]):
        if body.lines[i, t.HELD] > 0.0 and space.small[TAUT, i] > 0.0:
            moved = elongation(body.lines, i, space.step, space)
            off = space.small[LENGTHS, i] - body.lines[i, t.LINE_VALUE] - body.lines[i, t.COMPLIANCE] * tensions[i]
            total += moved * ((space.small[TENSIONS, i] - tensions[i]) + off / max(abs(space.matrix[i, i]), 1e-300))
    return total


def _are_sound(x: Array, arcs: Array) -> bool:
    """Whether arcs are still arcs."""
    for k in range(x.shape[0]):
        square = x[k, t.BEND_X] ** 2 + x[k, t.BEND_Y] ** 2
        long, rest = x[k, t.LENGTH], arcs[k, t.REST_LENGTH]
        if not square < LARGEST_BEND * LARGEST_BEND or not abs(x[k, t.TORSION]) < LARGEST_BEND:
            return False
        if not SHORTEST * rest <= long <= LONGEST * rest:
            return False
    return True


@shared
def descend(
    x: Array, tensions: Array, body: Body, load_factor: float, descends: bool, space: Workspace, most: int
) -> tuple[bool, int]:
    """Go from `x` (N, 4) and `tensions` (t,) to an equilibrium under a load factor, in place.

    Unless it `descends`, it is Newton's method as it is, which ends in unstable equilibria as well. Returns whether it
    was reached, and how many steps that took.
    """
    negative, _, _ = evaluate_state(x, tensions, body, load_factor, space)
    more = 0.0
    for iteration in range(most):
        held, more = find_step(tensions, body, space), max(FIRST_STIFFER, more / (STIFFER * STIFFER))
        largest, alpha = _size_of_step(body.arcs, space)
        while descends and (held < negative or alpha < 1.0) and more < MOST_STIFFER:  # it would lead up, or too far
            negative, _, _ = _factorise(x, body, load_factor, more, space)
            held, more = find_step(tensions, body, space), STIFFER * more
            largest, alpha = _size_of_step(body.arcs, space)
        if not largest < HUGE:
            return False, iteration
        if largest < CONVERGED:
            for k in range(x.shape[0]):
                for j in range(4):
                    x[k, j] += space.step[k, j]
            for i in range(body.lines.shape[0]):
                tensions[i] = space.small[TENSIONS, i]
            return _are_sound(x, body.arcs), iteration + 1
        negative = _line_search(x, tensions, body, load_factor, alpha, largest < SURE or not descends, space)
        if not _are_sound(x, body.arcs):
            return False, iteration + 1
    return False, most


def _line_search(
    x: Array, tensions: Array, body: Body, load_factor: float, most: float, sure: bool, space: Workspace
) -> int:
    """Go along the step, no farther than `most` of it, and check there; returns how many pivots are negative there."""
    small, alpha, negative = space.small, most, 0
    work = _work_along_step(tensions, body, space)
    for i in range(body.lines.shape[0]):
        small[TENSION_BEFORE, i] = tensions[i]
        small[TENSION_CHANGE, i] = small[TENSIONS, i] - tensions[i]
    for _ in range(MOST_HALVINGS):
        for k in range(x.shape[0]):
            for j in range(4):
                space.trial[k, j] = x[k, j] + alpha * space.step[k, j]
        for i in range(body.lines.shape[0]):
            tensions[i] = small[TENSION_BEFORE, i] + alpha * small[TENSION_CHANGE, i]
        negative, _, _ = evaluate_state(space.trial, tensions, body, load_factor, space)
        after = _work_along_step(tensions, body, space)
        if sure or after <= RETURNED_WORK * abs(work):
            break
        alpha *= max(0.1, min(0.6, abs(work) / (abs(work) + after)))
    copy(space.trial, x)
    return negative
