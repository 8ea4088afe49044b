"""Checkpoints: what a run has found so far, so that the same call goes on where an earlier one ended.

A run finds chunks, numbered in an order that depends on its record alone. The chunks stand in a folder beside the file
of results until all are there; the record beside them says what they depend on. A call with another record is refused.
"""

import hashlib
import json
import shutil
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import sinuous
from sinuous.base.documents import draft_of, written
from sinuous.base.errors import InputError
from sinuous.kernels.compiling.sources import sources_hash
from sinuous.model.robot import Robot
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.options import SolveOptions

SUFFIX = ".parts"
"""What is appended to the name of the file of results for the folder of chunks."""

HASH_LENGTH = 16
"""Letters of a hash in a record."""

Arrays = dict[str, NDArray[Any]]
"""Arrays by name: what a chunk consists of."""


class InMemory:
    """Chunks in memory: where there is no file of results, nothing outlives the run."""

    begun = False
    """Whether there is something to go on with."""

    def __init__(self) -> None:
        self._chunks: dict[int, Arrays] = {}

    def open(self) -> None:
        """Do nothing: there is nothing to go on with."""

    def done(self) -> list[int]:
        """Return the numbers of the chunks that are there, in rising order."""
        return sorted(self._chunks)

    def read(self, number: int, *names: str) -> Arrays:
        """Return the arrays of these names, by default all, of a chunk."""
        chunk = self._chunks[number]
        return {name: chunk[name] for name in names or chunk}

    def write(self, number: int, chunk: Arrays) -> None:
        """Keep a chunk."""
        self._chunks[number] = chunk

    def remove(self) -> None:
        """Do nothing: what is kept are the results."""


class Checkpoint:
    """Chunks in a folder beside the file of results.

    Parameters
    ----------
    results : Path
        The file of results.
    record : mapping of str to plain values
        All that the chunks depend on.
    run : str
        What a refusal calls the run: `this batch`.
    """

    def __init__(self, results: Path, record: Mapping[str, Any], run: str) -> None:
        self.folder = results.with_name(results.name + SUFFIX)
        self._record, self._run = record, run

    @property
    def begun(self) -> bool:
        """Whether there is something to go on with."""
        return self.folder.exists()

    def open(self) -> None:
        """Make the folder, or go on with the one that is there.

        Raises
        ------
        InputError
            When it holds chunks of another record, or cannot be written.
        """
        file = self.folder / "record.json"
        before = read_record(file)
        if before is not None:
            check_same(before, self._record, file, self._run)
        with written(self.folder, "out"):
            self.folder.mkdir(parents=True, exist_ok=True)
            write_record(file, self._record)

    def done(self) -> list[int]:
        """Return the numbers of the chunks that are there, in rising order; broken ones are deleted."""
        found = []
        for file in sorted(self.folder.glob("chunk-*.npz")):
            if zipfile.is_zipfile(file):
                found.append(int(file.stem.partition("-")[2]))
            else:  # the machine lost its power while the file was on its way to the disk
                file.unlink()
        return found

    def read(self, number: int, *names: str) -> Arrays:
        """Return the arrays of these names, by default all, of a chunk."""
        with np.load(self._file(number)) as data:
            return {name: data[name] for name in names or data.files}

    def write(self, number: int, chunk: Arrays) -> None:
        """Keep a chunk: it is there whole, or not at all."""
        with draft_of(self._file(number)) as draft, draft.open("wb") as out:
            np.savez(out, **chunk)  # type: ignore[arg-type]

    def delete(self, number: int) -> None:
        """Delete a chunk."""
        self._file(number).unlink()

    def remove(self) -> None:
        """Delete the folder, if it is there."""
        if self.begun:
            shutil.rmtree(self.folder)

    def _file(self, number: int) -> Path:
        return self.folder / f"chunk-{number:07}.npz"


def problem_record(robot: Robot, scene: Snapshot, options: SolveOptions) -> dict[str, str]:
    """Return the entries of a record that tell a robot, the obstacles, the options and this version from others."""
    names = [scene.name(i) for i in range(len(scene))]
    return {
        "version": f"{sinuous.__version__}, kernels {sources_hash()[:12]}",
        "robot": hash_of(json.dumps(robot.to_dict(), sort_keys=True).encode()),
        "scene": f"{len(scene)} obstacles, {hash_of(scene.group.tobytes(), repr(names).encode())}",
        **{name: str(value) for name, value in vars(options).items() if name != "memory"},
        "memory": "None" if options.memory is None else f"{len(options.memory)} shapes, {options.memory.fingerprint}",
    }


def check_same(before: Mapping[str, Any], now: Mapping[str, Any], where: Path, run: str) -> None:
    """Refuse to go on with a run that began with another record.

    Raises
    ------
    InputError
        That names the first entry that differs.
    """
    for key, value in now.items():
        if before.get(key) != value:
            wanted = f"{before.get(key)}, as in {where}, or another file for the results"
            raise InputError(key, f"it has changed since {run} began", value, wanted)


def read_record(file: Path) -> dict[str, Any] | None:
    """Return what a record says; `None` where there is no such file.

    Raises
    ------
    InputError
        When it is no record.
    """
    try:
        values = json.loads(file.read_text(encoding="utf-8"))
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, ValueError) as error:
        raise InputError("out", f"cannot be read: {error}", str(file), "the record of a run") from None
    if not isinstance(values, dict):
        raise InputError("out", "", str(file), "the record of a run")
    return values


def write_record(file: Path, record: Mapping[str, Any]) -> None:
    """Write a record whole, or not at all."""
    with draft_of(file) as draft:
        draft.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")


def hash_of(*parts: bytes) -> str:
    """Return a text that tells some bytes from others."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part)
    return digest.hexdigest()[:HASH_LENGTH]
