"""Training: what is learned, and what is refused."""

import numpy as np

import sinuous as sn
from sinuous.methods import learned
from tests.helpers import refused
from tests.methods import laws

WALL = sn.HalfSpace((30, 0, 0), (-1, 0, 0))


def test_drawn_shapes_keep_the_limits() -> None:
    robot = sn.Robot([sn.Segment(length=(1, 2), max_bend=0.5), sn.Segment(length=1, max_curvature=0.3)])
    q = learned._draw(robot, 500, np.random.default_rng(0))
    bends = np.linalg.norm(q[:, :, :2], axis=-1)
    assert (bends.max(axis=0) <= (0.5, 0.3)).all()
    assert (bends.max(axis=0) > (0.45, 0.28)).all()
    assert q[:, 0, 2].min() < 1.05
    assert (q[:, 1, 2] == 1.0).all()


def test_among_obstacles_what_is_clear_is_learned() -> None:
    scene = sn.Scene([WALL])
    rows, shapes = learned._lessons(laws.ARM, scene, 0, 300, np.random.default_rng(0))
    assert len(rows) == len(shapes) >= learned.FEWEST_TARGETS
    assert rows[:, 0].max() < 30.0
    for q in shapes[:20].reshape(-1, 5, 3):
        assert laws.ARM.backbone(q)[..., 0].max() < 30.0


def test_where_nothing_is_clear_the_robot_alone_is_learned() -> None:
    rows, _ = learned._lessons(laws.ARM, sn.Scene([sn.Sphere((0, 0, 0), 500)]), 0, 300, np.random.default_rng(0))
    assert len(rows) > 200


def test_what_is_no_training_is_refused() -> None:
    refused("robot", lambda: sn.methods.train("arm"))  # type: ignore[arg-type]
    refused("samples", lambda: sn.methods.train(laws.ARM, samples=3))
    refused("width", lambda: sn.methods.train(laws.ARM, width=0))
    refused("rounds", lambda: sn.methods.train(laws.ARM, rounds=0))
    refused("seed", lambda: sn.methods.train(laws.ARM, seed=-1))
    heavy = sn.Robot([sn.Segment(length=1, mass=1)], gravity=(0, 0, -9.81), stiffness=sn.Stiffness(1.0))
    refused("gravity", lambda: sn.methods.train(heavy))
