"""What an obstacle is, and where it is read from; and the exact ones, `PRIMITIVES`.

With `inside=True` the body must stay within.
"""

import math
import os
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Number, Orientation, Truth, Vector
from sinuous.base.checks import Floats, readable
from sinuous.base.documents import plain
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen
from sinuous.kernels.packing import primitive_row, primitive_rows
from sinuous.kernels.tables import (
    AXES,
    BOX,
    CENTER,
    CYLINDER,
    HALF_EXTENTS,
    HALF_SPACE,
    MANY_OBSTACLES,
    ROUNDING_RADIUS,
    SPHERE,
)
from sinuous.model.poses import any_rotation, least_rotation, least_rotations, pose


def check_file(file: Path, kinds: Sequence[str]) -> None:
    """Refuse a file that is not there or cannot be read, or whose name does not end in one of `kinds`."""
    if file.suffix.lower() not in kinds:
        raise InputError("file", "", str(file), "a name that ends in " + ", ".join(kinds))
    with readable(file), file.open("rb"):
        pass


IDENTITY = checks.closed(np.eye(3))


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Placement(Frozen):
    """The map p -> rotation * scale * p + position from a file to the world.

    Parameters
    ----------
    scale : float
        Greater than 0.
    position : array_like (3,), optional
    rotation : array_like (3, 3) or (4,), or Rotation of SciPy, optional
        A matrix or a quaternion wxyz.
    xyzw : array_like (4,), optional
        A quaternion in the order of SciPy and ROS, instead of `rotation`.
    """

    scale: float
    pose: Floats

    def __init__(
        self,
        scale: Number,
        position: Vector | None = None,
        rotation: Orientation | None = None,
        xyzw: Vector | None = None,
    ) -> None:
        self._set(scale=checks.number("scale", scale, above=0.0), pose=pose(position, rotation=rotation, xyzw=xyzw))

    @property
    def arguments(self) -> dict[str, Any]:
        """What makes an equal placement."""
        position, rotation = self.pose[:3, 3], self.pose[:3, :3]
        turn = None if np.array_equal(rotation, IDENTITY) else rotation
        return {"scale": self.scale, "position": position if position.any() else None, "rotation": turn}

    def apply(self, points: Floats) -> Floats:
        """Map points (m, 3); what is not finite stays so."""
        with np.errstate(invalid="ignore", over="ignore"):
            moved: Floats = (self.scale * points) @ self.pose[:3, :3].T + self.pose[:3, 3]
        return moved


class Origin(NamedTuple):
    """Where an obstacle was read from.

    Attributes
    ----------
    file : Path
        Absolute.
    arguments : dict
        How it was read: what stands beside the file in a problem file.
    parts : int
        Into how many obstacles, one after the other in their scene, it was divided.
    """

    file: Path
    arguments: dict[str, Any]
    parts: int = 1

    @classmethod
    def of(cls, file: str | Path, **arguments: Any) -> "Origin":
        """Remember a file and how it was read; what says nothing is left out."""
        return cls(Path(file).absolute(), {key: value for key, value in arguments.items() if value is not None})

    def entry(self, folder: Path) -> dict[str, Any]:
        """Return what a problem file in this folder says."""
        try:
            name = Path(os.path.relpath(self.file, folder.absolute())).as_posix()
        except ValueError:  # on another drive
            name = str(self.file)
        own = {key: plain(value) for key, value in self.arguments.items()}
        return {"file": name, **{key: value for key, value in own.items() if value is not None}}


def box_around(points: Floats, reach: Floats | float) -> Floats:
    """Opposite corners (2, 3) of the box around balls or boxes with these middles (m, 3)."""
    return np.stack([(points - reach).min(axis=0), (points + reach).max(axis=0)])


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Obstacle(Frozen, ABC):
    """Something the body must not touch."""

    name: str | None

    inside = False
    """Whether the body must stay within it."""

    is_function: ClassVar[bool] = False
    """Whether code says where it is, so that no file can."""

    has_edges: ClassVar[bool] = True
    """Whether its surface may have edges, which routes bend around."""

    @property
    def source(self) -> Origin | None:
        """The file that it was read from, and how; `None` when it is from none."""
        return vars(self).get("_source")

    @property
    def kind(self) -> str:
        """What problem files call such an obstacle: `half_space`."""
        return "".join(f"_{c.lower()}" if c.isupper() else c for c in type(self).__name__).lstrip("_")

    @property
    def place(self) -> "tuple[Obstacle, Floats] | None":
        """The obstacle before it was moved, and the pose (4, 4) that moved it; `None` for one that never was.

        What was computed of the former serves for this one, too.
        """
        return vars(self).get("_place")

    def placed(self, pose: Floats, **changes: Any) -> Self:
        """Return the same obstacle, moved by a pose (4, 4), with these attributes changed; see `moving.moved`."""
        root, before = self.place or (self, np.eye(4))
        twin = object.__new__(type(self))
        twin._set(**vars(self))
        twin._set(**changes, _source=None, _place=(root, pose @ before))
        return twin

    def _in_place(self, points: Floats) -> Floats:
        """Points (m, 3) of the obstacle as it was before it was moved, where they are now; read-only."""
        if self.place is None:
            return points
        _, pose = self.place
        return checks.closed(points @ pose[:3, :3].T + pose[:3, 3])

    def named(self, name: str | None) -> Self:
        """Return the same obstacle with another name, or None for none."""
        twin = object.__new__(type(self))
        twin._set(**vars(self))
        twin._keep(name)
        return twin

    @property
    @abstractmethod
    def _box(self) -> Floats | None:
        """Opposite corners (2, 3) of a box around it, along the axes of the world; `None`: it has no end."""

    def _keep(self, name: str | None, **values: Any) -> None:
        self._set(name=None if name is None else checks.text("name", name), **values)


class Frame(NamedTuple):
    """A place in the world and axes there.

    Attributes
    ----------
    center : ndarray (3,)
    rotation : ndarray (3, 3)
        Its columns are the axes in the world.
    half : ndarray (3,)
        Half extents along the axes, without what is rounded: with that, a box that holds the obstacle.
    rounding : float
        By how much it extends beyond them in every direction.
    """

    center: Floats
    rotation: Floats
    half: Floats
    rounding: float = 0.0


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Primitive(Obstacle):
    """An obstacle that a few numbers say exactly. It is convex: proofs take a tangent of its distance as a bound."""

    _code: ClassVar[int]
    """Its kind in the tables of the kernels."""

    @property
    @abstractmethod
    def frame(self) -> Frame:
        """Where it is, how it is turned, and how far it extends along its own axes."""

    @staticmethod
    def _half_sizes(axes: Floats, half: Floats) -> Floats:
        """Half sizes (m, 3) of boxes about some of this kind that are not rounded: with these axes and half extents."""
        sizes: Floats = (np.abs(axes) @ half[:, :, None])[:, :, 0]
        return sizes

    @property
    def _box(self) -> Floats | None:
        center, rotation, half, rounding = self.frame
        return box_around(center[None], self._half_sizes(rotation[None], half[None])[0] + rounding)

    @property
    def row(self) -> Floats:
        """One row of the table that the kernels read; layout of `sinuous.kernels.tables`."""
        return primitive_row(self._code, self.inside, *self.frame)


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Sphere(Primitive):
    """A ball.

    Parameters
    ----------
    center : array_like (3,)
    radius : float
    inside : bool
        The body must stay within it.
    name : str, optional
    """

    _code = SPHERE
    has_edges = False

    center: Floats
    radius: float
    inside: bool

    def __init__(self, center: Vector, radius: Number, inside: Truth = False, name: str | None = None) -> None:
        self._keep(
            name,
            center=checks.vector("center", center),
            radius=checks.number("radius", radius, above=0.0),
            inside=checks.truth("inside", inside),
        )

    @property
    def frame(self) -> Frame:
        """See `Primitive.frame`."""
        return Frame(self.center, IDENTITY, np.zeros(3), self.radius)


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Box(Primitive):
    """A box with flat faces.

    Parameters
    ----------
    center : array_like (3,)
    size : array_like (3,)
        Full extents along its own axes, each greater than 0.
    rotation : array_like (3, 3) or (4,), or Rotation of SciPy, optional
        Its axes in the world, a matrix or a quaternion wxyz.
    inside : bool
        The body must stay within it.
    name : str, optional
    xyzw : array_like (4,), optional
        A quaternion in the order of SciPy and ROS, instead of `rotation`.
    """

    _code = BOX

    center: Floats
    size: Floats
    rotation: Floats
    inside: bool

    def __init__(
        self,
        center: Vector,
        size: Vector,
        rotation: Orientation | None = None,
        inside: Truth = False,
        name: str | None = None,
        *,
        xyzw: Vector | None = None,
    ) -> None:
        extents, turned = checks.vector("size", size), any_rotation(rotation, xyzw)
        if not (extents > 0.0).all():
            raise InputError("size", "has no volume", extents.tolist(), "three extents greater than 0")
        self._keep(
            name,
            center=checks.vector("center", center),
            size=extents,
            rotation=IDENTITY if turned is None else turned,
            inside=checks.truth("inside", inside),
        )

    @property
    def frame(self) -> Frame:
        """See `Primitive.frame`."""
        return Frame(self.center, self.rotation, 0.5 * self.size)


def _along(start: Floats, end: Floats, across: float, rounding: float = 0.0) -> Frame:
    """Frame of what lies about a line: z along it, `across` the half extent at right angles to it."""
    span = end - start
    length = math.hypot(*span.tolist())
    rotation = IDENTITY if length == 0.0 else least_rotation(checks.direction("end", span))
    return Frame(0.5 * (start + end), rotation, np.array([across, across, 0.5 * length]), rounding)


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Capsule(Primitive):
    """All points within `radius` of the line from `start` to `end`.

    Parameters
    ----------
    start, end : array_like (3,)
    radius : float
    name : str, optional
    """

    _code = BOX  # of no width, rounded
    has_edges = False

    start: Floats
    end: Floats
    radius: float

    def __init__(self, start: Vector, end: Vector, radius: Number, name: str | None = None) -> None:
        self._keep(
            name,
            start=checks.vector("start", start),
            end=checks.vector("end", end),
            radius=checks.number("radius", radius, above=0.0),
        )

    @property
    def frame(self) -> Frame:
        """See `Primitive.frame`."""
        return _along(self.start, self.end, 0.0, self.radius)


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Cylinder(Primitive):
    """A cylinder with flat ends.

    Parameters
    ----------
    start, end : array_like (3,)
        Centers of the two ends; they must differ.
    radius : float
    inside : bool
        The body must stay within it.
    name : str, optional
    """

    _code = CYLINDER

    start: Floats
    end: Floats
    radius: float
    inside: bool

    def __init__(
        self, start: Vector, end: Vector, radius: Number, inside: Truth = False, name: str | None = None
    ) -> None:
        first, last = checks.vector("start", start), checks.vector("end", end)
        if np.array_equal(first, last):
            raise InputError("end", "is where the cylinder starts", last.tolist(), "another point than start")
        self._keep(
            name,
            start=first,
            end=last,
            radius=checks.number("radius", radius, above=0.0),
            inside=checks.truth("inside", inside),
        )

    @property
    def frame(self) -> Frame:
        """See `Primitive.frame`."""
        return _along(self.start, self.end, self.radius)

    @staticmethod
    def _half_sizes(axes: Floats, half: Floats) -> Floats:
        disks = half[:, :1] * np.hypot(axes[:, :, 0], axes[:, :, 1])
        sizes: Floats = disks + half[:, 2:] * np.abs(axes[:, :, 2])
        return sizes


@dataclass(frozen=True, init=False, eq=False, repr=False)
class HalfSpace(Primitive):
    """Everything behind a plane; free is the side that `normal` points to.

    Parameters
    ----------
    point : array_like (3,)
        A point of the plane.
    normal : array_like (3,)
        Any length but zero.
    name : str, optional
    """

    _code = HALF_SPACE

    point: Floats
    normal: Floats

    def __init__(self, point: Vector, normal: Vector, name: str | None = None) -> None:
        self._keep(name, point=checks.vector("point", point), normal=checks.direction("normal", normal))

    @property
    def frame(self) -> Frame:
        """See `Primitive.frame`."""
        return Frame(self.point, least_rotation(self.normal), np.zeros(3))

    @property
    def _box(self) -> None:
        return None


PRIMITIVES: dict[str, type[Primitive]] = {
    "sphere": Sphere,
    "box": Box,
    "capsule": Capsule,
    "cylinder": Cylinder,
    "half_space": HalfSpace,
}
"""Exact obstacles by what problem files call them, see `Obstacle.kind`; where else a kind stands: CONTRIBUTING.md."""


def indices_of(kinds: type | tuple[type, ...], obstacles: Sequence[Obstacle]) -> list[int]:
    """Indices of the obstacles that are of these kinds; `isinstance` would ask each of them what it derives from."""
    own = [type(obstacle) for obstacle in obstacles]
    wanted = {kind for kind in set(own) if issubclass(kind, kinds)}
    return [i for i, kind in enumerate(own) if kind in wanted]


def rows_of(obstacles: Sequence[Primitive]) -> Floats:
    """Rows (m, 33) of many exact obstacles, quicker than one after the other."""
    (centers, half), rounding = np.empty((2, len(obstacles), 3)), np.empty(len(obstacles))
    turns = np.empty((len(obstacles), 3, 3))
    lines, boxes = indices_of((Capsule, Cylinder), obstacles), indices_of(Box, obstacles)
    if lines:
        listed: list[Any] = [obstacles[i] for i in lines]
        starts, ends = np.array([own.start for own in listed]), np.array([own.end for own in listed])
        radii, round_ends = np.array([own.radius for own in listed]), np.array([own._code == BOX for own in listed])
        spans = ends - starts
        lengths = np.sqrt((spans**2).sum(axis=1))
        ways = (
            np.where((lengths > 0.0)[:, None], spans, (0.0, 0.0, 1.0)) / np.where(lengths > 0.0, lengths, 1.0)[:, None]
        )
        across = np.where(round_ends, 0.0, radii)
        centers[lines], turns[lines] = 0.5 * (starts + ends), least_rotations(ways)
        half[lines] = np.stack([across, across, 0.5 * lengths], axis=1)
        rounding[lines] = np.where(round_ends, radii, 0.0)
    if boxes:
        listed = [obstacles[i] for i in boxes]
        centers[boxes], turns[boxes] = [own.center for own in listed], [own.rotation for own in listed]
        half[boxes], rounding[boxes] = 0.5 * np.array([own.size for own in listed]), 0.0
    for i in sorted(set(range(len(obstacles))) - set(lines) - set(boxes)):  # of all other kinds, slower
        centers[i], turns[i], half[i], rounding[i] = obstacles[i].frame
    codes, inside = np.array([own._code for own in obstacles]), np.array([own.inside for own in obstacles])
    return primitive_rows(codes, inside, centers, turns, half, rounding)


def boxes_of(obstacles: Sequence[Obstacle]) -> dict[int, Floats]:
    """Opposite corners (2, 3) of boxes about obstacles that end somewhere, by their number; of many together."""
    exact = [i for i in indices_of(Primitive, obstacles) if type(obstacles[i])._box is Primitive._box]
    if len(exact) < MANY_OBSTACLES:
        return {i: box for i, own in enumerate(obstacles) if (box := own._box) is not None}
    primitives: list[Any] = [obstacles[i] for i in exact]
    rows = rows_of(primitives)
    axes, half = rows[:, AXES : AXES + 9].reshape(-1, 3, 3), rows[:, HALF_EXTENTS : HALF_EXTENTS + 3]
    extents = np.repeat(rows[:, ROUNDING_RADIUS, None], 3, axis=1)
    kinds: set[Any] = set(map(type, primitives))
    for kind in kinds:
        own = indices_of(kind, primitives)
        extents[own] += kind._half_sizes(axes[own], half[own])
    centers = rows[:, CENTER : CENTER + 3]
    boxes = dict(zip(exact, np.stack([centers - extents, centers + extents], axis=1), strict=True))
    others = set(range(len(obstacles))) - set(exact)
    return dict(sorted({**boxes, **{i: box for i in others if (box := obstacles[i]._box) is not None}}.items()))
