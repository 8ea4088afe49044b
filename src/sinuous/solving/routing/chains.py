"""Chains for narrow places: grown from the base and from the target, and joined where they nearly meet.

Either end may lie in a tube, before its mouth or in a cell, where the first segments have one way to go; a chain that
is grown from the other end is lost there. So chains are grown from both ends, by arcs that follow walls by themselves
(`kernels.growing`). Of k segments from the base and n - k from the target that nearly meet, one part is solved for the
pose in which the other begins: two problems of half the segments are far easier than one of all. An arc does not care
how it is turned about its tangent, so what is joined meets both ends.
"""

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.chain.batch import frames_of
from sinuous.kernels.solve.search import search
from sinuous.kernels.step.states import workspace_size
from sinuous.kernels.tables import (
    ANGLE_TOLERANCE,
    DIRECTION,
    FREE,
    GOAL,
    HAS_POSITION,
    ORIENTATION,
    POSE_POSITION,
    POSE_WIDTH,
    POSITION_TOLERANCE,
    ROTATION,
    SOLVED,
    TARGET_POSITION,
    TARGET_SEGMENT,
    TARGET_WIDTH,
    UNIT,
)
from sinuous.poses import pose
from sinuous.solving.routing.growth import Grown, settled
from sinuous.solving.routing.parts import before
from sinuous.solving.routing.turned import FLIP, Groups, turned, turned_back

ROOTS = 12
"""Directions in which chains from the target begin where it leaves that open."""

WHOLES = 4
"""Most chains of one beam that reach the other end by themselves and are given."""

JOINTS = 4
"""Most joints of beams that are `FIRST_WIDTH` wide; with their width goes its square root."""

GAP = 2.5
"""Greatest gap that is joined, in lengths of a segment."""

TURN = 0.5
"""Gap that a radian between the tangents counts as, in lengths of a segment."""

DEAR = 2.0
"""What a gap of a segment counts beside the scores of both parts."""

FIRST_WIDTH, LAST_WIDTH = 4, 1024
"""Chains of every number of segments that are kept, at first and at most: powers of two."""

TANGENT = slice(2, POSE_POSITION, 3)
"""The tangent (3,) in a pose (12,)."""

Left = Callable[[], float]
"""Seconds left."""


class _Joint(NamedTuple):
    """Chain number `i` of `k` segments from the base, and number `j` of all others from the target, nearly meet."""

    score: float
    k: int
    i: int
    j: int


class Chains:
    """Chains along one route, of beams that become wider.

    Parameters
    ----------
    groups : tuple of ndarray
        The problem, see `Groups`.
    legs : ndarray (l, K, 3)
        The legs of a route, from target to target, evenly spaced, in the length unit.
    left : callable
        Seconds left.
    """

    def __init__(self, groups: Groups, legs: Floats, left: Left) -> None:
        self._groups, self._legs, self._left = groups, legs, left
        self._n = int(groups[0][0])
        self._segment = float(groups[2][UNIT]) / self._n
        self._other = turned(groups, np.concatenate(list(legs)))
        robot, scene, _, targets = groups
        self._workspace = np.empty(workspace_size(self._n, int(robot[1]), int(scene[0]), len(targets) + 1))

    def of_width(self, width: int) -> Iterator[Floats]:
        """Yield chains (n, 3) of beams that are so wide, the likeliest first."""
        ahead = Grown(self._groups, self._legs, _base(self._groups)[None], width, self._left())
        wholes = [(ahead.scores[ahead.segments, i], ahead.whole(i)[0]) for i in range(min(ahead.wholes, WHOLES))]
        if self._other is not None and self._left() > 0.0:
            legs = self._legs[::-1, ::-1].copy()
            behind = Grown(self._other, legs, _roots(self._groups, self._other), width, self._left())
            for i in range(min(behind.wholes, WHOLES)):
                chain, root = behind.whole(i)
                wholes.append((behind.scores[behind.segments, i], turned_back(self._groups, self._from(root), chain)))
            yield from self._joined(ahead, behind, round(JOINTS * math.sqrt(width / FIRST_WIDTH)))
        wholes.sort(key=lambda whole: whole[0])
        for _, chain in wholes:
            yield chain
            yield from settled(self._groups, [chain], self._left)

    def _from(self, root: Floats) -> Groups:
        """The problem the other way round, of chains that begin with the pose `root`."""
        assert self._other is not None
        robot = self._other[0].copy()
        robot[-2 * POSE_WIDTH : -POSE_WIDTH] = root
        return (robot, *self._other[1:])

    def _joined(self, ahead: Grown, behind: Grown, most: int) -> Iterator[Floats]:
        """Yield chains (n, 3) that meet both ends, of parts from either end."""
        for _, k, i, j in self._joints(ahead, behind)[:most]:
            if self._left() <= 0.0:
                return
            (head, _), (tail, root) = ahead.chain(k, i), behind.chain(self._n - k, j)
            begun = self._from(root)
            closed = self._closed(self._groups, head, behind.frames[self._n - k, j])
            if closed is not None:
                head = closed
            else:
                closed = self._closed(begun, tail, ahead.frames[k, i])
                if closed is None:
                    continue
                tail = closed
            yield _whole(self._groups, head, begun, tail)

    def _joints(self, ahead: Grown, behind: Grown) -> list[_Joint]:
        """Pairs of parts that nearly meet, the best first: some of every number of segments."""
        joints = []
        for k in range(1, self._n):
            some, others = int(ahead.counts[k]), int(behind.counts[self._n - k])
            if some == 0 or others == 0:
                continue
            one, other = ahead.frames[k, :some, None], behind.frames[self._n - k, None, :others]
            off = np.linalg.norm(one[..., POSE_POSITION:] - other[..., POSE_POSITION:], axis=-1)
            cosine = -(one[..., TANGENT] * other[..., TANGENT]).sum(axis=-1)
            gap = off / self._segment + TURN * np.arccos(np.clip(cosine, -1.0, 1.0))
            score = DEAR * gap + ahead.costs[k, :some, None] + behind.costs[self._n - k, None, :others]
            for flat in np.argsort(score, axis=None)[:JOINTS]:
                i, j = divmod(int(flat), others)
                if gap[i, j] < GAP:
                    joints.append(_Joint(float(score[i, j]), k, i, j))
        return sorted(joints)

    def _closed(self, groups: Groups, chain: Floats, end: Floats) -> Floats | None:
        """Return a chain like this one (k, 3) that ends against a pose (12,); `None` where none is found."""
        row = np.zeros(TARGET_WIDTH)
        row[TARGET_SEGMENT], row[HAS_POSITION] = len(chain) - 1.0, 1.0
        row[TARGET_POSITION : TARGET_POSITION + 3] = end[POSE_POSITION:]
        if groups[3][-1, ORIENTATION] == ROTATION:
            row[ORIENTATION] = ROTATION
            row[GOAL : GOAL + 9] = (end[:POSE_POSITION].reshape(3, 3) @ FLIP).ravel()
        else:
            row[ORIENTATION], row[GOAL : GOAL + 3] = DIRECTION, -end[TANGENT]
        part = before(groups, row)
        tolerances = [POSITION_TOLERANCE, ANGLE_TOLERANCE]
        part[2][tolerances] = groups[2][tolerances]
        best = np.empty((len(chain), 3))
        record = search(*part, chain[None], (0, 0, 0, max(0.0, self._left())), self._workspace, best)
        return best if record[0] == SOLVED else None


def _base(groups: Groups) -> Floats:
    """Pose (12,) of the base."""
    return groups[0][-2 * POSE_WIDTH : -POSE_WIDTH]


def _roots(groups: Groups, other: Groups) -> Floats:
    """Poses (r, 12) in which chains from the target may begin: first that in which the route arrives."""
    base, tool = _base(other), groups[0][-POSE_WIDTH:]
    if groups[3][-1, ORIENTATION] != FREE or tool[POSE_POSITION:].any():
        return base[None].copy()
    number = np.arange(ROOTS - 1) + 0.5
    height, turn = 1.0 - 2.0 * number / (ROOTS - 1), math.pi * (1.0 + math.sqrt(5.0)) * number
    level = np.sqrt(1.0 - height * height)
    around = np.stack([level * np.cos(turn), level * np.sin(turn), height], axis=1)
    around = around[np.argsort(-around @ base[TANGENT])]
    frames = [np.append(pose(direction=ahead)[:3, :3].ravel(), base[POSE_POSITION:]) for ahead in around]
    return np.stack([base, *frames])


def _whole(groups: Groups, head: Floats, begun: Groups, tail: Floats) -> Floats:
    """The chain (n, 3) of a part (k, 3) from the base, and one (n - k, 3) from the target that it meets."""
    frames = np.empty((1, len(head) + 1, POSE_WIDTH))
    frames_of(head[None].copy(), _base(groups).reshape(1, POSE_WIDTH).copy(), frames)
    robot = groups[0].copy()
    robot[-2 * POSE_WIDTH : -POSE_WIDTH] = frames[0, -1]
    return np.concatenate([head, turned_back((robot, *groups[1:]), begun, tail)])
