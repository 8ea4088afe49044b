"""`clutter`: intricate places, each known to be possible; `worlds`: very many small ones.

Every place was made around a hidden shape that reaches its target, so neither "impossible" nor silence is excused.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from functools import lru_cache, partial
from statistics import median
from time import perf_counter
from typing import Any, NamedTuple

import sinuous as sn
from benchmarks.harness.experiment import Divided, Experiment, Plan
from benchmarks.harness.lines import Goal, Line, Times
from benchmarks.judges.judge import IMPOSSIBLE
from benchmarks.places import FAMILIES, Place, make
from benchmarks.places.place import right as judged_right
from sinuous.solver.options import read_without
from sinuous.solver.solver import Solver

COUNT, QUICK, TOGETHER = 60, 2, 5
"""Places of a family: three times all robots; in a quick run; and of one share, which an interrupt costs a process."""

PUBLISHED, PUBLISHED_QUICK, PUBLISHED_TOGETHER = 400, 8, 50
"""The same of a published protocol: a hundred in each of its four scenes."""

SMALL = "small world"
WORLDS, WORLDS_QUICK, WORLDS_TOGETHER = 100_000, 200, 100
"""The same of small worlds, made to find false claims that are rare."""

SOLVED = "solved and proved within 1 s, and found right by the judges"
FALSE = 'wrong claims: "solved" where a judge disagrees, or "impossible" where there is the hidden shape'
MEDIAN = "median time (one core, warm; the goal is stricter where the single arc alone solves 99 %)"
TAIL = "time that 95 % of the solves keep within"
WORST = "worst time"
FIRST = "from robot and obstacles to the first answer, median"
ALONE = "compared: newton from the single arc alone"

NARROW = 10e-3
"""Goal of the median where a pipe is 1.3 times as wide as the body, seconds."""

LIMIT = 1.0
"""Seconds after which an answer comes too late."""

SHOWN = 40
"""Most seeds that a line lists."""

COUNTED = (
    f"budget {LIMIT:g} s; timed is the second of two calls of solve, in a process that keeps to one core; counted is "
    "what says solved within the budget and the judges find right"
)


def clutter(plan: Plan, without: Sequence[str] = ()) -> Experiment:
    """Measure every family, some places a share; attempts of the solver may be switched off (`options.ATTEMPTS`).

    Raises
    ------
    InputError
        Where an attempt is not known.
    """
    off = read_without(list(without))
    parts = {}
    for family, own in FAMILIES.items():
        sizes = (PUBLISHED, PUBLISHED_QUICK) if own.published else (COUNT, QUICK)
        first = 1000 * plan.seed
        seeds = range(first, first + plan.count(*sizes))
        parts[family] = divided(family, seeds, PUBLISHED_TOGETHER if own.published else TOGETHER, off)
    protocol = (
        f"place i of a family is benchmarks.places.make(family, 1000 * seed + i), i below {COUNT} ({PUBLISHED} for p3 "
        "and p4); constants may be tuned on even numbers below 1000 only, and on no place of a judging kind, so every "
        f"seed but 0 judges; {COUNTED}"
    )
    settings = {"without": ",".join(off)} if off else {}
    return Experiment("clutter", plan, parts, protocol, settings, abreast=True)


def worlds(plan: Plan) -> Experiment:
    """Measure small worlds; world i has the number `WORLDS * seed + i`."""
    first = WORLDS * plan.seed
    seeds = range(first, first + plan.count(WORLDS, WORLDS_QUICK))
    protocol = f"world i is benchmarks.places.make({SMALL!r}, {WORLDS} * seed + i); {COUNTED}"
    return Experiment("worlds", plan, {SMALL: divided(SMALL, seeds, WORLDS_TOGETHER)}, protocol, abreast=True)


def divided(family: str, seeds: range, together: int, without: tuple[str, ...] = ()) -> Divided:
    """Return places of one family, some at a time, and what sums them up."""
    shares = [partial(tried, family, seeds[i : i + together], without) for i in range(0, len(seeds), together)]
    return Divided(shares, partial(summed, family))


class Attempt(NamedTuple):
    """What one solver came to.

    Attributes
    ----------
    first, seconds : float
        Of the first solve, which makes what a solver puts off, and of the second, which is what counts.
    status : str
    start : str
        Kind of the start that won.
    claimed, right : bool
        Whether it says solved, and whether the judge finds it so, who looks at nothing else.
    """

    first: float
    seconds: float
    status: str
    start: str
    claimed: bool
    right: bool

    @property
    def solved(self) -> bool:
        """Whether it says so and is."""
        return self.claimed and self.right

    @property
    def false(self) -> bool:
        """Whether the judge refutes that it is solved, or the hidden shape that it is impossible."""
        return (self.claimed and not self.right) or self.status in IMPOSSIBLE


class Trial(NamedTuple):
    """One place, and what came of it.

    Attributes
    ----------
    seed : int
    prepare : float
        Seconds to make scene and solver.
    ours, arc : Attempt
        Of the solver that a user gets, and of one that begins at the single arc alone.
    """

    seed: int
    prepare: float
    ours: Attempt
    arc: Attempt


def tried(family: str, seeds: range, without: tuple[str, ...]) -> list[list[Any]]:
    """Try some places; return plain values of the trials."""
    return [list(examine(family, seed, without)) for seed in seeds]


def examine(family: str, seed: int, without: tuple[str, ...] = ()) -> Trial:
    """Make a place and solve it; attempts of ours may be switched off."""
    place = make(family, seed)
    prepared = _shared if FAMILIES[family].published else _prepared
    solver, prepare = prepared(place.robot, place.scene, place.tolerance, without)
    local = _local(place.robot, place.scene, place.tolerance)
    return Trial(seed, prepare, _attempt(place, solver), _attempt(place, local))


def _prepared(
    robot: sn.Robot, scene: sn.Scene, tolerance: sn.Tolerance, without: tuple[str, ...]
) -> tuple[Solver, float]:
    """Return the solver that a user gets, and the seconds that it took to make."""
    began = perf_counter()
    solver = Solver(robot, sn.Scene(scene.obstacles), tolerance=tolerance, without=without)
    return solver, perf_counter() - began


_shared = lru_cache(maxsize=16)(_prepared)
"""For places that share robot and scene, which are the published ones."""


@lru_cache(maxsize=2)
def _local(robot: sn.Robot, scene: sn.Scene, tolerance: sn.Tolerance) -> Solver:
    """Return a solver without routes, which follows one start."""
    return Solver(robot, scene, tolerance=tolerance, max_starts=1, routes=False)


def _attempt(place: Place, solver: Solver) -> Attempt:
    spent = []
    for _ in range(2):
        began = perf_counter()
        solution = solver.solve(place.targets)
        spent.append(perf_counter() - began)
    right = solution.solved and judged_right(place, solution.configuration)
    return Attempt(spent[0], spent[1], str(solution.status), solution.start, solution.solved, right)


def summed(family: str, shares: Sequence[Sequence[Sequence[Any]]]) -> Iterator[Line]:
    """Summarise a family of which some shares were tried."""
    trials = [Trial(seed, prepare, Attempt(*ours), Attempt(*arc)) for own in shares for seed, prepare, ours, arc in own]
    yield from lines_of(family, trials)


def lines_of(family: str, trials: list[Trial]) -> Iterator[Line]:
    """Summarise one family: every family on the same lines, so that they can be compared."""
    own = FAMILIES[family]
    ours, arcs = [trial.ours for trial in trials], [trial.arc for trial in trials]
    times = Times.of([attempt.seconds for attempt in ours])
    good = [attempt.solved and attempt.seconds <= LIMIT for attempt in ours]
    goal = Goal(100.0 if own.published else 99.0, at_most=False)
    failed = [trial for trial, well in zip(trials, good, strict=True) if not well]
    won = Counter(attempt.start for attempt in ours if attempt.solved).most_common()
    winners = "won by " + (", ".join(f"{kind} {count}" for kind, count in won) or "none")
    note = "; ".join([own.words + " (judging only)" * own.judging, winners, *_listed("not solved", failed)])
    yield Line(SOLVED, family, 100.0 * sum(good) / len(good), "%", goal, times, (sum(good), len(good)), note)
    wrong = [trial for trial in trials if trial.ours.false or trial.arc.false]
    yield Line(FALSE, family, len(wrong), "", Goal(0, correctness=True), note="; ".join(_listed("wrong", wrong)))
    local = _solved(arcs) >= 0.99 * len(arcs)
    fast = Goal(200e-6 if own.published else 100e-6 if local else NARROW if "1.3" in family else 5e-3)
    yield Line(MEDIAN, family, times.median, "us" if fast.value < 1e-3 else "ms", fast)
    yield Line(TAIL, family, times.p95, "ms", Goal(50e-3))
    yield Line(WORST, family, times.worst, "ms", Goal(LIMIT))
    yield Line(FIRST, family, median(trial.prepare + trial.ours.first for trial in trials), "ms")
    alone = Times.of([attempt.seconds for attempt in arcs])
    yield Line(ALONE, family, 100.0 * _solved(arcs) / len(arcs), "%", None, alone, (_solved(arcs), len(arcs)))


def _solved(attempts: Sequence[Attempt]) -> int:
    return sum(attempt.solved for attempt in attempts)


def _listed(what: str, trials: list[Trial]) -> list[str]:
    """Seeds and statuses, to begin a search with; nothing when there are none."""
    listed = ", ".join(f"{trial.seed} ({trial.ours.status})" for trial in trials[:SHOWN])
    return [f"{what}: seeds {listed}{' ...' * (len(trials) > SHOWN)}"] if trials else []
