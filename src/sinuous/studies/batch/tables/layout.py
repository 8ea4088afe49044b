"""The answers to the targets of a chunk: arrays by name, and the columns that they make in a table."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous.answer.solutions import Solutions
from sinuous.answer.status import Status, places_of
from sinuous.base.checks import Floats
from sinuous.kernels.tables import CLEARANCE, CODE, FAILED, RECORD_WIDTH, SOLVED
from sinuous.model.robot import Robot
from sinuous.model.segment import coordinate_names

INVALID = "invalid"
"""Status of a row that is no target."""

SKIPPED = "skipped"
"""Status of a row whose chunk failed three times."""

STATUSES = (*(str(status) for status in Status), INVALID, SKIPPED)
"""Statuses of rows; `status` of an NPZ file holds their places here."""

CODES = {name: code for code, name in enumerate(STATUSES)}

Block = dict[str, NDArray[Any]]
"""Arrays of equal length by the names of `Layout.shapes`."""

ERRORS = ("position_error", "angle_error", "clearance", "self_clearance")
EFFORTS = ("iterations", "starts")


@dataclass(frozen=True)
class Layout:
    """The columns of a table of results.

    Attributes
    ----------
    segments : tuple of str
        Names of the segments.
    actuators : tuple of str
        Names of the actuators.
    """

    segments: tuple[str, ...]
    actuators: tuple[str, ...]

    @classmethod
    def of(cls, robot: Robot) -> "Layout":
        """Return that of a robot."""
        return cls(tuple(robot.segment_names), tuple(actuator.name for actuator in robot.actuators))

    @property
    def shapes(self) -> dict[str, tuple[np.dtype[Any], tuple[int, ...]]]:
        """What an array holds for each row, by its name."""
        real, small = np.dtype(np.float64), np.dtype(np.int32)
        return {
            "row": (np.dtype(np.int64), ()),
            "status": (np.dtype(np.uint8), ()),
            "q": (real, (len(self.segments), 3)),
            "actuators": (real, (len(self.actuators),)),
            **dict.fromkeys(ERRORS, (real, ())),
            **dict.fromkeys(EFFORTS, (small, ())),
        }

    @property
    def names(self) -> list[str]:
        """Names of the columns of a table."""
        return ["row", "status", *coordinate_names(self.segments), *self.actuators, *ERRORS, *EFFORTS]

    def flat(self, block: Block) -> Iterator[NDArray[Any]]:
        """Yield the columns of a table, in the order of `names`; statuses are words."""
        yield block["row"]
        yield np.array(STATUSES)[block["status"]]
        yield from block["q"].reshape(len(block["row"]), -1).T
        yield from block["actuators"].T
        yield from (block[name] for name in (*ERRORS, *EFFORTS))

    def nothing(self, first: int, count: int, status: str) -> Block:
        """Make rows without an answer, from row `first` on, 0 = first of all."""
        block = {
            name: np.full((count, *shape), np.nan if dtype.kind == "f" else 0, dtype)
            for name, (dtype, shape) in self.shapes.items()
        }
        block["row"] += np.arange(first + 1, first + count + 1)
        block["status"][:] = CODES[status]
        return block

    def fill(self, block: Block, rows: Any, found: Solutions, robot: Robot) -> None:
        """Put what was found into rows of a block, by their numbers or all of them (a slice)."""
        block["status"][rows] = places_of(found._answers)
        block["q"][rows] = found.q
        if self.actuators:
            block["actuators"][rows] = _actuators(robot, found.q)
        for name in (*ERRORS, *EFFORTS):
            block[name][rows] = getattr(found, name)

    def records(self, block: Block, robot: Robot) -> Floats:
        """What `Solutions` of the rows hold, as far as a table says it: whether, where, how clear of obstacles."""
        solved, clear = block["status"] == CODES["solved"], block["clearance"] - robot.least_demanded[0]
        answers = np.zeros((len(solved), RECORD_WIDTH + 3 * len(self.segments)))
        answers[:, CODE] = np.where(solved, SOLVED, FAILED)
        answers[:, CLEARANCE] = np.where(np.isnan(clear), np.inf, clear)
        answers[:, RECORD_WIDTH:] = block["q"].reshape(len(solved), -1)
        return answers


def _actuators(robot: Robot, q: Floats) -> Floats:
    """Values (m, k) of all actuators, summed in an order that does not depend on m, as that of a product does."""
    flat, jacobian = q.reshape(len(q), -1), robot.drive.jacobian
    displacements = np.zeros((len(q), len(jacobian)))
    for k, j in np.argwhere(jacobian).tolist():
        displacements[:, k] += jacobian[k, j] * flat[:, j]
    return robot.drive.motors.values(displacements)
