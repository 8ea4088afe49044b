"""A robot that gets better step by step: its fields and its answers move together, by their derivatives.

An answer has to meet its target, within all limits and clear of all obstacles, whatever the fields of the robot are: so
say the rows of the implicit function theorem, and the answers have more coordinates than these take. A step is the
linear program of these rows for all tasks at once, in a box of changes that grows where steps succeed. Each is solved
and proved as any other robot.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from sinuous.answer.derivatives.parameters import KeptRows, plan_for
from sinuous.answer.residual import residual_of
from sinuous.base.checks import Floats
from sinuous.kernels.derivative import layout as a
from sinuous.kernels.packing import scales_of, turns_of
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem
from sinuous.studies.designing.judge import Judge, Judged, Objective, of_robot
from sinuous.studies.runs.engine import Arrays
from sinuous.studies.tasks.tasks import Meet

DERIVED = ("length", "bend", "travel", "tension", "clearance")
"""Objectives that a step is known for."""

MOST_STEPS = 30
"""Most steps."""

LARGEST_CHANGE, LEAST_CHANGE = 0.3, 1e-4
"""Largest change of a field in a step, as a share of its range, and the one from which on there is no other."""

FIRST_CHANGE, GROWTH, SHRINKAGE = 0.1, 2.0, 0.4
"""The change at first, and what becomes of it where a step succeeds, and where it does not."""

COORDINATE_RATIO = 2.0
"""Change of a coordinate of an answer, in the metric of motions, for each share of a range that fields may change."""

LEAST_GAIN = 1e-4
"""Share of the objective that a step has to gain to be followed by another."""

CONTACT_RANGE = 0.5
"""Distance of an obstacle, in mean lengths of the robot, from which on a step may forget it."""

KEPT_DISTANCE = 1e-3
"""Distance from obstacles that steps keep, in mean lengths of the robot."""

HALF_STEP = 1e-6
"""Half the step of differences of a robot, as a share of the ranges."""


class Descended(NamedTuple):
    """Where a descent ended.

    Attributes
    ----------
    shares : ndarray (d,)
    judged : Judged
    tried : int
        Robots that were judged.
    """

    shares: Floats
    judged: Judged
    tried: int


def can_descend(judge: Judge) -> bool:
    """Whether steps are known: targets to be met by a robot without load, and objectives that have derivatives."""
    return (
        len(judge.space.ranges) > 0
        and all(name in DERIVED for name in judge.minimise)
        and all(isinstance(task, Meet) for task in judge.tasks.values())
        and not judge.space.template.has_external_load
    )


def descend(judge: Judge, combination: tuple[Any, ...], shares: Floats, begin: Floats, which: int) -> Descended:
    """Lower the objective `which` of a robot without raising the other; `begin` (t, N, 3) are its answers."""
    judged = judge.judge(judge.space.robot(combination, shares), begin=begin)
    tried, most, steps = 1, FIRST_CHANGE, None
    for _ in range(MOST_STEPS):
        if judged.failed != -1 or most < LEAST_CHANGE:
            break
        steps = _Steps(judge, combination, shares, judged) if steps is None else steps
        step = steps.step(most, which)
        if step is None:
            most *= SHRINKAGE
            continue
        found = judge.judge(judge.space.robot(combination, step.shares), stops=True, begin=step.answers)
        tried += 1
        gained = judged.objectives[which] - found.objectives[which]
        rest = all(new <= old for new, old in zip(found.objectives, judged.objectives, strict=True))
        if not rest or gained <= 0.0:
            most *= SHRINKAGE
            continue
        small = gained < LEAST_GAIN * abs(judged.objectives[which])
        shares, judged, most, steps = step.shares, found, min(LARGEST_CHANGE, GROWTH * most), None
        if small:
            break
    return Descended(shares, judged, tried)


class Judging:
    """Judges chunks of robots, and leads some of them down; may be pickled and sent to workers.

    Parameters
    ----------
    judge : Judge
    """

    def __init__(self, judge: Judge) -> None:
        self.judge, self.scene = judge, judge.scene

    def prepare(self) -> "Judging":
        """Compile, or load, what judging needs."""
        self.judge.solver(self.judge.space.template)
        return self

    def __call__(self, raw: Arrays) -> Arrays:
        """Judge some robots, which are a part of `search.Drawn`, and what `judge` is told.

        Where one is a source of others, it is replaced by what a descent from it leads to.
        """
        told = raw["bounds"], raw["order"].tolist(), bool(raw["stops"])
        ended = []
        for i, shares, begin, source, which in zip(
            *(raw[key] for key in ("combination", "shares", "begin", "source", "which")), strict=True
        ):
            own = self.judge.space.combinations[int(i)]
            if source >= 0:
                ended.append(descend(self.judge, own, shares, begin, int(which)))
            else:
                robot = self.judge.space.robot(own, shares)
                ended.append(Descended(shares, self.judge.judge(robot, *told, begin=begin), 1))
        return {
            "shares": np.array([each.shares for each in ended]),
            "tried": np.array([each.tried for each in ended]),
            **{name: np.array([getattr(each.judged, name) for each in ended]) for name in Judged._fields},
        }


class _Step(NamedTuple):
    """A robot that is tried next: shares (d,), and where its answers (t, N, 3) are looked for."""

    shares: Floats
    answers: Floats


class _Rows(NamedTuple):
    """Rows `fields . ds + own . z <= shared . t + left`, of changes of fields, an answer, and what all answers share.

    The latter are the objectives, then the largest values of all actuators, then the least, where travel counts.
    """

    fields: Floats
    own: Floats
    shared: Floats
    left: Floats


class _Steps:
    """Steps from one robot: rows of all tasks, which serve boxes of any size."""

    def __init__(self, judge: Judge, combination: tuple[Any, ...], shares: Floats, judged: Judged) -> None:
        self._judge, self._shares, self._values = judge, shares, np.array(judged.objectives)
        space = judge.space
        robot = space.robot(combination, shares)
        assert robot is not None
        self._robot = judge.solver(robot).robot
        self._shared = len(judge.minimise) + 2 * len(self._robot.drive) * ("travel" in judge.minimise)
        self._ends = []
        for unit in np.eye(len(shares)):
            high, low = np.minimum(shares + HALF_STEP * unit, 1.0), np.maximum(shares - HALF_STEP * unit, 0.0)
            pair = [space.robot(combination, each) for each in (high, low)]
            solved = [judge.solver(each).robot for each in pair if each is not None]
            self._ends.append((solved[0], solved[-1], float((high - low).sum())))
        self._scale, self._turns = scales_of(self._robot.limits).ravel(), turns_of(self._robot.limits)
        self._moved = self._by_fields(_parameters)
        n = len(self._robot)
        fixed = np.flatnonzero(self._scale[2::3] == 0.0)
        self._direct = np.zeros((3 * n, len(shares)))
        self._direct[3 * fixed + 2] = self._moved[6 + fixed]
        self._answers = [each[:n] for each in judged.answers]
        self._equal, self._most = [], []
        tasks = [task for task in judge.tasks.values() if isinstance(task, Meet)]
        for task, q in zip(tasks, self._answers, strict=True):
            problem = Problem(self._robot, task.targets, judge.scene)
            self._equal.append(self._of_targets(problem, q))
            parts = [self._of_limits(q), *self._of_contacts(problem, q), *self._of_objectives(q)]
            self._most.append(self._all(parts))

    def step(self, most: float, which: int) -> _Step | None:
        """Return the best step by the rows, with fields that change by at most `most` of their range."""
        from scipy.optimize import linprog  # noqa: PLC0415

        d, o, width = len(self._shares), self._shared, len(self._scale)
        far = COORDINATE_RATIO * most
        near = [self._within(rows, most, far) for rows in self._most]
        equal, bounds = self._matrix(self._equal), self._matrix(near)
        tops = np.tile([-np.inf, np.inf], (o, 1))
        tops[: len(self._values), 1] = self._values
        fields = np.column_stack([np.maximum(-most, -self._shares), np.minimum(most, 1.0 - self._shares)])
        answers = np.tile([-far, far], (len(self._answers) * width, 1))
        cost = np.zeros(d + o + len(answers))
        cost[d + which] = 1.0
        found: Any = linprog(
            cost,
            A_ub=bounds,
            b_ub=np.concatenate([rows.left for rows in near]),
            A_eq=equal,
            b_eq=np.concatenate([rows.left for rows in self._equal]),
            bounds=list(map(tuple, np.concatenate([fields, tops, answers]).tolist())),
            method="highs",
        )
        if found.x is None:
            return None
        change = found.x[:d]
        moved = self._direct @ change + (self._scale * found.x[d + o :].reshape(-1, width)) @ self._turns.T
        whole = np.full((len(moved), self._judge.space.segments, 3), np.nan)
        whole[:, : len(self._robot)] = np.array(self._answers) + moved.reshape(len(moved), -1, 3)
        return _Step(np.clip(self._shares + change, 0.0, 1.0), whole)

    def _matrix(self, blocks: list[_Rows]) -> Any:
        from scipy import sparse  # noqa: PLC0415

        shared = np.vstack([np.column_stack([rows.fields, -rows.shared]) for rows in blocks])
        return sparse.hstack(
            [sparse.csr_array(shared), sparse.block_diag([sparse.csr_array(rows.own) for rows in blocks])], "csr"
        )

    @staticmethod
    def _within(rows: _Rows, most: float, far: float) -> _Rows:
        """The rows that changes within a box can reach."""
        reach = most * np.abs(rows.fields).sum(axis=1) + far * np.abs(rows.own).sum(axis=1)
        chosen = (rows.left <= reach) | rows.shared.any(axis=1)
        return _Rows(*(each[chosen] for each in rows))

    @staticmethod
    def _all(parts: list[_Rows]) -> _Rows:
        return _Rows(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))

    def _by_fields(self, of: Any) -> Floats:
        """Derivatives (k, d) of what `of` says of a robot, relative to another one, by the shares."""
        ends = [(of(high, low) - of(low, low)) / way for high, low, way in self._ends]
        return np.stack(ends, axis=1)

    def _rows(
        self, fields: Floats, own: Floats, left: Floats, name: Objective | None = None, shared: Floats | None = None
    ) -> _Rows:
        """Rows for coordinates in the where lengths that fields fix move by themselves."""
        tops = np.zeros((len(left), self._shared)) if shared is None else shared
        if name is not None:
            tops[:, self._judge.minimise.index(name)] = 1.0
        return _Rows(fields + own @ self._direct, (own @ self._turns) * self._scale, tops, left)

    def _of_targets(self, problem: Problem, q: Floats) -> _Rows:
        missed = residual_of(problem, q)
        change = self._by_fields(lambda robot, _: residual_of(Problem(robot, problem.targets), q).value)
        return self._rows(-change, missed.jacobian, missed.value)

    def _of_limits(self, q: Floats) -> _Rows:
        listed = [each for each in self._robot.limit_set.sides(q) if not each.fixed]
        slopes = np.array([each.gradient.ravel() for each in listed]).reshape(-1, q.size)
        change = self._by_fields(lambda robot, _: np.array([e.slack for e in robot.limit_set.sides(q) if not e.fixed]))
        return self._rows(-change, slopes, np.array([each.slack for each in listed]))

    def _of_contacts(self, problem: Problem, q: Floats) -> list[_Rows]:
        if not len(problem.scene):
            return []
        plan = plan_for(problem, ("base", "lengths", "radii"))
        found = KeptRows.found(problem, plan, q, CONTACT_RANGE * self._robot.mean_length)
        factor = found.about[:, a.ROW_FACTOR][:, None]
        rows, left = found.rows / factor, found.about[:, a.ROW_SLACK] + CONTACT_RANGE * self._robot.mean_length
        fields = found.sides / factor @ self._moved
        listed = [self._rows(fields, -rows, left - KEPT_DISTANCE * self._robot.mean_length)]
        if "clearance" in self._judge.minimise:
            listed.append(self._rows(fields, -rows, left, "clearance"))
        return listed

    def _of_objectives(self, q: Floats) -> list[_Rows]:
        """Rows of what an answer, or the robot, has of the objectives but clearance."""
        listed = []
        for name, of in MEASURED.items():
            if name in self._judge.minimise:
                value, slopes, change = self._by_answer(of, q)
                listed.append(self._rows(change, slopes, -value, name))
        if "travel" in self._judge.minimise:  # between the largest and the least value of each actuator of all answers
            value, slopes, change = self._by_answer(_values, q)
            m, o = len(value) // 2, len(self._values)
            largest, least = np.eye(m, self._shared, o), np.eye(m, self._shared, o + m)
            ends = np.concatenate([largest, -least])
            listed.append(self._rows(change, slopes, -value, shared=ends))
            rest = _values(self._robot, self._robot.straight[None])[0]
            change = self._by_fields(lambda robot, _: _values(robot, robot.straight[None])[0])
            listed.append(self._rows(change, 0.0 * slopes, -rest, shared=ends))
            listed.append(self._rows(0.0 * change[:m], 0.0 * slopes[:m], np.zeros(m), "travel", least - largest))
        return listed

    def _by_answer(self, of: Any, q: Floats) -> tuple[Floats, Floats, Floats]:
        """What `of` says (m,) of an answer, and its derivatives (m, 3 n) by the answer and (m, d) by the shares."""
        steps = HALF_STEP * np.where(self._scale > 0.0, self._scale, 1.0)
        places = q + np.concatenate([np.diag(steps), -np.diag(steps)]).reshape(-1, *q.shape)
        above, below = np.split(of(self._robot, places), 2)
        slopes = ((above - below) / (2.0 * steps[:, None])).T
        return of(self._robot, q[None])[0], slopes, self._by_fields(lambda robot, _: of(robot, q[None])[0])


def _values(robot: Robot, q: Floats) -> Floats:
    """Values (k, 2 m) of all actuators in configurations (k, n, 3), and with the other sign."""
    return _both_signs(robot.drive.values(q))


def _tensions(robot: Robot, q: Floats) -> Floats:
    """Tensions (k, 2 m) of all elastic actuators in configurations (k, n, 3), and with the other sign."""
    elastic = robot.drive.elastic
    assert elastic is not None
    return _both_signs(elastic.balance(q).tensions)


def _both_signs(values: Floats) -> Floats:
    return np.concatenate([values, -values], axis=1)


MEASURED: dict[Objective, Callable[[Robot, Floats], Floats]] = {
    "bend": lambda robot, q: np.hypot(q[..., 0], q[..., 1]),
    "length": lambda robot, q: np.full((len(q), 1), of_robot("length", robot)),
    "tension": _tensions,
}
"""Objectives that are the largest of what configurations (k, n, 3) of a robot have: (k, m)."""


def _parameters(robot: Robot, other: Robot) -> Floats:
    """What contacts depend on: the base, as a small motion from that of another robot, lengths, radii."""
    turn = robot.base[:3, :3] @ other.base[:3, :3].T
    small = 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    lengths = [0.5 * sum(each.length) for each in robot.rows]
    return np.concatenate([small, robot.base[:3, 3], lengths, robot.radii])
