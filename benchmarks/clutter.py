"""`clutter`: intricate places, each known to be possible; `worlds`: very many small ones; `places`: one place again.

Every place was made around a hidden shape that reaches its target, so neither "impossible" nor silence is excused.
"""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

import sinuous as sn
from benchmarks.harness import Divided, Experiment, Goal, Line, Plan, Times, Trial, in_processes, timed
from benchmarks.judges.judge import IMPOSSIBLE
from benchmarks.places import FAMILIES, make
from benchmarks.places.place import right
from sinuous.base import checks
from sinuous.solver.options import read_without
from sinuous.solver.solver import Solver

COUNT, QUICK, TOGETHER = 60, 2, 20
"""Places of a family: three times all robots; in a quick run; and of one share, which an interrupt costs."""

PUBLISHED, PUBLISHED_QUICK, PUBLISHED_TOGETHER = 400, 8, 50
"""The same of a published protocol: a hundred in each of its four scenes."""

SMALL = "small world"
WORLDS, WORLDS_QUICK, WORLDS_TOGETHER = 100_000, 200, 1000
"""The same of small worlds, made to find false claims that are rare."""

SOLVED = "solved and proved within 1 s, and found right by the judges"
FALSE = 'wrong claims: "solved" where a judge disagrees, or "impossible" where there is the hidden shape'
MEDIAN = "median time (one core, warm)"
TAIL = "time that 95 % of the solves keep within"
WORST = "worst time"

NARROW = 10e-3
"""Goal of the median where a pipe is 1.3 times as wide as the body, seconds."""

CHUNK = 5
"""Places that a process gets at a time."""

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
        parts[family] = divided(plan, family, seeds, PUBLISHED_TOGETHER if own.published else TOGETHER, off)
    protocol = (
        f"place i of a family is benchmarks.places.make(family, 1000 * seed + i), i below {COUNT} ({PUBLISHED} for p3 "
        "and p4); constants may be tuned on even numbers below 1000 only, and on no place of a judging kind, so every "
        f"seed but 0 judges; {COUNTED}"
    )
    settings = {"without": ",".join(off)} if off else {}
    return Experiment("clutter", plan, parts, protocol, settings)


def worlds(plan: Plan) -> Experiment:
    """Measure small worlds; world i has the number `WORLDS * seed + i`."""
    first = WORLDS * plan.seed
    seeds = range(first, first + plan.count(WORLDS, WORLDS_QUICK))
    protocol = f"world i is benchmarks.places.make({SMALL!r}, {WORLDS} * seed + i); {COUNTED}"
    return Experiment("worlds", plan, {SMALL: divided(plan, SMALL, seeds, WORLDS_TOGETHER)}, protocol)


def divided(plan: Plan, family: str, seeds: range, together: int, without: tuple[str, ...] = ()) -> Divided:
    """Return places of one family, some at a time, and what sums them up."""
    shares = [
        partial(tried, plan.quick, family, seeds[i : i + together], without) for i in range(0, len(seeds), together)
    ]
    return Divided(shares, partial(lines_of, family))


def tried(alone: bool, family: str, seeds: range, without: tuple[str, ...]) -> list[Trial]:
    """Try some places, each in a process that has a core of its own, or (`alone`) in this one."""
    return list(in_processes(partial(examine, family, without=without), seeds, alone, CHUNK))


def examine(family: str, seed: int, without: tuple[str, ...] = ()) -> Trial:
    """Make a place and solve it; attempts of the solver may be switched off."""
    place = make(family, seed)
    solver = Solver(place.robot, place.scene, tolerance=place.tolerance, without=without)
    solver.solve(place.targets)
    solution, seconds = timed(solver.solve, place.targets)
    if solution.solved:
        wrong = "refuted" * (not right(place, solution.configuration))
    else:
        wrong = "impossible" * (solution.status in IMPOSSIBLE)
    return Trial(seed, seconds, str(solution.status), wrong, solution.start)


def lines_of(family: str, shares: Sequence[Sequence[Trial]]) -> Iterator[Line]:
    """Summarise one family: every family on the same lines, so that they can be compared."""
    own, trials = FAMILIES[family], [trial for share in shares for trial in share]
    times = Times.of([trial.seconds for trial in trials])
    failed = [trial for trial in trials if not trial.good(LIMIT)]
    good, goal = len(trials) - len(failed), Goal(100.0 if own.published else 99.0, at_most=False)
    won = Counter(trial.start for trial in trials if trial.good(math.inf)).most_common()
    winners = "won by " + (", ".join(f"{kind} {count}" for kind, count in won) or "none")
    note = "; ".join([own.words + " (judging only)" * own.judging, winners, *_listed("not solved", failed)])
    yield Line(SOLVED, family, 100.0 * good / len(trials), "%", goal, times, (good, len(trials)), note)
    wrong = [trial for trial in trials if trial.wrong]
    yield Line(FALSE, family, len(wrong), "", Goal(0, correctness=True), note="; ".join(_listed("wrong", wrong)))
    fast = Goal(200e-6 if own.published else NARROW if "1.3" in family else 5e-3)
    yield Line(MEDIAN, family, times.median, "ms", fast)
    yield Line(TAIL, family, times.p95, "ms", Goal(50e-3))
    yield Line(WORST, family, times.worst, "ms", Goal(LIMIT))


def _listed(what: str, trials: list[Trial]) -> list[str]:
    """Seeds and statuses, to begin a search with; nothing when there are none."""
    listed = ", ".join(f"{trial.number} ({trial.status})" for trial in trials[:SHOWN])
    return [f"{what}: seeds {listed}{' ...' * (len(trials) > SHOWN)}"] if trials else []


def run(
    family: Annotated[str, typer.Argument(metavar="FAMILY", help="Like 'pipe 1.3'.")],
    number: Annotated[int, typer.Argument(metavar="NUMBER", help="The seed that a run says.")] = 0,
    picture: Annotated[Path | None, typer.Option(metavar="FILE", help="Draw it: place.png.")] = None,
) -> None:
    """Solve one place again and judge it; the exit code is 1 when it is not solved."""
    checks.choice("FAMILY", family, tuple(FAMILIES))
    checks.integer("NUMBER", number, 0, 2**31 - 1)
    ours = examine(family, number)
    solved = ours.good(math.inf)
    verdict = "right" if solved else "WRONG" if ours.wrong else "not right"
    won = f" by {ours.start}" * solved
    typer.echo(f"{family}, {number}: {ours.status}{won} in {1e3 * ours.seconds:.3g} ms; the judge finds it {verdict}")
    if picture is not None:
        place = make(family, number)
        sn.plot(sn.solve(place.robot, place.targets, place.scene, tolerance=place.tolerance), path=picture)
    raise typer.Exit(0 if solved else 1)
