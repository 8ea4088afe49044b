"""Does `solve_all` find a solution through every door? Walls with doors, each with a hidden shape through every one."""

import itertools
from collections.abc import Sequence
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.harness.lines import Goal, Line
from benchmarks.judges.clearances import overlaps
from benchmarks.judges.judge import right
from benchmarks.judges.kinematics import body_points
from benchmarks.wild.trials import named
from sinuous.base.checks import Floats

MOST_DOORS = 4

RADIUS = 4.0

ROBOT = sn.Robot.uniform(6, (40.0, 60.0), 2.4, radius=RADIUS)

HALF = 1000.0
"""Half the edge of a wall: more than the robot can go round."""

OPEN = (3.0, 6.0)
"""Edges of a door, in radii of the body: it leaves 1 to 4 of them beside a body that is straight through it."""

POST = 1.5
"""Least width of what stands between two doors, in radii of the body."""

DRAWN = 64
"""Shapes drawn for the doors of one wall."""

SAMPLES = 400
"""Places a segment at which it is looked where a body crosses a wall."""

TOLERANCE = sn.Tolerance()

BUDGET = 1.0
"""Seconds of one `solve_all`."""

FOUND = 98.0
"""Share of the doors, in percent, that should be found."""

ASKED = 8
"""Solutions that it may return: its default."""

SECTION = f"solve_all by route: walls with 1 to {MOST_DOORS} doors, a hidden shape through each; budget {BUDGET:g} s"


class Wall(NamedTuple):
    """A wall across the z axis, and where its doors are.

    Attributes
    ----------
    scene : Scene
    target : Target
    middle : float
        Where it stands.
    doors : ndarray (k, 2, 2)
        Low and high corner of each, x and y.
    """

    scene: sn.Scene
    target: sn.Target
    middle: float
    doors: Floats


class Passed(NamedTuple):
    """What came of one wall.

    Attributes
    ----------
    doors, found : int
        Doors, and how many of these a returned solution goes through.
    again : int
        Solutions that go through the same doors, in the same order, as a better one.
    alike : int
        Solutions that are said to pass everything as a better one does.
    false : int
        Solutions that miss the target, exceed a limit or touch the wall.
    seconds : float
        Of the whole call.
    """

    doors: int
    found: int
    again: int
    alike: int
    false: int
    seconds: float


def make(seed: int, number: int) -> Wall:
    """Draw a wall: shapes that meet one target are found in the open, and a door is put where each crosses the wall."""
    rng = np.random.default_rng([seed, number])
    wanted = int(rng.integers(1, MOST_DOORS + 1))
    while True:
        wall = _draw(rng, wanted)
        if wall is not None:
            return wall


def _draw(rng: Generator, wanted: int) -> Wall | None:
    middle, half = float(rng.uniform(80.0, 180.0)), 0.5 * float(rng.uniform(1.0, 3.0)) * RADIUS
    around = rng.uniform(-80.0, 80.0, 2)
    target = sn.Target((*around, middle + rng.uniform(50.0, 120.0)))
    shapes = _shapes(rng, target)
    doors: list[Floats] = []
    for q in shapes:
        door = _door_about(q, middle, half, rng)
        if door is not None and all(_apart(door, other) for other in doors):
            doors.append(door)
        if len(doors) == wanted:
            scene = sn.Scene(_boxes(np.array(doors), middle, half))
            kept = [q for q in shapes if not overlaps(ROBOT, scene, q[None])[0]]
            through = {tuple(gates_of(q, middle, np.array(doors))) for q in kept}
            return Wall(scene, target, middle, np.array(doors)) if through >= {(i,) for i in range(wanted)} else None
    return None


def _shapes(rng: Generator, target: sn.Target) -> Floats:
    """Shapes (m, n, 3) that meet a target in the open, from random starts."""
    solver = sn.Solver(ROBOT, tolerance=TOLERANCE, max_starts=1)
    bends = rng.uniform(-1.2, 1.2, (DRAWN, len(ROBOT), 2))
    starts = np.concatenate([bends, np.full((DRAWN, len(ROBOT), 1), 50.0)], axis=2)
    found = [solver.solve(target, start) for start in starts]
    return np.array([each.q for each in found if each.solved]).reshape(-1, len(ROBOT), 3)


def _line(q: Floats) -> Floats:
    return body_points(ROBOT, q[None], SAMPLES)[0].reshape(-1, 3)


def _door_about(q: Floats, middle: float, half: float, rng: Generator) -> Floats | None:
    """A door (2, 2) about where a shape crosses a wall, once; `None` where it would be too large."""
    line = _line(q)
    within = line[np.abs(line[:, 2] - middle) < half + RADIUS]
    crosses = np.count_nonzero(np.diff(line[:, 2] > middle))
    if crosses != 1 or not len(within):
        return None
    low, high = within[:, :2].min(axis=0) - 1.1 * RADIUS, within[:, :2].max(axis=0) + 1.1 * RADIUS
    size = rng.uniform(*OPEN, 2) * RADIUS
    if (high - low > size).any() or not (np.abs(low) < HALF).all():
        return None
    corner = low - rng.uniform(0.0, 1.0, 2) * (size - (high - low))
    return np.stack([corner, corner + size])


def _apart(one: Floats, other: Floats) -> bool:
    """Whether there is room for a post between two doors, along x or along y."""
    gaps = np.maximum(one[0] - other[1], other[0] - one[1])
    return bool(gaps.max() > POST * RADIUS)


def _boxes(doors: Floats, middle: float, half: float) -> list[sn.Box]:
    """The wall, as boxes that lie side by side: the cells that all edges of doors divide it into, joined along x."""
    xs, ys = (np.unique([-HALF, *doors[:, :, axis].ravel(), HALF]) for axis in (0, 1))
    boxes = []
    for y0, y1 in itertools.pairwise(ys):
        first = None
        for x0, x1 in itertools.pairwise(xs):
            x, y = 0.5 * (x0 + x1), 0.5 * (y0 + y1)
            is_open = bool(((doors[:, 0] < (x, y)) & ((x, y) < doors[:, 1])).all(axis=1).any())
            first = x0 if first is None and not is_open else first
            if first is not None and (is_open or x1 == xs[-1]):
                end = x0 if is_open else x1
                boxes.append(sn.Box((0.5 * (first + end), y, middle), (end - first, y1 - y0, 2.0 * half)))
                first = None
    return boxes


def gates_of(q: Floats, middle: float, doors: Floats) -> list[int]:
    """Doors that a shape goes through, in their order; -1 for none of them."""
    line = _line(q)
    gates = []
    for i in np.flatnonzero(np.diff(line[:, 2] > middle)):
        place = line[i, :2]
        inside = ((doors[:, 0] < place) & (place < doors[:, 1])).all(axis=1)
        gates.append(int(inside.argmax()) if inside.any() else -1)
    return gates


def compare(wall: Wall) -> Passed:
    """Hold `solve_all` against what is known of a wall."""
    solver = sn.Solver(ROBOT, wall.scene, tolerance=TOLERANCE, time=BUDGET)
    began = perf_counter()
    found = solver.solve_all(wall.target, count=ASKED)
    seconds = perf_counter() - began
    q = np.array([solution.q for solution in found]).reshape(-1, len(ROBOT), 3)
    good = right(ROBOT, [wall.target] * len(q), q, TOLERANCE, wall.scene)
    gates = [tuple(gates_of(each, wall.middle, wall.doors)) for each in q]
    single = {each[0] for each in gates if len(each) == 1 and each[0] >= 0}
    classes = [solution.route_class for solution in found if solution.route_class is not None]
    said = [tuple((each.obstacle, each.side, each.at) for each in one.passes) for one in classes]
    again, alike = len(gates) - len(set(gates)), len(said) - len(set(said))
    return Passed(len(wall.doors), len(single), again, alike, int((~good).sum()), seconds)


def passed(seed: int, number: int) -> Passed:
    """Hold `solve_all` against a wall."""
    return compare(make(seed, number))


def lines_of(kind: str, shares: Sequence[Sequence[Sequence[Any]]]) -> list[Line]:
    """Sum up walls, of which shares hold plain values."""
    made = [Passed(*each) for share in shares for each in share]
    doors, found = (sum(getattr(each, key) for each in made) for key in ("doors", "found"))
    lacking = [f"{i}: {each.found} of {each.doors}" for i, each in enumerate(made) if each.found < each.doors]
    share, goal, alike = 100.0 * found / doors, Goal(FOUND, at_most=False), sum(each.alike for each in made)
    return [
        Line(
            SECTION,
            f"{kind}: doors that a solution goes through",
            share,
            "%",
            goal,
            None,
            (found, doors),
            named(lacking),
        ),
        Line(
            SECTION, f"{kind}: solutions through the same doors as a better one", sum(each.again for each in made), ""
        ),
        Line(SECTION, f"{kind}: solutions that are said to pass all as a better one does", alike, "", Goal(0)),
        Line(SECTION, f"{kind}: false", sum(each.false for each in made), "", Goal(0, correctness=True)),
        Line(SECTION, f"{kind}: median time", float(np.median([each.seconds for each in made])), "ms", noise=1.0),
    ]
