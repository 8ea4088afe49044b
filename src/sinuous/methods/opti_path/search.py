"""The method of Sun & Wang, whole: a path of arcs from base to goal, improved until it is a shape of the robot.

The unknowns are the points where arcs meet. The last is the goal, so that the position is exact by construction; what
has to be reached is that all lengths lie in their ranges, that the tip points where it should, and that the body is
clear. The first path that the common check (see `common`) calls solved ends the search.
"""

import math

from numba.np.unsafe.ndarray import to_fixed_tuple

from sinuous.kernels.chain.kinematics import forward, frame
from sinuous.kernels.clock import now
from sinuous.kernels.compile import entry, kernel
from sinuous.kernels.maths.vectors import Array, copy, get_vec, norm, put_vec
from sinuous.kernels.problem import Problem, answer_of, read_problem
from sinuous.kernels.solve.judge import (
    Check,
    begin,
    begin_from,
    carve_check,
    check_size,
    end,
    has_obstacles,
    offer,
)
from sinuous.kernels.step.targets import direction_vector
from sinuous.kernels.tables import (
    ARC,
    DIRECTION,
    GIVEN,
    GOAL,
    MAX_LENGTH,
    METHOD_OPTIONS,
    MIN_LENGTH,
    ORIENTATION,
    RANDOM,
    TARGET_POSITION,
)
from sinuous.methods.opti_path.bezier import configuration_of
from sinuous.methods.opti_path.costs import (
    ADJOINT,
    Aim,
    Path,
    Setting,
    Weights,
    gradient_backwards,
    gradient_by_differences,
    trace,
    want,
)
from sinuous.methods.opti_path.potential import Potential, read_potential
from sinuous.methods.opti_path.starts import WAYS, bow, carried, reach, single, swung
from sinuous.methods.opti_path.steps import move, project, scheduled

NUDGES = WAYS
"""Bows of a given shape that are tried when it does not lead to the target itself."""

OPTIONS = len(Setting._fields)

MANY = 20
"""Segments from which on the clock is read after every iteration, not after every eighth."""

STILL = 1e-9
"""A move, in lengths of a segment, after which nothing is expected any more."""


def workspace_size(segments: int, obstacles: int) -> int:
    """Numbers (float64) that a solve needs as workspace."""
    return 15 * (segments + 1) + 22 * segments + check_size(segments, obstacles)


@kernel
def carve_path(buffer: Array, n: int) -> tuple[Path, Array, Array]:
    """Lay out a path and a configuration; returns the rest of the buffer too."""
    m = 3 * (n + 1)
    rest = buffer[5 * m :]
    path = Path(
        buffer[:m].reshape((n + 1, 3)),
        buffer[m : 2 * m].reshape((n + 1, 3)),
        buffer[2 * m : 3 * m].reshape((n + 1, 3)),
        rest[: 15 * n].reshape((n, 15)),
        buffer[3 * m : 4 * m].reshape((n + 1, 3)),
        buffer[4 * m : 5 * m].reshape((n + 1, 3)),
        rest[15 * n : 19 * n].reshape((n, 4)),
    )
    return path, rest[19 * n : 22 * n].reshape((n, 3)), rest[22 * n :]


@kernel
def read_setting(options: Array) -> Setting:
    """Name the numbers of the options."""
    return Setting(*to_fixed_tuple(options, OPTIONS))  # type: ignore[call-arg]


@kernel
def read_aim(problem: Problem) -> Aim:
    """The target of the tip, and the mean length of a segment."""
    return Aim(
        get_vec(problem.targets, 0, TARGET_POSITION),
        get_vec(problem.targets, 0, GOAL),
        problem.targets[0, ORIENTATION] == DIRECTION,
        problem.unit / problem.limits.shape[0],
    )


@kernel
def begin_path(
    problem: Problem,
    check: Check,
    setting: Setting,
    aim: Aim,
    path: Path,
    initial: Array,
    index: int,
    first: int,
    seed: int,
    q: Array,
) -> int:
    """Put start `index` of a search into the path; its source, or -1 when there is no such start.

    Given shapes, the single arc and, with the repairs, a swung curve (before the arc, when the arc is longer than the
    robot). With restarts also: the first given shape bowed to all sides, before the arc; the arc bowed; and the shapes
    that other methods start from too.
    """
    own = index - initial.shape[0]
    if own >= 0:
        own += first
    again = setting.restarts != 0.0
    nudges = NUDGES if again and initial.shape[0] > 0 else 0
    rotation, base = frame(check.frames, 0)
    put_vec(path.points, 0, 0, base)
    put_vec(path.tangents, 0, 0, (rotation[0][2], rotation[1][2], rotation[2][2]))
    if own < nudges:
        copy(initial[index if own < 0 else 0], q)
        forward(q, check.frames)
        carried(check.frames, setting, aim, path)
        if own >= 0:
            bow(aim, path, own)
        return GIVEN
    own -= nudges
    if own > 0 and not again and (own > 1 or setting.other_guess == 0.0):
        return -1
    if own < 2 + 2 * WAYS:
        length = single(problem.limits, setting, aim, path)
        if own > 1:
            bow(aim, path, own - 2)
        elif setting.other_guess != 0.0 and (length > reach(problem.limits)[1]) == (own == 0):
            swung(problem.limits, aim, path, 0.0)
        return ARC
    begin_from(problem, check, initial, initial.shape[0], own - 1 - 2 * WAYS, seed, q)
    forward(q, check.frames)
    carried(check.frames, setting, aim, path)
    return RANDOM


@kernel
def look(problem: Problem, aim: Aim, path: Path) -> tuple[float, float]:
    """By how much the lengths of a traced path, and its last tangent, are off: length unit, rad."""
    long = 0.0
    for k in range(path.arcs.shape[0]):
        length = path.arcs[k, 14]
        long = max(long, problem.limits[k, MIN_LENGTH] - length, length - problem.limits[k, MAX_LENGTH])
    turn = norm(direction_vector(get_vec(path.tangents, path.arcs.shape[0], 0), aim.direction)) if aim.directed else 0.0
    return long, turn


@kernel
def descend(
    problem: Problem, potential: Potential, setting: Setting, weights: Weights, aim: Aim, path: Path, obstacles: bool
) -> float:
    """Move the points of a traced path one step down; how far the most moved."""
    if setting.gradient == ADJOINT:
        gradient_backwards(problem.scene, potential, setting, weights, aim, path, obstacles)
    else:
        gradient_by_differences(problem.scene, potential, setting, weights, aim, path, obstacles)
    if obstacles and setting.project != 0.0:
        project(path)
    return move(setting, path, aim.unit)


@kernel
def settle(
    problem: Problem,
    check: Check,
    potential: Potential,
    setting: Setting,
    aim: Aim,
    path: Path,
    kind: int,
    q: Array,
    best: Array,
    record: Array,
) -> int:
    """Go on from a solved path, farther from obstacles and limits; what is not solved any more is not taken.

    Returns the number of iterations.
    """
    weights = scheduled(setting, 0, True, True)
    count = int(setting.settle)
    for _ in range(count):
        descend(problem, potential, setting, weights, aim, path, True)
        trace(path)
    configuration_of(path.points, check.frames, q)
    offer(problem, check, q, kind, best, record)
    return count


@kernel
def improve(
    problem: Problem,
    check: Check,
    potential: Potential,
    setting: Setting,
    aim: Aim,
    path: Path,
    kind: int,
    deadline: float,
    q: Array,
    best: Array,
    record: Array,
) -> tuple[int, bool]:
    """Improve a path until it is solved, does not move any more, or its iterations or the time are over.

    Returns the number of iterations and whether it is solved. Of paths that are not, the one whose lengths and
    orientation were the least off is offered.
    """
    obstacles = has_obstacles(problem)
    least = math.inf
    iteration = 0
    while True:
        trace(path)
        long, turn = look(problem, aim, path)
        off = max(long / aim.unit, turn)
        if not math.isfinite(off):
            break
        if long <= 0.0 and turn <= problem.angle_tolerance:
            configuration_of(path.points, check.frames, q)
            if offer(problem, check, q, kind, best, record):
                if obstacles and setting.settle > 0.0:
                    iteration += settle(problem, check, potential, setting, aim, path, kind, q, best, record)
                return iteration, True
            least = -1.0
        elif off < least:
            least = off
            copy(path.points, path.kept)
        if iteration >= setting.iterations:
            break
        if (iteration % 8 == 7 or q.shape[0] >= MANY) and now(check.clock) > deadline:
            break
        weights = scheduled(setting, iteration, long > 0.0, turn > problem.angle_tolerance)
        iteration += 1
        far = descend(problem, potential, setting, weights, aim, path, obstacles)
        if not far > STILL * aim.unit or not math.isfinite(far):
            break
    if 0.0 <= least < math.inf:
        configuration_of(path.kept, check.frames, q)
        offer(problem, check, q, kind, best, record)
    return iteration, False


@entry
def search(
    robot: Array,
    scene: Array,
    settings: Array,
    sampled: Array,
    targets: Array,
    initial: Array,
    budget: tuple[int, int, int, float],
    workspace: Array,
    answers: Array,
) -> None:
    """Solve m problems; see `sinuous.methods.compiled`.

    The options in `settings` are those of `costs.Setting`; `sampled` is the group that `potential.read_potential` takes
    apart.
    """
    n, options = int(robot[0]), settings[METHOD_OPTIONS:]
    first, most, seed, seconds = budget
    setting = read_setting(options)
    for i in range(targets.shape[0]):
        problem = read_problem(robot, scene, settings, targets[i])
        best, record = answer_of(answers, i, n)
        path, q, rest = carve_path(workspace, n)
        check = carve_check(rest, problem)
        aim = read_aim(problem)
        potential = read_potential(sampled, setting.slope, setting.influence * aim.unit)
        want(problem.limits, setting.dead_band, problem.mount, path)
        deadline, last = begin(problem, check, initial[i], first, most, seconds, best, record)
        total, starts, late = 0, 0, False
        for index in range(last):
            kind = begin_path(problem, check, setting, aim, path, initial[i], index, first, seed, q)
            if kind < 0:
                break
            starts += 1
            used, solved = improve(problem, check, potential, setting, aim, path, kind, deadline, q, best, record)
            total += used
            if solved:
                break
            if now(check.clock) > deadline:
                late = True
                break
        end(problem, check, total, starts, late, best, record)
