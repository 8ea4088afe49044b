"""The interface of engines: workers that do tasks, until each task is done or has failed three times; and checkpoints.

A task, its answer and what it is a part of are plain arrays by name, so that they travel between processes and machines
and stand in a checkpoint.

A checkpoint is what a run has found so far, so that the same call goes on where an earlier one ended. A run finds
chunks, numbered in an order that depends on its record alone. The chunks stand in a folder beside the file of results
until all are there; the record beside them says what they depend on. A call with another record is refused.
"""

import hashlib
import json
import shutil
import zipfile
from abc import ABC, abstractmethod
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait
from pathlib import Path
from typing import Any, NamedTuple, Protocol, Self

import numpy as np
from numpy.typing import NDArray

import sinuous
from sinuous.base.checks import written
from sinuous.base.documents import draft_of
from sinuous.base.errors import InputError, UnfinishedError
from sinuous.kernels.compile import sources_hash
from sinuous.model.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.options import SolveOptions

Arrays = dict[str, NDArray[Any]]
"""Arrays by name."""

MOST_TRIES = 3
"""How often a task is tried before it is given up."""

REASON_LENGTH = 300
"""Letters of the reason why a task failed that are kept."""

Task = tuple[int, Arrays]
"""A task: its number in the run, and what it consists of."""


class Work(Protocol):
    """What workers do, in a scene; it is pickled when they are other processes."""

    scene: Scene

    def prepare(self) -> Self:
        """Compile, or load, what it needs."""
        ...

    def __call__(self, task: Arrays, /) -> Arrays:
        """Do a task."""
        ...


class LostError(Exception):
    """The workers are gone, and no task can be done any more; its text says what happened."""


class Failure(NamedTuple):
    """A task that was given up.

    Attributes
    ----------
    number : int
    reason : str
        What its last try ended with.
    """

    number: int
    reason: str


class _Queue:
    """Tasks that are to be done, and those that are to be done again."""

    def __init__(self, tasks: Iterable[Task], failures: list[Failure]) -> None:
        self._coming, self._failures = iter(tasks), failures
        self._again, self._alone = deque[Task](), deque[Task]()
        self._one_is_alone = False
        self._tries = Counter[int]()

    def take(self, idle: bool) -> Task | None:
        """Return the next task, if one may begin now: some begin only while the workers do nothing else."""
        if not idle and (self._alone or self._one_is_alone):
            return None
        self._one_is_alone = bool(self._alone)
        if self._alone:
            return self._alone.popleft()
        return self._again.popleft() if self._again else next(self._coming, None)

    def put_back(self, task: Task, error: BaseException) -> None:
        """Count a try that failed; it will be done again, unless that was the last try."""
        if not self._is_last_try(task[0], error):
            self._again.append(task)

    def put_back_lost(self, tasks: list[Task], error: BaseException) -> None:
        """Count a try of tasks whose worker died; where it is not known which of them killed it, none is given up."""
        if len(tasks) == 1 and self._is_last_try(tasks[0][0], error):
            return
        for number, _ in tasks if len(tasks) > 1 else ():
            self._tries[number] = min(self._tries[number] + 1, MOST_TRIES - 1)
        self._alone += tasks

    def _is_last_try(self, number: int, error: BaseException) -> bool:
        self._tries[number] += 1
        if self._tries[number] < MOST_TRIES:
            return False
        reason = f"{type(error).__name__}: {' '.join(str(error).split())}"
        self._failures.append(Failure(number, reason[:REASON_LENGTH]))
        return True


class Engine(ABC):
    """Workers that do tasks.

    Attributes
    ----------
    most_in_flight : int
        Most tasks that are handed out at the same time, so that no worker waits.
    gone : str
        What has happened when tasks are cancelled that were not cancelled here.
    failures : list of Failure
        Tasks that were given up.
    """

    most_in_flight: int
    gone = "the workers are gone"

    def __init__(self) -> None:
        self.failures: list[Failure] = []

    @abstractmethod
    def submit(self, task: Arrays) -> "Future[Any]":
        """Hand a task to a worker.

        Raises
        ------
        LostError, BrokenExecutor
        """

    def read(self, answer: Any) -> Arrays:
        """Return the answer that a worker gave, as it is."""
        found: Arrays = answer
        return found

    def restart(self) -> None:
        """Begin anew after workers died; tasks in flight are forgotten.

        Raises
        ------
        LostError
            When this engine cannot.
        """
        raise LostError("the executor broke: a worker died")

    @abstractmethod
    def close(self, now: bool) -> None:
        """End; with `now`, do not wait for tasks in flight."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        """End; what was interrupted, or went wrong, ends now."""
        self.close(now=kind is not None)

    def run(self, tasks: Iterable[Task]) -> Iterator[Task]:
        """Yield the answers to tasks with their numbers, as they come; what is given up is in `failures`.

        A worker that dies takes all tasks in flight with it, and it is not known which of them killed it. So each of
        these is tried again alone: what fails alone is to blame.

        Parameters
        ----------
        tasks : iterable of Task
            Read when they are handed out, so that only those in flight are in memory.

        Raises
        ------
        LostError
            When the workers are gone.
        """
        queue, in_flight = _Queue(tasks, self.failures), dict[Future[Any], Task]()
        while True:
            died, lost = None, list[Task]()
            try:
                while len(in_flight) < self.most_in_flight and (task := queue.take(idle=not in_flight)) is not None:
                    lost = [task]
                    in_flight[self.submit(task[1])] = task
                lost = []
            except BrokenExecutor as error:
                died = error
            if not in_flight and died is None:
                return
            for future in wait(in_flight, return_when=FIRST_COMPLETED).done:
                task = in_flight.pop(future)
                try:
                    answer = self.read(future.result())
                except BrokenExecutor as error:
                    died, lost = error, [*lost, task]
                except CancelledError:
                    raise LostError(self.gone) from None
                except Exception as error:
                    queue.put_back(task, error)
                else:
                    yield task[0], answer
            if died is not None:
                self.restart()
                queue.put_back_lost([*lost, *in_flight.values()], died)
                in_flight.clear()

    def results(self, tasks: Iterable[Arrays], undone: str) -> list[Arrays]:
        """Return the answers to tasks, in their order.

        Raises
        ------
        UnfinishedError
            When one of them failed three times, which the text `undone` says.
        LostError
            When the workers are gone.
        """
        found = dict(self.run(enumerate(tasks)))
        if self.failures:
            raise UnfinishedError(f"{undone}: {self.failures[0].reason}")
        return [found[number] for number in sorted(found)]


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
