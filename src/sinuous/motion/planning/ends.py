"""The ends of a plan with room around them: what trees grow from where the ends themselves are too near to contact."""

from functools import cached_property

import numpy as np

from sinuous.checks import Floats
from sinuous.motion.planning.means import Means
from sinuous.motion.planning.question import Question
from sinuous.solving.planning.trees import Trees, Way

Chain = list[Floats]
"""Configurations (n, 3); the motion from each to the next is proved clear, and so is the one back."""


class Ends:
    """The start and the goals of a question, each with a chain from it to where there is room.

    Parameters
    ----------
    question : Question

    Attributes
    ----------
    narrow : bool
        Whether trees that grew a little did not come far from one of them; who grows trees says so.
    """

    def __init__(self, question: Question) -> None:
        self._question, self.narrow = question, False
        self._chains: dict[bytes, Chain] = {}

    @cached_property
    def means(self) -> Means:
        """What they are moved with."""
        return Means(self._question)

    @property
    def start(self) -> Chain:
        """The chain of the start."""
        return self.eased(self._question.start)

    def eased(self, q: Floats) -> Chain:
        """The chain of any configuration (n, 3)."""
        key = q.tobytes()
        if key not in self._chains:
            self._chains[key] = self.means.eased(q)
        return self._chains[key]

    def goals(self, reached: Floats) -> list[Chain]:
        """The chains of all goals, after looking for more; see `Question`."""
        return [self.eased(q) for q in self._question.goals(reached)]

    def joined(self, trees: Trees, into: list[Chain], known: int, seed: int, draws: tuple[int, int]) -> Way | None:
        """Let trees grow from the end of the start's chain to those of goals, and lead a way on into the ends.

        `known`: how many of the goals are in the trees already.
        """
        question, out = self._question, self.start
        alone = len(out) == 1 and all(len(chain) == 1 for chain in into)
        shortcuts = question.shortcuts if alone else 0
        way = trees.grow(roots_of(out, into[known:]), seed, draws, question.watch.seconds_left(), shortcuts)
        if way is None or alone:
            return way
        last = next(chain for chain in into if np.array_equal(chain[-1], way.q[-1]))
        return self.whole(trees, [*out[:-1], *way.q, *last[-2::-1]])

    def whole(self, trees: Trees, q: Chain) -> Way:
        """Return the way through configurations from the start to a goal, pulled tight."""
        question = self._question
        seconds = question.watch.seconds_left()
        return trees.tighten(np.stack(q), question.seed, seconds, question.shortcuts)


def roots_of(out: Chain, into: list[Chain]) -> Floats:
    """Return what trees are planted with (1 + g, n, 3): the last of the start's chain, and of each goal's."""
    return np.stack([out[-1], *(chain[-1] for chain in into)])
