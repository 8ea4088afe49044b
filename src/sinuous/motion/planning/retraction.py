"""Retraction out of narrow places: the start and the goals are drawn back along themselves, then trees join them.

The tip goes back along the curve that the body makes, and the body slides back with it, the more the nearer it is to
the tip; the rest gives way as little as it can, pushed off by obstacles. A robot that cannot stretch bends more,
outside. Backwards, it is the motion into the place.
"""

from collections.abc import Iterator
from itertools import count
from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.planning.sliding import slide_back, sliding_size
from sinuous.model.robot import Robot, robot_group
from sinuous.motion.configurations import lever_metric
from sinuous.motion.planning.contact_retraction import ContactRetractionTrees
from sinuous.motion.planning.local_planner import CLEARANCES, LocalPlanner, QueryEnds, roots_of
from sinuous.motion.planning.query import ProvedPath, Query
from sinuous.motion.planning.rrt_connect import RRTConnect, lead_on, shortened
from sinuous.motion.planning.tree import Chain
from sinuous.problem.target import Target
from sinuous.solver.polylines import lengths_along

FIRST, LONGEST, SHORTEST = 0.01, 0.05, 1e-3
"""Steps of the tip, in robot lengths: twice as long after one that succeeds, half as long after one that does not."""

ENOUGH = 0.02
"""What is left in front of the tip of a body that is drawn back altogether, in robot lengths."""

BEFORE = 0.5
"""What is as near before the tip of the other end slides, too, in segments."""

MOST_STEPS = 100_000
"""Steps of one retraction."""

OF_CURVE = 20
"""Points of the curve on each segment."""

FIRST_GOALS = 2
"""Goals that are drawn back a little in the first turn of all."""

FIRST_DRAWS = 64
"""Draws of the trees that grow to a goal that was drawn back a little, in the first turn of all."""

DRAWS, MOST_DRAWS = 256, 2**20
"""Draws of the trees in the first turn, and the most in one turn; in each they are planted anew, with twice as many."""

TURNS_OF_START = (2, 4)
"""Turns in which the start is drawn back, each time beginning with another kind of retraction; in others, a goal."""

TURNS_BEFORE = 2
"""Turns that straight trees have before, where no end is in a narrow place: they are there sooner."""

FIRST_STEPS = 16
"""Steps of the first retraction in its first turn. Straight trees from ends with room may be there before it goes on,
so they have two turns then."""

RETRACTED_DRAWS, MOST_RETRACTED_DRAWS = 24, 192
"""Draws of the contact-retraction trees in a turn that has drawn back an end, and in others: a retraction of another
kind often leads to where it takes few of them. In the first turn they have none: straight trees are sooner where they
get there."""

ROOTS = 12
"""Knots of one retraction that trees grow from."""


class RetractionKind(NamedTuple):
    """How a body is led back.

    Attributes
    ----------
    slides : bool
        Whether each step begins with the body slid back along itself, or with the body where it is.
    points : bool
        Whether its tip points along the curve, or where it likes.
    meets : bool
        Whether only what is beyond the tip of the other end slides, and the rest goes to where it is there.
    """

    slides: bool
    points: bool
    meets: bool = False


KINDS = (
    RetractionKind(True, False, True),
    RetractionKind(True, False),
    RetractionKind(True, True, True),
    RetractionKind(True, True),
    RetractionKind(False, False),
    RetractionKind(False, True),
)
"""What is tried first, and, where that is stuck, what goes on from there: all of them with most room, then with less.
"""

WAYS = len(KINDS) * (len(CLEARANCES) + 1)
"""Kinds, each with every room."""


class Retraction:
    """The knots of a body that is drawn back along itself, as far as that goes.

    Parameters
    ----------
    local : LocalPlanner
    q : ndarray (n, 3)
        Where it begins: within all limits and clear.
    kind : int
        With which of the `KINDS` it begins.
    other : ndarray (n, 3)
        The other end of the path. The place of the curve beside its tip is where kinds that meet it are with the tip
        when the rest of the body is as it is there.

    Attributes
    ----------
    knots : list of ndarray (n, 3)
        The motion from each to the next is proved clear.
    left : float
        What is left of the curve in front of the tip (length unit).
    """

    def __init__(self, local: LocalPlanner, q: Floats, kind: int, other: Floats) -> None:
        self._local, self._way, self._first = local, 0, kind
        self._points = local.robot.backbone(q, OF_CURVE)
        self._along = lengths_along(self._points)
        self._other = other
        apart = np.linalg.norm(self._points - local.robot.tip(other)[:3, 3], axis=1)
        self._beside = float(self._along[apart.argmin()])
        self._step, self._stuck = FIRST * local.robot.mean_length, 0
        self.left = float(self._along[-1])
        self.knots = [q]

    def run(self, steps: int = MOST_STEPS, shortest: float = 0.0) -> bool:
        """Draw the body back by so many more steps, also such as fail, while there is time; say whether it is done.

        It stops where steps would be shorter than `shortest` (robot lengths).
        """
        unit = self._local.robot.mean_length
        for _ in range(steps):
            if self._step < shortest * unit:
                return False
            if self.left <= ENOUGH * unit or self._stuck == WAYS or self._local.deadline.left() <= 0.0:
                return True
            if self._goes_to(max(0.0, self.left - self._step)):
                self._step, self._stuck = min(2.0 * self._step, LONGEST * unit), 0
            elif self._step > SHORTEST * unit:
                self._step *= 0.5
            else:
                self._way, self._step, self._stuck = (self._way + 1) % WAYS, FIRST * unit, self._stuck + 1
        return False

    def _goes_to(self, along: float) -> bool:
        """Lead the tip to a place of the curve, if there is a proved motion."""
        local, q = self._local, self.knots[-1]
        kind = KINDS[(self._first + self._way) % len(KINDS)]
        room = (*CLEARANCES, 0.0)[self._way // len(KINDS)]
        begin = self._slid_back(self.left - along, kind.meets) if kind.slides else q
        new = local.lead(self._target(along, kind), begin, room)
        if new is None or not local.is_clear(q, new):
            return False
        self.knots.append(new)
        self.left = along
        return True

    def _slid_back(self, by: float, meets: bool) -> Floats:
        """The body, slid back; of one that meets the other end, what is before that one's tip goes there instead."""
        q, robot = self.knots[-1], self._local.robot
        n, weights = len(q), np.arange(1, len(q) + 1) / len(q)
        if not meets:
            return slid_back(robot, q, by, weights, np.zeros((n, 3)))
        places = self.left - np.append(np.cumsum(q[:0:-1, 2])[::-1], 0.0)
        weights[places < self._beside - BEFORE * robot.mean_length / n] = 0.0
        weights[-1] = 1.0
        left = self.left - self._beside
        share = min(1.0, by / left) if left > 0.0 else 0.0
        return slid_back(robot, q, by, weights, share * (self._other - q))

    def _target(self, along: float, kind: RetractionKind) -> Target:
        i = int(np.clip(np.searchsorted(self._along, along), 1, len(self._along) - 1))
        before, piece = self._points[i - 1], self._points[i] - self._points[i - 1]
        length = float(self._along[i] - self._along[i - 1])
        place = before + ((along - self._along[i - 1]) / length if length > 0.0 else 0.0) * piece
        return Target(place, direction=piece) if kind.points else Target(place)


def slid_back(robot: Robot, q: Floats, by: float, weights: Floats, wished: Floats) -> Floats:
    """Return the configuration (n, 3) whose ends of segments have gone back along their tangents, as far as they can.

    See `kernels.planning.sliding.slide_back`.
    """
    workspace, back = np.empty(sliding_size(len(robot))), np.empty((len(robot), 3))
    begin = np.array(q, order="C")
    slide_back(robot_group(robot), begin, by, weights, wished, robot.mean_length, workspace, back)
    return back


def retraction(query: Query, ends: QueryEnds) -> Iterator[ProvedPath | None]:
    """Yield a path from the start, or from where it can be drawn back to, into a goal, or `None` after each turn.

    Each turn draws back a goal, or the start, with another kind of retraction; then straight trees and
    contact-retraction trees join what is known. See `planners.find_path`.
    """
    join = _Join(query, ends)
    path = join.begin()
    if path is not None or not ends.narrow:
        yield path
        yield from (None for _ in range(TURNS_BEFORE - 1))
    for turn in count():
        yield from join.draw_back(turn)
        path = join.grow(turn)
        yield join.grow_retracted(turn) if path is None else path


class _Join:
    """How far the start and the goals can be drawn back, and trees that join them."""

    def __init__(self, query: Query, ends: QueryEnds) -> None:
        self._query, self._ends = query, ends
        self._trees = RRTConnect(query.robot, query.scene)
        self._retracted = ContactRetractionTrees(ends.local, query.seed)
        self._outs: list[Chain] = []
        self._ins: list[Chain] = []

    def begin(self) -> ProvedPath | None:
        """Draw back the first goals a little, from where they are, and let straight trees grow from the start to there.

        The last one first: what was solved without the start has fewer folds. Arms of links alone do not slide along
        themselves, and trees are there sooner.
        """
        query, path = self._query, None
        if not query.robot.segments:
            return None
        for goal in query.goals(query.start[None])[FIRST_GOALS - 1 :: -1]:
            if path is None and query.deadline.left() > 0.0:
                made = Retraction(self._ends.local, goal, 0, query.start)
                made.run(FIRST_STEPS, FIRST)
                roots = roots_of([query.start], [[q] for q in self._some(made.knots, query.start)])
                path = self._trees.grow(roots, query.seed, (0, FIRST_DRAWS), query.deadline)
                path = None if path is None else lead_on(query, self._trees, [query.start], path, [made.knots])
        return path

    def draw_back(self, turn: int) -> Iterator[None]:
        """Draw back a goal, or the start; `None` where a turn ends before that does."""
        goals = self._ends.goals(self._query.start[None])
        if turn in TURNS_OF_START:
            yield from self._draw_back(self._ends.start, goals[0][-1], len(self._outs), self._outs)
            return
        number, kinds = turn - len(self._outs), len(KINDS)
        if number < kinds * len(goals):
            yield from self._draw_back(goals[number // kinds], self._ends.start[-1], number % kinds, self._ins)

    def _draw_back(self, end: Chain, other: Floats, kind: int, retractions: list[Chain]) -> Iterator[None]:
        made = Retraction(self._ends.local, end[-1], kind, other)
        if not self._ins and not made.run(FIRST_STEPS):
            yield None
            yield None
        made.run()
        retractions.append([*end[:-1], *made.knots])

    def grow(self, turn: int) -> ProvedPath | None:
        """Let straight trees grow from the start, or the end of one of its retractions, to knots of the goals'."""
        query = self._query
        if query.deadline.left() <= 0.0:
            return None
        out = self._outs[turn // 2 % len(self._outs)] if self._outs and turn % 2 == 0 else self._ends.start
        roots = roots_of(out, [[q] for knots in self._ins for q in self._some(knots, out[-1])])
        draws, seed = min(DRAWS << turn, MOST_DRAWS), (query.seed + turn) % 2**31
        path = self._trees.grow(roots, seed, (0, draws), query.deadline)
        return None if path is None else lead_on(query, self._trees, out, path, self._ins)

    def grow_retracted(self, turn: int) -> ProvedPath | None:
        """Let contact-retraction trees grow from the start and its retractions, and from the goals'."""
        new = turn == len(self._outs) + len(self._ins) - 1
        self._retracted.plant(0, [self._ends.start, *self._outs])
        self._retracted.plant(1, self._ins)
        found = self._retracted.grow(0 if turn == 0 else RETRACTED_DRAWS if new else MOST_RETRACTED_DRAWS)
        return None if found is None else shortened(self._query, self._trees, found)

    def _some(self, knots: Chain, out: Floats) -> Chain:
        """Some of the knots, the last one first, and the one that is nearest to a configuration (n, 3)."""
        some = np.linspace(len(knots) - 1, 0, ROOTS).round().astype(int)
        squares = np.square((np.stack(knots) - out) * lever_metric(self._query.robot)).sum(axis=(1, 2))
        return [knots[i] for i in np.unique(np.append(some, squares.argmin()))[::-1]]
