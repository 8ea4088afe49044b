"""Ways out of narrow places and into them: start and goals are drawn back along themselves, then trees join them."""

from collections.abc import Iterator
from itertools import count

import numpy as np

from sinuous.checks import Floats
from sinuous.motion.planning.question import Question
from sinuous.motion.planning.retreat import KINDS, Means, Retreat
from sinuous.solving.planning.trees import Trees, Way

DRAWS, MOST_DRAWS = 64, 2**20
"""Draws of the trees in the first turn, and the most in one turn; in each they are planted anew, with twice as many."""

OF_START = (2, 4)
"""Turns in which the start is drawn back, each time beginning with another kind of retreat; in others, a goal."""

ALONE = 4
"""Turns that trees have before: where there is room, they are there sooner."""

ROOTS = 12
"""Knots of one retreat that trees grow from."""


def withdrawn(question: Question) -> Iterator[Way | None]:
    """Yield a way that leads from the start, or from where it can be drawn back to, into a goal; see `Source`.

    Each turn a goal is drawn back with another kind of retreat, or the start.
    """
    yield from (None for _ in range(ALONE))
    join = _Join(question)
    for turn in count():
        join.draw_back(turn)
        yield join.grow(turn)


class _Join:
    """What is known of the way: how far the start and the goals can be drawn back."""

    def __init__(self, question: Question) -> None:
        self._question, self._means = question, Means(question)
        self._trees = Trees(question.robot, question.scene)
        self._outs: list[list[Floats]] = []
        self._ins: list[list[Floats]] = []

    def draw_back(self, turn: int) -> None:
        """Draw back a goal, or the start."""
        if turn in OF_START:
            self._outs.append(self._retreat(self._question.start, len(self._outs)))
            return
        number, kinds = turn - len(self._outs), len(KINDS)
        goals = self._question.goals(self._question.start[None])
        if number < kinds * len(goals):
            self._ins.append(self._retreat(goals[number // kinds], number % kinds))

    def _retreat(self, q: Floats, kind: int) -> list[Floats]:
        retreat = Retreat(self._means, q, kind)
        retreat.run()
        return retreat.knots

    def grow(self, turn: int) -> Way | None:
        """Let trees grow from the start, or the end of one of its retreats, to knots of the goals' retreats."""
        question = self._question
        if question.watch.seconds_left() <= 0.0:
            return None
        out = self._outs[turn // 2 % len(self._outs)] if self._outs and turn % 2 == 0 else [question.start]
        ends = np.stack([out[-1], *(q for knots in self._ins for q in _some(knots))])
        draws, seed = min(DRAWS << turn, MOST_DRAWS), (question.seed + turn) % 2**31
        way = self._trees.grow(ends, seed, (0, draws), question.watch.seconds_left())
        if way is None:
            return None
        q = [*out, *way.q[1:-1], *_into(self._ins, way.q[-1])]
        return self._trees.tighten(np.stack(q), question.seed, question.watch.seconds_left(), question.shortcuts)


def _some(knots: list[Floats]) -> list[Floats]:
    """Some of the knots, the last one first."""
    return [knots[i] for i in np.unique(np.linspace(len(knots) - 1, 0, ROOTS).round().astype(int))[::-1]]


def _into(retreats: list[list[Floats]], end: Floats) -> list[Floats]:
    """The knots from one of them into its goal."""
    for knots in retreats:
        for i, q in enumerate(knots):
            if np.array_equal(q, end):
                return knots[i::-1]
    raise AssertionError("trees grow from knots of retreats")
