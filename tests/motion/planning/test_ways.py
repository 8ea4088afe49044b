"""Sources of ways take turns, until one has a way, the time is over, or none has anything left to try."""

from collections.abc import Iterator

import numpy as np
import pytest

import sinuous as sn
from sinuous.motion.planning import ways
from sinuous.motion.planning.ends import Ends
from sinuous.motion.planning.question import Question
from sinuous.motion.planning.watch import Watch
from sinuous.motion.planning.ways import Source
from sinuous.scene.scene import Scene
from sinuous.solving.planning.trees import Way

ROBOT = sn.Robot.uniform(2, 1.0)
WAY = Way(np.zeros((2, 2, 3)), np.zeros((1, 14)))


class Counted(Watch):
    """Says so many seconds are left, one after the other."""

    def __init__(self, left: list[float]) -> None:
        super().__init__(0.0)
        self._left = iter(left)

    def seconds_left(self) -> float:
        return next(self._left)


def question(seconds: list[float]) -> Question:
    start = np.zeros((2, 3))
    return Question(ROBOT, Scene([]).snapshot(), start, lambda reached: reached, 0, 0, Counted(seconds))


def test_they_take_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def source(name: str, answers: int, last: Way | None) -> Source:
        def given(question: Question, ends: Ends) -> Iterator[Way | None]:
            for _ in range(answers):
                asked.append(name)
                yield None
            asked.append(name)
            yield last

        return given

    monkeypatch.setattr(ways, "SOURCES", (source("a", 0, None), source("b", 1, WAY), source("c", 9, None)))
    assert ways.find_way(question([1.0] * 9)) is WAY
    assert asked == ["a", "b", "c", "b"]
    asked.clear()
    assert ways.find_way(question([1.0, 1.0, 0.0])) is None
    assert asked == ["a", "b"]
    monkeypatch.setattr(ways, "SOURCES", (source("a", 1, None),))
    assert ways.find_way(question([1.0] * 9)) is None
