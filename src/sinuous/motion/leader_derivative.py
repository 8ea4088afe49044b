"""How the shapes of a body that follows the leader change with the curve, the advance, the base and the lengths.

A shape is fitted to the curve by least squares, and solved from there with the tip on the curve. Each derivative is
made of central differences with two steps, of shapes that are found in this way from the one that is derived: exact to
the fourth order of a step of 1e-3.
"""

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

import numpy as np

from sinuous.base.arguments import LeaderParameter
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.parameter_groups import ByGroups, Column, read_names
from sinuous.model.robot import Robot
from sinuous.motion.curve_fitting import fit_chains_along
from sinuous.problem.path import Curve
from sinuous.problem.target import Tolerance
from sinuous.solver.solver import Solver
from sinuous.statics.response import KINK, motions_of_base

STEP = 1e-3
"""The larger one of the differences: rad, and mean lengths of the robot."""

SMOOTH = 0.4
"""What half a step may bend a shape, as a share of a whole one: 1/4 where it is smooth, 1/2 at a kink."""

EXACT = 1e-13
"""How exactly the tip is on the curve, in mean lengths of the robot."""

ROUNDING = 1e-9
"""What shapes are exact to: rad, and mean lengths of the robot."""

FARTHEST = 0.01
"""How far shapes may be from those of the motion: rad, and mean lengths. Where segments that stretch share the length
of the chain, the curve hardly says how, and least squares end far from where the motion stopped."""

OFF = 1e-5
"""How far the tip may be off the curve, in lengths of the robot, where a motion follows it."""


class LeaderQuestion(NamedTuple):
    """What is fitted: a robot, the curve from its base on, and depths (T,)."""

    robot: Robot
    path: Curve
    depths: Floats

    @classmethod
    def of(cls, robot: Robot, q: Floats, path: Curve, depths: Floats) -> "LeaderQuestion":
        """Ask for shapes `q` (T, n, 3) that follow the curve.

        Raises
        ------
        InputError
            When their tips are not on the curve.
        """
        robot._refuse_load()  # differences of equilibria are not as exact as those of shapes
        body = robot.changed(tool=None)  # the tip is led, not the tool
        off = np.linalg.norm(body.tip(q)[:, :3, 3] - path.at(depths), axis=1)
        if off.max(initial=0.0) > OFF * len(robot) * robot.mean_length:
            i = int(np.argmax(off))
            told = f"at depth {depths[i]:g} the tip is {off[i]:.3g} off it"
            raise InputError("curve", told, path, "the one that this motion follows")
        return cls(body, path, depths)

    def shapes(self, near: Floats) -> Floats:
        """Shapes (T, n, 3) near others; NaN where none is found."""
        near = near.copy()
        low, high = self.robot.limits[:, :2].T
        near[..., 2] = np.clip(near[..., 2], low, high)
        fitted = fit_chains_along(self.robot, self.path, self.depths, near)
        tolerance = Tolerance(EXACT * self.robot.mean_length)
        solver = Solver(self.robot, tolerance=tolerance, max_starts=1, routes=False)
        found = solver.solve_many(positions=self.path.at(self.depths), initial=fitted, workers=1)
        return np.where(found.solved[:, None, None], found.configuration, np.nan)


class LeaderDerivative(ByGroups[LeaderParameter]):
    """Derivatives of shapes on a curve, by groups of parameters; see `Motion.derivative`.

    Attributes
    ----------
    wrt : tuple of str
        Columns of groups have `labels` like `curve[2].x`.
    regular : bool
        Whether all shapes have a derivative: not where a limit is touched, a place of the body is where the straight
        line in front ends, or the curve does not say how segments that stretch share the length.
    depths : ndarray (T,)
    configurations : ndarray (T, n, 3)
        The shapes that were derived: the least squares of the motion, carried on to their end.
    q : mapping of str to ndarray (T, n, 3, p)
        Derivatives of the configurations.
    """

    def __init__(self, question: LeaderQuestion, q: Floats, wrt: LeaderParameter | Iterable[LeaderParameter]) -> None:
        self.depths, self.configurations = question.depths, question.shapes(q)
        columns = {name: tuple(GROUPS[name](question)) for name in read_names(wrt, GROUPS)}
        nothing = np.empty((*self.configurations.shape, 0))
        unit = np.array([1.0, 1.0, question.robot.mean_length])
        regular = bool((np.abs(self.configurations - q) <= FARTHEST * unit).all())
        self.q: dict[LeaderParameter, Floats] = {}
        for name, listed in columns.items():
            derived = [self._derive(column) for column in listed]
            self.q[name] = np.concatenate([nothing, *(change[..., None] for change, _ in derived)], axis=-1)
            regular &= all(smooth for _, smooth in derived)
        super().__init__(columns, self.q, regular)

    def _derive(self, column: Column) -> tuple[Floats, bool]:
        """Change (T, n, 3) by one parameter; and whether it is the same to both sides."""
        h, here = STEP * column.scale, self.configurations
        after, before, later, sooner = (column.changed(share * h).shapes(here) for share in (1.0, -1.0, 0.5, -0.5))
        change: Floats = (8.0 * (later - sooner) - (after - before)) / (6.0 * h)
        bent, wider = np.abs(later + sooner - 2.0 * here).max(), np.abs(after + before - 2.0 * here).max()
        slight = ROUNDING + KINK * np.abs(later - sooner).max()
        return change, bool(bent <= slight or bent < SMOOTH * wider)


def _by_advance(question: LeaderQuestion) -> Iterator[Column]:
    deeper = lambda h: question._replace(depths=question.depths + h)  # noqa: E731
    yield Column("advance", question.robot.mean_length, deeper)


def _by_curve(question: LeaderQuestion) -> Iterator[Column]:
    points = question.path.points
    for i in range(_held(question.path), len(points)):
        for axis, name in enumerate("xyz"):

            def changed(h: float, i: int = i, axis: int = axis) -> LeaderQuestion:
                moved = points.copy()
                moved[i, axis] += h
                return question._replace(path=Curve(moved, question.path.start))

            yield Column(f"curve[{i}].{name}", question.robot.mean_length, changed)


def _held(path: Curve) -> int:
    """How many points of a curve are where the base is, and move with it."""
    return int(path.lead == 0.0)


def _by_base(question: LeaderQuestion) -> Iterator[Column]:
    def put(robot: Robot) -> LeaderQuestion:
        points, start = question.path.points.copy(), robot.base[:3, 3]
        points[: _held(question.path)] = start
        return question._replace(robot=robot, path=Curve(points, start))

    return motions_of_base(question.robot, put)


def _by_lengths(question: LeaderQuestion) -> Iterator[Column]:
    robot = question.robot
    for k, segment in enumerate(robot.segments):
        low, high = segment.length
        if low == high:

            def changed(h: float, k: int = k) -> LeaderQuestion:
                parts = [s.changed(length=s.length[0] + h) if j == k else s for j, s in enumerate(robot.segments)]
                return question._replace(robot=robot.changed(segments=parts))

            yield Column(f"{robot.segment_names[k]}.length", robot.mean_length, changed)


GROUPS: dict[LeaderParameter, Callable[[LeaderQuestion], Iterator[Column]]] = {
    "advance": _by_advance,
    "curve": _by_curve,
    "base": _by_base,
    "lengths": _by_lengths,
}
"""All groups of parameters.

- `advance`: how far the tip has gone along the curve;
- `curve`: of each point three; a first point that is the base moves with it, and is none of them;
- `base`: a small rotation about its own origin, in world axes (3), and the motion of that origin (3), while the curve
  stays;
- `lengths`: of each segment that cannot stretch its length.
"""
