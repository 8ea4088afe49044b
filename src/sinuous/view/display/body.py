"""The surface of a robot as rings of vertices, for one configuration or many at once.

Every part is a row of rings about frames: the body about those along the backbone; what the robot stands on, the sleeve
over its mount and the tool about frames that follow from them.
"""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels import packing
from sinuous.model.poses import least_rotation
from sinuous.model.robot import Robot
from sinuous.view.display.obstacles import Faces, circle, ring_faces

ALONG = 12
"""Bands along a segment; each segment of a robot of many has fewer."""

MOST_ALONG = 240
"""Bands along the whole body, but for robots with more segments than that, which have one a segment."""

CAP = 6
"""Bands of the half balls in which the body ends."""

FLANGE, PLATE = 1.6, 0.5
"""Radius and thickness of the plate that the robot stands on, in radii of its first segment."""

SLEEVE = 1.25
"""Radius of the sleeve over the mount, in radii of the first segment."""

TOOL = 0.3
"""Radius of the tool, which has no body, in radii of the last segment."""


class ColouredPart(NamedTuple):
    """A part of the surface that has one colour.

    Attributes
    ----------
    segment : int or None
        The segment that it belongs to, 0 = first; None for what is no body.
    rings : slice
        Its rings.
    faces : ndarray (f, 4)
        They count its own vertices.
    """

    segment: int | None
    rings: slice
    faces: Faces


class Ring(NamedTuple):
    """A ring: the frame that it lies about, its radius, and how far ahead of the frame it is, along the z axis."""

    frame: int
    radius: float
    ahead: float


class BodySurface:
    """How the surface of a robot follows from its configuration.

    Parameters
    ----------
    robot : Robot
    least_radius : float
        The body is drawn no thinner than this.
    around : int
        Vertices of a ring.
    pieces : int
        Parts of each segment, which may have colours of their own.
    along : int, optional
        Bands along each segment; by default enough for a smooth picture.
    fittings : bool
        Whether the flange, the sleeve over the mount and the tool are drawn.
    share : float
        How much of its radius is drawn.

    Attributes
    ----------
    parts : list of ColouredPart
        From base to tip, then what is no body.
    per_segment : int
        Bands along each segment.
    """

    def __init__(
        self,
        robot: Robot,
        least_radius: float,
        around: int,
        *,
        pieces: int = 1,
        along: int | None = None,
        fittings: bool = True,
        share: float = 1.0,
    ) -> None:
        wanted = max(1, min(ALONG, MOST_ALONG // len(robot))) if along is None else along
        steps = max(1, -(-wanted // pieces))
        self.robot, self.per_segment, self.parts = robot, pieces * steps, list[ColouredPart]()
        self._around, self._circle, self._rings = around, circle(around), list[Ring]()
        radii = [share * max(radius, least_radius) for radius in robot.radii]
        self._last = len(robot) * self.per_segment
        self._mounted = _segments_within(robot, robot.mount) if fittings else 0
        self._reach = float(np.linalg.norm(robot.tool[:3, 3])) if fittings else 0.0
        for k in range(len(robot)):
            for first in range(k * self.per_segment, (k + 1) * self.per_segment, steps):
                self._add_piece(k, radii[k], first, first + steps)
        if fittings:
            self._add_fittings(radii[0], radii[-1])
        self._frame, self._radius, self._ahead = (np.array(column) for column in zip(*self._rings, strict=True))

    def _add_piece(self, segment: int, radius: float, first: int, last: int) -> None:
        """Add a tube about these frames; the body ends in half balls."""
        rings = [Ring(i, radius, 0.0) for i in range(first, last + 1)]
        angles = [0.5 * math.pi * i / CAP for i in range(1, CAP + 1)]
        if first == 0:
            rings = [Ring(0, radius * math.cos(a), -radius * math.sin(a)) for a in reversed(angles)] + rings
        if last == self._last:
            rings += [Ring(last, radius * math.cos(a), radius * math.sin(a)) for a in angles]
        self._add(segment, rings)

    def _add_fittings(self, first: float, last: float) -> None:
        """Add the flange behind the half ball of the base, the sleeve and the tool; two equal rings make an edge."""
        behind, before = Ring(0, FLANGE * first, -(1.0 + PLATE) * first), Ring(0, FLANGE * first, -first)
        ends = behind._replace(radius=0.0), before._replace(radius=0.0)
        self._add(None, [ends[0], behind, behind, before, before, ends[1]])
        frame = self._last + 1
        if self._mounted:
            sleeve = [Ring(frame + i, SLEEVE * first, 0.0) for i in range(self._mounted * self.per_segment + 1)]
            self._add(None, [*sleeve, sleeve[-1], sleeve[-1]._replace(radius=0.0)])
            frame += len(sleeve)
        if self._reach > 0.0:
            outline = ((1.0, 0.0), (0.8, 0.7), (0.0, 1.0))
            self._add(None, [Ring(frame, TOOL * last * size, self._reach * share) for size, share in outline])

    def _add(self, segment: int | None, rings: list[Ring]) -> None:
        band = np.array([ring != following for ring, following in pairwise(rings)])
        faces = ring_faces(len(rings), self._around).reshape(len(band), -1, 4)[band].reshape(-1, 4)
        self.parts.append(ColouredPart(segment, slice(len(self._rings), len(self._rings) + len(rings)), faces))
        self._rings += rings

    def vertices(self, q: Floats) -> list[Floats]:
        """Vertices (T, v, 3) of every part in configurations (T, n, 3)."""
        known = [_frames(self.robot, np.repeat(np.asarray(q, np.float64) / self.per_segment, self.per_segment, axis=1))]
        if self._mounted:
            known.append(self._mount_frames(q))
        if self._reach > 0.0:
            known.append(_tool_frames(self.robot, known[0][:, -1:]))
        chosen = np.concatenate(known, axis=1)[:, self._frame]
        axes = chosen[..., :9].reshape(*chosen.shape[:2], 3, 3)
        centers = chosen[..., 9:] + self._ahead[:, None] * axes[..., 2]
        across = np.einsum("ak,trik->trai", self._circle, axes[..., :2])
        rings = centers[:, :, None] + self._radius[:, None, None] * across
        return [rings[:, part.rings].reshape(len(rings), -1, 3) for part in self.parts]

    def facets(self, q: Floats) -> list[Floats]:
        """Corners (f, 4, 3) of the faces of every part in a configuration (n, 3)."""
        return [own[0][part.faces] for own, part in zip(self.vertices(q[None]), self.parts, strict=True)]

    def _mount_frames(self, q: Floats) -> Floats:
        """Frames (T, k, 12) along the part of the backbone that lies within the mount."""
        own = np.asarray(q, np.float64)[:, : self._mounted]
        begins = np.cumsum(own[..., 2], axis=1) - own[..., 2]
        share = np.clip((self.robot.mount - begins) / np.maximum(own[..., 2], 1e-300), 0.0, 1.0)
        fine = np.repeat(share[..., None] * own / self.per_segment, self.per_segment, axis=1)
        return _frames(self.robot, fine)


def _segments_within(robot: Robot, length: float) -> int:
    """How many segments may begin within this length of backbone from the base."""
    begins = np.cumsum([0.0, *(segment.length[0] for segment in robot.segments[:-1])])
    return int((begins < length).sum())


def _frames(robot: Robot, arcs: Floats) -> Floats:
    """Frames (T, m + 1, 12) at the base and at the ends of arcs (T, m, 3)."""
    from sinuous.kernels.chain import batch  # noqa: PLC0415

    frames = np.empty((len(arcs), arcs.shape[1] + 1, 12))
    batch.frames_of(np.ascontiguousarray(arcs), packing.pose_row(robot.base), frames)
    return frames


def _tool_frames(robot: Robot, tips: Floats) -> Floats:
    """Frames (T, 1, 12) at the tip, where `tips` are those of the body, with z towards the point of the tool."""
    place = robot.tool[:3, 3]
    turned = tips.copy()
    turned[..., :9] = (tips[..., :9].reshape(-1, 3, 3) @ least_rotation(place / np.linalg.norm(place))).reshape(
        -1, 1, 9
    )
    return turned
