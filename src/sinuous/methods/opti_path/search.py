"""The method of Sun & Wang, whole: a path of arcs from base to goal, improved until it is a shape of the robot.

The unknowns are the points where arcs meet. The last is the goal, so that the position is exact by construction; what
has to be reached is that all lengths lie in their ranges, that the tip points where it should, and that the body is
clear. The first path that the common check (see `sinuous.methods.search`) calls solved ends the search.

Where `opti_path` begins: an initial configuration carried to the goal, the single arc, and other guesses.
"""

import math

from sinuous.kernels.chain.kinematics import forward, frame
from sinuous.kernels.chain.single_arc import arc_to
from sinuous.kernels.clock import SEGMENT_WORK, late, spend
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.shapes import first_of
from sinuous.kernels.maths.vectors import (
    ZERO,
    Array,
    Vec,
    across,
    add,
    add_scaled,
    copy,
    cross,
    dot,
    get_vec,
    norm,
    put_vec,
    scale,
    sub,
)
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.limits import length_range
from sinuous.kernels.step.targets import direction_vector
from sinuous.kernels.tables import (
    ARC,
    DIRECTION,
    GIVEN,
    GOAL,
    MAX_LENGTH,
    MIN_LENGTH,
    ORIENTATION,
    RANDOM,
    TARGET_POSITION,
)
from sinuous.methods.opti_path.gradient import ADJOINT, Setting, Weights, gradient_backwards, gradient_by_differences
from sinuous.methods.opti_path.path import (
    Aim,
    Path,
    Work,
    along_arc,
    configuration_of,
    put_points,
    read_potential,
    trace,
    want,
)
from sinuous.methods.search import (
    NO_START,
    Answer,
    Check,
    Start,
    begin_own,
    has_obstacles,
    offer,
    own_number,
    search_by,
)

BOWS = 8
"""Bows of a path that are tried: so many directions across the first tangent, by two heights."""


def carried(frames: Array, setting: Setting, aim: Aim, path: Path) -> None:
    """The points of the shape whose `frames` (n + 1, 12) these are, with its end moved to the goal.

    The shift is blended over the points by `(i / n) ^ blend`; 0 moves the last point alone.
    """
    n = path.arcs.shape[0]
    put_points(frames, path.points)
    shift = sub(aim.position, get_vec(path.points, n, 0))
    for i in range(1, n):
        if setting.blend > 0.0:
            share = (i / n) ** setting.blend
            put_vec(path.points, i, 0, add_scaled(get_vec(path.points, i, 0), share, shift))
    put_vec(path.points, n, 0, aim.position)


def _sides(path: Path, aim: Aim) -> tuple[Vec, Vec, float, float]:
    """First tangent, unit vector across it towards the goal, and how far the goal is aside and ahead."""
    t = get_vec(path.tangents, 0, 0)
    d = sub(aim.position, get_vec(path.points, 0, 0))
    ahead = dot(d, t)
    out = add_scaled(d, -ahead, t)
    aside = norm(out)
    side = scale(1.0 / aside, out) if aside > 1e-12 * norm(d) else across(t)[0]
    return t, side, aside, ahead


def single(limits: Array, setting: Setting, aim: Aim, path: Path) -> float:
    """The arc from the base along its tangent to the goal, cut into pieces; returns its length.

    Pieces share it by the mean lengths in `limits` (n, 7). A goal straight ahead leaves the points on a line, which no
    gradient bends: `bow` moves them aside, by half a wave of that height.
    """
    n = path.arcs.shape[0]
    t, side, aside, ahead = _sides(path, aim)
    base = get_vec(path.points, 0, 0)
    half, length = arc_to(aside, ahead)
    low, high = length_range(limits)
    height = setting.bow * aim.unit if aside < setting.bow * aim.unit else 0.0
    s = 0.0
    for i in range(1, n):
        s += (limits[i - 1, MIN_LENGTH] + limits[i - 1, MAX_LENGTH]) / (low + high)
        p = add(base, along_arc(t, side, 2.0 * half, length, s))
        put_vec(path.points, i, 0, add_scaled(p, height * math.sin(math.pi * s), side))
    put_vec(path.points, n, 0, aim.position)
    return length


def _cubic(a: Vec, b: Vec, c: Vec, d: Vec, s: float) -> Vec:
    """Point of a cubic Bezier curve."""
    r = 1.0 - s
    p = add_scaled(scale(r * r * r, a), 3.0 * r * r * s, b)
    return add_scaled(add_scaled(p, 3.0 * r * s * s, c), s * s * s, d)


def _curve_length(a: Vec, b: Vec, c: Vec, d: Vec) -> float:
    """Length of a cubic Bezier curve, by 32 chords."""
    length, before = 0.0, a
    for j in range(1, 33):
        p = _cubic(a, b, c, d, j / 32.0)
        length += norm(sub(p, before))
        before = p
    return length


def swung(limits: Array, aim: Aim, path: Path, angle: float) -> None:
    """A cubic curve to the goal, as long as a robot with these `limits` (n, 7) at mid-range, swung out to the side.

    It leaves along the first tangent, ends along the tangent that is asked for, and swings out at `angle` about the
    first tangent from the goal's side; how far is found by halving.
    """
    t, side, _, _ = _sides(path, aim)
    base = get_vec(path.points, 0, 0)
    other = cross(t, side)
    out = add(scale(math.cos(angle), side), scale(math.sin(angle), other))
    low, high = length_range(limits)
    wanted = 0.5 * (low + high)
    near, far = 0.0, 2.0 * wanted
    b = c = base
    for _ in range(30):
        swing = 0.5 * (near + far)
        b = add_scaled(add_scaled(base, 0.4 * wanted, t), 0.5 * swing, out)
        if aim.directed:
            c = add_scaled(add_scaled(aim.position, -0.4 * wanted, aim.direction), 0.5 * swing, out)
        else:
            c = add_scaled(aim.position, swing, out)
        if _curve_length(base, b, c, aim.position) < wanted:
            near = swing
        else:
            far = swing
    _cut(limits, base, b, c, aim, path)


def _cut(limits: Array, a: Vec, b: Vec, c: Vec, aim: Aim, path: Path) -> None:
    """Put the points on a cubic curve, shared by the mean lengths of the segments in `limits` (n, 7)."""
    n = path.arcs.shape[0]
    low, high = length_range(limits)
    total = _curve_length(a, b, c, aim.position)
    i, done, before = 1, 0.0, a
    share = (limits[0, MIN_LENGTH] + limits[0, MAX_LENGTH]) / (low + high)
    steps = 16 * n
    for j in range(1, steps + 1):
        p = _cubic(a, b, c, aim.position, j / steps)
        piece = norm(sub(p, before))
        while i < n and done + piece >= share * total:
            part = (share * total - done) / piece if piece > 0.0 else 0.0
            put_vec(path.points, i, 0, add_scaled(before, part, sub(p, before)))
            share += (limits[i, MIN_LENGTH] + limits[i, MAX_LENGTH]) / (low + high)
            i += 1
        done += piece
        before = p
    for rest in range(i, n + 1):
        put_vec(path.points, rest, 0, aim.position)


def bow(aim: Aim, path: Path, which: int) -> None:
    """Bow a path to one of the sides of its first tangent, by a third of a segment or, the next round, two thirds."""
    n = path.arcs.shape[0]
    a, b = across(get_vec(path.tangents, 0, 0))
    angle = 2.0 * math.pi * (which % BOWS) / BOWS
    height = aim.unit / 3.0 if which < BOWS else 2.0 * aim.unit / 3.0
    for i in range(1, n):
        lift = height * math.sin(math.pi * i / n)
        p = add_scaled(get_vec(path.points, i, 0), lift * math.cos(angle), a)
        put_vec(path.points, i, 0, add_scaled(p, lift * math.sin(angle), b))


def begin_path(problem: Problem, check: Check, work: Work, aim: Aim, start: Start) -> int:
    """Put a start into the path; its source, or -1 when there is no such start.

    Initial configurations, the single arc and, with the repairs, a swung curve (before the arc, when the arc is longer
    than the robot). With restarts also: the first initial configuration bowed to all sides, before the arc; the arc
    bowed; and the shapes that other methods start from too.
    """
    path, q, setting, _ = work
    initial, own = start.initial, own_number(start)
    again = setting.restarts != 0.0
    nudges = BOWS if again and initial.shape[0] > 0 else 0
    rotation, base = frame(check.frames, 0)
    put_vec(path.points, 0, 0, base)
    put_vec(path.tangents, 0, 0, (rotation[0][2], rotation[1][2], rotation[2][2]))
    if own < nudges:
        copy(initial[start.index if own < 0 else 0], q)
        forward(problem.limits, q, check.frames)
        carried(check.frames, setting, aim, path)
        if own >= 0:
            bow(aim, path, own)
        return GIVEN
    own -= nudges
    if own > 0 and not again and (own > 1 or setting.other_guess == 0.0):
        return -1
    if own < 2 + 2 * BOWS:
        length = single(problem.limits, setting, aim, path)
        if own > 1:
            bow(aim, path, own - 2)
        elif setting.other_guess != 0.0 and (length > length_range(problem.limits)[1]) == (own == 0):
            swung(problem.limits, aim, path, 0.0)
        return ARC
    begin_own(problem, check, own - 1 - 2 * BOWS, start.seed, q)
    forward(problem.limits, q, check.frames)
    carried(check.frames, setting, aim, path)
    return RANDOM


CONSTANT, BY_LENGTH, BY_ORIENTATION, COOLING, GATED = 0.0, 1.0, 2.0, 3.0, 4.0
IDENTITY, DIFFERENCE, ACCELERATION = 0.0, 1.0, 2.0

LEAST = 0.1
"""What is left of a weight when its schedule has taken it down."""


def scheduled(setting: Setting, iteration: int, long: bool, turned: bool) -> Weights:
    """The weights of this iteration; `long` and `turned` say whether lengths and orientation are still off.

    With the temperature T = cooling ^ iteration: constant; length up from 0.1 to 1 and orientation down as T falls;
    the other way round; all down; or gated, where what is met already counts nothing.
    """
    length, orientation, all_of_them = 1.0, 1.0, 1.0
    warm = LEAST + (1.0 - LEAST) * setting.cooling**iteration
    cold = 1.0 + LEAST - warm
    if setting.schedule == BY_LENGTH:
        length, orientation = cold, warm
    elif setting.schedule == BY_ORIENTATION:
        length, orientation = warm, cold
    elif setting.schedule == COOLING:
        all_of_them = warm
    elif setting.schedule == GATED:
        length, orientation = 1.0 if long else 0.0, 1.0 if turned else 0.0
    return Weights(
        all_of_them * length * setting.length_weight,
        all_of_them * orientation * setting.orientation_weight,
        all_of_them * setting.obstacle_weight,
        all_of_them * setting.bend_weight,
    )


def project(path: Path) -> None:
    """Take out of the update of every point for obstacles what is along the line through its two neighbours."""
    for i in range(1, path.arcs.shape[0]):
        along = sub(get_vec(path.points, i + 1, 0), get_vec(path.points, i - 1, 0))
        square = dot(along, along)
        if square > 0.0:
            force = get_vec(path.avoid, i, 0)
            put_vec(path.avoid, i, 0, add_scaled(force, -dot(force, along) / square, along))


def solve_difference(x: Array) -> None:
    """Solve `K y = x` in place, for rows 1 to n - 1 of `x` (n + 1, 3), K = tridiag(-1, 2, -1): both ends are fixed.

    Elimination without tables: its pivots are (i + 1) / i.
    """
    last = x.shape[0] - 2
    before = ZERO
    for i in range(1, last + 1):
        before = scale(i / (i + 1.0), add(get_vec(x, i, 0), before))
        put_vec(x, i, 0, before)
    for i in range(last - 1, 0, -1):
        before = add_scaled(get_vec(x, i, 0), i / (i + 1.0), before)
        put_vec(x, i, 0, before)


def move(setting: Setting, path: Path, unit: float) -> float:
    """Move all inner points by `-A^-1 gradient / lambda`, none by more than the largest step; how far the most moved.

    A is the identity, K (differences of neighbours), or K'K: changes of acceleration.
    """
    n = path.arcs.shape[0]
    for i in range(1, n):
        put_vec(path.update, i, 0, add(get_vec(path.update, i, 0), get_vec(path.avoid, i, 0)))
    if setting.metric >= DIFFERENCE:
        solve_difference(path.update)
    if setting.metric == ACCELERATION:
        solve_difference(path.update)
    far = 0.0
    for i in range(1, n):
        far = max(far, norm(get_vec(path.update, i, 0)))
    far /= setting.regularisation
    share = 1.0 / setting.regularisation
    most = setting.largest_step * unit
    if most > 0.0 and far > most:
        share *= most / far
    if not math.isfinite(far):
        return far
    for i in range(1, n):
        put_vec(path.points, i, 0, add_scaled(get_vec(path.points, i, 0), -share, get_vec(path.update, i, 0)))
    return far


OPTIONS = len(Setting._fields)

STILL = 1e-9
"""A move, in lengths of a segment, after which nothing is expected any more."""


def scratch_size(n: int) -> int:
    """Numbers (float64) of the scratch for n segments."""
    return 5 * 3 * (n + 1) + 15 * n + 4 * n + 3 * n


def carve_path(buffer: Array, n: int) -> tuple[Path, Array]:
    """Lay out a path and a configuration (n, 3) in `buffer`, for n segments."""
    points, rest = cut(buffer, n + 1, 3)
    kept, rest = cut(rest, n + 1, 3)
    tangents, rest = cut(rest, n + 1, 3)
    update, rest = cut(rest, n + 1, 3)
    avoid, rest = cut(rest, n + 1, 3)
    arcs, rest = cut(rest, n, 15)
    wanted, rest = cut(rest, n, 4)
    q, _ = cut(rest, n, 3)
    return Path(points, kept, tangents, arcs, update, avoid, wanted), q


def read_setting(options: Array) -> Setting:
    """Name the first 28 numbers of the `options`."""
    return Setting(*first_of(options, OPTIONS))


def read_aim(problem: Problem) -> Aim:
    """The target of the tip, and the mean length of a segment."""
    return Aim(
        get_vec(problem.targets, 0, TARGET_POSITION),
        get_vec(problem.targets, 0, GOAL),
        problem.targets[0, ORIENTATION] == DIRECTION,
        problem.unit / problem.limits.shape[0],
    )


def look(problem: Problem, aim: Aim, path: Path) -> tuple[float, float]:
    """By how much the lengths of a traced path, and its last tangent, are off: length unit, rad."""
    long = 0.0
    for k in range(path.arcs.shape[0]):
        length = path.arcs[k, 14]
        long = max(long, problem.limits[k, MIN_LENGTH] - length, length - problem.limits[k, MAX_LENGTH])
    turn = norm(direction_vector(get_vec(path.tangents, path.arcs.shape[0], 0), aim.direction)) if aim.directed else 0.0
    return long, turn


def descend(problem: Problem, check: Check, work: Work, weights: Weights, aim: Aim, obstacles: bool) -> float:
    """Move the points of a traced path one step down; how far the most moved."""
    path, _, setting, potential = work
    if setting.gradient == ADJOINT:
        gradient_backwards(potential, setting, weights, aim, path, obstacles, check.clock)
    else:
        gradient_by_differences(potential, setting, weights, aim, path, obstacles, check.clock)
    if obstacles and setting.project != 0.0:
        project(path)
    return move(setting, path, aim.unit)


def settle(problem: Problem, check: Check, work: Work, aim: Aim, source: int, answer: Answer) -> int:
    """Go on from a solved path, farther from obstacles and limits; what is not solved any more is not taken.

    Returns the number of iterations.
    """
    path, q, setting, _ = work
    weights = scheduled(setting, 0, True, True)
    count = int(setting.settle)
    for _ in range(count):
        if late(check.clock):
            break
        descend(problem, check, work, weights, aim, True)
        trace(path)
    configuration_of(path.points, check.frames, q)
    offer(problem, check, q, source, answer)
    return count


def improve(problem: Problem, check: Check, work: Work, aim: Aim, source: int, answer: Answer) -> tuple[int, bool]:
    """Improve a path until it is solved, does not move any more, or its iterations or the time are over.

    Returns the number of iterations and whether it is solved. Of paths that are not, the one whose lengths and
    orientation were the least off is offered.
    """
    path, q, setting, _ = work
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
            if offer(problem, check, q, source, answer):
                if obstacles and setting.settle > 0.0:
                    iteration += settle(problem, check, work, aim, source, answer)
                return iteration, True
            least = -1.0
        elif off < least:
            least = off
            copy(path.points, path.kept)
        if iteration >= setting.iterations:
            break
        if spend(check.clock, SEGMENT_WORK * q.shape[0]):
            break
        weights = scheduled(setting, iteration, long > 0.0, turn > problem.angle_tolerance)
        iteration += 1
        far = descend(problem, check, work, weights, aim, obstacles)
        if not far > STILL * aim.unit or not math.isfinite(far):
            break
    if 0.0 <= least < math.inf:
        configuration_of(path.kept, check.frames, q)
        offer(problem, check, q, source, answer)
    return iteration, False


def follow(
    problem: Problem, check: Check, scratch: Array, options: Array, start: Start, answer: Answer
) -> tuple[int, bool]:
    """Follow one start; see `sinuous.methods.search`.

    `options` are those of `gradient.Setting`, then what `path.read_potential` takes apart.
    """
    path, q = carve_path(scratch, problem.limits.shape[0])
    setting, aim = read_setting(options), read_aim(problem)
    want(problem.limits, setting.dead_band, problem.mount, path)
    potential = read_potential(problem.scene, options[OPTIONS:], setting.slope, setting.influence * aim.unit)
    work = Work(path, q, setting, potential)
    source = begin_path(problem, check, work, aim, start)
    if source < 0:
        return NO_START, False
    return improve(problem, check, work, aim, source, answer)


search = search_by(follow)
