"""The shapes of a memory, found by their poses, and motions between them that were proved when they were kept."""

import hashlib
import threading
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.kernels import tables as t
from sinuous.kernels.solve.recall import ANGLE_WEIGHT, compare, recall
from sinuous.model.robot import Robot

Whole = NDArray[np.int64]

NEAREST = 8
"""Shapes that are offered for one target: of these one often leads to a solution past all obstacles, in a few steps."""

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

KIND = (t.TARGET_SEGMENT, t.HAS_POSITION, t.ORIENTATION)
"""Columns of a target that say what is asked for, whatever its numbers."""

Asked = tuple[int, bool, int]
"""What one target asks for: the segment whose end is meant, from 0 (-1: the last); whether it has a position; and
`t.FREE`, `t.DIRECTION` or `t.ROTATION`."""


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
        self._finder = Finder(robot.mean_length)
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
            self._edges, self._count, self._finder = numbers[pairs], len(self._q), Finder(self._robot.mean_length)
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
        return ~self.alike(found, self.nearest(tip_rows(poses_of(self._robot, found)), 1))[:, 0]

    def alike(self, one: Floats, others: Floats) -> NDArray[np.bool_]:
        """Whether configurations (m, n, 3) are hardly different from others (m, k, n, 3): truth values (m, k)."""
        apart = np.empty(others.shape[:2])
        compare(one, others, self._scale, apart)
        return apart <= SPACING

    def nearest(self, rows: Floats, count: int = NEAREST) -> Floats:
        """Return the shapes (m, k, n, 3) nearest to target sets (m, t, 15); k is at most `count`."""
        with self._lock:
            return self._q[self._finder.nearest(self._poses[: self._count], rows, count)]

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
        self._finder = Finder(robot.mean_length)

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
        return np.argsort(order)[labels] if size else np.empty(0, np.int64)

    @cached_property
    def neighbours(self) -> tuple[Whole, Whole, Whole]:
        """Where the neighbours of each shape begin (m + 1,), these (2 e,), and the number of the motion to each."""
        ends = np.concatenate([self.edges, self.edges[:, ::-1]])
        order = np.lexsort((ends[:, 1], ends[:, 0]))
        begins = np.searchsorted(ends[order, 0], np.arange(len(self.q) + 1))
        return begins, np.ascontiguousarray(ends[order, 1]), order % max(1, len(self.edges))

    def near(self, rows: Floats, count: int) -> Whole:
        """Return the numbers (m, k) of the shapes whose poses are nearest to target sets (m, t, 15)."""
        return self._finder.nearest(self._poses, rows, count)

    def near_shapes(self, q: Floats, count: int) -> Whole:
        """Return the numbers (m, k) of the shapes whose tips are nearest to those of others (m, n, 3)."""
        return self.near(tip_rows(poses_of(self._robot, q)), count)

    @property
    def tips(self) -> Floats:
        """Positions (m, 3) of the tips."""
        return self._poses[:, -1, 9:]


class PoseIndex:
    """A tree of poses, by what targets of one kind ask of them, from which likely ones are taken.

    Parameters
    ----------
    asked : tuple of Asked
    length : float
        Mean length of the robot, that distances count in.

    Attributes
    ----------
    sorted : int
        How many shapes, from the first on, are in the tree.
    """

    def __init__(self, asked: tuple[Asked, ...], length: float) -> None:
        self._asked, self._length = asked, length
        self._tree: Any = None
        self.sorted = 0

    def likely(self, poses: Floats, rows: Floats, count: int) -> Whole:
        """Return the numbers (m, k) of shapes of the tree that are nearest to target sets (m, t, 15).

        k is at most `count`; `poses` (s, n, 12) are those of all shapes.
        """
        if len(poses) - self.sorted > max(TAIL, TAIL_SHARE * self.sorted):
            from scipy.spatial import cKDTree  # noqa: PLC0415

            self._tree = cKDTree(np.concatenate([self._offered(each, poses) for each in self._asked], axis=1))
            self.sorted = len(poses)
        near = min(count, self.sorted)
        if not near:
            return np.empty((len(rows), 0), np.int64)
        wanted = np.concatenate([self._wanted(each, rows[:, i]) for i, each in enumerate(self._asked)], axis=1)
        return np.asarray(self._tree.query(wanted, near)[1], np.int64).reshape(len(rows), near)

    def _offered(self, asked: Asked, poses: Floats) -> Floats:
        """What poses (s, n, 12) of shapes are at one target: features (s, d)."""
        pose = poses[:, asked[0]]
        turned = {t.DIRECTION: pose[:, 2:9:3], t.ROTATION: pose[:, :9]}.get(asked[2], pose[:, :0])
        return self._features_of(asked, pose[:, 9:], turned)

    def _wanted(self, asked: Asked, rows: Floats) -> Floats:
        """What targets (m, 15) of one kind ask for: features (m, d)."""
        size = {t.DIRECTION: 3, t.ROTATION: 9}.get(asked[2], 0)
        return self._features_of(
            asked, rows[:, t.TARGET_POSITION : t.TARGET_POSITION + 3], rows[:, t.GOAL : t.GOAL + size]
        )

    def _features_of(self, asked: Asked, places: Floats, turned: Floats) -> Floats:
        """Features of which the distance is that of poses, as kernels measure it: a small turn counts by its angle."""
        angles = ANGLE_WEIGHT / np.sqrt(2.0 if asked[2] == t.ROTATION else 1.0) * turned
        return np.concatenate([places / self._length, angles], axis=1) if asked[1] else angles


class Finder:
    """Finds the nearest of shapes for any targets; an index is kept for every kind of these.

    Parameters
    ----------
    length : float
        Mean length of the robot.
    """

    def __init__(self, length: float) -> None:
        self._length = length
        self._indices: dict[tuple[Asked, ...], PoseIndex] = {}

    def nearest(self, poses: Floats, rows: Floats, count: int) -> Whole:
        """Return the numbers (m, k) of the poses (s, n, 12) nearest to target sets (m, t, 15); k is at most `count`."""
        found: Whole = np.empty((len(rows), min(count, len(poses))), np.int64)
        if not found.size:
            return found
        scratch = np.empty(found.shape[1])
        if len(poses) <= TAIL:
            recall(poses, rows, self._length, found[:, :0], 0, found, scratch)
            return found
        kinds = [tuple((int(s), p > 0.0, int(o)) for s, p, o in each) for each in rows[:, :, KIND].tolist()]
        for asked in set(kinds):
            index = self._indices.setdefault(asked, PoseIndex(asked, self._length))
            some = np.array([kind == asked for kind in kinds])
            likely, part = index.likely(poses, rows[some], count), found[some]
            recall(poses, rows[some], self._length, likely, index.sorted, part, scratch)
            found[some] = part
        return found


def poses_of(robot: Robot, shapes: Floats) -> Floats:
    """Return the poses (m, n, 12) of the ends of all segments, of the last one that of the tool."""
    frames = robot.forward(shapes)
    frames[:, -1] = frames[:, -1] @ robot.tool
    return np.concatenate([frames[..., :3, :3].reshape(*frames.shape[:2], 9), frames[..., :3, 3]], axis=-1)


def tip_rows(poses: Floats) -> Floats:
    """Return target sets (m, 1, 15) that ask for the poses (m, n, 12) of tips."""
    pose, rows = poses[:, -1], np.zeros((len(poses), 1, t.TARGET_WIDTH))
    rows[:, 0, t.TARGET_SEGMENT], rows[:, 0, t.HAS_POSITION], rows[:, 0, t.ORIENTATION] = -1, 1.0, t.ROTATION
    rows[:, 0, t.TARGET_POSITION : t.TARGET_POSITION + 3], rows[:, 0, t.GOAL : t.GOAL + 9] = pose[:, 9:], pose[:, :9]
    return rows
