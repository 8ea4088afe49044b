"""The body of a robot as a smooth tube: rings of points about its backbone, for one configuration or many at once."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous import packing
from sinuous.checks import Floats
from sinuous.robot.robot import Robot

AROUND = 16
"""Points of a ring."""

ALONG = 12
"""Rings along a segment; a robot of many segments has fewer each."""

MOST_ALONG = 240
"""Rings along the whole body, but for robots of so many segments that one each is more."""

CAP = 4
"""Rings of the half balls in which the body ends."""

Triangles = NDArray[np.uint32]


class Piece(NamedTuple):
    """A part of the tube that has one colour.

    Attributes
    ----------
    segment : int
        Which it belongs to, 0 = first.
    rings : slice
        Which rings it is made of.
    middle : slice
        The frames along it.
    """

    segment: int
    rings: slice
    middle: slice


class Tube:
    """How the rings of a robot's body follow from its configuration.

    Parameters
    ----------
    robot : Robot
    least_radius : float
        The body is drawn no thinner than this.
    parts : int
        Pieces of each segment.
    along : int, optional
        Steps along each piece.
    share : float
        Of its radius that is drawn.
    """

    def __init__(
        self, robot: Robot, least_radius: float, parts: int = 1, along: int | None = None, share: float = 1.0
    ) -> None:
        wanted = max(1, min(ALONG, MOST_ALONG // len(robot))) if along is None else along
        steps = max(1, -(-wanted // parts))
        self.robot = robot
        self.per_segment = parts * steps
        self.pieces: list[Piece] = []
        radii = [share * max(radius, least_radius) for radius in robot.radii]
        rows: list[tuple[float, float, float]] = []  # frame, radius, place along its axis
        angles = [0.5 * math.pi * i / CAP for i in range(1, CAP + 1)]
        for k, radius in enumerate(radii):
            for part in range(parts):
                first = k * self.per_segment + part * steps
                begin = len(rows)
                if first == 0:
                    rows += [(0, radius * math.cos(a), -radius * math.sin(a)) for a in reversed(angles)]
                rows += [(first + i, radius, 0.0) for i in range(steps + 1)]
                if first + steps == len(robot) * self.per_segment:
                    rows += [(first + steps, radius * math.cos(a), radius * math.sin(a)) for a in angles]
                self.pieces.append(Piece(k, slice(begin, len(rows)), slice(first, first + steps + 1)))
        table = np.array(rows)
        self._frame, self._radius, self._ahead = table[:, 0].astype(np.int64), table[:, 1], table[:, 2]
        turn = np.arange(AROUND) * (2.0 * math.pi / AROUND)
        self._circle = np.stack([np.cos(turn), np.sin(turn)], axis=-1)

    def frames(self, q: Floats) -> Floats:
        """Frames (T, m, 12) along the backbone in configurations (T, n, 3): nine numbers of a rotation, and a place."""
        from sinuous.kernels.chain import batch  # noqa: PLC0415

        fine = np.repeat(np.asarray(q, np.float64) / self.per_segment, self.per_segment, axis=1)
        frames = np.empty((len(fine), fine.shape[1] + 1, 12))
        batch.frames_of(fine, packing.pose_row(self.robot.base), frames)
        return frames

    def points(self, frames: Floats) -> NDArray[np.float32]:
        """Points (T, r, AROUND, 3) of all rings."""
        chosen = frames[:, self._frame]
        axes = chosen[..., :9].reshape(*chosen.shape[:2], 3, 3)
        centers = chosen[..., 9:] + self._ahead[:, None] * axes[..., 2]
        across = np.einsum("ak,trik->trai", self._circle, axes[..., :2])
        points: NDArray[np.float32] = (centers[:, :, None] + self._radius[:, None, None] * across).astype(np.float32)
        return points

    def faces(self, piece: Piece) -> Triangles:
        """Triangles (f, 3) of a piece, counterclockwise as seen from outside; they count its own points."""
        return tube_faces(piece.rings.stop - piece.rings.start, AROUND)


def tube_faces(rings: int, around: int) -> Triangles:
    """Triangles between neighbouring rings of so many points each."""
    ring, place = np.meshgrid(np.arange(rings - 1), np.arange(around), indexing="ij")
    a, b = ring * around + place, ring * around + (place + 1) % around
    quads = np.stack([a, b, b + around, a + around], axis=-1).reshape(-1, 4)
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.uint32)
