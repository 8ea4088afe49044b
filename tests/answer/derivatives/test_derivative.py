"""Derivatives of answers: against differences of answers where there is a derivative, and to one side where not."""

import itertools
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

import sinuous as sn
from benchmarks.derivatives import (
    ALL,
    FAMILIES,
    OBSTACLES,
    Tangent,
    again,
    agreement,
    draw,
    least_gaps,
    question,
    random_tangent,
    touching,
)
from sinuous.answer.derivatives.derivative import derivative_of
from sinuous.answer.residual import residual_of
from sinuous.base.arguments import Parameter
from sinuous.kernels.packing import scales_of
from tests.helpers import Floats, present, refused

TOLERANCE = 1e-6
"""Relative difference up to which a derivative agrees."""

ARM = sn.Robot.uniform(4, (0.8, 1.2), max_bend=2.0)


@cache
def exact_solver() -> sn.Solver:
    """Not made when tests are collected, since that compiles."""
    return sn.Solver(ARM, tolerance=sn.Tolerance(1e-12, 1e-12))


@cache
def answer() -> sn.Solution:
    """An answer among nothing; not found when tests are collected, since that compiles."""
    return exact_solver().solve(sn.Target((1.0, 0.4, 3.0)))


@pytest.mark.filterwarnings("ignore::sinuous.SuspiciousInput")  # differences are of tools that are hardly any
@pytest.mark.parametrize("family", list(FAMILIES))
def test_no_wrong_derivative_is_called_regular(family: str) -> None:
    """Along a random motion of all parameters at once: targets, base, tool, sizes, limits, obstacles, start."""
    regular = 0
    for seed in range(8):
        rng = np.random.default_rng([seed, 1])
        found = draw(family, rng)
        if found is None:
            continue
        derivative, way = found.derivative(ALL), random_tangent(found, rng)
        if derivative.regular:
            regular += 1
            assert agreement(found, derivative.jvp(way), way) < TOLERANCE, seed
    assert regular > 0 or family in ("limits", "actuators", "at obstacles")


@pytest.mark.parametrize("name", ALL)
def test_each_group_agrees_with_differences(name: Any) -> None:
    for seed in range(4):
        rng = np.random.default_rng([seed, 2])
        found = present(draw("free", rng))
        way = {name: random_tangent(found, rng)[name]}
        derivative = found.derivative(name)
        assert derivative.regular
        assert agreement(found, derivative.jvp(way), way) < TOLERANCE, seed


@pytest.mark.parametrize("family", ["limits", "actuators"])
def test_at_a_limit_one_sided_differences_agree(family: str) -> None:
    agreed = []
    for seed in range(20):
        rng = np.random.default_rng([seed, 3])
        found = present(draw(family, rng))
        derivative, whole = found.derivative(ALL), random_tangent(found, rng)
        assert derivative.active
        assert not derivative.regular
        way: Tangent = {"target": whole["target"], "base": whole["base"]}
        motion = derivative.jvp(way)
        if np.isfinite(motion).all() and again(found, way, 1e-5) is not None:
            agreed.append(agreement(found, motion, way, {1.0: 1.0, 0.0: -1.0}) < 1e-4)
    assert len(agreed) > 10
    assert np.mean(agreed) > 0.85  # a solve that binds one limit after the other does not always end at the nearest


def asked_of(found: sn.Solution, tangent: Floats) -> Floats:
    """How the residual of the targets has to change, by differences of it."""
    h, ends = 1e-6, []
    for sign in (1.0, -1.0):
        asked, _ = question(found, {"target": tangent}, sign * h)
        ends.append(residual_of(sn.Problem(asked.robot, asked.targets), found.q).value)
    change: Floats = (ends[0] - ends[1]) / (2.0 * h)
    return change


def least_motions(found: sn.Solution, rows: Floats, bounds: Floats, asked: Floats) -> Floats:
    """The least motion (3 n,) with which targets move as asked (m,) and `rows . dq >= bounds`, of all subsets."""
    scale = scales_of(found.problem.robot.limits).ravel()
    J = residual_of(found.problem, found.q).jacobian * scale
    C = rows * scale
    best, least = np.full(len(scale), np.nan), np.inf
    for count in range(len(C) + 1):
        for chosen in itertools.combinations(range(len(C)), count):
            system = np.vstack([J, C[list(chosen)]])
            wanted = np.concatenate([asked, bounds[list(chosen)]])
            x = np.linalg.lstsq(system, wanted, rcond=1e-9)[0]
            met = np.abs(system @ x - wanted).max() < 1e-9 and (C @ x >= bounds - 1e-9).all()
            if met and np.linalg.norm(x) < least:
                best, least = scale * x, float(np.linalg.norm(x))
    return best


class Touch(NamedTuple):
    """A problem, and a configuration that answers it."""

    problem: sn.Problem
    q: Floats


def slacks(robot: sn.Robot, q: Floats) -> tuple[Floats, Floats]:
    """What is left of each limit, and its gradients (l, 3 n)."""
    listed = list(robot.limit_set.sides(q))
    return np.array([each.slack for each in listed]), -np.array([each.gradient.ravel() for each in listed])


def test_limits_that_move_push_the_answer() -> None:
    """Against the least motion by another way: gradients of limits, and differences of what is left of them."""
    compared = 0
    for seed in range(20):
        rng = np.random.default_rng([seed, 8])
        found = present(draw(str(rng.choice(["limits", "actuators"])), rng))
        whole = random_tangent(found, rng)
        names: tuple[Parameter, ...] = tuple(name for name in ALL if name not in ("initial", "obstacles"))
        way = {name: whole[name] for name in names}
        robot, q, h, ends = found.problem.robot, found.q, 1e-6, []
        if (robot.limits[:, 0] == robot.limits[:, 1]).any():
            way.pop("lengths")  # what cannot stretch moves by itself
        left, gradients = slacks(robot, q)
        moves = np.linalg.norm(gradients * scales_of(robot.limits).ravel(), axis=1) > 0.0
        active = (left < 1e-6 * robot.mean_length) & moves
        for sign in (1.0, -1.0):
            asked, _ = question(found, way, sign * h)
            ends.append((residual_of(sn.Problem(asked.robot, asked.targets), q).value, slacks(asked.robot, q)[0]))
        wanted, shrinks = ((a - b) / (2.0 * h) for a, b in zip(*ends, strict=True))
        motion = found.derivative(names).jvp(way).ravel()
        oracle = least_motions(found, gradients[active], -shrinks[active], wanted)
        scale = np.where(scales_of(robot.limits).ravel() > 0.0, scales_of(robot.limits).ravel(), 1.0)
        if np.isnan(oracle).any():
            assert np.isnan(motion).any()
            continue
        np.testing.assert_allclose(motion / scale, oracle / scale, atol=1e-5 * max(1.0, np.abs(oracle / scale).max()))
        compared += 1
    assert compared > 10


def test_a_body_that_gets_thicker_pushes_the_answer_as_a_curvature_that_gets_less() -> None:
    """A body that avoids itself bends no tighter than its radius."""
    q, most = np.array([[2.0, 1.5, 1.0], [0.3, 0.4, 1.0], [-0.2, 0.5, 1.0]]), 2.5
    limits: dict[Parameter, dict[str, Any]] = {"curvatures": {"max_curvature": most}, "radii": {"radius": 1.0 / most}}
    moved = []
    for name, rate in zip(limits, (-1.0, 1.0 / most**2), strict=True):
        robot = sn.Robot.uniform(3, 1.0, 3.0, **limits[name])
        derivative = derivative_of(sn.Problem(robot, sn.Target(robot.tip(q)[:3, 3])), q, (name,))
        moved.append(derivative.jvp({name: np.array([rate, 0.0, 0.0])}))
    np.testing.assert_allclose(moved[0], moved[1], atol=1e-6)
    assert np.abs(moved[0]).max() > 1.0


def gap_gradient(found: sn.Solution) -> Floats:
    """Derivatives (3 n,) of the least distance from the obstacles, by central differences."""
    scale = scales_of(found.problem.robot.limits).ravel()
    some = np.flatnonzero(scale)
    steps = 1e-6 * np.diag(scale)[some].reshape(-1, *found.q.shape)
    ahead, back = (least_gaps(found.problem, found.q + sign * steps) for sign in (1.0, -1.0))
    gradient = np.zeros(found.q.size)
    gradient[some] = (ahead - back) / (2e-6 * scale[some])
    return gradient


@pytest.mark.parametrize("kind", list(OBSTACLES))
def test_at_an_obstacle_the_body_slides_along_it_or_comes_free(kind: str) -> None:
    """Against the least motion by another way: gaps by samples, their gradients by differences, all subsets of rows."""
    held, compared = 0, 0
    for seed in range(24):
        if compared > 4 and held > 0:
            break
        rng = np.random.default_rng([seed, 4])
        found: Any = Touch(*touching(kind, rng))
        if not sn.check(found.problem.robot, found.q, found.problem.scene).ok:
            continue
        derivative = derivative_of(found.problem, found.q, "target")
        if len(derivative._rows.about) - derivative._rows.targets != 1 or not derivative.active[0].obstacle:
            continue
        tangent = random_tangent(found, rng)["target"]
        motion = derivative.jvp(tangent)
        asked = asked_of(found, tangent)
        slope = gap_gradient(found)
        wanted = least_motions(found, slope[None], np.zeros(1), asked)
        scale = scales_of(found.problem.robot.limits).ravel()
        error = np.abs((motion.ravel() - wanted) / np.where(scale > 0.0, scale, 1.0)).max()
        assert error < 1e-4 * max(1.0, np.abs(wanted / np.where(scale > 0.0, scale, 1.0)).max()), seed
        compared += 1
        held += bool(abs(slope @ motion.ravel()) < 1e-6 * found.problem.robot.mean_length)
    assert compared > 2
    assert held > 0


def test_the_derivative_of_the_clearance_agrees_with_differences() -> None:
    compared = 0
    for seed in range(40):
        if compared > 9:
            break
        rng = np.random.default_rng([seed, 5])
        found = draw("beside obstacles", rng)
        if found is None:
            continue
        derivative, way = found.derivative(ALL), random_tangent(found, rng)
        assert derivative.clearance is not None
        change = sum(derivative.clearance[name] @ way[name] for name in ALL)
        if not derivative.regular or not np.isfinite(change):
            continue
        h, gaps = 1e-5, []
        for sign in (1.0, -1.0):
            asked, _ = question(found, way, sign * h)
            q = found.q + sign * h * derivative.jvp(way)
            gaps.append(least_gaps(asked, q[None])[0])
        assert (gaps[0] - gaps[1]) / (2.0 * h) == pytest.approx(change, rel=1e-6, abs=1e-6 * _size(found))
        compared += 1
    assert compared > 5


def _size(found: sn.Solution) -> float:
    return found.problem.robot.mean_length


def test_tip_and_actuators_follow() -> None:
    """The tool does what the targets ask, and the base carries everything."""
    for seed in range(8):
        rng = np.random.default_rng([seed, 6])
        found = present(draw("free", rng))
        derivative, way = found.derivative(ALL), random_tangent(found, rng)
        h, poses, values = 1e-6, [], []
        for sign in (1.0, -1.0):
            asked, _ = question(found, way, sign * h)
            q = present(again(found, way, sign * h))
            poses.append(asked.robot.tip(q))
            values.append(asked.robot.to_actuators(q))
        rate = (poses[0] - poses[1]) / (2.0 * h)
        turn = rate[:3, :3] @ found.problem.robot.tip(found.q)[:3, :3].T
        twist = np.concatenate([[turn[2, 1], turn[0, 2], turn[1, 0]], rate[:3, 3]])
        own = sum(derivative.tip[name] @ way[name] for name in ALL)
        size = found.problem.robot.mean_length
        scale = np.array([1.0] * 3 + [size] * 3)
        np.testing.assert_allclose(own / scale, twist / scale, atol=1e-4 * max(1.0, np.abs(twist / scale).max()))
        change = sum(derivative.actuators[name] @ way[name] for name in ALL)
        wanted = (values[0] - values[1]) / (2.0 * h)
        np.testing.assert_allclose(change, wanted, atol=1e-4 * max(size, np.abs(wanted).max(initial=0.0)))


def test_vjp_is_the_transpose_of_jvp() -> None:
    rng = np.random.default_rng(0)
    found = present(draw("free", np.random.default_rng([3, 1])))
    way, cotangent = random_tangent(found, rng), rng.normal(size=found.q.shape)
    back = found.vjp(cotangent, ALL)
    assert (cotangent * found.jvp(way)).sum() == pytest.approx(sum(float(back[name] @ way[name]) for name in ALL))


def test_a_singular_shape_has_no_derivative() -> None:
    straight = np.array([[0.0, 0.0, 1.0]] * 4)
    robot = sn.Robot.uniform(4, 1.0, max_bend=2.0)
    found = sn.Solver(robot).solve(sn.Target(robot.tip(straight)[:3, 3]), straight)
    derivative = found.derivative()
    assert derivative.singular
    assert not derivative.regular
    below, above = derivative.one_sided("target")
    assert np.isnan(below[..., 2]).all()
    assert np.isfinite(above[..., 0]).all()


def test_columns_have_names() -> None:
    tendons = sn.Tendons(3, 0.1, displacement=(-1.0, 1.0))
    robot = sn.Robot.uniform(2, (0.8, 1.2), tendons=tendons)
    found = sn.Solver(robot, [sn.Sphere((9.0, 0.0, 0.0), 1.0, name="ball")]).solve(sn.Target((0.5, 0.1, 1.7)))
    derivative = found.derivative(ALL)
    assert derivative.labels("target") == ("target.position_x", "target.position_y", "target.position_z")
    assert derivative.labels("obstacles")[3] == "ball.v_x"
    assert derivative.labels("tendons") == ("s1.tendons.radius", "s2.tendons.radius")
    assert derivative.labels("lengths") == ("s1.length", "s2.length")
    for name in ALL:
        assert derivative.q[name].shape == (2, 3, len(derivative.labels(name)))
        assert derivative.tip[name].shape == (6, len(derivative.labels(name)))
        assert derivative.actuators[name].shape == (6, len(derivative.labels(name)))


def test_listed_targets_of_several_kinds_keep_all_columns() -> None:
    targets = [sn.Target((1.0, 0.4, 3.0)), sn.Target(direction=(0.3, 0.0, 1.0))]
    many = sn.Solver(ARM).solve_many(targets).derivative()
    assert many.q["target"].shape == (2, 4, 3, 6)
    assert not many.q["target"][0, ..., 3:].any()
    assert not many.q["target"][1, ..., :3].any()
    uneven = sn.Solver(ARM).solve_many([targets[0], [targets[0], sn.Target(direction=(0.0, 0.1, 1.0), segment=2)]])
    refused("wrt", uneven.derivative, "equally many")
    assert uneven.derivative("base").q["base"].shape == (2, 4, 3, 6)


def test_bad_input_is_refused() -> None:
    nowhere: Any = "colour"
    refused("wrt", lambda: answer().derivative(nowhere), "target, base, tool")
    refused("wrt", lambda: answer().derivative(()), "names nothing")
    refused("wrt", lambda: answer().derivative("target").q["base"], "was not asked for")
    refused("cotangent", lambda: answer().vjp([[1.0, 2.0]]))
    refused("tangent['target']", lambda: answer().jvp([1.0, 2.0]))
    refused("tangent", lambda: answer().derivative(("target", "base")).jvp([1.0, 2.0, 3.0]), "a mapping")
    failed = exact_solver().solve(sn.Target((9.0, 0.0, 0.0)))
    with pytest.raises(sn.NotSolvedError):
        failed.derivative()
