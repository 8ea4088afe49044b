"""Places of the body, and how far they are from obstacles and from each other, by matrix exponentials and sampling."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.documents import result_of
from sinuous.base.errors import InputError, number, one_of_body
from sinuous.base.frozen import ShortRepr
from sinuous.measures.obstacles import Indices, at_most, measure, that_matter
from sinuous.model.joints import RigidRow
from sinuous.model.robot import Robot
from sinuous.scene.snapshot import Snapshot


@dataclass(frozen=True, repr=False)
class BodyPlace(ShortRepr):
    """A place of the backbone.

    Attributes
    ----------
    position : (float, float, float)
        In the world.
    segment : int, str or None
        1 = first; or the name of the joint whose link it is on; `None` where lengths that vary decide which it is.
    share : float or None
        How far along the segment, from 0 at its beginning to 1 at its end; `None` without a segment.
    """

    position: tuple[float, float, float]
    segment: Any = None
    share: float | None = None

    @classmethod
    def of(cls, position: Floats, segment: Any = None, share: float | None = None) -> "BodyPlace":
        """Make it of a position (3,), the number of a segment (1 = first), and a share of that."""
        x, y, z = np.asarray(position, np.float64).tolist()
        return cls((x, y, z), segment, None if share is None else float(share))

    def on_robot(self, owners: Sequence[Any], lengths: Floats) -> "BodyPlace":
        """Return it by segments of the robot, where it is on a body of arcs with these owners (N) and lengths (N,)."""
        if not isinstance(self.segment, int) or self.share is None:
            return self
        arc, segment = self.segment - 1, owners[self.segment - 1]
        own = np.array([each == segment for each in owners])
        before = float(lengths[:arc][own[:arc]].sum()) + self.share * float(lengths[arc])
        whole = float(lengths[own].sum())
        return replace(self, segment=segment, share=before / whole if whole > 0.0 else 0.0)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values, in the order of the file format."""
        return result_of(self, "position segment share")

    @classmethod
    def from_dict(cls, values: Any) -> "BodyPlace":
        """Make it of plain values, as `to_dict` writes them.

        Raises
        ------
        InputError
            When they are none.
        """
        try:
            own = {**values, "position": tuple(checks.vector("position", values["position"]).tolist())}
            return cls(**own)
        except (TypeError, KeyError):
            raise InputError("place", "", values, "position, segment and share") from None

    def __str__(self) -> str:
        largest = max(map(abs, self.position))
        digits = 3 - math.floor(math.log10(largest)) if largest > 0.0 else 0
        position = ", ".join(number(round(each, digits), 6) for each in self.position)
        return f"at ({position}){self._along}"

    @property
    def _along(self) -> str:
        """Where along the robot."""
        if self.share is None:
            return ""
        percent = round(100.0 * self.share)
        where = {0: "at the beginning of", 100: "at the end of"}.get(percent, f"{percent} % along")
        return f", {where} {one_of_body(self.segment)}"


RUN_BESIDE = 67
"""Places in a row that are held against an obstacle by one of them first: a third of those of a segment."""

SAMPLES = 200
"""Places on every segment where the body is looked at."""


WITHIN = 1e-12
"""What sticks out of the mount by no more counts as within it: rounding of sums of lengths, in lengths of the body."""


TERMS = 16
"""Terms of the series of an exponential, of a matrix with a norm of at most a half: the rest is below 1e-18."""


def exponential(twists: Floats) -> Floats:
    """Exponentials (..., 4, 4) of twists (..., 4, 4), by the power series of a small part, squared again and again.

    That of SciPy asks a library with threads for every 4x4 system, which takes a hundred times as long.
    """
    size = float(np.abs(twists[..., :3, :3]).sum(axis=(-2, -1)).max(initial=0.0))
    halvings = max(0, math.ceil(math.log2(2.0 * size))) if size > 0.0 else 0
    part = twists / 2.0**halvings
    term, result = np.eye(4), np.eye(4)
    for k in range(1, TERMS + 1):
        term = term @ part / k
        result = result + term
    for _ in range(halvings):
        result = result @ result
    return result


def arc_poses(q: Floats, pieces: int, begin: Floats | float = 0.0) -> Floats:
    """Poses (n, pieces + 1, 4, 4) along segments `q` (n, 3), each from its own begin: powers of exponentials of twists.

    Evenly spaced from the share `begin` (n,) of the segment up to its end.
    """
    twists, shares = np.zeros((len(q), 4, 4)), np.zeros((len(q), 1, 1))
    twists[:, :2, 2], twists[:, 2, :2], twists[:, 2, 3] = q[:, :2], -q[:, :2], q[:, 2]
    shares[:, 0, 0] = begin
    power, poses = exponential((1.0 - shares) * twists / pieces)[:, None], np.empty((len(q), pieces + 1, 4, 4))
    poses[:, 0], known = exponential(shares * twists), 1
    while known <= pieces:  # as many again, farther on by as many steps
        more = poses[:, known : 2 * known]
        np.matmul(poses[:, : more.shape[1]], power, out=more)
        known, power = 2 * known, power @ power
    return poses


def segment_ends(robot: Robot, q: Floats) -> Floats:
    """Poses (..., n + 1, 4, 4) of the base and of the ends of all segments in configurations (..., n, 3).

    Of a joint or a link, of what comes next.
    """
    steps = arc_poses(q.reshape(-1, 3), 1)[:, 1].reshape(*q.shape[:-1], 4, 4)
    poses = [np.broadcast_to(robot.base, (*q.shape[:-2], 4, 4))]
    for k, row in enumerate(robot.rows):
        end = poses[-1] @ steps[..., k, :, :]
        poses.append(end @ row.tail if isinstance(row, RigidRow) else end)
    return np.stack(poses, axis=-3)


def free_shares(robot: Robot, lengths: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Where in each segment of these lengths (..., n) the body leaves its mount, and whether any of it is beyond.

    The share (..., n) of the segment that lies within the mount, 0 to 1; the mount ends exactly there. It is nothing of
    links; joints have no body.
    """
    rigid = np.array([row.rigid for row in robot.rows])
    own = np.where(rigid, 0.0, lengths)
    ends = np.cumsum(own, axis=-1)
    left = robot.mount - (ends - own)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where((lengths > 0.0) & ~rigid, np.clip(left / lengths, 0.0, 1.0), 0.0)
    beyond = (ends > robot.mount + WITHIN * ends[..., -1:]) | (left <= 0.0)
    bodies = [row.has_body for row in robot.rows if isinstance(row, RigidRow)]
    beyond[..., : len(bodies)] = bodies
    return shares, beyond


def body_places(robot: Robot, q: Floats, ends: Floats) -> tuple[Floats, NDArray[np.intp]]:
    """Sampled places (m, 3) of the backbone beyond the mount, and the segment (m,), 0 = first, that each is on.

    The first of them is where the body leaves its mount.
    """
    shares, beyond = free_shares(robot, q[:, 2])
    poses = ends[:-1][beyond][:, None] @ arc_poses(q[beyond], SAMPLES, shares[beyond])
    return poses[..., :3, 3].reshape(-1, 3), np.repeat(np.flatnonzero(beyond), SAMPLES + 1)


class NearestObstacle(NamedTuple):
    """The least distance to obstacles, and where it is.

    Attributes
    ----------
    distance : float
        Infinite without obstacles.
    segment : int or None
        Segment of the body, 1 = first.
    obstacle : str or None
        Name of the obstacle.
    place : BodyPlace or None
        Of the backbone.
    """

    distance: float
    segment: int | None
    obstacle: str | None
    place: BodyPlace | None = None


def least_clearance(robot: Robot, scene: Snapshot, q: Floats, ends: Floats, *, beyond: bool = False) -> NearestObstacle:
    """Least clearance over sampled places of the body beyond the mount, in configuration `q` (n, 3).

    `ends` (n + 1, 4, 4) are the poses of the base and of the ends of all segments. `beyond`: less what is demanded.
    """
    least = NearestObstacle(math.inf, None, None)
    if len(scene) == 0:
        return least
    places, segments = body_places(robot, q, ends)
    radii = np.array(robot.needed_radii if beyond else robot.radii)[segments]
    runs, sizes = places.reshape(1, -1, RUN_BESIDE, 3), radii.reshape(1, 1, -1, RUN_BESIDE)[..., 0]
    for i, near in that_matter(scene.obstacles, runs, sizes):
        clearances = np.full(len(places), math.inf)
        asked = np.repeat(near[0], RUN_BESIDE)
        clearances[asked] = measure(scene.obstacles[i], places[asked]) - radii[asked]
        if clearances.min(initial=math.inf) < least.distance:
            nearest = int(clearances.argmin())
            segment, run = int(segments[nearest]), nearest % (SAMPLES + 1) / SAMPLES
            begin = float(free_shares(robot, q[:, 2])[0][segment])
            place = BodyPlace.of(places[nearest], segment + 1, begin + (1.0 - begin) * run)
            least = NearestObstacle(float(clearances[nearest]), segment + 1, scene.name(i), place)
    return least


def room_at(place: Floats, scene: Snapshot) -> NearestObstacle:
    """Upper bound of the distance of a place (3,) to the obstacles, and the obstacle that gives it, if one does."""
    distances = [float(at_most(obstacle, place[None])[0]) for obstacle in scene.obstacles]
    nearest = int(np.argmin(distances))
    return NearestObstacle(distances[nearest], None, scene.name(nearest) if math.isfinite(distances[nearest]) else None)


MOST_PLACES = 20_000
"""Places of the whole body, but for robots of so many segments that a few each are more."""

FEWEST = 8
"""Places of a segment."""

RUN, PAIRS = 16, 32
"""Places in a row that are held against others in a row, and pairs of such runs that are looked at together."""

ROUNDING = 1e-12
"""Of squared distances, as a share of the squared distances from a place near both."""


class Meeting(NamedTuple):
    """The least gap between two places of the body that concern each other, and where it is.

    Attributes
    ----------
    gap : float
        Their distance less both radii, and less what is demanded of it; infinite when no two places concern each other.
    segments : (int, int) or None
        Their segments, 1 = first, the one nearer to the base first.
    place : BodyPlace or None
        The one that is nearer to the tip.
    """

    gap: float
    segments: tuple[int, int] | None
    place: BodyPlace | None = None


class Places(NamedTuple):
    """Sampled places of the backbone, from the base to the tip, in one or more configurations.

    Attributes
    ----------
    shape : (int, int, int)
        Configurations, segments, and places of each segment: m in all.
    points, tangents : ndarray (m, 3)
    along, turned : ndarray (m,)
        Length of the backbone up to there, and by how much (rad) it turns up to there.
    segments : ndarray (m,)
        0 = first.
    radii : ndarray (m,)
        With half of the demanded clearance from itself, see `Robot.self_radii`.
    runs : ndarray (m,)
        The same number for neighbouring segments of the same radius.
    apart : ndarray (r, n)
        Which of the r rows of joints and links, the first ones, must not touch which row.
    """

    shape: tuple[int, int, int]
    points: Floats
    tangents: Floats
    along: Floats
    turned: Floats
    segments: Indices
    radii: Floats
    runs: Indices
    apart: NDArray[np.bool_]


def least_self_clearance(robot: Robot, q: Floats, ends: Floats) -> Meeting:
    """Least gap over sampled places of the body that concern each other, in configuration `q` (n, 3); see `concerned`.

    `ends` (n + 1, 4, 4) are the poses of the base and of the ends of all segments.
    """
    return nearest_pair(backbone_places(robot, q, ends, min(SAMPLES, max(FEWEST, MOST_PLACES // len(q)))))


def nearest_pair(places: Places) -> Meeting:
    """Least gap over places of a body that concern each other; see `concerned`."""
    points, radii = places.points, places.radii
    least = Meeting(math.inf, None)
    for low, one, other in _nearest_first(places):
        if low >= least.gap:
            break
        k, a, b = np.nonzero(_may_meet(places, one, other, least.gap))
        near, far = one[k, a], other[k, b]
        gaps = np.linalg.norm(points[near] - points[far], axis=1) - radii[near] - radii[far]
        gaps = np.where(concerned(places, near, far), gaps, math.inf)
        if gaps.min(initial=math.inf) < least.gap:
            nearest = int(gaps.argmin())
            pair = near[nearest], far[nearest]
            own, other_own = (int(each) + 1 for each in places.segments[list(pair)])
            share = float(pair[1] % places.shape[2]) / (places.shape[2] - 1)
            place = BodyPlace.of(places.points[pair[1]], other_own, share)
            least = Meeting(float(gaps[nearest]), (own, other_own), place)
    return least


def _may_meet(places: Places, one: Indices, other: Indices, gap: float) -> NDArray[np.bool_]:
    """Rule out most pairs (k, r, r) of places of runs (k, r) that do not concern each other, or are beyond a gap.

    Of a body without joints and with one radius all of the former: in runs side by side, most are neighbours on it.
    """
    points, radii = places.points, places.radii
    may = np.ones((len(one), RUN, RUN), np.bool_)
    jointed, widens = len(places.apart) > 0, places.runs[-1] > 0
    if not jointed and not widens:
        apart = places.along[other][:, None, :] - places.along[one][:, :, None]
        may = apart >= math.pi * radii[0]
    if math.isfinite(gap):
        middle = points[one[:, :1]]
        here, there = points[one] - middle, points[other] - middle
        lengths = np.square(here).sum(axis=-1)[:, :, None] + np.square(there).sum(axis=-1)[:, None, :]
        most = np.maximum(0.0, gap + radii[one].max(axis=1) + radii[other].max(axis=1))
        may &= (1.0 - ROUNDING) * lengths - 2.0 * here @ there.transpose(0, 2, 1) <= most[:, None, None] ** 2
    return may


def nearest_meeting(robot: Robot, q: Floats, ends: Floats) -> Meeting:
    """Where the body is nearest to itself, where that matters: see `Robot.avoids_itself`, `least_self_clearance`."""
    return least_self_clearance(robot, q, ends) if robot.avoids_itself else Meeting(math.inf, None)


def concerned(places: Places, first: Indices, second: Indices) -> NDArray[np.bool_]:
    """Whether the first of two places may not touch the second, which is nearer to the tip: they are no neighbours.

    Neighbours are, where the radius is the same from one to the other, places less than pi radii apart along the body;
    where it changes, places each of which lies ahead of the other. Two places without a radius never touch.
    """
    apart = places.along[second] - places.along[first]
    alike = places.runs[first] == places.runs[second]
    radius = np.maximum(places.radii[first], places.radii[second])
    result: NDArray[np.bool_] = apart >= math.pi * radius
    if not alike.all():
        across = places.points[second] - places.points[first]
        here = np.einsum("...i,...i->...", across, places.tangents[first])
        there = np.einsum("...i,...i->...", across, places.tangents[second])
        # Less than a quarter turn leaves them ahead of each other, also where rounding has it otherwise.
        astray = ((here <= 0.0) | (there <= 0.0)) & (places.turned[second] - places.turned[first] >= 0.5 * math.pi)
        result = np.where(alike, result, astray)
    count = len(places.apart)
    if count:
        one, other = places.segments[first], places.segments[second]
        linked = np.minimum(one, count - 1), other
        return np.where(one < count, places.apart[linked], result & (radius > 0.0))
    return result & (radius > 0.0)


def backbone_places(robot: Robot, q: Floats, ends: Floats, count: int) -> Places:
    """Divide each segment of a body in configuration `q` (n, 3) into `count` pieces; `ends` as above."""
    poses = ends[:-1, None] @ arc_poses(q, count)
    return places_of(robot, q[None], poses[None, ..., :3, 3], poses[None, ..., :3, 2])


def places_of(robot: Robot, q: Floats, points: Floats, tangents: Floats) -> Places:
    """Describe evenly spaced places (T, n, k, 3) of segments in configurations `q` (T, n, 3), and tangents there."""
    shape = points.shape[:3]
    fractions = np.linspace(0.0, 1.0, shape[2])
    along, turned = (
        ((np.cumsum(amounts, axis=1) - amounts)[..., None] + amounts[..., None] * fractions).ravel()
        for amounts in (q[..., 2], np.hypot(q[..., 0], q[..., 1]))
    )
    segments = np.broadcast_to(np.arange(shape[1])[:, None], shape).ravel()
    radii = np.array(robot.self_radii)
    runs = np.concatenate([[0], np.cumsum(np.diff(radii) != 0.0)])
    own = points.reshape(-1, 3), tangents.reshape(-1, 3)
    return Places(shape, *own, along, turned, segments, radii[segments], runs[segments], links_apart(robot))


def links_apart(robot: Robot) -> NDArray[np.bool_]:
    """Return which rows (r, n) of joints and links must not touch which rows of the robot."""
    rigid = [row for row in robot.rows if isinstance(row, RigidRow)]
    link, arcs = rigid[-1].link if rigid else 0, len(robot.rows) - len(rigid)
    links = [row.link for row in rigid] + [link + 1] * min(arcs, 1) + [link + 2] * (arcs - 1)
    bodies = [row.has_body for row in rigid] + [True] * arcs
    result = [
        [mine and theirs and not row.touches >> other & 1 for other, theirs in zip(links, bodies, strict=True)]
        for row, mine in zip(rigid, bodies, strict=False)
    ]
    return np.array(result, np.bool_).reshape(len(rigid), len(robot.rows))


def _nearest_first(places: Places) -> Iterator[tuple[float, Indices, Indices]]:
    """Yield pairs of runs of places (k, r), (k, r) with a lower bound of the gaps of what is still to come, and theirs.

    The run that is nearer to the base comes first. Pairs of which no two places concern each other are left out.
    The bounds are those of balls about the runs.
    """
    points, radii, (shapes, *own) = places.points, places.radii, places.shape
    count = math.prod(own)
    begin = np.arange(0, count, RUN)
    of_one = np.minimum(begin[:, None] + np.arange(RUN), count - 1)
    runs = (count * np.arange(shapes)[:, None, None] + of_one).reshape(-1, RUN)
    centers = points[runs].mean(axis=1)
    reach = (np.linalg.norm(points[runs] - centers[:, None], axis=-1) + radii[runs]).max(axis=1)
    thinnest = radii[runs].min(axis=1)
    pairs_of_one = np.array(np.triu_indices(len(begin)))
    one, other = (len(begin) * np.arange(shapes)[:, None] + pairs_of_one[:, None]).reshape(2, -1)
    far = places.along[runs[other, -1]] - places.along[runs[one, 0]] >= math.pi * np.maximum(
        thinnest[one], thinnest[other]
    )
    turned = places.turned[runs[other, -1]] - places.turned[runs[one, 0]] >= 0.5 * math.pi
    stepped = places.runs[runs[other, -1]] != places.runs[runs[one, 0]]
    begun, ended = places.segments[runs[:, 0]], places.segments[runs[:, -1]] + 1
    rigid = np.array([begun, ended]).clip(max=len(places.apart))[:, one]
    apart = np.pad(places.apart, ((1, 0), (1, 0))).cumsum(axis=0).cumsum(axis=1)
    low, high = (apart[rigid[1], each[other]] - apart[rigid[0], each[other]] for each in (begun, ended))
    may = np.flatnonzero(((far | (turned & stepped)) & (ended[one] > len(places.apart))) | (high > low))
    one, other = one[may], other[may]
    low = np.linalg.norm(centers[one] - centers[other], axis=1) - reach[one] - reach[other]
    order = np.argsort(low, kind="stable")
    for k in range(0, len(order), PAIRS):
        pairs = order[k : k + PAIRS]
        yield float(low[pairs[0]]), runs[one[pairs]], runs[other[pairs]]
