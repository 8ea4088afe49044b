"""What remembered starts bring: many targets in one place, for a solver with a memory and for one without.

The targets are those of shapes that the judge finds free, a random walk away from the hidden one.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

import sinuous as sn
from benchmarks.clutter.ways import Row, timed
from benchmarks.judges.kinematics import tip_poses
from benchmarks.places import Place, make
from benchmarks.places.place import feasible, right

AGAINST = {"with a memory": "without", "without": "without"}

SHORTEST, LONGEST = 1e-3, 0.5
"""Standard deviation of a step away from a shape, rad, drawn between these with equal shares of each size."""

LENGTH_SHARE = 0.3
"""The same of lengths, in longest lengths of a segment a radian."""

PATIENCE = 60
"""Draws for each target."""


def targets_about(place: Place, count: int, rng: np.random.Generator) -> Iterator[Place]:
    """Yield the same place with other hidden shapes and targets, all feasible: at most `count`."""
    lengths = np.array([segment.length for segment in place.robot.segments])
    scale = np.array([1.0, 1.0, LENGTH_SHARE * lengths[:, 1].max()])
    shapes = [place.hidden_q]
    for _ in range(PATIENCE * count):
        step = np.exp(rng.uniform(np.log(SHORTEST), np.log(LONGEST)))
        q = shapes[rng.integers(len(shapes))] + step * scale * rng.standard_normal(place.hidden_q.shape)
        q[:, 2] = np.clip(q[:, 2], lengths[:, 0], lengths[:, 1])
        tip = tip_poses(place.robot, q[None])[0]
        direction = None if place.target.direction is None else tip[:3, 2]
        other = replace(place, targets=(sn.Target(tip[:3, 3], direction=direction),), hidden_q=q)
        if feasible(other):
            shapes.append(q)
            yield other
            if len(shapes) > count:
                return


def examined(family: str, seed: int, count: int) -> Iterator[Row]:
    """Ask all targets of one place."""
    place = make(family, seed)
    others = list(targets_about(place, count, np.random.default_rng(seed)))
    for way, memory in zip(AGAINST, (sn.Memory(place.robot), None), strict=True):
        solver = sn.Solver(place.robot, place.scene, memory=memory, tolerance=place.tolerance)
        solver.solve(place.targets)
        for other in others:
            solution, spent = timed(solver.solve, other.targets)
            fine = solution.solved and right(other, solution.q)
            yield Row(family, way, fine, solution.solved and not fine, spent)
