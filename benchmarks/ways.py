"""`python -m benchmarks ways NAME`: places solved in several ways, which take turns, each held against another.

What counts is the CPU time of the thread, so that other work on the machine hardly matters. Answers count when the
judges find them right.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from statistics import fmean, median
from time import thread_time
from typing import Annotated, NamedTuple

import numpy as np
import typer

import sinuous as sn
from benchmarks.harness import Alone, Record, chosen, give, in_processes, table, timed
from benchmarks.judges.clearances import least_clearance
from benchmarks.judges.judge import wrong_in
from benchmarks.motion.known import straight
from benchmarks.places import FAMILIES, Place, make
from benchmarks.places.place import feasible, right
from benchmarks.problems import tip_targets
from sinuous.base import checks
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


class Row(NamedTuple):
    """One problem, in one way: whether it is solved, in time and right; whether a claim is false; and CPU time, s."""

    family: str
    way: str
    solved: bool
    wrong: bool
    seconds: float


class Ways(NamedTuple):
    """What is compared: in words; rows of a family, from a seed and a count; and what each way is held against."""

    about: str
    examined: Callable[[str, int, int], Iterator[Row]]
    against: Mapping[str, str]


measured = partial(timed, clock=thread_time)
"""By CPU time of the thread."""

EVERYTHING = "everything"


def without_attempts(family: str, seed: int, count: int) -> Iterator[Row]:
    """Solve places of a family with all attempts of the solver, and with one after the other switched off."""
    for number in range(1000 * seed, 1000 * seed + count):
        place = make(family, number)
        whole, opened = _ablated(place, EVERYTHING)
        for way in WAYS["ablation"].against:  # what the first call solves knows no attempts
            yield whole._replace(way=way) if opened or way == EVERYTHING else _ablated(place, way)[0]


def _ablated(place: Place, way: str) -> tuple[Row, bool]:
    without = () if way == EVERYTHING else (way.removeprefix("without "),)
    solver = Solver(place.robot, place.scene, tolerance=place.tolerance, time=PATIENCE * LIMIT, without=without)
    solver.solve(place.targets)
    solution, spent = measured(solver.solve, place.targets)
    fine = solution.solved and right(place, solution.configuration)
    solved = fine and spent <= LIMIT
    opened = solution.solved and solution.start != SOURCES[ROUTE] and solution.starts <= OPENING
    return Row(place.family, way, solved, solution.solved and not fine, spent if solved else LIMIT), opened


SHARE, TRACE = 0.5, 1e-6
"""What is demanded, of the clearance of the hidden shape; and a clearance that changes nothing, in radii."""

TURNS = 8
"""Solves in each way, of which the least counts."""


def demanding(family: str, seed: int, count: int) -> Iterator[Row]:
    """Solve places of a family with a clearance demanded, and by a body that is thicker by as much, in turns.

    The hidden shape keeps what is demanded. A millionth of the radius demanded is held against the problem without. An
    answer counts where judges find it as clear as was demanded.
    """
    for number in range(1000 * seed, 1000 * seed + count):
        place = make(family, number)
        robot, hidden = place.robot, least_clearance(place.robot, place.scene, place.hidden_q[None])[0]
        clearance, trace = SHARE * max(0.0, float(hidden)), TRACE * max(robot.radii)
        thicker = [each.changed(radius=each.radius + clearance) for each in robot.segments]
        asked = {
            "as ever": (robot, 0.0),
            "a trace demanded": (robot.changed(clearance=trace), trace),
            "thicker": (robot.changed(segments=thicker), clearance),
            "demanded": (robot.changed(clearance=clearance), clearance),
        }
        solvers = [
            (way, Solver(own, place.scene, tolerance=place.tolerance, time=PATIENCE * LIMIT), least)
            for way, (own, least) in asked.items()
        ]
        turns = [[measured(solver.solve, place.targets) for _, solver, _ in solvers] for _ in range(TURNS)]
        for (way, _, least), found in zip(solvers, zip(*turns, strict=True), strict=True):
            solution, spent = found[0][0], min(spent for _, spent in found)
            fine = solution.solved and right(place, solution.q)
            fine = fine and least_clearance(robot, place.scene, solution.q[None])[0] >= least * (1.0 - 1e-9)
            yield Row(family, way, fine and spent <= LIMIT, solution.solved and not fine, spent)


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


def remembering(family: str, seed: int, count: int) -> Iterator[Row]:
    """Ask many targets of a place, with a memory and without: of feasible shapes a random walk from the hidden one."""
    place = make(family, seed)
    others = list(targets_about(place, count, np.random.default_rng(seed)))
    for way, memory in zip(WAYS["remembered"].against, (sn.Memory(place.robot), None), strict=True):
        solver = sn.Solver(place.robot, place.scene, memory=memory, tolerance=place.tolerance)
        solver.solve(place.targets)
        for other in others:
            solution, spent = measured(solver.solve, other.targets)
            fine = solution.solved and right(other, solution.q)
            yield Row(family, way, fine, solution.solved and not fine, spent)


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


def exploring(family: str, seed: int, count: int) -> Iterator[Row]:
    """Plan into one place, explored from where the robot waits and from a solved shape, or not; the judges look.

    It waits straight, or, where that is not clear, in a shape that reaches a place away from the hidden tip; nothing
    where none is found. Plans lead to the hidden shape and to feasible targets about it.
    """
    place = make(family, seed)
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
    others = targets_about(place, count, np.random.default_rng(seed))
    goals: list[Goal] = [place.hidden_q, *(list(other.targets) for other in others)]
    for way, planner in zip(WAYS["explored"].against, (walker, plain), strict=True):
        planner.plan(start, goals[-1])  # what is kept of the memory is made by the first plan
        for goal in goals:
            motion, spent = measured(planner.plan, start, goal)
            wrong = motion.solved and bool(wrong_in(robot, scene, motion.q))
            yield Row(family, way, motion.solved and not wrong, wrong, spent)


ONE_OFF = (f"without {name}" for name in ATTEMPTS if name != "remembered")  # there is no memory

WAYS = {
    "ablation": Ways(
        "each attempt of the solver switched off", without_attempts, dict.fromkeys([EVERYTHING, *ONE_OFF], EVERYTHING)
    ),
    "demanded": Ways(
        "a clearance that is demanded, and a body that is thicker by as much",
        demanding,
        {"as ever": "as ever", "a trace demanded": "as ever", "thicker": "thicker", "demanded": "thicker"},
    ),
    "remembered": Ways(
        "many targets in one place, with a memory and without",
        remembering,
        {"with a memory": "without", "without": "without"},
    ),
    "explored": Ways(
        "plans into a place that was explored, and without that",
        exploring,
        {"explored": "not explored", "not explored": "not explored"},
    ),
}
"""What is compared, by name."""


def table_of(rows: Sequence[Row], against: Mapping[str, str], by_family: bool = True) -> str:
    """Return a table: how often and how quickly each way solves, and its time as a part of that of another."""
    headings = ["family", "way", "solved", "wrong", "mean, ms", "median", "p95", "worst", "against", "its time", "p95"]
    cells = [[*headings, "families that it moves"]]
    families = list(dict.fromkeys(row.family for row in rows))
    for family in [*families * by_family, "all"]:
        own = {way: [row for row in rows if row.way == way and family in (row.family, "all")] for way in against}
        for way, found in own.items():
            if not found:
                continue
            spent = [1e3 * row.seconds for row in found]
            times = [fmean(spent), *np.quantile(spent, [0.5, 0.95, 1.0]).tolist()]
            pairs = [(a, b) for a, b in zip(own[against[way]], found, strict=False) if a.solved and b.solved]
            ratios = [b.seconds / a.seconds for a, b in pairs] or [np.nan]
            moved = [_moved(each, rows, way, against[way]) for each in families] if family == "all" else []
            cell = [
                family,
                way,
                f"{sum(row.solved for row in found)}/{len(found)}",
                str(sum(row.wrong for row in found)),
            ]
            cell += [*(f"{value:.3g}" for value in times), against[way], f"{median(ratios):.3f}"]
            cells.append([*cell, f"{float(np.quantile(ratios, 0.95)):.2f}", ", ".join(filter(None, moved))])
    return table(cells, words=True)


def _moved(family: str, rows: Sequence[Row], way: str, other: str) -> str:
    """How a way matters in a family: how many more places are lost with it, or how much longer 95 % take."""
    with_it, without = ([row for row in rows if (row.family, row.way) == (family, each)] for each in (way, other))
    lost = sum(row.solved for row in without) - sum(row.solved for row in with_it)
    if lost > LOST * len(without):
        return f"{family} ({lost} lost)"
    before, after = (float(np.quantile([row.seconds for row in own] or [0.0], 0.95)) for own in (without, with_it))
    return f"{family} (x {after / before:.1f})" if after - before > max(LEAST, LONGER * before) else ""


def _rows(name: str, seed: int, count: int, family: str) -> list[Row]:
    return list(WAYS[name].examined(family, seed, count))


def run(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="; ".join(f"{k}: {v.about}" for k, v in WAYS.items()) + ".")
    ],
    piece: Annotated[
        list[str] | None, typer.Option(metavar="FAMILY", help="Only this family, or a pattern; repeat for more.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Of the places.")] = 0,
    count: Annotated[int, typer.Option(help="Places, or targets in one place, of each family.")] = 60,
    alone: Alone = False,
    record: Record = None,
) -> None:
    """Compare ways to solve places, family by family; the exit code is 1 when a claim was wrong."""
    checks.choice("NAME", name, tuple(WAYS))
    checks.integer("--seed", seed, 0, 2**31 // 1000 - 1)
    checks.integer("--count", count, 1, 10_000)
    fitting = chosen(list(FAMILIES), piece or ["*"])
    work = partial(_rows, name, seed, count)
    families = [each for each in FAMILIES if each in fitting and (name == "ablation" or not FAMILIES[each].joints)]
    rows = [row for some in in_processes(work, families, alone=alone) for row in some]
    facts = {
        "seed": str(seed),
        "protocol": f"{count} places or targets of each family; CPU time of the thread; solved within {LIMIT:g} s",
    }
    give(f"ways {name}", facts, table_of(rows, WAYS[name].against, name != "ablation"), record)
    raise typer.Exit(int(any(row.wrong for row in rows)))
