"""The boundary between nouns and kernels: the layout of every table, and the numbers that stand for words.

This module alone owns columns, widths, codes and kinds. `kernels.packing` writes the tables, kernels read them, and
both use the names below. All tables are float64 and C-contiguous. What belongs together travels as one *group*, a
single flat array, because every array that Python hands to a compiled function costs 0.08 us, and a tuple of arrays
more:

- the robot: `[n, p, avoid]`, rows of its n segments, rows of its p actuator limits, poses of base and tool;
- the scene: `[m]`, rows of its m obstacles, then the store: a hierarchy of many, and all numbers that rows point to;
- the settings: one number for each name below, then the options of the method;
- the targets: a table (t, 15), the only group with two axes.

Lengths are in the length unit of the user, angles in rad.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

# --- the robot group -------------------------------------------------------------------------------------------------

ROBOT_HEADER = 3
"""Numbers before the rows of the segments: how many segments, how many actuator limits, and 1 where the body must not
run through itself, else 0."""

MIN_LENGTH, MAX_LENGTH, MAX_BEND, MAX_CURVATURE, RADIUS, BEND_SCALE, LENGTH_SCALE, SELF_RADIUS = range(8)
"""Columns of a segment. Limits of its length, bend (rad) and curvature; the radius within which its body needs to be
free of obstacles, with the clearance that is demanded; scales of a bend (rad) and of a length in which motion is
measured (0: that coordinate cannot move); and the radius within which it needs to be free of the body itself.

`MAX_BEND` bounds the norm of the bend, whatever it is that holds it."""

IN_PLANE, REST, PLANE, LOW_BEND, HIGH_BEND, HOME = 8, 9, 11, 13, 14, 15
"""Further columns of a segment. 1 where its bend is `rest + z plane`, with a rest (2, rad) that is perpendicular to the
unit vector `plane` (2) and z from the low to the high bend (rad), both the same where it is locked; 0 where it may bend
to all sides. Home (3) is where segments go to when limits of actuators are to be kept, which they are there: bend (2)
and length, or -1 where any length will do."""

RIGID, TAIL, TAIL_LENGTH, BODY, TOUCHES, ONWARD = 18, 19, 31, 32, 33, 34
"""Further columns of what stands before the first segment: joints, as segments without length that bend in one plane
(revolute) or are straight (prismatic), and capsules of links, as straight segments. RIGID: 0 where the row is one of a
segment; else, and the mount does not concern it, 1 of a joint and LINK of what does not move against the one before.
TAIL: the pose (12) in the frame of its end in which the next row begins, and how far that is from the end
(TAIL_LENGTH). BODY: number of the link that it belongs to; a row without a body has a negative `SELF_RADIUS`. TOUCHES:
of a link, the sum of `2 ** BODY` of those that it may touch. ONWARD: how far the row begins from where the last joint
before it ends, which is where a link is measured from; of a `LINK`, how far anything of it is from there."""

LINK = 2.0
"""`RIGID` of a capsule of a link, and of a place."""

SEGMENT_WIDTH = 35

FIRST_SEGMENT, LAST_SEGMENT, WEIGHTS, MIN_VALUE, MAX_VALUE = 0, 1, 2, 5, 6
"""Columns of an actuator limit. It bounds `weights . (bend_x, bend_y, length)` (3 weights), summed from the first
segment to the last. A chamber sees one segment; a tendon all segments from 0 to its last. Rows are in the order of
their last."""

ACTUATOR_WIDTH = 7

POSE_ROTATION, POSE_POSITION = 0, 9
"""Columns of a pose: rotation (9, row by row) and position (3)."""

POSE_WIDTH = 12

# --- the scene group -------------------------------------------------------------------------------------------------

SCENE_HEADER = 1
"""Numbers before the rows of the obstacles: how many there are."""

SPHERE, BOX, CYLINDER, HALF_SPACE, TREE, SAMPLES = range(6)
"""Kinds of obstacles. Primitives come before TREE: code tests `KIND < TREE`, so a new one is put before it. TREE:
triangles, balls or cubes in a tree of boxes, perhaps with samples. SAMPLES: samples alone."""

KIND, SIGN = 0, 1
"""First columns of every obstacle: its kind; 1, or -1 where the body must stay inside."""

CENTER, AXES, HALF_EXTENTS = 2, 5, 14
"""Columns of a primitive: center (3), rotation (9, its columns are the obstacle's axes in the world), half extents
(3)."""

ROUNDING_RADIUS = 17
"""Column of every obstacle: what is taken off the distance."""

ROUNDOFF = 18
"""Column of every obstacle: what arithmetic may make its distances wrong by, for the size of the coordinates that are
subtracted (length unit); what comes from those of the robot is not in it."""

EXTENT = 19
"""Column of a primitive: radius of a ball about its center that holds it, `ROUNDING_RADIUS` included; inf where there
is none, and where the body must stay inside."""

NODES, LEVELS, ITEMS, ITEM_COUNT, ITEM_KIND, NORMALS = range(2, 8)
"""Columns of a TREE. Where its nodes begin in the store, and its levels; where its items begin, their number and kind;
where their normals begin (-1: triangles without an inside)."""

FIRST_SAMPLE, SHAPE, ORIGIN, SPACING = 8, 9, 12, 15
"""Columns of whatever has samples: where they begin in the store (-1: there are none), how many along every axis (3),
the place of the first (3), and the distance between neighbours."""

CUBE_HALF = 16
"""Column of a TREE of cubes: half of their edge."""

EXACT_BELOW = 16
"""Column of SAMPLES: the value from which on they are lower bounds of a distance only. Below it they are distances, and
so are those that are not above 0, as far as an upper bound is asked for."""

PLACED, PLACE = 19, 20
"""Columns of whatever is in the store: 1 where it lies there as it is described, in a frame of its own, and has been
moved; and the pose of that frame in the world, as `POSE_ROTATION` and `POSE_POSITION` lay it out (12)."""

FIRST_CELL = 32
"""Column of a TREE of triangles: where the cells begin in the store that list which may be the closest (-1: there are
none). SHAPE, ORIGIN and SPACING are then of their middles: who has cells has no samples."""

OBSTACLE_WIDTH = 33

MANY_OBSTACLES = 48
"""From so many obstacles on, the store begins with a hierarchy: a tree of boxes about all of them. With fewer it takes
longer to walk than to ask everyone."""

(
    HIERARCHY_OBSTACLES,
    HIERARCHY_LEVELS,
    HIERARCHY_BOXES,
    HIERARCHY_BESIDE,
    HIERARCHY_WORK,
    HIERARCHY_ROUNDOFF,
    HIERARCHY_SPACING,
    HIERARCHY_CHANGES,
    HIERARCHY_CELLS,
    HIERARCHY_HEADER,
) = range(10)
"""First places of the store of many obstacles: their number; levels of the tree; how many boxes are in its leaves, one
each at most; how many obstacles are beside it; work units of a query; the largest `ROUNDOFF` and the largest spacing of
samples of all; how many obstacles were changed since it was made; and where cells begin that list who is near (0: there
are none), see `kernels.fields.scene_cells`: last in the store, because they are left out where an obstacle changes.

After this header follow the numbers of the obstacles that are beside the tree, because they have no end or move; the
number of the obstacle of each box, which may have several; and the nodes, of `kernels.fields.eight_boxes` eight a
block."""

FEWEST_SAMPLED = 500
"""Triangles from which on a mesh is sampled wherever it stands: the exact distance to fewer is nearly as quick, see
`kernels.fields.candidates`. Where there are very many, those have a few samples, too."""

TRIANGLES, BALLS, CUBES = range(3)
"""Kinds of items."""

TRIANGLE_SIZE, TRIANGLE_NORMAL, TRIANGLE_OFFSET = 13, 9, 12
"""Numbers of a triangle: its corners (9), the unit normal of its plane (3), and how far that is from the origin."""

NORMALS_SIZE = 21
"""Numbers of the normals of a triangle, in the order of its parts: inside, edges ab, bc, ca, corners a, b, c."""

BALL_SIZE, CUBE_SIZE = 4, 3
"""Numbers of a ball (center, radius) and of a cube (center)."""

NODE_SIZE = 6
"""Numbers of a node of a tree: the low and the high corner of its box."""

LEAF_ITEMS = 4
"""Most items of a leaf of a tree."""

# --- the targets -----------------------------------------------------------------------------------------------------

TARGET_SEGMENT, HAS_POSITION, TARGET_POSITION, ORIENTATION, GOAL = 0, 1, 2, 5, 6
"""Columns of a target: the segment whose end is meant (from 0; -1: the last), whether a position is asked for, that
position (3), what is asked of the orientation, and the direction (3) or rotation (9, row by row)."""

FREE, DIRECTION, ROTATION = range(3)
"""What may be asked of the orientation."""

TARGET_WIDTH = 15

# --- the settings ----------------------------------------------------------------------------------------------------

(
    MOUNT,
    UNIT,
    MARGIN,
    POSITION_TOLERANCE,
    ANGLE_TOLERANCE,
    COARSE_DEPTH,
    STEP_DEPTH,
    MAX_ITERATIONS,
    INITIAL_WEIGHT,
    BENDS_WEIGHT,
    WISHED_CLEARANCE,
    CLEARANCE_MARGIN,
) = range(12)
"""Places in the settings: length of backbone that obstacles do not concern; mean length of the robot; clearance that
steps aim for; tolerances; how often a segment is halved in the search for contacts, at a glance and in a step; most
iterations from one start; the preferences: weights of staying close to the initial configuration and of small bends,
and the clearance that is wished for; and the clearance that an answer in contact is given where that costs nothing."""

METHOD_OPTIONS = 12
"""Place of the first option of the method."""

Budget = tuple[int, int, int, float]
"""What a search may spend: numbers of its own starts, from the first up to, without it, the last; the seed of the
scattered ones; and seconds."""

# --- the query of a route search ------------------------------------------------------------------------------------

QUERY_ORIGIN, QUERY_AXIS, QUERY_GOAL, QUERY_BACK, QUERY_NORMAL = 0, 3, 6, 9, 12
"""Where routes begin, and the unit tangent there; where they end, and the unit vector to where they come from there
(zero: from anywhere); and the unit normal of the plane that they stay in (zero: anywhere)."""

(
    QUERY_GOAL_RADIUS,
    QUERY_GOAL_SLACK,
    QUERY_RADIUS,
    QUERY_SHORTEST,
    QUERY_LONGEST,
    QUERY_FREE_LENGTH,
    QUERY_CELL,
    QUERY_CLEARANCE,
    QUERY_FREE_MARGIN,
    QUERY_MOST_CELLS,
    QUERY_PROVE,
) = range(15, 26)
"""How far from the goal a route may end, and how much farther a proof has to grant; radius of what moves along the
route, and its least length; the longest route; length from the origin that obstacles do not concern. Edge of the cells;
distance from obstacles with which a cell can be passed; room beyond the radius that costs nothing; most cells that a
search meets, a power of two; whether to prove that there is no route where none is found."""

QUERY_WIDTH = 26

FOUND, CLOSED, FULL, TIMED_OUT, PROVED_CLOSED = range(5)
"""How a route search ended: with a route; without; its table was full; its time was up; without, and it is proved that
there is none for any body of this radius, whatever its tangents."""

# --- the outcome -----------------------------------------------------------------------------------------------------

SOLVED, UNPROVED, FAILED, LATE, OUT_OF_REACH, TARGET_BLOCKED, BASE_BLOCKED, NO_ROUTE, RATE_BOUND = range(9)
"""How a search ended. From OUT_OF_REACH to NO_ROUTE: proved impossible. RATE_BOUND: out of reach in one control
step."""

GIVEN, ARC, RANDOM, ROUTE, REMEMBERED = range(5)
"""Sources of starts."""

SOURCES = ("given", "arc", "random", "route", "remembered")
"""Their names, in the same order."""

CODE, ITERATIONS, STARTS, SOURCE, POSITION_ERROR, ANGLE_ERROR, CLEARANCE, SELF_CLEARANCE, BOUND, MERIT, SECONDS = range(
    11
)
"""Columns of the record of a search, in the order of the fields of `Outcome`."""

RECORD_WIDTH = 11


class Outcome(NamedTuple):
    """What a search found for one problem.

    Attributes
    ----------
    q : ndarray (n, 3)
        The best configuration.
    code : int
        How the search ended: SOLVED, UNPROVED, ...
    iterations, starts : int
        Iterations of all starts, and how many starts there were.
    source : int
        Where the best start came from: GIVEN, ARC, ...
    position_error, angle_error : float
        Largest over the targets, length unit and rad.
    clearance : float
        Proved when it is solved, else the least that was seen.
    self_clearance : float
        The same of the body from itself; infinite where that does not matter, or nobody examined it.
    bound : bool
        Whether limits stopped the best start.
    merit : float
        What is left of its residual, squared.
    seconds : float
    cell : float
        Edge of the cells by which it was proved that there is no route; NaN otherwise.
    route : ndarray (k, 3) or None
        Points of the route that the solved start was laid along; `None` where it came from elsewhere.
    """

    q: NDArray[np.float64]
    code: int
    iterations: int
    starts: int
    source: int
    position_error: float
    angle_error: float
    clearance: float
    self_clearance: float
    bound: bool
    merit: float
    seconds: float
    cell: float = float("nan")
    route: NDArray[np.float64] | None = None

    @classmethod
    def from_record(cls, q: NDArray[np.float64], record: list[float]) -> "Outcome":
        """Make it of one record, where whole numbers and truth values are floats too."""
        code, iterations, starts, source, off, turn, clearance, own, bound, merit, seconds = record
        counts = int(code), int(iterations), int(starts), int(source)
        return cls(q, *counts, off, turn, clearance, own, bool(bound), merit, seconds)

    def write(self, answer: NDArray[np.float64]) -> None:
        """Write it as one answer of a batch (11 + 3 n,): its record, then its configuration."""
        answer[:RECORD_WIDTH] = self[1 : RECORD_WIDTH + 1]
        answer[RECORD_WIDTH:] = self.q.ravel()


def answer_size(segments: int) -> int:
    """Numbers of one answer in a batch: its record, then its configuration."""
    return RECORD_WIDTH + 3 * segments
