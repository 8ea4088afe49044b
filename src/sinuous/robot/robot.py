"""The robot: segments that bend and stretch, one after the other on a base."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from sinuous import checks, packing
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.frozen import Frozen
from sinuous.poses import as_pose
from sinuous.robot import actuation, limits
from sinuous.robot.actuators import Chambers, Tendons
from sinuous.robot.limits import Violation
from sinuous.robot.segment import Segment

MOST_SEGMENTS = 10_000


class Robot(Frozen):
    """A continuum robot: segments from base to tip, where it stands, and what it carries.

    A configuration `q` is an array (..., n, 3) with `bend_x`, `bend_y` (rad) and `length` of every segment.

    Parameters
    ----------
    segments : iterable of Segment
        Base to tip; at least one, and not all of length 0.
    radius : float, optional
        Radius of the body for all segments, instead of each one's own.
    mount : float
        Length of backbone from the base that obstacles do not concern.
    base : array_like (4, 4), optional
        Pose of the base in the world; its z axis is the tangent that the backbone leaves with.
    tool : array_like (4, 4), optional
        Pose of the tool in the frame of the tip. Targets of the tip mean the tool; the tool has no body.

    Attributes
    ----------
    segments : tuple of Segment
    radii : tuple of float
        Radius of the body, per segment.
    limits, actuation : ndarray (n, 7), (p, 7)
        Limits of segments and actuators as `sinuous.kernels.tables` lays them out, read-only.

    Raises
    ------
    InputError
        When there is no segment, nothing has a length, or a pose is none.
    """

    segments: tuple[Segment, ...]
    radii: tuple[float, ...]
    mount: float
    base: Floats
    tool: Floats
    limits: Floats
    actuation: Floats

    def __init__(
        self, segments: Iterable[Segment], *, radius: Any = None, mount: Any = 0.0, base: Any = None, tool: Any = None
    ) -> None:
        if not isinstance(segments, Iterable):
            raise InputError("segments", "", segments, "a list of Segment")
        listed = tuple(segments)
        checks.integer("segments", len(listed), 1, MOST_SEGMENTS)
        for k, segment in enumerate(listed):
            if not isinstance(segment, Segment):
                raise InputError(f"segments[{k}]", "", segment, "a Segment")
        if all(segment.length[1] == 0.0 for segment in listed):
            raise InputError("segments", "", listed, "at least one segment that can be longer than 0")
        radii = tuple(segment.radius for segment in listed)
        if radius is not None:
            radii = (checks.number("radius", radius, low=0.0),) * len(listed)
        self._set(
            segments=listed,
            mount=checks.number("mount", mount, low=0.0),
            base=as_pose("base", base),
            tool=as_pose("tool", tool),
            radii=radii,
            limits=packing.segment_table(listed, radii),
            actuation=packing.actuator_table(listed),
        )

    @classmethod
    def uniform(
        cls,
        count: Any,
        length: Any,
        max_bend: Any = math.pi,
        max_curvature: Any = None,
        radius: Any = 0.0,
        *,
        tendons: Tendons | None = None,
        chambers: Chambers | None = None,
        **whole: Any,
    ) -> "Robot":
        """Make a robot of `count` equal segments; the rest as for `Segment`, and mount, base, tool as for `Robot`."""
        number = checks.integer("count", count, 1, MOST_SEGMENTS)
        segment = Segment(length, max_bend, max_curvature, radius, tendons, chambers)
        return cls([segment] * number, **whole)

    def __len__(self) -> int:
        return len(self.segments)

    def __repr__(self) -> str:
        low, high = (sum(segment.length[i] for segment in self.segments) for i in (0, 1))
        return f"Robot({len(self)} segments, total length {low:g} to {high:g})"

    @property
    def mean_length(self) -> float:
        """Sum of the mean lengths of the segments: the unit of relative tolerances."""
        return 0.5 * sum(sum(segment.length) for segment in self.segments)

    def configuration(self, key: str, q: Any) -> Floats:
        """Check an array (..., n, 3) of finite numbers; limits are not looked at."""
        return checks.stack(key, q, (len(self), 3))

    def forward(self, q: Any) -> Floats:
        """Poses (..., n, 4, 4) of the ends of all segments in the world; the tool is not applied."""
        frames, lead = self._frames(q)
        poses = np.zeros((*frames.shape[:2], 4, 4))
        poses[..., :3, :3] = frames[..., :9].reshape(*frames.shape[:2], 3, 3)
        poses[..., :3, 3] = frames[..., 9:]
        poses[..., 3, 3] = 1.0
        return poses[:, 1:].reshape(*lead, len(self), 4, 4)

    def tip(self, q: Any) -> Floats:
        """Pose (..., 4, 4) of the tool (of the tip, without one) in the world."""
        result: Floats = self.forward(q)[..., -1, :, :] @ self.tool
        return result

    def backbone(self, q: Any, samples: int = 20) -> Floats:
        """Points (..., n * samples + 1, 3) of the backbone from base to tip, evenly spaced within each segment."""
        from sinuous.kernels.chain import batch  # noqa: PLC0415

        count = checks.integer("samples", samples, 1, 100_000)
        frames, lead = self._frames(q)
        flat = np.array(q, np.float64, order="C").reshape(-1, len(self), 3)
        points = np.empty((len(flat), len(self) * count + 1, 3))
        batch.points_of(flat, frames, count, points)
        return points.reshape(*lead, *points.shape[1:])

    def jacobian(self, q: Any, segment: int | None = None) -> Floats:
        """Geometric Jacobian (..., 6, 3 n) of the end of `segment` (1 = first; the last, the default, means the tool).

        Rows 0 to 2 are the angular velocity, rows 3 to 5 the velocity of that point, both in world axes; columns are
        `bend_x, bend_y, length` of the first segment, of the second, and so on.
        """
        from sinuous.kernels.chain import batch  # noqa: PLC0415

        end = len(self) if segment is None else checks.integer("segment", segment, 1, len(self))
        frames, lead = self._frames(q)
        flat = np.array(q, np.float64, order="C").reshape(-1, len(self), 3)
        out = np.zeros((len(flat), 6, 3 * len(self)))
        batch.jacobians_of(flat, frames, packing.pose_row(self.tool), end - 1, np.empty((len(self), 18)), out)
        return out.reshape(*lead, 6, 3 * len(self))

    def _frames(self, q: Any) -> tuple[Floats, tuple[int, ...]]:
        from sinuous.kernels.chain import batch  # noqa: PLC0415

        checked = self.configuration("q", q)
        lead = checked.shape[:-2]
        flat = np.array(checked.reshape(-1, len(self), 3))
        frames = np.empty((len(flat), len(self) + 1, 12))
        batch.frames_of(flat, packing.pose_row(self.base), frames)
        return frames, lead

    def excess(self, q: Any) -> float:
        """Return by how much configurations (..., n, 3) are outside the limits, at worst; 0 within all of them.

        Bends and lengths count in their own units (rad, length unit), actuators in the length unit.
        """
        return limits.excess(self.segments, self.configuration("q", q))

    def violations(self, q: Any) -> list[Violation]:
        """List the limits that a configuration (n, 3) violates, each with its segment (1 = first) and by how much.

        `length` and `actuator` count in the length unit, `bend` and `curvature` in rad: the latter is the bend beyond
        what the curvature allows at this length.
        """
        slack = 1e-11 * max(1.0, self.mean_length)
        return limits.violations(self.segments, checks.array("q", q, (len(self), 3)), slack)

    def tendon_displacements(self, q: Any) -> list[Floats]:
        """Displacement of every tendon, per segment an array (..., m); positive is pulled, of the bends alone."""
        return actuation.tendon_displacements(self.segments, self.configuration("q", q))

    def tendon_lengths(self, q: Any) -> list[Floats]:
        """Length of every tendon from base to where it ends, per segment an array (..., m)."""
        return actuation.tendon_lengths(self.segments, self.configuration("q", q))

    def from_tendon_lengths(self, lengths: list[Any]) -> Floats:
        """Configuration (..., n, 3) of a robot whose tendons have these lengths (by least squares where they are many).

        Every segment needs tendons that are not all in one plane with the backbone; without extension the known
        length of a segment is used, otherwise the lengths of its tendons determine it.
        """
        return actuation.from_tendon_lengths(self.segments, lengths)

    def from_tendon_displacements(self, displacements: list[Any], length: Any = None) -> Floats:
        """Configuration (..., n, 3) from displacements per segment (..., m), with segment lengths (..., n).

        `length` may be left out when no segment can stretch.
        """
        return actuation.from_tendon_displacements(self.segments, displacements, length)

    def chamber_lengths(self, q: Any) -> list[Floats]:
        """Length of every chamber, per segment an array (..., m)."""
        return actuation.chamber_lengths(self.segments, self.configuration("q", q))

    def from_chamber_lengths(self, lengths: list[Any]) -> Floats:
        """Configuration (..., n, 3) of a robot whose chambers have these lengths (least squares where many)."""
        return actuation.from_chamber_lengths(self.segments, lengths)
