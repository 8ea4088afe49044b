"""`table1`, `tracking`, `segments`, `methods`: the methods of the literature on the same problems, in turns.

The first three are the experiments of the paper (Sun & Wang); the last has random problems that can be solved.
An answer counts where `verify()` and the judges of the benchmarks both find the targets met, the limits kept and the
body clear. Times and errors are those of such answers.
"""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from itertools import islice, pairwise
from statistics import median
from time import perf_counter, thread_time
from typing import Any, NamedTuple

import numpy as np

import sinuous as sn
from benchmarks.harness import Divided, Experiment, Goal, Line, Plan, Times, number
from benchmarks.judges.judge import Flags, right
from benchmarks.problems import (
    FREE_BEND,
    PAPER_POSES,
    PAPER_TOLERANCE,
    PATH_LENGTH,
    WAYPOINTS,
    ProblemSet,
    among_spheres,
    arm,
    path_through,
    random_configurations,
    tip_targets,
)
from sinuous.answer.verification import Verification, verify
from sinuous.base.checks import Floats
from sinuous.files.nouns import read_robot
from sinuous.methods.learned import Learned, Network, train
from sinuous.methods.method import METHODS, capabilities, name_of
from sinuous.methods.opti_path.options import OptiPath

FAITHFUL, DIFFERENCES = "opti_path, faithful", "opti_path, differences"
"""Labels of `OptiPath.faithful()`, and of the repaired method with the gradient of the paper."""


@dataclass(frozen=True)
class Entrant:
    """A method that takes part.

    Attributes
    ----------
    label : str
        Its name in tables.
    method : str or options
        What `Solver` takes as `method`.
    tolerance : Tolerance, optional
        What it aims for, where that is more than the problems ask for.
    """

    label: str
    method: Any
    tolerance: sn.Tolerance | None = None

    def solver(self, problems: ProblemSet, seconds: float, seed: int) -> sn.Solver:
        """Prepare it, to spend at most `seconds` on a solve."""
        method, scene = self.method, problems.scene
        if isinstance(method, Learned):
            network = _trained(json.dumps(problems.robot.to_dict()), scene if len(scene) else None)
            method = replace(method, network=network)
        tolerance = self.tolerance or problems.tolerance
        return sn.Solver(problems.robot, scene, tolerance=tolerance, method=method, time=seconds, seed=seed)

    def refusal(self, problems: ProblemSet) -> str:
        """Say what of these problems the method does not handle; empty when it takes part.

        Limits are no reason: an answer that violates one counts as a failure.
        """
        can, name = capabilities(self.method), name_of(self.method)
        if len(problems.scene) and not (can.obstacles or isinstance(self.method, Learned)):
            return "does not avoid obstacles"
        problem = sn.Problem(problems.robot, problems.targets[0], problems.scene, problems.tolerance)
        try:
            can.refuse_robot(name, problems.robot)
            can.refuse_targets(name, problem.rows, len(problems.robot))
        except sn.InputError as error:
            return f"{error.key}: takes {error.expected}"
        return ""


@lru_cache(32)
def _trained(robot: str, scene: sn.Scene | None) -> Network:
    """What was learned of a robot, given as JSON, in a scene, for all that take part."""
    return train(read_robot(json.loads(robot)), scene)


def entrants() -> list[Entrant]:
    """Return all methods; after `opti_path` what the paper says, after `learned` its network with one step and none."""
    own: dict[str, list[Entrant]] = {
        "opti_path": [Entrant("opti_path", "opti_path"), Entrant(FAITHFUL, OptiPath.faithful())],
        "learned": [
            Entrant("learned", Learned()),
            Entrant("learned, one step", Learned(steps=1)),
            Entrant("learned, alone", Learned(steps=0)),
        ],
    }
    return [each for name in METHODS for each in own.get(name, [Entrant(name, name)])]


BLOCK = 10
"""Problems that a method gets at a time: a minute in which the machine is slow is shared by all."""

STOLEN, TRIES = 1e-3, 3
"""Seconds without the processor from which on a solve is repeated, and how often it is tried: budgets are by the clock,
and a busy machine would let slow methods fail."""

Record = dict[str, Any]
"""Plain values of one solve, for the journal: see `Judge.record`."""

Solve = Callable[[Sequence[Entrant], ProblemSet], dict[str, list[Record]]]
"""From methods and problems to the records of each method, by its label."""


class Judge:
    """Verifies answers to one set of problems, by two codes that share nothing with the methods or with each other."""

    def __init__(self, problems: ProblemSet) -> None:
        self.problems = problems
        self._seen: dict[tuple[int, bytes], tuple[Verification, Flags]] = {}

    def record(self, number: int, solution: sn.Solution, seconds: float) -> Record:
        """Judge the answer to problem `number`.

        Of the record, `right` says that `verify()` and the judges both confirm it; `claimed` is what the method says.
        Errors, `excess` (beyond the limits) and `clearance` are those that `verify()` computed.
        """
        key = number, solution.q.tobytes()
        if key not in self._seen:  # repeats give the same answers
            p = self.problems
            problem = sn.Problem(p.robot, p.targets[number], p.scene, p.tolerance)
            confirmed = right(p.robot, [p.targets[number]], solution.q[None], p.tolerance, p.scene)
            self._seen[key] = verify(problem, solution.q), confirmed
        found, confirmed = self._seen[key]
        return {
            "seconds": seconds,
            "claimed": solution.solved,
            "right": bool(solution.solved and found.ok and confirmed[0]),
            "position": found.position_error,
            "angle": found.angle_error,
            "excess": found.excess,
            "clearance": found.clearance,
            "iterations": solution.iterations,
            "starts": solution.starts,
            "start": solution.start,
        }


def solve_in_turns(
    able: Sequence[Entrant], problems: ProblemSet, *, seconds: float, seed: int, along: bool = False
) -> dict[str, list[Record]]:
    """Let every method solve every problem, a block at a time in turns, each for at most `seconds`.

    From cold, or `along` the targets as a path, each from the last solved. Then, of the records, `motion` is how far
    the point of the backbone that moved most is from where it was at the confirmed waypoint before.
    """
    judge = Judge(problems)
    answers = {each.label: _answers(each.solver(problems, seconds, seed), problems.targets, along) for each in able}
    records: dict[str, list[Record]] = {label: [] for label in answers}
    shapes: dict[str, list[Floats]] = {label: [] for label in answers}
    for first in range(0, len(problems.targets), BLOCK):
        for label, own in answers.items():
            for i, (solution, spent) in enumerate(list(islice(own, BLOCK)), first):
                records[label].append(judge.record(i, solution, spent))
                shapes[label].append(solution.q)
    for label, judged in records.items() if along else ():
        for i, j in pairwise([i for i, record in enumerate(judged) if record["right"]]):
            before, after = problems.robot.backbone(np.stack([shapes[label][i], shapes[label][j]]), 4)
            judged[j]["motion"] = float(np.linalg.norm(after - before, axis=-1).max())
    return records


def _answers(solver: sn.Solver, targets: Sequence[sn.Target], along: bool) -> Iterator[tuple[sn.Solution, float]]:
    """Solve, and take the time around the call; again where another process had the processor meanwhile.

    At the beginning of each block comes an answer that does not count. A path is followed as `track` does.
    """
    start: sn.Solution | None = None
    for i, target in enumerate(targets):
        if i % BLOCK == 0:
            solver.solve(target, start)
        for _ in range(TRIES):
            worked, began = thread_time(), perf_counter()
            solution = solver.solve(target, start)
            seconds = perf_counter() - began
            if seconds - (thread_time() - worked) < STOLEN:
                break
        start = solution if along and solution.solved else start
        yield solution, seconds


def share(everyone: Sequence[Entrant], problems: Callable[[], ProblemSet], solve: Solve) -> list[dict[str, Any]]:
    """Let those that can solve some problems; list their records, and why the others do not take part."""
    asked = problems()
    refused = {entrant.label: entrant.refusal(asked) for entrant in everyone}
    able = [entrant for entrant in everyone if not refused[entrant.label]]
    return [{"records": solve(able, asked), "refused": {label: why for label, why in refused.items() if why}}]


def lines_of(
    section: str,
    shares: Sequence[Mapping[str, Any]],
    told: Callable[[str, list[Record]], str] = lambda _label, _records: "",
) -> Iterator[Line]:
    """Sum up one set of problems: a line for each method, then how many claims were wrong.

    `told` says more of a method, from its label and its records.
    """
    wrong = 0
    for label in dict.fromkeys(label for each in shares for label in each["records"]):
        records = [record for each in shares for record in each["records"].get(label, [])]
        good, bad = ([record for record in records if record["right"] is right] for right in (True, False))
        wrong += sum(record["claimed"] for record in bad)
        times = Times.of([record["seconds"] for record in good]) if good else None
        note = "; ".join(filter(None, [told(label, records), _note(good, bad)]))
        yield Line(section, label, 100.0 * len(good) / len(records), "%", None, times, (len(good), len(records)), note)
    refused = {label: why for each in shares for label, why in each["refused"].items()}
    note = "not run: " + "; ".join(f"{label} {why}" for label, why in refused.items()) if refused else ""
    yield Line(section, 'wrong claims of "solved"', wrong, "", Goal(0, correctness=True), note=note)


def _note(good: Sequence[Record], bad: Sequence[Record]) -> str:
    """Medians of what is confirmed, and what is wrong with the rest."""
    outside = [record["excess"] > 1e-6 for record in bad]
    touching = [record["clearance"] is not None and record["clearance"] < 0.0 for record in bad]
    off = sum(not (out or touches) for out, touches in zip(outside, touching, strict=True))
    counts = {"outside limits": sum(outside), "touching": sum(touching), "off the target": off}
    failed = [f"{count} {what}" for what, count in counts.items() if count]
    if not good:
        return ", ".join(failed)
    steps, position, angle = (median(record[key] for record in good) for key in ("iterations", "position", "angle"))
    first = sum(record["starts"] <= 1 for record in good)
    middle = f"{steps:g} iterations, off by {position:.2g} and {angle:.2g} rad, {first} from the first start"
    return ", ".join([middle, *failed])


PAPER_BUDGET = 0.1
"""Seconds of one solve of a pose, or of one waypoint, with all its initial configurations."""

REPEATS, BLOCKS = 10, 10
"""Solves of a pose in one share, and shares."""

PUBLISHED = {
    ("A", "fabrikc"): "183 ms, 0.863 mm, 0 rad",
    ("A", "dls"): "112 ms, 4.52 mm, 0.85 rad",
    ("A", "slinki"): "12.2 ms, 0.766 mm, 0 rad",
    ("A", FAITHFUL): "16.9 ms, 0 mm, 0.014 rad",
    ("B", "fabrikc"): "206 ms, 0.775 mm, 0 rad",
    ("B", "dls"): "124 ms, 0 mm, 0 rad",
    ("B", "slinki"): "11.8 ms, 0.632 mm, 0 rad",
    ("B", FAITHFUL): "2.80 ms, 0 mm, 0.017 rad",
    ("C", FAITHFUL): "15.9 ms",
    ("D", FAITHFUL): "172 ms",
}
"""By pose, and by the method here that is nearest: exFABRIKc as `fabrikc`, Opti.DLS as `dls`, Opti.path as what we
read in the paper; on the authors' machine."""


def table1(plan: Plan) -> Experiment:
    """The paper's four poses, every method, beside what the paper publishes. A part is a pose."""
    everyone = entrants()
    everyone.insert(1, Entrant("newton, to 1e-6", "newton", sn.Tolerance(1e-6, 1e-6)))
    solve = partial(solve_in_turns, seconds=PAPER_BUDGET, seed=plan.seed)
    repeats, count = plan.count(REPEATS, 2), plan.count(BLOCKS, 1)
    parts = {}
    for pose, (position, direction) in PAPER_POSES.items():
        target = sn.Target(position, direction=direction)
        problems = ProblemSet(arm(5, FREE_BEND), [target] * repeats, sn.Scene(), PAPER_TOLERANCE)
        work = partial(share, everyone, partial(replace, problems), solve)
        heading = f"pose {pose}: position {position} mm, direction {direction}"
        parts[pose] = Divided([work] * count, partial(lines_of, heading, told=partial(_published, pose)))
    protocol = f"five segments, no obstacles, to {PAPER_TOLERANCE.position:g} mm and {PAPER_TOLERANCE.angle} rad"
    return Experiment("table1", plan, parts, f"{protocol}, from cold, at most {1e3 * PAPER_BUDGET:g} ms a solve")


def _published(pose: str, label: str, _: list[Record]) -> str:
    return f"published {PUBLISHED[pose, label]}" if (pose, label) in PUBLISHED else ""


SEGMENTS = 8
SCENES = {10: 2, 20: 2, 40: 2, 70: 12}
"""Scenes of paths by their number of spheres."""

JUMP = 0.1 * PATH_LENGTH
"""Motion (mm) of some point of the body between two waypoints that is a jump to another shape; a step of the path is a
tenth of that."""


def tracking(plan: Plan) -> Experiment:
    """A path of 180 points behind random spheres, every method. A part is a number of spheres, a share a scene.

    Each waypoint begins from the last one solved; a method that fails from there may try its other initial
    configurations. Nothing guarantees that a waypoint can be reached.
    """
    everyone, solve = entrants(), partial(solve_in_turns, seconds=PAPER_BUDGET, seed=plan.seed, along=True)
    parts = {}
    for spheres, count in ({10: 1, 40: 1} if plan.quick else SCENES).items():
        paths = [partial(_path, plan, spheres, number) for number in range(count)]
        heading = f"{SEGMENTS} segments, {spheres} spheres, {count} scenes"
        works = [partial(share, everyone, path, solve) for path in paths]
        parts[f"{spheres} spheres"] = Divided(works, partial(lines_of, heading, told=_along))
    protocol = f"a figure of eight of {WAYPOINTS} points, position alone, at most {1e3 * PAPER_BUDGET:g} ms a waypoint"
    return Experiment("tracking", plan, parts, protocol)


def _path(plan: Plan, spheres: int, number: int) -> ProblemSet:
    return path_through(SEGMENTS, spheres, plan.rng(20, spheres, number), plan.count(WAYPOINTS, 8))


def _along(_: str, records: list[Record]) -> str:
    good = [record for record in records if record["right"]]
    from_last = sum(record["start"] == "given" for record in good)
    least = min((record["clearance"] for record in good), default=float("nan"))
    jumps = sum(record.get("motion", 0.0) > JUMP for record in good)
    return f"{from_last} from the last shape, least clearance {least:.2g} mm, {jumps} jumps of {JUMP:g} mm"


SIZES = (5, 6, 7, 8, 9, 10, 20, 40, 80, 160, 320, 640)
"""Numbers of segments: those of the paper, and beyond."""

MOST_DIFFERENCES = 80
"""Segments for which differences do not take minutes."""

GROWTH_BUDGET, TOTAL_BEND = 0.25, 6.0
"""Seconds of one solve; sum of the bends that poses are drawn with, so that long arms do not curl up."""

POSES, ROUNDS = 40, 4
"""Poses of each size, and times that all sizes are gone through: a slow minute of the machine bends no curve."""


def segments(plan: Plan) -> Experiment:
    """How the time of an iteration, and of a solve, grows with the number of segments; one part.

    Time of an iteration: all of a solve, with its initial configurations, over its iterations, summed over those
    confirmed solves that had any. Exponents are slopes of straight lines through logarithms, by least squares.
    """
    both = [Entrant("opti_path", "opti_path"), Entrant(DIFFERENCES, OptiPath(gradient="differences"))]
    everyone = [Entrant("newton", "newton"), *both]
    sizes = (5, 10, 20) if plan.quick else SIZES
    works, solve = [], partial(solve_in_turns, seconds=GROWTH_BUDGET, seed=plan.seed)
    for _ in range(plan.count(ROUNDS, 1)):
        for size in sizes:
            able = everyone if size <= MOST_DIFFERENCES else everyone[:-1]
            works.append(partial(share, able, partial(_poses, plan, size), solve))
    parts = {"growth": Divided(works, partial(_growth, sizes))}
    return Experiment("segments", plan, parts, "positions and directions without obstacles, from cold, in four rounds")


def _poses(plan: Plan, size: int) -> ProblemSet:
    drawn = arm(size, TOTAL_BEND / size)
    q = random_configurations(drawn, plan.count(POSES, 4), plan.rng(41, size))
    return ProblemSet(arm(size, FREE_BEND), tip_targets(drawn, q), sn.Scene(), PAPER_TOLERANCE)


def _growth(sizes: Sequence[int], shares: Sequence[Mapping[str, Any]]) -> Iterator[Line]:
    curves: dict[str, dict[int, float]] = {}
    for i, size in enumerate(sizes):
        own = shares[i :: len(sizes)]
        yield from lines_of(f"{size} segments", own, lambda _, some: f"{number(_iteration(some), 'us')} an iteration")
        for label in {label: None for each in own for label in each["records"]}:
            records = [record for each in own for record in each["records"][label]]
            curves.setdefault(label, {})[size] = _iteration(records)
    for label, curve in curves.items():
        if len(curve) < 2:
            continue
        fitted = float(np.polyfit(np.log(list(curve)), np.log(list(curve.values())), 1)[0])
        yield Line("time of an iteration grows as the number of segments to the power of", label, fitted, "", Goal(1.1))


def _iteration(records: Sequence[Record]) -> float:
    """Seconds of an iteration; NaN where no confirmed solve had any."""
    busy = [record for record in records if record["right"] and record["iterations"] > 0]
    seconds, steps = (sum(record[key] for record in busy) for key in ("seconds", "iterations"))
    return seconds / steps if steps else float("nan")


BUDGET = 0.05
"""Seconds of one solve of a random problem, with all its initial configurations."""

TOGETHER, SHARES = 20, 10
"""Problems in one share, among obstacles in one scene; and shares of each kind."""

SPHERES, BEND = 40, 2.4


class Family(NamedTuple):
    """A kind of problems.

    Attributes
    ----------
    words : str
        What it is.
    robot : Robot
    asked : str
        What of a tip that some shape has, see `target_at`.
    spheres : int
        How many there are, in which the shape is clear.
    drawn : Robot, optional
        Whose shapes are drawn, where not those of the robot.
    tolerance : Tolerance
    """

    words: str
    robot: sn.Robot
    asked: str = "direction"
    spheres: int = 0
    drawn: sn.Robot | None = None
    tolerance: sn.Tolerance = PAPER_TOLERANCE


ARM, THICK = arm(5, BEND), arm(5, BEND, radius=4.0)
FIXED, MANY, LONG = sn.Robot.uniform(5, 57.5, BEND, base=ARM.base), arm(20, 1.2), arm(8, 1.5, radius=8.0)

GENTLE = "Gentle poses: drawn with bends to 1.2, no limit on bends"
EXACT = "Position and direction, to 1e-4 of the length and 1e-3 rad"
THICKET = f"Position and direction, 8 segments with bends to 1.5, 8 mm thick, among {3 * SPHERES} spheres"

FAMILIES = {
    "gentle": Family(GENTLE, arm(5, FREE_BEND), drawn=arm(5, 1.2)),
    "direction": Family(f"Position and direction, bends to {BEND}", ARM),
    "exact": Family(EXACT, ARM, tolerance=sn.Tolerance()),
    "position": Family("Position alone", ARM, "position"),
    "rotation": Family("Position and whole rotation", ARM, "rotation"),
    "fixed lengths": Family("Position and direction, lengths fixed at 57.5 mm", FIXED),
    "20 segments": Family("Position and direction, 20 segments, bends to 1.2", MANY),
    "spheres, direction": Family(f"Position and direction among {SPHERES} spheres, 4 mm thick", THICK, spheres=SPHERES),
    "spheres, position": Family(f"Position alone among {SPHERES} spheres, 4 mm thick", THICK, "position", SPHERES),
    "spheres, thicket": Family(THICKET, LONG, spheres=3 * SPHERES),
}
"""What each is, and how its problems are drawn."""


def methods(plan: Plan) -> Experiment:
    """All methods on common random problems, with and without obstacles. A part is a kind of problem."""
    everyone, solve = entrants(), partial(solve_in_turns, seconds=BUDGET, seed=plan.seed)
    parts = {}
    for family, own in FAMILIES.items():
        draws = [partial(_drawn, plan, family, number) for number in range(plan.count(SHARES, 1))]
        parts[family] = Divided([partial(share, everyone, draw, solve) for draw in draws], partial(lines_of, own.words))
    protocol = f"each the pose of a configuration within limits and clear, from cold, at most {1e3 * BUDGET:g} ms"
    return Experiment("methods", plan, parts, protocol)


def _drawn(plan: Plan, family: str, number: int) -> ProblemSet:
    own, rng = FAMILIES[family], plan.rng(30, list(FAMILIES).index(family), number)
    drawn = among_spheres(own.drawn or own.robot, own.spheres, plan.count(TOGETHER, 2), rng, own.asked)
    return replace(drawn, robot=own.robot, tolerance=own.tolerance.for_robot(own.robot))
