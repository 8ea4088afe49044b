"""`clutter`: intricate places, each known to be possible; `worlds`: very many small ones; `places`: one place again.

Every place was made around a hidden shape that reaches its target, so neither "impossible" nor silence is excused.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Annotated

import typer

import sinuous as sn
from benchmarks.harness import Experiment, Line, Plan, Trial, divided, missed, number, refuted, solved_within, timed
from benchmarks.judges.judge import IMPOSSIBLE
from benchmarks.places import FAMILIES, make
from benchmarks.places.place import right
from sinuous.base import checks
from sinuous.solver.solver import Solver

COUNT, QUICK, TOGETHER = 60, 2, 20
"""Places of a family: three times all robots; in a quick run; and of one share, which an interrupt costs."""

PUBLISHED, PUBLISHED_QUICK, PUBLISHED_TOGETHER = 400, 8, 50
"""The same of a published protocol: a hundred in each of its four scenes."""

SMALL = "small world"
WORLDS, WORLDS_QUICK, WORLDS_TOGETHER = 100_000, 200, 1000
"""The same of small worlds, made to find false claims that are rare."""

SOLVED = "solved and proved within 1 s, and found right by the judges"
JUDGING = f"kinds that judge only: {SOLVED}"
ALL = f"all: {SOLVED}"
FALSE = 'wrong claims: "solved" where a judge disagrees, or "impossible" where there is the hidden shape'

MEDIAN, TAIL, WORST = 5e-3, 50e-3, 1.0
"""Wanted of the times of a family, seconds: in the median, of 95 %, and at worst."""

PUBLISHED_MEDIAN, NARROW_MEDIAN = 200e-6, 10e-3
"""Wanted of the median of published protocols, and where a pipe is 1.3 times as wide as the body, seconds."""

LIMIT = 1.0
"""Seconds after which an answer comes too late."""

COUNTED = (
    f"budget {LIMIT:g} s; timed is the second of two calls of solve, in a process that keeps to one core; counted is "
    "what says solved within the budget and the judges find right"
)


def clutter(plan: Plan) -> Experiment:
    """Measure every family, some places a share."""
    parts = {}
    for family, own in FAMILIES.items():
        sizes = (PUBLISHED, PUBLISHED_QUICK) if own.published else (COUNT, QUICK)
        first = 1000 * plan.seed
        seeds = range(first, first + plan.count(*sizes))
        together = PUBLISHED_TOGETHER if own.published else TOGETHER
        parts[family] = divided(plan, partial(examine, family), seeds, together, partial(lines_of, family))
    protocol = (
        f"place i of a family is benchmarks.places.make(family, 1000 * seed + i), i below {COUNT} ({PUBLISHED} for p3 "
        "and p4); constants may be tuned on even numbers below 1000 only, and on no place of a judging kind, so every "
        f"seed but 0 judges; {COUNTED}"
    )
    return Experiment("clutter", plan, parts, protocol, total_of)


def worlds(plan: Plan) -> Experiment:
    """Measure small worlds; world i has the number `WORLDS * seed + i`."""
    first = WORLDS * plan.seed
    seeds = range(first, first + plan.count(WORLDS, WORLDS_QUICK))
    protocol = f"world i is benchmarks.places.make({SMALL!r}, {WORLDS} * seed + i); {COUNTED}"
    part = divided(plan, partial(examine, SMALL), seeds, WORLDS_TOGETHER, partial(lines_of, SMALL))
    return Experiment("worlds", plan, {SMALL: part}, protocol, total_of)


def examine(family: str, seed: int) -> Trial:
    """Make a place and solve it."""
    place = make(family, seed)
    solver = Solver(place.robot, place.scene, tolerance=place.tolerance)
    solver.solve(place.targets)
    solution, seconds = timed(solver.solve, place.targets)
    if solution.solved:
        wrong = "refuted" * (not right(place, solution.configuration))
    else:
        wrong = "impossible" * (solution.status in IMPOSSIBLE)
    return Trial(seed, seconds, str(solution.status), wrong, solution.start)


def lines_of(family: str, trials: Sequence[Trial]) -> Iterator[Line]:
    """Sum up one family: what is solved, which places are not, and which times are longer than was wanted."""
    own = FAMILIES[family]
    section, share = JUDGING if own.judging else SOLVED, 100.0 if own.published else 99.0
    line = solved_within(LIMIT, section, family, trials, share)
    assert line.times is not None
    median = PUBLISHED_MEDIAN if own.published else NARROW_MEDIAN if "1.3" in family else MEDIAN
    wanted = {"median": median, "p95": TAIL, "worst": WORST}
    late = [f"{name} over {number(most, 'ms')}" for name, most in wanted.items() if getattr(line.times, name) > most]
    failed = missed(trials, LIMIT)
    yield replace(line, note="; ".join([*late, *([f"not solved: {failed}"] if failed else [])]))


def total_of(found: Mapping[str, Sequence[Trial]]) -> Iterator[Line]:
    """Sum up all families, and count wrong claims."""
    if len(found) > 1:
        yield solved_within(LIMIT, ALL, f"{len(found)} families", list(chain.from_iterable(found.values())), 99.0)
    yield refuted(FALSE, "all", found)


def run(
    family: Annotated[str, typer.Argument(metavar="FAMILY", help="Like 'pipe 1.3'.")],
    seed: Annotated[int, typer.Argument(metavar="NUMBER", help="The seed that a run says.")] = 0,
    picture: Annotated[Path | None, typer.Option(metavar="FILE", help="Draw it: place.png.")] = None,
) -> None:
    """Solve one place again and judge it; the exit code is 1 when it is not solved."""
    checks.choice("FAMILY", family, tuple(FAMILIES))
    checks.integer("NUMBER", seed, 0, 2**31 - 1)
    ours = examine(family, seed)
    solved = ours.good(math.inf)
    verdict = "right" if solved else "WRONG" if ours.wrong else "not right"
    won, took = f" by {ours.start}" * solved, f"{1e3 * ours.seconds:.3g} ms"
    typer.echo(f"{family}: {FAMILIES[family].words}")
    typer.echo(f"place {seed}: {ours.status}{won} in {took}; the judge finds it {verdict}")
    if picture is not None:
        place = make(family, seed)
        sn.plot(sn.solve(place.robot, place.targets, place.scene, tolerance=place.tolerance), path=picture)
    raise typer.Exit(0 if solved else 1)
