"""Ways through trees of configurations that grow from the start and from the goals: see `kernels.planning.trees`."""

from collections.abc import Iterator

from sinuous.motion.planning.ends import Ends, roots_of
from sinuous.motion.planning.question import Question
from sinuous.solving.planning.trees import Trees, Way

ROUNDS = (64, 256, 1024)
"""Draws after which more goals are asked for. Then the trees are planted anew, with other draws, twice as many."""

NARROW = 0.1875
"""A tree with no more nodes than this share of the draws of the first round grows from a narrow place."""


def grown(question: Question, ends: Ends) -> Iterator[Way | None]:
    """Yield the way that the trees find; see `Source`.

    In the first round they grow from the ends as they are, then from where these have room. Where an end is in a narrow
    place, others have two turns for one of trees that are planted anew.
    """
    trees, seed = question.trees or Trees(question.robot, question.scene), question.seed
    goals, first, last = question.goals(question.start[None]), 0, ROUNDS[0]
    roots = roots_of([question.start], [[goal] for goal in goals])
    way = trees.grow(roots, seed, (first, last), question.watch.seconds_left(), question.shortcuts)
    ends.narrow = way is None and min(trees.sizes[0], trees.sizes[1] - len(goals) + 1) <= NARROW * last
    yield way
    known = len(goals) if not any(len(ends.eased(q)) > 1 for q in roots) else 0
    for following in ROUNDS[1:]:
        first, last = last if known else 0, following
        chains = ends.goals(trees.reached)
        yield ends.joined(trees, chains, known, seed, (first, last))
        known = len(chains)
    while True:
        if ends.narrow:
            yield None
        seed, last = (seed + 1) % 2**31, 2 * last
        yield ends.joined(trees, ends.goals(trees.reached), 0, seed, (0, last))
