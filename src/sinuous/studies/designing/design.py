"""What a design found: the best robots, what they cost, and what decides."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from sinuous.base.checks import Floats
from sinuous.base.documents import result_of, write_table
from sinuous.base.errors import InputError, duration
from sinuous.base.frozen import ShortRepr
from sinuous.model.robot import Robot
from sinuous.studies.designing.judge import Objective


class FoundRobot(NamedTuple):
    """One robot of the front.

    Attributes
    ----------
    robot : Robot
    values : dict
        Of the fields that were varied.
    objectives : dict of str to float
        `clearance` with its own sign.
    done, tasks : int
        Tasks that are done, and all.
    share : float
        Of the targets that are met.
    answers : dict of str to ndarray (n, 3)
        Of each task that asks for targets the configuration that its objectives are those of: solves begin from it.
    """

    robot: Robot
    values: dict[str, Any]
    objectives: dict[str, float]
    done: int
    tasks: int
    share: float
    answers: dict[str, Floats]


class Change(NamedTuple):
    """What becomes of the best robot when one field changes by one percent.

    Attributes
    ----------
    field : str
    value : float
        After the change.
    objectives : dict of str to float, or None
        `None` where a task fails.
    failed : str or None
        The first task that fails.
    """

    field: str
    value: float
    objectives: dict[str, float] | None
    failed: str | None


class Cut(NamedTuple):
    """Listed values that were not tried: a proof says that no robot with them does a task.

    Attributes
    ----------
    values : dict
    task : str
    reason : str
    """

    values: dict[str, Any]
    task: str
    reason: str


@dataclass(frozen=True, eq=False, repr=False)
class Design(ShortRepr):
    """Robots for a set of tasks.

    Attributes
    ----------
    minimise : tuple of str
    front : tuple of FoundRobot
        Robots that no other is better than, by the first objective; empty where none does all tasks.
    deciding : str or None
        The task that decides: which fails first when the best robot changes, or most often where none does all.
    changes : tuple of Change
        Of the best robot, by 1 % of each field with a range, to either side.
    cut : tuple of Cut
    tried : int
        Robots that were judged.
    most_done : int
        Tasks that the robot does which does most, of `tasks`.
    tasks : int
    seconds : float
    """

    minimise: tuple[Objective, ...]
    front: tuple[FoundRobot, ...]
    deciding: str | None
    changes: tuple[Change, ...]
    cut: tuple[Cut, ...]
    tried: int
    most_done: int
    tasks: int
    seconds: float

    @property
    def solved(self) -> bool:
        """Whether a robot was found."""
        return bool(self.front)

    @property
    def best(self) -> FoundRobot | None:
        """The first of the front; `None` where there is none."""
        return self.front[0] if self.front else None

    @property
    def robot(self) -> Robot:
        """The best robot.

        Raises
        ------
        InputError
            When none was found.
        """
        if not self.front:
            raise InputError("design", "found no robot", str(self), "wider ranges, or fewer tasks")
        return self.front[0].robot

    def to_csv(self, file: str | Path) -> None:
        """Write a row for each robot of the front: its fields, then its objectives.

        Raises
        ------
        InputError
            When the file cannot be written.
        """
        rows = [{**found.values, **found.objectives, "done": found.done, "share": found.share} for found in self.front]
        write_table(file, rows[0] if rows else self.minimise, (row.values() for row in rows))

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values."""
        own = result_of(self, "minimise front deciding changes cut tried most_done tasks seconds")
        return {"status": "solved" if self.solved else "unsolved", **own}

    def _shown(self) -> Iterator[str]:
        yield ", ".join(self.minimise)
        yield f"{self.tried} robots tried"
        yield f"{len(self.front)} in the front" if self.front else "none does all tasks"

    def __str__(self) -> str:
        head = f"Design: {self.tried} robots tried in {duration(self.seconds)}, {self.tasks} tasks"
        if self.cut:
            head += f", {len(self.cut)} choices cut by proofs"
        lines = [head]
        lines += [f"  {_told(found.objectives)}  with {_told(found.values)}" for found in self.front]
        if not self.front:
            lines.append(f"  no robot does all tasks; the best does {self.most_done}")
        if self.deciding is not None:
            lines.append(f"  {self.deciding} decides")
        for change in self.changes:
            became = f"{change.failed} fails" if change.objectives is None else _told(change.objectives)
            lines.append(f"  {change.field} = {change.value:.4g}: {became}")
        return "\n".join(lines)


def _told(values: dict[str, Any]) -> str:
    shown = ((name, f"{value:.4g}" if isinstance(value, float) else str(value)) for name, value in values.items())
    return ", ".join(f"{name} {value}" for name, value in shown)
