"""The shapes of a memory, found by their poses, and motions between them that were proved when they were kept."""

import hashlib
import threading
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
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
from sinuous.robot.robot import Robot

Whole = NDArray[np.int64]

NEAREST = 4
"""Shapes that are offered for one target: further ones seldom lead to a solution where these do not."""

ANGLE_WEIGHT = 0.5
"""Share of the robot's mean length that counts as far as 1 rad, where the nearest poses are looked for."""

SPACING = 0.02
"""Shapes nearer than that to what is kept already are not kept: rad, and mean lengths of a segment."""

TAIL = 512
"""Shapes that may be looked through one by one before they are sorted into the tree again: as quick as a tree."""

TAIL_SHARE = 0.125
"""The same as a share of all shapes: sorting costs a constant for each shape that is kept."""

POSE_SIZE = 12
"""Numbers of a pose: a rotation, row by row, and a position."""

SHAPE_BYTES = 512
"""Memory of one shape in trees and their features, and of the motions that begin there."""

KIND = (TARGET_SEGMENT, HAS_POSITION, ORIENTATION)
"""Columns of a target that say what is asked for, whatever its numbers."""

Asked = tuple[int, bool, int]
"""What one target asks for: the segment whose end is meant, from 0 (-1: the last); whether it has a position; and
`FREE`, `DIRECTION` or `ROTATION`."""


class Shapes:
    """Configurations of one robot, and pairs of them between which a motion was proved; safe to share between threads.

    Parameters
    ----------
    robot : Robot
    megabytes : float
        Most memory that is used, in 10^6 bytes.

    Attributes
    ----------
    version : int
        Another number whenever motions were added, or shapes forgotten.
    """

    def __init__(self, robot: Robot, megabytes: float) -> None:
        self._robot, n = robot, len(robot)
        self.most = max(2, int(1e6 * megabytes / (8 * n * (3 + POSE_SIZE) + SHAPE_BYTES)))
        self._scale = np.array([1.0, 1.0, max(robot.mean_length / n, np.finfo(float).tiny)])
        self._lock = threading.RLock()
        self._count, self.version = 0, 0
        self._q, self._poses = np.empty((0, n, 3)), np.empty((0, n, POSE_SIZE))
        self._edges: Whole = np.empty((0, 2), np.int64)
        self._indices: dict[tuple[Asked, ...], PoseIndex] = {}
        self._graph: tuple[int, Graph] | None = None

    def __len__(self) -> int:
        return self._count

    @property
    def q(self) -> Floats:
        """All shapes (m, n, 3), the oldest first; a copy."""
        with self._lock:
            return self._q[: self._count].copy()

    @property
    def edges(self) -> Whole:
        """Numbers (e, 2) of the shapes between which a motion was proved, the smaller first."""
        with self._lock:
            return self._edges.copy()

    @property
    def fingerprint(self) -> str:
        """A hash (12 hexadecimal digits) of all of this."""
        with self._lock:
            return hashlib.sha256(self.q.tobytes() + self._edges.tobytes()).hexdigest()[:12]

    def add(self, shapes: Floats, edges: Whole | None = None) -> int:
        """Keep shapes (m, n, 3), and motions between pairs (e, 2) of numbers; return how many shapes were kept.

        Where there is no room for all, the older half of those without motions is forgotten. Numbers of shapes that are
        added go on from those of shapes that are kept; with motions nothing is forgotten, and nothing kept for which
        there is no room.
        """
        with self._lock:
            if edges is None and self._count + len(shapes) > self.most:
                self._forget(len(shapes))
                shapes = shapes[: self.most - self._count]
            elif self._count + len(shapes) > self.most:
                return 0
            end = self._count + len(shapes)
            if end > len(self._q):
                room = min(self.most, 2 * end) - len(self._q)
                self._q = np.concatenate([self._q, np.empty((room, *self._q.shape[1:]))])
                self._poses = np.concatenate([self._poses, np.empty((room, *self._poses.shape[1:]))])
            self._q[self._count : end], self._poses[self._count : end] = shapes, poses_of(self._robot, shapes)
            self._count = end
            if edges is not None and len(edges):
                pairs = np.sort(edges, axis=1)
                self._edges = np.unique(np.concatenate([self._edges, pairs[pairs[:, 0] < pairs[:, 1]]]), axis=0)
                self.version += 1
            return len(shapes)

    def keep(self, shapes: NDArray[np.bool_], edges: NDArray[np.bool_]) -> None:
        """Forget all but some shapes (m,) and motions (e,)."""
        with self._lock:
            numbers = np.cumsum(shapes) - 1
            pairs = self._edges[edges & shapes[self._edges].all(axis=1)]
            self._q, self._poses = self._q[: self._count][shapes], self._poses[: self._count][shapes]
            self._edges, self._count, self._indices = numbers[pairs], len(self._q), {}
            self.version += 1

    def _forget(self, count: int) -> None:
        """Make room for so many, as far as that is possible."""
        kept = np.zeros(self._count, np.bool_)
        kept[self._edges] = True
        others = np.flatnonzero(~kept)
        room = self.most - (self._count - len(others))
        left = max(0, min(len(others), room // 2, room - count))
        kept[others[len(others) - left :]] = True
        self.keep(kept, np.ones(len(self._edges), np.bool_))

    def is_new(self, found: Floats) -> NDArray[np.bool_]:
        """Say of shapes (m, n, 3) which differ from the kept one of the nearest tip."""
        if not (self._count and len(found)):
            return np.ones(len(found), np.bool_)
        return ~self.alike(found, self.nearest(tip_rows(poses_of(self._robot, found)), 1)[:, 0])

    def alike(self, one: Floats, other: Floats) -> NDArray[np.bool_]:
        """Whether configurations (..., n, 3) are hardly different from others: truth values (...)."""
        found: NDArray[np.bool_] = np.abs((one - other) / self._scale).max(axis=(-2, -1)) <= SPACING
        return found

    def nearest(self, rows: Floats, count: int = NEAREST) -> Floats:
        """Return the shapes (m, k, n, 3) nearest to target sets (m, t, 15); k is at most `count`."""
        with self._lock:
            return self._q[nearest_numbers(self._indices, self._robot, self._poses[: self._count], rows, count)]

    @property
    def graph(self) -> "Graph":
        """The shapes that motions join, as they are now."""
        with self._lock:
            if self._graph is None or self._graph[0] != self.version:
                numbers, edges = np.unique(self._edges, return_inverse=True)
                graph = Graph(self._robot, self._q[numbers], self._poses[numbers], edges.reshape(-1, 2))
                self._graph = self.version, graph
            return self._graph[1]

    @property
    def everything(self) -> "Graph":
        """All shapes and motions, as they are now; numbers of shapes are those that are kept."""
        with self._lock:
            poses = self._poses[: self._count].copy()
            return Graph(self._robot, self.q, poses, self._edges)


class Graph:
    """Shapes (m, n, 3) that proved motions join, at one moment.

    Parameters
    ----------
    robot : Robot
    q : ndarray (m, n, 3)
    poses : ndarray (m, n, 12)
        Of the ends of all segments.
    edges : ndarray (e, 2) of int
    """

    def __init__(self, robot: Robot, q: Floats, poses: Floats, edges: Whole) -> None:
        self._robot, self.q, self._poses, self.edges = robot, q, poses, edges
        self._indices: dict[tuple[Asked, ...], PoseIndex] = {}

    def __len__(self) -> int:
        return len(self.q)

    @cached_property
    def parts(self) -> Whole:
        """Numbers (m,) of the parts that are joined: 0 is the largest."""
        from scipy.sparse import coo_array  # noqa: PLC0415
        from scipy.sparse.csgraph import connected_components  # noqa: PLC0415

        size = len(self.q)
        graph = coo_array((np.ones(len(self.edges), np.bool_), self.edges.T), shape=(size, size))
        labels = connected_components(graph, directed=False)[1]
        order = np.argsort(-np.bincount(labels), kind="stable")
        found: Whole = np.argsort(order)[labels] if size else np.empty(0, np.int64)
        return found

    @cached_property
    def neighbours(self) -> tuple[Whole, Whole, Whole]:
        """Where the neighbours of each shape begin (m + 1,), these (2 e,), and the number of the motion to each."""
        ends = np.concatenate([self.edges, self.edges[:, ::-1]])
        order = np.lexsort((ends[:, 1], ends[:, 0]))
        begins = np.searchsorted(ends[order, 0], np.arange(len(self.q) + 1))
        return begins, np.ascontiguousarray(ends[order, 1]), order % max(1, len(self.edges))

    def near(self, rows: Floats, count: int) -> Whole:
        """Return the numbers (m, k) of the shapes whose poses are nearest to target sets (m, t, 15)."""
        return nearest_numbers(self._indices, self._robot, self._poses, rows, count)

    def near_shapes(self, q: Floats, count: int) -> Whole:
        """Return the numbers (m, k) of the shapes whose tips are nearest to those of others (m, n, 3)."""
        return self.near(tip_rows(poses_of(self._robot, q)), count)

    @property
    def tips(self) -> Floats:
        """Positions (m, 3) of the tips."""
        return self._poses[:, -1, 9:]


class PoseIndex:
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

    def nearest(self, poses: Floats, rows: Floats, count: int) -> Whole:
        """Return the numbers (m, count) of the shapes with poses (s, n, 12) nearest to target sets (m, t, 15)."""
        self._grow(poses)
        wanted = _joined([self._wanted(each, rows[:, i]) for i, each in enumerate(self._asked)])
        near, tail = min(count, self._sorted), self._features[self._sorted :]
        if near:
            distances, found = (each.reshape(len(rows), near) for each in self._tree.query(wanted, near))
            if not len(tail):
                return np.asarray(found, np.int64)
        apart = wanted[:, None] - tail
        beside = np.einsum("msd,msd->ms", apart, apart)
        if not near:
            return np.asarray(beside.argsort(axis=1, kind="stable")[:, :count], np.int64)
        numbers = np.broadcast_to(np.arange(self._sorted, len(self._features)), beside.shape)
        order = _joined([distances, np.sqrt(beside)]).argsort(axis=1, kind="stable")[:, :count]
        return np.asarray(_joined([found, numbers])[np.arange(len(rows))[:, None], order], np.int64)

    def _grow(self, poses: Floats) -> None:
        """Take the shapes in that were added since."""
        before = len(self._features)
        if len(poses) > before:
            added = _joined([self._offered(each, poses[before:]) for each in self._asked])
            self._features = np.concatenate([self._features.reshape(before, added.shape[1]), added])
        if len(poses) - self._sorted > max(TAIL, TAIL_SHARE * self._sorted):
            from scipy.spatial import cKDTree  # noqa: PLC0415

            self._tree, self._sorted = cKDTree(self._features), len(self._features)

    def _offered(self, asked: Asked, poses: Floats) -> Floats:
        """What poses (s, n, 12) of shapes are at one target: features (s, d)."""
        pose = poses[:, asked[0]]
        turned = {DIRECTION: pose[:, 2:9:3], ROTATION: pose[:, :9]}.get(asked[2], pose[:, :0])
        return self._features_of(asked, pose[:, 9:], turned)

    def _wanted(self, asked: Asked, rows: Floats) -> Floats:
        """What targets (m, 15) of one kind ask for: features (m, d)."""
        size = {DIRECTION: 3, ROTATION: 9}.get(asked[2], 0)
        return self._features_of(asked, rows[:, TARGET_POSITION : TARGET_POSITION + 3], rows[:, GOAL : GOAL + size])

    def _features_of(self, asked: Asked, places: Floats, turned: Floats) -> Floats:
        """Features of which the distance is that of poses, in mean lengths: a small turn counts by its angle."""
        _, position, orientation = asked
        angles = ANGLE_WEIGHT / np.sqrt(2.0 if orientation == ROTATION else 1.0) * turned
        found: Floats = _joined([places / self._length, angles]) if position else angles
        return found


def nearest_numbers(
    indices: dict[tuple[Asked, ...], PoseIndex], robot: Robot, poses: Floats, rows: Floats, count: int
) -> Whole:
    """Return the numbers (m, k) of the poses (s, n, 12) nearest to target sets (m, t, 15); an index of a kind is kept.

    k is at most `count`.
    """
    chosen: Whole = np.empty((len(rows), min(count, len(poses))), np.int64)
    if not chosen.size:
        return chosen
    kinds = [tuple((int(s), p > 0.0, int(o)) for s, p, o in each) for each in rows[:, :, KIND].tolist()]
    for asked in set(kinds):
        index = indices.get(asked)
        if index is None:
            index = indices[asked] = PoseIndex(asked, robot.mean_length)
        some = [i for i, kind in enumerate(kinds) if kind == asked] if len(rows) > 1 else slice(None)
        chosen[some] = index.nearest(poses, rows[some], chosen.shape[1])
    return chosen


def _joined(parts: Sequence[Any]) -> Any:
    """Return columns beside each other; of one part, itself."""
    return parts[0] if len(parts) == 1 else np.concatenate(parts, axis=1)


def poses_of(robot: Robot, shapes: Floats) -> Floats:
    """Return the poses (m, n, 12) of the ends of all segments, of the last one that of the tool."""
    frames = robot.forward(shapes)
    frames[:, -1] = frames[:, -1] @ robot.tool
    poses: Floats = np.concatenate([frames[..., :3, :3].reshape(*frames.shape[:2], 9), frames[..., :3, 3]], axis=-1)
    return poses


def tip_rows(poses: Floats) -> Floats:
    """Return target sets (m, 1, 15) that ask for the poses (m, n, 12) of tips."""
    pose, rows = poses[:, -1], np.zeros((len(poses), 1, TARGET_WIDTH))
    rows[:, 0, TARGET_SEGMENT], rows[:, 0, HAS_POSITION], rows[:, 0, ORIENTATION] = -1, 1.0, ROTATION
    rows[:, 0, TARGET_POSITION : TARGET_POSITION + 3], rows[:, 0, GOAL : GOAL + 9] = pose[:, 9:], pose[:, :9]
    return rows
