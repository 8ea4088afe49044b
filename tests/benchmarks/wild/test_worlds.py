"""Wild worlds are those of their numbers, of all sorts, and what is hidden in them is a solution."""

import numpy as np
import pytest

from benchmarks.judges.clearances import Clearances
from benchmarks.judges.judge import target_errors, within_limits
from benchmarks.judges.self_collision import look
from benchmarks.wild import curled, worlds
from benchmarks.wild.worlds import World

MADE = [worlds.make(3, number) for number in range(80)]


def test_a_world_is_made_again_by_its_number() -> None:
    first, again = worlds.make(3, 7), worlds.make(3, 7)
    np.testing.assert_array_equal(first.hidden, again.hidden)
    np.testing.assert_array_equal(first.robot.limits, again.robot.limits)
    assert [o.kind for o in first.scene.obstacles] == [o.kind for o in again.scene.obstacles]
    assert first.tolerance == again.tolerance
    assert len({world.tolerance.angle for world in MADE}) == len(MADE)


@pytest.mark.parametrize("world", [*MADE[:25], curled.make(3, 0, 0), curled.make(8, 0, 1)])
def test_what_is_hidden_is_a_solution(world: World) -> None:
    robot, q = world.robot, world.hidden
    assert 1 <= len(world.targets) == len(q)
    for targets in zip(*world.targets, strict=True):
        position, angle = target_errors(robot, targets, q)
        assert (position <= 1e-12 * robot.mean_length + 1e-15 * np.abs(robot.base).max()).all()
        assert (angle <= 1e-9).all()
    assert within_limits(robot, q).all()
    assert (look(robot, q, 0.0).least > 0.0).all()
    assert (Clearances(robot, world.scene).least(q, 0.0) > 0.0).all()


def test_a_body_that_avoids_itself_can_have_the_hidden_curvature() -> None:
    for world in MADE:
        bends, radii = np.hypot(world.hidden[..., 0], world.hidden[..., 1]), np.array(world.robot.radii)
        assert (bends * radii < world.hidden[..., 2] + 1e-300).all()


def test_worlds_are_of_all_sorts() -> None:
    robots, scenes = [world.robot for world in MADE], [world.scene for world in MADE]
    segments = [segment for robot in robots for segment in robot.segments]
    assert min(map(len, robots)) == 1
    assert max(map(len, robots)) > 16
    assert any(segment.length == (0.0, segment.length[1]) and segment.max_bend == 0.0 for segment in segments)
    assert any(segment.length[0] == segment.length[1] and segment.max_bend == 0.0 for segment in segments)
    assert any(np.isfinite(segment.max_curvature) for segment in segments)
    assert any(segment.tendons for segment in segments)
    assert any(segment.chambers for segment in segments)
    assert max(np.hypot(world.hidden[..., 0], world.hidden[..., 1]).max() for world in MADE) > 4.0
    assert any(robot.mount > 0.0 for robot in robots)
    assert any((robot.tool != np.eye(4)).any() for robot in robots)
    assert any(len(set(robot.radii)) > 1 for robot in robots)
    assert any(len(targets) > 1 for world in MADE for targets in world.targets)
    lengths = [robot.mean_length for robot in robots]
    assert min(lengths) < 1e-4
    assert max(lengths) > 1e3
    kinds = {obstacle.kind for scene in scenes for obstacle in scene.obstacles}
    assert kinds >= {"sphere", "box", "capsule", "cylinder", "half_space"}
    assert any(getattr(obstacle, "inside", False) for scene in scenes for obstacle in scene.obstacles)
    assert min(map(len, scenes)) == 0
    assert max(map(len, scenes)) > 25
