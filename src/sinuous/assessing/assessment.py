"""What robots can do of a set of tasks: a row for each robot and task, and totals for each robot."""

import csv
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

from sinuous.assessing.tasks import Done
from sinuous.reprs import ShortRepr
from sinuous.words import duration
from sinuous.writing.documents import written

SOLVED = "solved"


class Total(NamedTuple):
    """What one robot can do of all tasks.

    Attributes
    ----------
    robot : str
    done, tasks : int
        Tasks that are done, and all.
    share : float
        Mean share of the targets that are met.
    clearance, self_clearance : float or None
        Least proved, over the tasks that are done.
    seconds : float
        The longest time of computing.
    duration : float or None
        The longest motion.
    binds : str or None
        What binds most often: of the tasks that are not done, or of all where all are.
    """

    robot: str
    done: int
    tasks: int
    share: float
    clearance: float | None
    self_clearance: float | None
    seconds: float
    duration: float | None
    binds: str | None


class Row(NamedTuple):
    """One task of one robot; see `Done`."""

    robot: str
    task: str
    kind: str
    done: Done


class Assessment(ShortRepr):
    """What robots can do of a set of tasks.

    Attributes
    ----------
    rows : tuple of Row
        Robots in their order, and the tasks of each in theirs.
    totals : tuple of Total
        One a robot.
    """

    def __init__(self, rows: tuple[Row, ...]) -> None:
        self.rows = rows
        robots = list(dict.fromkeys(row.robot for row in rows))
        self.totals = tuple(_total(name, [row.done for row in rows if row.robot == name]) for name in robots)

    @property
    def solved(self) -> bool:
        """Whether every robot can do every task."""
        return all(total.done == total.tasks for total in self.totals)

    def best(self) -> Total:
        """Return the robot that can do most; of several the one with the largest share, then the largest clearance."""
        return max(self.totals, key=lambda total: (total.done, total.share, total.clearance or 0.0))

    def failed(self, robot: str | None = None) -> list[Row]:
        """List the tasks that a robot cannot do; by default of all robots."""
        return [row for row in self.rows if row.done.status != SOLVED and robot in (None, row.robot)]

    def to_csv(self, file: str | Path, tasks: bool = False) -> None:
        """Write a row for each robot, or with `tasks` for each task of each robot; what is not known is empty.

        Raises
        ------
        InputError
            When the file cannot be written.
        """
        table: list[dict[str, Any]] = self.to_dict()["rows" if tasks else "totals"]
        with written(file), Path(file).open("w", encoding="utf-8", newline="") as out:
            writer = csv.DictWriter(out, list(table[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(table)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values."""
        rows = [{"robot": row.robot, "task": row.task, "kind": row.kind, **row.done.told()} for row in self.rows]
        return {"totals": [total._asdict() for total in self.totals], "rows": rows}

    def _shown(self) -> Iterator[str]:
        yield f"{len(self.totals)} robots"
        yield f"{self.totals[0].tasks} tasks"

    def __str__(self) -> str:
        width = max(len(total.robot) for total in self.totals)
        parts = [f"Assessment: {len(self.totals)} robots, {self.totals[0].tasks} tasks"]
        for total in self.totals:
            told = [f"{total.done} of {total.tasks} done", f"{100.0 * total.share:.3g} % of the targets"]
            told += [] if total.clearance is None else [f"clearance {total.clearance:.3g}"]
            told += [] if total.duration is None else [f"longest motion {total.duration:.3g}"]
            told += [f"longest time {duration(total.seconds)}"]
            told += [] if total.binds is None else [f"limited by {total.binds}"]
            parts.append(f"  {total.robot:<{width}}  {', '.join(told)}")
        return "\n".join(parts)


def _total(name: str, done: list[Done]) -> Total:
    solved = [each for each in done if each.status == SOLVED]
    failed = [each for each in done if each.status != SOLVED]
    names = Counter(each.binds for each in failed or done if each.binds is not None)
    return Total(
        robot=name,
        done=len(solved),
        tasks=len(done),
        share=sum(each.share for each in done) / len(done),
        clearance=_least(each.clearance for each in solved),
        self_clearance=_least(each.self_clearance for each in solved),
        seconds=max(each.seconds for each in done),
        duration=max((each.duration for each in solved if each.duration is not None), default=None),
        binds=names.most_common(1)[0][0] if names else None,
    )


def _least(values: Iterable[float | None]) -> float | None:
    return min((value for value in values if value is not None), default=None)
