"""Large meshes and live clouds: time to prepare a mesh, what it adds to a solve, and how fast a cloud is replaced."""

import os
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from time import perf_counter
from unittest.mock import patch

import numpy as np

import sinuous as sn
from benchmarks.harness.experiment import Plan
from benchmarks.harness.lines import Goal, Line, Times
from benchmarks.places.parts.surfaces import Surface, ball, solid
from benchmarks.problems import arm, reachable
from benchmarks.speed.solves import solve_all

SECTION = "large meshes and live clouds"
SIDES = 224
"""Of a ball, around and from pole to pole: 99,904 triangles."""

POINTS = 50_000
RESOLUTION = 0.01
"""Of the cloud, in the edge of the cube that it fills."""


def measure(plan: Plan) -> Iterator[Line]:
    """Prepare a mesh with and without the samples on disk, solve beside it, and replace a cloud again and again."""
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
    yield _updates(plan)


def _seconds(scene: sn.Scene) -> float:
    began = perf_counter()
    scene.prepare()
    return perf_counter() - began


def _beside(plan: Plan, surface: Surface) -> Iterator[Line]:
    """Solve the same problems without a mesh, and with one out of reach."""
    free = reachable(arm(5, 2.4, radius=4.0), plan.count(500, 20), plan.rng(11))
    unit = free.robot.mean_length
    alone = solve_all(plan, free, "nothing")
    far = replace(
        free, scene=sn.Scene([sn.Mesh(0.4 * unit * surface.vertices + [1.8 * unit, 0.0, 0.0], surface.faces)])
    )
    beside = solve_all(plan, far, "a mesh out of reach")
    added = beside.times.median - alone.times.median
    what = f"{len(surface.faces)} triangles out of reach add to a solve of 5 segments"
    note = f"{1e6 * alone.times.median:.1f} us without; {beside.complaint}".rstrip("; ")
    yield Line(SECTION, what, max(added, 0.0), "us", Goal(20e-6), beside.times, beside.solved, note)


def _updates(plan: Plan) -> Line:
    """Replace a cloud in a cube of edge 1, as a camera does, and count how often a second that goes."""
    rng = plan.rng(12)
    clouds = [np.round(rng.random((POINTS, 3)) / RESOLUTION) * RESOLUTION for _ in range(plan.count(20, 2))]
    scene = sn.Scene([sn.PointCloud(clouds[0], 0.5 * RESOLUTION)])
    scene.update(clouds[0])
    seconds = []
    for cloud in clouds:
        began = perf_counter()
        scene.update(cloud)
        seconds.append(perf_counter() - began)
    times = Times.of(seconds)
    return Line(SECTION, f"updates of a cloud of {POINTS} points", 1.0 / times.median, "/s", Goal(10.0, False), times)
