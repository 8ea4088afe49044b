"""Routes as starts: narrow places that a local solver does not get into, and rooms without a door."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous import Box, Robot, Scene, Segment, Solver, Sphere, Status, Target
from sinuous.kernels.freespace.cells import memory_size
from sinuous.kernels.tables import PROVED_CLOSED
from sinuous.solver.attempts import IKQuery, RandomRestarts, StartBatch
from sinuous.solver.routing.searches import CELLS, MEMORY, FoundRoutes, Searches
from sinuous.solver.strategy import attempts_of, plans_of
from tests.helpers import Floats, present

ROBOT = Robot.uniform(5, length=(0.8, 1.2), max_bend=2.4, radius=0.1)
HIDDEN = np.array([[0.9, 0.2, 1.0], [-0.8, 1.2, 1.1], [0.3, -1.5, 0.9], [1.2, 0.4, 1.0], [-1.0, -0.9, 1.0]])


def pipe(robot: Robot, q: Floats, ratio: float, ball: float = 0.06) -> Scene:
    """Balls all over the surface that is `ratio` times the radius away from the backbone."""
    points = robot.backbone(q, 20)
    rng = np.random.default_rng(0)
    away = rng.normal(size=(len(points), 400, 3))
    away /= np.linalg.norm(away, axis=-1, keepdims=True)
    reach = ratio * 0.1 + ball
    wall = (points[:, None] + reach * away).reshape(-1, 3)
    wall = wall[np.linalg.norm(wall[:, None] - points[None, ::2], axis=-1).min(axis=1) >= reach - 2e-3]
    _, first = np.unique(np.round(wall / 0.05), axis=0, return_index=True)
    return Scene([Sphere(center, ball) for center in wall[first]])


@pytest.fixture(scope="module")
def narrow() -> Scene:
    return pipe(ROBOT, HIDDEN, 1.6)


@pytest.fixture(scope="module")
def target() -> Target:
    return Target(ROBOT.tip(HIDDEN)[:3, 3])


def problem(robot: Robot, target: Target, scene: Scene) -> sn.Problem:
    return sn.Problem(robot, target, scene)


def router(robot: Robot, scene: Scene) -> Searches:
    return Searches(robot, scene, sn.Tolerance().for_robot(robot))


def question(asked: sn.Problem, seconds: float = 60.0) -> IKQuery:
    return IKQuery(asked, np.empty((0, len(asked.robot), 3)), lambda: seconds)


def batches_of(finder: Searches, asked: IKQuery, *without: str) -> Iterator[StartBatch]:
    """All starts but scattered ones."""
    off = ("scattered", *without)
    return (batch for batch in attempts_of(asked, RandomRestarts(3, 10), finder, without=off).batches() if batch.size)


def first(finder: Searches, asked: sn.Problem) -> FoundRoutes:
    """What the quickest plan finds."""
    query = finder.query(asked)
    return finder.find(asked, present(query), finder.coarse, 60.0)


def test_a_route_leads_where_scattered_starts_do_not(narrow: Scene, target: Target) -> None:
    solution = Solver(ROBOT, narrow, time=60.0, max_starts=40).solve(target)
    assert solution.status is Status.SOLVED
    assert solution.start == "route"
    assert solution.verify().ok
    assert solution.route is not None
    assert np.allclose(solution.route[0], 0.0)
    assert np.allclose(solution.route[-1], ROBOT.tip(HIDDEN)[:3, 3])
    assert np.linalg.norm(ROBOT.backbone(solution.q, 9)[:, None] - solution.route, axis=-1).min(axis=1).max() < 0.1
    assert not solution.route.flags.writeable
    assert not Solver(ROBOT, narrow, time=60.0, max_starts=12, routes=False).solve(target).solved


def test_threads_that_search_at_once_find_the_same(narrow: Scene, target: Target) -> None:
    asked, finder = problem(ROBOT, target, narrow), router(ROBOT, narrow)
    alone = next(batches_of(finder, question(asked))).initial

    def search(_: int) -> Any:
        return next(batches_of(finder, question(asked))).initial

    with ThreadPoolExecutor(4) as threads:
        assert all(np.array_equal(alone, found) for found in threads.map(search, range(12)))
    assert sum(buffer.nbytes for buffer in MEMORY._kept) <= 2 * 8 * memory_size(CELLS[1])


def test_a_robot_much_longer_than_its_route_is_stowed_beside_it() -> None:
    robot = Robot.uniform(6, length=1.0, max_bend=2.0, radius=0.1)
    walls = [((0.0, side, 0.3), (0.6, 0.3, 1.8)) for side in (0.29, -0.29)]
    walls += [((side, 0.0, 0.3), (0.3, 0.9, 1.8)) for side in (0.29, -0.29)]
    scene = Scene([Box(middle, size) for middle, size in walls])
    asked, finder = problem(robot, Target((0.3, 0.0, 2.6)), scene), router(robot, scene)
    query = finder.query(asked)
    route = finder.find(asked, present(query), finder.fine, 60.0).routes[0]
    assert np.linalg.norm(np.diff(route, axis=0), axis=1).sum() < 3.1
    solution = Solver(robot, scene, time=60.0, max_starts=30).solve(Target((0.3, 0.0, 3.0)))
    assert (solution.status, solution.start) == (Status.SOLVED, "route")


def test_a_body_gets_through_a_door_behind_its_base() -> None:
    """Half a circle over the wall, then straight down: the route turns back at once, as the body cannot."""
    robot = Robot.uniform(6, length=1.0, max_bend=1.4, radius=0.1)
    hidden = np.array([[np.pi / 3.0, 0.0, 1.0]] * 3 + [[0.0, 0.0, 1.0]] * 3)
    door, end = robot.backbone(hidden, 1)[3, 0], robot.tip(hidden)[:3, 3]
    walls = [Box((door + side * 2.2, 0.0, -0.5), (4.0, 8.0, 0.1)) for side in (-1.0, 1.0)]
    walls += [Box((door, side * 2.2, -0.5), (0.4, 4.0, 0.1)) for side in (-1.0, 1.0)]
    scene = Scene(walls)
    assert scene.distance(robot.backbone(hidden, 40)).min() > 0.15
    solution = Solver(robot, scene, time=60.0, max_starts=200).solve(Target(end))
    assert solution.status is Status.SOLVED
    assert solution.verify().ok


def box_room(center: Floats, half: float, wall: float, door: float = 0.0) -> Scene:
    """Six walls; the one towards the base has a door."""
    walls: list[Box] = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            at, size = center.copy(), np.full(3, 2.0 * half + wall)
            at[axis] += side * half
            size[axis] = wall
            if axis == 2 and side < 0.0 and door > 0.0:
                rest = half + 0.5 * wall - 0.5 * door
                for shift in (-1.0, 1.0):
                    part, extent = at.copy(), size.copy()
                    part[0] += shift * 0.5 * (rest + door)
                    extent[0] = rest
                    walls.append(Box(part, extent))
                    part, extent = at.copy(), size.copy()
                    part[1] += shift * 0.5 * (rest + door)
                    extent[0], extent[1] = door, rest
                    walls.append(Box(part, extent))
            else:
                walls.append(Box(at, size))
    return Scene(walls)


@pytest.mark.parametrize("wall", [1e-4, 0.1])
def test_a_room_without_a_door_is_said_to_be_closed(wall: float) -> None:
    center = np.array([0.6, 0.4, 3.0])
    solution = Solver(ROBOT, box_room(center, 0.6, wall), time=60.0).solve(Target(center))
    assert solution.status is Status.NO_ROUTE


def test_a_room_with_a_door_is_not() -> None:
    center = np.array([0.2, 0.1, 3.0])
    scene = box_room(center, 0.6, 0.1, door=0.5)
    assert scene.distance((0.2, 0.1, 2.4)) == pytest.approx(0.25)
    solution = Solver(ROBOT, scene, time=60.0).solve(Target(center))
    assert solution.status is Status.SOLVED


def test_a_base_in_a_closed_room_is_said_to_be() -> None:
    scene = box_room(np.array([0.0, 0.0, 0.3]), 0.6, 0.1)
    solution = Solver(ROBOT, scene, time=60.0).solve(Target((1.0, 0.5, 3.0)))
    assert solution.status is Status.NO_ROUTE
    assert solution.route is None


def test_all_solutions_come_from_no_more_starts_than_allowed(narrow: Scene, target: Target) -> None:
    solver = Solver(ROBOT, narrow, time=60.0, max_starts=2)
    assert solver.solve_all(target) == []


@pytest.mark.parametrize("tip", [0.0, 1e-5])
def test_what_is_too_narrow_for_thick_segments_is_open_to_the_thin_ones(tip: float) -> None:
    robot = Robot([Segment((0.8, 1.2), 2.0, radius=radius) for radius in (0.1, 0.1, 0.1, tip, tip)])
    hole, target = 0.05, Target((0.3, 0.1, 3.3))
    room = [Box((0, 0, -0.55), (4, 4, 0.1))]
    for side in (-1, 1):
        room += [Box((1.95 * side, 0, 1), (0.1, 4, 3.2)), Box((0, 1.95 * side, 1), (4, 0.1, 3.2))]
        beside = (1 + hole / 2) * side
        room += [Box((beside, 0, 2.55), (2 - hole, 4, 0.1)), Box((0, beside, 2.55), (2 * hole, 2 - hole, 0.1))]
    assert Solver(robot, room, time=10.0).solve(target).verify().ok
    thick = robot.changed(segments=[segment.changed(radius=0.1) for segment in robot.segments])
    assert Solver(thick, room, time=10.0).solve(target).status is Status.NO_ROUTE


@pytest.mark.parametrize(("mount", "proved"), [(0.0, True), (0.5, True), (0.6, False), (0.7, False)])
def test_nothing_is_proved_where_the_body_may_end_within_its_mount(mount: float, proved: bool) -> None:
    """A tip that stays in the mount may stand in an obstacle; the shortest body here has length 0.6."""
    robot = Robot([Segment((0.2, 1.0), 1.0, radius=0.05)] * 3, mount=mount)
    hidden = np.array([[0.3, 0.1, 0.22], [0.2, 0.0, 0.21], [-0.1, 0.2, 0.22]])
    scene = Scene([Sphere((0, 0, 0), 0.55, inside=True)])
    problem = sn.Problem(robot, [Target(robot.tip(hidden)[:3, 3])], scene)
    searches = Searches(robot, scene, problem.tolerance)
    query = present(searches.query(problem))
    ended = {searches.find(problem, query, plan, 30.0).ended for _, plan in plans_of(searches) if plan.prove}
    assert (PROVED_CLOSED in ended) is proved
    solution = sn.solve(robot, Target(robot.tip(hidden)[:3, 3]), scene, initial=hidden)
    assert solution.solved is (mount == 0.7)
