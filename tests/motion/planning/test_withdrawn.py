"""Ways into bores and out of them: through shapes that are drawn back along themselves."""

from itertools import islice

import numpy as np
import pytest

import sinuous as sn
from benchmarks.motion.judged import collides
from sinuous.kernels.between.query import VERDICT
from sinuous.kernels.body.proof import CLEAR
from sinuous.motion.planning.goals import FixedGoal
from sinuous.motion.planning.grown import grown
from sinuous.motion.planning.question import Question
from sinuous.motion.planning.watch import Watch
from sinuous.motion.planning.withdrawn import ALONE, withdrawn
from sinuous.scene.scene import Scene
from tests.helpers import Floats
from tests.motion.planning.places import INSIDE, OUTSIDE, ROBOT, bore

OTHER = -INSIDE * [1.0, 1.0, -1.0]
"""The mirror image: turned half about the base's axis."""


def asked(scene: Scene, start: Floats, goal: Floats, seconds: float = 60.0) -> Question:
    return Question(ROBOT, scene.snapshot(), start, FixedGoal(goal), 0, 0, Watch(seconds))


@pytest.mark.parametrize(
    ("start", "goal", "walls"),
    [(OUTSIDE, INSIDE, bore()), (INSIDE, OUTSIDE, bore()), (OTHER, INSIDE, [*bore(), *bore(OTHER)])],
    ids=["into a bore", "out of it", "from one into another"],
)
def test_ways_are_found_that_trees_alone_do_not_find(start: Floats, goal: Floats, walls: list[sn.Box]) -> None:
    scene = Scene(walls)
    assert list(islice(grown(asked(scene, start, goal)), 3)) == [None] * 3
    way = next(way for way in islice(withdrawn(asked(scene, start, goal)), ALONE + 5) if way is not None)
    np.testing.assert_array_equal(way.q[[0, -1]], [start, goal])
    assert (way.answers[:, VERDICT] == CLEAR).all()
    assert collides(ROBOT, scene, way.q) == ""
    motion = sn.plan(ROBOT, start, goal, scene, time=60.0)
    assert motion.solved
    assert collides(ROBOT, scene, motion.q) == ""


def test_the_same_seed_gives_the_same_way() -> None:
    scene = Scene(bore())
    one, other = (next(filter(None, withdrawn(asked(scene, OUTSIDE, INSIDE)))) for _ in range(2))
    np.testing.assert_array_equal(one.q, other.q)


def test_without_time_there_is_none() -> None:
    assert list(islice(withdrawn(asked(Scene(bore()), OUTSIDE, INSIDE, seconds=0.0)), 4)) == [None] * 4
