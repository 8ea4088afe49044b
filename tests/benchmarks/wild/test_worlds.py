"""Wild worlds are those of their numbers, of all sorts, and what is hidden in them is a solution."""

from collections.abc import Callable
from functools import cache, partial

import numpy as np
import pytest

from benchmarks.judges.clearances import Clearances
from benchmarks.judges.judge import target_errors, within_limits
from benchmarks.judges.self_collision import look
from benchmarks.wild import audit, curled, worlds
from benchmarks.wild.worlds import World
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment
from sinuous.scene.obstacles import HalfSpace, Sphere
from sinuous.scene.scene import Scene


@cache
def made() -> list[World]:
    """Eighty worlds; not while tests are collected, which every process does."""
    return [worlds.make(3, number) for number in range(80)]


def test_a_world_is_made_again_by_its_number() -> None:
    first, again = worlds.make(3, 7), worlds.make(3, 7)
    np.testing.assert_array_equal(first.hidden, again.hidden)
    np.testing.assert_array_equal(first.robot.limits, again.robot.limits)
    assert [o.kind for o in first.scene.obstacles] == [o.kind for o in again.scene.obstacles]
    assert first.tolerance == again.tolerance
    assert len({world.tolerance.angle for world in made()}) == len(made())


OF_ALL_SORTS = [partial(worlds.make, 3, number) for number in range(15)]
CURLED = [partial(curled.make, 3, 0, 0), partial(curled.make, 8, 0, 1)]


@pytest.mark.parametrize("make", [*OF_ALL_SORTS, *CURLED])
def test_what_is_hidden_is_a_solution(make: Callable[[], World]) -> None:
    world = make()
    robot, q = world.robot, world.hidden
    assert 1 <= len(world.targets) == len(q)
    for targets in zip(*world.targets, strict=True):
        position, angle = target_errors(robot, targets, q)
        assert (position <= 1e-12 * robot.mean_length + 1e-15 * np.abs(robot.base).max()).all()
        assert (angle <= 1e-9).all()
    assert within_limits(robot, q).all()
    assert (look(robot, q, 0.0).least > 0.0).all()
    assert (Clearances(robot, world.scene).least(q, 0.0) > 0.0).all()


@pytest.mark.parametrize("kind", audit.KINDS)
@pytest.mark.parametrize("number", range(4))
def test_audited_worlds_have_hidden_solutions_where_they_say_so(kind: str, number: int) -> None:
    world = audit.KINDS[kind](3, number)
    robot, q = world.robot, world.hidden
    assert 1 <= len(world.targets) == len(q)
    assert within_limits(robot, q).all()
    for targets in zip(*world.targets, strict=True):
        position, angle = target_errors(robot, targets, q)
        assert (position <= 1e-9 * robot.mean_length + 1e-12 * np.abs(robot.base).max()).all()
        assert (angle <= 1e-9).all()
    least = Clearances(robot, world.truth or world.scene).least(q, 0.0) if len(world.scene) else np.ones(1)
    assert (least > 0.0).all() or not world.possible


def test_the_judge_knows_distances_to_huge_obstacles_to_the_last_digits_of_the_robot() -> None:
    """A ball of radius 1e10 that is 1e-7 away: in double precision the gap is lost."""
    robot = Robot([Segment(1.0, 1.0, radius=0.1)])
    straight = np.array([[[0.0, 0.0, 1.0]]])
    for gap in (1e-7, -1e-7):
        wall = HalfSpace((0.0, 1e10, 1.1 + gap), (0.0, 0.0, -1.0))
        ball = Sphere((0.0, 0.0, 1e10 + 1.1 + 2e-6), 1e10)
        assert Clearances(robot, Scene([wall])).least(straight)[0] == pytest.approx(gap, abs=1e-15)
        exact = ball.center[2] - 1e10 - 1.1
        assert Clearances(robot, Scene([ball])).least(straight)[0] == pytest.approx(exact, abs=1e-9)


def test_a_body_that_avoids_itself_can_have_the_hidden_curvature() -> None:
    for world in made():
        bends, radii = np.hypot(world.hidden[..., 0], world.hidden[..., 1]), np.array(world.robot.radii)
        assert (bends * radii < world.hidden[..., 2] + 1e-300).all()


def test_worlds_are_of_all_sorts() -> None:
    robots, scenes = [world.robot for world in made()], [world.scene for world in made()]
    segments = [segment for robot in robots for segment in robot.segments]
    assert min(map(len, robots)) == 1
    assert max(map(len, robots)) > 16
    assert any(segment.length == (0.0, segment.length[1]) and segment.max_bend == 0.0 for segment in segments)
    assert any(segment.length[0] == segment.length[1] and segment.max_bend == 0.0 for segment in segments)
    assert any(np.isfinite(segment.max_curvature) for segment in segments)
    assert any(segment.tendons for segment in segments)
    assert any(segment.chambers for segment in segments)
    assert max(np.hypot(world.hidden[..., 0], world.hidden[..., 1]).max() for world in made()) > 4.0
    assert any(robot.mount > 0.0 for robot in robots)
    assert any((robot.tool != np.eye(4)).any() for robot in robots)
    assert any(len(set(robot.radii)) > 1 for robot in robots)
    assert any(len(targets) > 1 for world in made() for targets in world.targets)
    lengths = [robot.mean_length for robot in robots]
    assert min(lengths) < 1e-4
    assert max(lengths) > 1e3
    kinds = {obstacle.kind for scene in scenes for obstacle in scene.obstacles}
    assert kinds >= {"sphere", "box", "capsule", "cylinder", "half_space"}
    assert any(getattr(obstacle, "inside", False) for scene in scenes for obstacle in scene.obstacles)
    assert min(map(len, scenes)) == 0
    assert max(map(len, scenes)) > 25
