"""The costs of arcs are those of the paper."""

import math
from typing import Any

import numpy as np

from sinuous.methods.opti_path.gradient import Setting, Weights
from sinuous.methods.opti_path.options import OptiPath
from sinuous.methods.opti_path.path import Aim
from sinuous.methods.opti_path.potential import Potential
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene
from tests.helpers import Floats, kernel_scene, vec
from tests.methods.opti_path.test_path import N

SCENE = Scene([Sphere((0.9, 0.3, 1.5), 0.4), Sphere((-0.3, 0.2, 3.0), 0.5), Sphere((0.4, -0.5, 4.5), 0.4)])
WEIGHTS = Weights(1.3, 0.7, 0.9, 0.4)
GOAL = np.array([0.6, -0.64, 0.48])
REACH = 0.6


def setting(**changes: Any) -> Setting:
    return Setting(*(float(x) for x in OptiPath(**changes).vector()))


def aim(directed: bool = True) -> Aim:
    return Aim((0.0, 0.0, 0.0), vec(GOAL), directed, 1.0)


def field() -> Potential:
    return Potential(kernel_scene(SCENE), np.empty((0, 0, 0)), (0.0, 0.0, 0.0), 1.0, 1.2, REACH, 0.05)


def c_of(p: Floats) -> float:
    d = float(SCENE.distance(p)) - 0.05
    return 1.2 * (0.5 * REACH - d) if d < 0.0 else 0.6 / REACH * (d - REACH) ** 2 if d < REACH else 0.0


def arc_costs(points: Floats, chosen: OptiPath) -> tuple[Floats, Floats]:
    """Costs F_j of all arcs, without and of the obstacles: plain NumPy, the paper's words."""
    t, shapes, bodies = np.array([0.0, 0.0, 1.0]), [], []
    for j in range(N):
        a, b = points[j], points[j + 1]
        chord = float(np.linalg.norm(b - a))
        e = (b - a) / chord
        x = math.acos(float(np.clip(t @ e, -1.0, 1.0)))
        length = chord * x / math.sin(x)
        inset = 0.5 * (1.0 - chosen.dead_band) * 0.4
        miss = max(0.0, length - (1.2 - inset)) + max(0.0, 0.8 + inset - length)
        over = max(0.0, 2.0 * x - 2.0)
        shape = WEIGHTS.length * miss**2 + WEIGHTS.bends * over**2
        body = 0.0
        for s in range(1, chosen.samples + 1):
            u = s / (chosen.samples + 1)
            w, h = t @ e, 0.5 * chord
            top = (1 - u) ** 2 * a + 2 * u * (1 - u) * (w * a + h * t) + u**2 * b
            body += c_of(top / ((1 - u) ** 2 + 2 * u * (1 - u) * w + u**2))
        bodies.append(WEIGHTS.obstacles * chosen.arcs_weight * length * body / chosen.samples)
        t = 2.0 * (t @ e) * e - t
        if j == N - 1:
            far = float(np.linalg.norm(t - GOAL))
            shape += WEIGHTS.orientation * (far if chosen.orientation == "norm" else far**2)
        shapes.append(shape)
    return np.array(shapes), np.array(bodies)
