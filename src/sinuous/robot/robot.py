"""The robot: segments that bend and stretch, one after the other on a base."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.kernels.tables import ACTUATOR_WIDTH
from sinuous.packing import actuator_row, pose_row, segment_row
from sinuous.poses import as_pose
from sinuous.robot.actuators import Chambers, Tendons

MOST_SEGMENTS = 10_000


@dataclass(frozen=True, init=False, eq=False)
class Segment:
    """One constant-curvature piece of a robot, and its limits.

    Parameters
    ----------
    length : float or (float, float)
        Length of the backbone, or its range; one number means inextensible. The lower end may be 0 (an insertion
        stage).
    max_bend : float
        Largest norm of the bending vector, rad; 0 = the segment cannot bend.
    max_curvature : float, optional
        Largest bend divided by length, in 1 / length unit.
    radius : float
        Radius of the body.
    tendons : Tendons, optional
        Tendons that end at the end of this segment.
    chambers : Chambers, optional
        Chambers along this segment.

    Raises
    ------
    InputError
        When a limit is negative, NaN, or the wrong way round, or when the straight segment breaks a limit of its
        chambers.
    """

    length: tuple[float, float]
    max_bend: float
    max_curvature: float
    radius: float
    tendons: Tendons | None
    chambers: Chambers | None

    def __init__(
        self,
        length: Any,
        max_bend: Any = math.pi,
        max_curvature: Any = None,
        radius: Any = 0.0,
        tendons: Tendons | None = None,
        chambers: Chambers | None = None,
    ) -> None:
        low, high = checks.interval("length", length, low=0.0)
        curvature = math.inf if max_curvature is None else checks.number("max_curvature", max_curvature, low=0.0)
        for key, value, kind in (("tendons", tendons, Tendons), ("chambers", chambers, Chambers)):
            if value is not None and not isinstance(value, kind):
                raise InputError(key, "of the wrong kind", value, f"{kind.__name__} or nothing")
        if chambers is not None:
            low, high = max(low, chambers.length[0]), min(high, chambers.length[1])
            if low > high:
                raise InputError(
                    "chambers.length", "excludes the straight segment", chambers.length, f"overlap with {length}"
                )
        object.__setattr__(self, "length", (low, high))
        object.__setattr__(self, "max_bend", checks.number("max_bend", max_bend, low=0.0))
        object.__setattr__(self, "max_curvature", curvature)
        object.__setattr__(self, "radius", checks.number("radius", radius, low=0.0))
        object.__setattr__(self, "tendons", tendons)
        object.__setattr__(self, "chambers", chambers)

    def __repr__(self) -> str:
        low, high = self.length
        shown = f"{low:g}" if low == high else f"({low:g}, {high:g})"
        return f"Segment(length={shown}, max_bend={self.max_bend:g}, radius={self.radius:g})"


class Robot:
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

    Raises
    ------
    InputError
        When there is no segment, nothing has a length, or a pose is none.
    """

    def __init__(
        self, segments: Iterable[Segment], *, radius: Any = None, mount: Any = 0.0, base: Any = None, tool: Any = None
    ) -> None:
        if not isinstance(segments, Iterable):
            raise InputError("segments", "of the wrong kind", segments, "a list of Segment")
        self.segments: tuple[Segment, ...] = tuple(segments)
        checks.integer("segments", len(self.segments), 1, MOST_SEGMENTS)
        for k, segment in enumerate(self.segments):
            if not isinstance(segment, Segment):
                raise InputError(f"segments[{k}]", "of the wrong kind", segment, "a Segment")
        if all(segment.length[1] == 0.0 for segment in self.segments):
            raise InputError(
                "segments", "have no length", self.segments, "at least one segment that can be longer than 0"
            )
        self.mount = checks.number("mount", mount, low=0.0)
        self.base = as_pose("base", base)
        self.tool = as_pose("tool", tool)
        radii = [segment.radius for segment in self.segments]
        if radius is not None:
            radii = [checks.number("radius", radius, low=0.0)] * len(self.segments)
        self.radii: tuple[float, ...] = tuple(radii)
        self.limits = np.array(
            [
                segment_row(segment.length, segment.max_bend, segment.max_curvature, radius)
                for segment, radius in zip(self.segments, radii, strict=True)
            ]
        )
        self.actuation = _actuation_table(self.segments)
        for table in (self.limits, self.actuation):
            table.flags.writeable = False

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
        mount: Any = 0.0,
        base: Any = None,
        tool: Any = None,
    ) -> "Robot":
        """Make a robot of `count` equal segments; the rest as for `Segment` and `Robot`."""
        number = checks.integer("count", count, 1, MOST_SEGMENTS)
        segment = Segment(length, max_bend, max_curvature, radius, tendons, chambers)
        return cls([segment] * number, mount=mount, base=base, tool=tool)

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
        flat = np.ascontiguousarray(np.asarray(q, np.float64).reshape(-1, len(self), 3))
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
        flat = np.ascontiguousarray(np.asarray(q, np.float64).reshape(-1, len(self), 3))
        out = np.zeros((len(flat), 6, 3 * len(self)))
        batch.jacobians_of(flat, frames, pose_row(self.tool), end - 1, np.empty((len(self), 18)), out)
        return out.reshape(*lead, 6, 3 * len(self))

    def _frames(self, q: Any) -> tuple[Floats, tuple[int, ...]]:
        from sinuous.kernels.chain import batch  # noqa: PLC0415

        checked = self.configuration("q", q)
        lead = checked.shape[:-2]
        flat = np.array(checked.reshape(-1, len(self), 3))
        frames = np.empty((len(flat), len(self) + 1, 12))
        batch.frames_of(flat, pose_row(self.base), frames)
        return frames, lead

    def excess(self, q: Any) -> float:
        """Return by how much a configuration is outside the limits, at worst; 0 when it is within all of them.

        Bends and lengths count in their own units (rad, length unit), actuators in the length unit.
        """
        x = self.configuration("q", q)
        bends, lengths = np.hypot(x[..., 0], x[..., 1]), x[..., 2]
        low, high, max_bend, max_curvature = self.limits[:, :4].T
        with np.errstate(invalid="ignore"):
            cap = np.fmin(max_bend, np.where(np.isinf(max_curvature), np.inf, max_curvature * lengths))
        beyond = [low - lengths, lengths - high, bends - cap]
        for first, last, ax, ay, al, lowest, highest in self.actuation.tolist():
            value = x[..., int(first) : int(last) + 1, :].sum(axis=-2) @ np.array([ax, ay, al])
            beyond += [lowest - value, value - highest]
        return max(float(np.max(part, initial=0.0)) for part in beyond)

    def violations(self, q: Any) -> list[tuple[str, int, float]]:
        """List the limits that a configuration (n, 3) violates, each with its segment (1 = first) and by how much.

        `length` and `actuator` count in the length unit, `bend` and `curvature` in rad: the latter is the bend beyond
        what the curvature allows at this length.
        """
        x = checks.array("q", q, (len(self), 3))
        found: list[tuple[str, int, float]] = []
        for k, (segment, (ux, uy, length)) in enumerate(zip(self.segments, x.tolist(), strict=True), start=1):
            bend = math.hypot(ux, uy)
            found.append(("length", k, max(segment.length[0] - length, length - segment.length[1])))
            found.append(("bend", k, bend - segment.max_bend))
            if math.isfinite(segment.max_curvature):
                found.append(("curvature", k, bend - segment.max_curvature * max(0.0, length)))
        for first, last, ax, ay, al, lowest, highest in self.actuation.tolist():
            value = float(x[int(first) : int(last) + 1].sum(axis=0) @ np.array([ax, ay, al]))
            found.append(("actuator", int(last) + 1, max(lowest - value, value - highest)))
        return [each for each in found if each[2] > 1e-11 * max(1.0, self.mean_length)]

    def tendon_displacements(self, q: Any) -> list[Floats]:
        """Displacement of every tendon, per segment an array (..., m); positive is pulled, of the bends alone."""
        x = self.configuration("q", q)
        total = np.cumsum(x[..., :2], axis=-2)
        return [
            np.zeros((*x.shape[:-2], 0)) if s.tendons is None else total[..., k, :] @ s.tendons.arms.T
            for k, s in enumerate(self.segments)
        ]

    def tendon_lengths(self, q: Any) -> list[Floats]:
        """Length of every tendon from base to where it ends, per segment an array (..., m)."""
        x = self.configuration("q", q)
        reach = np.cumsum(x[..., 2], axis=-1)
        return [reach[..., k, None] - pulled for k, pulled in enumerate(self.tendon_displacements(x))]

    def from_tendon_lengths(self, lengths: list[Any]) -> Floats:
        """Configuration (..., n, 3) of a robot whose tendons have these lengths (by least squares where they are many).

        Every segment needs tendons that are not all in one plane with the backbone; without extension the known
        length of a segment is used, otherwise the lengths of its tendons determine it.
        """
        return _undo_lines(self, "tendons", _per_segment(self, "lengths", lengths, "tendons"))

    def from_tendon_displacements(self, displacements: list[Any], length: Any = None) -> Floats:
        """Configuration (..., n, 3) from displacements per segment (..., m), with segment lengths (..., n).

        `length` may be left out when no segment can stretch.
        """
        if length is None and any(s.length[0] != s.length[1] for s in self.segments):
            raise InputError("length", "is missing", length, "segment lengths, because segments can stretch")
        own = checks.stack("length", [s.length[0] for s in self.segments] if length is None else length, (len(self),))
        reach = np.cumsum(own, axis=-1)
        values = _per_segment(self, "displacements", displacements, "tendons")
        _broadcast("length", length, own[..., 0], values[0][..., 0])
        return _undo_lines(self, "tendons", [reach[..., k, None] - v for k, v in enumerate(values)], own)

    def chamber_lengths(self, q: Any) -> list[Floats]:
        """Length of every chamber, per segment an array (..., m)."""
        x = self.configuration("q", q)
        return [
            np.zeros((*x.shape[:-2], 0)) if s.chambers is None else x[..., k, 2:] - x[..., k, :2] @ s.chambers.arms.T
            for k, s in enumerate(self.segments)
        ]

    def from_chamber_lengths(self, lengths: list[Any]) -> Floats:
        """Configuration (..., n, 3) of a robot whose chambers have these lengths (least squares where many)."""
        return _undo_lines(self, "chambers", _per_segment(self, "lengths", lengths, "chambers"))


def _actuation_table(segments: tuple[Segment, ...]) -> Floats:
    """Rows (p, 7) of all limits of actuators."""
    rows = []
    for k, segment in enumerate(segments):
        if segment.tendons is not None and np.isfinite(segment.tendons.displacement).any():
            rows += [actuator_row(0, k, (ax, ay, 0.0), segment.tendons.displacement) for ax, ay in segment.tendons.arms]
        if segment.chambers is not None and np.isfinite(segment.chambers.length).any():
            rows += [actuator_row(k, k, (-ax, -ay, 1.0), segment.chambers.length) for ax, ay in segment.chambers.arms]
    return np.array(rows, np.float64).reshape(-1, ACTUATOR_WIDTH)


def _broadcast(key: str, value: Any, *arrays: Floats) -> list[Floats]:
    """Bring arrays to one shape."""
    try:
        return list(np.broadcast_arrays(*arrays))
    except ValueError:
        shapes = " and ".join(str(a.shape) for a in arrays)
        raise InputError(key, "does not fit the rest", value, f"shapes that broadcast, not {shapes}") from None


def _per_segment(robot: Robot, key: str, values: list[Any], kind: str) -> list[Floats]:
    """Check one array (..., lines) a segment; their axes in front are broadcast."""
    listed = (
        []
        if isinstance(values, (str, bytes, dict)) or not np.iterable(values)
        else list(islice(values, len(robot) + 1))
    )
    if len(listed) != len(robot):
        raise InputError(key, "wrong kind or number", values, f"a list of {len(robot)} arrays, one a segment")
    result = []
    for k, (segment, value) in enumerate(zip(robot.segments, listed, strict=True)):
        lines = getattr(segment, kind)
        if lines is None or not lines.spans_plane:
            raise InputError(
                f"segments[{k}].{kind}", "do not determine the bend", lines, "at least two, not in one plane"
            )
        result.append(checks.stack(f"{key}[{k}]", value, (len(lines.angles),)))
    lead = _broadcast(key, values, *(v[..., 0] for v in result))[0].shape
    return [np.broadcast_to(v, (*lead, v.shape[-1])) for v in result]


def _undo_lines(robot: Robot, kind: str, values: list[Floats], known: Floats | None = None) -> Floats:
    """Undo `length = reach - arms . bend`, segment by segment; later tendons run through earlier segments."""
    before = np.zeros((*values[0].shape[:-1], 3))
    out = []
    for k, (segment, value) in enumerate(zip(robot.segments, values, strict=True)):
        arms = getattr(segment, kind).arms
        system = np.concatenate([-arms, np.ones((len(arms), 1))], axis=1)
        fixed = (
            known[..., k]
            if known is not None
            else (segment.length[0] if segment.length[0] == segment.length[1] else None)
        )
        rest = value - (before @ system.T if kind == "tendons" else 0.0)
        if fixed is None:
            if np.linalg.matrix_rank(system, tol=1e-9) < 3:
                raise InputError(
                    f"segments[{k}].{kind}", "do not determine the length", len(arms), "three lines or more"
                )
            own = rest @ np.linalg.pinv(system).T
        else:
            stretch = np.broadcast_to(np.asarray(fixed, np.float64), rest.shape[:-1])[..., None]
            own = np.concatenate([(stretch - rest) @ np.linalg.pinv(arms).T, stretch], axis=-1)
        out.append(own)
        before = before + own
    return np.stack(out, axis=-2)


def from_arc_parameters(curvature: Any, plane_angle: Any, length: Any) -> Floats:
    """Configuration (..., 3) of segments with these curvatures (1 / length), bending-plane angles (rad) and lengths.

    Webster & Jones 2010: (kappa, phi, l). The arrays broadcast; `(n,)` arrays make one configuration (n, 3).
    """
    given = (("curvature", curvature), ("plane_angle", plane_angle), ("length", length))
    parts = [checks.stack(key, value, ()) for key, value in given]
    kappa, phi, arc = _broadcast("curvature", curvature, *parts)
    return np.stack([kappa * arc * np.cos(phi), kappa * arc * np.sin(phi), arc], axis=-1)


def arc_parameters(q: Any) -> tuple[Floats, Floats, Floats]:
    """Curvature (1 / length), bending-plane angle (rad; 0 when straight) and length of every segment, each (..., n).

    A segment of length 0 has no curvature unless it is straight (then 0).
    """
    x = checks.stack("q", q, (3,))
    bend = np.hypot(x[..., 0], x[..., 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        curvature = np.where(bend == 0.0, 0.0, bend / x[..., 2])
    if not np.isfinite(curvature).all():
        raise InputError(
            "q", "has a bent segment of length 0", x.tolist(), "a length greater than 0 where there is a bend"
        )
    return curvature, np.arctan2(x[..., 1], x[..., 0]), x[..., 2].copy()
