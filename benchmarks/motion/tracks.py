"""Paths: the paper's 180 waypoints behind random spheres; each step is proved."""

from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from itertools import pairwise
from time import perf_counter
from typing import Any

import numpy as np

import sinuous as sn
from benchmarks.harness import Goal, Line, Plan, Times, in_processes
from benchmarks.judges.judge import wrong_in
from benchmarks.problems import ProblemSet, path_through
from sinuous.base.arguments import Reconfigure
from sinuous.motion.planning.rrt_connect import load_trees

SEGMENTS, SPHERES, SEEDS = (5, 8, 10), (10, 30, 50, 70), 12

REACHED = "paths of 180 waypoints behind random spheres: reached by proved motion, of those that were solved"
LEFT = "paths: the tip left a line between two of the 180 waypoints, which alone are asked for"
WHOLE = "paths: followed whole on the lines between the 180 waypoints, where these are asked for"
WAYPOINT = "paths: median time of a waypoint (one core, warm, with the proof of every step)"
WORST = "paths: worst time of a waypoint"
FALSE = "paths: steps called proved in which a judge finds a collision"
TIP = "paths: tip farther from a waypoint than the tolerance"


Followed = tuple[list[float], Counter[str]]
"""Seconds of every waypoint, and counts.

How many were `solved`, and `reached` by proved motion; how often the robot was `reconfigured`, whether the tip `left` a
line between two waypoints then, and whether the path is followed `whole` where that is refused; steps that are called
proved and are `wrong`, and waypoints that the tip `missed`.
"""


def measure(plan: Plan, segments: int) -> Iterator[Line]:
    """Follow paths among so many spheres, with one number of segments."""
    for spheres in SPHERES:
        what = f"{segments} segments, {spheres} spheres"
        paths = [(segments, spheres, 1000 * plan.seed + i) for i in range(plan.count(SEEDS, 1))]
        followed = list(in_processes(follow, paths, alone=plan.quick))
        times = Times.of([second for seconds, _ in followed for second in seconds])
        total = Counter[str]()
        for _, counts in followed:
            total += counts
        solved = total["solved"]
        tried = times.count
        note = f"{tried - solved} of {tried} waypoints were not solved; reconfigured {total['reconfigured']} times"
        yield Line(REACHED, what, 100.0 * total["reached"] / max(1, solved), "%", Goal(99.9, at_most=False), note=note)
        for section, name in ((LEFT, "left"), (WHOLE, "whole")):
            yield Line(section, what, 100.0 * total[name] / len(followed), "%")
        yield Line(WAYPOINT, what, times.median, "us", Goal(60e-6), times)
        yield Line(WORST, what, times.worst, "ms", Goal(50e-3))
        for section, name in ((FALSE, "wrong"), (TIP, "missed")):
            yield Line(section, what, total[name], "", Goal(0.0, correctness=True))


PARTS: dict[str, Callable[[Plan], Iterator[Line]]] = {
    f"paths, {segments} segments": partial(measure, segments=segments) for segments in SEGMENTS
}


def follow(path: tuple[int, int, int]) -> Followed:
    """Follow one path, by numbers of segments and spheres and a seed, and judge every step that is called proved."""
    segments, spheres, seed = path
    problems = path_through(segments, spheres, np.random.default_rng([seed, segments, spheres]))
    _track(problems.only(range(3)))
    load_trees(problems.robot, problems.scene.snapshot())  # what re-configures the robot is warm, too
    motion, seconds = _track(problems)
    solved = sum(solution.solved for solution in motion.solutions)
    counts = {
        "solved": solved,
        "reached": solved - _unproved(motion),
        "reconfigured": len(motion.reconfigured),
        "left": bool(motion.left_steps),
        "whole": _track(problems, "refuse")[0].solved if motion.left_steps else motion.solved,
        "wrong": sum(bool(wrong_in(problems.robot, problems.scene, knots)) for knots in _proved_runs(motion)),
        "missed": _missed(problems, motion),
    }
    return seconds, Counter(counts)


def _track(problems: ProblemSet, reconfigure: Reconfigure = "allow") -> tuple[sn.Motion, list[float]]:
    """Follow a path; return the motion, and the seconds of each waypoint with all that was proved of the way there."""
    stamps = [perf_counter()]

    def stamp(_: sn.Solution) -> None:
        stamps.append(perf_counter())

    # The experiment asks for waypoints only.
    options: dict[str, Any] = {"tolerance": problems.tolerance, "progress": stamp, "reconfigure": reconfigure}
    motion = sn.track(problems.robot, problems.targets, problems.scene, **options)
    return motion, np.diff(stamps).tolist()


def _unproved(motion: sn.Motion) -> int:
    """How many waypoints come after a step that is not proved, one each."""
    knots = [knot for knot in motion.waypoint_knots if knot is not None]
    return len({int(np.searchsorted(knots, step)) for step in motion.unproved_steps})


def _proved_runs(motion: sn.Motion) -> Iterator[np.ndarray]:
    """Knots of the longest stretches that are proved."""
    for begin, end in pairwise((0, *motion.unproved_steps, len(motion.q))):
        if end - begin > 1:
            yield motion.q[begin:end]


def _missed(problems: ProblemSet, motion: sn.Motion) -> int:
    """How many waypoints that are called solved the tip misses."""
    count = 0
    for target, solution, knot in zip(problems.targets, motion.solutions, motion.waypoint_knots, strict=True):
        if solution.solved and knot is not None:
            assert target.position is not None
            off = np.linalg.norm(problems.robot.tip(motion.q[knot])[:3, 3] - target.position)
            count += bool(off > (problems.tolerance.position or 0.0) * (1.0 + 1e-9))
    return count
