"""`ablation`, `remembered`, `explored`: places solved in several ways, each held against another.

What counts is the CPU time of the thread, so that other work on the machine hardly matters. Answers count when the
judges find them right.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain
from statistics import median
from time import thread_time
from typing import NamedTuple

import numpy as np

import sinuous as sn
from benchmarks.harness import Experiment, Line, Plan, Times, Trial, divided, refuted, solved_within, timed
from benchmarks.judges.judge import wrong_in
from benchmarks.motion.known import straight
from benchmarks.places import FAMILIES, Place, make
from benchmarks.places.place import feasible, right
from benchmarks.problems import tip_targets
from sinuous.base.checks import Floats
from sinuous.kernels.tables import ROUTE, SOURCES
from sinuous.motion.plan import Goal
from sinuous.solver.options import ATTEMPTS
from sinuous.solver.solver import Solver
from sinuous.solver.strategy import OPENING
from sinuous.studies.exploring.explore import explore

LIMIT = 1.0
"""Seconds of CPU time in which a place has to be solved."""

PATIENCE = 3.0
"""Budget of a solve on the clock, in units of that: the machine may be busy."""

LOST, LONGER, LEAST = 0.01, 0.1, 2e-3
"""From which on a way moves a family: share of its places that is lost; growth of its 95 %, as a share, and in s."""


Found = tuple[str, Trial]
"""In which way, and what came of it in CPU time."""


class Ways(NamedTuple):
    """What is compared.

    Attributes
    ----------
    examined : callable
        From a run and a place to what came of each way there.
    against : mapping of str to str
        What each way is held against.
    places : int
        Places of a family.
    within : float
        CPU time in which a problem has to be solved, in seconds.
    whole : bool
        Whether all families are asked, and told together alone; else those without joints, each by itself, too.
    """

    examined: Callable[[Plan, Place], Iterator[Found]]
    against: Mapping[str, str]
    places: int
    within: float
    whole: bool = False


measured = partial(timed, clock=thread_time)
"""By CPU time of the thread."""

EVERYTHING = "everything"


def without_attempts(_: Plan, place: Place) -> Iterator[Found]:
    """Solve a place with all attempts of the solver, and with one after the other switched off."""
    whole, opened = _ablated(place, EVERYTHING)
    for way in WAYS["ablation"].against:  # what the first call solves knows no attempts
        yield way, whole if opened or way == EVERYTHING else _ablated(place, way)[0]


def _ablated(place: Place, way: str) -> tuple[Trial, bool]:
    without = () if way == EVERYTHING else (way.removeprefix("without "),)
    solver = Solver(place.robot, place.scene, tolerance=place.tolerance, time=PATIENCE * LIMIT, without=without)
    solver.solve(place.targets)
    solution, spent = measured(solver.solve, place.targets)
    opened = solution.solved and solution.start != SOURCES[ROUTE] and solution.starts <= OPENING
    return _judged(place, solution, spent), opened


def _judged(place: Place, solution: sn.Solution, spent: float) -> Trial:
    wrong = solution.solved and not right(place, solution.configuration)
    return Trial(place.seed, spent, str(solution.status), "refuted" * wrong)


SHORTEST, LONGEST = 1e-3, 0.5
"""Standard deviation of a step away from a shape, rad, drawn between these with equal shares of each size."""

LENGTH_SHARE = 0.3
"""The same of lengths, in longest lengths of a segment a radian."""

DRAWS = 60
"""Draws for each target."""


def targets_about(place: Place, count: int, rng: np.random.Generator) -> Iterator[Place]:
    """Yield the same place with other hidden shapes and targets, all feasible: at most `count`."""
    lengths = np.array([segment.length for segment in place.robot.segments])
    scale = np.array([1.0, 1.0, LENGTH_SHARE * lengths[:, 1].max()])
    shapes = [place.hidden_q]
    for _ in range(DRAWS * count):
        step = np.exp(rng.uniform(np.log(SHORTEST), np.log(LONGEST)))
        q = shapes[rng.integers(len(shapes))] + step * scale * rng.standard_normal(place.hidden_q.shape)
        q[:, 2] = np.clip(q[:, 2], lengths[:, 0], lengths[:, 1])
        targets = tip_targets(place.robot, q[None], "position" if place.target.direction is None else "direction")
        other = replace(place, targets=tuple(targets), hidden_q=q)
        if feasible(other):
            shapes.append(q)
            yield other
            if len(shapes) > count:
                return


REMEMBERED, EXPLORED, QUICK = 100, 20, 1
"""Targets in each place, with a memory and in an explored one; and in a quick run."""


def remembering(plan: Plan, place: Place) -> Iterator[Found]:
    """Ask many targets of a place, with a memory and without: of feasible shapes a random walk from the hidden one."""
    others = list(targets_about(place, plan.count(REMEMBERED, QUICK), np.random.default_rng(place.seed)))
    for way, memory in zip(WAYS["remembered"].against, (sn.Memory(place.robot), None), strict=True):
        solver = sn.Solver(place.robot, place.scene, memory=memory, tolerance=place.tolerance)
        solver.solve(place.targets)
        for other in others:
            yield way, _judged(other, *measured(solver.solve, other.targets))


SECONDS, EXPLORING, ROUNDS = 5.0, 3600.0, 50
"""Budget of a plan; seconds of exploring, whatever the rounds; and rounds of it."""

AWAY, TRIES = (0.3, 0.6), 30
"""How far the tip of another shape is from the hidden one's, in lengths of the robot, and how many are tried."""


def elsewhere(place: Place) -> Floats | None:
    """Return a clear shape (n, 3) whose tip is away from the hidden one; `None` where none is found."""
    rng, solver = np.random.default_rng(place.seed), sn.Solver(place.robot, place.scene)
    tip = place.robot.tip(place.hidden_q)[:3, 3]
    for _ in range(TRIES):
        way = rng.normal(size=3)
        far = place.robot.mean_length * rng.uniform(*AWAY)
        solution = solver.solve(sn.Target(tip + far * way / np.linalg.norm(way)))
        if solution.solved:
            return np.array(solution.q)
    return None


def exploring(plan: Plan, place: Place) -> Iterator[Found]:
    """Plan into a place, explored from where the robot waits and from a solved shape, or not; the judges look.

    It waits straight, or, where that is not clear, in a shape that reaches a place away from the hidden tip; nothing
    where none is found. Plans lead to the hidden shape and to feasible targets about it.
    """
    robot, scene, tolerance = place.robot, place.scene, place.tolerance
    start: Floats | None = straight(robot)
    plain = sn.Planner(robot, scene, time=SECONDS, tolerance=tolerance)
    if plain.plan(straight(robot), place.hidden_q).status is sn.Status.START_BLOCKED:
        start = elsewhere(place)
    if start is None:
        return
    memory = sn.Memory(robot)
    sn.Solver(robot, scene, memory=memory, tolerance=tolerance).solve(place.targets)
    explore(robot, scene, time=EXPLORING, rounds=ROUNDS, memory=memory, starts=start, workers=1)
    walker = sn.Planner(robot, scene, memory=memory.reading(), time=SECONDS, tolerance=tolerance)
    others = targets_about(place, plan.count(EXPLORED, QUICK), np.random.default_rng(place.seed))
    goals: list[Goal] = [place.hidden_q, *(list(other.targets) for other in others)]
    for way, planner in zip(WAYS["explored"].against, (walker, plain), strict=True):
        planner.plan(start, goals[-1])  # what is kept of the memory is made by the first plan
        for goal in goals:
            motion, spent = measured(planner.plan, start, goal)
            wrong = wrong_in(robot, scene, motion.q) if motion.solved else ""
            yield way, Trial(place.seed, spent, str(motion.status), wrong)


ONE_OFF = (f"without {name}" for name in ATTEMPTS if name != "remembered")  # there is no memory

WAYS = {
    "ablation": Ways(
        without_attempts, dict.fromkeys([EVERYTHING, *ONE_OFF], EVERYTHING), places=3, within=LIMIT, whole=True
    ),
    "remembered": Ways(
        remembering, {"with a memory": "without", "without": "without"}, places=2, within=PATIENCE * LIMIT
    ),
    "explored": Ways(exploring, {"explored": "not explored", "not explored": "not explored"}, places=2, within=SECONDS),
}
"""What is compared, by name."""

EACH, ALL, FALSE = "each family", "all families", 'wrong claims: "solved" where a judge disagrees'


def _compare(name: str, plan: Plan) -> Experiment:
    """Compare ways to solve places; a part is a family."""
    ways, first = WAYS[name], 1000 * plan.seed
    numbers = range(first, first + plan.count(ways.places, 1))
    parts = {}
    for family in [family for family, own in FAMILIES.items() if ways.whole or not own.joints]:
        work, summed = partial(examine, name, plan, family), partial(lines_of, name, family)
        parts[family] = divided(plan, work, numbers, len(numbers), summed)
    protocol = (
        f"places 1000 * seed + i of each family, i below {len(numbers)}; CPU time of the thread; counted is what says "
        f"solved within {ways.within:g} s and the judges find right"
    )
    return Experiment(name, plan, parts, protocol, partial(total_of, name))


ablation, remembered, explored = (partial(_compare, name) for name in WAYS)


def examine(name: str, plan: Plan, family: str, number: int) -> list[Found]:
    """Examine a place of a family in all ways."""
    return list(WAYS[name].examined(plan, make(family, number)))


def lines_of(name: str, family: str, found: Sequence[Sequence[Found]]) -> Iterator[Line]:
    """Sum up the ways in places of one family, where each is told by itself."""
    for way, (trials, other) in _paired(name, found).items() if not WAYS[name].whole else ():
        yield _line(name, EACH, f"{family}, {way}", trials, other)


def total_of(name: str, found: Mapping[str, Sequence[Sequence[Found]]]) -> Iterator[Line]:
    """Sum up the ways in all families, say which of these each moves, and count wrong claims."""
    by_family = {family: _paired(name, places) for family, places in found.items()}
    for way, (trials, other) in _paired(name, [*chain.from_iterable(found.values())]).items():
        line = _line(name, ALL, way, trials, other)
        moved = [_moved(family, *own[way], WAYS[name].within) for family, own in by_family.items() if way in own]
        yield replace(line, note="; ".join(filter(None, [line.note, ", ".join(filter(None, moved))])))
    judged = {family: [trial for place in places for _, trial in place] for family, places in found.items()}
    yield refuted(FALSE, "all", judged)


def _paired(name: str, found: Sequence[Sequence[Found]]) -> dict[str, tuple[list[Trial], list[Trial]]]:
    """What came of each way, and, problem by problem, of that which it is held against."""
    own = {way: [trial for each, trial in chain.from_iterable(found) if each == way] for way in WAYS[name].against}
    return {way: (trials, own[WAYS[name].against[way]]) for way, trials in own.items() if trials}


def _line(name: str, section: str, what: str, trials: Sequence[Trial], other: Sequence[Trial]) -> Line:
    """How often and how quickly a way solves, and, in the note, its time as a part of that of the other."""
    within, pairs = WAYS[name].within, zip(trials, other, strict=True)
    ratios = [a.seconds / b.seconds for a, b in pairs if a.good(within) and b.good(within)] or [np.nan]
    told = f"takes {median(ratios):.3g} of the time of the other, {np.quantile(ratios, 0.95):.3g} for 95 %"
    return solved_within(within, section, what, trials, note="" if trials is other else told)


def _moved(family: str, trials: Sequence[Trial], other: Sequence[Trial], within: float) -> str:
    """How a way matters in a family: how many more places are lost with it, or how much longer 95 % take."""
    lost = sum(trial.good(within) for trial in other) - sum(trial.good(within) for trial in trials)
    if lost > LOST * len(other):
        return f"{family} ({lost} lost)"
    after, before = (Times.of([trial.seconds for trial in own]).p95 for own in (trials, other))
    return f"{family} (x {after / before:.1f})" if after - before > max(LEAST, LONGER * before) else ""
