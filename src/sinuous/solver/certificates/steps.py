"""What is proved of the motion between neighbouring configurations: linear in q, the whole body, all the way.

Of a robot under load it is the drive that is linear: what is proved are pieces of the way between two loaded shapes.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.frozen import call
from sinuous.base.progress import WORK_UNIT
from sinuous.kernels import packing
from sinuous.kernels import tables as k
from sinuous.kernels.body.proof import CLEAR, TOUCHING, UNDECIDED
from sinuous.kernels.certificate.courses import (
    COURSE,
    COURSE_POSE_WIDTH,
    COURSE_POSITION,
    COURSE_ROTATION,
    ONWARD,
    TIME,
    fill_drifts,
)
from sinuous.kernels.certificate.drift import OF, OWN_AXES, OWN_CENTER
from sinuous.kernels.certificate.query import ANSWER_WIDTH, CLEARANCES, UNTIL, VERDICT, certify_motions
from sinuous.kernels.certificate.sweep import (
    CLEARANCES_WIDTH,
    DRIFT_WIDTH,
    LEAST_SEEN,
    PROVED_BOUND,
    SEGMENT,
    WHEN,
    sweep_size,
)
from sinuous.kernels.packing import robot_parts
from sinuous.kernels.statics.layout import ARC_WORK
from sinuous.model.limits import LIMIT_ROUNDING
from sinuous.model.robot import Robot, robot_group
from sinuous.scene.moving import Course, Moving
from sinuous.scene.obstacles import Primitive
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.polylines import interpolate
from sinuous.statics.between import Leave, bounded, leave, stretches_between
from sinuous.statics.body import body_of
from sinuous.statics.equilibrium import longest_body
from sinuous.statics.rest import Rest, Way, kept_rests, stretches_allowed


class Drifts:
    """How the obstacles of a scene move, from time to time.

    Parameters
    ----------
    scene : Snapshot
    """

    def __init__(self, scene: Snapshot) -> None:
        self._courses = scene.courses
        self._row = np.zeros((len(self._courses), DRIFT_WIDTH))
        for e, i in enumerate(self._courses):
            obstacle = scene.obstacles[i]
            assert isinstance(obstacle, Moving)
            self._row[e, OF] = i
            if isinstance(obstacle.obstacle, Primitive):
                center, axes, *_ = obstacle.obstacle.frame
                self._row[e, OWN_CENTER : OWN_CENTER + 3] = center
                self._row[e, OWN_AXES : OWN_AXES + 9] = np.ravel(axes)
        self._poses = _poses(list(self._courses.values()))
        every = [course.times for course in self._courses.values()]
        self._turns = np.unique(np.concatenate(every)) if every else np.zeros(0)

    def __len__(self) -> int:
        return len(self._courses)

    def rows(self, times: Floats) -> Floats:
        """Drifts (T - 1, c, 31) from each of the times (T,) to the next; no course may have one of its own between."""
        rows = np.repeat(self._row[None], max(0, len(times) - 1), axis=0)
        fill_drifts(self._poses, np.array(times, np.float64), rows)
        return rows

    def divided(self, times: Floats) -> Floats:
        """Put between times (T,), which do not decrease, those at which a course has a pose of its own."""
        first, last = np.searchsorted(self._turns, times[0], "right"), np.searchsorted(self._turns, times[-1], "left")
        if first >= last:
            return times
        own = self._turns[first:last]
        fresh = own[~np.isin(own, times)]
        return np.sort(np.concatenate([times, fresh]), kind="stable") if len(fresh) else times


def _poses(courses: list[Course]) -> Floats:
    """Poses (P, 17) of courses, as the kernel reads them."""
    tables = []
    for number, course in enumerate(courses):
        poses = np.zeros((len(course.times), COURSE_POSE_WIDTH))
        poses[:, COURSE], poses[:, TIME] = number, course.times
        poses[:, COURSE_POSITION : COURSE_POSITION + 3] = course.positions
        turned = np.eye(3) if course.rotations is None else course.rotations
        poses[:, COURSE_ROTATION : COURSE_ROTATION + 9] = np.broadcast_to(turned, (len(poses), 3, 3)).reshape(-1, 9)
        poses[:-1, ONWARD : ONWARD + 3] = course.turns
        tables.append(poses)
    return np.concatenate(tables) if tables else np.zeros((0, COURSE_POSE_WIDTH))


def together(answers: Floats, times: Floats, finer: Floats) -> Floats:
    """Answers (T - 1, 14) about the steps between times (T,), of those (U - 1, 14) between finer ones (U,)."""
    step = np.clip(np.searchsorted(times, finer[:-1], side="right") - 1, 0, len(times) - 2)
    result = np.zeros((len(times) - 1, ANSWER_WIDTH))
    for i in range(len(result)):
        own = np.flatnonzero(step == i)
        begin, length = times[i], times[i + 1] - times[i]
        result[i] = joined(answers[own], (finer[own] - begin) / length, (finer[own + 1] - finer[own]) / length)
    return result


def joined(answers: Floats, begins: Floats, lengths: Floats) -> Floats:
    """One answer (14,) of those (u, 14) about the parts of a step, which begin at these shares of it."""
    joined: Floats = answers[0].copy()
    verdicts: NDArray[np.float64] = answers[:, VERDICT]
    unclear = np.flatnonzero(verdicts != CLEAR)
    joined[VERDICT], joined[UNTIL] = CLEAR, 1.0
    if len(unclear):
        first = unclear[0]
        joined[VERDICT] = TOUCHING if (verdicts == TOUCHING).any() else UNDECIDED
        joined[UNTIL] = begins[first] + lengths[first] * answers[first, UNTIL]
    for at in (CLEARANCES, CLEARANCES + CLEARANCES_WIDTH):
        nearest = int(answers[:, at + LEAST_SEEN].argmin())
        joined[at : at + CLEARANCES_WIDTH] = answers[nearest, at : at + CLEARANCES_WIDTH]
        joined[at + WHEN] = begins[nearest] + lengths[nearest] * answers[nearest, at + WHEN]
        joined[at + PROVED_BOUND] = answers[:, at + PROVED_BOUND].min()
    return joined


SLACK = 0.1
"""How far below the true clearance its proved bound may be, as a share of it."""

FINEST = 1e-7
"""Length, in robot lengths, below which a proof gives up."""

SECONDS = 0.05
"""Time that a step may take on average."""

LOOSE_SECONDS = 0.5
"""Time for the proof of a step that is only to be clear, without a tight bound."""

LIMIT_SLACK = 1e-9
"""By how much tensions of a motion may leave their limits, as a stretch in robot lengths: what knots may, too."""

SAMPLED = 3
"""Verdict beside those of `kernels.body.proof`: clear at all shapes that were looked at, and near these. No proof."""

SAMPLES = 17
"""Shapes, evenly spaced, at which a step is looked at whose way nothing bounds."""

HALVINGS = 6
"""How often a step is halved, so that equilibria stay nearer to the straight way, and the body is less thick."""

KEPT = 256
"""Shapes at knots that are kept."""


class StepPiece(NamedTuple):
    """A part of a step: shares where it begins and ends, both shapes (2, N, 3), and how far aside the body may be."""

    begin: float
    end: float
    arcs: Floats
    aside: float


class LoadedShapes:
    """Loaded shapes of a robot at drives and between them; those at the last drives are kept.

    Parameters
    ----------
    robot : Robot

    Attributes
    ----------
    at : callable
        The loaded body at a drive (n, 3), the same that `Robot.shape` gives.
    owners : ndarray of int (N,)
        The segment of every arc, 0 = first.
    bounded : bool
        Whether anything bounds how far equilibria move.
    """

    def __init__(self, robot: Robot) -> None:
        self.at = kept_rests(robot, KEPT)
        self.owners, self.bounded = body_of(robot).owners, bounded(robot)
        allowed = stretches_allowed(robot)
        slack = LIMIT_ROUNDING * robot.mean_length
        self._allowed = allowed + np.array([-slack, slack]) if np.isfinite(allowed).any() else None

    def keeps_tensions(self, one: Rest, other: Rest, left: Leave) -> bool:
        """Whether tensions stay within their limits on the way between two shapes, which the body leaves by so much."""
        if self._allowed is None:
            return True
        least, most = stretches_between(one, other, left).T
        return bool((least >= self._allowed[:, 0]).all() and (most <= self._allowed[:, 1]).all())


@dataclass
class WorkUnits:
    """What is left of the work that proofs of a loaded body may take, so that none depends on how busy a machine is."""

    left: float = 0.0


def prove_loaded_step(
    shapes: LoadedShapes, q0: Floats, q1: Floats, prove: Callable[[StepPiece], Floats], work: WorkUnits
) -> Floats:
    """Answer (14,) about a step: proved where every piece is, else `SAMPLED` where shapes are clear, else undecided.

    Parameters
    ----------
    q0, q1 : ndarray (n, 3)
    prove : callable
        Proves a piece for a body that is thicker by its `aside`.
    work : WorkUnits
        How long it is tried.
    """
    one, other = shapes.at(q0), shapes.at(q1)
    nothing: Floats = unproved(1)[0]
    if not (one.tensions_kept and other.tensions_kept):
        return nothing
    way = Way(one, other)
    done: list[tuple[float, float, Floats]] = []
    left = [(0.0, 1.0, one, other)] if shapes.bounded or one is other else []
    bounded = bool(left)
    while left:
        begin, last, a, b = left.pop()
        off, answer = leave(a, b), None
        if off.aside < np.inf and shapes.keeps_tensions(a, b, off):
            answer = prove(StepPiece(begin, last, np.stack([a.arcs, b.arcs]), off.aside))
            if answer[VERDICT] == CLEAR:
                done.append((begin, last, answer))
                continue
        middle = 0.5 * (begin + last)
        work.left -= ARC_WORK * len(shapes.owners)
        near = way.rest(middle) if last - begin > 0.5**HALVINGS and work.left > 0.0 else a
        if near is a or not near.tensions_kept or one is other:
            done.append((begin, last, nothing if answer is None else answer))
            bounded = answer is not None
            break
        left += [(middle, last, near, b), (begin, middle, a, near)]
    if bounded or (done and work.left <= 0.0):
        begins, ends = np.array([each[0] for each in done]), np.array([each[1] for each in done])
        return joined(np.array([each[2] for each in done]), begins, ends - begins)
    return _sampled(one, other, prove)


def _sampled(one: Rest, other: Rest, prove: Callable[[StepPiece], Floats]) -> Floats:
    """Look at shapes on the way, and from each to the next, as far aside as every other leaves its neighbours."""
    from sinuous.kernels.chain import batch  # noqa: PLC0415

    way = Way(one, other)
    rests = [one, *map(way.rest, np.linspace(0.0, 1.0, SAMPLES)[1:-1].tolist()), other]
    if not all(each.tensions_kept for each in rests):
        return unproved(1)[0]
    arcs = np.stack([each.arcs for each in rests])
    middles = np.ascontiguousarray(0.5 * (arcs[:-2:2] + arcs[2::2]))
    frames = np.empty((2, len(middles), arcs.shape[1] + 1, 12))
    base, plain = one.frames[:, 0].copy(), packing.plain_rows(arcs.shape[1])
    batch.frames_of(plain, np.ascontiguousarray(arcs[1::2]), base, frames[0])
    batch.frames_of(plain, middles, base, frames[1])
    aside = float(np.linalg.norm(frames[0, ..., 9:] - frames[1, ..., 9:], axis=-1).max())
    answers = []
    for i in range(SAMPLES - 1):
        begin = i / (SAMPLES - 1.0)
        answers.append(prove(StepPiece(begin, begin + 1.0 / (SAMPLES - 1.0), arcs[i : i + 2].copy(), aside)))
        if answers[-1][VERDICT] != CLEAR:
            break
    begins = np.arange(len(answers)) / (SAMPLES - 1.0)
    answer = joined(np.array(answers), begins, np.full(len(answers), 1.0 / (SAMPLES - 1.0)))
    answer[VERDICT], answer[UNTIL] = (SAMPLED if answer[VERDICT] == CLEAR else UNDECIDED), 0.0
    return answer


def is_passable(answer: Floats) -> bool:
    """Whether a robot may go this way, as far as is known: it is proved clear (14,), or at least `SAMPLED`."""
    return bool(answer[VERDICT] in (CLEAR, SAMPLED))


def unproved(count: int) -> Floats:
    """Answers (count, 14) about motions of which nothing is known."""
    answers = np.full((count, ANSWER_WIDTH), np.inf)
    answers[:, VERDICT], answers[:, UNTIL] = UNDECIDED, 0.0
    return answers


@dataclass(frozen=True, eq=False, repr=False)
class Steps:
    """What is proved of the motions between neighbouring configurations, in their order.

    Attributes
    ----------
    answers : ndarray (m, 14)
        What the kernel found, see `kernels.certificate.query`.
    demanded : (float, float)
        Clearance and self-clearance that the robot keeps in any case, from which those of the kernel count.
    """

    answers: Floats
    demanded: tuple[float, float] = (0.0, 0.0)

    @cached_property
    def proved(self) -> NDArray[np.bool_]:
        """Whether the body is proved clear of obstacles and of itself all the way (m,)."""
        return self.answers[:, VERDICT] == CLEAR

    @property
    def samples(self) -> NDArray[np.intp]:
        """At how many shapes each motion was looked at (m,) and found clear, where that is all: see `SAMPLED`."""
        return np.where(self.answers[:, VERDICT] == SAMPLED, SAMPLES, 0)

    @classmethod
    def told(
        cls,
        count: int,
        unproved: Sequence[int],
        clearance: float | None,
        self_clearance: float | None,
        demanded: tuple[float, float] = (0.0, 0.0),
    ) -> "Steps":
        """Make what somebody says: so many steps, numbers (1 = first) of those not proved, and bounds of all others."""
        answers = np.zeros((count, ANSWER_WIDTH))
        answers[:, VERDICT], answers[:, UNTIL] = CLEAR, 1.0
        answers[:, CLEARANCES] = math.inf if clearance is None else clearance - demanded[0]
        answers[:, CLEARANCES + CLEARANCES_WIDTH] = math.inf if self_clearance is None else self_clearance - demanded[1]
        wrong = np.array(unproved, np.intp) - 1
        answers[wrong, VERDICT], answers[wrong, UNTIL] = UNDECIDED, 0.0
        return cls(answers, demanded)

    @property
    def clearances(self) -> Floats:
        """Proved lower bounds of the clearance in each motion (m,); infinite without obstacles."""
        return self.answers[:, CLEARANCES] + self.demanded[0]

    @property
    def self_clearances(self) -> Floats:
        """Proved lower bounds of the self-clearance in each motion (m,); infinite where it does not matter."""
        return self.answers[:, CLEARANCES + CLEARANCES_WIDTH] + self.demanded[1]

    @property
    def room(self) -> tuple[Floats, Floats]:
        """The same two (m,), beyond what is demanded: by so much the body may come nearer."""
        return self.answers[:, CLEARANCES], self.answers[:, CLEARANCES + CLEARANCES_WIDTH]

    @property
    def clearance(self) -> float | None:
        """Proved lower bound of the clearance in all motions; `None` without obstacles or without a proof."""
        return self._least(self.clearances)

    @property
    def self_clearance(self) -> float | None:
        """Proved lower bound of the self-clearance in all motions; `None` where it is infinite, or without a proof."""
        return self._least(self.self_clearances)

    def reversed(self) -> "Steps":
        """Return the same for the motions backwards, in the opposite order."""
        answers = self.answers[::-1].copy()
        answers[:, UNTIL] = np.where(answers[:, VERDICT] == CLEAR, 1.0, 0.0)
        for seen in (CLEARANCES, CLEARANCES + CLEARANCES_WIDTH):
            answers[:, seen + WHEN] = 1.0 - answers[:, seen + WHEN]
        return Steps(answers, self.demanded)

    def __repr__(self) -> str:
        return call("Steps", [f"{int(self.proved.sum())} of {len(self.proved)} proved clear"])

    def _least(self, bounds: Floats) -> float | None:
        least = float(bounds.min(initial=math.inf))
        return least if self.proved.all() and math.isfinite(least) else None


class Prover:
    """Proves one motion after the other for a robot in a scene, without making anything anew.

    Where obstacles move, motions have times, and where these are between them is looked at in the same time. Of a robot
    under load it proves the loaded body: linear in the coordinates of its arcs, and as far aside of that as equilibria
    may be.

    `finest`: length, in robot lengths, below which a proof gives up. `owners` (N,): the segment of each of its arcs.
    """

    def __init__(self, robot: Robot, scene: Snapshot, finest: float = FINEST) -> None:
        self.scene = scene
        self._ways = LoadedShapes(robot) if robot.has_external_load else None
        body = longest_body(robot) if robot.has_external_load else robot
        self._group, self._scene_group = robot_group(body), scene.at(0.0)._kernel_group
        self._mount, self._finest = float(robot.mount), finest * robot.mean_length
        self._workspace = np.empty(sweep_size(len(body), len(scene)))
        self.owners = np.arange(len(robot)) if self._ways is None else self._ways.owners
        self._tensions, self._limit_slack = robot.limit_set.tension_rows, LIMIT_SLACK * robot.mean_length
        self._drifts, self._work = Drifts(scene) if scene.moves else None, WorkUnits()
        if self._drifts is not None:
            self._scene_group = scene.at(0.0).group_beside(scene.courses)  # rows of it are written

    def prove(
        self,
        knots: Floats,
        slack: float = SLACK,
        seconds: float = SECONDS,
        times: Floats | None = None,
        known: Floats | None = None,
    ) -> Floats:
        """Return answers (T - 1, 14) about the motions between neighbouring `knots`; see `prove_steps`.

        `known` (T, 2): proved clearances and self-clearances of the knots, beyond what is demanded; 0: not known.
        Bounds are no more than `slack` below these, then.
        """
        if self._ways is not None:
            self._work.left = seconds * (len(knots) - 1) / WORK_UNIT
            return self._prove_under_load(self._ways, knots, slack, times)
        answers = self._prove_in_time(knots, slack, seconds, times, known)
        self.keep_tensions(knots, answers)
        return answers

    def keep_tensions(self, knots: Floats, answers: Floats) -> None:
        """Take back what is proved (T - 1, 14) of steps between knots on which tensions may leave their limits."""
        rows, allowed = self._tensions, self._limit_slack
        if rows is None or not len(answers):
            return
        kept = rows.decoupled & (rows.most_between(knots[:-1], knots[1:]) <= allowed).all(axis=-1)
        for i in np.flatnonzero(~kept).tolist():
            share = rows.share_between(knots[i], knots[i + 1], allowed)
            if share < 1.0:
                answers[i, UNTIL] = min(answers[i, UNTIL], share)
                if answers[i, VERDICT] == CLEAR:
                    answers[i, VERDICT] = UNDECIDED

    def is_clear(self, one: Floats, other: Floats, seconds: float = LOOSE_SECONDS) -> bool:
        """Whether the motion from one configuration (n, 3) to another is proved clear, however narrow it is."""
        return bool(self.prove(np.stack([one, other]), 1.0, seconds)[0, VERDICT] == CLEAR)

    def _prove_in_time(
        self, knots: Floats, slack: float, seconds: float, times: Floats | None, known: Floats | None
    ) -> Floats:
        clear = np.zeros((len(knots), 2)) if known is None else known
        if self._drifts is None:
            return self._prove(knots, clear, np.empty((len(knots) - 1, 0, DRIFT_WIDTH)), slack, seconds)
        if times is None:
            raise InputError("times", "missing: obstacles move", None, "when the robot is at each knot")
        finer = self._drifts.divided(times)
        if len(finer) == len(times):
            return self._prove(knots, clear, self._drifts.rows(times), slack, seconds)
        divided = interpolate(times, knots, finer)
        answers = self._prove(divided, np.zeros((len(finer), 2)), self._drifts.rows(finer), slack, seconds)
        return together(answers, times, finer)

    def _prove(self, knots: Floats, known: Floats, drifts: Floats, slack: float, seconds: float) -> Floats:
        answers = np.zeros((len(knots) - 1, ANSWER_WIDTH))
        terms = self._mount, slack, self._finest, seconds * len(answers), self._work.left
        groups = self._group, self._scene_group, knots, known, drifts
        self._work.left = certify_motions(*groups, terms, self._workspace, answers)
        return answers

    def _prove_under_load(self, ways: LoadedShapes, knots: Floats, slack: float, times: Floats | None) -> Floats:
        """Prove the steps of a loaded body, each in as many pieces as it takes, while there is work left."""
        answers = unproved(len(knots) - 1)
        if self._drifts is not None and times is None:
            raise InputError("times", "missing: obstacles move", None, "when the robot is at each knot")
        for i in range(len(answers)):
            begin, more = (0.0, 0.0) if times is None else (float(times[i]), float(times[i + 1] - times[i]))

            def clear(piece: StepPiece, begin: float = begin, more: float = more) -> Floats:
                when = None if times is None else begin + more * np.array([piece.begin, piece.end])
                self._work.left = max(1.0, self._work.left)  # with none left, time would count
                return self._prove_piece(piece, slack, when)

            answers[i] = prove_loaded_step(ways, knots[i], knots[i + 1], clear, self._work)
        return answers

    def _prove_piece(self, piece: StepPiece, slack: float, times: Floats | None) -> Floats:
        """Prove the way linear in the coordinates of arcs (2, N, 3) for a body that is thicker by `piece.aside`."""
        rows = robot_parts(self._group).segments
        rows[:, k.MAX_LENGTH] = np.maximum(rows[:, k.MAX_LENGTH], piece.arcs[..., 2].max(axis=0))
        for column in (k.RADIUS, k.SELF_RADIUS):
            rows[:, column] += piece.aside
        try:
            answer: Floats = self._prove_in_time(piece.arcs, slack, 0.0, times, None)[0]
        finally:
            for column in (k.RADIUS, k.SELF_RADIUS):
                rows[:, column] -= piece.aside
        for at in (CLEARANCES, CLEARANCES + CLEARANCES_WIDTH):
            answer[at + SEGMENT] = self.owners[int(answer[at + SEGMENT])] if answer[at + SEGMENT] >= 0.0 else -1.0
        return answer


def prove_steps(
    robot: Robot, scene: Snapshot, knots: Floats, slack: float = SLACK, times: Floats | None = None
) -> Steps:
    """Prove the motions linear in q between neighbouring `knots` (T, n, 3), which are within all limits.

    `slack`: how far below the truth clearances may be, as a share of them; with 1 it is enough that they are greater
    than 0. `times` (T,) count where obstacles move; a step whose clearance is not bounded so tightly in this time is
    then proved clear at least, where that is possible.
    """
    prover, path = Prover(robot, scene), np.array(knots, np.float64)
    answers = prover.prove(path, slack, SECONDS, times)
    if times is not None and scene.moves:
        for i in np.flatnonzero(answers[:, VERDICT] == UNDECIDED).tolist():
            again = prover.prove(path[i : i + 2], 1.0, LOOSE_SECONDS, times[i : i + 2])[0]
            answers[i] = again if again[VERDICT] == CLEAR else answers[i]
    return Steps(answers, robot._least_clearances)


def load_motions(robot: Robot, scene: Snapshot) -> None:
    """Compile what proves motions, or load it."""
    prove_steps(robot, scene, np.zeros((1, len(robot), 3)), times=np.zeros(1))
