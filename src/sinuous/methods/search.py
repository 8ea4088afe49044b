"""The search of every method but our own, and the check of its answers.

Starts are followed one after the other until one is solved.

A method brings its kernel `follow`, which follows one start; all else is the same for all. It is called as

    follow(problem, check, scratch, options, start, answer) -> iterations, solved

with `scratch` (w,), a buffer of as many numbers as the method asked for, and the `options` of the method. It hands its
answers to `offer`, and returns `NO_START` iterations where the method has no start of this number.

A method works as it likes; `offer` alone takes its answers. It recomputes everything from the configuration: `solved`
is what it finds within tolerance, within all limits, and proved clear of obstacles and of itself.
"""

import math
from collections import namedtuple
from collections.abc import Callable

from sinuous.kernels import tables as t
from sinuous.kernels.body.pieces import Scratch
from sinuous.kernels.body.proof import CLEAR, TOUCHING, prove
from sinuous.kernels.body.self_pairs import SPAN_WIDTH, Shape
from sinuous.kernels.body.self_proof import prove_self
from sinuous.kernels.chain.kinematics import forward, frame, put_frame
from sinuous.kernels.clock import CLOCK_SIZE, allow, begin, now, over
from sinuous.kernels.compile import entry_around, shared
from sinuous.kernels.maths.buffers import cut, cut_whole
from sinuous.kernels.maths.vectors import ZERO, Array, add, copy, dot, get_vec, norm, put_vec
from sinuous.kernels.problem import Problem, answer_of, read_problem
from sinuous.kernels.solve.starts import find_most_distal, put_single_arc, turn_to_targets, widest_bend
from sinuous.kernels.solve.verdicts import POSSIBLE, verdict_of
from sinuous.kernels.step.actuation import runs_through, sums_from
from sinuous.kernels.step.limits import bend_cap
from sinuous.kernels.step.scattered import scattered
from sinuous.kernels.step.targets import end_pose, end_segment, miss_of
from sinuous.kernels.tables import Budget

SLACK = 0.1
"""How far below the true clearance its proved bound may be, as a share of it."""

FINEST = 1e-7
"""Length of backbone, in robot lengths, below which a proof gives up."""

ROUNDING = 1e-11
"""By how much a limit may be exceeded, rad or robot lengths: what arithmetic rounds."""

Check = namedtuple("Check", ["frames", "among", "clock", "spans"])
"""Scratch of the check: frames (n + 1, 12), whose first row is the base; numbers of the m obstacles (m,); the
clock, see `kernels.clock`; and `spans` (n + 1, 5) of `self_pairs`."""

Answer = namedtuple("Answer", ["best", "record"])
"""What a search fills: the best configuration (n, 3; rad and length unit), and its record (11,; see `tables`)."""


def check_size(segments: int, obstacles: int) -> int:
    """Numbers (float64) that `carve_check` takes from a buffer."""
    return (12 + SPAN_WIDTH) * (segments + 1) + obstacles + CLOCK_SIZE


def carve_check(buffer: Array, problem: Problem) -> tuple[Check, Array]:
    """Lay out the scratch of the check at the beginning of `buffer` (`check_size` or more); returns the rest too."""
    n = problem.limits.shape[0]
    frames, rest = cut(buffer, n + 1, 12)
    rotation, position = frame(problem.base, 0)
    put_frame(frames, 0, rotation, position)
    among, rest = cut_whole(rest, problem.scene.table.shape[0])
    clock, rest = cut_whole(rest, CLOCK_SIZE)
    spans, rest = cut(rest, n + 1, SPAN_WIDTH)
    return Check(frames, among, clock, spans), rest


def has_obstacles(problem: Problem) -> bool:
    """Whether there is anything to run into."""
    return bool(problem.scene.table.shape[0] > 0)


def finite(q: Array) -> bool:
    """Whether all numbers of a configuration (n, 3) are finite."""
    total = 0.0
    for k in range(q.shape[0]):
        for j in range(3):
            total += q[k, j] - q[k, j]
    return total == 0.0


def target_errors(problem: Problem, frames: Array) -> tuple[float, float]:
    """Largest distance (length unit) and angle (rad) to the targets, of the shape with these frames (n + 1, 12)."""
    off = turn = 0.0
    for i in range(problem.targets.shape[0]):
        rotation, position = end_pose(frames, problem.tool, end_segment(problem.targets, i, frames.shape[0] - 1))
        miss, twist = miss_of(problem.targets, i, rotation, position)
        off, turn = max(off, norm(miss)), max(turn, norm(twist))
    return off, turn


def excess(problem: Problem, q: Array) -> tuple[float, float]:
    """By how much `q` (n, 3) exceeds its limits: lengths and actuators (length unit), bends (rad)."""
    length = bend = 0.0
    total, first = ZERO, sums_from(problem.actuation)
    j = 0
    for k in range(q.shape[0]):
        own = get_vec(q, k, 0)
        if k >= first:
            total = add(total, own)
        length = max(length, problem.limits[k, t.MIN_LENGTH] - own[2], own[2] - problem.limits[k, t.MAX_LENGTH])
        bend = max(bend, math.hypot(own[0], own[1]) - bend_cap(problem.limits, k, max(0.0, own[2])))
        while j < problem.actuation.shape[0] and problem.actuation[j, t.LAST_SEGMENT] == k:
            seen = dot(get_vec(problem.actuation, j, t.WEIGHTS), total if runs_through(problem.actuation, j) else own)
            length = max(length, problem.actuation[j, t.MIN_VALUE] - seen, seen - problem.actuation[j, t.MAX_VALUE])
            j += 1
    return length, bend


@shared
def finish(problem: Problem, check: Check, q: Array) -> tuple[int, float, float, float, float, bool, float]:
    """The check of an answer `q` (n, 3), the same for all methods.

    Returns SOLVED, UNPROVED or FAILED; largest distance and angle to the targets; clearance and self-clearance, proved
    when solved, else the least that was seen; whether a limit is exceeded; and the merit: all that is wrong, squared,
    in robot lengths and rad.
    """
    if not finite(q):  # comparisons with NaN are false, also those that should find something wrong
        return t.FAILED, math.inf, math.inf, math.inf, math.inf, True, math.inf
    forward(problem.limits, q, check.frames)
    off, turn = target_errors(problem, check.frames)
    length, bend = excess(problem, q)
    bound = not (length <= ROUNDING * problem.unit and bend <= ROUNDING)
    verdict, clearance = CLEAR, math.inf
    if has_obstacles(problem):
        verdict, clearance, _, _, _ = prove(
            problem.limits,
            q,
            check.frames,
            problem.scene,
            problem.mount,
            SLACK,
            FINEST * problem.unit,
            Scratch(check.among, check.clock),
        )
    own, self_clearance = CLEAR, math.inf
    if problem.avoids_itself:
        shape = Shape(problem.limits, q, check.frames, check.spans)
        own, self_clearance, _ = prove_self(shape, FINEST * problem.unit, check.clock)
    overlap = max(0.0, -clearance) if verdict == TOUCHING else 0.0
    crossing = max(0.0, -self_clearance) if own == TOUCHING else 0.0
    lengths = off * off + length * length + overlap * overlap + crossing * crossing
    merit = lengths / (problem.unit * problem.unit) + turn * turn + bend * bend
    code = t.FAILED
    if off <= problem.position_tolerance and turn <= problem.angle_tolerance and not bound:
        if verdict == CLEAR and own == CLEAR:
            code = t.SOLVED
        elif TOUCHING not in (verdict, own):
            code = t.UNPROVED
    return code, off, turn, clearance, self_clearance, bound, merit


def offer(problem: Problem, check: Check, q: Array, source: int, answer: Answer) -> bool:
    """Check a configuration (n, 3), keep it when it is the best so far, and say whether it is solved.

    `source` says where its start came from. Shapes with a number that is not finite are passed over.
    """
    record = answer.record
    code, off, turn, clearance, self_clearance, bound, merit = finish(problem, check, q)
    if record[t.CODE] == t.SOLVED and code != t.SOLVED:
        return False
    if not finite(q) or not (code == t.SOLVED or merit < record[t.MERIT]):
        return False
    copy(q, answer.best)
    if record[t.CODE] < t.OUT_OF_REACH or code == t.SOLVED:
        record[t.CODE] = code
    record[t.SOURCE], record[t.POSITION_ERROR], record[t.ANGLE_ERROR], record[t.CLEARANCE] = (
        source,
        off,
        turn,
        clearance,
    )
    record[t.SELF_CLEARANCE], record[t.BOUND], record[t.MERIT] = self_clearance, 1.0 if bound else 0.0, merit
    return code == t.SOLVED


Start = namedtuple("Start", ["initial", "index", "first", "seed"])
"""One start of a search: the initial configurations (g, n, 3; rad and length unit); its place among all starts, of
which these are the first; the number of the method's own start that comes after them; and the seed of those that are
random."""

NO_START = -1
"""Iterations of a start that does not exist: the search ends."""

Follow = Callable[[Problem, Check, Array, Array, Start, Answer], tuple[int, bool]]

Search = Callable[[Array, Array, Array, Array, Array, Budget, Array, Array], None]


def own_number(start: Start) -> int:
    """Number of a start among the method's own; -1 for an initial configuration."""
    given = start.initial.shape[0]
    return start.first + start.index - given if start.index >= given else -1


def begin_from(problem: Problem, check: Check, start: Start, q: Array) -> int:
    """Put a start into `q` (n, 3): an initial configuration, or one of `begin_own`; returns its source."""
    number = own_number(start)
    if number < 0:
        copy(start.initial[start.index], q)
        return t.GIVEN
    return begin_own(problem, check, number, start.seed, q)


@shared
def begin_own(problem: Problem, check: Check, number: int, seed: int, q: Array) -> int:
    """Put own start `number` into `q` (n, 3): 0 is the single arc, all others are scattered; returns its source."""
    tip, goal = find_most_distal(problem)
    if number == 0 and tip >= 0:
        put_single_arc(problem.limits, check.frames, tip, goal, q)
        return t.ARC
    scattered(problem.limits, number, seed, widest_bend(number), q)
    turn_to_targets(problem.limits, problem.targets, check.frames, problem.tool, q)
    return t.RANDOM


def open_record(problem: Problem, check: Check, given: int, budget: Budget, answer: Answer) -> int:
    """Open the record and the time of a search; returns the number of its starts.

    They are `given` initial configurations and the method's own of the `budget`. What is proved impossible is tried
    from the initial configurations and once more.
    """
    first, last, _, seconds = budget
    record = answer.record
    began = allow(check.clock, seconds)
    impossible = verdict_of(problem)
    for j in range(record.shape[0]):
        record[j] = 0.0
    record[t.CODE] = t.FAILED if impossible == POSSIBLE else impossible
    record[t.POSITION_ERROR] = record[t.ANGLE_ERROR] = record[t.MERIT] = math.inf
    record[t.CLEARANCE] = record[t.SELF_CLEARANCE] = math.inf
    record[t.SECONDS] = began
    for k in range(answer.best.shape[0]):
        put_vec(
            answer.best, k, 0, (0.0, 0.0, 0.5 * (problem.limits[k, t.MIN_LENGTH] + problem.limits[k, t.MAX_LENGTH]))
        )
    own = last - first if impossible == POSSIBLE else min(last - first, 1)
    return given + own


def close_record(problem: Problem, check: Check, iterations: int, starts: int, late: bool, answer: Answer) -> None:
    """Close the record of a search; where nothing could be kept, the best is the straight robot, and FAILED."""
    record = answer.record
    if record[t.MERIT] == math.inf:
        _, off, turn, clearance, self_clearance, _, merit = finish(problem, check, answer.best)
        record[t.POSITION_ERROR], record[t.ANGLE_ERROR], record[t.MERIT] = off, turn, merit
        record[t.CLEARANCE], record[t.SELF_CLEARANCE] = clearance, self_clearance
    if late and record[t.CODE] == t.FAILED:
        record[t.CODE] = t.LATE
    record[t.ITERATIONS], record[t.STARTS] = iterations, starts
    record[t.SECONDS] = now(check.clock) - record[t.SECONDS]


def search_by(follow: Follow) -> Search:
    """Make the search of the method that `follow` belongs to, to be called from Python.

    It is made around `follow`, because code that is handed over as an argument cannot be kept on disk.
    """

    def search(
        robot: Array,
        scene: Array,
        settings: Array,
        targets: Array,
        initial: Array,
        budget: Budget,
        workspace: Array,
        answers: Array,
    ) -> None:
        """Solve m problems, each from its starts until one is solved, there are no more, or time is over.

        `robot`, `scene` and `settings` are groups, laid out as `tables` says; `targets` (m, t, 15); `initial`
        (m, g, n, 3). `workspace` is scratch of the check (`check_size`), then of the method. Fills `answers`
        (m, 11 + 3 n): record and configuration of each.
        """
        n, options = int(robot[0]), settings[t.METHOD_OPTIONS :]
        for i in range(targets.shape[0]):
            problem = read_problem(robot, scene, settings, targets[i])
            check, scratch = carve_check(workspace, problem)
            if i == 0:
                begin(check.clock)
            best, record = answer_of(answers, i, n)
            answer = Answer(best, record)
            count = open_record(problem, check, initial.shape[1], budget, answer)
            total, index, late, solved = 0, 0, False, False
            while index < count and not late and not solved:
                start = Start(initial[i], index, budget[0], budget[2])
                used, solved = follow(problem, check, scratch, options, start, answer)
                if used < 0:
                    break
                total += used
                index += 1
                late = not solved and over(check.clock)
            close_record(problem, check, total, index, late, answer)

    return entry_around(follow, search)
