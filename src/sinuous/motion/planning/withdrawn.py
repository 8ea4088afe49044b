"""Ways out of narrow places and into them: start and goals are drawn back along themselves, then trees join them."""

from collections.abc import Iterator
from itertools import count

import numpy as np

from sinuous.checks import Floats
from sinuous.motion.configurations import lever_metric
from sinuous.motion.planning.ends import Chain, Ends, roots_of
from sinuous.motion.planning.question import Question
from sinuous.motion.planning.retreat import KINDS, Retreat
from sinuous.motion.planning.yielding import Yielding
from sinuous.solving.planning.trees import Trees, Way

DRAWS, MOST_DRAWS = 256, 2**20
"""Draws of the trees in the first turn, and the most in one turn; in each they are planted anew, with twice as many."""

OF_START = (2, 4)
"""Turns in which the start is drawn back, each time beginning with another kind of retreat; in others, a goal."""

ALONE = 2
"""Turns that trees have before, where no end is in a narrow place: they are there sooner."""

STEPS = 16
"""Steps of the first retreat in its first turn. Trees from ends that have room may be there before it goes on, so they
have two turns then."""

PAIRS, MOST_PAIRS = 24, 192
"""Draws of the trees that give way in a turn that has drawn back an end, and in others: a retreat of another kind often
leads to where it takes few of them. In the first turn they have none: plain trees are sooner where they get there."""

ROOTS = 12
"""Knots of one retreat that trees grow from."""


def withdrawn(question: Question, ends: Ends) -> Iterator[Way | None]:
    """Yield a way that leads from the start, or from where it can be drawn back to, into a goal; see `Source`.

    A goal is drawn back with another kind of retreat each turn, or the start.
    """
    join = _Join(question, ends)
    if not ends.narrow:
        yield from (None for _ in range(ALONE))
    for turn in count():
        yield from join.draw_back(turn)
        way = join.grow(turn)
        yield join.give_way(turn) if way is None else way


class _Join:
    """What is known of the way: how far the start and the goals can be drawn back."""

    def __init__(self, question: Question, ends: Ends) -> None:
        self._question, self._ends = question, ends
        self._trees = Trees(question.robot, question.scene)
        self._outs: list[Chain] = []
        self._ins: list[Chain] = []
        self._yielding = Yielding(ends.means, question.seed)

    def draw_back(self, turn: int) -> Iterator[None]:
        """Draw back a goal, or the start; `None` where a turn ends before that does."""
        if turn in OF_START:
            other = self._ends.goals(self._question.start[None])[0][-1]
            yield from self._retreat(self._ends.start, other, len(self._outs), self._outs)
            return
        number, kinds = turn - len(self._outs), len(KINDS)
        goals = self._ends.goals(self._question.start[None])
        if number < kinds * len(goals):
            yield from self._retreat(goals[number // kinds], self._ends.start[-1], number % kinds, self._ins)

    def _retreat(self, eased: Chain, other: Floats, kind: int, retreats: list[Chain]) -> Iterator[None]:
        retreat = Retreat(self._ends.means, eased[-1], kind, other)
        if not self._ins and not retreat.run(STEPS):
            yield None
            yield None
        retreat.run()
        retreats.append([*eased[:-1], *retreat.knots])

    def grow(self, turn: int) -> Way | None:
        """Let trees grow from the start, or the end of one of its retreats, to knots of the goals' retreats."""
        question = self._question
        if question.watch.seconds_left() <= 0.0:
            return None
        out = self._outs[turn // 2 % len(self._outs)] if self._outs and turn % 2 == 0 else self._ends.start
        roots = roots_of(out, [[q] for knots in self._ins for q in self._some(knots, out[-1])])
        draws, seed = min(DRAWS << turn, MOST_DRAWS), (question.seed + turn) % 2**31
        way = self._trees.grow(roots, seed, (0, draws), question.watch.seconds_left())
        if way is None:
            return None
        return self._ends.whole(self._trees, [*out, *way.q[1:-1], *_into(self._ins, way.q[-1])])

    def give_way(self, turn: int) -> Way | None:
        """Let trees whose bodies give way grow from the start and its retreats, and from the goals'."""
        new = turn == len(self._outs) + len(self._ins) - 1
        self._yielding.plant(0, [self._ends.start, *self._outs])
        self._yielding.plant(1, self._ins)
        found = self._yielding.grow(0 if turn == 0 else PAIRS if new else MOST_PAIRS)
        return None if found is None else self._ends.whole(self._trees, found)

    def _some(self, knots: Chain, out: Floats) -> Chain:
        """Some of the knots, the last one first, and the one that is nearest to a configuration (n, 3)."""
        some = np.linspace(len(knots) - 1, 0, ROOTS).round().astype(int)
        squares = np.square((np.stack(knots) - out) * lever_metric(self._question.robot)).sum(axis=(1, 2))
        return [knots[i] for i in np.unique(np.append(some, squares.argmin()))[::-1]]


def _into(retreats: list[Chain], end: Floats) -> Chain:
    """The knots from one of them into its goal."""
    for knots in retreats:
        for i, q in enumerate(knots):
            if np.array_equal(q, end):
                return knots[i::-1]
    raise AssertionError("trees grow from knots of retreats")
