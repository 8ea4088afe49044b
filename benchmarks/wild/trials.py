"""Wild worlds solved problem by problem: every claim is held against judges, and against the hidden solutions."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

import sinuous as sn
from benchmarks.harness.lines import Goal, Line, Times
from benchmarks.judges.bodies import measured_body, needed_body, self_body
from benchmarks.judges.clearances import GRACE, Clearances
from benchmarks.judges.judge import IMPOSSIBLE, ROUNDING, Flags, target_errors, within_limits
from benchmarks.judges.self_collision import look
from benchmarks.wild.worlds import LIMIT, World, standing
from sinuous.base.checks import Floats
from sinuous.statics.rest import bodies_at

TARGET, LIMITS, OVERLAP, SELF_OVERLAP = "target missed", "limits", "overlap", "overlap with itself"
DEMAND, REST = "less clearance than is demanded", "no equilibrium"
CLEARANCE, SELF_CLEARANCE = "clearance overstated", "self-clearance overstated"

EXCEPTION = "exception"

QUICK = 0.3
"""Seconds within which most should be solved."""

MANY, UNIT = 100_000, "of 100,000"
"""What counts are relative to."""

SHOWN = 40
"""Most names of problems in a note."""


@dataclass(frozen=True)
class Trial:
    """What came of one problem.

    Attributes
    ----------
    status : str
    seconds : float
        Around the call.
    false : tuple of str
        Kinds of false claims: of what is called solved, words for what is not, and a call that ended in no answer.
    """

    status: str
    seconds: float
    false: tuple[str, ...] = ()

    @property
    def solved(self) -> bool:
        """Whether it says so, and nothing of it is false."""
        return self.status == sn.Status.SOLVED and not self.false


class Judged(NamedTuple):
    """What came of one motion, or call: whether it is called proved, or ended in an answer; and what is false of it."""

    good: bool
    false: str


def solutions_of(world: World) -> tuple[list[sn.Solution | Exception], list[float]]:
    """Solve all problems, one by one, with the defaults of a user; how long each took, in seconds."""
    solver = sn.Solver(world.robot, world.scene, tolerance=world.tolerance, time=world.time)
    solutions: list[sn.Solution | Exception] = []
    seconds = []
    for targets in world.targets:
        began = perf_counter()
        try:
            solutions.append(solver.solve(targets))
        except Exception as error:  # whatever it is, it is counted
            solutions.append(error)
        seconds.append(perf_counter() - began)
    return solutions, seconds


def examine(world: World) -> list[Trial]:
    """Solve all problems of a world, and judge all claims."""
    found, seconds = solutions_of(world)
    false = refuted(world, {i: each for i, each in enumerate(found) if isinstance(each, sn.Solution)})
    return [
        Trial(str(each.status), seconds[i], false[i])
        if isinstance(each, sn.Solution)
        else Trial(EXCEPTION, seconds[i], (EXCEPTION,))
        for i, each in enumerate(found)
    ]


def refuted(world: World, solutions: Mapping[int, sn.Solution]) -> dict[int, tuple[str, ...]]:
    """What is false of solutions of some problems, by their numbers."""
    false: dict[int, tuple[str, ...]] = {
        i: (str(each.status),) if world.possible and each.status in IMPOSSIBLE else () for i, each in solutions.items()
    }
    claims = {i: each for i, each in solutions.items() if each.solved}
    if claims:
        wrong = _wrong(world, claims)
        false |= {i: tuple(kind for kind, where in wrong.items() if where[at]) for at, i in enumerate(claims)}
    return false


def _wrong(world: World, claims: Mapping[int, sn.Solution]) -> dict[str, Flags]:
    """Where solutions that are called solved are wrong, kind by kind; of a robot under load its body at rest counts."""
    robot, q = world.robot, np.array([each.configuration for each in claims.values()])
    slack, demanded = GRACE * robot.mean_length, np.zeros(len(q), bool)
    found = {LIMITS: ~within_limits(robot, q)}
    if world.loaded:
        found[REST] = ~standing(robot, q)
        if found[REST].any():
            return found
        shapes = [robot.shape(one) for one in q]
        met = [_at_targets(world, [i], each.body, each.arcs[None])[0] for i, each in zip(claims, shapes, strict=True)]
        found[TARGET] = ~np.array(met)
        robot, q = bodies_at(robot, q)
    else:
        found[TARGET] = ~_at_targets(world, list(claims), robot, q)
    if len(world.scene):
        scene, said = world.truth or world.scene, _said(claims, "clearance")
        gaps = Clearances(measured_body(robot), scene).least(q, max(0.0, float(np.nan_to_num(said).max())))
        found |= {OVERLAP: gaps < -slack, CLEARANCE: said > gaps + slack}
        if np.any(robot.clearance):
            demanded |= Clearances(needed_body(robot), scene).least(q, 0.0) < -slack
    gaps, thick = look(robot, q, 0.0).least, self_body(robot)
    left = gaps if thick is robot else look(thick, q, 0.0).least
    found |= {SELF_OVERLAP: gaps < -slack, DEMAND: demanded | (left < -slack)}
    most = left + float(np.min(robot.self_clearance)) + slack
    return found | {SELF_CLEARANCE: _said(claims, "self_clearance") > most}


def _said(claims: Mapping[int, sn.Solution], name: str) -> Floats:
    """A bound that every solution claims; NaN where it claims none."""
    values = [getattr(solution, name, None) for solution in claims.values()]
    return np.array([np.nan if value is None else value for value in values], np.float64)


def _at_targets(world: World, problems: list[int], robot: Any, q: Floats) -> Flags:
    """Whether the shapes of a body meet all targets of these problems."""
    tolerance = world.tolerance
    good = np.ones(len(q), bool)
    for targets in zip(*(world.targets[i] for i in problems), strict=True):
        position, angle = target_errors(robot, targets, q)
        good &= position <= (tolerance.position or 0.0) + ROUNDING * robot.longest
        good &= angle <= tolerance.angle + ROUNDING
    return good


def tallied(make: Callable[[int], World], numbers: range) -> list[tuple[str, Trial]]:
    """Solve and judge worlds; return names of problems, and what came of them."""
    examine(make(numbers[0]))  # loads what is compiled, which nobody's time should count
    return [(f"{number}.{i}", trial) for number in numbers for i, trial in enumerate(examine(make(number)))]


def lines_of(section: str, what: str, most: float, shares: Sequence[Sequence[tuple[str, Trial]]]) -> Iterator[Line]:
    """Sum up worlds: how many problems are not solved in time, at most so many of `MANY`, and false claims."""
    trials = [each for share in shares for each in share]
    count, times = len(trials), Times.of([trial.seconds for _, trial in trials])
    for limit, goal in ((LIMIT, Goal(most)), (QUICK, None)):
        names = [f"{name} {one.status}" for name, one in trials if not one.solved or one.seconds > limit]
        told, solved = f"{what}, not solved and found right by the judges within {limit:g} s", count - len(names)
        yield Line(section, told, MANY * len(names) / count, UNIT, goal, times, (solved, count), named(names))
    false = [f"{name} {kind}" for name, trial in trials for kind in trial.false]
    yield Line(section, f"{what}, false claims", len(false), "", Goal(0, correctness=True), note=named(false))


def lines_of_judged(
    section: str, kind: str, good: str, false: str, shares: Sequence[Sequence[Judged]]
) -> Iterator[Line]:
    """Sum up motions or calls of one kind: how many are good, and which false."""
    judged = [each for share in shares for each in share]
    count = sum(each.good for each in judged)
    wrong = [f"{i}: {each.false}" for i, each in enumerate(judged) if each.false]
    yield Line(section, f"{kind}: {good}", 100.0 * count / len(judged), "%", None, None, (count, len(judged)))
    yield Line(section, f"{kind}: {false}", len(wrong), "", Goal(0, correctness=True), note=named(wrong))


def named(names: Sequence[str]) -> str:
    """Say the first names."""
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return f"problems: {', '.join(names[:SHOWN])}{more}" if names else ""
