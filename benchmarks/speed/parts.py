"""Scenes of up to 10,000 parts: what a distance costs by their number, how long they take to prepare, and to change."""

from collections.abc import Callable, Iterator
from operator import itemgetter
from time import process_time

import numpy as np

import sinuous as sn
from benchmarks.harness import Goal, Line, Plan
from sinuous.base.checks import Floats
from sinuous.kernels.tables import MANY_OBSTACLES
from sinuous.scene.obstacles import Obstacle

SECTION = "parts of a scene, evenly spread, CPU time"
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


def measure(plan: Plan) -> Iterator[Line]:
    """Ask distances along a way, in scenes of one density."""
    for kind, make in KINDS.items():
        times, cells = list[float](), list[float]()
        for count in COUNTS[: plan.count(len(COUNTS), 3)]:
            scene, prepared = min((_scene(make, count, plan.rng(21)) for _ in range(ROUNDS)), key=itemgetter(1))
            times.append(_asked(scene, count, plan.rng(22)))
            yield Line(SECTION, f"a distance and its gradient among {count} {kind}", times[-1], "us")
            yield Line(SECTION, f"preparing {count} {kind}", prepared, "ms", Goal(PREPARED))
            if count >= MANY_OBSTACLES:
                listed, again = _listed(scene, count, plan.rng(22))
                cells.append(again)
                yield Line(SECTION, f"the same once cells list who is near, {count} {kind}", cells[-1], "us")
                yield Line(SECTION, f"making these cells, {count} {kind}", listed, "ms")
            yield Line(SECTION, f"moving one of {count} {kind}", _moved(scene, plan), "ms", Goal(CHANGED))
        for what, own in (("", times), (" with cells", cells)):
            factor = max(own) / min(own)
            yield Line(SECTION, f"dearest over cheapest distance{what}, {kind}", factor, "x", Goal(FACTOR))


def _scene(make: Make, count: int, rng: np.random.Generator) -> tuple[sn.Scene, float]:
    """Return a scene with one part in each unit of volume, and how long it took to prepare."""
    places, ways = count ** (1.0 / 3.0) * (rng.random((count, 3)) - 0.5), rng.normal(size=(count, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    scene = sn.Scene([make(place, way) for place, way in zip(places, ways, strict=True)])
    began = process_time()
    scene.prepare()
    return scene, process_time() - began


def _asked(scene: sn.Scene, count: int, rng: np.random.Generator) -> float:
    """Return the least time of a distance on a random walk within the middle of a scene."""
    side = 0.5 * min(count, COUNTS[0]) ** (1.0 / 3.0)
    points = np.clip(np.cumsum(STEP * rng.normal(size=(POINTS, 3)), axis=0), -side, side)
    scene.gradient(points[:1])
    spent = []
    for _ in range(ROUNDS):
        began = process_time()
        scene.gradient(points)
        spent.append(process_time() - began)
    return min(spent) / POINTS


def _listed(scene: sn.Scene, count: int, rng: np.random.Generator) -> tuple[float, float]:
    """Return how long cells about the middle took, as a hard solve has them made, and what a distance costs then."""
    began = process_time()
    scene.snapshot().list_near(np.zeros(3), REACH, THICKNESS)
    return process_time() - began, _asked(scene, count, rng)


def _moved(scene: sn.Scene, plan: Plan) -> float:
    """Return the median time to move the first part."""
    rng, spent = plan.rng(23), []
    for _ in range(20):
        place = rng.normal(size=3)
        began = process_time()
        scene.move(scene.name(0), place)
        spent.append(process_time() - began)
    return float(np.median(spent))
