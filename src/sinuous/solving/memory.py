"""What one robot has solved before, kept as starts for what is asked next."""

import hashlib
import json
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous import checks
from sinuous.arguments import Batch, Number, Truth
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.kernels.tables import (
    DIRECTION,
    GOAL,
    HAS_POSITION,
    ORIENTATION,
    ROTATION,
    TARGET_POSITION,
    TARGET_SEGMENT,
    TARGET_WIDTH,
)
from sinuous.problem.target import Targets, target_list, target_table
from sinuous.reprs import ShortRepr
from sinuous.robot.robot import Robot, demanding
from sinuous.writing.documents import written

FORMAT = 1
"""Version of the file; the kind of file is told by the key `memory`."""

NEAREST = 4
"""Shapes that are offered for one target: further ones seldom lead to a solution where these do not."""

ANGLE_WEIGHT = 0.5
"""Share of the robot's mean length that counts as far as 1 rad, where the nearest poses are looked for."""

SPACING = 0.02
"""Shapes nearer than that to the start that led to them are not kept: rad, and mean lengths of a segment."""

TAIL = 64
"""Shapes that may be looked through one by one before they are sorted into the tree again."""

TAIL_SHARE = 0.125
"""The same as a share of all shapes: sorting costs a constant for each shape that is kept."""

POSE_SIZE = 12
"""Numbers of a pose: a rotation, row by row, and a position."""

TREE_BYTES = 256
"""Memory of one shape in trees and their features."""

MEGABYTES = 100.0
"""Default bound of a memory."""


class Memory(ShortRepr):
    """Shapes of one robot that met earlier targets, as starts for new ones.

    A solve with a memory tries the shapes whose poses are nearest to its targets before it searches, and adds what it
    finds. A remembered shape is a start and never an answer: it is followed and proved like any other, so the memory
    may be of another scene, or of one that has changed since. For the same memory and seed the answer is the same.
    Safe to share between threads.

    Parameters
    ----------
    robot : Robot
        The robot whose shapes these are.
    megabytes : float
        Most memory that is used, in 10^6 bytes: the older half is forgotten when it is full.
    learns : bool
        Whether solves add what they find.

    Attributes
    ----------
    robot : Robot
    megabytes : float
    learns : bool

    Raises
    ------
    InputError
        When an argument is not what it should be.

    Examples
    --------
    >>> memory = sn.Memory(robot)
    >>> solver = sn.Solver(robot, scene, memory=memory)
    >>> memory.save("arm.memory.npz")
    """

    def __init__(self, robot: Robot, megabytes: Number = MEGABYTES, learns: Truth = True) -> None:
        if not isinstance(robot, Robot):
            raise InputError("robot", "", robot, "a Robot")
        self.robot = robot
        self.megabytes = checks.number("megabytes", megabytes, above=0.0)
        self.learns = checks.truth("learns", learns)
        n = len(robot)
        self._most = max(2, int(1e6 * self.megabytes / (8 * n * (3 + POSE_SIZE) + TREE_BYTES)))
        self._scale = np.array([1.0, 1.0, max(robot.mean_length / n, np.finfo(float).tiny)])
        self._lock = threading.Lock()
        self._forget()

    def _forget(self) -> None:
        self._count, self._shapes = 0, np.empty((0, len(self.robot), 3))
        self._poses = np.empty((0, len(self.robot), POSE_SIZE))
        self._indices: dict[tuple[Asked, ...], _Index] = {}

    def __len__(self) -> int:
        return self._count

    @property
    def q(self) -> Floats:
        """All shapes that are kept (m, n, 3), the oldest first; a copy."""
        with self._lock:
            shapes: Floats = self._shapes[: self._count].copy()
            return shapes

    def add(self, q: Batch) -> None:
        """Keep configurations (n, 3) or (m, n, 3), within the limits of the robot or not.

        Raises
        ------
        InputError
            When it is no configuration of this robot.
        """
        shapes = self.robot.configuration("q", q).reshape(-1, len(self.robot), 3)
        self._add(shapes[-self._most :])

    def nearest(self, targets: Targets, count: int = NEAREST) -> Floats:
        """Return the `count` shapes (k, n, 3) whose poses are nearest to the targets, the nearest first.

        A rotation of 1 rad counts as far as half of the robot's mean length.

        Raises
        ------
        InputError
            When an argument is not what it should be.
        """
        most = checks.integer("count", count, 1, 10_000)
        found: Floats = self.nearest_to(
            target_table(self.robot, target_list("targets", targets, self.robot))[None], most
        )[0]
        return found

    def serves(self, robot: Robot) -> bool:
        """Whether these are shapes of this robot, whatever clearances it demands."""
        one, other = (demanding(each, 0.0, 0.0) for each in (robot, self.robot))
        return one.equals(other)

    def check(self, robot: Robot) -> None:
        """Refuse to serve another robot.

        Raises
        ------
        InputError
        """
        if not self.serves(robot):
            raise InputError("memory", "of another robot", self, f"shapes of {robot}")

    def reading(self) -> "Memory":
        """Return these shapes as a memory that keeps nothing new."""
        other = Memory(self.robot, self.megabytes, learns=False)
        other.add(self.q)
        return other

    @property
    def fingerprint(self) -> str:
        """A hash (12 hexadecimal digits) of all shapes that are kept."""
        return hashlib.sha256(self.q.tobytes()).hexdigest()[:12]

    def save(self, file: str | Path) -> None:
        """Write it as NPZ, in one step: a file that was there stays until the new one is complete.

        Raises
        ------
        InputError
            When the file cannot be written.
        """
        path = Path(file)
        draft = path.with_name(f".{path.name}.draft")
        with written(path):
            try:
                with draft.open("wb") as out:
                    own: dict[str, Any] = {"megabytes": self.megabytes, "learns": self.learns, "q": self.q}
                    np.savez(out, memory=FORMAT, robot=json.dumps(self.robot.to_dict()), **own)
                draft.replace(path)
            finally:
                draft.unlink(missing_ok=True)

    @classmethod
    def load(cls, file: str | Path) -> "Memory":
        """Read what `save` wrote.

        Raises
        ------
        InputError
            When it is no such file.
        """
        return read_memory(file)

    def _add(self, shapes: Floats) -> None:
        poses = _poses(self.robot, shapes)
        with self._lock:
            if self._count + len(shapes) > self._most:
                kept = min(self._count, self._most // 2, self._most - len(shapes))
                self._shapes = self._shapes[self._count - kept : self._count].copy()
                self._poses = self._poses[self._count - kept : self._count].copy()
                self._count, self._indices = kept, {}
            end = self._count + len(shapes)
            if end > len(self._shapes):
                room = max(0, min(self._most, 2 * end) - len(self._shapes))
                self._shapes = np.concatenate([self._shapes, np.empty((room, *self._shapes.shape[1:]))])
                self._poses = np.concatenate([self._poses, np.empty((room, *self._poses.shape[1:]))])
            self._shapes[self._count : end], self._poses[self._count : end] = shapes, poses
            self._count = end

    def learn(self, found: Floats) -> None:
        """Keep solutions (m, n, 3), without those that are hardly different from the kept shape of the nearest tip."""
        if not self.learns:
            return
        if self._count and len(found):
            pose = _poses(self.robot, found)[:, -1]
            rows = np.zeros((len(found), 1, TARGET_WIDTH))
            rows[:, 0, TARGET_SEGMENT], rows[:, 0, HAS_POSITION], rows[:, 0, ORIENTATION] = -1, 1.0, ROTATION
            rows[:, 0, TARGET_POSITION : TARGET_POSITION + 3], rows[:, 0, GOAL : GOAL + 9] = pose[:, 9:], pose[:, :9]
            found = found[~self.alike(found, self.nearest_to(rows, 1)[:, 0])]
        if len(found):
            self._add(found)

    def alike(self, one: Floats, other: Floats) -> NDArray[np.bool_]:
        """Whether configurations (..., n, 3) are hardly different from others: truth values (...)."""
        found: NDArray[np.bool_] = np.max(np.abs(one - other) / self._scale, axis=(-2, -1)) <= SPACING
        return found

    def nearest_to(self, rows: Floats, count: int = NEAREST) -> Floats:
        """Return the shapes (m, k, n, 3) nearest to target sets (m, t, 15); k is at most `count`."""
        kinds = [tuple(_asked(row) for row in each) for each in rows[:, :, [TARGET_SEGMENT, HAS_POSITION, ORIENTATION]]]
        with self._lock:
            chosen = np.empty((len(rows), min(count, self._count)), np.int64)
            for asked in set(kinds) if chosen.size else ():
                some = [i for i, kind in enumerate(kinds) if kind == asked]
                index = self._indices.setdefault(asked, _Index(asked, self.robot.mean_length))
                chosen[some] = index.nearest(self._poses[: self._count], rows[some], chosen.shape[1])
            return self._shapes[chosen]

    def _shown(self) -> Iterator[str]:
        yield f"{len(self.robot)} segments"
        yield f"{self._count} shapes"

    def __getstate__(self) -> dict[str, Any]:
        return {"robot": self.robot, "megabytes": self.megabytes, "learns": self.learns, "q": self.q}

    def __setstate__(self, state: dict[str, Any]) -> None:
        Memory.__init__(self, state["robot"], state["megabytes"], state["learns"])
        self._add(state["q"])


class Asked(NamedTuple):
    """What one target asks for, whatever its numbers.

    Attributes
    ----------
    segment : int
        The segment whose end is meant, from 0; -1: the last.
    position : bool
    orientation : int
        `FREE`, `DIRECTION` or `ROTATION`.
    """

    segment: int
    position: bool
    orientation: int


class _Index:
    """Finds the nearest of the shapes for targets that ask for one kind of thing: a tree, and a tail beside it.

    Parameters
    ----------
    asked : tuple of Asked
    length : float
        Mean length of the robot, that distances count in.
    """

    def __init__(self, asked: tuple[Asked, ...], length: float) -> None:
        self._asked, self._length = asked, length
        self._features: Floats = np.empty((0, 0))
        self._tree: Any = None
        self._sorted = 0

    def nearest(self, poses: Floats, rows: Floats, count: int) -> Any:
        """Return the numbers (m, count) of the shapes with poses (s, n, 12) nearest to target sets (m, t, 15)."""
        self._grow(poses)
        wanted = np.concatenate([self._wanted(each, rows[:, i]) for i, each in enumerate(self._asked)], axis=1)
        near = min(count, self._sorted)
        distances, numbers = np.empty((len(rows), 0)), np.empty((len(rows), 0), np.int64)
        if near:
            distances, numbers = (found.reshape(len(rows), near) for found in self._tree.query(wanted, near))
        tail = self._features[self._sorted :]
        if len(tail):
            beside = np.sqrt(((wanted[:, None] - tail) ** 2).sum(axis=-1))
            distances = np.concatenate([distances, beside], axis=1)
            numbers = np.concatenate([numbers, np.broadcast_to(self._sorted + np.arange(len(tail)), beside.shape)], 1)
        order = np.argsort(distances, axis=1, kind="stable")[:, :count]
        return np.take_along_axis(numbers, order, 1)

    def _grow(self, poses: Floats) -> None:
        """Take the shapes in that were added since."""
        before = len(self._features)
        if len(poses) > before:
            added = np.concatenate([self._offered(each, poses[before:]) for each in self._asked], axis=1)
            self._features = np.concatenate([self._features.reshape(before, added.shape[1]), added])
        if len(poses) - self._sorted > max(TAIL, TAIL_SHARE * self._sorted):
            from scipy.spatial import cKDTree  # noqa: PLC0415

            self._tree, self._sorted = cKDTree(self._features), len(self._features)

    def _offered(self, asked: Asked, poses: Floats) -> Floats:
        """What poses (s, n, 12) of shapes are at one target: features (s, d)."""
        pose = poses[:, asked.segment]
        turned = {DIRECTION: pose[:, 2:9:3], ROTATION: pose[:, :9]}.get(asked.orientation, pose[:, :0])
        return self._features_of(asked, pose[:, 9:], turned)

    def _wanted(self, asked: Asked, rows: Floats) -> Floats:
        """What targets (m, 15) of one kind ask for: features (m, d)."""
        size = {DIRECTION: 3, ROTATION: 9}.get(asked.orientation, 0)
        return self._features_of(asked, rows[:, TARGET_POSITION : TARGET_POSITION + 3], rows[:, GOAL : GOAL + size])

    def _features_of(self, asked: Asked, places: Floats, turned: Floats) -> Floats:
        """Features of which the distance is that of poses, in mean lengths: a small turn counts by its angle."""
        angles = ANGLE_WEIGHT / np.sqrt(2.0 if asked.orientation == ROTATION else 1.0) * turned
        return np.concatenate([places / self._length, angles], axis=1) if asked.position else angles


def _asked(columns: Floats) -> Asked:
    """What a target asks for, of its columns (3,)."""
    return Asked(int(columns[0]), bool(columns[1] > 0.0), int(columns[2]))


def _poses(robot: Robot, shapes: Floats) -> Floats:
    """Return the poses (m, n, 12) of the ends of all segments, of the last one that of the tool."""
    frames = robot.forward(shapes)
    frames[:, -1] = frames[:, -1] @ robot.tool
    return np.concatenate([frames[..., :3, :3].reshape(*frames.shape[:2], 9), frames[..., :3, 3]], axis=-1)


def read_memory(file: str | Path) -> Memory:
    """Read a file that `Memory.save` wrote.

    Raises
    ------
    InputError
        When it is no such file.
    """
    from sinuous.files.nouns import read_robot  # noqa: PLC0415

    what = "a file that Memory.save wrote"
    try:
        with Path(file).open("rb") as stream, np.load(stream) as data:  # NumPy leaves a file open that is no archive
            if int(data["memory"]) != FORMAT:
                raise InputError("memory", "of another version", int(data["memory"]), str(FORMAT), str(file))
            robot = read_robot(json.loads(str(data["robot"])))
            memory = Memory(robot, float(data["megabytes"]), learns=bool(data["learns"]))
            memory.add(data["q"])
            return memory
    except OSError as error:
        raise InputError("memory", f"cannot be read: {error}", str(file), what) from None
    except InputError as error:
        raise InputError("memory", f"damaged: {error}", str(file), what) from None
    except Exception as error:  # a damaged archive raises errors of zipfile, zlib, numpy, json
        raise InputError("memory", f"damaged: {error}", str(file), what) from None
