"""Backbones and routes as curves among obstacles: drawn tight, compared, and named by what they pass on which side.

Two are alike where one is known to deform into the other and stay clear, see `sinuous.kernels.freespace.homotopy`.
"""

import math
from collections.abc import Sequence
from operator import itemgetter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.answer.route_class import SIDES, Passing, RouteClass
from sinuous.base.checks import Floats
from sinuous.kernels.freespace import homotopy
from sinuous.model.robot import Robot
from sinuous.scene.mesh import Mesh
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.attempts import Deadline
from sinuous.solver.polylines import lengths_along, points_at

FEWEST = 64
"""Least number of points of a curve."""

MOST = 512
"""Largest number of points of a curve."""

A_RADIUS = 1.5
"""Points of a curve for each radius of the body in the length of the robot."""

CLEAR = 0.85
"""Distance that a curve keeps from the obstacles while it is drawn tight, in radii of the body."""

SPACED = 1.2
"""Least distance that it keeps, in distances between its points."""

ALIKE = 0.5
"""Distance from the obstacles that the lines between two curves that are alike keep, in units of that distance."""

HALFWAY = 0.7
"""Distance from the obstacles that a curve halfway between two others keeps, in units of that distance."""

DEPTH = 2
"""How often a deformation may be divided: it leads over at most 2 ** DEPTH - 1 curves between both."""


class Seen(NamedTuple):
    """What lines of sight meet.

    Attributes
    ----------
    lengths : ndarray (m,)
        How far each is clear.
    which : ndarray (m,)
        Index of the obstacle that ends it; -1 where nothing does.
    """

    lengths: Floats
    which: NDArray[np.int64]


class RouteCurves:
    """The curves of one robot in one scene. Not to be shared between threads.

    Parameters
    ----------
    robot : Robot
    scene : Snapshot
    deadline : callable
        See `Deadline`.

    Attributes
    ----------
    scene : Snapshot
    mount : float
        Length from the base that obstacles do not concern.
    keep : float
        Distance from the obstacles that a curve keeps while it is drawn tight, in the length unit.
    """

    def __init__(self, robot: Robot, scene: Snapshot, deadline: Deadline = lambda: math.inf) -> None:
        self._robot, self._deadline = robot, deadline
        self.scene, self.mount = scene, robot.mount
        radius, longest = min(robot.needed_radii), sum(segment.length[1] for segment in robot.rows)
        wanted = A_RADIUS * longest / radius if radius > 0.0 else MOST
        self._points = int(min(MOST, max(FEWEST, math.ceil(wanted))))
        self.keep = max(CLEAR * radius, SPACED * longest / self._points)
        self._workspace = np.empty(homotopy.homotopy_workspace_size(self._points))

    def of(self, q: Floats) -> Floats:
        """Return the backbone (N, 3) of a configuration (n, 3) beyond the mount, drawn tight."""
        robot = self._robot
        samples = max(2, math.ceil(self._points / len(robot)))
        along = np.repeat(q[:, 2] / samples, samples)
        return self._tight(robot.backbone(q, samples), np.concatenate([[0.0], np.cumsum(along)]))

    def along(self, route: Floats) -> Floats:
        """Return a route (k, 3) beyond the mount, drawn tight: (N, 3)."""
        return self._tight(route, lengths_along(route))

    def _tight(self, points: Floats, along: Floats) -> Floats:
        """Draw a line tight whose points (k, 3) lie at these lengths (k,)."""
        wanted = np.linspace(min(self.mount, along[-1]), along[-1], self._points)
        curve = points_at(points, along, wanted)
        homotopy.draw_tight(self._group, curve, self.keep, self.seconds(), self._workspace)
        return curve

    def alike(self, a: Floats, b: Floats, depth: int = DEPTH) -> bool:
        """Whether a deformation of one curve (N, 3) into the other is found that stays clear."""
        if homotopy.deforms(self._group, a, b, ALIKE * self.keep, self.seconds(), self._workspace):
            return True
        middle = np.empty_like(a)
        if depth == 0 or not homotopy.halfway(
            self._group, a, b, HALFWAY * self.keep, self.seconds(), self._workspace, middle
        ):
            return False
        return self.alike(a, middle, depth - 1) and self.alike(middle, b, depth - 1)

    def alike_one(self, curve: Floats, others: Sequence[Floats]) -> int | None:
        """Return which of other curves this curve (N, 3) is alike, the nearest of them; `None` where there is none."""
        apart = [float(np.abs(curve - other).max()) for other in others]
        return next((i for i in np.argsort(apart).tolist() if self.alike(curve, others[i])), None)

    def see(self, starts: Floats, ends: Floats, keep: float, seconds: float = math.inf) -> Seen:
        """Look from points (m, 3) to points (m, 3), along lines that keep a distance from the obstacles.

        Lines for which the seconds do not suffice end early.
        """
        lengths, which = np.empty(len(starts)), np.empty(len(starts), np.int64)
        homotopy.trace_lines(self._group, starts.copy(), ends.copy(), keep, seconds, self._workspace, lengths, which)
        return Seen(lengths, which)

    def between(self, a: Floats, b: Floats) -> NDArray[np.int64]:
        """Return what is first met from points of a curve (N, 3) to their counterparts on another (N,); -1: nothing."""
        return self.see(a, b, ALIKE * self.keep).which

    def load(self) -> None:
        """Compile the entries, or load them from the cache."""
        line = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), self._points)
        homotopy.draw_tight(self._group, line, self.keep, 0.0, self._workspace)
        homotopy.deforms(self._group, line, line, self.keep, 0.0, self._workspace)
        homotopy.halfway(self._group, line, line, self.keep, 0.0, self._workspace, line.copy())
        self.see(line[:1], line[:1], self.keep)
        self.scene.beside([Mesh(np.eye(3), [[0, 1, 2]])]).distance(np.zeros(3))

    @property
    def _group(self) -> Floats:
        return self.scene._kernel_group

    def seconds(self) -> float:
        """Return how many seconds are left."""
        return max(0.0, self._deadline())


def across(axes: Floats) -> Floats:
    """Two unit vectors (..., 2, 3) across unit vectors (..., 3), and across each other."""
    return np.asarray(np.linalg.svd(axes[..., None, :])[2][..., 1:, :])


LOOKS = 16
"""Directions across a curve in which an obstacle is looked for."""

SURROUNDED = 0.5
"""Share of these directions in which an obstacle is met, above which the curve leads through that obstacle."""


def group_alike(curves: RouteCurves, own: Sequence[Floats]) -> list[int]:
    """Return the class of each of m curves (N, 3): the number of the first curve of its class.

    Each curve is compared only with the first curve of each class, so that no two of these are alike. The result
    depends on the order: around a ball each curve may be alike its neighbours, and the last one not alike the first.
    """
    firsts: list[int] = []
    found = []
    for i, curve in enumerate(own):
        at = curves.alike_one(curve, [own[j] for j in firsts])
        if at is None:
            at = len(firsts)
            firsts.append(i)
        found.append(firsts[at])
    return found


def name_classes(curves: RouteCurves, firsts: Sequence[Floats]) -> list[RouteClass]:
    """Number classes in this order; say which obstacles the first curve (N, 3) of each passes on a side of its own."""
    named = []
    for i, own in enumerate(firsts):
        others = [other for j, other in enumerate(firsts) if j != i]
        found = [_passing(curves, own, *each) for each in sorted(_aside(curves, own, others).items())]
        named.append(RouteClass(i + 1, tuple(passing for _, passing in sorted(found, key=itemgetter(0)))))
    return named


def _aside(curves: RouteCurves, own: Floats, others: Sequence[Floats]) -> dict[int, Floats]:
    """Return the obstacles between a curve (N, 3) and others, each with the sum of unit vectors from the others."""
    found: dict[int, Floats] = {}
    for other in others:
        for which in (curves.between(own, other), curves.between(other, own)):  # what each of them sees first
            for obstacle in set(which.tolist()) - {-1}:
                across = (own - other)[which == obstacle]
                units = across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-300)
                found[obstacle] = found.get(obstacle, np.zeros(3)) + units.sum(axis=0)
    return found


def _passing(curves: RouteCurves, own: Floats, which: int, across: Floats) -> tuple[int, Passing]:
    """Where a curve (N, 3) passes an obstacle, by number of the point, and on which side.

    Of the axes of the world that is the one along which the curve is both away from the obstacle and from the others.
    """
    distances, gradients = curves.scene.distance_to(which, own)
    nearest = int(distances.argmin())
    away = gradients[nearest]
    both = away * across
    axis = int((both if both.max() > 0.0 else np.abs(away)).argmax())
    side = None if _surrounds(curves, own, nearest, which) else SIDES[2 * axis + int(away[axis] > 0.0)]
    x, y, z = own[nearest].tolist()
    return nearest, Passing(curves.scene.name(which), side, (x, y, z))


def _surrounds(curves: RouteCurves, own: Floats, at: int, which: int) -> bool:
    """Whether an obstacle is met in most directions across a curve (N, 3), from one of its points."""
    place, tangent = own[at], np.gradient(own, axis=0)[at]
    angles = 2.0 * np.pi / LOOKS * np.arange(LOOKS)
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=1) @ across(tangent)
    reach = np.linalg.norm(np.diff(own, axis=0), axis=1).sum()
    starts = np.repeat(place[None], LOOKS, axis=0)
    met = curves.see(starts, place + reach * rays, 1e-3 * curves.keep).which == which
    return bool(met.mean() > SURROUNDED)
