"""How numbers are laid out for the kernels: the one place that fills the tables of `sinuous.kernels.tables`.

This is the boundary of nouns and kernels. Below it there are rows of numbers, above it robots, scenes and targets. It
knows no noun: each noun hands over its numbers (`sinuous.model.robot.robot_group`,
`sinuous.problem.problem.settings_group`, `Target`, the obstacles, `Snapshot`).

Rows are returned as new arrays. Kernels are compiled for writable arrays alone; whoever keeps a table and shows it to
users keeps the array for itself and shows a read-only view of it.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from sinuous.base.checks import Floats, closed
from sinuous.kernels import tables as t

ITERATIONS = 60
"""Most iterations from one start."""

COARSE_DEPTH = 0
"""How often a segment is halved in the search for contacts where starts are compared at a glance."""

STEP_DEPTH = 3
"""How often a segment is halved in the search for contacts in a step."""

ROUNDOFF = 1e-13
"""What arithmetic may make of a distance, relative to the coordinates that are subtracted."""

MARGIN = 1e-4
"""Clearance that steps aim for beyond none, of the robot's mean length: room for the proof to decide."""


def read_only(array: Any) -> Any:
    """Return a view of an array that cannot be written to."""
    view = array.view()
    view.flags.writeable = False
    return view


class BendLine(NamedTuple):
    """The bends of a segment in one plane, `rest + z plane`; all in rad but the unit vector `plane`.

    `rest` is perpendicular to `plane`. Where the bend is locked, `low` and `high` are the same.
    """

    rest: tuple[float, float]
    plane: tuple[float, float]
    low: float
    high: float

    def at(self, z: float) -> tuple[float, float]:
        """The bend with this coordinate in the plane."""
        return self.rest[0] + z * self.plane[0], self.rest[1] + z * self.plane[1]

    def nearest(self, bends: Floats) -> Floats:
        """Of bends (..., 2), the nearest ones here."""
        along = np.clip(bends @ np.array(self.plane), self.low, self.high)
        result: Floats = np.array(self.rest) + along[..., None] * np.array(self.plane)
        return result

    def distance(self, bends: Floats) -> Floats:
        """How far bends (..., 2) are from here, in rad."""
        away = bends - self.nearest(bends)
        return np.hypot(away[..., 0], away[..., 1])

    @property
    def largest(self) -> float:
        """Largest norm of the bends."""
        return max(math.hypot(*self.at(self.low)), math.hypot(*self.at(self.high)))

    @property
    def home(self) -> tuple[float, float]:
        """The bend of least norm."""
        return self.at(min(max(0.0, self.low), self.high))


ANY_LENGTH = (0.0, 0.0, -1.0)
"""Home of a segment that is within the limits of actuators wherever it is straight."""


def segment_row(
    length: tuple[float, float],
    bends: float | BendLine,
    max_curvature: float,
    radius: float,
    self_radius: float,
    home: tuple[float, float, float] = ANY_LENGTH,
) -> list[float]:
    """Return the row of a segment; what cannot move has the scale 0.

    `bends` is the largest bend, to all sides, or where it may bend to. Within `radius` of its backbone no obstacle may
    be; two of its `self_radius` may not overlap.
    """
    low, high = length
    row = [0.0] * t.SEGMENT_WIDTH
    row[t.MIN_LENGTH], row[t.MAX_LENGTH], row[t.MAX_CURVATURE] = low, high, max_curvature
    if isinstance(bends, BendLine):
        row[t.MAX_BEND] = bends.largest
        row[t.BEND_SCALE] = 1.0 if bends.low < bends.high else 0.0
        row[t.IN_PLANE], row[t.LOW_BEND], row[t.HIGH_BEND] = 1.0, bends.low, bends.high
        row[t.REST : t.REST + 2], row[t.PLANE : t.PLANE + 2] = bends.rest, bends.plane
    elif bends > 0.0 and max_curvature > 0.0 and high > 0.0:
        row[t.MAX_BEND], row[t.BEND_SCALE] = bends, 1.0
    row[t.HOME : t.HOME + 3] = home
    row[t.RADIUS], row[t.SELF_RADIUS] = radius, self_radius
    row[t.LENGTH_SCALE] = 0.5 * (low + high) if high > low else 0.0
    return row


def make_rigid(row: list[float], tail: Floats, link: int, touches: int, joins: bool) -> None:
    """Make a row that of a joint, or (not `joins`) of a capsule of a link: see `tables.RIGID`.

    `tail` (4, 4) is where the next row begins, in the frame of its end; `touches` the sum of `2 ** link` of those that
    its link may touch.
    """
    row[t.RIGID], row[t.BODY], row[t.TOUCHES] = 1.0 if joins else t.LINK, float(link), float(touches)
    row[t.TAIL : t.TAIL + t.POSE_WIDTH] = pose_row(tail)[0].tolist()
    row[t.TAIL_LENGTH] = float(np.linalg.norm(tail[:3, 3]))


def scales_of(limits: Floats) -> Floats:
    """Scales (n, 3) in which coordinates of segments (n, 35) count: 1 rad, and mean lengths; 0 for what cannot move.

    Where a segment bends in one plane, the first coordinate is the bend in it: see `turns_of`.
    """
    scales = limits[:, [t.BEND_SCALE, t.BEND_SCALE, t.LENGTH_SCALE]]
    scales[limits[:, t.IN_PLANE] != 0.0, 1] = 0.0
    return scales


def turns_of(limits: Floats) -> Floats:
    """What turns the coordinates of `scales_of`, of segments (n, 35), into configurations: orthogonal (3 n, 3 n)."""
    turns = np.eye(3 * len(limits))
    for k in np.flatnonzero(limits[:, t.IN_PLANE]):
        x, y = limits[k, t.PLANE : t.PLANE + 2]
        turns[3 * k : 3 * k + 2, 3 * k : 3 * k + 2] = (x, -y), (y, x)
    return turns


def plain_rows(count: int) -> Floats:
    """Return rows (n, 35) of segments of which only the kinematics is asked."""
    return np.zeros((count, t.SEGMENT_WIDTH))


def fine_rows(rows: Floats, per: int) -> Floats:
    """Return rows (n per, 35) of a robot whose rows (n, 35) are cut into `per` equal parts; tails come last."""
    fine: Floats = np.repeat(rows, per, axis=0)
    cut = np.arange(len(fine)) % per != per - 1
    fine[cut, t.RIGID] = fine[cut, t.TAIL_LENGTH] = 0.0
    fine[np.arange(len(fine)) % per != 0, t.ONWARD] = 0.0
    return fine


def actuator_row(first: int, last: int, weights: Sequence[float], limits: tuple[float, float]) -> list[float]:
    """Return the row of an actuator limit on segments `first` to `last`, counted from 0."""
    return [float(first), float(last), *weights, *limits]


def segment_table(rows: Sequence[Sequence[float]]) -> Floats:
    """Return the table (n, 35) of segments, base to tip; read-only."""
    return closed(np.array(rows, np.float64))


def actuator_table(rows: Sequence[Sequence[float]]) -> Floats:
    """Return the table (p, 7) of all limits of actuators, in the order of their last segment; read-only."""
    ordered = sorted(rows, key=lambda row: row[t.LAST_SEGMENT])
    return closed(np.array(ordered, np.float64).reshape(-1, t.ACTUATOR_WIDTH))


def pose_row(matrix: Floats) -> Floats:
    """Return the row (1, 12) of a pose (4, 4)."""
    return np.concatenate([matrix[:3, :3].ravel(), matrix[:3, 3]])[None, :].copy()


class RobotParts(NamedTuple):
    """What the group of a robot is made of.

    Attributes
    ----------
    segments : ndarray (n, 35)
    actuators : ndarray (p, 7)
    base, tool : ndarray (12,)
        Poses.
    avoids_itself : float
        1 or 0.
    """

    segments: Floats
    actuators: Floats
    base: Floats
    tool: Floats
    avoids_itself: float

    def group(self) -> Floats:
        """Return the group that kernels read, a new array."""
        header = [float(len(self.segments)), float(len(self.actuators)), self.avoids_itself]
        return np.concatenate([header, self.segments.ravel(), self.actuators.ravel(), self.base, self.tool])


def robot_group(limits: Floats, actuation: Floats, base: Floats, tool: Floats, avoids_itself: bool) -> Floats:
    """Return the group of a robot, of its tables (n, 35) and (p, 7), and the poses (4, 4) of base and tool."""
    return RobotParts(limits, actuation, pose_row(base)[0], pose_row(tool)[0], float(avoids_itself)).group()


def robot_parts(group: Floats) -> RobotParts:
    """Return what the group of a robot is made of, as views."""
    rows = group[t.ROBOT_HEADER : -2 * t.POSE_WIDTH]
    end = t.SEGMENT_WIDTH * int(group[0])
    return RobotParts(
        rows[:end].reshape(-1, t.SEGMENT_WIDTH),
        rows[end:].reshape(-1, t.ACTUATOR_WIDTH),
        group[-2 * t.POSE_WIDTH : -t.POSE_WIDTH],
        group[-t.POSE_WIDTH :],
        float(group[2]),
    )


def primitive_row(
    kind: int, inside: bool, center: Floats, axes: Floats, half_extents: Any, rounding: float = 0.0
) -> Floats:
    """Return the row (33,) of a sphere, box, cylinder or half-space."""
    row = np.zeros(t.OBSTACLE_WIDTH)
    row[t.KIND], row[t.SIGN], row[t.ROUNDING_RADIUS] = kind, -1.0 if inside else 1.0, rounding
    row[t.CENTER : t.CENTER + 3] = center
    row[t.AXES : t.AXES + 9] = np.ravel(axes)
    row[t.HALF_EXTENTS : t.HALF_EXTENTS + 3] = half_extents
    row[t.ROUNDOFF] = roundoff(np.abs([center]) + np.abs([half_extents]), rounding)
    endless = inside or kind == t.HALF_SPACE
    row[t.EXTENT] = math.inf if endless else np.linalg.norm(row[t.HALF_EXTENTS : t.HALF_EXTENTS + 3]) + rounding
    return row


def primitive_rows(
    kinds: Floats, inside: Floats, centers: Floats, axes: Floats, half_extents: Floats, roundings: Floats
) -> Floats:
    """Return rows (m, 33) of many primitives: the same, but for what arithmetic makes of them."""
    rows = np.zeros((len(kinds), t.OBSTACLE_WIDTH))
    rows[:, t.KIND], rows[:, t.SIGN], rows[:, t.ROUNDING_RADIUS] = kinds, np.where(inside, -1.0, 1.0), roundings
    rows[:, t.CENTER : t.CENTER + 3], rows[:, t.AXES : t.AXES + 9] = centers, axes.reshape(-1, 9)
    rows[:, t.HALF_EXTENTS : t.HALF_EXTENTS + 3] = half_extents
    rows[:, t.ROUNDOFF] = ROUNDOFF * ((np.abs(centers) + np.abs(half_extents)).sum(axis=1) + roundings)
    rows[:, t.EXTENT] = np.sqrt((half_extents**2).sum(axis=1)) + roundings
    rows[(inside != 0.0) | (kinds == t.HALF_SPACE), t.EXTENT] = math.inf
    return rows


def roundoff(corners: Floats, more: float = 0.0) -> float:
    """What arithmetic may make of the distance to what lies among these corners (m, 3), rounded by `more`."""
    return ROUNDOFF * (float(np.abs(corners).max(axis=0).sum()) + more)


STORE_PLACES = [t.NODES, t.ITEMS, t.NORMALS, t.FIRST_SAMPLE, t.FIRST_CELL]
"""Columns of a row that say where something begins in the store."""


def scene_group(rows: Floats, stores: Sequence[Floats], hierarchy: Floats) -> Floats:
    """Return the group of a scene of rows (m, 33) and its hierarchy (h,), empty where there is none.

    Places in the rows count from the start of the obstacle's own store.
    """
    table = rows.copy()
    begins = len(hierarchy) + np.cumsum([0, *map(len, stores)])[:-1]
    moved = (table[:, t.KIND] >= t.TREE)[:, None] & (table[:, STORE_PLACES] >= 0.0)
    table[:, STORE_PLACES] += np.where(moved, begins[:, None], 0)
    kept = [store for store in stores if len(store)]
    # One number more than there is: an empty store would be another type of array to NumPy's slices.
    return np.concatenate([[float(len(table))], table.ravel(), hierarchy, *kept, [0.0]])


def with_row(group: Floats, index: int, before: tuple[Floats, Floats], now: tuple[Floats, Floats]) -> Floats | None:
    """Return the group of a scene in which one obstacle is another one, as `scene_group` would make it.

    `before` and `now`: its row and store, as they are given to that. The hierarchy stays as it is. `None` where only
    one of both is in the store: then the group has to be made anew.
    """
    (old, old_store), (row, store) = before, now
    if (len(old_store) > 0) != (len(store) > 0):
        return None
    end, begin = t.SCENE_HEADER + t.OBSTACLE_WIDTH * int(group[0]), 0
    if len(store):
        column = next(each for each in STORE_PLACES if old[each] >= 0.0)
        begin = int(scene_parts(group)[0][index, column] - old[column])
    at = end + begin
    if len(store) == len(old_store):
        made = group.copy()
        made[at : at + len(store)] = store
    else:
        made = np.concatenate([group[:at], store, group[at + len(old_store) :]])
        rows = scene_parts(made)[0]
        moved = (rows[:, t.KIND] >= t.TREE)[:, None] & (rows[:, STORE_PLACES] >= begin + len(old_store))
        rows[:, STORE_PLACES] += np.where(moved, len(store) - len(old_store), 0)
    table = scene_parts(made)[0]
    table[index] = row
    if row[t.KIND] >= t.TREE:
        table[index, STORE_PLACES] += np.where(row[STORE_PLACES] >= 0.0, begin, 0)
    return made


def scene_parts(group: Floats) -> tuple[Floats, Floats]:
    """Return the rows (m, 33) and the store (s,) of the group of a scene, as views."""
    end = t.SCENE_HEADER + t.OBSTACLE_WIDTH * int(group[0])
    return group[t.SCENE_HEADER : end].reshape(-1, t.OBSTACLE_WIDTH), group[end:]


def target_rows(count: int, positions: Floats | None, directions: Floats | None, rotations: Floats | None) -> Floats:
    """Return the rows (m, 15) of m targets of the last segment, of arrays (m, 3), (m, 3) and (m, 3, 3)."""
    rows = np.zeros((count, t.TARGET_WIDTH))
    rows[:, t.TARGET_SEGMENT] = -1
    if positions is not None:
        rows[:, t.HAS_POSITION] = 1.0
        rows[:, t.TARGET_POSITION : t.TARGET_POSITION + 3] = positions
    if directions is not None:
        rows[:, t.ORIENTATION], rows[:, t.GOAL : t.GOAL + 3] = t.DIRECTION, directions
    elif rotations is not None:
        rows[:, t.ORIENTATION], rows[:, t.GOAL : t.GOAL + 9] = t.ROTATION, rotations.reshape(-1, 9)
    return rows


def target_row(
    segment: int | None, position: Floats | None, direction: Floats | None, rotation: Floats | None
) -> Floats:
    """Return the row (1, 15) of a target; `segment` 1 = first, `None` the last."""
    row = target_rows(1, position, direction, rotation)
    if segment is not None:
        row[0, t.TARGET_SEGMENT] = segment - 1
    return row


def target_parts(row: Floats) -> tuple[int | None, Floats | None, Floats | None, Floats | None]:
    """Return segment, position, direction and rotation of a target, from its row (15,), as views: see `target_row`."""
    segment, orientation, goal = int(row[t.TARGET_SEGMENT]), int(row[t.ORIENTATION]), row[t.GOAL : t.GOAL + 9]
    position = row[t.TARGET_POSITION : t.TARGET_POSITION + 3] if row[t.HAS_POSITION] else None
    direction = goal[:3] if orientation == t.DIRECTION else None
    rotation = goal.reshape(3, 3) if orientation == t.ROTATION else None
    return None if segment < 0 else segment + 1, position, direction, rotation


def settings_group(
    *,
    mount: float,
    unit: float,
    position_tolerance: float | None,
    angle_tolerance: float,
    start_weight: float = 0.0,
    bends_weight: float = 0.0,
    clearance_wish: float = 0.0,
    options: Sequence[float] | Floats = (),
) -> Floats:
    """Return the settings of a solve, with the options of its method at their end; `unit` is the mean length."""
    values = {
        t.MOUNT: mount,
        t.UNIT: unit,
        t.MARGIN: MARGIN * unit,
        t.POSITION_TOLERANCE: position_tolerance,
        t.ANGLE_TOLERANCE: angle_tolerance,
        t.COARSE_DEPTH: COARSE_DEPTH,
        t.STEP_DEPTH: STEP_DEPTH,
        t.MAX_ITERATIONS: ITERATIONS,
        t.INITIAL_WEIGHT: start_weight,
        t.BENDS_WEIGHT: bends_weight,
        t.WISHED_CLEARANCE: clearance_wish,
        t.CLEARANCE_MARGIN: 0.0,
    }
    own = np.array([values[i] for i in range(t.METHOD_OPTIONS)], np.float64)
    return np.concatenate([own, np.asarray(options, np.float64)])


def plan_search(
    query: Floats, *, cell: float, clearance: float, free_margin: float, most_cells: int, prove: bool
) -> Floats:
    """Return the query (QUERY_WIDTH,) of a route search with these numbers put in; see `sinuous.kernels.tables`."""
    planned = query.copy()
    planned[t.QUERY_CELL], planned[t.QUERY_CLEARANCE], planned[t.QUERY_FREE_MARGIN] = cell, clearance, free_margin
    planned[t.QUERY_MOST_CELLS], planned[t.QUERY_PROVE] = most_cells, prove
    return planned
