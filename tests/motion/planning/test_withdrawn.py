"""Ways into bores and out of them: through shapes that are drawn back along themselves."""

from collections.abc import Iterator
from itertools import islice, takewhile

import numpy as np
import pytest

import sinuous as sn
from benchmarks.motion.judged import collides
from benchmarks.motion.places.motions import straight
from benchmarks.places import make
from sinuous.kernels.between.query import VERDICT
from sinuous.kernels.body.proof import CLEAR
from sinuous.motion.planning.ends import Ends
from sinuous.motion.planning.goals import FixedGoal
from sinuous.motion.planning.grown import grown
from sinuous.motion.planning.question import Question
from sinuous.motion.planning.watch import Watch
from sinuous.motion.planning.ways import Source
from sinuous.motion.planning.withdrawn import ALONE, withdrawn
from sinuous.scene.scene import Scene
from sinuous.solving.planning.trees import Way
from tests.helpers import Floats
from tests.motion.planning.places import INSIDE, OUTSIDE, ROBOT, bore

OTHER = -INSIDE * [1.0, 1.0, -1.0]
"""The mirror image: turned half about the base's axis."""


def asked(scene: Scene, start: Floats, goal: Floats, seconds: float = 60.0) -> Question:
    return Question(ROBOT, scene.snapshot(), start, FixedGoal(goal), 0, 0, Watch(seconds))


def ways(source: Source, question: Question) -> Iterator[Way | None]:
    return source(question, Ends(question))


@pytest.mark.parametrize(
    ("start", "goal", "walls"),
    [(OUTSIDE, INSIDE, bore()), (INSIDE, OUTSIDE, bore()), (OTHER, INSIDE, [*bore(), *bore(OTHER)])],
    ids=["into a bore", "out of it", "from one into another"],
)
def test_ways_are_found_that_trees_alone_do_not_find(start: Floats, goal: Floats, walls: list[sn.Box]) -> None:
    scene = Scene(walls)
    assert list(islice(ways(grown, asked(scene, start, goal)), 3)) == [None] * 3
    way = next(way for way in islice(ways(withdrawn, asked(scene, start, goal)), ALONE + 7) if way is not None)
    np.testing.assert_array_equal(way.q[[0, -1]], [start, goal])
    assert (way.answers[:, VERDICT] == CLEAR).all()
    assert collides(ROBOT, scene, way.q) == ""
    motion = sn.plan(ROBOT, start, goal, scene, time=60.0)
    assert motion.solved
    assert collides(ROBOT, scene, motion.q) == ""


def test_the_same_seed_gives_the_same_way() -> None:
    scene = Scene(bore())
    one, other = (next(filter(None, ways(withdrawn, asked(scene, OUTSIDE, INSIDE)))) for _ in range(2))
    np.testing.assert_array_equal(one.q, other.q)


def test_without_time_there_is_none() -> None:
    assert list(islice(ways(withdrawn, asked(Scene(bore()), OUTSIDE, INSIDE, seconds=0.0)), 4)) == [None] * 4


def test_where_it_is_narrow_it_begins_at_once() -> None:
    question = asked(Scene(bore()), OUTSIDE, INSIDE)
    narrow, wide = Ends(question), Ends(question)
    narrow.narrow = True
    turns = [len(list(takewhile(lambda way: way is None, withdrawn(question, ends)))) for ends in (narrow, wide)]
    assert turns[1] == turns[0] + ALONE


def test_trees_see_how_narrow_it_is() -> None:
    place = make("square bore", 14)
    for goal, narrow in ((place.hidden_q, True), (0.9 * straight(place.robot) + 0.1 * place.hidden_q, False)):
        goals, watch = FixedGoal(goal), Watch(60.0)
        question = Question(place.robot, place.scene.snapshot(), straight(place.robot), goals, 0, 0, watch)
        ends = Ends(question)
        next(grown(question, ends))
        assert ends.narrow == narrow
