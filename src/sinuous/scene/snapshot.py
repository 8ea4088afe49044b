"""The obstacles as they are at one moment, how far points are from them, and how one of them is moved quickly."""

import math
import threading
from collections.abc import Callable, Collection, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.arguments import Number, Stack
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen
from sinuous.base.progress import LATE, estimated
from sinuous.kernels import packing
from sinuous.kernels import tables as t
from sinuous.scene.grids import Field, evaluate
from sinuous.scene.hierarchy import bounds, hierarchy, is_worn, refit, with_cells, without_cells
from sinuous.scene.mesh import Mesh
from sinuous.scene.moving import Course, Moving, standing_at
from sinuous.scene.obstacles import Obstacle, Primitive, boxes_of, indices_of, rows_of
from sinuous.scene.parts import NOTHING, Part, prepare, seconds_to_prepare, unsampled
from sinuous.scene.sampling import Progress

MOST_TREES = 0.25
"""Share of obstacles that are meshes, clouds or grids up to which it is noted who is near: lists of these take 0.1 s
and hardly make anything sooner (rubble, assembly)."""

DIFFERENCE = 1e-4
"""Step of the differences that stand for the gradient of a `Field`, in units of its spacing."""


class Surroundings:
    """What may be asked of obstacles, in a scene as it is now or in a snapshot of one."""

    __slots__ = ()

    def snapshot(self) -> "Snapshot":
        """Return the obstacles as they are now, frozen."""
        raise NotImplementedError

    @property
    def obstacles(self) -> tuple[Obstacle, ...]:
        """All obstacles, as they are now."""
        return self.snapshot()._obstacles

    @property
    def group(self) -> Floats:
        """What the kernels read, laid out as `sinuous.kernels.tables` says; read-only."""
        return packing.read_only(self.snapshot()._kernel_group)

    @property
    def table(self) -> Floats:
        """Rows (m, 33) for the kernels, read-only."""
        return packing.scene_parts(self.group)[0]

    @property
    def memory(self) -> int:
        """Bytes that the kernels read: at most 16 MB of samples or lists an obstacle, and some 350 bytes a triangle."""
        return self.snapshot()._kernel_group.nbytes

    def __len__(self) -> int:
        return len(self.obstacles)

    def __repr__(self) -> str:
        moves = ", some of which move" if self.snapshot().moves else ""
        return f"{type(self).__name__}({len(self)} obstacles{moves})"

    def name(self, index: int) -> str:
        """Name of an obstacle; one that has none is called by its kind and place in the list, like `sphere[3]`."""
        own = self.obstacles[index]
        return own.name or f"{own.kind}[{index}]"

    def _called(self, name: str) -> list[int]:
        """Indices of the obstacles of this name."""
        every = self.obstacles
        found = self.snapshot()._with_name(name)
        kind, _, number = name.removesuffix("]").rpartition("[")
        if kind and number.isdecimal() and int(number) < len(every) and not every[int(number)].name:
            found += [int(number)] if self.name(int(number)) == name else []
        return found

    def distance(self, points: Stack) -> Floats:
        """Signed distance (...) of points (..., 3) to the nearest obstacle; infinite in an empty scene.

        Exact: no samples are interpolated, and the function of a `Field` is called. Near a `Grid` of distances, of
        which only samples are known, it is the largest distance that they prove.
        """
        return self.snapshot()._query(points)[0]

    def at_most(self, points: Stack) -> Floats:
        """Upper bound (...) of the distance of points (..., 3): their `distance`, except near a `Grid` of distances."""
        return self.snapshot()._query(points)[3]

    def gradient(self, points: Stack) -> Floats:
        """Gradient (..., 3) of the distance at points (..., 3): a unit vector away from the nearest obstacle.

        Where the distance has a kink one of its sides is given; zero in an empty scene. That of a `Field` is taken by
        differences, that of a `Grid` of distances by interpolation; they need not be of length 1.
        """
        return self.snapshot()._query(points)[1]

    def nearest(self, points: Stack) -> NDArray[np.int64]:
        """Index (...) of the obstacle nearest to points (..., 3); -1 in an empty scene."""
        return self.snapshot()._query(points)[2]


def _part_of(obstacle: Obstacle, stored: int, name: str = "", progress: Progress | None = None) -> Part:
    """What the kernels read of an obstacle in a scene with so many in the store: of a primitive its row alone."""
    return Part(obstacle.row, NOTHING) if isinstance(obstacle, Primitive) else prepare(obstacle, name, progress, stored)


def _still(obstacle: Obstacle) -> Obstacle:
    """What moves, as it is described."""
    return obstacle.obstacle if isinstance(obstacle, Moving) else obstacle


def group_of(parts: Sequence[Part], beside: Collection[int] = ()) -> Floats:
    """What the kernels read of all obstacles; those that are `beside` the hierarchy may be moved in it."""
    rows = np.array([part.row for part in parts], np.float64).reshape(-1, t.OBSTACLE_WIDTH)
    tree = np.zeros(0)
    if len(rows) >= t.MANY_OBSTACLES:
        boxes = rows[:, t.CENTER : t.ROUNDING_RADIUS + 1].copy()
        for i in np.flatnonzero(rows[:, t.KIND] >= t.TREE).tolist():
            boxes[i] = parts[i].box
        tree = hierarchy(rows, boxes, beside)
    return packing.scene_group(rows, [part.store for part in parts], tree)


class Snapshot(Surroundings, Frozen):
    """A union of obstacles, frozen. Distances are positive outside, negative inside, in the length unit.

    Problems and solutions hold the snapshot of the scene that they were solved in. What the kernels read of it is
    computed when it is first asked for, or by `prepare`. Where obstacles move there are distances `at` a time only.

    Parameters
    ----------
    obstacles : tuple of Obstacle
    parts : sequence of Part, optional
        What the kernels read of each, where it is known.
    """

    __slots__ = ("_fields", "_group", "_kept_sizes", "_listed", "_lock", "_moves", "_named", "_obstacles", "_parts")

    _fields: dict[int, Field] | None
    _kept_sizes: tuple[dict[int, float], float] | None
    _group: Floats | None
    _lock: threading.Lock
    _moves: bool | None
    _named: dict[str, list[int]] | None
    _listed: Floats | None
    _obstacles: tuple[Obstacle, ...]
    _parts: Sequence[Part] | None

    def __init__(self, obstacles: tuple[Obstacle, ...], parts: Sequence[Part] | None = None) -> None:
        kept: dict[str, Any] = {
            "_group": None,
            "_fields": None,
            "_moves": None,
            "_kept_sizes": None,
            "_listed": None,
            "_named": None,
        }
        self._set(_obstacles=obstacles, _parts=parts, _lock=threading.Lock(), **kept)

    def snapshot(self) -> "Snapshot":
        """Return itself."""
        return self

    def _with_name(self, name: str) -> list[int]:
        if self._named is None:  # every move asks
            named: dict[str, list[int]] = {}
            for i, own in enumerate(self._obstacles):
                if own.name is not None:
                    named.setdefault(own.name, []).append(i)
            self._set(_named=named)
        return list((self._named or {}).get(name, ()))

    @property
    def _kernel_group(self) -> Floats:
        """What the kernels read, writable, as they are compiled for."""
        if self._group is None:
            self.refuse_moving()
            self.prepare()
        return self._group  # type: ignore[return-value]  # `prepare` has set it

    def prepare(self, progress: Callable[[str, float], object] | None = None) -> None:
        """Compute what the kernels read, if that is not done yet; see `Scene.prepare`."""
        self._prepared(progress)

    def _prepared(self, progress: Callable[[str, float], object] | None = None) -> Sequence[Part]:
        """What the kernels read of each obstacle; after that, what they read of all is there, too, unless some move."""
        with self._lock:
            self._set(_parts=self._parts or self._all_parts(progress))
            parts: Sequence[Part] = self._parts or []
            if self._group is None and not self.moves:
                self._set(_group=group_of(parts))
        return parts

    @property
    def has_hierarchy(self) -> bool:
        """Whether there are so many obstacles that kernels have a tree of boxes over all of them."""
        rows, store = packing.scene_parts(self._kernel_group)
        return len(rows) >= t.MANY_OBSTACLES and bool(store[t.HIERARCHY_OBSTACLES] == len(rows))

    @property
    def is_crowded(self) -> bool:
        """Whether there are as many bodies as make a hierarchy, be they obstacles or pieces of solids."""
        solids = (own for own in self.obstacles if isinstance(own, Mesh) and own.watertight)
        return self.has_hierarchy or sum(solid.piece_count for solid in solids) >= t.MANY_OBSTACLES

    def list_near(self, place: Floats, reach: float, radius: float) -> None:
        """Note who is near, in cells about a place (3,): what kernels find is the same, and found several times sooner.

        Made once a snapshot, of a large scene, when a solve turns out to be hard: it takes as long as some hundred
        scattered starts of a robot with this reach and radius. For another robot elsewhere it is made anew, of all.
        Where many are meshes and clouds (`MOST_TREES`), nothing is noted.
        """
        rows, store = packing.scene_parts(self._kernel_group)
        if not self.has_hierarchy or np.mean(rows[:, t.KIND] >= t.TREE) > MOST_TREES:
            return
        all_of_it = bounds(store)
        box = np.clip(place + np.array([[-reach], [reach]]), *all_of_it)
        with self._lock:
            known = self._listed
            if known is not None and (known[0] <= box[0]).all() and (known[1] >= box[1]).all():
                return
            box = box if known is None else all_of_it
            made = np.concatenate([[float(len(rows))], rows.ravel(), with_cells(rows, store, box, radius)])
            self._set(_group=made, _listed=box)

    def group_beside(self, beside: Collection[int]) -> Floats:
        """What the kernels read, an array of its own, where the rows of some obstacles may be written."""
        return group_of(self._prepared(), beside)

    def _all_parts(self, progress: Callable[[str, float], object] | None) -> list[Part]:
        """Prepare each obstacle; where nobody is told of it and it takes long, a bar or a line says so."""
        exact, stored = indices_of(Primitive, self._obstacles), self._stored
        known = dict[int, Part]()
        if len(exact) >= t.MANY_OBSTACLES:  # they are quicker together
            listed: list[Any] = [self._obstacles[i] for i in exact]
            known = {i: Part(row, NOTHING) for i, row in zip(exact, rows_of(listed), strict=True)}

        def parts(say: Callable[[str, float], object] | None) -> list[Part]:
            return [known.get(i) or self._part(i, say, len(stored)) for i in range(len(self))]

        if progress is not None:
            return parts(progress)
        seconds = {i: seconds_to_prepare(own, len(stored)) for i, own in stored.items()}
        if sum(seconds.values()) < LATE:
            return parts(None)
        longest = self.name(max(seconds, key=seconds.__getitem__))
        several = " and others" if sum(each > 0.0 for each in seconds.values()) > 1 else ""
        with estimated(f"preparing {longest}{several}", sum(seconds.values())) as say:
            return parts(lambda name, share: say(f"preparing {name}", share))

    def forget(self) -> None:
        """Let go of the array that the kernels read: it is put together again when it is asked for."""
        self._set(_group=None)

    @property
    def courses(self) -> dict[int, Course]:
        """How the obstacles move that do, by their index."""
        return {i: own.course for i, own in enumerate(self._obstacles) if isinstance(own, Moving)}

    @property
    def moves(self) -> bool:
        """Whether an obstacle moves."""
        if self._moves is None:  # every plan asks several times
            self._set(_moves=bool(indices_of(Moving, self._obstacles)))
        return bool(self._moves)

    @property
    def _functions(self) -> dict[int, Field]:
        """The obstacles that are functions, by their index."""
        if self._fields is None:
            self._set(_fields={i: self._obstacles[i] for i in indices_of(Field, self._obstacles)})
        return self._fields or {}

    @property
    def _sizes(self) -> tuple[dict[int, float], float]:
        """Diagonals of boxes around the obstacles that end somewhere, by their index, and around all of these."""
        if self._kept_sizes is None:  # every solver and plan asks
            found = boxes_of(self._obstacles)
            corners = np.reshape([*found.values()], (len(found), 2, 3))
            sizes = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=-1).tolist()
            span = corners[:, 1].max(axis=0) - corners[:, 0].min(axis=0) if found else np.zeros(3)
            self._set(_kept_sizes=(dict(zip(found, sizes, strict=True)), float(np.linalg.norm(span))))
        return self._kept_sizes  # type: ignore[return-value]  # set above

    @property
    def first(self) -> "Snapshot":
        """The obstacles as they are before any has moved; itself where none moves."""
        starts = [float(course.times[0]) for course in self.courses.values()]
        return self.at(min(starts, default=0.0))

    def refuse_moving(self) -> None:
        """Refuse obstacles that move, where they have to stand still.

        Raises
        ------
        InputError
        """
        for i, obstacle in enumerate(self._obstacles):
            if isinstance(obstacle, Moving):
                raise InputError("scene", f"{self.name(i)} moves", obstacle, "the scene at one time: scene.at(t)")

    def at(self, t: Number) -> "Snapshot":
        """Return the obstacles as they are at a time, standing still; itself where none moves. Nothing is sampled."""
        when = checks.number("t", t)
        if not self.moves:
            return self
        there = tuple(standing_at(self._obstacles, when))
        each = zip(there, self._obstacles, self._prepared(), strict=True)
        stored = len(self._stored)
        parts = [part if own is old else _part_of(own, stored) for own, old, part in each]
        return Snapshot(there, parts)

    def _part(self, index: int, progress: Callable[[str, float], object] | None, stored: int) -> Part:
        name = self.name(index)
        told = None if progress is None else partial(progress, name)
        return _part_of(_still(self._obstacles[index]), stored, name, told)

    @property
    def _stored(self) -> dict[int, Obstacle]:
        """What is in the store, as it stands still, by its index: all that is not exact."""
        others = sorted(set(range(len(self))) - set(indices_of(Primitive, self._obstacles)))
        still = {i: _still(self._obstacles[i]) for i in others}
        return {i: own for i, own in still.items() if not isinstance(own, Primitive)}

    def replaced(self, index: int, obstacle: Obstacle, part: Part | None = None) -> "Snapshot":
        """Return a snapshot with another obstacle in the place of one; `part` is what kernels read of it, if known."""
        changed = (*self._obstacles[:index], obstacle, *self._obstacles[index + 1 :])
        if self._parts is None:
            snapshot = Snapshot(changed)
            snapshot.prepare()
            return snapshot
        if part is None:
            stored = 0 if isinstance(obstacle, Primitive) else len(self._stored)  # counted among 10,000 in 2 ms
            part = _part_of(obstacle, stored)
        known, own = self._parts, part
        snapshot = Snapshot(changed, [*known[:index], own, *known[index + 1 :]])
        snapshot._set(_group=self._group_with(index, known[index], own))
        if obstacle.name == self._obstacles[index].name:
            snapshot._set(_named=self._named)
        if not isinstance(obstacle, Moving) and self._moves is False:
            snapshot._set(_moves=False)
        snapshot.prepare()
        return snapshot

    def _group_with(self, index: int, before: Part, now: Part) -> Floats | None:
        """What the kernels read with another obstacle in the place of one; `None` where all of it is made anew."""
        if (
            self._group is None
            or len(self) < t.MANY_OBSTACLES
            or is_worn(packing.scene_parts(self._group)[1], len(self))
        ):
            return None
        group = packing.with_row(without_cells(self._group), index, (before.row, before.store), (now.row, now.store))
        return group if group is not None and refit(*packing.scene_parts(group), index, now.box) else None

    def beside(self, meshes: Sequence[Mesh]) -> "Snapshot":
        """Return a snapshot with these meshes, too. They are not sampled: only their trees are built.

        Without any it is the same snapshot, whose numbers need no copy.
        """
        if not meshes:
            return self
        return Snapshot((*self._obstacles, *meshes), [*self._prepared(), *map(unsampled, meshes)])

    def without(self, names: Collection[str]) -> "Snapshot":
        """Return a snapshot without the obstacles of these names; nothing is sampled again."""
        parts = self._prepared()
        kept = [i for i in range(len(self)) if self.name(i) not in names]
        named = tuple(self._obstacles[i].named(self.name(i)) for i in kept)
        return Snapshot(named, [parts[i] for i in kept])

    def _content(self) -> dict[str, Any]:
        return {"obstacles": self._obstacles}

    def __getstate__(self) -> tuple[tuple[Obstacle, ...], Sequence[Part] | None, bool]:
        return self._obstacles, self._parts, self._group is not None

    def __setstate__(self, state: Any) -> None:
        obstacles, parts, joined = state
        Snapshot.__init__(self, obstacles, parts)
        if joined:
            self.prepare()

    def distance_to(self, index: int, points: Stack) -> tuple[Floats, Floats]:
        """Signed distance (...) of points (..., 3) to one obstacle, and its gradient (..., 3); see `Scene.distance`."""
        return self._query(points, (index,))[:2]

    def _query(
        self, points: Stack, among: Sequence[int] | None = None
    ) -> tuple[Floats, Floats, NDArray[np.int64], Floats]:
        from sinuous.kernels.fields import distances  # noqa: PLC0415

        checked = checks.stack("points", points, (3,))
        flat = checked.reshape(-1, 3).copy()
        values, gradients, which = np.empty(len(flat)), np.empty(flat.shape), np.empty(len(flat), np.int64)
        rows, store = packing.scene_parts(self._kernel_group)
        fields = self._functions
        asked = None if among is None and not fields else among or range(len(rows))
        above = np.empty(len(flat))
        if asked is None:  # with their hierarchy
            distances.many(rows, store, flat, values, above, gradients, which)
        else:
            fields = {i: own for i, own in fields.items() if i in asked}
            others = np.array([i for i in asked if i not in fields], np.int64)
            distances.many(rows[others], store, flat, values, above, gradients, which)
            which = np.where(which >= 0, others[which] if len(others) else -1, -1)
        for i, field in fields.items():
            _ask_field(field, i, flat, values, above, gradients, which)
        lead = checked.shape[:-1]
        return values.reshape(lead), gradients.reshape(*lead, 3), which.reshape(lead), above.reshape(lead)


def _ask_field(
    field: Field, index: int, points: Floats, values: Floats, above: Floats, gradients: Floats, which: NDArray[np.int64]
) -> None:
    """Put in the distance to a field where it is the nearest obstacle."""
    own = evaluate(field.function, points)
    np.minimum(above, field.at_most(points), out=above)
    nearer = own < values
    values[nearer], which[nearer] = own[nearer], index
    step = DIFFERENCE * field.spacing
    for axis, offset in enumerate(step * np.eye(3)):
        if nearer.any():
            beyond, before = (evaluate(field.function, points[nearer] + sign * offset) for sign in (1.0, -1.0))
            gradients[nearer, axis] = (beyond - before) / (2.0 * step)


class NearestPoint(NamedTuple):
    """A least distance, and where it is.

    Attributes
    ----------
    distance : float
        Infinite without obstacles.
    place : int or None
        Index of the point.
    obstacle : str or None
        Name of the obstacle.
    """

    distance: float
    place: int | None
    obstacle: str | None


def least_gap(points: Floats, radii: Floats, scene: Snapshot, above: bool = False) -> NearestPoint:
    """Least of `distance - radius` over points (m, 3) with radii (m,), and where it is: along a body it is quickest.

    `above`: of upper bounds of distances, where only bounds of them are known.
    """
    from sinuous.kernels.fields import distances  # noqa: PLC0415

    fields = scene._functions
    rows, store = packing.scene_parts(scene._kernel_group)
    others = np.array([i for i in range(len(rows)) if i not in fields], np.int64) if fields else np.arange(len(rows))
    plain = np.require(points, np.float64, ["C", "W"]), np.require(radii, np.float64, ["C", "W"])
    listed = rows[others] if fields else rows  # all rows have their hierarchy
    least, place, which = distances.least_gap(listed, store, *plain, above)
    best = least, place, int(others[which]) if which >= 0 else -1
    for i, field in fields.items():
        gaps = (field.at_most(points) if above else evaluate(field.function, points)) - radii
        if gaps.min(initial=math.inf) < best[0]:
            best = float(gaps.min()), int(gaps.argmin()), i
    return NearestPoint(best[0], best[1], scene.name(best[2])) if best[2] >= 0 else NearestPoint(math.inf, None, None)


def room_at(place: Floats, scene: Snapshot) -> NearestPoint:
    """Upper bound of the distance of a place (3,) to the obstacles, and the obstacle that gives it."""
    return least_gap(place[None], np.zeros(1), scene, True)
