"""What the kernels read of a scene: a table with one row an obstacle, and one store of numbers for all."""

import threading
from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels import packing
from sinuous.kernels import tables as t
from sinuous.scene.grids import Field, Grid
from sinuous.scene.meshes.bodies import bodies_overlap
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.obstacles import Obstacle, Primitive
from sinuous.scene.point_cloud import PointCloud
from sinuous.scene.prepared import sampling, trees
from sinuous.scene.prepared.sampling import Progress
from sinuous.scene.prepared.trees import LeafOrder, Pieces

NOTHING = np.empty(0)


@dataclass(frozen=True)
class Part:
    """What the kernels read of one obstacle.

    Attributes
    ----------
    row : ndarray (33,)
        Its places in the store are counted from the beginning of its own.
    store : ndarray (s,)
    """

    row: Floats
    store: Floats


class _Entry:
    """What is prepared of one obstacle, and the lock of whoever prepares it."""

    __slots__ = ("lock", "order", "part")

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.part: Part | None = None
        self.order: LeafOrder | None = None


_ENTRIES: "WeakKeyDictionary[Obstacle, _Entry]" = WeakKeyDictionary()
_LOCK = threading.Lock()
"""Held while an entry is looked up, never while an obstacle is prepared: different ones do not wait for each other."""


def _entry(obstacle: Obstacle) -> _Entry:
    with _LOCK:
        entry = _ENTRIES.get(obstacle)
        if entry is None:
            entry = _ENTRIES[obstacle] = _Entry()
        return entry


def prepare(obstacle: Obstacle, name: str, progress: Progress | None = None) -> Part:
    """Make what the kernels read of an obstacle, once for all scenes that it is in.

    Raises
    ------
    InputError
        For a mesh that cuts through itself.
    """
    if isinstance(obstacle, Primitive):
        return Part(obstacle.row, NOTHING)
    if obstacle.place is not None:
        root, pose = obstacle.place
        return put(prepare(root, name, progress), pose)
    entry = _entry(obstacle)
    with entry.lock:
        if entry.part is None:
            entry.part = _prepare(obstacle, name, progress)
        return entry.part


def put(part: Part, pose: Floats) -> Part:
    """Return what the kernels read of an obstacle that is in the store, moved by a pose (4, 4); the store is shared."""
    row = part.row.copy()
    row[t.PLACED] = 1.0
    row[t.PLACE : t.PLACE + t.POSE_WIDTH] = packing.pose_row(pose)[0]
    row[t.ROUNDOFF] += packing.roundoff(pose[None, :3, 3])
    return Part(row, part.store)


def unsampled(obstacle: PointCloud | Mesh, before: PointCloud | None = None) -> Part:
    """Make what the kernels read of an obstacle that will soon be replaced: without samples, which take longer.

    Balls are left in the order of those of the cloud `before`, where they lie in about the same way: sorting takes most
    of the time.
    """
    if obstacle.place is not None:
        root, pose = obstacle.place
        assert isinstance(root, PointCloud | Mesh)
        return put(unsampled(root), pose)
    entry = _entry(obstacle)
    with entry.lock:
        if entry.part is None:
            like = None if before is None else _entry(before).order
            made = trees.triangles(obstacle) if isinstance(obstacle, Mesh) else trees.balls(obstacle, like)
            entry.part, entry.order = _of_pieces(made), made.order
        return entry.part


def _prepare(obstacle: Obstacle, name: str, progress: Progress | None) -> Part:
    if isinstance(obstacle, Field) or (isinstance(obstacle, Grid) and not obstacle.occupancy):
        return _of_samples(obstacle.values, obstacle.origin, obstacle.spacing, obstacle.exact_below)
    if isinstance(obstacle, Grid):
        occupied = np.argwhere(obstacle.values)
        return _sampled(trees.cubes(obstacle.origin + obstacle.spacing * occupied, obstacle.spacing), progress)
    if isinstance(obstacle, PointCloud):
        return _sampled(trees.balls(obstacle), progress)
    if isinstance(obstacle, Mesh):
        pieces = trees.triangles(obstacle)
        small = len(pieces.items) < sampling.FEWEST_PIECES
        if small and not obstacle.watertight:
            return _with_candidates(pieces)
        part = _sampled(pieces, progress)  # of a small one, too: samples tell whether its sides are as its normals say
        if obstacle.watertight:
            _check_sides(obstacle, part, name)
        return _with_candidates(pieces) if small else part
    raise NotImplementedError(f"no distance to {type(obstacle).__name__}")


def _of_pieces(pieces: Pieces) -> Part:
    """Row and store of a tree."""
    row = np.zeros(t.OBSTACLE_WIDTH)
    row[[t.KIND, t.SIGN]] = t.TREE, pieces.sign
    row[[t.LEVELS, t.ITEM_COUNT, t.ITEM_KIND]] = pieces.levels, len(pieces.items), pieces.kind
    row[[t.CUBE_HALF, t.ROUNDING_RADIUS]] = pieces.half, pieces.rounding
    items = pieces.nodes.size
    normals = items + pieces.items.size
    row[[t.NODES, t.ITEMS]] = 0.0, items
    row[[t.NORMALS, t.FIRST_SAMPLE, t.FIRST_CELL]] = normals if len(pieces.normals) else -1.0, -1.0, -1.0
    if len(pieces.items):
        row[t.ROUNDOFF] = packing.roundoff(np.stack([pieces.low, pieces.high]), abs(pieces.rounding))
    return Part(row, np.concatenate([pieces.nodes.ravel(), pieces.items.ravel(), pieces.normals.ravel()]))


def _sampled(pieces: Pieces, progress: Progress | None) -> Part:
    """Row and store of a tree with samples."""
    part = _of_pieces(pieces)
    if not len(pieces.items):
        return part
    wanted = min(max(sampling.PER_PIECE * len(pieces.items), sampling.LEAST), sampling.MOST)
    low, spacing, shape = sampling.sampling_grid(pieces.low, pieces.high, wanted)
    row = _with_grid(part.row, t.FIRST_SAMPLE, -1, shape, low, spacing)
    values = sampling.sample(row, part.store, low, spacing, shape, progress)
    return Part(
        _with_grid(part.row, t.FIRST_SAMPLE, part.store.size, shape, low, spacing),
        np.concatenate([part.store, values.ravel()]),
    )


def _of_samples(values: Floats, low: Floats, spacing: float, exact_below: float) -> Part:
    """Row and store of samples alone, which are distances below a value."""
    row = np.zeros(t.OBSTACLE_WIDTH)
    row[[t.KIND, t.SIGN, t.NODES, t.ITEMS, t.NORMALS, t.FIRST_CELL]] = t.SAMPLES, 1.0, -1.0, -1.0, -1.0, -1.0
    row[t.EXACT_BELOW] = exact_below
    corners = np.stack([low, low + spacing * np.array(values.shape)])
    row[t.ROUNDOFF] = packing.roundoff(corners, float(np.abs(values).max()))
    return Part(_with_grid(row, t.FIRST_SAMPLE, 0, values.shape, low, spacing), values.ravel().copy())


def _with_candidates(pieces: Pieces) -> Part:
    """Row and store of a tree of triangles, and lists of those that may be the closest."""
    part = _of_pieces(pieces)
    low, spacing, shape = sampling.sampling_grid(pieces.low, pieces.high, sampling.CELLS)
    row = _with_grid(part.row, t.FIRST_CELL, part.store.size, shape, low, spacing)
    return Part(row, np.concatenate([part.store, sampling.candidates(row, part.store, shape)]))


def _with_grid(row: Floats, first: int, at: int, shape: Any, low: Floats, spacing: float) -> Floats:
    """Return a row that says where its grid is: `first` is the column of the place in the store."""
    result = row.copy()
    result[first], result[t.SPACING] = at, spacing
    result[t.SHAPE : t.SHAPE + 3] = shape
    result[t.ORIGIN : t.ORIGIN + 3] = low
    return result


def _check_sides(mesh: Mesh, part: Part, name: str) -> None:
    """Refuse a solid whose sides cannot be told apart: bodies that overlap, or a surface that cuts through itself.

    The former are found exactly, the latter by distances that jump between samples.
    """
    values = part.store[int(part.row[t.FIRST_SAMPLE]) :].reshape(part.row[t.SHAPE : t.SHAPE + 3].astype(int))
    jump = max(float(np.abs(np.diff(values, axis=axis)).max()) for axis in range(3))
    wrong = f"a distance that jumps by {jump:.3g}" if jump > part.row[t.SPACING] * (1.0 + 1e-6) else ""
    wrong = "bodies that overlap" if bodies_overlap(mesh.vertices, mesh.faces) else wrong
    if wrong:
        raise InputError(name, "cuts through itself", wrong, "its bodies one by one: mesh.bodies()")
