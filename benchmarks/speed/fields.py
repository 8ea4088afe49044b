"""Large meshes: time to prepare one, and what it adds to a solve; `motion` replaces clouds in control loops."""

import os
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from time import perf_counter
from unittest.mock import patch

import numpy as np

import sinuous as sn
from benchmarks.harness import Goal, Line, Plan
from benchmarks.places.parts import Surface, ball, solid
from benchmarks.problems import arm, reachable
from benchmarks.speed.solves import solve_all

SECTION = "large meshes"
SIDES = 224
"""Of a ball, around and from pole to pole: 99,904 triangles."""


def measure(plan: Plan) -> Iterator[Line]:
    """Prepare a mesh with and without the samples on disk, and solve beside it."""
    surface = ball(np.zeros(3), 1.0, plan.count(SIDES, 32))
    with tempfile.TemporaryDirectory() as folder, patch.dict(os.environ, {"XDG_CACHE_HOME": folder}):
        sn.Scene([solid(ball(np.zeros(3), 1.0, 18), "ball")]).prepare()  # loads the kernels, or compiles them
        scene = sn.Scene([solid(surface, "ball")])
        what = f"a mesh of {len(surface.faces)} triangles"
        seconds = _seconds(scene)
        note = f"{scene.memory / 1e6:.0f} MB"
        yield Line(SECTION, f"{what}, sampled", seconds, "s", Goal(10.0), note=note)
        seconds = _seconds(sn.Scene([solid(surface, "ball")]))
        yield Line(SECTION, f"{what}, samples from disk", seconds, "s", Goal(1.0))
        yield from _beside(plan, surface)


def _seconds(scene: sn.Scene) -> float:
    began = perf_counter()
    scene.prepare()
    return perf_counter() - began


def _beside(plan: Plan, surface: Surface) -> Iterator[Line]:
    """Solve the same problems without a mesh, and with one out of reach."""
    free = reachable(arm(5, 2.4, radius=4.0), plan.count(500, 20), plan.rng(11))
    unit = free.robot.mean_length
    alone = solve_all(free)
    far = replace(
        free, scene=sn.Scene([sn.Mesh(0.4 * unit * surface.vertices + [1.8 * unit, 0.0, 0.0], surface.faces)])
    )
    beside = solve_all(far)
    added = beside.times.median - alone.times.median
    what = f"{len(surface.faces)} triangles out of reach add to a solve of 5 segments"
    note = f"{1e6 * alone.times.median:.1f} us without; {beside.complaint}".rstrip("; ")
    yield Line(SECTION, what, max(added, 0.0), "us", Goal(20e-6), beside.times, beside.solved, note)
