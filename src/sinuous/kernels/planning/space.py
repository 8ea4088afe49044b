"""The space of configurations: how far apart two are, random ones, and which motions between them are clear.

A bend of a segment moves what lies beyond it by at most the bend times the length from there to the tip. So a change of
a bend counts by that length, its lever; a change of a length by itself.

`p` (n, 3) and `q` (n, 3) are configurations, `levers` (n,) squares of levers (length unit).
"""

import math
from collections import namedtuple

import numpy as np

from sinuous.kernels.certificate.obstacles import Accuracy
from sinuous.kernels.certificate.proof import (
    bound_again,
    certify,
    certify_again,
    forget,
    narrow_obstacles,
    touches_at,
    touches_too,
)
from sinuous.kernels.certificate.self_proof import passed_over
from sinuous.kernels.certificate.sweep import Motion
from sinuous.kernels.chain.kinematics import interpolate
from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.step.actuation import admissible_step, approach_held_values
from sinuous.kernels.step.scattered import scattered, uniform

MOTION_PARTS = 8
"""Into how many parts a long motion is divided by the configurations that are examined before it is proved."""

EDGE_PARTS, SHORT_EDGE_PARTS = 4, 2
"""The same for an edge of a tree, and for one that was cut short: a proof that fails is dearer than these
evaluations."""

NEAR = 3.0
"""Two times are near when one is no more than so many times the other: one evaluation more is taken between them."""

Space = namedtuple("Space", ["robot", "scene", "mount", "levers", "sweep", "seen"])
"""The robot and the scene; length of backbone that obstacles do not concern; squares of the levers (n,); the scratch of
the proof, and what it saw (2, 6)."""


def squared_distance(p: Array, q: Array, levers: Array, most: float) -> float:
    """Square of the distance of two configurations (n, 3); of what is above `most` only that it is."""
    total = 0.0
    for k in range(p.shape[0]):
        x, y, z = p[k, 0] - q[k, 0], p[k, 1] - q[k, 1], p[k, 2] - q[k, 2]
        total += levers[k] * (x * x + y * y) + z * z
        if total > most:
            break
    return total


def distance(p: Array, q: Array, levers: Array) -> float:
    """Distance of two configurations (n, 3), in the length unit."""
    return math.sqrt(squared_distance(p, q, levers, math.inf))


def random(index: int, seed: int, which: int) -> float:
    """A number in [0, 1): random number `which`, of 2, for each index and seed."""
    return uniform(np.uint64(seed) * np.uint64(0x9E3779B1) + np.uint64(2 * index + which) * np.uint64(0x85EBCA77))


def draw(space: Space, start: Array, index: int, seed: int, out: Array) -> None:
    """Fill `out` (n, 3) with random configuration number `index`: within all limits when `start` (n, 3) is."""
    scattered(space.robot.limits, index, seed, 2.0 * math.pi, out)
    approach_held_values(space.robot.limits, space.robot.actuation, out)
    interpolate(start, out, admissible_step(space.robot.actuation, start, out), out)


def _edge(space: Space, p: Array, q: Array) -> Motion:
    """The motion from `p` to `q` (n, 3), in which no obstacle moves."""
    return Motion(space.robot.limits, p, q, space.scene, space.robot.avoids_itself, space.sweep.still)


def seems_clear(space: Space, p: Array, q: Array, finest: float) -> bool:
    """Whether nothing is seen to touch on the way from `p` to `q` (n, 3), at seven times, the middle first.

    Then the space has `seen` the least of all of them, and `bound_edge` goes on from there.
    """
    motion = _edge(space, p, q)
    accuracy = Accuracy(1.0, finest, 0.0, space.mount, False)
    narrow_obstacles(motion, space.sweep, accuracy, space.seen)
    forget(space.seen)
    parts = 2
    while parts <= MOTION_PARTS:
        for i in range(1, parts, 2):
            if touches_too(motion, i / parts, space.sweep, accuracy, space.seen):
                return False
        parts *= 2
    return True


def probe_edge(space: Space, p: Array, q: Array, back: float, least: float, finest: float) -> float:
    """Until when the way from `p` to `q` (n, 3) may be worth a step; 0: it is not.

    What is left ends `back` before the time when something touches, and below `least` it is worth nothing. It is
    checked at where it ends, then in between. Where something touches at its end, the first check is where the least
    would be: most ways that go nowhere are stopped there. Then evaluations go on between the last time when nothing
    touches and the first when something does, by their geometric mean.
    """
    motion = _edge(space, p, q)
    accuracy = Accuracy(1.0, finest, 0.0, space.mount, False)
    narrow_obstacles(motion, space.sweep, accuracy, space.seen)
    clear, touching, parts = 1.0, math.inf, EDGE_PARTS
    if touches_at(motion, 1.0, space.sweep, accuracy, space.seen):
        clear, touching, parts = min(0.5, back + least), 1.0, SHORT_EDGE_PARTS
        if touches_at(motion, clear, space.sweep, accuracy, space.seen):
            return 0.0
        clear, touching = _bracket_contact(space, motion, accuracy, clear, touching)
        if touching < back + least:
            return 0.0
    end, divided = clear, 2
    while divided <= parts and clear == end:
        for i in range(1, divided, 2):
            t = end * i / divided
            if touches_at(motion, t, space.sweep, accuracy, space.seen):
                clear, touching = _bracket_contact(space, motion, accuracy, t - end / divided, t)
                break
        divided *= 2
    return max(0.0, min(clear, touching - back))


def _bracket_contact(
    space: Space, motion: Motion, accuracy: Accuracy, clear: float, touching: float
) -> tuple[float, float]:
    """Look between a time when nothing touches and one when something does; return two such times that are near."""
    while True:
        nearer = touching <= NEAR * clear or clear == 0.0
        t = 0.5 * (clear + touching) if nearer else math.sqrt(clear * touching)
        if touches_at(motion, t, space.sweep, accuracy, space.seen):
            touching = t
        else:
            clear = t
        if nearer:
            return clear, touching


def prove_edge(space: Space, p: Array, q: Array, finest: float, prefix: bool) -> tuple[int, float]:
    """Verdict about the motion from `p` to `q` (n, 3), and until when it is proved; see `certify` and `Accuracy`."""
    return certify(_edge(space, p, q), space.sweep, Accuracy(1.0, finest, 0.0, space.mount, prefix), space.seen)


def bound_edge(space: Space, p: Array, q: Array, slack: float, finest: float) -> tuple[int, float]:
    """The same for a motion that was examined last, or proved without a tight bound; see `certify_again`."""
    return certify_again(_edge(space, p, q), space.sweep, Accuracy(slack, finest, 0.0, space.mount, False), space.seen)


def bound_edge_again(space: Space, p: Array, q: Array, slack: float, finest: float, row: int) -> bool:
    """Bound one row of what is `seen` of a motion that is proved clear more tightly; see `bound_again`."""
    motion = _edge(space, p, q)
    return bound_again(motion, space.sweep, Accuracy(slack, finest, 0.0, space.mount, False), space.seen, row)


def best_bound(space: Space, p: Array, q: Array, row: int) -> float:
    """What the lower bound of a row of `seen` is no greater than, however tight it is for the motion from `p` to `q`.

    Gaps of the body that are never examined have one bound for all of the motion.
    """
    return float(passed_over(space.robot.limits, p, q)) if row == 1 else math.inf
