"""The options of a solve: each is checked, each has its default, and old names are answered with new ones.

Batches of starts: nothing is lost where they are cut, and numbers go on.

Attempts: each alone finds what it is for, in places of the benchmark, with intermediate targets and tools.

What comes of a solve whose time is over, and of one that is interrupted: never a claim without proof.
"""

import itertools
import os
import signal
import sys
import threading
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import sinuous as sn
from benchmarks.judges.kinematics import segment_ends
from benchmarks.places import make
from sinuous.base.arguments import MethodName
from sinuous.kernels.clock import SEGMENT_WORK, STRIDE
from sinuous.methods.method import METHODS, capabilities
from sinuous.scene.obstacles import Obstacle
from sinuous.solver.attempts import StartBatch
from sinuous.solver.options import ATTEMPTS, SolveOptions
from tests.helpers import Floats, present, refused, with_each
from tests.methods.laws import quick

ROBOT = sn.Robot.uniform(2, 1.0)
WRONG: dict[str, tuple[Any, ...]] = {
    "tolerance": (0.1, "fine", (0.1, 0.1), True),
    "prefer": ("short", 1.0, {"bends": 1.0}),
    "time": (-1.0, float("nan"), float("inf"), "1", True, None),
    "max_starts": (0, -3, 1.5, "9", True, 10**10),
    "seed": (-1, 2**31, 0.5, "0", False, None),
    "routes": (0, 1, "yes", None),
    "without": ("hops", ("grown", "hops"), 7, None),
    "memory": ("arm.npz", 7),
}


def test_every_field_is_kept() -> None:
    given: dict[str, Any] = {
        "tolerance": sn.Tolerance(1e-3, 1e-2),
        "method": "dls",
        "prefer": sn.Preferences(bends=1.0),
        "time": 0.5,
        "max_starts": 7,
        "seed": 3,
        "routes": False,
        "without": ("bottleneck",),
        "memory": sn.Memory(ROBOT),
        "clearance": 0.5,
        "self_clearance": 0.25,
    }
    assert set(given) == set(SolveOptions.__dataclass_fields__)
    options = SolveOptions.of(given)
    assert vars(options) == given
    assert sn.Solver(ROBOT, **{**given, "method": "newton"}).options.seed == 3


@with_each(("key", "value"), [(key, value) for key, values in WRONG.items() for value in values])
def test_wrong_values_are_refused_by_name(key: str, value: Any) -> None:
    refused(key, lambda: SolveOptions(**{key: value}))


def test_old_names_of_attempts_are_answered_with_new_ones() -> None:
    with pytest.warns(DeprecationWarning, match="'gates' is 'bottleneck' now"):
        assert SolveOptions(without=("gates", "cells")).without == ("cells", "bottleneck")


@pytest.mark.parametrize(
    ("guess", "meant"), [("obstacles", "scene"), ("guess", "initial"), ("timeout", "time"), ("tolerances", "tolerance")]
)
def test_an_option_that_is_guessed_is_answered_with_what_is_meant(guess: str, meant: str) -> None:
    given: Any = {guess: 1}
    refused(guess, lambda: sn.solve(ROBOT, (0.0, 0.0, 1.0), **given), meant)


def initial(count: int) -> Floats:
    return np.arange(6.0 * count).reshape(count, 2, 3)


@given(st.integers(0, 9), st.integers(0, 20), st.integers(0, 30), st.lists(st.integers(1, 9), min_size=1))
def test_parts_are_the_whole(count: int, first: int, own: int, sizes: list[int]) -> None:
    batch = StartBatch("route", initial(count), (first, first + own), effort=3.0)
    asked = itertools.cycle(sizes)
    limits: list[int] = []

    def most() -> int:
        limits.append(next(asked))
        return limits[-1]

    parts = list(batch.parts(most))
    assert batch.size == count + own == sum(part.size for part in parts)
    assert all(0 < part.size <= limit for part, limit in zip(parts, limits, strict=True))
    assert all(part.source == "route" for part in parts)
    assert np.array_equal(np.concatenate([NOTHING, *(part.initial for part in parts)]), batch.initial)
    numbers = [i for part in parts for i in range(*part.own)]
    assert numbers == list(range(first, first + own))
    # Initial configurations come first, and never together with starts of the method.
    kinds = [len(part.initial) > 0 for part in parts]
    assert kinds == sorted(kinds, reverse=True)
    assert not any(len(part.initial) and part.own[0] < part.own[1] for part in parts)


NOTHING = initial(0)


PLACES = [
    ("open pipe 1.6", 1, ("base_tube",)),
    ("two tubes", 2, ("base_tube",)),
    ("cells", 0, ("edges", "fitted")),
    ("cells pipe", 4, ("edges", "side_tubes", "grown")),
    ("cells", 1, ("cells", "fitted")),
    ("two tubes", 2, ("cells", "grown")),
    ("cells", 1, ("edges", "grown")),
    ("folded", 0, ("cells", "bottleneck")),
    ("door in mesh", 54, ("edges", "bottleneck")),
    ("door in mesh", 54, ("cells", "detours")),
    ("two doors", 0, ("unguided",)),
]
"""Families, numbers, and attempts that are enough there."""


def alone(*names: str) -> list[str]:
    """All other attempts."""
    return [name for name in ATTEMPTS if name not in names]


@pytest.mark.parametrize(("family", "number", "names"), PLACES)
def test_each_attempt_leads_to_a_solution_by_itself(family: str, number: int, names: tuple[str, ...]) -> None:
    place = make(family, number)
    solver = sn.Solver(place.robot, place.scene, tolerance=place.tolerance, time=60.0, without=alone(*names))
    found = solver.solve(place.targets)
    assert found.solved
    assert found.verify().ok
    assert found.start == "route"
    assert (found.route is None) == (names == ("unguided",))
    if found.route is not None:
        np.testing.assert_allclose(found.route[0], place.robot.base[:3, 3], atol=1e-9)
    np.testing.assert_array_equal(solver.solve(place.targets).q, found.q)


@pytest.mark.parametrize(("seed", "segment"), [(52031, 3), (230113, 5)])
def test_random_chains_pass_an_intermediate_target_among_hundreds_of_sheets(seed: int, segment: int) -> None:
    place = make("sheets", seed)
    elbow = sn.Target(segment_ends(place.robot, place.hidden_q[None])[0, segment, :3, 3], segment=segment)
    solver = sn.Solver(place.robot, place.scene, time=60.0, max_starts=100, without=alone("unguided"))
    found = solver.solve((elbow, place.target))
    assert found.solved
    assert found.verify().ok


@pytest.mark.parametrize("asked", ["position", "direction", "rotation", "elbow"])
@pytest.mark.parametrize("tool", [False, True])
@pytest.mark.parametrize(
    ("family", "number", "names"),
    [
        ("two tubes", 2, ("cells", "grown")),
        ("door in mesh", 54, ("edges", "bottleneck")),
        ("two tubes", 2, ("unguided",)),
    ],
)
def test_chains_from_both_ends_meet_whatever_is_asked(
    family: str, number: int, names: tuple[str, ...], tool: bool, asked: str
) -> None:
    place = make(family, number)
    radius, middle = min(place.robot.radii), len(place.robot) // 2
    held = sn.pose((0.3 * radius, 0.0, 1.5 * radius), direction=(0.2, 0.0, 1.0)) if tool else np.eye(4)
    robot = place.robot.changed(tool=held)
    tip = robot.tip(place.hidden_q)
    targets = {
        "position": [sn.Target(tip[:3, 3])],
        "direction": [sn.Target(tip[:3, 3], direction=tip[:3, 2])],
        "rotation": [sn.Target(tip[:3, 3], rotation=tip[:3, :3])],
        "elbow": [sn.Target(robot.forward(place.hidden_q)[middle - 1, :3, 3], segment=middle), sn.Target(tip[:3, 3])],
    }[asked]
    found = sn.solve(robot, targets, place.scene, tolerance=place.tolerance, time=60.0, without=alone(*names))
    assert (found.solved, found.start) == (True, "route")
    assert found.verify().ok


FIVE = sn.Robot.uniform(5, (0.8, 1.2), 2.0, radius=0.05)
STRAIGHT = np.tile([0.0, 0.0, 1.0], (5, 1))
AHEAD = sn.Target((0.0, 0.0, 5.0), direction=(0, 0, 1))
GRAZED = sn.Box((0, 0, 0), (0.1 + 2e-7, 20, 20), inside=True)
"""Walls between which a proof takes millions of looks."""

FAR: list[Obstacle] = [sn.Sphere((9.0, 0.01 * i, 0.0), 0.5) for i in range(2 * STRIDE)]
"""More obstacles than looks between two times that the clock is read."""


@pytest.mark.parametrize("method", METHODS)
def test_every_method_ends_when_there_is_no_time(method: MethodName) -> None:
    """After so many looks, with what it has then; most of them are not even through with one start."""
    scenes: list[list[Obstacle]] = [[], FAR] if capabilities(method).obstacles else [[]]
    for scene in scenes:
        solver = sn.Solver(FIVE, scene, method=quick(method, FIVE), routes=False)
        found = solver.solve(sn.Target((1.0, 2.0, 2.0), direction=(0, 1, 0)), time=0.0)
        assert found.starts <= 1
        assert found.iterations * len(FIVE) * SEGMENT_WORK <= 2 * STRIDE
        assert found.solved or found.status in (sn.Status.TIME_LIMIT, sn.Status.UNPROVED)
        assert np.isfinite(found.q).all()
        assert np.isfinite(present(found.position_error))
        assert found.solved == found.verify().ok or found.status is sn.Status.UNPROVED


def test_the_first_start_is_told_whatever_it_is() -> None:
    """Among many obstacles the time is over before the first linearisation: there is a configuration all the same."""
    found = sn.Solver(FIVE, FAR).solve(AHEAD, initial=0.9 * STRAIGHT, time=0.0)
    assert found.status is sn.Status.TIME_LIMIT
    np.testing.assert_array_equal(found.q, 0.9 * STRAIGHT)
    assert found.position_error == pytest.approx(0.5)


@pytest.mark.parametrize("method", ["newton", "monte_carlo"])
def test_a_proof_that_takes_too_long_is_none(method: MethodName) -> None:
    solver = sn.Solver(FIVE, [GRAZED], method=method, routes=False, max_starts=1)
    found = solver.solve(AHEAD, initial=STRAIGHT, time=1e-3)
    assert found.status is sn.Status.UNPROVED
    assert found.clearance is None
    np.testing.assert_array_equal(found.q, STRAIGHT)


@pytest.mark.skipif(sys.platform == "win32", reason="there a process cannot send itself this signal")
@pytest.mark.parametrize("count", [1, 4])
def test_an_interrupt_is_heard_within_a_call(count: int) -> None:
    solver = sn.Solver(FIVE, [GRAZED], routes=False)
    solver.solve_many([AHEAD] * count, initial=[STRAIGHT] * count, time=0.0)  # machine code is loaded before
    threading.Timer(0.05, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        solver.solve_many([AHEAD] * count, initial=[STRAIGHT] * count, time=60.0)
