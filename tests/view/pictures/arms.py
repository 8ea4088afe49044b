"""What the tests of pictures draw."""

import numpy as np

import sinuous as sn
from tests.helpers import Floats
from tests.scene.shapes import cube

ROBOT = sn.Robot.uniform(3, (0.8, 1.2), radius=0.05, mount=0.2, tool=sn.pose((0, 0, 0.2)), tendons=sn.Tendons(3, 0.04))
SCENE = sn.Scene(
    [
        sn.Sphere((2, 0, 1), 0.3),
        sn.Box((-1, 0, 1), (0.3, 1, 1)),
        sn.Capsule((-3, 2, 1), (3, 2, 1), 0.1),
        sn.Cylinder((0, -1.5, 0), (0, -1.5, 3), 0.2),
        sn.HalfSpace((0, 0, -0.5), (0, 0, 1)),
        sn.Sphere((0, 0, 0), 8, inside=True),
        sn.Box((0, 0, 0), (12, 12, 12), inside=True),
        sn.Cylinder((0, 0, -6), (0, 0, 6), 6, inside=True),
        sn.Mesh(*cube(0.5, (-2, -2, 2)), name="solid"),
        sn.Mesh(cube()[0] + [2, 2, 2], cube()[1][1:], name="shell"),
        sn.Mesh(*cube(15.0), inside=True),
        sn.PointCloud(np.random.default_rng(0).normal(size=(500, 3)) * 0.2 + [2, -2, 1], 0.02),
        sn.Grid(np.ones((2, 3, 4), bool), (2, 0, 3), 0.1),
        sn.Grid(np.zeros((2, 2, 2), bool), (2, 0, 3), 0.1),
        sn.Field(lambda p: np.linalg.norm(p - [-2, 1, 3], axis=-1) - 0.3, (-9, -9, -9), (9, 9, 9), 0.3),
    ]
)
BALL = [sn.Sphere((2, 0, 1), 0.3, name="ball")]
TARGETS: list[sn.Target | list[sn.Target]] = [
    sn.Target((0.5, 0.5, 2.4), direction=(0, 0, 1)),
    [sn.Target(rotation=(1, 0, 0, 0)), sn.Target((0, 0, 1), segment=1)],
    sn.Target(direction=(1, 0, 0)),
    sn.Target((0, 0, 9)),
]
PATH = [sn.Target((0.5, y, 2.4)) for y in np.linspace(0, 1, 12)]


def share_of(pixels: Floats, colour: tuple[float, float, float], within: float = 0.12) -> float:
    """Share of pixels (h, w, 3 or more), 0 to 1 each, whose colour is about this one."""
    return float((np.abs(pixels[..., :3] - np.array(colour)).max(axis=-1) < within).mean())
