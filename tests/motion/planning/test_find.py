"""Planners take turns, until one has a path, the time is over, or none has anything left to try."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest

import sinuous as sn
from sinuous.motion.planning import planners
from sinuous.motion.planning.query import Deadline, ProvedPath, Query
from sinuous.scene.scene import Scene

ROBOT = sn.Robot.uniform(2, 1.0)
PATH = ProvedPath(np.zeros((2, 2, 3)), np.zeros((1, 14)))


class Counted(Deadline):
    """Says so many seconds are left, one after the other."""

    def __init__(self, left: list[float]) -> None:
        super().__init__(0.0)
        self._left = iter(left)

    def left(self) -> float:
        return next(self._left)


def query(seconds: list[float]) -> Query:
    start = np.zeros((2, 3))
    return Query(ROBOT, Scene([]).snapshot(), start, lambda reached: reached, 0, 0, Counted(seconds))


def test_they_take_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def planner(name: str, answers: int, last: ProvedPath | None) -> Callable[..., Iterator[ProvedPath | None]]:
        def given(*asked_with: object) -> Iterator[ProvedPath | None]:
            for _ in range(answers):
                asked.append(name)
                yield None
            asked.append(name)
            yield last

        return given

    monkeypatch.setattr(planners, "rrt_connect", planner("a", 0, None))
    monkeypatch.setattr(planners, "retraction", planner("b", 2, PATH))
    assert planners.find_path(query([1.0] * 9)) is PATH
    assert asked == ["a", "b", "b", "b"]
    asked.clear()
    assert planners.find_path(query([1.0, 1.0, 0.0])) is None
    assert asked == ["a", "b"]
    asked.clear()
    monkeypatch.setattr(planners, "retraction", planner("b", 1, None))
    assert planners.find_path(query([1.0] * 9)) is None
    assert asked == ["a", "b", "b"]
