"""Sets of targets of one robot, one after the other: each set is to be met at once."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.kernels.tables import HAS_POSITION, ORIENTATION, TARGET_WIDTH
from sinuous.problem.target import KEYS, Goals, Target, Targets, target_list, target_table
from sinuous.robot.robot import Robot

INSTEAD = "for positions use positions="
"""What to do with mere numbers."""


class TargetSets:
    """m sets of targets, as kernels read them; frozen.

    Parameters
    ----------
    rows : ndarray (r, 15)
        All targets, set after set.
    counts : ndarray (m,)
        How many targets each set has.
    listed : sequence of tuple of Target, optional
        The sets as they were given; by default targets are made of their rows when they are asked for.
    """

    def __init__(
        self, rows: Floats, counts: NDArray[np.int64], listed: tuple[tuple[Target, ...], ...] | None = None
    ) -> None:
        self._rows, self._counts, self._listed = rows, counts, listed
        self._first = np.concatenate([[0], np.cumsum(counts)])

    def __len__(self) -> int:
        return len(self._counts)

    def __getitem__(self, index: Any) -> "TargetSets":
        """Some of them: a slice, or numbers (k,)."""
        numbers = np.arange(len(self))[index]
        counts = self._counts[numbers]
        before = np.cumsum(counts) - counts
        rows = np.arange(counts.sum()) + np.repeat(self._first[numbers] - before, counts)
        listed = None if self._listed is None else tuple(self._listed[i] for i in numbers.tolist())
        return TargetSets(self._rows[rows], counts, listed)

    def targets(self, i: int) -> tuple[Target, ...]:
        """Return the targets of set `i`."""
        if self._listed is not None:
            return self._listed[i]
        return Target.of_rows(self._rows[self._first[i] : self._first[i + 1]])

    def rows(self, first: int, last: int) -> Floats:
        """Return the targets of some sets as kernels read them, a new array (last - first, t, 15).

        There are equally many in each of them: see `runs`.
        """
        return self._rows[self._first[first] : self._first[last]].reshape(last - first, -1, TARGET_WIDTH).copy()

    def runs(self) -> list[tuple[int, int]]:
        """First and last of every run of sets with equally many targets."""
        cuts = (np.flatnonzero(np.diff(self._counts)) + 1).tolist()
        return list(zip([0, *cuts], [*cuts, len(self)], strict=True)) if len(self) else []

    @property
    def placed(self) -> NDArray[np.bool_]:
        """Of which sets some target has a position (m,)."""
        return self._any(HAS_POSITION)

    @property
    def turned(self) -> NDArray[np.bool_]:
        """Of which sets some target has a direction or a rotation (m,)."""
        return self._any(ORIENTATION)

    def _any(self, column: int) -> NDArray[np.bool_]:
        some: NDArray[np.bool_] = np.logical_or.reduceat(self._rows[:, column] != 0.0, self._first[:-1])
        return some


def read_target_sets(robot: Robot, targets: Iterable[Targets] | None, arrays: Mapping[str, Any]) -> TargetSets:
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
        rows = Goals.read(arrays).rows
        return TargetSets(rows, np.ones(len(rows), np.int64))
    if given:
        raise InputError(given[0], "stands beside targets", arrays[given[0]], "one of targets, arrays")
    listed = listed_targets(robot, targets)
    tables = [np.empty((0, TARGET_WIDTH)), *(target._table for each in listed for target in each)]
    return TargetSets(np.concatenate(tables), np.array([len(each) for each in listed], np.int64), listed)


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
