"""Answers to the targets of a chunk, arrays by name; and tables of them, CSV, NPZ and Parquet."""

import csv
import zipfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from sinuous.answer.solutions import Solutions, column_names
from sinuous.answer.status import Status, places_of
from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels.tables import CLEARANCE, CODE, FAILED, RECORD_WIDTH, SOLVED
from sinuous.model.robot import Robot
from sinuous.studies.batch.tables.reading import ending_of, parquet
from sinuous.studies.runs.engine import Arrays

INVALID = "invalid"
"""Status of a row that is no target."""

SKIPPED = "skipped"
"""Status of a row whose chunk failed three times."""

STATUSES = (*(str(status) for status in Status), INVALID, SKIPPED)
"""Statuses of rows; `status` of an NPZ file holds their places here."""

CODES = {name: code for code, name in enumerate(STATUSES)}

ERRORS = ("position_error", "angle_error", "clearance", "self_clearance")
EFFORTS = ("iterations", "starts")


@dataclass(frozen=True)
class Layout:
    """The columns of a table of results.

    Attributes
    ----------
    robot : Robot
    chosen : tuple of str or None
        Names of the columns of a table after `row` and `status`, in this order; None: all.
    """

    robot: Robot
    chosen: tuple[str, ...] | None = None

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints."""
        return self.robot.joint_names

    @property
    def actuators(self) -> tuple[str, ...]:
        """Names of the actuators."""
        return tuple(actuator.name for actuator in self.robot.actuators)

    @property
    def shapes(self) -> dict[str, tuple[np.dtype[Any], tuple[int, ...]]]:
        """What an array holds for each row, by its name."""
        real, small = np.dtype(np.float64), np.dtype(np.int32)
        return {
            "row": (np.dtype(np.int64), ()),
            "status": (np.dtype(np.uint8), ()),
            **({"joints": (real, (len(self.joints),))} if self.joints else {}),
            "q": (real, (len(self.robot.segments), 3)),
            "actuators": (real, (len(self.actuators),)),
            **dict.fromkeys(ERRORS, (real, ())),
            **dict.fromkeys(EFFORTS, (small, ())),
        }

    @property
    def names(self) -> list[str]:
        """Names of the columns of a table."""
        return ["row", "status", *(self._known if self.chosen is None else self.chosen)]

    def choosing(self, columns: Sequence[str] | None) -> "Layout":
        """Return that of tables with these columns.

        Raises
        ------
        InputError
            When a name is not known, or given twice.
        """
        if columns is None:
            return self
        return replace(self, chosen=tuple(checks.names_of("columns", columns, self._known)))

    @property
    def _known(self) -> list[str]:
        return [*column_names(self.robot), *ERRORS, *EFFORTS]

    def flat(self, block: Arrays) -> Iterator[NDArray[Any]]:
        """Yield the columns of a table, in the order of `names`; statuses are words."""
        yield block["row"]
        yield np.array(STATUSES)[block["status"]]
        numbers = block["q"].reshape(len(block["row"]), -1).T, block["actuators"].T
        own = [*(block["joints"].T if self.joints else ()), *numbers[0], *numbers[1]]
        columns = dict(zip(self._known, [*own, *(block[name] for name in (*ERRORS, *EFFORTS))], strict=True))
        yield from (columns[name] for name in self.names[2:])

    def nothing(self, first: int, count: int, status: str) -> Arrays:
        """Make rows without an answer, from row `first` on, 0 = first of all."""
        block = {
            name: np.full((count, *shape), np.nan if dtype.kind == "f" else 0, dtype)
            for name, (dtype, shape) in self.shapes.items()
        }
        block["row"] += np.arange(first + 1, first + count + 1)
        block["status"][:] = CODES[status]
        return block

    def fill(self, block: Arrays, rows: Any, found: Solutions) -> None:
        """Put what was found into rows of a block, by their numbers or all of them (a slice)."""
        block["status"][rows] = places_of(found._answers)
        block["q"][rows] = found.q
        if self.joints:
            block["joints"][rows] = found.joints
        if self.actuators:
            block["actuators"][rows] = _actuators(self.robot, found.configuration)
        for name in (*ERRORS, *EFFORTS):
            block[name][rows] = getattr(found, name)

    def records(self, block: Arrays) -> Floats:
        """What `Solutions` of the rows hold, as far as a table says it: whether, where, how clear of obstacles."""
        solved, clear = block["status"] == CODES["solved"], block["clearance"] - self.robot._least_clearances[0]
        answers = np.zeros((len(solved), RECORD_WIDTH + 3 * len(self.robot)))
        answers[:, CODE] = np.where(solved, SOLVED, FAILED)
        answers[:, CLEARANCE] = np.where(np.isnan(clear), np.inf, clear)
        q = self.robot._rigid.with_joints(block["q"], block["joints"]) if self.joints else block["q"]
        answers[:, RECORD_WIDTH:] = q.reshape(len(solved), -1)
        return answers


def _actuators(robot: Robot, q: Floats) -> Floats:
    """Values (m, k) of all actuators, summed in an order that does not depend on m, as that of a product does."""
    flat, jacobian = q.reshape(len(q), -1), robot.drive.jacobian
    displacements = np.zeros((len(q), len(jacobian)))
    for k, j in np.argwhere(jacobian).tolist():
        displacements[:, k] += jacobian[k, j] * flat[:, j]
    stretch = robot.drive.stretch(np.concatenate([q, q[:1]]))[:-1]  # that of a row alone is summed in another order
    return robot.drive.motors.values(displacements + stretch)


def write_npz(file: Path, blocks: Callable[..., Iterable[Arrays]], layout: Layout, rows: int) -> None:
    """Write results: an array for each name of `Layout.shapes`, and the words that its numbers stand for.

    `blocks` is called with the name of each array and yields that array of all blocks: one is written after the other.
    """
    texts = {"statuses": STATUSES, "segment_names": layout.robot.segment_names, "actuator_names": layout.actuators}
    texts |= {"joint_names": layout.joints} if layout.joints else {}
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for name, words in texts.items():
            _write(archive, name, iter([np.array(words, np.str_)]))
        for name, (dtype, shape) in layout.shapes.items():
            columns = (np.asarray(block[name], dtype) for block in blocks(name))
            _write(archive, name, columns, (dtype, (rows, *shape)))


def _write(
    archive: zipfile.ZipFile,
    name: str,
    columns: Iterator[NDArray[Any]],
    whole: tuple[np.dtype[Any], tuple[int, ...]] | None = None,
) -> None:
    """Write an array that comes in pieces; its date is always the same, so that equal results are equal files."""
    with archive.open(zipfile.ZipInfo(f"{name}.npy"), "w", force_zip64=True) as member:
        if whole is None:
            npy.write_array(member, next(columns), allow_pickle=False)
            return
        dtype, shape = whole
        header = {"descr": npy.dtype_to_descr(dtype), "fortran_order": False, "shape": shape}
        npy.write_array_header_2_0(member, header)
        for column in columns:
            member.write(np.ascontiguousarray(column).data.cast("B") if column.size else b"")


def write_parquet(file: Path, blocks: Iterable[Arrays], layout: Layout) -> None:
    """Write results, a row a target; a block is a row group."""
    module = parquet(file)
    import pyarrow  # noqa: PLC0415

    shapes = layout.shapes
    kinds = {name: pyarrow.from_numpy_dtype(dtype) for name, (dtype, shape) in shapes.items() if not shape}
    kinds["status"] = pyarrow.dictionary(pyarrow.int8(), pyarrow.string())
    schema = pyarrow.schema([(name, kinds.get(name, pyarrow.float64())) for name in layout.names])
    words = pyarrow.array(STATUSES)
    with module.ParquetWriter(file, schema) as out:
        for block in blocks:
            columns = [pyarrow.array(column, from_pandas=True) for column in layout.flat(block)]
            status = pyarrow.array(block["status"].astype(np.int8))
            columns[1] = pyarrow.DictionaryArray.from_arrays(status, words)
            out.write_table(pyarrow.Table.from_arrays(columns, schema=schema))


def write_csv(file: Path, blocks: Iterable[Arrays], layout: Layout) -> None:
    """Write results, a row a target; what is not known is an empty cell."""
    with file.open("w", encoding="utf-8", newline="") as out:
        table = csv.writer(out, lineterminator="\n")
        table.writerow(layout.names)
        for block in blocks:
            columns = [_listed(column) for column in layout.flat(block)]
            table.writerows(zip(*columns, strict=True))


def _listed(column: np.ndarray) -> list[object]:
    """Values as Python has them; NaN is nothing."""
    values: list[object] = column.tolist()
    if column.dtype.kind == "f" and np.isnan(column).any():
        return [None if missing else value for value, missing in zip(values, np.isnan(column).tolist(), strict=True)]
    return values


def check_results(key: str, file: Path, columns: Sequence[str] | None = None) -> None:
    """Refuse a file of results that could not be written at the end.

    Raises
    ------
    InputError
        When its ending is not known or has no columns, or pyarrow is missing.
    """
    ending = ending_of(key, file)
    if ending == ".parquet":
        parquet(file)
    elif ending != ".csv" and columns is not None:
        raise InputError("columns", "arrays have none", str(file), "a table, .csv or .parquet")


def write_results(file: Path, blocks: Callable[..., Iterable[Arrays]], layout: Layout, rows: int) -> None:
    """Write results of the kind that the ending says.

    `blocks` gives all blocks anew at each call; given the name of an array, that array of each alone.
    """
    match file.suffix.lower():
        case ".csv":
            write_csv(file, blocks(), layout)
        case ".parquet":
            write_parquet(file, blocks(), layout)
        case _:
            write_npz(file, blocks, layout, rows)


def joined(blocks: Iterable[Arrays], layout: Layout) -> Arrays:
    """Put blocks together in memory."""
    parts = [layout.nothing(0, 0, "skipped"), *blocks]
    return {name: np.concatenate([part[name] for part in parts]) for name in layout.shapes}
