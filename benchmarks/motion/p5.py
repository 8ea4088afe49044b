"""P5: plans between random states in random clutter; see `pairs`."""

from collections.abc import Callable, Iterator
from functools import partial
from statistics import median

from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from benchmarks.motion import peers
from benchmarks.motion.trials import CONFIGURATION, TARGET, Task, Trial, examine
from benchmarks.solvers.parallel import in_processes

COUNT, QUICK = 200, 4
"""Pairs of one number of segments and one density."""

COMPARED, PATIENCE = 20, 1.0
"""Pairs that the planners of others plan, too, and the seconds that each has for one: in all no more than their product
for each planner and each of the two numbers of segments."""

PLANNED = "P5: planned and proved in time, and found clear by the judges"
FALSE = "P5: motions called proved in which a judge finds a collision"
MEDIAN = "P5: median time of a plan (one core, warm, with the proof of every step)"
SHORTENED = "P5: median time with 10 shortcuts tried"
OTHERS = "P5: compared, over the same proofs: planned in time"

NOISE = 1.0

WITHIN = {(CONFIGURATION, 1): (0.1, 99.5), (CONFIGURATION, 2): (1.0, 97.0), (CONFIGURATION, 4): (1.0, 97.0)}
"""Seconds, and the share (%) that is to be planned in them, by what is asked for and how dense the spheres are."""

LARGE = (1.0, 99.0)
"""The same for 8 segments."""

OF_TARGETS = (0.5, 98.0)
"""The same where the pose of the goal's tip is asked for."""


def _goal(segments: int, density: int, goal: str) -> tuple[float, float]:
    if goal == TARGET:
        return OF_TARGETS
    return LARGE if segments == 8 else WITHIN[goal, density]


def measure(plan: Plan, segments: int, density: int, goal: str) -> Iterator[Line]:
    """Plan all pairs of a kind."""
    what = f"{segments} segments, {density * segments**3} spheres, to a {goal}"
    compares = goal == CONFIGURATION and density == 1 and segments in (3, 6) and peers.installed()
    tasks = [
        Task(segments, density, i, plan.seed, goal, peers=PATIENCE * (compares and i < COMPARED))
        for i in range(plan.count(COUNT, QUICK))
    ]
    trials = list(plan.track(in_processes(examine, tasks, alone=plan.quick), what, len(tasks)))
    yield from lines_of(what, trials, *_goal(segments, density, goal))
    if goal == CONFIGURATION and density == 1:
        tasks = [task._replace(shortcuts=10, peers=0.0) for task in tasks]
        shorter = list(plan.track(in_processes(examine, tasks, alone=plan.quick), what, len(tasks)))
        yield Line(SHORTENED, what, median(trial.seconds for trial in shorter), "ms")
        yield _false(what + ", shortened", shorter)


def lines_of(what: str, trials: list[Trial], limit: float, share: float) -> Iterator[Line]:
    """Sum up the trials of one kind: so large a share (%) is to be planned within the limit (s)."""
    times = Times.of([trial.seconds for trial in trials])
    good = [trial.solved and trial.seconds <= limit for trial in trials]
    missed = ", ".join(f"{trial.number} ({trial.status})" for trial, well in zip(trials, good, strict=True) if not well)
    note = f"not within {limit:g} s: pairs {missed}" if missed else ""
    reached = 100.0 * sum(good) / len(good)
    yield Line(PLANNED, what, reached, "%", Goal(share, at_most=False), times, (sum(good), len(good)), note)
    yield _false(what, trials)
    timed = Goal(1e-3) if limit == WITHIN[CONFIGURATION, 1][0] else None
    yield Line(MEDIAN, what, times.median, "ms", timed, noise=NOISE)
    for name in peers.PLANNERS:
        others = [trial.others[name] for trial in trials if name in trial.others]
        if others:
            found = sum(solved for _, solved in others)
            spent = Times.of([seconds for seconds, _ in others])
            cut = f"the first {len(others)} of {len(trials)} pairs, {PATIENCE:g} s for each"
            note = f"{cut}; goes on to shorten the way until they are over" if name == peers.OPTIMAL else cut
            yield Line(
                OTHERS,
                f"{name} of OMPL, {what}",
                100.0 * found / len(others),
                "%",
                None,
                spent,
                (found, len(others)),
                note,
            )


def _false(what: str, trials: list[Trial]) -> Line:
    wrong = [trial for trial in trials if trial.wrong]
    note = "wrong: " + ", ".join(f"{trial.number} ({trial.wrong})" for trial in wrong) if wrong else ""
    return Line(FALSE, what, len(wrong), "", Goal(0, correctness=True), None, None, note)


PARTS: dict[str, Callable[[Plan], Iterator[Line]]] = {
    **{f"P5, {n} segments": partial(measure, segments=n, density=1, goal=CONFIGURATION) for n in (3, 4, 5, 6, 8)},
    **{
        f"P5, {n} segments, {d} times as dense": partial(measure, segments=n, density=d, goal=CONFIGURATION)
        for d in (2, 4)
        for n in (3, 4, 5, 6)
    },
    **{f"P5, {n} segments, targets": partial(measure, segments=n, density=1, goal=TARGET) for n in (3, 4, 5, 6)},
}
