"""The parameters that an answer can be derived by: their groups, their columns and what these are called.

What an answer has to keep while parameters change are its rows, as kernels find them.
"""

import math
import threading
from collections.abc import Iterable
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from sinuous.base.arguments import Parameter
from sinuous.base.checks import Floats
from sinuous.base.parameter_groups import TWIST, read_names
from sinuous.kernels.derivative import layout as a
from sinuous.kernels.derivative.query import derive
from sinuous.kernels.derivative.sides import ACTUATOR_NUMBER, CIRCLE, RADIUS_OF
from sinuous.kernels.packing import scales_of
from sinuous.model.limits import least_distance
from sinuous.model.robot import Robot, robot_group
from sinuous.model.segment import coordinate_names
from sinuous.problem.problem import Problem, settings_group

GROUPS: dict[Parameter, int] = {
    "target": a.TARGET,
    "base": a.BASE,
    "tool": a.TOOL,
    "lengths": a.LENGTHS,
    "bends": a.BENDS,
    "curvatures": a.CURVATURES,
    "radii": a.RADII,
    "tendons": a.TENDONS,
    "actuators": a.ACTUATORS,
    "obstacles": a.OBSTACLES,
    "initial": a.INITIAL,
}
"""All groups of parameters.

- `target`: of each target the position (3), if it has one, and then the orientation (3), if it has one, as a small
  rotation of it in world axes;
- `base`: a small rotation of the base about its own origin, in world axes (3), and the motion of that origin (3);
- `tool`: the same of the tool, in axes of the tip;
- `lengths`: of each segment its length; where it stretches, both ends of its range together;
- `bends`, `curvatures`, `radii`: of each segment its `max_bend`, its `max_curvature`, its `radius`;
- `tendons`: of each circle of tendons or chambers its radius;
- `actuators`: of each actuator the least and the largest displacement that its limits allow, in the length unit;
- `obstacles`: of each obstacle a small rotation about its center, or about the origin of the frame that it is described
  in, in world axes (3), and the motion of that place (3);
- `initial`: the configuration to stay close to, which by default is the answer itself.
"""

FIELDS = {"lengths": "length", "bends": "max_bend", "curvatures": "max_curvature", "radii": "radius"}

_KNOWN: dict[Any, tuple[Parameter, ...]] = {(name,): (name,) for name in GROUPS}
"""Groups of parameters that were asked for."""


def read_wrt(wrt: Any) -> tuple[Parameter, ...]:
    """Check names of groups of parameters: one, or several.

    Raises
    ------
    InputError
    """
    if isinstance(wrt, tuple) and wrt in _KNOWN:
        return _KNOWN[wrt]
    found = read_names(wrt, GROUPS)
    return _KNOWN.setdefault(found, found)


class DerivativePlan:
    """What kernels are asked for about answers of one robot, for some parameters; shared between answers.

    Attributes
    ----------
    wrt : tuple of str
    robot : Robot
    obstacles, targets : int
        How many there are.
    group, settings : ndarray
        Robot and settings as kernels read them.
    asked : ndarray (14,) of int64
        See `sinuous.kernels.derivative.layout`.
    lines : ndarray (p, 3)
        See `sinuous.kernels.derivative.sides`.
    circles : tuple of (str, int, float)
        Circles of lines: `tendons` or `chambers`, the segment (0 = first), and the radius.
    limited : tuple of int
        Of each actuator limit that kernels see the number of the actuator.
    elastic : Elastic or None
        The elastic actuators, where they have limits.
    rows, columns, answer : int
        Most rows, columns of all parameters, numbers of an answer.
    """

    __slots__ = (
        "answer",
        "asked",
        "circles",
        "columns",
        "elastic",
        "group",
        "limited",
        "lines",
        "obstacles",
        "robot",
        "rows",
        "settings",
        "spans",
        "targets",
        "workspace",
        "wrt",
    )

    def __init__(self, problem: Problem, wrt: tuple[Parameter, ...]) -> None:
        robot = self.robot = problem.robot
        n, self.obstacles, self.targets, self.wrt = len(robot), len(problem.scene), len(problem.targets), wrt
        self.circles = circles_of(robot)
        widths = {
            "target": a.TARGET_COLUMNS * self.targets,
            "base": len(TWIST),
            "tool": len(TWIST),
            "lengths": n,
            "bends": n,
            "curvatures": n,
            "radii": n,
            "tendons": len(self.circles),
            "actuators": 2 * len(robot.drive),
            "obstacles": len(TWIST) * self.obstacles,
            "initial": 3 * n,
        }
        self.asked = np.full(a.ASKED_WIDTH, -1)
        self.spans: dict[Parameter, tuple[int, int]] = {}
        at = 0
        for name in wrt:
            self.asked[GROUPS[name]] = at
            self.spans[name] = at, at + widths[name]
            at += widths[name]
        self.columns, self.rows = at, a.most_rows(n, self.targets)
        self.asked[a.COLUMNS], self.asked[a.ROWS] = self.columns, self.rows
        elastic = robot.drive.elastic
        self.elastic = elastic if elastic is not None and elastic.bounded else None
        self.limited = _limited(robot)
        self.lines = self._lines()
        self.group, self.settings = robot_group(robot), settings_group(robot, problem.tolerance)
        self.answer = self.asked[a.ANSWER] = a.answer_size(n, self.targets, self.columns)
        self.workspace = np.empty(a.workspace_size(n, self.obstacles, self.targets, self.columns))

    def fits(self, problem: Problem, wrt: tuple[Parameter, ...]) -> bool:
        """Whether it serves such a problem and these parameters."""
        return (
            self.robot is problem.robot
            and self.wrt == wrt
            and self.targets == len(problem.targets)
            and self.obstacles == len(problem.scene)
        )

    def _lines(self) -> Floats:
        """See `lines`."""
        robot, table = self.robot, np.empty((len(self.limited), 3))
        numbers = {(kind, k): i for i, (kind, k, _) in enumerate(self.circles)}
        for row, number in zip(table, self.limited, strict=True):
            actuator = robot.drive.actuators[number]
            i = numbers.get((f"{actuator.kind}s", robot.end_row(actuator.segment) - 1), -1)
            row[CIRCLE], row[ACTUATOR_NUMBER] = i, number
            row[RADIUS_OF] = self.circles[i][2] if i >= 0 else 1.0
        return table

    def labels(self, name: Parameter, problem: Problem) -> tuple[str, ...]:
        """What the columns of a group are called."""
        robot, names = self.robot, self.robot.row_names
        listed: dict[Parameter, Iterable[str]] = {
            "target": (label for label, asked in _target_labels(problem) if asked),
            "base": (f"base.{each}" for each in TWIST),
            "tool": (f"tool.{each}" for each in TWIST),
            "tendons": (f"{names[k]}.{kind}.radius" for kind, k, _ in self.circles),
            "actuators": (f"{actuator.name}.limits[{i}]" for actuator in robot.actuators for i in (0, 1)),
            "obstacles": (f"{problem.scene.name(i)}.{each}" for i in range(self.obstacles) for each in TWIST),
            "initial": coordinate_names(names),
        }
        return tuple(listed[name] if name in listed else (f"{segment}.{FIELDS[name]}" for segment in names))

    def chosen(self, name: Parameter, problem: Problem) -> Any:
        """Index of the columns of a group among all: those of a target that is not asked for are left out."""
        first, last = self.spans[name]
        if name != "target":
            return slice(first, last)
        kept = [i for i, (_, asked) in enumerate(_target_labels(problem)) if asked]
        return slice(first, first + 3) if kept == [0, 1, 2] else np.array([first + i for i in kept])


def _target_labels(problem: Problem) -> list[tuple[str, bool]]:
    """What the columns of all targets are called, and whether they are asked for."""
    listed = []
    for i, target in enumerate(problem.targets):
        name = "target" if len(problem.targets) == 1 else f"targets[{i}]"
        turned = "rotation" if target.direction is None else "direction"
        listed += [(f"{name}.position_{axis}", target.position is not None) for axis in "xyz"]
        own = target.direction is not None or target.rotation is not None
        listed += [(f"{name}.{turned}_{axis}", own) for axis in "xyz"]
    return listed


def circles_of(robot: Robot) -> tuple[tuple[str, int, float], ...]:
    """All circles of tendons and chambers: which of the two, the segment (0 = first), and the radius."""
    return tuple(
        (kind, k, lines.radius)
        for k, segment in enumerate(robot.rows)
        for kind, lines in (("tendons", segment.tendons), ("chambers", segment.chambers))
        if lines is not None
    )


def _limited(robot: Robot) -> tuple[int, ...]:
    """Of each row of `Robot.actuation` the number of its actuator; the order is that of `packing.actuator_table`."""
    coordinates, found = robot.drive.coordinates, []
    for number, actuator in enumerate(robot.drive.actuators):
        if not np.isfinite(robot.drive.limits[number]).any():
            continue
        seen = coordinates.moving(robot.drive.jacobian[number].reshape(-1, 3))
        if actuator.kind != "linear":
            if coordinates.sees(robot.drive.jacobian[number]):
                found.append((robot.end_row(actuator.segment) - 1, number))
        elif seen[:, :2].any() or (seen.any() and not coordinates.free):
            # Otherwise straight robots have all its values, and kernels see no limit.
            found.append((int(np.flatnonzero(seen.any(axis=1))[-1]), number))
    return tuple(number for _, number in sorted(found, key=lambda pair: pair[0]))


_KEPT = threading.local()


def plan_for(problem: Problem, wrt: tuple[Parameter, ...]) -> DerivativePlan:
    """Return the plan for such problems and parameters; the last one of a thread is kept."""
    kept: DerivativePlan | None = getattr(_KEPT, "plan", None)
    if kept is None or not kept.fits(problem, wrt):
        kept = _KEPT.plan = DerivativePlan(problem, wrt)
    return kept


def fixed_lengths(plan: DerivativePlan) -> Floats:
    """Motions (3 n, p) of the lengths of segments that cannot stretch, by the parameters that say them."""
    direct = np.zeros((3 * len(plan.robot), plan.columns))
    if plan.asked[a.LENGTHS] >= 0:
        fixed = np.flatnonzero(scales_of(plan.robot.limits)[:, 2] == 0.0)
        direct[3 * fixed + 2, plan.asked[a.LENGTHS] + fixed] = 1.0
    return direct


class KeptRows:
    """The rows of an answer, targets first.

    Attributes
    ----------
    problem : Problem
    plan : DerivativePlan
    answer : ndarray
        As kernels fill it, see `sinuous.kernels.derivative.layout`.
    q : ndarray (n, 3)
        The configuration.
    """

    __slots__ = ("__dict__", "answer", "plan", "problem", "q")

    def __init__(self, problem: Problem, plan: DerivativePlan, answer: Floats, q: Floats) -> None:
        self.problem, self.plan, self.answer, self.q = problem, plan, answer, q

    @classmethod
    def found(cls, problem: Problem, plan: DerivativePlan, q: Floats, keep: float = math.inf) -> "KeptRows":
        """Find what `q` (n, 3) keeps, and derive it as the nearest answer.

        With a finite `keep` find the places of the body whose gaps to obstacles are at most about that: gaps count
        from there.
        """
        answer, group = np.empty(plan.answer), problem.scene._kernel_group
        workspace = plan.workspace if keep == math.inf else np.empty(plan.workspace.size)
        own = plan.group, group, plan.settings, problem._rows, plan.asked, plan.lines
        derive(*own, np.array(q), keep, workspace, answer)
        return cls(problem, plan, answer, q)

    def at(self, q: Floats) -> "KeptRows":
        """Return those of another configuration, or of a Newton step from there, which meets the targets."""
        found = self.found(self.problem, self.plan, q)
        found.q = self.plan.workspace[: q.size].reshape(q.shape).copy()
        return found

    @property
    def moved(self) -> Floats:
        """Derivatives (3 n, p) of the configuration by all parameters."""
        size = 3 * len(self.plan.robot)
        return self.answer[a.ANSWER_HEADER : a.ANSWER_HEADER + size * self.plan.columns].reshape(size, -1)

    @property
    def targets(self) -> int:
        """How many are those of targets."""
        return int(self.answer[a.TARGET_ROWS])

    @property
    def smooth(self) -> bool:
        """Whether the targets can follow all small changes, and there was room for all rows."""
        return not int(self.answer[a.STATUS]) & (a.SINGULAR | a.TOO_MANY)

    @cached_property
    def _parts(self) -> tuple[Floats, Floats, Floats]:
        count, r, size = int(self.answer[a.ROW_COUNT]), self.plan.rows, 3 * len(self.plan.robot)
        first, found = a.ANSWER_HEADER + size * self.plan.columns, []
        for width in (size, a.ABOUT_WIDTH, self.plan.columns):
            found.append(self.answer[first : first + r * width].reshape(r, width)[:count])
            first += r * width
        return found[0], found[1], found[2]

    @property
    def rows(self) -> Floats:
        """Rows (r, 3 n), of length 1 in the metric."""
        return self._parts[0]

    @property
    def about(self) -> Floats:
        """What is known about them (r, 12)."""
        return self._parts[1]

    @property
    def sides(self) -> Floats:
        """What parameters ask of them (r, p)."""
        return self._parts[2]

    @property
    def missing(self) -> Floats:
        """By how much (r,) rows have to change for targets to be met, and for nothing to be left of limits."""
        left = self.about[:, a.ROW_FACTOR] * self.about[:, a.ROW_SLACK]
        return np.where(self.about[:, a.ROW_KIND] == a.TARGET_ROW, left, -left)


RANK = 1e-10
"""Singular value, relative to the largest, below which rows depend on each other."""

INCOMPATIBLE = 1e-9
"""By how much equations may be missed, relative to their right sides, or nothing satisfies them."""


class Kept(NamedTuple):
    """What a small motion x (c,) has to do.

    Attributes
    ----------
    equal : ndarray (e, c)
        Rows whose products with x are given.
    least : ndarray (l, c)
        Rows whose products with x are bounded from below.
    hessian : ndarray (c, c) or None
        Of what is least among all such motions, beside `pull`; `None` for the identity.
    """

    equal: Floats
    least: Floats
    hessian: Floats | None


def least_motion(kept: Kept, values: Floats, bounds: Floats, pull: Floats) -> Floats:
    """Return the x (c,) with the least `x' H x / 2 + pull . x` that keeps rows; NaN where none does.

    `values` (e,) and `bounds` (l,) are those of `equal` and `least`. Least-distance programming in what the equations
    leave free.
    """
    count = kept.equal.shape[1]
    _, sizes, directions = np.linalg.svd(kept.equal)
    rank = int((sizes > RANK * max(1.0, sizes.max(initial=0.0))).sum())
    free = directions[rank:].T
    begin = np.linalg.lstsq(kept.equal, values, rcond=RANK)[0] if len(kept.equal) else np.zeros(count)
    if np.abs(kept.equal @ begin - values).max(initial=0.0) > INCOMPATIBLE * (1.0 + np.abs(values).max(initial=0.0)):
        return np.full(count, np.nan)
    slope = free.T @ (pull + (begin if kept.hessian is None else kept.hessian @ begin))
    if kept.hessian is None:
        root = np.eye(free.shape[1])
    else:
        try:
            root = np.linalg.cholesky(free.T @ kept.hessian @ free)
        except np.linalg.LinAlgError:
            return np.full(count, np.nan)
    best: Floats = -np.linalg.solve(root.T, np.linalg.solve(root, slope))
    nearest = least_distance(root, best, kept.least @ free, bounds - kept.least @ begin)
    return np.full(count, np.nan) if nearest is None else begin + free @ nearest[0]
