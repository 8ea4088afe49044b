"""Many targets at once: to the last bit what a loop finds, whatever the threads; made into solutions when asked for."""

import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.answer.solutions import Solutions
from sinuous.solver.many import LARGEST_CALL
from tests.helpers import Floats, refused, refused_each
from tests.methods.laws import shapes

ARM = sn.Robot.uniform(4, (0.8, 1.2), 2.0, radius=0.05)
SPHERES = [sn.Sphere((0.6, 0.0, 2.0), 0.4), sn.Sphere((0.0, -1.2, 2.5), 0.5)]
FIXED = sn.Robot.uniform(3, 1.0, 2.0)
TENDONS = sn.Robot.uniform(3, (0.8, 1.2), 2.0, radius=0.05, tendons=sn.Tendons(3, 0.05, displacement=(-0.08, 0.08)))
LONG = 20.0
"""Seconds that nothing here takes, however slow the machine is."""


def tips(robot: sn.Robot, count: int, seed: int = 0) -> Floats:
    return robot.tip(shapes(robot, count, 2.0, seed))


def are_those_of_a_loop(solver: sn.Solver, many: Solutions, targets: Any, initial: Any = None) -> None:
    assert len(many) == len(targets)
    for i, target in enumerate(targets):
        own = None if initial is None else initial[i]
        loop, one = solver.solve(target, own), many[i]
        assert one.status is loop.status
        np.testing.assert_array_equal(one.q, loop.q)
        for name in NAMES:
            assert getattr(one, name) == getattr(loop, name), name


NAMES = (
    "iterations starts start position_error angle_error clearance self_clearance method seed solved".split()  # noqa: SIM905
)
"""What is the same in each run."""


def goals(kind: str, poses: Floats) -> dict[str, Any]:
    given: dict[str, Any] = {} if kind.endswith("alone") else {"positions": poses[:, :3, 3]}
    if kind.startswith("direction"):
        given["directions"] = poses[:, :3, 2]
    elif kind.startswith("rotation"):
        given["rotations"] = poses[:, :3, :3]
    return given


@pytest.mark.parametrize("kind", ["position", "direction", "rotation", "direction alone", "rotation alone"])
@pytest.mark.parametrize(
    ("robot", "scene"),
    [(ARM, ()), (ARM, SPHERES), (FIXED, ()), (TENDONS, SPHERES)],
    ids=["free", "spheres", "fixed", "tendons"],
)
def test_arrays_are_a_loop(robot: sn.Robot, scene: Any, kind: str) -> None:
    solver = sn.Solver(robot, scene, max_starts=30, time=LONG, routes=False)
    given = goals(kind, tips(robot, 30))
    if "positions" in given:
        given["positions"] = given["positions"].copy()
        given["positions"][::7] *= 3.0  # mostly out of reach
    singular = {key[:-1]: value for key, value in given.items()}
    targets = [sn.Target(**dict(zip(singular, row, strict=True))) for row in zip(*singular.values(), strict=True)]
    many = solver.solve_many(**given)
    are_those_of_a_loop(solver, many, targets)
    assert many.equals(solver.solve_many(targets, workers=1))
    for workers in (1, 2, 5):
        assert many.equals(solver.solve_many(**given, workers=workers))


def test_several_targets_at_once_in_any_order() -> None:
    """Numbers of targets at once differ from one to the next; some are out of reach, some need many starts."""
    solver = sn.Solver(ARM, SPHERES, max_starts=40, time=LONG, prefer=sn.Preferences(bends=0.5, start=0.5))
    asked: list[Any] = [sn.Target(pose[:3, 3], rotation=pose[:3, :3]) for pose in tips(ARM, 16)]
    asked[7:9] = [[sn.Target((0, 0, 3.8)), sn.Target((0.1, 0, 1.9), segment=2)], [sn.Target((0, 0, 9.0))]]
    asked[12] = sn.Target((0.6, 0.0, 2.0))
    initial = list(shapes(ARM, 16, 2.0, 13))
    initial[3] = solver.solve(sn.Target((0, 0, 3.8)))
    for given in (None, initial):
        many = solver.solve_many(asked, given, workers=2)
        are_those_of_a_loop(solver, many, [each if isinstance(each, list) else [each] for each in asked], given)
        assert {"solved", "out_of_reach", "target_blocked"} <= set(many.status)
    assert solver.solve_many(iter(asked), iter(initial)).equals(many)


@pytest.fixture(scope="module")
def some() -> Solutions:
    """Solved, blocked and out of reach; with and without an orientation."""
    solver = sn.Solver(TENDONS, SPHERES, max_starts=3, time=LONG, routes=False)
    poses = tips(TENDONS, 40, 3)
    targets: list[Any] = [sn.Target(pose[:3, 3]) for pose in poses]
    targets[:20] = [sn.Target(pose[:3, 3], rotation=pose[:3, :3]) for pose in poses[:20]]
    targets[3], targets[30] = sn.Target(direction=(0, 0.2, 1)), sn.Target((0, 0, 9))
    return solver.solve_many(targets)


def test_arrays_say_what_each_solution_says(some: Solutions) -> None:
    def same(array: Any, name: str) -> None:
        values = [getattr(each, name) for each in some]
        if any(isinstance(value, float) for value in values):
            values = [np.nan if value is None else value for value in values]
        np.testing.assert_array_equal(array, values)

    assert {
        len(some),
        len(list(some)),
        *(len(getattr(some, name)) for name in NAMES if name not in ("method", "seed")),
    } == {40}
    for name in (*NAMES[:-3], "q", "status", "solved", "seconds"):
        same(getattr(some, name), name)
    assert (some.method, some.seed) == (some[0].method, some[0].seed)
    assert len(set(some.status)) > 2
    assert np.isnan(some.clearance).any()
    assert not np.isnan(some.clearance[some.solved]).any()
    assert np.isnan(some.position_error[3])
    assert np.isnan(some.angle_error[25])
    assert some.actuators is not None
    for name, values in some.actuators.items():
        np.testing.assert_allclose(values, [(each.actuators or {})[name] for each in some], atol=1e-12)
    assert sn.Solver(ARM).solve_many(positions=[[0, 0, 3.9]]).actuators is None


def test_it_is_a_sequence(some: Solutions) -> None:
    assert isinstance(some[3], sn.Solution)
    np.testing.assert_array_equal(some[-1].q, some.q[39])
    np.testing.assert_array_equal(some[np.int64(5)].q, some.q[5])
    for index in (
        slice(5, 9),
        slice(None, None, -3),
        [4, -1, 4],
        np.array([], int),
        ~some.solved,
        some.solved.tolist(),
    ):
        part = some[index]
        assert isinstance(part, Solutions)
        np.testing.assert_array_equal(part.q, some.q[index])
        assert part.status.tolist() == some.status[index].tolist()
        np.testing.assert_array_equal(part.angle_error, some.angle_error[index])
        for own, whole in zip(part, some.q[index], strict=True):
            np.testing.assert_array_equal(own.q, whole)
            assert own.verify().ok == own.solved
    assert some[5:20][3:][1].problem.targets[0] is some[9].problem.targets[0]
    for bad in (40, -41):
        with pytest.raises(IndexError, match="40 solutions"):
            some[bad]
    with pytest.raises(TypeError):
        some["a"]  # type: ignore[index]
    refused("index", lambda: some[np.zeros((2, 2), int)])


def test_initial_configurations_for_all_and_for_each() -> None:
    solver = sn.Solver(ARM, time=LONG)
    poses, near = tips(ARM, 6), shapes(ARM, 6, 1.0, 4)
    targets = [sn.Target(pose[:3, 3]) for pose in poses]
    places = poses[:, :3, 3]
    each = solver.solve_many(positions=places, initial=near)
    are_those_of_a_loop(solver, each, targets, near)
    for same in (list(near), near.tolist(), np.asfortranarray(near)):
        assert solver.solve_many(positions=places, initial=same).equals(each)
    one = solver.solve_many(positions=places, initial=near[0])
    are_those_of_a_loop(solver, one, targets, [near[0]] * 6)
    for same in (near[0].tolist(), np.broadcast_to(near[0], near.shape)):
        assert solver.solve_many(positions=places, initial=same).equals(one)
    again = solver.solve_many(positions=places, initial=each)
    are_those_of_a_loop(solver, again, targets, each.q)
    assert set(again.start) == {"given"}
    assert solver.solve_many(positions=places, initial=list(each)).equals(again)
    assert solver.solve_many(positions=places, initial=each[0]).equals(
        solver.solve_many(positions=places, initial=each.q[0])
    )


def test_more_than_one_call_can_take() -> None:
    """Chunks of every size; an answer depends on its target alone."""
    solver = sn.Solver(FIXED, max_starts=2)
    places = np.tile(tips(FIXED, 97)[:, :3, 3], (3 * LARGEST_CALL // 97, 1))
    many = solver.solve_many(positions=places, workers=2)
    assert len(many) > 2 * LARGEST_CALL
    np.testing.assert_array_equal(many.q, np.tile(many.q[:97], (3 * LARGEST_CALL // 97, 1, 1)))


@pytest.mark.parametrize("workers", [1, 2])
def test_the_budget_is_that_of_each(workers: int) -> None:
    wall = sn.Box((0, 0, 0), (0.1 + 2e-7, 20, 20), inside=True)  # within which a proof takes millions of looks
    solver = sn.Solver(ARM, [wall], routes=False)
    straight = np.tile([0.0, 0.0, 1.0], (4, 1))
    began = time.process_time()  # other work on the machine does not count
    many = solver.solve_many(positions=[[0, 0, 4.0]] * 6, initial=straight, time=0.02, workers=workers)
    assert time.process_time() - began < 1.0
    assert set(many.status) == {"unproved"}
    assert (many.seconds >= 0.02).all()


@pytest.mark.skipif(sys.platform == "win32", reason="there a process cannot send itself this signal")
@pytest.mark.parametrize("workers", [1, 2])
def test_an_interrupt_stops_all_threads(workers: int) -> None:
    wall = sn.Box((0, 0, 0), (0.1 + 2e-7, 20, 20), inside=True)
    solver = sn.Solver(ARM, [wall], routes=False)
    straight, before = np.tile([0.0, 0.0, 1.0], (4, 1)), threading.active_count()
    solver.solve_many(positions=[[0, 0, 4.0]], time=0.0)
    threading.Timer(0.1, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    began = time.process_time()
    with pytest.raises(KeyboardInterrupt):
        solver.solve_many(positions=[[0, 0, 4.0]] * 100, initial=straight, time=60.0, workers=workers)
    assert time.process_time() - began < 5.0
    assert threading.active_count() == before


def test_what_is_asked_wrongly_is_refused_by_name() -> None:
    solver, places = sn.Solver(ARM), tips(ARM, 4)[:, :3, 3]
    ask: Callable[..., Any] = solver.solve_many
    target = sn.Target((0, 0, 3.9))
    refused("targets", ask, "nothing is asked", "positions=")
    refused("targets[1]", lambda: ask([target, [1.0, 2.0]]), "a Target", "for positions use positions=")
    refused("targets[0]", lambda: ask([places[0, :2]]), "for positions use positions=")
    refused("targets", lambda: ask(places), "a list of targets", "for positions use positions=")
    refused_each("targets", (target, "abc", 3, {"position": 1}), ask, "a list of targets")
    refused_each("targets[0]", ([3], [None], ["abc"]), ask, "a Target")
    refused("targets[0][1]", lambda: ask([[target, 3]]), "a Target")
    refused("len(targets[0])", lambda: ask([[]]))
    refused("targets[1].segment", lambda: ask([target, sn.Target((0, 0, 1), segment=9)]), "1 to 4")
    refused("positions", lambda: ask([target], positions=places), "cannot be combined with targets")
    refused("position", lambda: ask(position=places), "did you mean 'positions'?")
    refused("positions[2]", lambda: ask(positions=[*places[:2], (0, 0, np.nan)]), "3 finite numbers")
    refused("directions", lambda: ask(positions=places, directions=places[:2]), "positions: 4")
    refused("directions", lambda: ask(positions=places, directions=places, xyzw=np.ones((4, 4))), "xyzw")
    refused_each("workers", (0, -1, 1.5, True, "2"), lambda value: ask(positions=places, workers=value), "from 1 to")
    refused_each("progress", (1, "yes", None), lambda value: ask(positions=places, progress=value), "true or false")
    refused_each("time", (-1, "1"), lambda value: ask(positions=places, time=value))
    refused("starts", lambda: ask([target], starts=[1]))
    near = shapes(ARM, 4, 1.0, 0)
    near[2, 1, 1] = np.nan
    refused("initial", lambda: ask(positions=places, initial=near[:2]), "4 configurations", "got 2")
    refused("initial[2]", lambda: ask(positions=places, initial=near), "rows of 3 finite numbers")
    refused("initial[2]", lambda: ask(positions=places, initial=list(near)), "4 rows of 3 finite numbers")
    refused_each(
        "initial", (3, near[0, :2], near[2], near[..., :2]), lambda value: ask(positions=places, initial=value)
    )
