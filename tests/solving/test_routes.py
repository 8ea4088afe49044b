"""Ways as starts: narrow places that a local solver does not get into, and rooms without a door."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous import Box, Robot, Scene, Segment, Solver, Sphere, Status, Target
from sinuous.problem.problem import Problem
from sinuous.solving.routes import Router
from tests.helpers import Floats

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


def problem(robot: Robot, target: Target, scene: Scene) -> Problem:
    return Problem(robot, target, scene)


def router(robot: Robot, scene: Scene) -> Router:
    return Router(robot, scene, sn.Tolerance().for_robot(robot))


def test_a_way_leads_where_starts_at_random_do_not(narrow: Scene, target: Target) -> None:
    solution = Solver(ROBOT, narrow, time=60.0, starts=40).solve(target)
    assert solution.status is Status.SOLVED
    assert solution.start == "route"
    assert solution.verify().ok
    assert not Solver(ROBOT, narrow, time=60.0, starts=12, routes=False).solve(target).solved


def test_ways_go_from_base_to_target_and_starts_lie_in_them(narrow: Scene, target: Target) -> None:
    routes = next(router(ROBOT, narrow).search(problem(ROBOT, target, narrow), lambda: 60.0))
    assert len(routes.ways) == len(routes.starts) == 1
    way = routes.ways[0]
    assert np.allclose(way[0], 0.0)
    assert np.allclose(way[-1], ROBOT.tip(HIDDEN)[:3, 3])
    assert narrow.distance(way).min() > 0.09
    body = ROBOT.backbone(routes.starts[0], 20)
    assert np.linalg.norm(body[:, None] - way[None], axis=-1).min(axis=1).max() < 0.1
    assert not routes.closed


def test_the_same_search_gives_the_same_ways(narrow: Scene, target: Target) -> None:
    asked = problem(ROBOT, target, narrow)
    finder = router(ROBOT, narrow)
    first, again = (next(finder.search(asked, lambda: 60.0)) for _ in range(2))
    other = next(router(ROBOT, narrow).search(asked, lambda: 60.0))
    assert np.array_equal(first.starts, again.starts)
    assert np.array_equal(first.starts, other.starts)


def test_ways_differ_in_the_side_on_which_they_pass() -> None:
    scene = Scene([Sphere((0, 0, 2.2), 0.7)])
    asked = problem(ROBOT, Target((0, 0, 4.4)), scene)
    ways = [way for routes in router(ROBOT, scene).search(asked, lambda: 60.0) for way in routes.ways]
    sides = {tuple(np.sign(np.round(way[np.abs(way[:, 2] - 2.2).argmin(), :2], 1))) for way in ways}
    assert len(sides) >= 3


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


def test_what_sits_in_the_mount_may_pass_the_wall() -> None:
    robot = Robot([Segment((0.0, 3.0), 0.0, radius=0.1), *[Segment(1.0, 2.4, radius=0.1)] * 3], mount=2.0)
    scene = box_room(np.array([0.0, 0.0, 3.5]), 1.8, 0.1)
    q = np.array([[0, 0, 1.9], [1.2, 0.3, 1.0], [-0.3, 1.0, 1.0], [0.2, -0.5, 1.0]])
    solution = Solver(robot, scene, time=60.0).solve(Target(robot.tip(q)[:3, 3]))
    assert solution.status is not Status.NO_ROUTE


def test_without_a_position_there_is_no_way() -> None:
    scene = Scene([Sphere((0, 0, 3), 0.3)])
    asked = problem(ROBOT, Target(direction=(0, 0, 1)), scene)
    assert list(router(ROBOT, scene).search(asked, lambda: 60.0)) == []


def test_no_time_no_way(narrow: Scene, target: Target) -> None:
    assert list(router(ROBOT, narrow).search(problem(ROBOT, target, narrow), lambda: 0.0)) == []


def test_all_solutions_come_from_different_ways() -> None:
    scene = Scene([Sphere((0, 0, 2.2), 0.7)])
    solver = Solver(ROBOT, scene, time=60.0, starts=30)
    found = solver.solve_all(Target((0, 0, 4.4), direction=(0, 0, 1)), count=8)
    assert len(found) >= 3
    assert "route" in {solution.start for solution in found}
    sides = {tuple(np.sign(np.round(ROBOT.backbone(s.q, 20)[50, :2], 1))) for s in found}
    assert len(sides) >= 3


@pytest.fixture
def without_ways(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fail where a way is looked for, once a `Solver` is made."""
    find = Router._find

    def only_loading(self: Router, problem: Problem, which: int, plan: Any, seconds: float) -> Any:
        assert seconds == 0.0, "looked for a way"
        return find(self, problem, which, plan, seconds)

    monkeypatch.setattr(Router, "_find", only_loading)


@pytest.mark.usefixtures("without_ways")
def test_what_is_decided_needs_no_way(narrow: Scene, target: Target) -> None:
    ball = [Sphere((0, 0, 2.2), 0.7)]
    assert Solver(ROBOT, ball).solve(Target((0, 0, 50))).status is Status.OUT_OF_REACH
    assert Solver(ROBOT, ball).solve(Target((0, 0, 2.2))).status is Status.TARGET_BLOCKED
    assert Solver(ROBOT, narrow, starts=1).solve(target).starts == 1


def test_all_solutions_come_from_no_more_starts_than_allowed(narrow: Scene, target: Target) -> None:
    solver = Solver(ROBOT, narrow, time=60.0, starts=2)
    assert solver.solve_all(target) == []
