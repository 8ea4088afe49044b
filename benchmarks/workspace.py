"""`workspace`: maps of three robots that others published, against `solve` at places that were drawn at random.

A map says a volume and by how much it may be off. Places drawn in the box of the map are solved one by one, with many
starts; the share that is solved, of the volume of the box, is the same volume, known as well as the number of places
allows. Tips of random shapes judge a map without any solve: they must be in voxels that are reached, or beside them.
"""

import math
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
from scipy.ndimage import binary_dilation

import sinuous as sn
from benchmarks.harness import Goal, Line, Part, Plan
from benchmarks.problems import random_configurations
from benchmarks.real import captured_robot
from sinuous.base.checks import Floats

PLACES, SHAPES = 20_000, 20_000
"""Places that are solved, and shapes whose tips are looked up, in a whole run."""

STARTS = 10
"""Starts of each solve."""

IN_CONE = 12
"""Random directions in a cone, and random shapes that solves of a position begin from, which are tried at a place."""

WITHIN = math.radians(20.0)

DEVIATIONS = 3.0
"""Standard deviations of the share of random places that count as their error."""


def _rods() -> sn.Robot:
    """Two segments of 0.2 m, three tendons each (Rao, Peyron, Lilge & Burgner-Kahrs 2021)."""
    lines = sn.Tendons(count=3, radius=0.01, angle=math.pi / 2)
    return sn.Robot([sn.Segment(0.2, max_bend=math.pi, tendons=lines)] * 2, radius=0.012)


def _obstacles(robot: sn.Robot) -> list[sn.Sphere]:
    """Two balls beside the robot."""
    size = robot.mean_length
    places = ((0.45, 0.1, 0.6), (-0.2, -0.4, 0.7))
    return [sn.Sphere(tuple(size * np.array(place)), radius=0.18 * size) for place in places]


def _sampled(robot: sn.Robot, found: sn.studies.Reach, plan: Plan, count: int) -> tuple[float, float]:
    """Volume that is solved among random places in the box of a map, and how far it may be off."""
    low = found.voxels.first - 0.5 * found.voxels.spacing
    high = low + found.voxels.spacing * np.array(found.voxels.shape)
    rng = plan.rng(1)
    places = rng.uniform(low, high, (count, 3))
    solver = sn.Solver(robot, _obstacles(robot), max_starts=STARTS, routes=False, time=0.05)
    once = sn.Solver(robot, _obstacles(robot), max_starts=1, routes=False)
    solved = np.zeros(count, np.bool_)
    for _ in range(IN_CONE if len(found.directions) else 1):
        left = np.flatnonzero(~solved)
        if len(found.directions):
            some = once.solve_many(positions=places[left], initial=random_configurations(robot, len(left), rng))
            along = robot.tip(some.q)[:, :3, 2] @ found.directions[0]
            aimed = solver.solve_many(positions=places[left], directions=_in_cone(found.directions[0], len(left), rng))
            solved[left] = (some.solved & (along > math.cos(WITHIN))) | aimed.solved
        else:
            solved[left] = solver.solve_many(positions=places[left]).solved
    share = float(solved.mean())
    box = float(np.prod(high - low))
    return box * share, DEVIATIONS * box * math.sqrt(max(share * (1.0 - share), 1.0 / count) / count)


def _in_cone(axis: Floats, count: int, rng: np.random.Generator) -> Floats:
    """Directions (count, 3), even on the part of the sphere that is within the angle."""
    z, turn = rng.uniform(math.cos(WITHIN), 1.0, count), rng.uniform(0.0, math.tau, count)
    first = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    first /= np.linalg.norm(first)
    ring = np.cos(turn)[:, None] * first + np.sin(turn)[:, None] * np.cross(axis, first)
    return np.asarray(z[:, None] * axis + np.sqrt(1.0 - z * z)[:, None] * ring)


def _missed(robot: sn.Robot, found: sn.studies.Reach, plan: Plan, count: int) -> float:
    """Share, in %, of tips of random shapes that are clear, in voxels of which none around is reached."""
    rng = plan.rng(2)
    tips: list[Floats] = []
    scene = sn.Scene(_obstacles(robot)).snapshot()
    while sum(map(len, tips)) < count:
        q = random_configurations(robot, count, rng)
        clear = (scene.distance(robot.backbone(q, 8)) > max(robot.radii)).all(axis=-1)
        tips.append(robot.tip(q[clear])[:, :3, 3])
    near = binary_dilation(found.reachable, np.ones((3, 3, 3), np.bool_))
    at = np.rint((np.concatenate(tips)[:count] - found.voxels.first) / found.voxels.spacing).astype(int)
    return 100.0 * float((~near[tuple(np.clip(at, 0, np.array(near.shape) - 1).T)]).mean())


def map_robot(name: str, plan: Plan) -> Iterator[Line]:
    """Hold the maps of a robot, of positions and within a cone, against solves at random places."""
    robot = _rods() if name == "rods" else captured_robot(name).changed(radius=6.0)
    count = plan.count(PLACES, 300)
    spacing = None if not plan.quick else 0.12 * robot.mean_length
    cones: dict[str, dict[str, Any]] = {
        "positions": {},
        "tip within 20 degrees of z": {"directions": (0, 0, 1), "within": WITHIN},
    }
    for what, cone in cones.items():
        found = sn.studies.reach(robot, _obstacles(robot), spacing, progress=False, **cone)
        volume = found.volume(dexterous=bool(cone))
        sampled, unsure = _sampled(robot, found, plan, count // (4 if cone else 1))
        off = abs(volume.found - sampled)
        told = f"map {volume.found:.4g}, {found.seconds:.1f} s; places {sampled:.4g} +- {unsure:.2g}"
        goal = Goal(1.0, correctness=True)
        yield Line(name, f"{what}: off, of the stated error", off / (volume.error + unsure), "", goal, note=told)
        yield Line(name, f"{what}: stated error of the volume", 100.0 * volume.error / volume.found, "%")
        if not cone:
            beside = _missed(robot, found, plan, plan.count(SHAPES, 500))
            yield Line(name, "tips of random shapes beside the map", beside, "%")


PARTS: dict[str, Part] = {name: partial(map_robot, name) for name in ("v4", "v6", "rods")}
"""What is measured, by name."""
