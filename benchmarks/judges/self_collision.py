"""Does the body run through itself? Centre lines sampled densely wherever they come near, in plain NumPy.

Two places of the backbone must be farther apart than the sum of their radii, unless they are neighbours: where the
radius is the same between them, nearer along it than pi radii; where it changes, each ahead of the other. The *gap* of
such a pair is its distance less both radii.
"""

import math
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.judges.kinematics import Backbones, Indices, arm_of, body_places, moving
from sinuous.base.checks import Floats
from sinuous.model.joints import Fixed
from sinuous.model.robot import Robot

Flags = NDArray[np.bool_]

FINEST = 0.05
"""How far a place may be from the nearest sample at last, both places of a pair together, as a share of the smaller of
their radii: the least gap that was seen is that much above the true one at most."""

MOST_HALVINGS = 14

FEW, PLACES, MORE_PLACES = 32, 25, 97
"""Configurations of an arm with joints that are few, places along a capsule or a segment where many are looked at, and
where few are."""

KINK = 1e100
"""Curvature of a segment that bends without any length."""


class Seen(NamedTuple):
    """What sampling found of m configurations.

    Attributes
    ----------
    least : ndarray (m,)
        Least gap that was seen: never below the true one. Infinite where no pair counts.
    doubtful : ndarray (m,) of bool
        Whether a gap below what was asked for, or below `least`, may lie between the finest samples.
    """

    least: Floats
    doubtful: Flags


class _Arcs(NamedTuple):
    """Pairs of arcs of one configuration each, all the same fraction of their segments.

    Attributes
    ----------
    shape, first, second : ndarray (p,) of int
        Which configuration, and the segments that the arcs are of.
    a, b : ndarray (p,)
        Where the middles of the arcs lie, from 0 to 1 on their segments.
    """

    shape: Indices
    first: Indices
    second: Indices
    a: Floats
    b: Floats

    def only(self, chosen: Flags) -> "_Arcs":
        return _Arcs(self.shape[chosen], self.first[chosen], self.second[chosen], self.a[chosen], self.b[chosen])

    def halved(self, part: float) -> "_Arcs":
        """Every pair as four; the halves are so large a `part` of their segments."""
        aside = np.tile(0.5 * part * np.array([[-1.0, -1.0, 1.0, 1.0], [-1.0, 1.0, -1.0, 1.0]]), len(self.a))
        shape, first, second = (np.repeat(which, 4) for which in self[:3])
        return _Arcs(shape, first, second, np.repeat(self.a, 4) + aside[0], np.repeat(self.b, 4) + aside[1])


def look(robot: Robot, q: Floats, below: float = math.inf) -> Seen:
    """Look for the least gaps of configurations (m, n, 3), where they are less than `below`.

    All pairs of segments are halved as long as a smaller gap than seen, less than `below`, may lie between the samples:
    a place of an arc is no farther from its middle than half the arc is long. Where a stretch between two places turns
    by less than half a turn, its chord is no shorter than that of a circle of its largest curvature (Schur 1921). Links
    are sampled.
    """
    if robot.joints:
        return Seen(_least_of_links(robot, q, below), np.zeros(len(q), bool))
    found = Seen(np.full(len(q), math.inf), np.zeros(len(q), bool))
    radii, body = np.array(robot.radii), Backbones.of(robot, q)
    bends = np.hypot(q[..., 0], q[..., 1])
    turned = np.cumsum(bends, axis=1) - bends
    runs = np.concatenate([[0], np.cumsum(np.diff(radii) != 0.0)])
    i, j = np.triu_indices(len(robot))
    thick = (radii[i] > 0.0) & (radii[j] > 0.0)
    i, j, count = np.tile(i[thick], len(q)), np.tile(j[thick], len(q)), int(thick.sum())
    curvature = _curvatures(q)
    middles = np.full(len(i), 0.5)
    arcs, part = _Arcs(np.repeat(np.arange(len(q)), count), i, j, middles, middles), 1.0
    for _ in range(MOST_HALVINGS):
        shape, first, second, a, b = arcs
        l_a, l_b = q[shape, first, 2], q[shape, second, 2]
        along = np.abs(body.before[shape, second] + b * l_b - body.before[shape, first] - a * l_a)
        loose = 0.5 * part * (l_a + l_b)
        across = body.places(shape, second, b) - body.places(shape, first, a)
        apart = np.linalg.norm(across, axis=-1)
        gap = apart - radii[first] - radii[second]
        counted = math.pi * np.maximum(radii[first], radii[second])
        stepped = runs[first] != runs[second]
        ahead = np.minimum(
            (across * body.tangents(shape, first, a)).sum(axis=-1),
            (across * body.tangents(shape, second, b)).sum(axis=-1),
        )
        u_a, u_b = bends[shape, first], bends[shape, second]
        turn = turned[shape, second] + b * u_b - turned[shape, first] - a * u_a
        astray = (ahead <= 0.0) & (turn >= 0.5 * math.pi)
        np.minimum.at(found.least, shape, np.where(np.where(stepped, astray, along >= counted), gap, math.inf))
        wanted = np.minimum(found.least[shape], below)
        unsure = ahead <= loose + 0.5 * part * (apart + loose) * np.maximum(u_a, u_b)
        unsure &= turn + 0.5 * part * (u_a + u_b) >= 0.5 * math.pi
        going = np.where(stepped, unsure, along + loose >= counted) & (gap - loose < wanted)
        most = curvature[shape, first, second]
        nearest = 0.5 * np.where(stepped, np.maximum(along - loose, 0.0), np.maximum(along - loose, counted))
        chord = 2.0 * nearest * np.sinc(np.minimum(most * nearest / math.pi, 1.0))
        going &= (most * (along + loose) > math.pi) | (chord - radii[first] - radii[second] < wanted)
        fine = loose <= FINEST * np.minimum(radii[first], radii[second])
        found.doubtful[shape[going & fine]] = True
        part *= 0.5
        arcs = arcs.only(going & ~fine).halved(part)
        if len(arcs.a) == 0:
            return found
    found.doubtful[arcs.shape] = True
    return found


def _curvatures(q: Floats) -> Floats:
    """Largest curvature (m, n, n) between the beginning of one segment and the end of another."""
    bends = np.hypot(q[..., 0], q[..., 1])
    own = np.divide(bends, q[..., 2], out=np.where(bends > 0.0, KINK, 0.0), where=q[..., 2] > 0.0)
    upwards = np.triu(np.broadcast_to(own[:, None], (*own.shape, own.shape[1])))
    return np.asarray(np.maximum.accumulate(upwards, axis=2))


def surely_clear(robot: Robot, q: Floats) -> Flags:
    """Say of configurations (m, n, 3) whether it is certain that no pair of places is too near; false also in doubt."""
    seen = look(robot, q, 0.0)
    return np.asarray((seen.least > 0.0) & ~seen.doubtful)


def places_of(q: Floats) -> int:
    """Return at how many places along each part of an arm with joints configurations (m, rows, 3) are looked at."""
    return MORE_PLACES if len(q) < FEW else PLACES


def _least_of_links(robot: Robot, q: Floats, below: float) -> Floats:
    """Return the least distance (m,) of a body with joints from itself that is seen.

    Links may touch those next to them, those next but for links without a body, and those that a joint names; the first
    segment may touch the last link with a body.
    """
    bodies, own = body_places(robot, q, places_of(q)), moving(robot.joints)
    links, least = len(own), np.full(len(q), math.inf)
    chain = sorted({link for link, _, _ in bodies if link <= links} | {links + 1})
    free = {*pairwise(chain)} | {(i, i + 1) for i in range(links + 1)} | _named(robot)
    for (one, first, r), (other, second, s) in combinations(bodies, 2):
        pair = min(one, other), max(one, other)
        if one == other or pair in free or pair[0] > links:
            continue
        middle = first[:, :1]
        a, b = first - middle, second - middle
        squares = (a * a).sum(-1)[:, :, None] + (b * b).sum(-1)[:, None] - 2.0 * a @ np.swapaxes(b, 1, 2)
        least = np.minimum(least, np.sqrt(squares.min(axis=(1, 2)).clip(0.0)) - r - s)
    arm = arm_of(robot)
    return least if arm is None else np.minimum(least, look(arm, robot.split(q)[1], below).least)


def _named(robot: Robot) -> set[tuple[int, int]]:
    """Pairs of links that joints say may touch, the lower number first."""
    link, number, pairs = 0, {"base": 0}, set[tuple[int, int]]()
    for i, joint in enumerate(robot.joints, 1):
        link += not isinstance(joint, Fixed)
        number[joint.name or f"j{i}"] = link
    for i, joint in enumerate(robot.joints, 1):
        own = number[joint.name or f"j{i}"]
        pairs |= {(min(own, number[name]), max(own, number[name])) for name in joint.touches}
    return pairs
