"""The method of the paper: what it reaches, and where it fails without its repairs."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from benchmarks.problems import PAPER_POSES, arm
from sinuous import methods
from sinuous.methods.opti_path.gradient import PotentialKind
from tests.helpers import present, refused

EXACT = sn.Tolerance(1e-9, 0.0175)
DOWN = (0.0, 0.0, -1.0)


def poses() -> list[sn.Target]:
    return [sn.Target(position, direction=direction) for position, direction in PAPER_POSES.values()]


def solve_from_the_arc(target: sn.Target, robot: sn.Robot | None = None, **options: Any) -> sn.Solution:
    """Solve from the method's first start alone."""
    return sn.Solver(robot or arm(5, np.pi), tolerance=EXACT, method=methods.OptiPath(**options), max_starts=1).solve(
        target
    )


def largest_bend(solution: sn.Solution) -> float:
    return float(np.hypot(solution.q[:, 0], solution.q[:, 1]).max())


@pytest.mark.parametrize("target", poses(), ids=list(PAPER_POSES))
def test_the_four_poses_of_the_paper(target: sn.Target) -> None:
    for gradient in ("adjoint", "differences"):
        solution = solve_from_the_arc(target, gradient=gradient)
        assert solution.solved
        assert solution.verify().ok
        assert solution.iterations <= 60
        assert solution.position_error == pytest.approx(0.0, abs=1e-10)
        assert solution.starts == 1


@pytest.mark.parametrize("target", poses(), ids=list(PAPER_POSES))
def test_the_faithful_mode_solves_them_and_the_literal_exponent_does_not(target: sn.Target) -> None:
    def run(**changes: Any) -> sn.Solution:
        return sn.Solver(arm(5, 6.0), tolerance=EXACT, method=methods.OptiPath.faithful(**changes)).solve(target)

    solution = run()
    assert solution.solved
    assert solution.iterations <= 60
    for metric in ("acceleration", "identity"):
        literal = run(exponent="literal", metric=metric, orientation="norm", largest_step=0.0)
        assert not literal.solved
        assert literal.worst is not None


def test_a_goal_straight_ahead_needs_a_bow() -> None:
    """An exact saddle: by symmetry no gradient points aside, and a straight robot is too long."""
    target = sn.Target((0.0, 0.0, -200.0))
    stuck = solve_from_the_arc(target, bow=0.0)
    assert not stuck.solved
    assert largest_bend(stuck) == pytest.approx(0.0, abs=1e-9)
    assert present(stuck.worst).constraint == "length"
    bowed = solve_from_the_arc(target)
    assert bowed.solved
    assert bowed.verify().ok


def test_a_goal_behind_the_base_needs_another_guess() -> None:
    """The single arc is nearly a whole turn then, and far too long."""
    target = sn.Target((0.0, 1e-6, 100.0))
    faithful = sn.Solver(arm(5, np.pi), tolerance=EXACT, method=methods.OptiPath.faithful()).solve(target)
    assert not faithful.solved
    assert np.isfinite(faithful.q).all()
    repaired = solve_from_the_arc(target)
    assert repaired.solved
    assert repaired.iterations <= 60


def tracking_scene(seed: int, spheres: int) -> tuple[sn.Robot, list[sn.Target], sn.Scene]:
    rng = np.random.default_rng(seed)
    turn = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    path = 480.0 * np.stack([0.3 * np.sin(turn), 0.22 * np.sin(2.0 * turn), 0.72 + 0.1 * np.cos(turn)], axis=-1)
    base = np.linspace(0.0, 60.0, 10)[:, None] * [0.0, 0.0, 1.0]
    found: list[Any] = []
    while len(found) < spheres:
        center, radius = 480.0 * rng.uniform([-0.45, -0.45, 0.1], [0.45, 0.45, 0.7]), 480.0 * rng.uniform(0.03, 0.08)
        if min(np.linalg.norm(line - center, axis=-1).min() for line in (path, base)) > radius + 15.0:
            found.append(sn.Sphere(center, radius))
    return sn.Robot.uniform(8, (54, 66), radius=1.0), [sn.Target(p) for p in path], sn.Scene(found)


@pytest.mark.parametrize("potential", ["grid", "exact"])
def test_a_path_through_spheres_is_tracked(potential: PotentialKind) -> None:
    robot, path, scene = tracking_scene(1, 70)
    solver = sn.Solver(robot, scene, method=methods.OptiPath(potential=potential))
    solution = solver.solve(path[0])
    warm = sn.Solver(robot, scene, method=methods.OptiPath(potential=potential), max_starts=1)
    moved = 0
    for target in path[:30]:
        solution = warm.solve(target, solution)
        assert solution.solved
        assert solution.start == "given"
        assert solution.verify().ok
        moved += solution.iterations
    assert moved > 20


def test_obstacles_are_kept_away_from_by_the_body_between_its_points() -> None:
    """With one long segment before a sphere only samples on the arcs feel it."""
    robot = sn.Robot.uniform(3, (80, 120), radius=2.0)
    scene, target = sn.Scene([sn.Sphere((6.0, 0.0, 150.0), 20.0)]), sn.Target((0.0, 10.0, 298.0))
    felt = sn.Solver(robot, scene, method=methods.OptiPath(arcs_weight=3.0), max_starts=1).solve(target)
    blind = sn.Solver(robot, scene, method=methods.OptiPath(arcs_weight=0.0, influence=0.1), max_starts=1).solve(target)
    assert felt.solved
    assert felt.verify().ok
    assert blind.status is sn.Status.BLOCKED
    assert present(blind.worst).constraint == "clearance"


def test_a_grid_that_is_too_fine_is_refused() -> None:
    scene = sn.Scene([sn.Sphere((0.0, 0.0, 1.0), 0.1)])
    robot = sn.Robot.uniform(20, 1.0)
    refused("spacing", lambda: sn.Solver(robot, scene, method=methods.OptiPath(spacing=1e-3)), "nodes")
    sn.Solver(robot, method=methods.OptiPath(spacing=1e-3))  # nothing to sample
    sn.Solver(robot, scene, method=methods.OptiPath(spacing=1e-3, potential="exact"))


def test_everything_scales_with_the_robot() -> None:
    """Options are in lengths of a segment: the same problem in metres has the same solution."""
    scene = [sn.Sphere((20.0, 40.0, -150.0), 25.0)]
    small_scene = [sn.Sphere((0.02, 0.04, -0.15), 0.025)]
    for target in poses()[:3]:
        large = sn.solve(arm(5, np.pi), target, scene, method="opti_path", tolerance=EXACT)
        small = sn.solve(
            sn.Robot.uniform(5, (0.045, 0.07), base=sn.pose(direction=DOWN)),
            sn.Target(0.001 * present(target.position), direction=target.direction),
            small_scene,
            method="opti_path",
            tolerance=sn.Tolerance(1e-12, 0.0175),
        )
        assert large.iterations == small.iterations
        np.testing.assert_allclose(small.q * [1.0, 1.0, 1000.0], large.q, atol=1e-5)
