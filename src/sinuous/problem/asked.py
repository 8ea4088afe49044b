"""Many questions about one robot: its targets one after the other, as they were listed or as arrays."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.problem.target import KEYS, Goals, Target, Targets, target_list, target_table
from sinuous.robot.robot import Robot

Truths = NDArray[np.bool_]

INSTEAD = "for positions use positions="


class Asked(ABC):
    """What is asked m times; frozen. Targets and their rows are made when they are asked for."""

    @abstractmethod
    def __len__(self) -> int: ...

    @abstractmethod
    def __getitem__(self, index: Any) -> "Asked":
        """Some of them: a slice, or numbers (k,)."""

    @abstractmethod
    def targets(self, i: int) -> tuple[Target, ...]:
        """Return the targets that are to be met at once, in question `i`."""

    @abstractmethod
    def rows(self, first: int, last: int) -> Floats:
        """Return the targets of some questions as kernels read them, a new array (last - first, t, 15).

        There are equally many in each of them.
        """

    @abstractmethod
    def runs(self) -> list[tuple[int, int]]:
        """First and last of every run of questions with equally many targets."""

    @property
    @abstractmethod
    def placed(self) -> Truths:
        """Of which questions some target has a position (m,)."""

    @property
    @abstractmethod
    def turned(self) -> Truths:
        """Of which questions some target has a direction or a rotation (m,)."""


class Listed(Asked):
    """Targets as they were listed; checked before, for this robot."""

    def __init__(self, robot: Robot, sets: tuple[tuple[Target, ...], ...]) -> None:
        self._robot, self._sets = robot, sets

    def __len__(self) -> int:
        return len(self._sets)

    def __getitem__(self, index: Any) -> "Listed":
        if isinstance(index, slice):
            return Listed(self._robot, self._sets[index])
        return Listed(self._robot, tuple(self._sets[i] for i in index.tolist()))

    def targets(self, i: int) -> tuple[Target, ...]:
        """Return the targets that are to be met at once, in question `i`."""
        return self._sets[i]

    def rows(self, first: int, last: int) -> Floats:
        """Return the targets as kernels read them; see `Asked`."""
        tables = [target._table for targets in self._sets[first:last] for target in targets]
        return np.concatenate(tables).reshape(last - first, -1, tables[0].shape[1])

    def runs(self) -> list[tuple[int, int]]:
        """First and last of every run of questions with equally many targets."""
        cuts = (np.flatnonzero(np.diff([len(targets) for targets in self._sets])) + 1).tolist()
        return list(zip([0, *cuts], [*cuts, len(self)], strict=True)) if self._sets else []

    @property
    def placed(self) -> Truths:
        """Of which questions some target has a position (m,)."""
        return np.array([any(t.position is not None for t in targets) for targets in self._sets], np.bool_)

    @property
    def turned(self) -> Truths:
        """Of which questions some target has a direction or a rotation (m,)."""
        return np.array(
            [any(t.direction is not None or t.rotation is not None for t in targets) for targets in self._sets],
            np.bool_,
        )


class OfArrays(Asked):
    """One target of the tip each, from arrays."""

    def __init__(self, goals: Goals) -> None:
        self._goals = goals

    def __len__(self) -> int:
        return len(self._goals)

    def __getitem__(self, index: Any) -> "OfArrays":
        return OfArrays(self._goals[index])

    def targets(self, i: int) -> tuple[Target, ...]:
        """Return the one target of question `i`."""
        return Target.of_goals(self._goals[i : i + 1])

    def rows(self, first: int, last: int) -> Floats:
        """Return the targets as kernels read them; see `Asked`."""
        return self._goals[first:last].rows[:, None]

    def runs(self) -> list[tuple[int, int]]:
        """One run, of all."""
        return [(0, len(self))] if len(self) else []

    @property
    def placed(self) -> Truths:
        """Of which questions the target has a position (m,)."""
        return np.full(len(self), self._goals.positions is not None)

    @property
    def turned(self) -> Truths:
        """Of which questions the target has a direction or a rotation (m,)."""
        return np.full(len(self), self._goals.directions is not None or self._goals.rotations is not None)


def read_asked(robot: Robot, targets: Iterable[Targets] | None, arrays: Mapping[str, Any]) -> Asked:
    """Check what is asked, for this robot: targets in a list, or arrays by the names of `GoalArrays`.

    Raises
    ------
    InputError
        That names the element, or says what is missing, not known, or said twice.
    """
    unknown = next((key for key in arrays if key not in KEYS), None)
    if unknown is not None:
        raise InputError(unknown, "is not known", arrays[unknown], "one of " + ", ".join(KEYS))
    given = [key for key in KEYS if arrays.get(key) is not None]
    if targets is None:
        if not given:
            raise InputError("targets", "nothing is asked", None, "targets, or positions=, directions= or rotations=")
        return OfArrays(Goals.read(arrays))
    if given:
        raise InputError(given[0], "stands beside targets", arrays[given[0]], "one of targets, arrays")
    return Listed(robot, listed_targets(robot, targets))


def listed_targets(robot: Robot, targets: Any) -> tuple[tuple[Target, ...], ...]:
    """Check a list of targets, or of lists of targets that are to be met at once, for this robot."""
    if isinstance(targets, (Target, str, bytes, dict)) or not np.iterable(targets):
        raise InputError("targets", "", targets, "a list of targets")
    if isinstance(targets, np.ndarray) and targets.dtype != object:
        raise InputError("targets", INSTEAD, targets, "a list of targets")
    sets = []
    for i, each in enumerate(targets):
        if isinstance(each, Target):
            own: tuple[Target, ...] = (each,)
        else:
            own = _together(f"targets[{i}]", each)
        if len(own) > 1 or own[0].segment is not None:
            with checks.inside(f"targets[{i}]"):
                target_table(robot, own)
        sets.append(own)
    return tuple(sets)


def _together(key: str, targets: Any) -> tuple[Target, ...]:
    """Check targets that are to be met at once; say what to do with mere numbers."""
    numbers = isinstance(targets, (np.ndarray, list, tuple)) and not any(isinstance(t, Target) for t in targets)
    if numbers and len(targets):
        raise InputError(key, INSTEAD, targets, "a Target or a list of them")
    return target_list(key, targets)
