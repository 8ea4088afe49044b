"""Large scenes: meshes, and up to 10,000 parts.

Of a mesh the time to prepare it, and what it adds to a solve; `motion` replaces clouds in control loops. Of parts what
a distance costs by their number, how long they take to prepare, and to change.
"""

import os
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from operator import itemgetter
from time import process_time
from unittest.mock import patch

import numpy as np

import sinuous as sn
from benchmarks.harness import Goal, Line, Plan, timed
from benchmarks.places import solids
from benchmarks.problems import arm, reachable
from benchmarks.speed.solves import answered
from sinuous.base.checks import Floats
from sinuous.kernels.tables import MANY_OBSTACLES
from sinuous.scene.obstacles import Obstacle

MESHES = "large meshes"
SIDES = 224
"""Of a ball, around and from pole to pole: 99,904 triangles."""


def measure_meshes(plan: Plan) -> Iterator[Line]:
    """Prepare a mesh with and without the samples on disk, and solve beside it."""
    surface = solids.ball(np.zeros(3), 1.0, plan.count(SIDES, 32))
    with tempfile.TemporaryDirectory() as folder, patch.dict(os.environ, {"XDG_CACHE_HOME": folder}):
        sn.Scene([solids.ball(np.zeros(3), 1.0, 18).mesh("ball")]).prepare()  # loads the kernels, or compiles them
        scene = sn.Scene([surface.mesh("ball")])
        what = f"a mesh of {len(surface.faces)} triangles"
        seconds = timed(scene.prepare)[1]
        note = f"{scene.memory / 1e6:.0f} MB"
        yield Line(MESHES, f"{what}, sampled", seconds, "s", Goal(10.0), note=note)
        seconds = timed(sn.Scene([surface.mesh("ball")]).prepare)[1]
        yield Line(MESHES, f"{what}, samples from disk", seconds, "s", Goal(1.0))
        yield from _beside(plan, surface)


def _beside(plan: Plan, surface: solids.Surface) -> Iterator[Line]:
    """Solve the same problems without a mesh, and with one out of reach."""
    free = reachable(arm(5, 2.4, radius=4.0), plan.count(500, 20), plan.rng(11))
    unit = free.robot.mean_length
    far = replace(
        free, scene=sn.Scene([sn.Mesh(0.4 * unit * surface.vertices + [1.8 * unit, 0.0, 0.0], surface.faces)])
    )
    what = f"{len(surface.faces)} triangles out of reach add to a solve of 5 segments"
    alone, beside = (answered(MESHES, what, [problems]) for problems in (free, far))
    assert alone.times is not None
    assert beside.times is not None
    added = max(beside.times.median - alone.times.median, 0.0)
    note = f"{1e6 * alone.times.median:.1f} us without; {beside.note}".rstrip("; ")
    yield replace(beside, reached=added, unit="us", goal=Goal(20e-6), note=note)


PARTS_OF_SCENES = "parts of a scene, evenly spread, CPU time"
COUNTS = (10, 100, 1_000, 10_000)
POINTS, STEP = 4_000, 0.03
"""Places on the way of a point that distances are asked at, and how far it goes between them."""

ROUNDS = 5
REACH, THICKNESS = 5.0, 0.1
"""How far the robot reaches for which cells are made, and the radius of its body."""

FACTOR, PREPARED, CHANGED = 3.0, 50e-3, 1e-3
"""Goals: the dearest distance over the cheapest; seconds to prepare the largest scene, and to move a part of it."""

Make = Callable[[Floats, Floats], Obstacle]


def _rod(place: Floats, way: Floats) -> Obstacle:
    return sn.Capsule(place - 0.8 * way, place + 0.8 * way, 0.04)


def _block(place: Floats, way: Floats) -> Obstacle:
    return sn.Box(place, (0.2, 0.4, 0.6), (*way, 0.5))


KINDS: dict[str, Make] = {"rods": _rod, "boxes": _block}


def measure_parts(plan: Plan) -> Iterator[Line]:
    """Ask distances along a way, in scenes of one density."""
    for kind, make in KINDS.items():
        times, cells = list[float](), list[float]()
        for count in COUNTS[: plan.count(len(COUNTS), 3)]:
            scene, prepared = min((_scene(make, count, plan.rng(21)) for _ in range(ROUNDS)), key=itemgetter(1))
            times.append(_asked(scene, count, plan.rng(22)))
            yield Line(PARTS_OF_SCENES, f"a distance and its gradient among {count} {kind}", times[-1], "us")
            yield Line(PARTS_OF_SCENES, f"preparing {count} {kind}", prepared, "ms", Goal(PREPARED))
            if count >= MANY_OBSTACLES:
                listed, again = _listed(scene, count, plan.rng(22))
                cells.append(again)
                yield Line(PARTS_OF_SCENES, f"the same once cells list who is near, {count} {kind}", cells[-1], "us")
                yield Line(PARTS_OF_SCENES, f"making these cells, {count} {kind}", listed, "ms")
            yield Line(PARTS_OF_SCENES, f"moving one of {count} {kind}", _moved(scene, plan), "ms", Goal(CHANGED))
        for what, own in (("", times), (" with cells", cells)):
            factor = max(own) / min(own)
            yield Line(PARTS_OF_SCENES, f"dearest over cheapest distance{what}, {kind}", factor, "x", Goal(FACTOR))


def _scene(make: Make, count: int, rng: np.random.Generator) -> tuple[sn.Scene, float]:
    """Return a scene with one part in each unit of volume, and how long it took to prepare."""
    places, ways = count ** (1.0 / 3.0) * (rng.random((count, 3)) - 0.5), rng.normal(size=(count, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    scene = sn.Scene([make(place, way) for place, way in zip(places, ways, strict=True)])
    return scene, timed(scene.prepare, clock=process_time)[1]


def _asked(scene: sn.Scene, count: int, rng: np.random.Generator) -> float:
    """Return the least time of a distance on a random walk within the middle of a scene."""
    side = 0.5 * min(count, COUNTS[0]) ** (1.0 / 3.0)
    points = np.clip(np.cumsum(STEP * rng.normal(size=(POINTS, 3)), axis=0), -side, side)
    scene.gradient(points[:1])
    return timed(scene.gradient, points, runs=ROUNDS, clock=process_time)[1] / POINTS


def _listed(scene: sn.Scene, count: int, rng: np.random.Generator) -> tuple[float, float]:
    """Return how long cells about the middle took, as a hard solve has them made, and what a distance costs then."""
    listed = timed(scene.snapshot().list_near, np.zeros(3), REACH, THICKNESS, clock=process_time)[1]
    return listed, _asked(scene, count, rng)


def _moved(scene: sn.Scene, plan: Plan) -> float:
    """Return the median time to move the first part."""
    places, name = plan.rng(23).normal(size=(20, 3)), scene.name(0)
    return float(np.median([timed(scene.move, name, place, clock=process_time)[1] for place in places]))
