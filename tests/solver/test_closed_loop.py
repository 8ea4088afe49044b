"""Ticks that look at the real robot: the tip converges on the target although the model is wrong."""

import math
import pickle
from collections import deque
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

import sinuous as sn
from sinuous.answer.step import Step
from tests.helpers import Floats, present, refused

ARM = sn.Robot.uniform(3, 80.0, max_bend=2.4)


@cache
def arm_solver() -> sn.Solver:
    """Not made when tests are collected, since that compiles."""
    return sn.Solver(ARM)


REAL = sn.Robot([sn.Segment(84.0, max_bend=2.6), sn.Segment(76.0, max_bend=2.6), sn.Segment(84.0, max_bend=2.6)])
"""The same robot, wrong by 5 %."""

TARGET = np.array([70.0, 30.0, 190.0])
LENGTH = ARM.mean_length

Sensor = Callable[[Floats], Floats]


def shape(q: Floats) -> Floats:
    """What the real robot does where its model is at `q`: it bends less, and hangs."""
    bent = np.array(q)
    bent[:, :2] = 0.95 * q[:, :2] + np.array([0.03, -0.02])
    bent[:, 2] = [segment.length[0] for segment in REAL.segments]
    return bent


def real_pose(q: Floats) -> Floats:
    return REAL.tip(shape(q))


def run(
    target: sn.Target, sensor: Sensor, ticks: int, noise: float = 0.0, delay: int = 0, **options: Any
) -> list[Floats]:
    """Poses of the real tip in a loop that starts at a configuration that meets the target in the model."""
    rng = np.random.default_rng(0)
    step: sn.Solution | Step = sn.solve(ARM, target)
    late, poses = deque([step.q] * (delay + 1), maxlen=delay + 1), []
    for _ in range(ticks):
        reading = sensor(late[0])
        if noise:
            reading = reading + rng.normal(0.0, noise, reading.shape)
        step = arm_solver().step(step, dt=0.01, target=target, measured=reading, delay=delay, **options)
        late.append(step.q)
        poses.append(real_pose(step.q))
    return poses


def off(pose: Floats) -> float:
    return float(np.linalg.norm(pose[:3, 3] - TARGET))


def test_the_model_alone_misses() -> None:
    assert off(real_pose(sn.solve(ARM, sn.Target(TARGET)).q)) > 0.02 * LENGTH


def test_the_tip_converges_on_the_target() -> None:
    poses = run(sn.Target(TARGET), lambda q: real_pose(q)[:3, 3], 60)
    assert off(poses[-1]) < 1e-4 * LENGTH


def test_bends_from_a_fibre_and_points_of_the_body() -> None:
    bends = run(sn.Target(TARGET), lambda q: shape(q)[:, :2], 60)
    assert off(bends[-1]) < off(real_pose(sn.solve(ARM, sn.Target(TARGET)).q))

    def points(q: Floats) -> Floats:
        poses = REAL.forward(shape(q))
        return np.stack([poses[1, :3, 3], poses[2, :3, 3]])

    seen = run(sn.Target(TARGET), points, 60, places=[2.0 / 3.0, 1.0])
    assert off(seen[-1]) < 1e-3 * LENGTH
    elbow = sn.Target(ARM.forward(sn.solve(ARM, sn.Target(TARGET)).q)[1, :3, 3], segment=2)
    step: sn.Solution | Step = sn.solve(ARM, elbow)
    for _ in range(60):
        step = arm_solver().step(step, dt=0.01, target=elbow, measured=points(step.q), places=[2.0 / 3.0, 1.0])
    assert np.linalg.norm(points(step.q)[0] - present(elbow.position)) < 1e-3 * LENGTH


def test_what_is_not_seen_changes_nothing_and_what_is_known_is_carried() -> None:
    target = sn.Target(TARGET)
    first = arm_solver().step(sn.solve(ARM, target), dt=0.01, target=target, measured=TARGET + 3.0)
    blind = arm_solver().step(first, dt=0.01, target=target, measured=np.full(3, math.nan))
    without = arm_solver().step(first, dt=0.01, target=target)
    assert first.observed is not None
    for step in (blind, without):
        np.testing.assert_array_equal(present(step.observed).shifts, first.observed.shifts)
    again = pickle.loads(pickle.dumps(first))
    np.testing.assert_array_equal(again.observed.shifts, first.observed.shifts)
    assert arm_solver().step(first.q, dt=0.01, target=target).observed is None


def test_bad_readings_are_refused() -> None:
    target, q = sn.Target(TARGET), sn.solve(ARM, sn.Target(TARGET)).q
    wrong: Any = [1.0, 2.0]
    refused("measured", lambda: arm_solver().step(q, dt=0.01, target=target, measured=wrong), "pose (4, 4)")
    two = np.zeros((2, 3))
    refused("measured", lambda: arm_solver().step(q, dt=0.01, target=target, measured=two), "places")
    refused(
        "places", lambda: arm_solver().step(q, dt=0.01, target=target, measured=two, places=[0.5, 0.4]), "increasing"
    )
    refused("gain", lambda: arm_solver().step(q, dt=0.01, target=target, measured=TARGET, gain=0.0))
    refused("delay", lambda: arm_solver().step(q, dt=0.01, target=target, measured=TARGET, delay=-1))
