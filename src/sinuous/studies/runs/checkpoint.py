"""Checkpoints: what a run has found so far, so that the same call goes on where an earlier one ended.

A run finds chunks, numbered in an order that depends on its record alone. The chunks stand in a folder beside the file
of results until all are there; the record beside them says what they depend on. A call with another record is refused.
"""

import hashlib
import json
import shutil
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

import sinuous
from sinuous.base.documents import draft_of, written
from sinuous.base.errors import InputError
from sinuous.kernels.compile import sources_hash
from sinuous.model.robot import Robot
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.options import SolveOptions
from sinuous.studies.runs.engine import Arrays

SUFFIX = ".parts"
"""What is appended to the name of the file of results for the folder of chunks."""

HASH_LENGTH = 16
"""Letters of a hash in a record."""


class Checkpoint:
    """Chunks in a folder beside the file of results; without a file in memory, where nothing outlives the run.

    Parameters
    ----------
    results : Path or None
        The file of results.
    record : mapping of str to plain values
        All that the chunks depend on.
    run : str
        What a refusal calls the run: `this batch`.
    """

    def __init__(self, results: Path | None, record: Mapping[str, Any], run: str) -> None:
        self.folder = None if results is None else results.with_name(results.name + SUFFIX)
        self._record, self._run = record, run
        self._in_memory: dict[int, Arrays] = {}

    @property
    def begun(self) -> bool:
        """Whether there is a folder to go on with."""
        return self.folder is not None and self.folder.exists()

    def open(self) -> None:
        """Make the folder, or go on with the one that is there.

        Raises
        ------
        InputError
            When it holds chunks of another record, or cannot be written.
        """
        if self.folder is None:
            return
        file = self.folder / "record.json"
        before = read_record(file)
        if before is not None:
            check_same(before, self._record, file, self._run)
        with written(self.folder, "out"):
            self.folder.mkdir(parents=True, exist_ok=True)
            write_record(file, self._record)

    def done(self) -> list[int]:
        """Return the numbers of the chunks that are there, in rising order; broken ones are deleted."""
        if self.folder is None:
            return sorted(self._in_memory)
        files = sorted(self.folder.glob("chunk-*.npz"))
        for file in files:
            if not zipfile.is_zipfile(file):  # the machine lost its power while the file was on its way to the disk
                file.unlink()
        return [int(file.stem.partition("-")[2]) for file in files if file.exists()]

    def read(self, number: int, *names: str) -> Arrays:
        """Return the arrays of these names, by default all, of a chunk."""
        if self.folder is None:
            chunk = self._in_memory[number]
            return {name: chunk[name] for name in names or chunk}
        with np.load(self._file(number)) as data:
            return {name: data[name] for name in names or data.files}

    def write(self, number: int, chunk: Arrays) -> None:
        """Keep a chunk: it is there whole, or not at all."""
        if self.folder is None:
            self._in_memory[number] = chunk
            return
        with draft_of(self._file(number)) as draft, draft.open("wb") as out:
            np.savez(out, **chunk)  # type: ignore[arg-type]

    def once(self, number: int, make: Callable[[], Arrays]) -> Arrays:
        """Return a chunk that an earlier call has kept, or make it, and keep it where there is a folder."""
        if self.folder is None:
            return make()
        if not zipfile.is_zipfile(self._file(number)):
            self.write(number, make())
        return self.read(number)

    def delete(self, number: int) -> None:
        """Delete a chunk in the folder."""
        self._file(number).unlink()

    def remove(self) -> None:
        """Delete the folder, if there is one."""
        if self.folder is not None and self.folder.exists():
            shutil.rmtree(self.folder)

    def _file(self, number: int) -> Path:
        assert self.folder is not None
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
