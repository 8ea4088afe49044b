"""Looks at single times of a motion: what overlaps then is seen, whatever was seen before."""

import math

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.between.obstacles import Aim
from sinuous.kernels.between.proof import narrow_obstacles, touches_at
from sinuous.kernels.between.sweep import (
    BALL_WIDTH,
    DRIFT_WIDTH,
    KNOTS,
    LEAST,
    LEVELS,
    PACE_WIDTH,
    SEEN_WIDTH,
    Motion,
    Sweep,
)
from sinuous.kernels.body.self_pairs import SPAN_WIDTH
from sinuous.kernels.chain.rates import RATES_WIDTH
from sinuous.kernels.clock import CLOCK_SIZE, DEADLINE
from sinuous.kernels.fields.distances import Scene
from sinuous.kernels.packing import pose_row
from sinuous.scene.snapshot import Snapshot

ROBOT = sn.Robot([sn.Segment(1.0, 2.0, radius=0.05)] * 2)


def sweep_of(m: int) -> Sweep:
    """Scratch of `ROBOT` among m obstacles, as `carve_sweep` lays it out; of no obstacle the ball is known."""
    n = len(ROBOT)
    frames = np.zeros((KNOTS, n + 1, 12))
    frames[:, 0] = pose_row(ROBOT.base)
    each, clock = np.tile(np.arange(m), (n, 1)), np.zeros(CLOCK_SIZE, np.int64)
    clock[DEADLINE] = np.iinfo(np.int64).max
    return Sweep(
        np.zeros((KNOTS, n, 3)),
        frames,
        each,
        np.full(n, m),
        each.copy(),
        np.zeros((LEVELS + 2, n), np.int64),
        np.zeros((n, RATES_WIDTH)),
        np.zeros((KNOTS, n + 1, SPAN_WIDTH)),
        np.zeros(m, np.int64),
        np.zeros(n * (n + 1) // 2, np.int64),
        np.zeros(LEVELS + 2, np.int64),
        np.zeros((m, PACE_WIDTH)),
        np.full((m, BALL_WIDTH), math.inf),
        np.zeros((0, DRIFT_WIDTH)),
        clock,
    )


@pytest.mark.parametrize("before", [math.inf, -0.5])
def test_an_overlap_is_seen_also_after_a_deeper_one(before: float) -> None:
    # Straight up until the middle of the time, then bent to the side; beside the tip stands a sphere.
    q0, q1 = (np.array([[bend, 0.0, 1.0], [bend, 0.0, 1.0]]) for bend in (-0.6, 0.6))
    snapshot = Snapshot((sn.Sphere([0.2, 0.0, 1.9], 0.2), sn.Sphere([9.0, 0.0, 0.0], 0.2)))
    scene = Scene(snapshot.table.copy(), np.empty(0))
    sweep, aim, seen = sweep_of(2), Aim(1.0, 0.01, 0.0, 0.0, False), np.zeros((2, SEEN_WIDTH))
    motion = Motion(ROBOT.limits.copy(), q0, q1, scene, True, sweep.still)
    narrow_obstacles(motion, sweep, aim, seen)
    assert 1 in sweep.counts[1]  # the one that is near, and not the one that is far
    for t, touches in ((0.5, True), (0.0, False)):
        seen[:, LEAST] = before
        q = (1.0 - t) * q0 + t * q1
        assert (snapshot.distance(ROBOT.backbone(q, 50)).min() < 0.05) == touches
        assert touches_at(motion, t, sweep, aim, seen) == touches
