"""Sets of targets of one robot, one after the other: each set is to be met at once; and the problems that they make."""

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, refuse_unknown
from sinuous.kernels.tables import HAS_POSITION, ORIENTATION, TARGET_WIDTH
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem
from sinuous.problem.target import KEYS, Target, Targets, TipGoals, Tolerance, is_place, target_list
from sinuous.scene.snapshot import Snapshot

INSTEAD = "for positions use positions="
"""What to do with mere numbers."""


class ListedTargets:
    """m sets of targets as they were listed, each to be met at once; checked before, for their robot."""

    def __init__(self, sets: tuple[tuple[Target, ...], ...]) -> None:
        self._sets = sets

    def __len__(self) -> int:
        return len(self._sets)

    def __getitem__(self, index: Any) -> "ListedTargets":
        """Some of them: a slice, or numbers (k,)."""
        return ListedTargets(tuple(self._sets[i] for i in np.arange(len(self))[index].tolist()))

    def targets(self, i: int) -> tuple[Target, ...]:
        """Return the targets of set `i`."""
        return self._sets[i]

    def chunk(self, first: int, last: int) -> Floats:
        """Return the targets of some sets as kernels read them, a new array (last - first, t, 15).

        There are equally many in each of them: see `runs`.
        """
        tables = [target._table for targets in self._sets[first:last] for target in targets]
        return np.concatenate(tables).reshape(last - first, -1, TARGET_WIDTH)

    def runs(self) -> list[tuple[int, int]]:
        """First and last of every run of sets with equally many targets."""
        cuts = (np.flatnonzero(np.diff([len(targets) for targets in self._sets])) + 1).tolist()
        return list(zip([0, *cuts], [*cuts, len(self)], strict=True)) if self._sets else []

    @property
    def placed(self) -> NDArray[np.bool_]:
        """Of which sets some target has a position (m,)."""
        return self._some(HAS_POSITION)

    @property
    def turned(self) -> NDArray[np.bool_]:
        """Of which sets some target has a direction or a rotation (m,)."""
        return self._some(ORIENTATION)

    def _some(self, column: int) -> NDArray[np.bool_]:
        return np.array([any(target._table[0, column] for target in each) for each in self._sets], np.bool_)


TargetSets = TipGoals | ListedTargets
"""Sets of targets: one of the tip in each, from arrays, or listed ones."""


class ManyProblems(NamedTuple):
    """m problems of one robot in one scene.

    Attributes
    ----------
    robot : Robot
    target_sets : TargetSets
        The targets of each.
    scene : Snapshot
    tolerance : Tolerance
        With numbers for all that is not said.
    initial : ndarray (m, g, n, 3)
        The initial configurations of each: g is 0 or 1.
    """

    robot: Robot
    target_sets: TargetSets
    scene: Snapshot
    tolerance: Tolerance
    initial: Floats

    def problem(self, i: int) -> Problem:
        """Return one of the problems."""
        return Problem.prepared(self.robot, self.target_sets.targets(i), self.scene, self.tolerance)

    def some(self, index: Any) -> "ManyProblems":
        """Return some of the problems: by a slice, or numbers (k,)."""
        return self._replace(target_sets=self.target_sets[index], initial=self.initial[index])


def read_target_sets(robot: Robot, targets: Iterable[Targets] | None, arrays: Mapping[str, Any]) -> TargetSets:
    """Check what is asked, for this robot: targets in a list, or arrays by the names of `GoalArrays`.

    Raises
    ------
    InputError
        That names the element, or says what is missing, not known, or said twice.
    """
    refuse_unknown(arrays, KEYS)
    given = [key for key in KEYS if arrays.get(key) is not None]
    if targets is None:
        if not given:
            raise InputError("targets", "nothing is asked", None, "targets, or positions=, directions= or rotations=")
        return TipGoals.read(arrays)
    if given:
        raise InputError(given[0], "cannot be combined with targets", arrays[given[0]], "one of targets, arrays")
    return ListedTargets(listed_targets(robot, targets))


def listed_targets(robot: Robot, targets: Any) -> tuple[tuple[Target, ...], ...]:
    """Check a list of targets, or of lists of targets that are to be met at once, for this robot."""
    if isinstance(targets, (Target, str, bytes, dict)) or not np.iterable(targets) or is_place(targets):
        raise InputError("targets", "", targets, "a list of targets")
    if isinstance(targets, np.ndarray) and targets.dtype != object:
        raise InputError("targets", INSTEAD, targets, "a list of targets")
    sets = []
    for i, each in enumerate(targets):
        own = (each,) if isinstance(each, Target) else _together(f"targets[{i}]", each)
        sets.append(own if len(own) == 1 and own[0].segment is None else target_list(f"targets[{i}]", own, robot))
    return tuple(sets)


def _together(key: str, targets: Any) -> tuple[Target, ...]:
    """Check targets that are to be met at once; say what to do with mere numbers."""
    numbers = isinstance(targets, (np.ndarray, list, tuple)) and not any(isinstance(t, Target) for t in targets)
    if numbers and len(targets) and not is_place(targets):
        raise InputError(key, INSTEAD, targets, "a Target or a list of them")
    return target_list(key, targets)
