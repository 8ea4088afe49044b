"""What the kernels read of a scene: a table with one row an obstacle, and one store of numbers for all.

Triangles, balls and cubes are in the order in which the kernels search them, see `sinuous.kernels.fields.trees`.
"""

import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels import packing
from sinuous.kernels import tables as t
from sinuous.kernels.tables import BALLS, CUBES, TRIANGLES
from sinuous.scene import sampling
from sinuous.scene.grids import Field, Grid
from sinuous.scene.hierarchy import BOX_NUMBERS, PADDING
from sinuous.scene.mesh import Mesh
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.point_cloud import PointCloud
from sinuous.scene.sampling import Progress
from sinuous.scene.trees import enclose_in_order, tree_of_boxes
from sinuous.scene.triangles import bodies_overlap, boxes_of, cross, sides_of, size_of, with_planes


def part_normals(vertices: Floats, faces: NDArray[np.int64]) -> Floats:
    """Normals of the inside, the three edges and the three corners of every triangle of a closed surface.

    At an edge the sum of the normals of its triangles; at a corner their sum weighted by their angles there (Baerentzen
    & Aanaes 2005, Signed distance computation using the angle weighted pseudonormal).

    Parameters
    ----------
    vertices : ndarray (v, 3)
    faces : ndarray of int64 (f, 3)

    Returns
    -------
    ndarray (f, 7, 3)
        Unit vectors: triangle; edges from the first corner to the second, second to third, third to first; corners.
    """
    corners = [vertices[corner].T for corner in faces.T]
    sides = [after - own for own, after in zip(corners, [*corners[1:], corners[0]], strict=True)]
    flat = _unit(cross(sides[0], sides[1]))
    weighted = []
    for own, last in zip(sides, [sides[2], *sides[:2]], strict=True):
        angle = np.arctan2(size_of(cross(own, -last)), (own * -last).sum(axis=0))
        weighted.append(angle * flat)
    # Sums are made triangle by triangle, so that their rounding does not depend on how they are gathered.
    index, each = faces.ravel(), np.stack(weighted, axis=-1).reshape(3, -1)
    at_corners = _unit(np.stack([np.bincount(index, axis, len(vertices)) for axis in each]))[:, index]
    order = np.argsort(sides_of(faces)[2], kind="stable")
    at_edges = np.empty((3, 3 * len(faces)))
    at_edges[:, order] = np.repeat(_unit(flat[:, order[::2] // 3] + flat[:, order[1::2] // 3]), 2, axis=1)
    result = np.empty((len(faces), 7, 3))
    result[:, 0] = flat.T
    result[:, 1:4], result[:, 4:] = at_edges.T.reshape(-1, 3, 3), at_corners.T.reshape(-1, 3, 3)
    return result


def _unit(vectors: Floats) -> Floats:
    """Scale vectors (3, m) to length 1; zero stays zero."""
    length = size_of(vectors)
    return np.asarray(vectors / np.where(length > 0.0, length, 1.0))


PIECE_SECONDS = 8e-6
"""Seconds that a primitive takes to be prepared, but for samples, about."""

WORSE = 1.5
"""By how much larger leaves may be than in a new order, on average, before one is made."""


class LeafOrder(NamedTuple):
    """An order of primitives (m,), and the sum of the sides of all leaves of the tree when it was made."""

    order: NDArray[np.int64]
    leaves: float


@dataclass(frozen=True)
class Pieces:
    """Many primitives of one kind, in the order of their tree.

    Attributes
    ----------
    kind : int
        TRIANGLES, BALLS or CUBES of the kernels.
    levels : int
        Of the tree.
    nodes : ndarray (2 << levels, 6)
        Boxes of the tree.
    items : ndarray (m, size)
        Numbers of the primitives.
    normals : ndarray (m, 21) or (0, 21)
        Of the parts of triangles, where they have an inside.
    sign : float
        -1 where the body must stay inside.
    half : float
        Half side of cubes.
    rounding : float
        What is taken off the distance.
    order : LeafOrder or None
        Of balls: how they were put in order.
    """

    kind: int
    levels: int
    nodes: Floats
    items: Floats
    normals: Floats
    sign: float = 1.0
    half: float = 0.0
    rounding: float = 0.0
    order: LeafOrder | None = None

    @property
    def low(self) -> Floats:
        """Low corner (3,) of the box about all."""
        return self.nodes[1, :3] - self.rounding

    @property
    def high(self) -> Floats:
        """High corner (3,) of the box about all."""
        return self.nodes[1, 3:] + self.rounding


NO_NORMALS = np.empty((0, 21))


def triangles(mesh: Mesh) -> Pieces:
    """Triangles of a mesh, with normals where it is watertight."""
    vertices, faces = mesh.vertices, mesh.faces
    large = mesh.watertight and len(faces) >= t.FEWEST_SAMPLED
    with ThreadPoolExecutor(1) as beside:  # NumPy works on large arrays without the interpreter's lock
        later = beside.submit(part_normals, vertices, faces) if large else None
        corners = vertices[faces]
        order, levels, nodes = tree_of_boxes(corners.mean(axis=1), *boxes_of(corners))
        items = with_planes(corners[order])
    normals = NO_NORMALS
    if mesh.watertight:
        normals = part_normals(vertices, faces) if later is None else later.result()
    return Pieces(
        TRIANGLES,
        levels,
        nodes,
        items,
        normals[order].reshape(-1, 21) if mesh.watertight else normals,
        sign=-1.0 if mesh.inside else 1.0,
        rounding=mesh.half_thickness,
    )


def balls(cloud: PointCloud, like: LeafOrder | None = None) -> Pieces:
    """Balls about the points of a cloud; in the order of as many earlier balls, if those lay in about the same way."""
    radii = cloud.radii[:, None]
    corners = cloud.points - radii, cloud.points + radii
    known = None if like is None or len(like.order) != len(cloud.points) else like
    if known is not None:
        levels, nodes = enclose_in_order(known.order, *corners)
        known = known if _leaves(levels, nodes) <= WORSE * known.leaves else None
    if known is None:
        order, levels, nodes = tree_of_boxes(cloud.points, *corners)
        known = LeafOrder(order, _leaves(levels, nodes))
    items = np.concatenate([cloud.points, radii], axis=1)[known.order]
    return Pieces(BALLS, levels, nodes, items, NO_NORMALS, order=known)


def cubes(centers: Floats, side: float) -> Pieces:
    """Solid cubes about points (m, 3)."""
    order, levels, nodes = tree_of_boxes(centers, centers - 0.5 * side, centers + 0.5 * side)
    return Pieces(CUBES, levels, nodes, centers[order], NO_NORMALS, half=0.5 * side)


def _leaves(levels: int, nodes: Floats) -> float:
    """Sum of the sides of all leaves."""
    leaves = nodes[1 << levels :]
    return float((leaves[:, 3:] - leaves[:, :3]).sum())


NOTHING = np.empty(0)


class Part(NamedTuple):
    """What the kernels read of one obstacle.

    Attributes
    ----------
    row : ndarray (33,)
        Its places in the store are counted from the beginning of its own.
    store : ndarray (s,)
    own_box : ndarray (16,) or None
        Of what is in the store, where that was described: see `box`.
    """

    row: Floats
    store: Floats
    own_box: Floats | None = None

    @property
    def box(self) -> Floats:
        """A box about it (16,), see `hierarchy.BOX_NUMBERS`; infinite where there is none."""
        if self.row[t.KIND] < t.TREE:
            return self.row[t.CENTER : t.ROUNDING_RADIUS + 1]
        if self.own_box is None:
            return np.full(BOX_NUMBERS, np.inf)
        box = self.own_box.copy()
        if self.row[t.PLACED]:
            turn = self.row[t.PLACE : t.PLACE + 9].reshape(3, 3)
            box[:3] = turn @ box[:3] + self.row[t.PLACE + t.POSE_POSITION : t.PLACE + t.POSE_WIDTH]
            box[3:12] = (turn @ box[3:12].reshape(3, 3)).ravel()
        return box


class _Entry:
    """What is prepared of one obstacle, and the lock of whoever prepares it."""

    __slots__ = ("lock", "order", "parts")

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.parts: dict[int, Part] = {}  # by how many share samples
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


UNSAMPLED = 0
"""Stands for how many share samples where there are none."""


def _sharing(obstacle: Obstacle, many: int) -> int:
    """How many obstacles share the samples of one: parts of one mesh, or all of a scene with so `many` in its store.

    Rounded up to a power of two, so that adding some to a scene does not change all others.
    """
    own = obstacle.together if isinstance(obstacle, Mesh) else 1
    return max(own, 1 << (many - 1).bit_length()) if many >= t.MANY_OBSTACLES else own


def prepare(obstacle: Obstacle, name: str, progress: Progress | None = None, many: int = 1) -> Part:
    """Make what the kernels read of an obstacle of the store, once for all scenes with about as `many` of these.

    The store has meshes, clouds and grids.

    Raises
    ------
    InputError
        For a mesh that cuts through itself.
    """
    if obstacle.place is not None:
        root, pose = obstacle.place
        return put(prepare(root, name, progress, many), pose)
    entry, sharing = _entry(obstacle), _sharing(obstacle, many)
    with entry.lock:
        part = entry.parts.get(UNSAMPLED) or entry.parts.get(sharing)
        if part is None:
            part = entry.parts[sharing] = _prepare(obstacle, name, progress, sharing)
        return part


def seconds_to_prepare(obstacle: Obstacle, many: int) -> float:
    """How long `prepare` will take, about, where nothing is kept on disk."""
    if obstacle.place is not None:
        return seconds_to_prepare(obstacle.place[0], many)
    if not isinstance(obstacle, Mesh | PointCloud) or _entry(obstacle).parts:
        return 0.0
    of_mesh = isinstance(obstacle, Mesh)
    pieces = len(obstacle.faces) if isinstance(obstacle, Mesh) else len(obstacle.points)
    samples = sampling.sample_count(of_mesh, pieces, _sharing(obstacle, many))
    return sampling.SAMPLE_SECONDS * samples + PIECE_SECONDS * pieces


def put(part: Part, pose: Floats) -> Part:
    """Return what the kernels read of an obstacle that is in the store, moved by a pose (4, 4); the store is shared."""
    row = part.row.copy()
    row[t.PLACED] = 1.0
    row[t.PLACE : t.PLACE + t.POSE_WIDTH] = packing.pose_row(pose)[0]
    row[t.ROUNDOFF] += packing.roundoff(pose[None, :3, 3])
    return Part(row, part.store, part.own_box)


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
        if not entry.parts:
            like = None if before is None else _entry(before).order
            made = triangles(obstacle) if isinstance(obstacle, Mesh) else balls(obstacle, like)
            entry.parts[UNSAMPLED], entry.order = _of_pieces(made), made.order
        return next(iter(entry.parts.values()))


def _prepare(obstacle: Obstacle, name: str, progress: Progress | None, sharing: int) -> Part:
    if isinstance(obstacle, Field) or (isinstance(obstacle, Grid) and not obstacle.occupancy):
        return _of_samples(obstacle.values, obstacle.origin, obstacle.spacing, obstacle.exact_below)
    if isinstance(obstacle, Grid):
        occupied = np.argwhere(obstacle.values)
        return _sampled(cubes(obstacle.origin + obstacle.spacing * occupied, obstacle.spacing), progress, sharing)
    if isinstance(obstacle, PointCloud):
        return _sampled(balls(obstacle), progress, sharing)
    if isinstance(obstacle, Mesh):
        pieces = triangles(obstacle)
        # Cells are 2 MB each, and take as long as a hundred solves: of many meshes steps read some samples instead.
        celled = _is_small(pieces) and sharing < t.MANY_OBSTACLES
        if celled and not obstacle.watertight:
            return _with_candidates(pieces)
        # Of one with cells, too: samples tell whether its sides are as its normals say.
        part = _sampled(pieces, progress, sharing)
        if obstacle.watertight:
            _check_sides(obstacle, part, name)
        return _with_candidates(pieces) if celled else part
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
    store = np.concatenate([pieces.nodes.ravel(), pieces.items.ravel(), pieces.normals.ravel()])
    return Part(row, store, _box_of(pieces) if len(pieces.items) else None)


def _is_small(pieces: Pieces) -> bool:
    """Whether it is a mesh of few triangles."""
    return pieces.kind == TRIANGLES and len(pieces.items) < t.FEWEST_SAMPLED


def _box_of(pieces: Pieces) -> Floats:
    """A box (16,) about a few triangles along their own axes, about anything else along those of the world."""
    turn = np.eye(3)
    low, high = pieces.nodes[1, :3], pieces.nodes[1, 3:]
    if _is_small(pieces):
        corners = pieces.items[:, :9].reshape(-1, 3)
        own = np.linalg.svd(corners - corners.mean(axis=0), full_matrices=False)[2].T
        lows, highs = (corners @ own).min(axis=0), (corners @ own).max(axis=0)
        if np.prod(highs - lows) < np.prod(high - low):
            turn, low, high = own, lows, highs
    center, half = turn @ (0.5 * (low + high)), 0.5 * (high - low)
    return np.concatenate([center, turn.ravel(), half + PADDING * np.abs(center).sum(), [pieces.rounding]])


def _sampled(pieces: Pieces, progress: Progress | None, sharing: int) -> Part:
    """Row and store of a tree with samples, see `_sharing`."""
    part = _of_pieces(pieces)
    if not len(pieces.items):
        return part
    wanted = sampling.sample_count(pieces.kind == TRIANGLES, len(pieces.items), sharing)
    low, spacing, shape = sampling.sampling_grid(pieces.low, pieces.high, wanted)
    row = _with_grid(part.row, t.FIRST_SAMPLE, -1, shape, low, spacing)
    values = sampling.sample(row, part.store, low, spacing, shape, progress)
    extent = spacing * (np.array(shape) - 1.0)  # beyond the samples, a distance is no less than that to their grid
    box = np.concatenate([low + 0.5 * extent, np.eye(3).ravel(), 0.5 * extent, [0.0]])
    return Part(
        _with_grid(part.row, t.FIRST_SAMPLE, part.store.size, shape, low, spacing),
        np.concatenate([part.store, values.ravel()]),
        part.own_box if _is_small(pieces) else box,  # so few samples reach far about it
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
    return Part(row, np.concatenate([part.store, sampling.candidates(row, part.store, shape)]), part.own_box)


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
    wrong = "bodies that overlap" if mesh.piece_count > 1 and bodies_overlap(mesh.vertices, mesh.faces) else wrong
    if wrong:
        raise InputError(name, "cuts through itself", wrong, "its bodies one by one: mesh.bodies()")
