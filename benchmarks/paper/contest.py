"""Methods that solve the same problems in turns, and what became of every answer once it was verified."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import islice, pairwise
from statistics import median
from time import perf_counter, thread_time
from typing import Any

import numpy as np

import sinuous as sn
from benchmarks.harness.experiment import Experiment, Findings, Piece
from benchmarks.harness.markdown import figure, span, table
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from benchmarks.judges.collisions import Body
from benchmarks.judges.judge import judge
from benchmarks.paper.entrants import Entrant, divide, roster
from benchmarks.problems import ProblemSet
from sinuous.answer.verification import Verification, verify
from sinuous.base.checks import Floats

BLOCK = 10
"""Problems that a method gets at a time: a minute in which the machine is slow is shared by all."""

WARM = 1
"""Solves before each block whose time does not count."""

STOLEN, TRIES = 1e-3, 3
"""Seconds without the processor from which on a solve is repeated, and how often it is tried: budgets are by the clock,
and a busy machine would let slow methods fail."""

Record = dict[str, Any]
"""Plain values of one solve, for the journal: see `Judge.record`."""

Records = dict[str, list[list[Record]]]
"""Of every method, the records of every piece."""


class Judge:
    """Verifies answers to one set of problems, by two codes that share nothing with the methods or with each other."""

    def __init__(self, problems: ProblemSet) -> None:
        self.problems = problems
        self._body = Body(problems.robot, problems.scene) if len(problems.scene) else None
        self._seen: dict[tuple[int, bytes], tuple[Verification, bool]] = {}

    def record(self, number: int, solution: sn.Solution, seconds: float) -> Record:
        """Judge the answer to problem `number`.

        Of the record, `right` says that `verify()` and the judges of the bench both found the targets met, the limits
        kept and the body clear; `claimed` is what the method says. Errors, `excess` (beyond the limits) and
        `clearance` are those that `verify()` computed.
        """
        key = number, solution.q.tobytes()
        if key not in self._seen:  # repeats give the same answers
            self._seen[key] = self._look(number, solution.q)
        found, confirmed = self._seen[key]
        return {
            "seconds": seconds,
            "claimed": solution.solved,
            "right": solution.solved and found.ok and confirmed,
            "position": found.position_error,
            "angle": found.angle_error,
            "excess": found.excess,
            "clearance": found.clearance,
            "iterations": solution.iterations,
            "starts": solution.starts,
            "start": solution.start,
        }

    def _look(self, number: int, q: Floats) -> tuple[Verification, bool]:
        p = self.problems
        found = verify(sn.Problem(p.robot, p.targets[number], p.scene, p.tolerance), q)
        return found, bool(judge(p.robot, [p.targets[number]], q[None], p.tolerance, self._body).right[0])


def solve_in_turns(
    entrants: Sequence[Entrant], problems: ProblemSet, *, seconds: float, seed: int
) -> dict[str, list[Record]]:
    """Let every method solve every problem from cold, a block at a time, each for at most `seconds`."""
    solvers = {entrant.label: entrant.solver(problems, seconds, seed) for entrant in entrants}
    judge_of = Judge(problems)
    records: dict[str, list[Record]] = {label: [] for label in solvers}
    for first in range(0, len(problems.targets), BLOCK):
        numbers = range(first, min(first + BLOCK, len(problems.targets)))
        for label, solver in solvers.items():
            timed = [_undisturbed(solver, problems.targets[i]) for i in [*[first] * WARM, *numbers]][WARM:]
            records[label] += [judge_of.record(i, *answer) for i, answer in zip(numbers, timed, strict=True)]
    return records


def _undisturbed(solver: sn.Solver, target: sn.Target, start: sn.Solution | None = None) -> tuple[sn.Solution, float]:
    """Solve, and take the time around the call; again where another process had the processor meanwhile."""
    for _ in range(TRIES):
        worked, began = thread_time(), perf_counter()
        solution = solver.solve(target, start)
        seconds = perf_counter() - began
        if seconds - (thread_time() - worked) < STOLEN:
            break
    return solution, seconds


def follow_in_turns(
    entrants: Sequence[Entrant], problems: ProblemSet, *, seconds: float, seed: int
) -> dict[str, list[Record]]:
    """Let every method follow the targets as a path, each from the last solved, some waypoints at a time in turns.

    Of the records, `motion` is how far the point of the backbone that moved most is from where it was at the confirmed
    waypoint before; `prepared`, of the first, the seconds that preparing the method for the scene took, once compiled.
    """
    prepared, found, tracks = dict[str, float](), dict[str, list[sn.Solution]](), dict[str, Iterator[sn.Solution]]()
    for entrant in entrants:
        entrant.solver(problems, seconds, seed)
        began = perf_counter()
        solver = entrant.solver(problems, seconds, seed)
        prepared[entrant.label], found[entrant.label] = perf_counter() - began, []
        tracks[entrant.label] = _follow(solver, problems.targets)
    for _ in range(0, len(problems.targets), BLOCK):
        for label, track in tracks.items():
            found[label].extend(islice(track, BLOCK))
    judge_of = Judge(problems)
    records = {label: _judge_track(judge_of, solutions) for label, solutions in found.items()}
    for label, own in records.items():
        own[0]["prepared"] = prepared[label]
    return records


def _follow(solver: sn.Solver, targets: Sequence[sn.Target]) -> Iterator[sn.Solution]:
    """Follow a path as `track` does, with an answer that does not count at the beginning of each block."""
    start: sn.Solution | None = None
    for i, target in enumerate(targets):
        if i % BLOCK == 0:
            for _ in range(WARM):
                solver.solve(target, start)
        solution, _ = _undisturbed(solver, target, start)
        start = solution if solution.solved else start
        yield solution


def _judge_track(judge_of: Judge, solutions: Sequence[sn.Solution]) -> list[Record]:
    records = [judge_of.record(i, one, one.seconds) for i, one in enumerate(solutions)]
    for i, j in pairwise([i for i, record in enumerate(records) if record["right"]]):
        before, after = judge_of.problems.robot.backbone(np.stack([solutions[i].q, solutions[j].q]), 4)
        records[j]["motion"] = float(np.linalg.norm(after - before, axis=-1).max())
    return records


def tally(records: Sequence[Record]) -> dict[str, Any]:
    """Sum up what became of many solves by one method, as plain values.

    Times, errors, iterations and how many needed the first start alone are those of the confirmed answers; of the
    others `limits`, `obstacle` and `target` count those outside a limit, touching, or off the target.
    """
    good, bad = ([record for record in records if record["right"] is right] for right in (True, False))
    outside = [record["excess"] > 1e-6 for record in bad]
    touching = [record["clearance"] is not None and record["clearance"] < 0.0 for record in bad]
    times = Times.of([record["seconds"] for record in good]) if good else Times(0, *[float("nan")] * 4)
    return {
        "runs": len(records),
        "right": len(good),
        "wrong": sum(record["claimed"] for record in bad),
        "percent": 100.0 * len(good) / len(records),
        "first": sum(record["starts"] <= 1 for record in good),
        **{key: getattr(times, key) for key in ("median", "p95", "worst")},
        **{
            key: median(record[key] for record in good) if good else float("nan")
            for key in ("iterations", "position", "angle")
        },
        "limits": sum(outside),
        "obstacle": sum(touching),
        "target": sum(not (out or touches) for out, touches in zip(outside, touching, strict=True)),
    }


HEADINGS = (
    "method", "solved", "", "from the first start", "median", "p95", "worst", "iterations", "position error",
    "angle error, rad", "limits", "obstacle", "target",
)  # fmt: skip

Column = Callable[[str, list[list[Record]]], str]
"""From a method, by its label, and its records of every piece to a cell of a table."""


def contest_table(found: Records, unable: Mapping[str, str], more: Mapping[str, Column]) -> str:
    """Return a row for each method, with more columns by their headings, and why some methods were not run."""
    rows = [[*HEADINGS, *more]]
    for label, pieces in found.items():
        own = tally([record for piece in pieces for record in piece])
        cells = [
            *(label, f"{own['right']}/{own['runs']}", f"{own['percent']:.1f} %", str(own["first"])),
            *(span(own[key]) for key in ("median", "p95", "worst")),
            *(figure(own["iterations"]), figure(own["position"], ".2g"), figure(own["angle"], ".2g")),
            *(str(own[key] or "") for key in ("limits", "obstacle", "target")),
        ]
        rows.append([*cells, *(column(label, pieces) for column in more.values())])
    reasons = " ".join(f"`{label}` {reason}." for label, reason in unable.items())
    return table(rows) + (f"\n\nNot run: {reasons}" if reasons else "")


class Contest(Experiment):
    """An experiment of groups of problems, which methods solve in turns; see `Experiment`.

    Parameters
    ----------
    plan : Plan
    entrants : sequence of Entrant
    """

    about = ""
    """What is said before the tables."""

    columns: Mapping[str, Column] = {}
    """More columns of the tables, by their headings."""

    def __init__(self, plan: Plan, entrants: Sequence[Entrant]) -> None:
        self.plan = plan
        self.entrants = entrants

    def groups(self) -> Mapping[str, tuple[str, int]]:
        """Return a heading, and the number of pieces, of every group."""
        raise NotImplementedError

    def problems(self, group: str, number: int) -> ProblemSet:
        """Return the problems of one piece."""
        raise NotImplementedError

    def solve(self, entrants: Sequence[Entrant], problems: ProblemSet) -> dict[str, list[Record]]:
        """Let methods solve the problems of one piece."""
        raise NotImplementedError

    def pictures(self, found: Mapping[str, Records]) -> dict[str, Any]:
        """Draw what was found, by names of files; nothing by default."""
        return {}

    def settings(self) -> dict[str, Any]:
        """Return what the figures depend on."""
        sizes = {group: count for group, (_, count) in self.groups().items()}
        return {"methods": [entrant.label for entrant in self.entrants], "pieces": sizes}

    def pieces(self) -> Iterable[Piece]:
        """Return the first piece of every group, then the second."""
        groups = self.groups()
        for number in range(max(count for _, count in groups.values())):
            for group, (_, count) in groups.items():
                if number < count:
                    yield f"{group}: {number}", partial(self._measure, group, number)

    def _measure(self, group: str, number: int) -> dict[str, list[Record]]:
        problems = self.problems(group, number)
        return self.solve(divide(self.entrants, problems)[0], problems)

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Sum up group by group and method by method."""
        found, unable, text = dict[str, Records](), dict[str, dict[str, str]](), list[str]()
        for group, (words, count) in self.groups().items():
            able, unable[group] = divide(self.entrants, self.problems(group, 0))
            own = [pieces[f"{group}: {number}"] for number in range(count)]
            found[group] = {each.label: [piece[each.label] for piece in own] for each in able}
            text += [f"## {words}", contest_table(found[group], unable[group], self.columns)]
        drawn = self.pictures(found)
        shown = [f"![{name.replace('_', ' ')}]({name}.png)" for name in drawn]
        everywhere = set.intersection(*(set(each.items()) for each in unable.values()))
        text = [self.about, *shown, *text, "## Methods", roster(self.entrants, dict(everywhere))]
        records = {
            group: {label: [record for piece in own for record in piece] for label, own in each.items()}
            for group, each in found.items()
        }
        data = {group: {label: tally(own) for label, own in each.items()} for group, each in records.items()}
        wrong = sum(own["wrong"] for each in data.values() for own in each.values())
        return Findings(text="\n\n".join(text), data={"found": data, "not_run": unable}, pictures=drawn, wrong=wrong)
