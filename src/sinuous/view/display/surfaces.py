"""Surfaces as vertices and faces: of simple solids and of obstacles; and points on those that have no surface.

Vertices are shared where a surface is smooth, and kept apart along an edge: pages shade by the normals of vertices.
"""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.kernels import packing
from sinuous.model.joints import RigidRow
from sinuous.model.poses import least_rotation
from sinuous.model.robot import Robot
from sinuous.scene.grids import Field, Grid
from sinuous.scene.mesh import Mesh
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Obstacle, Primitive, Sphere
from sinuous.scene.point_cloud import PointCloud

Faces = NDArray[np.int64]
Triangles = NDArray[np.uint32]

ARC_BANDS = 6
"""Bands of a quarter of a circle, from the equator to a pole."""


class Surface(NamedTuple):
    """A surface in space.

    Attributes
    ----------
    vertices : ndarray (v, 3)
        In the length unit.
    faces : ndarray (f, 4)
        Indices of the corners, counterclockwise as seen from outside. A triangle repeats its last corner.
    """

    vertices: Floats
    faces: Faces

    @property
    def facets(self) -> Floats:
        """Corners (f, 4, 3) of all faces."""
        return self.vertices[self.faces]

    @property
    def triangles(self) -> Triangles:
        """The faces as triangles (t, 3)."""
        return as_triangles(self.faces)

    def moved(self, rotation: Floats, position: Floats) -> "Surface":
        """Return the surface rotated (3, 3), then translated (3,)."""
        return Surface(self.vertices @ rotation.T + position, self.faces)

    def flipped(self) -> "Surface":
        """Return the same surface with its inside outside."""
        triangle = (self.faces[:, 2] == self.faces[:, 3])[:, None]
        return Surface(self.vertices, np.where(triangle, self.faces[:, [2, 1, 0, 0]], self.faces[:, ::-1]))


def as_triangles(faces: Faces) -> Triangles:
    """Triangles (t, 3) of faces with four corners; a face that repeats its last corner gives one."""
    second = faces[faces[:, 2] != faces[:, 3]]
    return np.concatenate([faces[:, [0, 1, 2]], second[:, [0, 2, 3]]]).astype(np.uint32)


def join_surfaces(*surfaces: Surface) -> Surface:
    """Put several surfaces together."""
    starts = np.cumsum([0, *(len(each.vertices) for each in surfaces[:-1])])
    faces = [each.faces + start for each, start in zip(surfaces, starts, strict=True)]
    return Surface(np.concatenate([each.vertices for each in surfaces]), np.concatenate(faces))


def ring_faces(rings: int, around: int) -> Faces:
    """Faces ((rings - 1) * around, 4) between neighbouring rings of so many vertices, which turn counterclockwise."""
    ring, place = np.meshgrid(np.arange(rings - 1), np.arange(around), indexing="ij")
    a, b = ring * around + place, ring * around + (place + 1) % around
    return np.stack([a, b, b + around, a + around], axis=-1).reshape(-1, 4)


def circle(around: int) -> Floats:
    """Points (around, 2) of a circle of radius 1."""
    turn = np.arange(around) * (2.0 * math.pi / around)
    return np.stack([np.cos(turn), np.sin(turn)], axis=-1)


def arc(radius: float, begin: float, end: float, bands: int) -> Floats:
    """Points (bands + 1, 2) of an arc about the origin, from one angle (rad) to another."""
    angles = np.linspace(begin, end, bands + 1)
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=-1)


def revolve_profile(profile: Floats, around: int) -> Surface:
    """A surface of revolution about z; `profile` (p, 2): distance from the axis, and height, upwards."""
    rings = np.empty((len(profile), around, 3))
    rings[..., :2] = profile[:, None, :1] * circle(around)
    rings[..., 2] = profile[:, 1:]
    return Surface(rings.reshape(-1, 3), ring_faces(len(profile), around))


def sphere(radius: float, around: int) -> Surface:
    """A ball about the origin."""
    return revolve_profile(arc(radius, -0.5 * math.pi, 0.5 * math.pi, 2 * ARC_BANDS + 1), around)


def capsule(radius: float, half: float, around: int, pieces: int) -> Surface:
    """All points within `radius` of the z axis from -half to half; its wall is cut into so many pieces."""
    shift = np.array([0.0, half])
    low, high = arc(radius, -0.5 * math.pi, 0.0, ARC_BANDS) - shift, arc(radius, 0.0, 0.5 * math.pi, ARC_BANDS) + shift
    wall = np.linspace(low[-1], high[0], pieces + 1)[1:-1]
    return revolve_profile(np.concatenate([low, wall, high]), around)


def cylinder(radius: float, half: float, around: int, pieces: int) -> Surface:
    """A cylinder with flat ends about z, from -half to half; its wall is cut into so many pieces."""
    wall = np.linspace([radius, -half], [radius, half], pieces + 1)
    bottom, top = np.array([[0.0, -half], [radius, -half]]), np.array([[radius, half], [0.0, half]])
    return join_surfaces(*(revolve_profile(profile, around) for profile in (bottom, wall, top)))


def box(half: Floats, pieces: int) -> Surface:
    """A box about the origin with these half extents (3,); its edges are cut into so many pieces."""
    sides = []
    for axis in range(3):
        for height in (-1.0, 1.0):
            side = square(1.0, pieces)
            side.vertices[:, 2] = height
            facing = side if height > 0.0 else side.flipped()
            sides.append(Surface(np.roll(facing.vertices, axis + 1, axis=-1) * half, facing.faces))
    return join_surfaces(*sides)


def square(half: float, pieces: int) -> Surface:
    """A square about the origin in the plane z = 0, that faces up; its edges are cut into so many pieces."""
    edge = np.linspace(-half, half, pieces + 1)
    x, y = np.meshgrid(edge, edge)
    corner = np.arange((pieces + 1) ** 2).reshape(pieces + 1, pieces + 1)
    corners = [corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1]]
    return Surface(
        np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3), np.stack(corners, axis=-1).reshape(-1, 4)
    )


FACES_AROUND = 32
"""Faces around what is round."""

FACES_ALONG = 12
"""Faces along an edge or a wall: pictures sort faces by the distance of their middles, so that none may be long."""

MOST_POINTS = 20_000
"""Points of an obstacle that are drawn; of more, evenly spread ones are."""

Dotted = PointCloud | Grid | Field
"""Obstacles that are drawn as points."""


def obstacle_surface(
    obstacle: Obstacle, middle: Floats, span: float, around: int = FACES_AROUND, pieces: int = FACES_ALONG
) -> Surface:
    """Return the surface of an obstacle in the world. It faces the side where the body may be.

    Parameters
    ----------
    obstacle : Primitive or Mesh
        A mesh that is not watertight has no inside; its faces face as they are given.
    middle : ndarray (3,)
        A half-space has no end: a square is drawn where it is nearest to this place.
    span : float
        Side of that square.
    around : int
        Faces around what is round.
    pieces : int
        Faces along an edge of a box or square, and along the wall of a cylinder or capsule.
    """
    if isinstance(obstacle, Mesh):
        surface = Surface(obstacle.vertices, obstacle.faces[:, [0, 1, 2, 2]])
        return surface.flipped() if obstacle.inside else surface
    if isinstance(obstacle, HalfSpace):
        near = middle - (middle - obstacle.point) @ obstacle.normal * obstacle.normal
        return square(0.5 * span, pieces).moved(obstacle.frame.rotation, near)
    if not isinstance(obstacle, Primitive):
        raise NotImplementedError(f"no picture of {type(obstacle).__name__}")
    center, rotation, half, _ = obstacle.frame
    match obstacle:
        case Sphere(radius=radius):
            local = sphere(radius, around)
        case Box():
            local = box(half, pieces)
        case Capsule(radius=radius):
            local = capsule(radius, float(half[2]), around, pieces)
        case Cylinder(radius=radius):
            local = cylinder(radius, float(half[2]), around, pieces)
        case _:
            raise NotImplementedError(f"no picture of {type(obstacle).__name__}")
    surface = local.moved(rotation, center)
    return surface.flipped() if obstacle.inside else surface


def points_of(obstacle: Dotted) -> Floats:
    """Points (m, 3) of a cloud, or on the surface of a grid or field."""
    if isinstance(obstacle, PointCloud):
        points = obstacle.points
    elif isinstance(obstacle, Grid) and obstacle.occupancy:
        points = obstacle.points(np.argwhere(_outermost(obstacle.values.astype(np.bool_))))
    else:
        points = obstacle.points(_crossings(obstacle.values))
    return points[:: -(-len(points) // MOST_POINTS)] if len(points) > MOST_POINTS else points


def _outermost(occupied: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Occupied cells that have a free one at one of their six faces."""
    around = np.pad(occupied, 1)
    buried = np.ones_like(occupied)
    for axis in range(3):
        for step in (-1, 1):
            buried &= np.roll(around, step, axis)[1:-1, 1:-1, 1:-1]
    return np.asarray(occupied & ~buried)


def _crossings(values: Floats) -> Floats:
    """Places (m, 3), in steps of the grid, where neighbours along an axis differ in sign, by linear interpolation."""
    found = []
    for axis in range(3):
        near = np.delete(values, -1, axis)
        rise = np.diff(values, axis=axis)
        at = np.argwhere((near > 0.0) != (near + rise > 0.0))
        places = at.astype(np.float64)
        places[:, axis] -= near[tuple(at.T)] / rise[tuple(at.T)]
        found.append(places)
    return np.concatenate(found)


BANDS_PER_SEGMENT = 12
"""Bands along a segment; each segment of a robot of many has fewer."""

MOST_BANDS = 240
"""Bands along the whole body, but for robots with more segments than that, which have one a segment."""

CAP_BANDS = 6
"""Bands of the half balls in which the body ends."""

FLANGE_RADII, PLATE_RADII = 1.6, 0.5
"""Radius and thickness of the plate that the robot stands on, in radii of its first segment."""

SLEEVE_RADII = 1.25
"""Radius of the sleeve over the mount, in radii of the first segment."""

DRUM_RADII, ROD_RADII = (0.8, 1.2), 0.45
"""Radius and half height of a joint that turns, and radius of a rod, in radii of its link."""

TOOL_RADII = 0.3
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
        wanted = max(1, min(BANDS_PER_SEGMENT, MOST_BANDS // len(robot))) if along is None else along
        steps = max(1, -(-wanted // pieces))
        self.robot, self.per_segment, self.parts = robot, pieces * steps, list[ColouredPart]()
        self._around, self._circle, self._rings = around, circle(around), list[Ring]()
        radii = [share * max(radius, least_radius) for radius in robot.radii]
        self._last = len(robot) * self.per_segment
        self._turned: list[tuple[int, Floats]] = []  # frames that rigid parts lie about: of the body, turned by a pose
        self._begin = len(robot.rows) - len(robot.segments)
        self._mounted = _segments_within(robot, robot.mount) if fittings else 0
        self._reach = float(np.linalg.norm(robot.tool[:3, 3])) if fittings else 0.0
        for k, row in enumerate(robot.rows):
            if isinstance(row, RigidRow):
                self._add_rigid(k, row, radii, pieces, share * least_radius)
                continue
            for first in range(k * self.per_segment, (k + 1) * self.per_segment, steps):
                self._add_piece(k, radii[k], first, first + steps)
        if fittings:
            self._add_rods(radii, share * least_radius)
            self._add_fittings(_thickness(robot, 0, radii), radii[-1])
        self._frame, self._radius, self._ahead = (np.array(column) for column in zip(*self._rings, strict=True))

    def _add_piece(self, segment: int, radius: float, first: int, last: int) -> None:
        """Add a tube about these frames; the body ends in half balls."""
        rings = [Ring(i, radius, 0.0) for i in range(first, last + 1)]
        angles = [0.5 * math.pi * i / CAP_BANDS for i in range(1, CAP_BANDS + 1)]
        if first == self._begin * self.per_segment:
            rings = [Ring(first, radius * math.cos(a), -radius * math.sin(a)) for a in reversed(angles)] + rings
        if last == self._last:
            rings += [Ring(last, radius * math.cos(a), radius * math.sin(a)) for a in angles]
        self._add(segment, rings)

    def _add_rigid(self, k: int, row: RigidRow, radii: list[float], pieces: int, least: float) -> None:
        """Add a capsule of a link, a drum about the axis of a joint that turns, or the rod that one slides along."""
        begin = k * self.per_segment
        if row.has_body:
            length, r = row.length[1], radii[k]
            low, high = arc(r, -0.5 * math.pi, 0.0, CAP_BANDS), arc(r, 0.0, 0.5 * math.pi, CAP_BANDS)
            rings = [Ring(begin, size, ahead) for size, ahead in low.tolist()]
            rings += [Ring(begin, size, length + ahead) for size, ahead in high.tolist()]
        elif row.joint < 0:
            rings = [Ring(begin, 0.0, 0.0)] * 2
        else:
            size = max(2.0 * least, _thickness(self.robot, row.link, radii))
            if row.length[1] > 0.0:
                back = np.asarray(np.linalg.inv(row.tail), np.float64)
                end = self._turn(begin + self.per_segment, back)
                rings = [
                    Ring(at, size * ROD_RADII * wide, 0.0) for at, wide in ((begin, 0), (begin, 1), (end, 1), (end, 0))
                ]
            else:
                turned = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])  # z is the y axis here
                about = self._turn(begin, turned)
                ends = ((-1.0, 0.0), (-1.0, 1.0), (1.0, 1.0), (1.0, 0.0))
                rings = [Ring(about, size * DRUM_RADII[0] * wide, size * DRUM_RADII[1] * ahead) for ahead, wide in ends]
        self._add(k, rings)
        for _ in range(1, pieces):
            self._add(k, [Ring(begin, 0.0, 0.0)] * 2)

    def _add_rods(self, radii: list[float], least: float) -> None:
        """Add rods between the joints of links that have no body."""
        rows = [row for row in self.robot.rows if isinstance(row, RigidRow)]
        with_body = {row.link for row in rows if row.has_body}
        for k, row in enumerate(rows):
            back = np.asarray(np.linalg.inv(row.tail), np.float64)
            length = float(np.linalg.norm(back[:3, 3]))
            if row.link not in with_body and length > 0.0:
                towards = np.eye(4)
                towards[:3, :3] = least_rotation(back[:3, 3] / length)
                at = self._turn((k + 1) * self.per_segment, towards)
                size = max(least, ROD_RADII * _thickness(self.robot, row.link, radii))
                self._add(None, [Ring(at, size, 0.0), Ring(at, size, length)])

    def _turn(self, frame: int, pose: Floats) -> int:
        """Number of a frame of the body that is turned by a pose (4, 4)."""
        self._turned.append((frame, pose))
        return self._last + len(self._turned)

    def _add_fittings(self, first: float, last: float) -> None:
        """Add the flange behind the half ball of the base, the sleeve and the tool; two equal rings make an edge."""
        before = Ring(0, FLANGE_RADII * first, -first)
        behind = before._replace(ahead=-(1.0 + PLATE_RADII) * first)
        ends = behind._replace(radius=0.0), before._replace(radius=0.0)
        self._add(None, [ends[0], behind, behind, before, before, ends[1]])
        frame = self._last + 1 + len(self._turned)
        if self._mounted:
            own = SLEEVE_RADII * (_thickness(self.robot, None, [*self.robot.radii]) or first)
            begin = frame + self._begin * self.per_segment
            sleeve = [Ring(begin + i, own, 0.0) for i in range(self._mounted * self.per_segment + 1)]
            self._add(None, [*sleeve, sleeve[-1], sleeve[-1]._replace(radius=0.0)])
            frame = sleeve[-1].frame + 1
        if self._reach > 0.0:
            outline = ((1.0, 0.0), (0.8, 0.7), (0.0, 1.0))
            self._add(None, [Ring(frame, TOOL_RADII * last * size, self._reach * share) for size, share in outline])

    def _add(self, segment: int | None, rings: list[Ring]) -> None:
        band = np.array([ring != following for ring, following in pairwise(rings)])
        faces = ring_faces(len(rings), self._around).reshape(len(band), -1, 4)[band].reshape(-1, 4)
        self.parts.append(ColouredPart(segment, slice(len(self._rings), len(self._rings) + len(rings)), faces))
        self._rings += rings

    def vertices(self, q: Floats) -> list[Floats]:
        """Vertices (T, v, 3) of every part in configurations (T, n, 3)."""
        known = [
            _frames(
                self.robot,
                np.repeat(np.asarray(q, np.float64) / self.per_segment, self.per_segment, axis=1),
                self.per_segment,
            )
        ]
        known += [_turned(known[0][:, frame], pose)[:, None] for frame, pose in self._turned]
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
        own = np.asarray(q, np.float64)[:, : self._begin + self._mounted]
        begins = np.cumsum(own[:, self._begin :, 2], axis=1) - own[:, self._begin :, 2]
        share = np.ones(own.shape[:2])  # joints and links are where they are
        within = (self.robot.mount - begins) / np.maximum(own[:, self._begin :, 2], 1e-300)
        share[:, self._begin :] = np.clip(within, 0.0, 1.0)
        fine = np.repeat(share[..., None] * own / self.per_segment, self.per_segment, axis=1)
        return _frames(self.robot, fine, self.per_segment)


def _segments_within(robot: Robot, length: float) -> int:
    """How many segments may begin within this length of backbone from where the first one begins."""
    begins = np.cumsum([0.0, *(segment.length[0] for segment in robot.segments[:-1])])
    return int((begins < length).sum()) if robot.segments else 0


def _thickness(robot: Robot, link: int | None, radii: list[float]) -> float:
    """Radius, of these of all rows, of the thickest capsule of a link; without any, that of the first segment."""
    own = [
        radius
        for row, radius in zip(robot.rows, radii, strict=True)
        if isinstance(row, RigidRow) and row.has_body and row.link == link
    ]
    return max(own) if own else radii[len(robot.rows) - len(robot.segments)] if robot.segments else radii[-1]


def _turned(frames: Floats, pose: Floats) -> Floats:
    """Frames (T, 12) turned and shifted by a pose that they see."""
    rotation = frames[:, :9].reshape(-1, 3, 3)
    place = frames[:, 9:] + rotation @ pose[:3, 3]
    return np.concatenate([(rotation @ pose[:3, :3]).reshape(-1, 9), place], axis=-1)


def _frames(robot: Robot, arcs: Floats, per: int = 1) -> Floats:
    """Frames (T, m + 1, 12) at the base and at the ends of arcs (T, m, 3), `per` of them a segment."""
    from sinuous.kernels.chain import batch  # noqa: PLC0415

    frames = np.empty((len(arcs), arcs.shape[1] + 1, 12))
    batch.frames_of(
        packing.fine_rows(robot.limits, per), np.ascontiguousarray(arcs), packing.pose_row(robot.base), frames
    )
    return frames


def _tool_frames(robot: Robot, tips: Floats) -> Floats:
    """Frames (T, 1, 12) at the tip, where `tips` are those of the body, with z towards the point of the tool."""
    place = robot.tool[:3, 3]
    towards = np.eye(4)
    towards[:3, :3] = least_rotation(place / np.linalg.norm(place))
    return _turned(tips[:, 0], towards)[:, None]
