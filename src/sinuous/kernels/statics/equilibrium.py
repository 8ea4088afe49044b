"""Equilibria of a body of arcs: what Python calls."""

from sinuous.kernels.compile import entry, shared
from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.statics import layout as t
from sinuous.kernels.statics import newton
from sinuous.kernels.statics.newton import Body, Workspace, descend, evaluate_state, fill_replies, find_taut, lay_out
from sinuous.kernels.statics.pulls import solve_taut
from sinuous.kernels.statics.sweeps import stiffness_of

LOAD_FACTOR, NEWTON_STEPS, UNSTABLE, LARGEST_RESIDUAL, TOTAL_MOMENT, TOTAL_FORCE = 0, 1, 2, 3, 4, 7
"""Columns of a record: load factor for which an equilibrium was found; Newton steps; how many directions lower
its energy; largest residual; and moment (3, about the base) and force (3) of all loads."""

EQUILIBRIUM_WIDTH = 10

SMALLEST_LOAD_STEP = 1.0 / 256.0
"""Least growth of the load factor in the continuation."""

MOST_STEPS = 12
"""Newton steps from what is predicted to an equilibrium."""

NUDGE = 0.2
"""Bend of the whole body by which an unstable equilibrium is left, rad."""


@entry
def equilibrate(
    base: Array,
    arcs: Array,
    loads: Array,
    lines: Array,
    slopes: int,
    x: Array,
    tensions: Array,
    descends: bool,
    buffer: Array,
    record: Array,
) -> None:
    """Go from state `x` (N, 4) and `tensions` (t,) to an equilibrium, in place; fill `record` (10,).

    Where it `descends`, to a stable one if there is one near; else to any, under all of the load or not at all.

    There are `slopes` rows for lengths of lines in arcs. `buffer` has `newton.workspace_size` numbers.
    """
    body, space = lay_out(base, arcs, loads, lines, slopes, buffer)
    equilibrate_body(x, tensions, body, descends, space, record)


@shared
def equilibrate_body(x: Array, tensions: Array, body: Body, descends: bool, space: Workspace, record: Array) -> None:
    """Find an equilibrium, see `equilibrate`, in a space whose first frame is the base; fill `record` (10,)."""
    find_taut(body.lines, tensions, space)
    record[NEWTON_STEPS] = 0.0
    if descends:
        _increase_load(x, tensions, body, space, record)
    else:
        found, steps = descend(x, tensions, body, 1.0, False, space, newton.MOST_ITERATIONS)
        record[LOAD_FACTOR], record[NEWTON_STEPS] = 1.0 if found else 0.0, steps
    if record[LOAD_FACTOR] < 1.0:
        return
    _record_state(x, tensions, body, space, record)
    for trial in range(2):
        if record[UNSTABLE] == 0.0 or not descends:
            return
        _leave_unstable(x, tensions, body, space, trial, record)


def is_stable(record: Array) -> bool:
    """Whether the `record` (10,) says that an equilibrium was found, and is stable."""
    return bool(record[LOAD_FACTOR] >= 1.0 and record[UNSTABLE] == 0.0)


@shared
def equilibrate_near(x: Array, tensions: Array, body: Body, space: Workspace, record: Array) -> None:
    """Go from a state near an equilibrium to it, in few steps or not at all; fill `record` (10,)."""
    find_taut(body.lines, tensions, space)
    found, steps = descend(x, tensions, body, 1.0, True, space, MOST_STEPS)
    record[LOAD_FACTOR], record[NEWTON_STEPS] = 1.0 if found else 0.0, steps
    if found:
        _record_state(x, tensions, body, space, record)


def _keep_state(x: Array, tensions: Array, space: Workspace) -> None:
    newton.copy_state(x, tensions, space.kept, space.small[newton.TENSION_KEPT])


def _restore_state(x: Array, tensions: Array, lines: Array, space: Workspace) -> None:
    newton.copy_state(space.kept, space.small[newton.TENSION_KEPT], x, tensions)
    find_taut(lines, tensions, space)


def _increase_load(x: Array, tensions: Array, body: Body, space: Workspace, record: Array) -> None:
    """Try all of the load; where that does not end, a smaller share first, and more from there; fill `record` (10,)."""
    reached, step = 0.0, 1.0
    _keep_state(x, tensions, space)
    while reached < 1.0 and step >= SMALLEST_LOAD_STEP:
        load_factor = min(1.0, reached + step)
        found, steps = descend(x, tensions, body, load_factor, True, space, newton.MOST_ITERATIONS)
        record[NEWTON_STEPS] += steps
        if found:
            reached, step = load_factor, 2.0 * step
            _keep_state(x, tensions, space)
        else:
            _restore_state(x, tensions, body.lines, space)
            step *= 0.25
    record[LOAD_FACTOR] = reached


def _record_state(x: Array, tensions: Array, body: Body, space: Workspace, record: Array) -> None:
    """Fill what `record` (10,) says of an equilibrium that was just evaluated."""
    negative, moment, force = evaluate_state(x, tensions, body, 1.0, space)
    left, lines = 0.0, body.lines
    for k in range(x.shape[0]):
        for j in range(4):
            if stiffness_of(body.arcs, k, j) < t.RIGID:
                left = max(left, abs(space.stages[k, t.RESIDUAL + j]))
    if negative > 0 and lines.shape[0] > 0:  # tendons that are held may hold what would fall
        fill_replies(lines, x.shape[0], space)
        scratch = space.scratch[: lines.shape[0]]
        negative -= solve_taut(
            space.matrix, space.small[newton.LENGTHS], space.small[newton.TAUT], space.small[newton.WANTED], scratch
        )
    record[UNSTABLE], record[LARGEST_RESIDUAL] = negative, left
    for i in range(3):
        record[TOTAL_MOMENT + i], record[TOTAL_FORCE + i] = moment[i], force[i]


def _leave_unstable(x: Array, tensions: Array, body: Body, space: Workspace, trial: int, record: Array) -> None:
    """Leave an unstable equilibrium for a stable one, where there is one near; else stay. Fill `record` (10,)."""
    _keep_state(x, tensions, space)
    count = x.shape[0]
    for k in range(count):
        if body.arcs[k, t.BEND_STIFFNESS] < t.RIGID:
            x[k, trial] += NUDGE * (1.0 + 0.3 * k / count) / count
            x[k, 1 - trial] += 0.1 * NUDGE / count
    found, steps = descend(x, tensions, body, 1.0, True, space, 2 * newton.MOST_ITERATIONS)
    record[NEWTON_STEPS] += steps
    if not found:
        _restore_state(x, tensions, body.lines, space)
        return
    _record_state(x, tensions, body, space, record)
