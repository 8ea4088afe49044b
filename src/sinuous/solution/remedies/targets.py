"""The nearest target that can be met, and the tolerance with which this one can."""

import math
from collections.abc import Iterator
from itertools import chain
from typing import Any

import numpy as np

from sinuous.checks import Floats
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target, Tolerance
from sinuous.solution.binding.pull import pull_of
from sinuous.solution.remedies.nearest import nearest
from sinuous.solution.remedies.remedy import Remedy
from sinuous.solution.remedies.trials import Case, Trials
from sinuous.solution.turns import turn_between
from sinuous.words import number, rounded_up

LOOSER = 20.0
"""How many times a tolerance may grow before another target is the better advice."""

MORE = (1.0, 1.02, 1.1, 1.3, 2.0)
"""By how much farther a target is moved where the whole search, begun anew, finds no solution with the least."""


def relax(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield the nearest position and direction that can be reached, or tolerances within which the target is met."""
    for i, target in enumerate(case.problem.targets if len(case.problem.targets) == 1 else ()):
        found = [*_moved(trials, case, i)] if target.position is not None else []
        if target.direction is not None or target.rotation is not None:
            found += _turned(trials, case, i)
        yield from found or _both(trials, case, i)


def drop(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield the targets, of several, without which the others can be met."""
    targets = case.problem.targets
    for i in range(len(targets) if len(targets) > 1 else 0):
        if trials.whole(case.problem.changed(targets=targets[:i] + targets[i + 1 :])) is not None:
            yield Remedy(f"target {i + 1}", repr(targets[i]), None)


def _with(problem: Problem, i: int, **values: Any) -> Problem:
    """The problem with other values in target `i`."""
    targets = problem.targets
    return problem.changed(targets=(*targets[:i], targets[i].changed(**values), *targets[i + 1 :]))


def _moved(trials: Trials, case: Case, i: int) -> Iterator[Remedy]:
    """The target moved as little as possible; a little: with its tolerance."""
    problem, target = case.problem, case.problem.targets[i]
    tolerance, place = problem.tolerance.position or 0.0, np.asarray(target.position)
    digits = math.ceil(-math.log10(0.1 * tolerance))

    def moved(by: Floats) -> Problem:
        return _with(problem, i, position=np.round(place + by, min(15, digits)))

    ends = (_end(problem, q, target)[:3, 3] for q in _without(trials, case, i, "position"))
    firsts = chain(_out_of(case, place), (end - place for end in ends))
    least = nearest(trials, moved, firsts, 0.5 * tolerance)
    if least is not None and float(np.linalg.norm(least[0])) <= tolerance:
        yield from _from_there(trials, case, least[1].q)
        return
    for by in () if least is None else [more * least[0] for more in MORE]:
        if trials.whole(moved(by)) is not None:
            size = float(np.linalg.norm(by))
            loose = rounded_up(tolerance + size)
            if loose <= LOOSER * tolerance and trials.whole(_looser(problem, position=loose)) is not None:
                yield Remedy("tolerance.position", tolerance, loose)
            after = moved(by).targets[i].position
            yield Remedy("target position", place.tolist(), np.asarray(after).tolist(), f"{number(size)} away")
            return


def _out_of(case: Case, place: Floats) -> Iterator[Floats]:
    """The shortest way out of the obstacle that a target is in, where that is the reason."""
    if case.reason is not None and case.reason.bound == "target":
        deep = case.reason.needed - case.reason.available
        yield (deep + (case.problem.tolerance.position or 0.0)) * case.problem.scene.gradient(place)


def _turned(trials: Trials, case: Case, i: int) -> Iterator[Remedy]:
    """The target turned as little as possible; a little: with its tolerance."""
    from scipy.spatial.transform import Rotation  # noqa: PLC0415

    problem, target = case.problem, case.problem.targets[i]
    key, tolerance = "rotation" if target.direction is None else "direction", problem.tolerance.angle
    before: Floats = getattr(target, key)

    def turned(by: Floats) -> Problem:
        return _with(problem, i, **{key: Rotation.from_rotvec(by).as_matrix() @ before})

    ends = (_end(problem, q, target)[:3, :3] for q in _without(trials, case, i, key))
    firsts = (turn_between(before, end[:, 2] if key == "direction" else end) for end in ends)
    least = nearest(trials, turned, firsts, 0.5 * tolerance, before if key == "direction" else None)
    if least is not None and float(np.linalg.norm(least[0])) <= tolerance:
        yield from _from_there(trials, case, least[1].q)
        return
    for by in () if least is None else [more * least[0] for more in MORE]:
        if trials.whole(turned(by)) is not None:
            size = float(np.linalg.norm(by))
            loose = rounded_up(tolerance + size)
            if loose <= LOOSER * tolerance and trials.whole(_looser(problem, angle=loose)) is not None:
                yield Remedy("tolerance.angle", tolerance, loose)
            after: Floats = getattr(turned(by).targets[i], key)
            yield Remedy(f"target {key}", before.tolist(), after.tolist(), f"{number(size)} rad away")
            return


def _from_there(trials: Trials, case: Case, q: Floats) -> Iterator[Remedy]:
    """A start from which the target itself is met, where it turns out that nothing has to be changed."""
    if trials.quick(case.problem, q) is not None:
        yield Remedy("start", None if case.given is None else case.given.tolist(), q.tolist())


def _both(trials: Trials, case: Case, i: int) -> Iterator[Remedy]:
    """The target where the best configuration is, when neither moving nor turning it is enough."""
    target, end = case.problem.targets[i], _end(case.problem, case.q, case.problem.targets[i])
    if target.position is None or (target.direction is None and target.rotation is None):
        return
    key, value = ("direction", end[:3, 2]) if target.rotation is None else ("rotation", end[:3, :3])
    if trials.whole(_with(case.problem, i, **{"position": end[:3, 3], key: value})) is not None:
        before = {"position": target.position.tolist(), key: getattr(target, key).tolist()}
        yield Remedy("target", before, {"position": end[:3, 3].tolist(), key: value.tolist()})


def _without(trials: Trials, case: Case, i: int, key: str) -> Iterator[Floats]:
    """Configurations that meet the rest of a target; then, from the best one on, some that are nearer and nearer."""
    problem, target = case.problem, case.problem.targets[i]
    rest = ("direction", "rotation") if key == "position" else ("position",)
    if any(getattr(target, other) is not None for other in rest):
        found = trials.quick(_with(problem, i, **{key: None}))
        if found is not None:
            yield found.q
    yield case.q
    off = max(1e-3 * problem.robot.mean_length, pull_of(problem, case.q).off)
    while key == "position" and off < 4.0 * problem.robot.mean_length and trials.left > 0.0:
        found = trials.quick(_looser(problem, position=off))
        if found is not None:
            yield found.q
        off *= 2.0


def _looser(problem: Problem, **values: float) -> Problem:
    own: dict[str, Any] = {"position": problem.tolerance.position, "angle": problem.tolerance.angle}
    return problem.changed(tolerance=Tolerance(**{**own, **values}))


def _end(problem: Problem, q: Floats, target: Target) -> Floats:
    """Pose (4, 4) of the end that a target speaks of."""
    robot = problem.robot
    last = len(robot) if target.segment is None else target.segment
    pose: Floats = robot.tip(q) if last == len(robot) else robot.forward(q)[last - 1]
    return pose
