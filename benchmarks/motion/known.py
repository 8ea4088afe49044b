"""Plans for which a motion is known: into places around hidden motions, from outside or from another shape there.

Hidden motions lead to a shape, within all limits, and nowhere near themselves. In one kind the straight body wanders
through random shapes. In the others the tip leads in: the body is drawn back from the hidden shape along itself. In one
of these the whole body is, as far as a share of its length, and straightened there. Backwards that is a way in that
sweeps little where the hidden shape ends. In the other only what is beyond a place of the shape slides back, to just
before that place, and nothing is straightened: backwards the body comes out of folds, through a hole at that place that
it hardly needs wider than it is. The least squares of that are NumPy's, and share nothing with the planner.

What is put around leaves room for all of it: balls, plates of bars, cells with doors, pipes.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from time import thread_time
from typing import NamedTuple
from zlib import crc32

import numpy as np
from numpy.random import Generator
from scipy.spatial import cKDTree

import sinuous as sn
from benchmarks.harness import Line, Plan, Trial, counted, in_processes, timed
from benchmarks.judges.judge import samples, wrong_in
from benchmarks.judges.kinematics import body_points, segment_ends
from benchmarks.judges.self_collision import look
from benchmarks.places import solids
from benchmarks.places.cells import WALL as WALLS
from benchmarks.places.cells import Cell, cells_back_to_back, common_wall, in_frame
from benchmarks.places.families import one_mesh
from benchmarks.places.parts import WALL, curve_of, draw_shape, longest, robot_of
from benchmarks.places.tubes import RINGS
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.scene.obstacles import Obstacle

WANDERING, LEADING, THREADING = "wandering", "leading", "threading"
KINDS = (WANDERING, LEADING, THREADING)

APART = 4.0
"""Distance of the shapes from themselves, in radii of the body."""

ROOM = 0.2
"""Clearance from itself that the whole motion has, in radii of the body."""

SHAPES, FEW = (2, 4), 9
"""Range of the shapes that a wandering body goes through, the last is where it ends; robots of so many segments or more
go to the last one at once, because they hardly ever get from one shape to another without running into themselves."""

BACK = (0.25, 0.6)
"""Range of the share of its length that a leading body is drawn back by."""

HOLE, OUT = (0.45, 0.8), 0.04
"""Range of the share of its length where the hole of a threading body is, and how far the tip is drawn out of it."""

BEFORE = 0.5
"""What is as near before the hole slides, too, in segments."""

STEP = 0.02
"""Of a body that is drawn back, in its lengths."""

ROUNDS, DAMPING, NUDGE = 4, 1e-3, 1e-6
"""Steps of the least squares for each step back; their damping, as a share; and the step of finite differences."""

CURVE_SAMPLES = 12
"""Intervals of a segment in the curve that it is drawn back along."""

LOOKS = 12
"""Configurations a step at most, and more than one where the motion is looked at whether it keeps clear of itself."""


def draw_motions(robot: Robot, kind: str, rng: Generator, another: bool) -> list[Floats]:
    """Draw the knots (T, n, 3) of a motion that is linear between them; see `keeps_apart`.

    With `another`, draw also one from where it begins to another shape of the same kind. Of threading bodies both
    shapes are alike up to the hole; where no segment is beyond it, there is one motion alone.
    """
    motion, hole = _draw_motion(robot, kind, rng)
    q = motion[-1]
    place = hole * float(q[:, 2].sum())
    alike = int((np.cumsum(q[:, 2]) < place).sum()) + 1 if kind == THREADING else 0
    if not another or alike >= len(q):
        return [motion]
    return [motion, np.concatenate([motion[:1], _draw_motion(robot, kind, rng, q[:alike], place)[0]])]


def _draw_motion(
    robot: Robot, kind: str, rng: Generator, first: Floats | None = None, place: float = 0.0
) -> tuple[Floats, float]:
    """Draw a motion, and the share of the length where its hole is; the first segments, and the place, may be given."""
    radius = max(robot.radii)
    count = int(rng.integers(*SHAPES)) if kind == WANDERING and len(robot) < FEW else 1
    shapes = [draw_shape(robot, APART * radius, rng, first=first) for _ in range(count)]
    if kind == THREADING:
        hole = place / float(shapes[0][:, 2].sum()) if place > 0.0 else rng.uniform(*HOLE)
        return np.stack(drawn_back(robot, shapes[0], 1.0 - hole + OUT, hole)[::-1]), hole
    if kind == LEADING:
        shapes = drawn_back(robot, shapes[0], rng.uniform(*BACK))[::-1]
    return np.stack([straight(robot), *shapes]), 0.0


def keeps_apart(robot: Robot, knots: Floats) -> bool:
    """Whether a motion through knots (T, n, 3) is nowhere near itself."""
    room = ROOM * max(robot.radii)
    return bool(look(robot, samples(knots, LOOKS), room).least.min() > room)


def straight(robot: Robot) -> Floats:
    """Return the straight robot (n, 3): every stage drawn in, every other segment at its mean length."""
    low, high, most = np.array([(*segment.length, segment.max_bend) for segment in robot.segments]).T
    return np.column_stack([np.zeros((len(low), 2)), np.where(most == 0.0, low, 0.5 * (low + high))])


def drawn_back(robot: Robot, q: Floats, share: float, hole: float | None = None) -> list[Floats]:
    """Return configurations (n, 3) from `q` to one whose tip is back by a share of the length.

    Ends of segments are to lie where the curve of `q` was so much before, the more the nearer they are to the tip; what
    would be behind the base is free. With a hole, at a share of the length, all ends beyond it count the same, and what
    is before it is free. Gauss and Newton, damped, with finite differences.
    """
    curve = curve_of(robot, q, CURVE_SAMPLES)
    ends, length = np.cumsum(q[:, 2]), float(curve.along[-1])
    weights, free = np.arange(1, len(q) + 1) / len(q), 0.0
    if hole is not None:
        weights, free = np.ones(len(q)), (hole - BEFORE / len(q)) * length
    found = [q]
    for by in np.arange(1, math.floor(share / STEP) + 1) * STEP * length:
        places = np.stack([np.interp(ends - by, curve.along, axis) for axis in curve.points.T], axis=-1)
        held = np.where(ends - by > free, weights, 0.0)
        held[-1] = 1.0
        new = found[-1]
        for _ in range(ROUNDS):
            new = _step(robot, new, places, held[:, None])
        found.append(new)
    return found


def _step(robot: Robot, q: Floats, places: Floats, weights: Floats) -> Floats:
    """Bring the ends of segments nearer to places (n, 3)."""
    flat = q.ravel()
    nudges = np.tile([NUDGE, NUDGE, NUDGE * robot.mean_length / len(q)], len(q))
    tried = (flat + np.vstack([np.zeros(len(flat)), np.diag(nudges)])).reshape(-1, *q.shape)
    seen = (weights * (segment_ends(robot, tried)[:, 1:, :3, 3] - places)).reshape(len(tried), -1)
    jacobian = ((seen[1:] - seen[0]) / NUDGE).T
    normal = jacobian.T @ jacobian
    normal[np.diag_indices_from(normal)] += DAMPING * np.trace(normal) / len(normal)
    change = nudges / NUDGE * np.linalg.solve(normal, jacobian.T @ seen[0])
    return _within_limits(robot, (flat - change).reshape(q.shape))


def _within_limits(robot: Robot, q: Floats) -> Floats:
    """Return the configuration (n, 3) with lengths and bends (3 n) no greater than they may be."""
    low, high, most = np.array([(*segment.length, segment.max_bend) for segment in robot.segments]).T
    bends = np.hypot(q[:, 0], q[:, 1])
    share = np.where(bends > most, most / np.maximum(bends, 1e-12), 1.0)
    return np.stack([share * q[:, 0], share * q[:, 1], np.clip(q[:, 2], low, high)], axis=-1)


BODY_SAMPLES = 10
"""Intervals of a segment where the body is looked at."""

LEAST_GAP, MOST_GAP = 0.2, 6.0
"""Range of the room that a ball leaves beside a shape on the way; cubes of an even draw, so that most are close."""

SMALLEST, LARGEST = 1.5, 5.0
"""Range of the radius of a ball."""

FROM = 0.3
"""Share of the motion after which balls are beside it: before, the robot is straight."""

FEWEST, MOST = 2, 4
"""Range of the number of plates."""

HALF, BAR, THICKNESS, OPEN = 10.0, 0.8, 0.5, 0.4
"""Half the edge of a plate; width of its bars; its thickness; and the least room beside the motion in its opening.

All but shares and numbers in radii of the body.
"""

BEYOND = (0.04, 0.1)
"""How far a door is beyond where the tip begins, in lengths of the hidden shape."""

GAP = (0.2, 0.45)
"""Least room beside the motion in a door and in a pipe, in radii of the body."""

WIDEST = 3.0
"""Half of the wider side of a door, and the inner radius of a pipe, at most, in radii of the body."""

FINE = 4
"""Frames along a pipe for each of its rings, where its width is measured."""

ENDS = (0.1, 0.5)
"""How far before the tip a pipe ends, in what of the hidden shape is beyond its beginning."""

ALONG = 1.0
"""How much farther than `WIDEST` from the axis of a pipe a body counts as one in it, in radii of the body."""

DRAWS = 400
"""Balls that are drawn for each that is wanted."""


Ways = Sequence[Floats]
"""Knots (T, n, 3) of motions that begin at the same configuration; walls are put about the first."""


def swept(robot: sn.Robot, ways: Ways) -> Floats:
    """Points (m, 3) of the backbone on all of the ways, that no place of it is far from."""
    points, _ = body_points(robot, np.concatenate([samples(knots) for knots in ways]), BODY_SAMPLES)
    return points.reshape(-1, 3)


def balls(robot: sn.Robot, ways: Ways, rng: Generator, count: int) -> list[sn.Sphere] | None:
    """Put balls beside shapes of motions, clear of all of them; `None` where there is no room for so many."""
    unit, tree = max(robot.radii), cKDTree(swept(robot, ways))
    way = np.concatenate([samples(knots) for knots in ways])
    found: list[sn.Sphere] = []
    for _ in range(DRAWS * count):
        size = unit * rng.uniform(SMALLEST, LARGEST)
        gap = unit * (LEAST_GAP + (MOST_GAP - LEAST_GAP) * rng.random() ** 3)
        shape = way[int(rng.uniform(FROM, 1.0) * len(way))]
        points = curve_of(robot, shape, BODY_SAMPLES).points
        aside = rng.normal(size=3)
        center = points[rng.integers(len(points))] + (size + unit + gap) * aside / np.linalg.norm(aside)
        if tree.query(center)[0] >= size + (1.0 + LEAST_GAP) * unit:
            found.append(sn.Sphere(center, size))
            if len(found) == count:
                return found
    return None


def plates(robot: sn.Robot, ways: Ways, rng: Generator) -> list[sn.Box]:
    """Put plates of bars across the shape where the first motion ends, with openings that all motions need."""
    unit, points = max(robot.radii), swept(robot, ways)
    poses = curve_of(robot, ways[0][-1], 40).poses
    count = int(rng.integers(FEWEST, MOST + 1))
    shares = 0.25 + 0.65 * (np.arange(count) + rng.uniform(0.2, 0.8, count)) / count
    return [
        bar
        for number, share in enumerate(shares)
        for bar in _plate(poses[round(share * (len(poses) - 1))], points, unit, f"plate {number + 1}")
    ]


def _plate(pose: Floats, points: Floats, unit: float, name: str) -> list[sn.Box]:
    """Cut a plate across a frame (4, 4) into bars, and leave out what is too near to points (m, 3)."""
    room, thick, width = (1.0 + OPEN) * unit, 0.5 * THICKNESS * unit, BAR * unit
    local = (points - pose[:3, 3]) @ pose[:3, :3]
    local = local[np.abs(local[:, 2]) < room + thick]
    deep = np.maximum(np.abs(local[:, 2]) - thick, 0.0)
    count = math.ceil(2.0 * HALF / BAR)
    middles = width * (np.arange(count) - 0.5 * (count - 1))
    aside = np.maximum(np.abs(local[:, :2, None] - middles) - 0.5 * width, 0.0)
    near = (aside[:, 0, :, None] ** 2 + aside[:, 1, None, :] ** 2 + deep[:, None, None] ** 2 < room**2).any(axis=0)
    found: list[sn.Box] = []
    for row in range(count):
        edges = np.flatnonzero(np.diff(np.concatenate([[True], near[row], [True]]).astype(int)))
        for first, last in edges.reshape(-1, 2):
            middle = np.array([middles[row], 0.5 * (middles[first] + middles[last - 1]), 0.0])
            size = np.array([width, (last - first) * width, 2.0 * thick])
            found.append(
                sn.Box(pose[:3, 3] + pose[:3, :3] @ middle, size, pose[:3, :3], name=f"{name}, {len(found) + 1}")
            )
    return found


def doors(which: str, robot: sn.Robot, ways: Ways, rng: Generator, mesh: bool = False) -> list[Obstacle] | None:
    """Put a cell with one door around where motions end (`in`) or around the base (`out`), or both (`two`).

    The common wall of two has a slit, too, that is too narrow. `None` where they need too wide a door. Walls are boxes,
    or one mesh.
    """
    cells = _cells(robot, ways, rng)
    if cells is None:
        return None
    walls = common_wall(*cells, min(robot.radii), rng) if which == "two" else cells[which == "in"].boxes("cell")
    return [one_mesh(walls, robot)] if walls is not None and mesh else walls  # type: ignore[return-value]


def _cells(robot: sn.Robot, ways: Ways, rng: Generator) -> tuple[Cell, Cell] | None:
    """Cells on both sides of the middle of a wall: around the base, and around where motions end."""
    points, unit = swept(robot, ways), max(robot.radii)
    frame = _ahead(robot, ways[0], rng)[0]
    local = in_frame(frame, points)
    through = local[np.abs(local[:, 2]) < (1.0 + WALLS[1]) * unit, :2]
    low, high = through.min(axis=0), through.max(axis=0)
    half = 0.5 * (high - low) + (1.0 + rng.uniform(*GAP)) * unit
    begin = in_frame(frame, curve_of(robot, ways[0][0], RINGS).points)
    if half.max() > WIDEST * unit or begin[:, 2].max() > 0.0:
        return None
    frame[:3, 3] += frame[:3, :2] @ (0.5 * (low + high))
    before, after = points[local[:, 2] <= 0.0], points[local[:, 2] >= 0.0]
    return cells_back_to_back(before, after, frame, half, unit, rng)


def _ahead(robot: sn.Robot, knots: Floats, rng: Generator) -> Floats:
    """Frames (m, 4, 4) along the hidden shape, `FINE` a ring, from a little beyond where the tip begins."""
    curve = curve_of(robot, knots[-1], FINE * RINGS)
    tip = curve_of(robot, knots[0], RINGS).points[-1]
    begin = int(np.linalg.norm(curve.points - tip, axis=1).argmin())
    begin += round(rng.uniform(*BEYOND) * (len(curve.poses) - 1))
    return curve.poses[min(begin, len(curve.poses) - 1 - FINE) :].copy()


def pipe(robot: sn.Robot, ways: Ways, rng: Generator) -> list[sn.Mesh] | None:
    """Put a pipe, open at both ends, where motions lead in; `None` as before."""
    unit = max(robot.radii)
    ahead = _ahead(robot, ways[0], rng)
    axis = ahead[: max(FINE + 1, round((1.0 - rng.uniform(*ENDS)) * len(ahead)))]
    gaps, at = map(np.asarray, cKDTree(axis[:, :3, 3]).query(swept(robot, ways)))
    along = gaps[(at > 0) & (at < len(axis) - 1) & (gaps < (WIDEST + ALONG) * unit)]
    inside = float(along.max(initial=0.0)) + (1.0 + rng.uniform(*GAP)) * unit
    if inside > WIDEST * unit:
        return None
    return [solids.open_tube(axis[::FINE], inside, inside + WALL * unit).mesh("pipe")]


PLANNED = "plans for which a motion is known: planned and proved within 5 s of CPU time, and found clear by the judges"
FALSE = "plans for which a motion is known: called proved, and a judge finds a collision"

COUNT, QUICK = 8, 1
"""Places of a family."""

STRIDE = 7
"""From one place's seed to the next: eight places have robots of all sizes, with stages and without."""

SECONDS = 5.0
"""Seconds of CPU time in which a plan has to be found."""

ON_CLOCK = 3.0
"""Budget of a plan on the clock, in units of that: the machine may be busy."""

PATIENCE = 300
"""Draws of one place before its family counts as having none."""

Around = Callable[[sn.Robot, Ways, Generator], Sequence[Obstacle] | None]
"""From a robot and motions to what stands around them; `None` where there is no room."""

FROM_ANOTHER = ", from another shape"
"""Ending of the names of families whose plans begin at a shape in the place, to which a second hidden motion leads."""


class Hidden(NamedTuple):
    """A robot among obstacles, and a motion (T, n, 3) that the judges find clear."""

    robot: sn.Robot
    scene: sn.Scene
    knots: Floats


_ANY: dict[str, Around] = {
    "40 balls": partial(balls, count=40),
    "100 balls": partial(balls, count=100),
    "plates": plates,
}
_DOORS = {"door in": "in", "door out": "out", "two doors": "two"}

_FROM_OUTSIDE: dict[str, tuple[str, Around, Callable[[int, Generator], sn.Robot]]] = {
    **{f"{what}, {kind}": (kind, around, robot_of) for what, around in _ANY.items() for kind in KINDS},
    **{what: (THREADING, partial(doors, which), robot_of) for what, which in _DOORS.items()},
    **{f"{what} mesh": (THREADING, partial(doors, which, mesh=True), robot_of) for what, which in _DOORS.items()},
    "pipe between": (THREADING, pipe, robot_of),
    "folded": (THREADING, partial(doors, "out"), longest),
    "folded mesh": (THREADING, partial(doors, "out", mesh=True), longest),
}
FAMILIES = {
    **_FROM_OUTSIDE,
    **{name + FROM_ANOTHER: family for name, family in _FROM_OUTSIDE.items()},
    "pipe between" + FROM_ANOTHER: (THREADING, pipe, longest),  # others have no segment beyond a pipe
}
"""How the hidden motion goes, what stands around it, and what makes a robot of a seed."""


def make(family: str, seed: int) -> Hidden:
    """Make the place of a seed.

    Raises
    ------
    RuntimeError
        When none is found.
    """
    another, (kind, around, robots) = family.endswith(FROM_ANOTHER), FAMILIES[family]
    for attempt in range(PATIENCE):
        rng = np.random.default_rng([crc32(family.encode()), seed, attempt])
        robot = robots(seed, rng)
        ways = draw_motions(robot, kind, rng, another)
        knots = np.concatenate([*(way[:0:-1] for way in ways[1:]), ways[0]])
        obstacles = around(robot, ways, rng) if len(ways) == 1 + another and keeps_apart(robot, knots) else None
        if obstacles is None:
            continue
        scene = sn.Scene(list(obstacles))
        if not wrong_in(robot, scene, knots):
            return Hidden(robot, scene, knots)
    raise RuntimeError(f"{family} has no place for seed {seed}")


def examine(place: tuple[str, int]) -> Trial:
    """Plan from where a hidden motion begins to where it ends, and judge the plan."""
    hidden = make(*place)
    asked = hidden.robot, hidden.knots[0], hidden.knots[-1], hidden.scene
    motion, spent = timed(sn.plan, *asked, time=ON_CLOCK * SECONDS, clock=thread_time)
    wrong = wrong_in(hidden.robot, hidden.scene, motion.q) if motion.solved else ""
    return Trial(place[1], spent, str(motion.status), wrong)


def measure(plan: Plan, family: str) -> Iterator[Line]:
    """Plan into places of one family."""
    places = [(family, 1000 * plan.seed + STRIDE * i) for i in range(plan.count(COUNT, QUICK))]
    yield from counted(PLANNED, FALSE, family, list(in_processes(examine, places, alone=plan.quick)), SECONDS, 99.0)


PARTS = {f"known {family}": partial(measure, family=family) for family in FAMILIES}
"""Pieces of the experiment, by name."""
