"""How obstacles move between the knots of a motion, as the kernels read it: see `kernels.certificate.drift`."""

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
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
from sinuous.kernels.certificate.query import ANSWER_WIDTH, CLEARANCES, UNTIL, VERDICT
from sinuous.kernels.certificate.sweep import CLEARANCES_WIDTH, DRIFT_WIDTH, LEAST_SEEN, PROVED_BOUND, WHEN
from sinuous.scene.moving import Course, Moving
from sinuous.scene.obstacles import Primitive
from sinuous.scene.snapshot import Snapshot


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


def divided_knots(knots: Floats, times: Floats, finer: Floats) -> Floats:
    """Configurations (U, n, 3) of a motion at finer times (U,), among which are those of its knots (T, n, 3)."""
    step = np.clip(np.searchsorted(times, finer, side="right") - 1, 0, len(times) - 2)
    share = ((finer - times[step]) / (times[step + 1] - times[step]))[:, None, None]
    return (1.0 - share) * knots[step] + share * knots[step + 1]


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
