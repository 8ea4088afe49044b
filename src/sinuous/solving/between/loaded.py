"""Motions of a robot under load: pieces of the way between two loaded shapes, and what is proved of all of them."""

from collections import OrderedDict
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.between.query import ANSWER_WIDTH, UNTIL, VERDICT
from sinuous.kernels.body.proof import CLEAR, UNDECIDED
from sinuous.robot.robot import Robot
from sinuous.solving.between.drifts import joined
from sinuous.statics.between import bounded, leave
from sinuous.statics.body import body_of
from sinuous.statics.rest import Rest, Way
from sinuous.work_time import work_time

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


class Ways:
    """Loaded shapes of a robot at drives and between them; those at the last drives are kept.

    Parameters
    ----------
    robot : Robot

    Attributes
    ----------
    owners : ndarray of int (N,)
        The segment of every arc, 0 = first.
    bounded : bool
        Whether anything bounds how far equilibria move.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot, self._kept = robot, OrderedDict[bytes, Rest]()
        self.owners, self.bounded = body_of(robot).owners, bounded(robot)

    def at(self, q: Floats) -> Rest:
        """The loaded body at a drive (n, 3), the same that `Robot.shape` gives."""
        key = q.tobytes()
        found = self._kept.get(key)
        if found is None:
            found = self._kept[key] = Rest(self._robot, q.copy())
            if len(self._kept) > KEPT:
                self._kept.popitem(last=False)
        return found


def prove_way(ways: Ways, q0: Floats, q1: Floats, prove: Callable[[StepPiece], Floats], end: float) -> Floats:
    """Answer (14,) about a step: proved where every piece is, else `SAMPLED` where shapes are clear, else undecided.

    Parameters
    ----------
    q0, q1 : ndarray (n, 3)
    prove : callable
        Proves a piece for a body that is thicker by its `aside`.
    end : float
        When the time is over, see `work_time`.
    """
    one, other = ways.at(q0), ways.at(q1)
    nothing: Floats = unproved(1)[0]
    if one.states is None or other.states is None:
        return nothing
    way = Way(one, other)
    done: list[tuple[float, float, Floats]] = []
    left = [(0.0, 1.0, one, other)] if ways.bounded or one is other else []
    bounded = bool(left)
    while left:
        begin, last, a, b = left.pop()
        off, answer = leave(a, b), None
        if off.aside < np.inf:
            answer = prove(StepPiece(begin, last, np.stack([a.arcs, b.arcs]), off.aside))
            if answer[VERDICT] == CLEAR:
                done.append((begin, last, answer))
                continue
        middle = 0.5 * (begin + last)
        near = way.rest(middle) if last - begin > 0.5**HALVINGS and work_time() < end else a
        if near is a or near.states is None or one is other:
            done.append((begin, last, nothing if answer is None else answer))
            bounded = answer is not None
            break
        left += [(middle, last, near, b), (begin, middle, a, near)]
    if bounded or (done and work_time() >= end):
        begins, ends = np.array([each[0] for each in done]), np.array([each[1] for each in done])
        return joined(np.array([each[2] for each in done]), begins, ends - begins)
    return _sampled(one, other, prove)


def _sampled(one: Rest, other: Rest, prove: Callable[[StepPiece], Floats]) -> Floats:
    """Look at shapes on the way, and from each to the next, as far aside as every other leaves its neighbours."""
    from sinuous.kernels.chain import batch  # noqa: PLC0415

    way = Way(one, other)
    rests = [one, *map(way.rest, np.linspace(0.0, 1.0, SAMPLES)[1:-1].tolist()), other]
    if any(each.states is None for each in rests):
        return unproved(1)[0]
    arcs = np.stack([each.arcs for each in rests])
    middles = np.ascontiguousarray(0.5 * (arcs[:-2:2] + arcs[2::2]))
    frames = np.empty((2, len(middles), arcs.shape[1] + 1, 12))
    base = one.frames[:, 0].copy()
    batch.frames_of(np.ascontiguousarray(arcs[1::2]), base, frames[0])
    batch.frames_of(middles, base, frames[1])
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


def passes(answer: Floats) -> bool:
    """Whether a robot may go this way, as far as is known: it is proved clear (14,), or at least `SAMPLED`."""
    return bool(answer[VERDICT] in (CLEAR, SAMPLED))


def unproved(count: int) -> Floats:
    """Answers (count, 14) about motions of which nothing is known."""
    answers = np.full((count, ANSWER_WIDTH), np.inf)
    answers[:, VERDICT], answers[:, UNTIL] = UNDECIDED, 0.0
    return answers
