"""Obstacles that move: where they are at which time, and what an obstacle is where it has been moved to."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Number, Orientations, Rows, Stack, Vector
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen, text
from sinuous.model.poses import any_rotations
from sinuous.scene.grids import Field
from sinuous.scene.obstacles import Obstacle, Primitive, box_around


class Course(Frozen):
    """Poses at times: linear in position between them, turning evenly the shortest way; at rest before and after.

    Parameters
    ----------
    times : ndarray (T,)
        Increasing, at least one.
    positions : ndarray (T, 3)
    rotations : ndarray (T, 3, 3) or None
        `None`: it never turns.
    """

    times: Floats
    positions: Floats
    rotations: Floats | None

    def __init__(self, times: Floats, positions: Floats, rotations: Floats | None) -> None:
        self._set(times=times, positions=positions, rotations=rotations)

    def poses(self, when: Floats) -> tuple[Floats, Floats]:
        """Positions (m, 3) and rotations (m, 3, 3) at times (m,)."""
        from scipy.spatial.transform import Rotation  # noqa: PLC0415

        turned = np.eye(3)[None] if self.rotations is None else self.rotations
        if len(self.times) < 2:
            return np.repeat(self.positions, len(when), axis=0), np.repeat(turned[:1], len(when), axis=0)
        step = np.clip(np.searchsorted(self.times, when, side="right") - 1, 0, len(self.times) - 2)
        begin, end = self.times[step], self.times[step + 1]
        share = np.clip((when - begin) / (end - begin), 0.0, 1.0)[:, None]
        places = (1.0 - share) * self.positions[step] + share * self.positions[step + 1]
        if self.rotations is None:
            return places, np.repeat(turned, len(when), axis=0)
        return places, turned[step] @ Rotation.from_rotvec(share * self.turns[step]).as_matrix()

    @cached_property
    def turns(self) -> Floats:
        """Rotation vectors (T - 1, 3) between neighbouring poses, rad, in the frame of the first of the two."""
        from scipy.spatial.transform import Rotation  # noqa: PLC0415

        if self.rotations is None or len(self.times) < 2:
            return np.zeros((max(0, len(self.times) - 1), 3))
        return Rotation.from_matrix(np.swapaxes(self.rotations[:-1], 1, 2) @ self.rotations[1:]).as_rotvec()


def moved(obstacle: Obstacle, pose: Floats) -> Obstacle:
    """Return an obstacle of the same name, each place x of which lies at `pose` (4, 4) times x."""
    own, turn = vars(obstacle), pose[:3, :3]
    there: dict[str, Any] = {key: checks.closed(turn @ own[key] + pose[:3, 3]) for key in PLACES if key in own}
    there |= {key: turn @ own[key] for key in AXES if key in own}
    if isinstance(obstacle, Field):
        there["function"] = Elsewhere(obstacle.function, pose)
    return obstacle._changed(there) if isinstance(obstacle, Primitive) else obstacle.placed(pose, **there)


PLACES = ("center", "start", "end", "point", "origin", "low", "high")
"""Attributes of obstacles that are places in the world. Only these and `AXES` move with an obstacle: a new kind uses
these names, or adds its own."""

AXES = ("rotation", "normal", "axes")
"""Attributes of obstacles that are directions in the world, as rows or columns."""


@dataclass(frozen=True, eq=False)
class Elsewhere:
    """A signed distance, moved by a pose.

    Attributes
    ----------
    function : callable
        From points (m, 3) to distances (m,).
    pose : ndarray (4, 4)
    """

    function: Callable[[Floats], Any]
    pose: Floats

    def __call__(self, points: Floats) -> Any:
        """Distances (m,) of points (m, 3) in the world."""
        local = (np.asarray(points) - self.pose[:3, 3]) @ self.pose[:3, :3]
        return self.function(local)


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Moving(Obstacle):
    """An obstacle that is elsewhere at other times.

    A pose says where the frame is in which the obstacle is described: a place x of it lies at `rotation @ x + position`
    then. An obstacle that is described about the origin is where its positions say. Between two times the position is
    linear and the rotation even, the shortest way. Before the first time and after the last one it stands still.

    Parameters
    ----------
    obstacle : Obstacle
        Of any kind, standing still.
    times : array_like (T,)
        Increasing, at least one; in the unit of the times of motions.
    positions : array_like (T, 3), optional
        By default the origin: it turns where it is described.
    rotations : array_like (T, 3, 3) or (T, 4), or Rotation of SciPy, optional
        Matrices or quaternions wxyz; by default it does not turn.
    xyzw : array_like (T, 4), optional
        Quaternions in the order of SciPy and ROS, instead of `rotations`.
    poses : array_like (T, 4, 4), optional
        Positions and rotations as matrices, instead of both.

    Attributes
    ----------
    rotations : ndarray (T, 3, 3) or None

    Raises
    ------
    InputError
        When an argument is not what it should be, there is no pose at all, or the obstacle moves itself.
    """

    obstacle: Obstacle
    times: Floats
    positions: Floats
    rotations: Floats | None

    def __init__(
        self,
        obstacle: Obstacle,
        times: Vector,
        positions: Rows | None = None,
        rotations: Orientations | None = None,
        *,
        xyzw: Rows | None = None,
        poses: Stack | None = None,
    ) -> None:
        if not isinstance(obstacle, Obstacle) or isinstance(obstacle, Moving):
            raise InputError("obstacle", "", obstacle, "an obstacle that stands still")
        when = checks.increasing("times", times, None)
        if not len(when):
            raise InputError("times", "", times, "at least one time")
        self._follow(obstacle, Course(when, *_poses(len(when), positions, rotations, xyzw, poses)))

    @classmethod
    def along(cls, obstacle: Obstacle, course: Course) -> Self:
        """Make an obstacle that shares its course with others."""
        moving = object.__new__(cls)
        moving._follow(obstacle, course)
        return moving

    def _follow(self, obstacle: Obstacle, course: Course) -> None:
        poses = {"times": course.times, "positions": course.positions, "rotations": course.rotations}
        self._set(name=obstacle.name, obstacle=obstacle, **poses, _course=course)

    @property
    def course(self) -> Course:
        """Its poses over time."""
        return vars(self)["_course"]

    @property
    def kind(self) -> str:
        """What problem files call the obstacle."""
        return self.obstacle.kind

    def named(self, name: str | None) -> Self:
        """See `Obstacle.named`."""
        return self.along(self.obstacle.named(name), self.course)

    def pose(self, t: Number | Stack) -> Floats:
        """Poses (..., 4, 4) of its frame at times (...)."""
        when = checks.stack("t", t, ())
        result = np.tile(np.eye(4), (when.size, 1, 1))
        result[:, :3, 3], result[:, :3, :3] = self.course.poses(when.reshape(-1))
        return result.reshape(*when.shape, 4, 4)

    def at(self, t: Number) -> Obstacle:
        """Return the obstacle as it is at a time, standing still."""
        return moved(self.obstacle, self.pose(checks.number("t", t)))

    @property
    def _box(self) -> Floats | None:
        """Around the obstacle at all of its times, and so all the way, but where it turns far from where it is."""
        boxes = [self.at(t)._box for t in self.times.tolist()]
        return None if boxes[0] is None else box_around(np.concatenate([box for box in boxes if box is not None]), 0.0)

    def _shown(self) -> Iterator[str]:
        yield text(self.obstacle)
        yield f"times={text(self.times)}"


def standing_at(obstacles: Iterable[Obstacle], t: float | None = None) -> list[Obstacle]:
    """Return obstacles as they are at a time, standing still; by default where the course of each begins."""
    return [own.at(float(own.times[0]) if t is None else t) if isinstance(own, Moving) else own for own in obstacles]


def _poses(
    count: int, positions: Rows | None, rotations: Orientations | None, xyzw: Rows | None, poses: Stack | None
) -> tuple[Floats, Floats | None]:
    """Check poses of so many times; return positions (T, 3) and rotations (T, 3, 3)."""
    given = {"positions": positions, "rotations": rotations, "xyzw": xyzw}
    beside = [key for key, value in given.items() if value is not None]
    if poses is not None:
        if beside:
            raise InputError("poses", f"cannot be combined with {beside[0]}", poses, "one of both")
        return _of_matrices(count, poses)
    if not beside:
        raise InputError("positions", "missing", None, "positions, rotations or poses")
    places = np.zeros((count, 3)) if positions is None else checks.rows("positions", positions, 3)
    turned = any_rotations(rotations, xyzw)
    for key, rows in (("positions", places), (beside[-1], turned)):
        if rows is not None and len(rows) != count:
            raise InputError(key, "", len(rows), f"as many as times: {count}")
    return checks.closed(places), turned


def _of_matrices(count: int, poses: Stack) -> tuple[Floats, Floats | None]:
    matrices = checks.array("poses", poses, (count, 4, 4))
    if not (matrices[:, 3] == (0.0, 0.0, 0.0, 1.0)).all():
        raise InputError("poses", "a last row is wrong", poses, "[0, 0, 0, 1] as last row of each")
    turned = any_rotations(matrices[:, :3, :3], None, "poses")
    still = turned is None or bool((turned == np.eye(3)).all())
    return checks.closed(matrices[:, :3, 3].copy()), None if still else turned
