"""Ways through trees of configurations that grow from the start and from the goals: see `kernels.planning.trees`."""

from collections.abc import Iterator

import numpy as np

from sinuous.motion.planning.question import Question
from sinuous.solving.planning.trees import Trees, Way

ROUNDS = (64, 256, 1024)
"""Draws after which more goals are asked for. Then the trees are planted anew, with other draws, twice as many."""


def grown(question: Question) -> Iterator[Way | None]:
    """Yield the way that the trees find; see `Source`."""
    trees, seed = Trees(question.robot, question.scene), question.seed
    goals, first = question.goals(question.start[None]), 0
    for last in ROUNDS:
        known = 0 if first == 0 else len(goals)
        goals = goals if first == 0 else question.goals(trees.reached)
        ends = np.concatenate([question.start[None], goals[known:]])
        yield trees.grow(ends, seed, (first, last), question.watch.seconds_left(), question.shortcuts)
        first = last
    while True:
        seed, last = (seed + 1) % 2**31, 2 * last
        ends = np.concatenate([question.start[None], question.goals(trees.reached)])
        yield trees.grow(ends, seed, (0, last), question.watch.seconds_left(), question.shortcuts)
