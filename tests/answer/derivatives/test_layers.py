"""Layers of learning libraries: gradients agree with theirs on free kinematics, in both modes, over batches."""

import importlib
from functools import cache
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.answer.derivatives.many import HostGoals, solved
from tests.helpers import Floats, refused

pytestmark = pytest.mark.filterwarnings("ignore:`torch.jit")  # PyTorch calls it itself

ROBOT = sn.Robot.uniform(4, (0.8, 1.2), max_bend=2.0)


GOALS = np.array([[1.0, 0.4, 3.0], [0.5, -1.0, 2.8], [-0.7, 0.2, 3.1]])
DIRECTIONS = np.array([[0.5, 0.1, 2.0], [0.2, -0.6, 1.0], [-0.3, 0.1, 0.9]])

STIFF = sn.Robot([sn.Segment((0.8, 1.2), 2.0), sn.Segment(1.0, 2.0)])
"""Position and direction leave it no motion to spare."""

REACHED = STIFF.tip([[[0.9, 0.3, 1.1], [-0.4, 0.8, 1.0]], [[-0.5, 0.6, 0.9], [0.7, 0.2, 1.0]]])
CASES = {
    "spare": (ROBOT, GOALS, None),
    "spare, turned": (ROBOT, GOALS, DIRECTIONS),
    "none to spare": (STIFF, REACHED[:, :3, 3], REACHED[:, :3, 2]),
}
"""Robots, positions and directions."""


@pytest.mark.parametrize("case", CASES)
def test_gradients_are_those_of_the_function_that_ran(case: str) -> None:
    """From a cold start, at the tolerance that solvers have: differences of answers agree."""
    robot, goals, directions = CASES[case]
    solver = sn.Solver(robot)

    def answers(positions: Floats) -> tuple[Floats, Floats]:
        return solved(solver, HostGoals(positions, directions), None, "raise", True)

    q, change = answers(goals)
    assert np.linalg.norm(robot.tip(q)[:, :3, 3] - goals, axis=1).max() < 1e-8
    for c, step in enumerate(1e-5 * np.eye(3)):
        differences = (answers(goals + step)[0] - answers(goals - step)[0]) / 2e-5
        np.testing.assert_allclose(change[..., c], differences, atol=1e-5 * np.abs(change).max())


def test_no_answer_is_nearer_to_where_a_solve_begins() -> None:
    q, _ = solved(exact_solver(), HostGoals(GOALS), None, "raise", True)
    begin = np.array([[0.0, 0.0, 1.0]] * 4)
    for way in np.random.default_rng(0).normal(size=(20, 4, 3)):
        other = exact_solver().solve_many(positions=GOALS, initial=q + 0.05 * way).q
        sizes = [np.linalg.norm((each - begin).reshape(3, -1), axis=1) for each in (q, np.array(other))]
        assert (sizes[0] <= sizes[1] + 1e-9).all()


def test_answers_keep_clear_and_kinks_are_said() -> None:
    """Near a ball that is in the way the answer stays proved, and a warning says that its gradient is one-sided."""
    ball = [sn.Sphere((0.25, 0.1, 1.4), 0.55)]
    solver = sn.Solver(ROBOT, ball)
    with pytest.warns(sn.SuspiciousInput, match="1 of 1 answers touch"):
        q, change = solved(solver, HostGoals(np.array([[0.5, 0.2, 2.9]])), None, "raise", True)
    assert sn.Motion(ROBOT, np.stack([q[0], q[0]]), ball).verify().ok
    assert change.any()


@cache
def exact_solver() -> sn.Solver:
    """Not made when tests are collected, since that compiles."""
    return sn.Solver(ROBOT, tolerance=sn.Tolerance(1e-12, 1e-12))


def torch_tip(torch: Any, q: Any) -> Any:
    """Position and tangent of the tip, by the matrix exponential of PyTorch."""
    pose = torch.eye(4, dtype=q.dtype)
    for x, y, length in q:
        zero = torch.zeros_like(x)
        rows = [[zero, zero, x, zero], [zero, zero, y, zero], [-x, -y, zero, length], [zero, zero, zero, zero]]
        pose = pose @ torch.linalg.matrix_exp(torch.stack([torch.stack(row) for row in rows]))
    return torch.cat([pose[:3, 3], pose[:3, 2]])


def test_torch_agrees_with_its_own_gradients_of_free_kinematics() -> None:
    torch = pytest.importorskip("torch")
    import sinuous.torch as layer

    q = torch.tensor(np.random.default_rng(0).uniform((-0.5, -0.5, 0.9), (0.5, 0.5, 1.1), (4, 3)))
    goal = torch_tip(torch, q)[:3].requires_grad_()
    change = torch.autograd.functional.jacobian(lambda p: layer.solve(exact_solver(), p, initial=q), goal)
    own = torch.autograd.functional.jacobian(lambda x: torch_tip(torch, x)[:3], q).reshape(3, 12)
    np.testing.assert_allclose(change.reshape(12, 3), np.linalg.pinv(own.numpy()), atol=1e-9)  # the least motion


@pytest.mark.parametrize("case", CASES)
def test_torch_checks_itself_in_both_modes_from_a_cold_start(case: str) -> None:
    torch = pytest.importorskip("torch")
    import sinuous.torch as layer

    robot, *goals = CASES[case]
    solver = sn.Solver(robot)
    given = [torch.tensor(each.copy(), requires_grad=True) for each in goals if each is not None]

    def of(positions: Any, directions: Any = None) -> Any:
        return layer.solve(solver, positions, directions=directions)

    assert torch.autograd.gradcheck(of, given, eps=1e-5, atol=1e-5, check_forward_ad=True)


def test_torch_maps_over_batches() -> None:
    torch = pytest.importorskip("torch")
    import sinuous.torch as layer

    goals = torch.tensor(GOALS)
    together = layer.solve(exact_solver(), goals)
    mapped = torch.func.vmap(lambda p: layer.solve(exact_solver(), p))(goals)
    np.testing.assert_array_equal(mapped, together)
    rows = torch.func.vmap(torch.func.jacrev(lambda p: layer.solve(exact_solver(), p)))(goals)
    columns = torch.func.vmap(torch.func.jacfwd(lambda p: layer.solve(exact_solver(), p)))(goals)
    own = solved(exact_solver(), HostGoals(GOALS), None, "raise", True)[1]
    np.testing.assert_allclose(rows, own, atol=1e-12)
    np.testing.assert_allclose(columns, own, atol=1e-12)


def test_torch_says_what_is_not_solved() -> None:
    torch = pytest.importorskip("torch")
    import sinuous.torch as layer

    far = torch.tensor([[9.0, 0.0, 0.0], GOALS[0].tolist()], dtype=torch.float64, requires_grad=True)
    with pytest.raises(sn.NotSolvedError):
        layer.solve(exact_solver(), far)
    layer.solve(exact_solver(), far, unsolved="best").sum().backward()
    assert not far.grad[0].any()
    assert far.grad[1].any()
    refused("unsolved", lambda: layer.solve(exact_solver(), far, unsolved="perhaps"))
    refused("positions", lambda: layer.solve(exact_solver()), "nothing is asked")
    refused("directions", lambda: layer.solve(exact_solver(), far, directions=far[0]), "the same axes in front")
    refused("positions", lambda: layer.solve(exact_solver(), far[:, :2]), "(..., 3)")


def test_jax_has_both_modes_and_maps_over_batches() -> None:
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    import sinuous.jax as layer

    own = solved(exact_solver(), HostGoals(GOALS), None, "raise", True)[1]

    def of(position: Any) -> Any:
        return layer.solve(exact_solver(), position)

    np.testing.assert_allclose(jax.vmap(jax.jacfwd(of))(GOALS), own, atol=1e-12)
    np.testing.assert_allclose(jax.vmap(jax.jacrev(of))(GOALS), own, atol=1e-12)
    np.testing.assert_allclose(jax.jit(jax.jacrev(of))(GOALS[0]), own[0], atol=1e-12)
    assert of(GOALS).shape == (3, 4, 3)


def test_jax_takes_directions_and_rotations() -> None:
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    import sinuous.jax as layer

    weights = np.random.default_rng(0).normal(size=(4, 3))
    found = exact_solver().solve(sn.Target(GOALS[0], direction=DIRECTIONS[0]))
    own = found.vjp(weights)["target"]

    def of(position: Any, direction: Any) -> Any:
        return (weights * layer.solve(exact_solver(), position, directions=direction, lead=False)).sum()

    position, direction = jax.grad(of, (0, 1))(GOALS[0], DIRECTIONS[0])
    np.testing.assert_allclose(position, own[:3], atol=1e-12)
    way = np.array([0.1, 0.2, -0.3])
    turn = np.cross(DIRECTIONS[0], way) / (DIRECTIONS[0] @ DIRECTIONS[0])
    np.testing.assert_allclose(direction @ way, own[3:] @ turn, atol=1e-12)
    tip = ROBOT.tip(found.q)
    asked = exact_solver().solve(sn.Target(rotation=tip[:3, :3]), found.q)

    def turned(rotation: Any) -> Any:
        return (weights * layer.solve(exact_solver(), rotations=rotation, initial=found.q)).sum()

    moved = np.stack([np.cross(way, column) for column in tip[:3, :3].T], axis=1)
    np.testing.assert_allclose(
        (jax.grad(turned)(tip[:3, :3]) * moved).sum(), asked.vjp(weights)["target"] @ way, atol=1e-12
    )


@pytest.mark.parametrize(
    "modes", [("jacrev", "jacrev"), ("jacfwd", "jacrev"), ("jacrev", "jacfwd"), ("jacfwd", "jacfwd")]
)
@pytest.mark.parametrize("library", ["torch", "jax"])
def test_second_derivatives_are_refused(library: str, modes: tuple[str, str]) -> None:
    """Of positions and directions, in all modes; they would be 0."""
    pytest.importorskip(library)
    layer = importlib.import_module(f"sinuous.{library}")
    if library == "jax":
        tools = importlib.import_module("jax")
        tools.config.update("jax_enable_x64", True)
        given = GOALS[0], DIRECTIONS[0]
    else:
        tools = importlib.import_module("torch").func
        given = tuple(importlib.import_module("torch").tensor(each[0]) for each in (GOALS, DIRECTIONS))
    outer, inner = (getattr(tools, mode) for mode in modes)
    for number in range(2):
        first = inner(lambda p, d: layer.solve(exact_solver(), p, directions=d), number)
        assert np.asarray(first(*given)).any()
        with pytest.raises(NotImplementedError, match="has no second derivatives"):
            outer(first, number)(*given)
