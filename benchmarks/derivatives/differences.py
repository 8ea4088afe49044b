"""Differences of answers: solve again, from the answer, after the parameters have moved a little both ways."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator
from scipy.spatial.transform import Rotation

import sinuous as sn
from benchmarks.derivatives.families import solver_for
from sinuous.answer.derivatives.derivative import derivative_of
from sinuous.answer.derivatives.parameters import GROUPS, circles_of
from sinuous.base.arguments import Parameter
from sinuous.base.checks import Floats
from sinuous.kernels.tables import LENGTH_SCALE
from sinuous.model.actuators import Lines
from sinuous.scene.moving import moved
from sinuous.scene.obstacles import Obstacle

Tangent = dict[Parameter, Floats]
"""How fast each group of parameters moves, as `Derivative.jvp` takes it."""

SHARES = (1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7)
"""How far parameters move: rad, and mean lengths of the robot. The step that agrees best counts: a large one leaves the
neighbourhood in which the answer is smooth, a small one drowns in rounding."""


class Question(NamedTuple):
    """A robot, targets and obstacles, and where to begin."""

    robot: sn.Robot
    targets: list[sn.Target]
    scene: list[Obstacle]
    initial: Floats


def random_tangent(found: sn.Solution, rng: Generator) -> Tangent:
    """Let all parameters move at once: by rad, and by mean lengths of the robot."""
    robot, problem = found.problem.robot, found.problem
    size, n = robot.mean_length, len(robot)
    twist = np.array([1.0, 1.0, 1.0, size, size, size])
    target = [
        scale * rng.normal(size=3)
        for each in problem.targets
        for scale, asked in (
            (size, each.position is not None),
            (1.0, each.direction is not None or each.rotation is not None),
        )
        if asked
    ]
    return {
        "target": np.concatenate(target),
        "base": twist * rng.normal(size=6),
        "tool": twist * rng.normal(size=6),
        "lengths": size * rng.normal(size=n),
        "bends": rng.normal(size=n),
        "curvatures": rng.normal(size=n) / size,
        "radii": np.array(robot.radii) * rng.normal(size=n),
        "tendons": size * rng.normal(size=len(circles_of(robot))),
        "actuators": _of_circles(robot, size * rng.normal(size=(n, 3, 2))),
        "obstacles": np.tile(twist, len(problem.scene)) * rng.normal(size=6 * len(problem.scene)),
        "initial": np.tile([1.0, 1.0, size], n) * rng.normal(size=3 * n) * (robot.limits[:, [5, 5, 6]].ravel() > 0.0),
    }


def _of_circles(robot: sn.Robot, ends: Floats) -> Floats:
    """Let the limits of all lines of a circle move alike: those of the tendons and of the chambers of each segment."""
    kinds = ("tendon", "chamber", "stage", "linear")
    return np.ravel([ends[each.segment - 1, kinds.index(each.kind)] for each in robot.actuators])


def _small_pose(twist: Floats) -> Floats:
    """The pose (4, 4) of a rotation, and a shift, apart."""
    small = np.eye(4)
    small[:3, :3] = Rotation.from_rotvec(twist[:3]).as_matrix()
    small[:3, 3] = twist[3:]
    return small


def _about(place: Floats, twist: Floats) -> Floats:
    """The pose (4, 4) that turns about a place, and moves it."""
    small = _small_pose(twist)
    small[:3, 3] += place - small[:3, :3] @ place
    return small


def _place_of(obstacle: Obstacle) -> Floats:
    ends = [np.asarray(getattr(obstacle, name)) for name in ("start", "end") if hasattr(obstacle, name)]
    if ends:
        return np.asarray(np.mean(ends, axis=0), np.float64)
    for name in ("center", "point"):
        if hasattr(obstacle, name):
            return np.asarray(getattr(obstacle, name))
    return np.zeros(3)


def _segment(robot: sn.Robot, k: int, way: Tangent, h: float) -> sn.Segment:
    own = robot.segments[k]
    low, high = own.length
    shift = h * way["lengths"][k] if "lengths" in way else 0.0
    changed = own.changed(length=low + shift if low == high else (low + shift, high + shift))
    if "bends" in way:
        changed = changed.changed(max_bend=own.max_bend + h * way["bends"][k])
    if "curvatures" in way and np.isfinite(own.max_curvature):
        changed = changed.changed(max_curvature=own.max_curvature + h * way["curvatures"][k])
    if "radii" in way and own.radius > 0.0:
        changed = changed.changed(radius=own.radius + h * way["radii"][k])
    ends = [way["actuators"][2 * i : 2 * i + 2] for i in range(len(robot.drive))] if "actuators" in way else []
    for kind, lines in (("tendons", own.tendons), ("chambers", own.chambers)):
        if lines is None:
            continue
        bigger = _circle(robot, k, kind, lines, way, h)
        mine = [i for i, each in enumerate(robot.actuators) if each.segment == k + 1 and f"{each.kind}s" == kind]
        key = "displacement" if kind == "tendons" else "length"
        limits = np.asarray(getattr(lines, key))
        if np.isfinite(limits).all():
            shift = h * ends[mine[0]] if ends else np.zeros(2)
            bigger = bigger.changed(**{key: tuple(limits + shift)})
        own_kind: Any = {kind: bigger}
        changed = changed.changed(**own_kind)
    return changed


def _circle(robot: sn.Robot, k: int, kind: str, lines: Lines, way: Tangent, h: float) -> Lines:
    number = [(kind, k) == each[:2] for each in circles_of(robot)].index(True)
    return lines.changed(radius=lines.radius + h * way["tendons"][number]) if "tendons" in way else lines


def _targets(found: sn.Solution, way: Tangent, h: float) -> list[sn.Target]:
    listed, at = [], 0
    for own in found.problem.targets:
        position, turned = own.position, own
        if "target" not in way:
            listed.append(own)
            continue
        if position is not None:
            position, at = position + h * way["target"][at : at + 3], at + 3
        if own.direction is not None or own.rotation is not None:
            turn, at = Rotation.from_rotvec(h * way["target"][at : at + 3]).as_matrix(), at + 3
            axis = None if own.direction is None else turn @ own.direction
            matrix = None if own.rotation is None else turn @ own.rotation
            turned = sn.Target(position, direction=axis, rotation=matrix, segment=own.segment)
        else:
            turned = sn.Target(position, segment=own.segment)
        listed.append(turned)
    return listed


def question(found: sn.Solution, way: Tangent, h: float) -> Question:
    """Return what was asked, after the parameters have moved by `h` times a tangent."""
    robot, scene = found.problem.robot, list(found.problem.scene.obstacles)
    changed = robot.changed(segments=[_segment(robot, k, way, h) for k in range(len(robot))])
    if "base" in way:
        base = robot.base.copy()
        small = _small_pose(h * way["base"])
        base[:3, :3], base[:3, 3] = small[:3, :3] @ base[:3, :3], base[:3, 3] + small[:3, 3]
        changed = changed.changed(base=base)
    if "tool" in way:
        tool = robot.tool.copy()
        small = _small_pose(h * way["tool"])
        tool[:3, :3], tool[:3, 3] = small[:3, :3] @ tool[:3, :3], tool[:3, 3] + small[:3, 3]
        changed = changed.changed(tool=tool)
    if "obstacles" in way:
        scene = [
            moved(each, _about(_place_of(each), h * way["obstacles"][6 * i : 6 * i + 6]))
            for i, each in enumerate(scene)
        ]
    q = found.q.copy()
    fixed = robot.limits[:, LENGTH_SCALE] == 0.0
    if "lengths" in way:
        q[fixed, 2] += h * way["lengths"][fixed]
    if "initial" in way:
        q += h * way["initial"].reshape(-1, 3)
    return Question(changed, _targets(found, way, h), scene, q)


def again(found: sn.Solution, way: Tangent, h: float) -> Floats | None:
    """Solve what was asked after the parameters have moved; nothing where that is impossible or fails."""
    try:
        asked = question(found, way, h)
        again = solver_for(asked.robot, asked.scene).solve(asked.targets, asked.initial)
    except sn.InputError:
        return None
    return again.q if again.solved else None


def minimum_again(found: sn.Solution, way: Tangent, h: float) -> Floats | None:
    """Find the minimum of what is preferred after the parameters have moved, from where it was."""
    wish, near = found._wish(), found.derivative().configuration
    if wish is None or wish.reference is None:
        return None
    asked = question(found, way, h)
    begin, reference = near + asked.initial - found.q, wish.reference + asked.initial - found.q
    problem = sn.Problem(asked.robot, asked.targets, asked.scene, found.problem.tolerance)
    moved = derivative_of(problem, begin, "target", True, wish._replace(reference=reference))
    return moved.configuration if moved.regular else None


def least_gaps(problem: sn.Problem, q: Floats) -> Floats:
    """Least distances (m,) of bodies (m, n, 3) from the obstacles, densely sampled and then refined.

    Each segment is refined by itself: the nearest place may be just before the end of one.
    """
    robot, scene = problem.robot, problem.scene
    m, n = q.shape[:2]
    width, shares = 1.0 / 400.0, np.tile(np.linspace(0.0, 1.0, 401), (m, n, 1))
    for _ in range(4):
        parts = np.repeat(np.repeat(q[:, None, None], n, axis=1), shares.shape[2], axis=2)
        for k in range(n):
            parts[:, k, :, k] *= shares[:, k, :, None]
        poses = robot.forward(parts.reshape(-1, n, 3)).reshape(*parts.shape[:3], n, 4, 4)
        places = np.stack([poses[:, k, :, k, :3, 3] for k in range(n)], axis=1)
        table = scene.distance(places.reshape(-1, 3)).reshape(places.shape[:3]) - np.array(robot.radii)[:, None]
        middle = np.take_along_axis(shares, table.argmin(axis=2)[..., None], axis=2)
        shares, width = np.clip(middle + width * np.linspace(-1.0, 1.0, 41), 0.0, 1.0), width / 20.0
    return np.asarray(table.min(axis=(1, 2)))


class Agreement(NamedTuple):
    """How well a derivative along a tangent agrees with differences.

    Attributes
    ----------
    error : float
        Least difference between the two, relative to the larger; infinite where nothing was found.
    step : float
        The step at which it is that.
    """

    error: float
    step: float


def agreement(found: sn.Solution, motion: Floats, way: Tangent, one_sided: bool = False) -> Agreement:
    """Compare a derivative (n, 3) along a tangent with central differences, or with those to one side."""

    def difference(h: float) -> Floats | None:
        before = found.q if one_sided else again(found, way, -h)
        after = None if before is None else again(found, way, h)
        return None if after is None or before is None else (after - before) / (h if one_sided else 2.0 * h)

    return _best(found, motion, difference)


def agreement_of_minima(found: sn.Solution, motion: Floats, way: Tangent) -> Agreement:
    """Compare it with differences of minima of what is preferred: near straight shapes they curve, so two steps."""

    def difference(h: float) -> Floats | None:
        ends = [minimum_again(found, way, size) for size in (h, -h, 0.5 * h, -0.5 * h)]
        far, near, less, more = ends
        if far is None or near is None or less is None or more is None:
            return None
        return (8.0 * (less - more) - (far - near)) / (6.0 * h)

    return _best(found, motion, difference)


def _best(found: sn.Solution, motion: Floats, difference: Callable[[float], Floats | None]) -> Agreement:
    """How well a derivative agrees at the step at which it does so best."""
    scale = np.array([1.0, 1.0, found.problem.robot.mean_length])
    best = Agreement(np.inf, np.nan)
    for h in SHARES:
        change = difference(h)
        if change is None:
            continue
        size = max(float(np.linalg.norm(change / scale)), float(np.linalg.norm(motion / scale)), 1e-3)
        best = min(best, Agreement(float(np.linalg.norm((change - motion) / scale)) / size, h))
        if best.error < 1e-8:
            break
    return best


ALL = tuple(GROUPS)
"""All groups of parameters."""
