"""Chains for narrow places: grown from the base and from the target and joined, or cut in two at the narrowest place.

Either end may lie in a tube, before its mouth or in a cell, where the first segments have one way to go; a chain that
is grown from the other end is lost there. So chains are grown from both ends, by arcs that follow walls by themselves
(`kernels.growing`). Of k segments from the base and n - k from the target that nearly meet, one part is solved for the
pose in which the other begins: two problems of half the segments are far easier than one of all. An arc does not care
how it is turned about its tangent, so what is joined meets both ends.

Without growing, a robot is cut in two at the narrowest place of its route: one part ends there, along the route, and
one begins there.

An intermediate target in a narrow place leaves few tangents to pass it with, and chains past all targets seldom arrive
with one of these. So, for some of its tangents, chains are also grown in two parts: up to the intermediate target, and
from there.

Chains are also grown without a route, at random: w chains from either end make w^2 pairs, some of which nearly meet.
Hardly one of them passes an intermediate target by chance: the shorter part, from it to the base or to the tip, is
solved first, in many ways, and beams grow from where these end, and from the other end.

Terminal poses are those in which a chain from the target may begin. A bridge is what stands in the open between a chain
that comes out of a narrow place at the base and one at the target: scattered starts solve it.
"""

import math
from collections.abc import Iterable, Iterator
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.kernels import tables as t
from sinuous.kernels.fitting.lines import distances_along
from sinuous.kernels.fitting.query import ball_radius
from sinuous.kernels.packing import robot_parts
from sinuous.kernels.tables import BEND_SCALE, IN_PLANE, MAX_LENGTH, MIN_LENGTH, POSE_POSITION, UNIT, Outcome
from sinuous.model.poses import least_rotation
from sinuous.solver.attempts import Deadline
from sinuous.solver.polylines import lengths_along
from sinuous.solver.routing.partial_chains import (
    FIRST_WIDTH,
    FLIP,
    Groups,
    GrownChains,
    common_plane,
    end_pose,
    fit_first_segments,
    join_chains,
    problem_before,
    problem_beyond,
    problem_ending_at,
    problem_from_pose,
    problem_up_to,
    reverse_chain,
    reverse_problem,
    search_part,
    segments_in,
    segments_of,
    settle_chains,
    solve_part,
    with_end_tangent,
)

WIDE = 3.0
"""Distance from the obstacles across a route, in radii of the body, from which on no place of it is narrow."""

NARROW = 1.35
"""Distance up to which a place is as narrow as the narrowest one, in units of that one's."""

ENDS = 0.04
"""Share of a leg at either end that is not looked at: an end may lie in a narrow place."""

TANGENT_POINTS = 3
"""Points on either side over which the tangent of a route is taken."""

STRETCHED = 0.95
"""Least length of a part, in lengths of its part of the route: the route does not cut corners."""

BARELY = 0.15
"""Share of a segment that may stick out of a long narrow place and still counts as in it."""


class PartSearch:
    """One part of a robot, solved with more and more scattered starts.

    Parameters
    ----------
    groups : tuple of ndarray
        Its problem, see `Groups`.

    Attributes
    ----------
    nearest : ndarray (m, 3) or None
        What came nearest to a solution.
    possible : bool
        Whether it is not proved that there is none.
    """

    def __init__(self, groups: Groups) -> None:
        self._groups, self._n = groups, int(groups[0][0])
        self._starts = 0
        self._least = math.inf
        self._q: Floats | None = None
        self.nearest: Floats | None = None
        self.possible = True

    def solve(self, starts: int, deadline: Deadline) -> Floats | None:
        """Return a configuration (m, 3) that is proved, from at most so many starts in all."""
        own, self._starts = (self._starts, starts), max(starts, self._starts)
        if self._q is None and self.possible and own[0] < starts:
            found = search_part(self._groups, np.empty((0, self._n, 3)), own, deadline)
            self.possible = found.code < t.OUT_OF_REACH
            if found.merit < self._least:
                self._least, self.nearest = found.merit, found.q
            if found.code == t.SOLVED:
                self._q = found.q
        return self._q


class BottleneckDecomposition:
    """A robot cut in two at the narrowest place of a route.

    The more segments are before the place, the harder the part before it is, and the easier that beyond, unless there
    are too few to get there: their number is found by halving.

    Parameters
    ----------
    groups : tuple of ndarray
        The problem, see `Groups`.
    legs : ndarray (l, K, 3)
        The legs of a route, evenly spaced, in the length unit.
    widths : ndarray (l, K)
        Greatest distance from the obstacles in the plane across the route at these points, in the length unit.
    """

    def __init__(self, groups: Groups, legs: Floats, widths: Floats) -> None:
        self._groups, self._legs = groups, legs
        self._heads: dict[int, PartSearch] = {}
        self._tails: dict[int, tuple[Floats, PartSearch]] = {}
        skipped = max(1 + TANGENT_POINTS, round(ENDS * legs.shape[1]))
        looked = widths[:, skipped:-skipped]
        self._which = which = int(looked.min(axis=1).argmin())
        own = looked[which]
        first, last = _run_about(own <= NARROW * max(0.0, own.min()), int(own.argmin()))
        spacing = lengths_along(legs[which])[-1] / (legs.shape[1] - 1)
        deep = round(min(max(0.0, own.min() / spacing), last - first)) if spacing > 0.0 else 0
        self._long = (last - first - deep) * spacing > segments_in(groups[0])[:, t.MAX_LENGTH].mean()
        self._at = skipped + (min(first + deep, last) if self._long else (first + last) // 2)
        self._end = skipped + last if self._long else self._at
        narrow = own.min() < WIDE * ball_radius(segments_in(groups[0])) and first > 0 and last < len(own) - 1
        self._counts = self._possible() if narrow else []

    @property
    def any(self) -> bool:
        """Whether there is a narrow place, and segments for both parts."""
        return len(self._counts) > 0

    def chains(self, starts: int, deadline: Deadline) -> Iterator[Floats]:
        """Yield chains (n, 3) through the narrow place, each part of at most so many scattered starts."""
        low, high, i = 0, len(self._counts) - 1, self._even
        while low <= high:
            chain, through = self._solved(self._counts[i], starts, deadline)
            if chain is not None:
                yield chain
            low, high = (i + 1, high) if through else (low, i - 1)
            i = (low + high) // 2

    def _possible(self) -> list[int]:
        """Numbers of segments that may be before the place; sets the one that stows as much in both parts."""
        legs, at = self._legs, self._at
        ends = [-1, *segments_of(self._groups)[-len(legs) :]]
        first = ends[self._which] + 1
        own = segments_in(self._groups[0])[first : ends[self._which + 1] + 1]
        low, high = (np.append(0.0, np.cumsum(own[:, which])) for which in (t.MIN_LENGTH, t.MAX_LENGTH))
        along = STRETCHED * lengths_along(legs[self._which])
        gone, rest = along[at], along[-1] - along[at]
        counts = [m for m in range(1, len(own)) if high[m] >= gone and high[-1] - high[m] >= rest]
        mean = 0.5 * (low + high)
        stowed = [(mean[m] - gone) / m - (mean[-1] - mean[m] - rest) / (len(own) - m) for m in counts]
        self._even = int(np.abs(stowed).argmin()) if counts else 0
        return [first + m for m in counts]

    def _solved(self, count: int, starts: int, deadline: Deadline) -> tuple[Floats | None, bool]:
        """Return a chain with so many segments before the place, and whether more may be there.

        Where the second part is not solved, what came nearest is taken: the whole chain has more freedom.
        """
        if count not in self._heads:
            self._heads[count] = PartSearch(problem_before(self._groups, self._row(count)))
        head = self._heads[count].solve(starts, deadline)
        if head is None:
            return None, not self._heads[count].possible
        if count not in self._tails:
            within = self._within(problem_beyond(self._groups, head), deadline)
            self._tails[count] = within, PartSearch(problem_beyond(self._groups, np.concatenate([head, within])))
        within, part = self._tails[count]
        tail = part.solve(starts, deadline)
        tail = part.nearest if tail is None else tail
        return (None if tail is None else np.concatenate([head, within, tail])), True

    def _within(self, rest: Groups, deadline: Deadline) -> Floats:
        """The segments (m, 3) that lie in a long narrow place beyond the first part, fitted to the route."""
        line = self._legs[self._which][self._at : self._end + 1]
        if not self._long:
            return np.empty((0, 3))
        low, high = (segments_in(rest[0])[:-1, which] for which in (t.MIN_LENGTH, t.MAX_LENGTH))
        ends = np.cumsum(0.5 * (low + high))
        count = int(np.searchsorted(ends, lengths_along(line)[-1] + BARELY * high.mean()))
        return fit_first_segments(rest, count, line, deadline())

    def _row(self, count: int) -> Floats:
        """The place and the tangent of the route there, as a target (15,) of the end of the first segments."""
        leg, at = self._legs[self._which], self._at
        ahead = leg[at + TANGENT_POINTS] - leg[at - TANGENT_POINTS]
        row = np.zeros(t.TARGET_WIDTH)
        row[t.TARGET_SEGMENT], row[t.HAS_POSITION], row[t.ORIENTATION] = count - 1.0, 1.0, t.DIRECTION
        row[t.TARGET_POSITION : t.TARGET_POSITION + 3] = leg[at]
        row[t.GOAL : t.GOAL + 3] = ahead / np.linalg.norm(ahead)
        return row


def _run_about(which: NDArray[np.bool_], at: int) -> tuple[int, int]:
    """First and last of the neighbours of a point (K,) that are all so."""
    others = np.flatnonzero(~which)
    behind, ahead = others[others < at], others[others > at]
    return int(behind[-1]) + 1 if len(behind) else 0, int(ahead[0]) - 1 if len(ahead) else len(which) - 1


MOST = 12
"""Roots at most."""

DIRECTIONS, ROLLS = 64, 16
"""Directions that are tried where the target leaves it open, and angles about one where a tool points aside. With both,
twice as many directions, each at one angle."""

STEPS = (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0)
"""Places behind a terminal pose where it is looked for room, and how much is enough. In radii of the body."""

ENOUGH = 1.25
"""Room that is enough there, in radii of the body."""

IN_WALL = 0.75
"""Room that a terminal pose lacks at most, in radii of the body: a pose that lacks more ends in a wall, however open
what lies behind it (a tool that leads through the wall of a tube: two tubes)."""

AGREEMENT = 1e-3
"""What a pose counts that is turned away from the route, beside the mean square of the room that it lacks: decides
between poses in the open."""

APART = 0.35
"""How far terminal poses are apart, in rad; two radii of the body count as one."""

BEFORE = 3
"""Points of a route that its tangent is taken over."""

GOLDEN = 0.618034
"""Share of a turn between neighbours that have one angle each."""


def find_terminal_poses(groups: Groups, route: Floats) -> Floats:
    """Return poses (r, 12) in which chains from the target may begin, the best first.

    There is none where the tip is not asked to be somewhere, or where the route (K, 3) has no direction there.
    """
    robot, scene, _, targets = groups
    tips = targets[np.isin(targets[:, t.TARGET_SEGMENT], (-1.0, robot[0] - 1.0))]
    tool = robot_parts(robot).tool
    tangent = None if len(tips) != 1 or tips[0, t.HAS_POSITION] == 0.0 else _arrival(tips[0], tool, route)
    if tangent is None:
        return np.empty((0, t.POSE_WIDTH))
    ends = _end_rotations(groups[0], tips[0], tangent)
    places = tips[0, t.TARGET_POSITION : t.TARGET_POSITION + 3] - ends @ tool[t.POSE_POSITION :]
    ahead, radius = ends[:, :, 2], ball_radius(segments_in(robot))
    order = [0]
    if len(ends) > 1:
        points = places[:, None] - radius * np.array(STEPS)[:, None] * ahead[:, None]
        distances = np.empty(points.size // 3)
        distances_along(scene, points.reshape(-1, 3).copy(), ENOUGH * radius, distances)
        lack = np.maximum(0.0, ENOUGH - distances.reshape(len(ends), -1) / radius)
        squares = lack * lack
        ranked = np.argsort(squares[:, 0] + squares.mean(axis=1) - AGREEMENT * ahead @ tangent, kind="stable")
        order = [i for i in ranked.tolist() if lack[i, 0] <= IN_WALL] or ranked[:1].tolist()
    chosen: list[int] = []
    for i in order:
        if len(chosen) == MOST:
            break
        turns = np.arccos(np.clip(ahead[chosen] @ ahead[i], -1.0, 1.0))
        off = turns + np.linalg.norm(places[chosen] - places[i], axis=1) / (2.0 * radius)
        if (off > APART).all():
            chosen.append(i)
    return np.stack([np.append((ends[i] @ FLIP).ravel(), places[i]) for i in chosen])


def _arrival(target: Floats, tool: Floats, route: Floats) -> Floats | None:
    """Tangent (3,) of a route (K, 3) where the backbone ends and the tool (12,) begins; `None` where it has none.

    Where all of the route is nearer to the target than the tool is long, that is where the route begins.
    """
    goal = target[t.TARGET_POSITION : t.TARGET_POSITION + 3]
    beyond = np.flatnonzero(np.linalg.norm(route - goal, axis=1) >= np.linalg.norm(tool[t.POSE_POSITION :]))
    before = min(BEFORE, len(route) - 1)
    at = max(before, int(beyond[-1]) if len(beyond) else 0)
    tangent: Floats = route[at] - route[at - before]
    length = float(np.linalg.norm(tangent))
    return None if length == 0.0 else tangent / length


def _end_rotations(robot: Floats, target: Floats, tangent: Floats) -> Floats:
    """Rotations (m, 3, 3) of the end of the backbone of a robot (a group) at a target; what that leaves open is tried.

    A body that lies in a plane ends in it.
    """
    parts = robot_parts(robot)
    held, plane = parts.tool[: t.POSE_POSITION].reshape(3, 3), common_plane(parts.segments)
    aside = bool(parts.tool[t.POSE_POSITION : t.POSE_POSITION + 2].any())
    if target[t.ORIENTATION] == t.ROTATION:
        return (target[t.GOAL : t.GOAL + 9].reshape(3, 3) @ held.T)[None]
    direction = target[t.GOAL : t.GOAL + 3] if target[t.ORIENTATION] == t.DIRECTION else None
    if plane is not None:
        return _rotations_in_plane(parts.base[: t.POSE_POSITION].reshape(3, 3), plane, held, direction, tangent)
    if direction is not None:
        rolls = np.arange(ROLLS) / ROLLS if aside or held[2, 2] < 1.0 else np.zeros(1)
        ahead = least_rotation(direction)
        return np.stack([ahead @ _spin(roll) @ held.T for roll in rolls])
    count = 2 * DIRECTIONS if aside else DIRECTIONS
    number = np.arange(count - 1) + 0.5
    height, turn = 1.0 - 2.0 * number / (count - 1), math.pi * (1.0 + math.sqrt(5.0)) * number
    level = np.sqrt(1.0 - height * height)
    around = np.stack([level * np.cos(turn), level * np.sin(turn), height], axis=1)
    turned = [least_rotation(ahead) for ahead in np.vstack([tangent, around])]
    return np.stack([each @ _spin(GOLDEN * i) for i, each in enumerate(turned)] if aside else turned)


def _rotations_in_plane(base: Floats, plane: Floats, held: Floats, direction: Floats | None, tangent: Floats) -> Floats:
    """Rotations (m, 3, 3) of the end of a body that bends in a plane (2,) of its base: one where a direction is asked.

    `held` (3, 3) is the rotation of the tool. The first is that which is nearest to the direction, or to the tangent.
    """
    own = np.array([[plane[0], -plane[1], 0.0], [plane[1], plane[0], 0.0], [0.0, 0.0, 1.0]])
    wanted, points = (tangent, np.eye(3)) if direction is None else (direction, held)
    local, tip = own.T @ base.T @ wanted, own.T @ points[:, 2]
    first = math.atan2(local[0], local[2]) - math.atan2(tip[0], tip[2])
    count = DIRECTIONS if direction is None else 1
    turns = first + 2.0 * math.pi * np.arange(count) / count
    bent = np.zeros((count, 3, 3))
    bent[:, 0, 0] = bent[:, 2, 2] = np.cos(turns)
    bent[:, 0, 2], bent[:, 1, 1], bent[:, 2, 0] = np.sin(turns), 1.0, -np.sin(turns)
    return np.asarray(base @ own @ bent @ own.T)


def _spin(turns: float) -> Floats:
    """Rotation (3, 3) about z."""
    cosine, sine = math.cos(2.0 * math.pi * turns), math.sin(2.0 * math.pi * turns)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


OPEN = 3.5
"""Distance from the obstacles from which on an end is in the open, in radii of the body."""

STARTS = 8
"""Scattered starts of a bridge, at most: of wider beams more bridges are tried, not each one longer (cells)."""

FREEDOM = 6
"""Least number of coordinates of a bridge between two poses: fewer meet both by chance only."""

End = tuple[int, int]
"""A chain, by its number of segments and its own number."""


def bridge_chains(
    groups: Groups, other: Groups, ahead: GrownChains, behind: GrownChains, width: int, deadline: Deadline
) -> Iterator[Floats]:
    """Yield chains (n, 3) of a part from the base, a bridge that scattered starts solve, and a part to the target.

    Parameters
    ----------
    groups, other : tuple of ndarray
        The problem, and the same the other way round, see `Groups`.
    ahead, behind : GrownChains
        Chains from the base and from the target that end in the open, or none that do.
    width : int
        Of the beams: about as many bridges are tried.
    deadline : callable
        See `Deadline`.
    """
    n, segments = int(groups[0][0]), segments_in(groups[0])
    freedom = (2 - segments[:, IN_PLANE]) * (segments[:, BEND_SCALE] > 0.0) + (
        segments[:, MAX_LENGTH] > segments[:, MIN_LENGTH]
    )
    pairs = [
        (one, two)
        for one, two in product(_ends(ahead, width), _ends(behind, width))
        if one[0] + two[0] > 0 and freedom[one[0] : n - two[0]].sum() >= FREEDOM
    ]
    pairs.sort(key=lambda pair: n - pair[0][0] - pair[1][0])
    for one, two in pairs[: 2 * width]:
        (head, _), (tail, terminal_pose) = ahead.chain(*one), behind.chain(*two)
        rest = problem_beyond(groups, head)
        if len(tail) > 0:
            rest = problem_ending_at(rest, n - len(head) - len(tail), behind.frames[two])
        bridge = solve_part(rest, np.empty((0, int(rest[0][0]), 3)), min(width, STARTS), deadline)
        if bridge is not None:
            yield join_chains(groups, np.concatenate([head, bridge]), problem_from_pose(other, terminal_pose), tail)


def _ends(grown: GrownChains, most: int) -> list[End]:
    """Chains beyond which a bridge may begin: those in the open, those that they continue, and the terminal pose."""
    if not grown.open:
        return [(0, 0)]
    k, outside = grown.outside()
    ends = [(k, i) for i in outside[: max(1, most // 4)]]
    ends += [(k - 1, grown.parent(*end)) for end in ends if k > 0]
    return list(dict.fromkeys([*ends, (0, 0)]))


WHOLES = 2
"""Most chains of one beam that reach the other end by themselves and are given."""

MOST_JUNCTIONS = 4
"""Most junctions of beams that are `FIRST_WIDTH` wide; with their width goes its square root."""

WIDTH_OF_HALVES = 16
"""Width of beams without a route up to which they are grown to the middle only."""

MEETINGS_OF_A_LENGTH = 16
"""The same for each number of segments from the base, where `MOST_JUNCTIONS` are looked at along a route."""

GAP = 2.5
"""Greatest gap that is joined, in lengths of a segment."""

TURN = 0.5
"""Gap that a radian between the tangents counts as, in lengths of a segment."""

DEAR = 2.0
"""What a gap of a segment counts beside the scores of both parts."""

TANGENT = slice(2, POSE_POSITION, 3)
"""The tangent (3,) in a pose (12,)."""

MOST_TANGENTS = 4
"""Most tangents of an intermediate target with which chains are led past it."""


class _Junction(NamedTuple):
    """Chain number `i` of `k` segments from the base, and number `j` of all others from the target, nearly meet."""

    score: float
    k: int
    i: int
    j: int


_Placed = tuple[Floats, Floats]
"""The pose (12,) in which a chain begins, and its configuration (n, 3)."""


def _turn_about(pose: Floats, pivot: Floats, place: Floats, goal: Floats) -> Floats:
    """Turn a pose (12,) about a pivot by the least angle that brings a place fixed to it into line with a goal (3,)."""
    away, ahead = place - pivot, goal - pivot
    lengths = np.linalg.norm(away), np.linalg.norm(ahead)
    if min(lengths) == 0.0:
        return pose
    frame = least_rotation(away / lengths[0])
    turn = frame @ least_rotation(frame.T @ ahead / lengths[1]) @ frame.T
    rotation = turn @ pose[:POSE_POSITION].reshape(3, 3)
    return np.append(rotation.ravel(), pivot + turn @ (pose[POSE_POSITION:] - pivot))


class JoinedChains:
    """Chains along one route, of beams that become wider.

    Parameters
    ----------
    groups : tuple of ndarray
        The problem, see `Groups`.
    legs : ndarray (l, K, 3)
        The legs of a route, from target to target, evenly spaced, in the length unit.
    deadline : callable
        See `Deadline`.
    bases : ndarray (r, 12), optional
        Poses in which chains may begin, of those without a route; by default the base.
    """

    def __init__(self, groups: Groups, legs: Floats, deadline: Deadline, bases: Floats | None = None) -> None:
        self._groups, self._legs, self._deadline = groups, legs, deadline
        self._bases = robot_parts(groups[0]).base[None].copy() if bases is None else bases
        self._n = int(groups[0][0])
        self._segment = float(groups[2][UNIT]) / self._n
        self._terminal_poses = find_terminal_poses(groups, np.concatenate(list(legs)))
        self._other = reverse_problem(groups, self._terminal_poses[0]) if len(self._terminal_poses) else None

    def chains_of_width(self, width: int) -> Iterator[Floats]:
        """Yield chains (n, 3) of beams that are so wide, the likeliest first."""
        yield from self.chains_past_all_targets(width, OPEN)
        for target in self._intermediate_targets:
            yield from target.chains_of_width(width)

    @cached_property
    def _intermediate_targets(self) -> "list[_IntermediateTarget]":
        """Ways to pass the first intermediate target, if any; made once chains past all targets are not enough."""
        if len(self._legs) == 1:
            return []
        before = problem_up_to(self._groups, segments_of(self._groups)[0] + 1)
        ends = find_terminal_poses(before, self._legs[0])[:MOST_TANGENTS]
        return [_IntermediateTarget(self._groups, before, self._legs, end, self._deadline) for end in ends]

    def chains_past_all_targets(self, width: int, open_from: float = math.inf) -> Iterator[Floats]:
        """Yield chains (n, 3) of beams that lead past all targets; first those that are bridged, see `GrownChains`."""
        if self._other is None:
            yield from self._given(self._wholes(self._ahead(width), self._groups))
            return
        ahead, behind = self._ahead(width, open_from), self._behind(self._other, width, open_from)
        yield from bridge_chains(self._groups, self._other, ahead, behind, width, self._deadline)
        ahead = self._ahead(width) if ahead.open else ahead
        behind = self._behind(self._other, width) if behind.open else behind
        for _, chain in self._joined(ahead, behind, round(MOST_JUNCTIONS * math.sqrt(width / FIRST_WIDTH))):
            yield chain
        yield from self._given([*self._wholes(ahead, self._groups), *self._wholes(behind, self._other)])

    def chains_that_meet(self, width: int) -> Iterator[Floats]:
        """Yield chains (n, 3) of beams from both ends that nearly meet: without a route, where they meet is chance.

        Up to as many as a beam is wide are tried: that takes a quarter of what the beams themselves take.
        """
        for _, chain in self._meeting_chains(width):
            yield chain

    def _meeting_chains(self, width: int) -> Iterator[_Placed]:
        """Yield the same, first those that are led past an intermediate target; all where there is none of these."""
        if self._other is None:
            return
        passing = self._chains_past_targets(width) if len(self._legs) > 1 else iter(())
        first = next(passing, None)
        if first is not None:
            yield first
            yield from passing
            return
        most = self._n // 2 + 1 if width <= WIDTH_OF_HALVES else self._n
        ahead, behind = self._ahead(width, most=most), self._behind(self._other, width, most=most)
        yield from self._joined(ahead, behind, width, loose=True)

    def _chains_past_targets(self, width: int) -> Iterator[_Placed]:
        """Yield chains (n, 3) of which a part is solved up to an intermediate target: that with fewer segments."""
        if len(self._bases) > 1 or 2 * (segments_of(self._groups)[-2] + 1) <= self._n:
            yield from self._chains_past_first_target(width, None)
            return
        assert self._other is not None
        turned = JoinedChains(self._other, self._legs[::-1, ::-1].copy(), self._deadline, self._terminal_poses)
        tip = self._groups[3][np.isin(self._groups[3][:, t.TARGET_SEGMENT], (-1.0, self._n - 1.0))][0]
        place = tip[t.TARGET_POSITION : t.TARGET_POSITION + 3]
        for begin, chain in turned._chains_past_first_target(width, place if tip[t.ORIENTATION] == t.FREE else None):
            yield self._bases[0], reverse_chain(self._groups, problem_from_pose(self._other, begin), chain)

    def _chains_past_first_target(self, width: int, pivot: Floats | None) -> Iterator[_Placed]:
        """Yield chains (n, 3) whose first part is solved, up to the first target; beams grow on from there.

        Where chains may begin turned about a `pivot` (3,), each is turned to face that target: few do by themselves.
        """
        before = problem_up_to(self._groups, segments_of(self._groups)[0] + 1)
        grown = GrownChains(before, self._legs[:1], self._bases, width, self._deadline())
        heads, ends = list[_Placed](), list[Floats]()
        for i in range(grown.complete_count):
            chain, begin = grown.complete_chain(i)
            if pivot is not None:
                end = end_pose(problem_from_pose(before, begin), chain)[POSE_POSITION:]
                begin = _turn_about(begin, pivot, end, self._legs[0, -1])
            own = problem_from_pose(before, begin)
            head = solve_part(own, chain[None], 0, self._deadline)
            if head is not None:
                heads.append((begin, head))
                ends.append(end_pose(own, head))
        if not heads:
            return
        rest = problem_beyond(problem_from_pose(self._groups, heads[0][0]), heads[0][1])
        beyond = JoinedChains(rest, self._legs[1:], self._deadline, np.stack(ends))
        for end, tail in beyond._meeting_chains(width):
            begin, head = heads[int((beyond._bases == end).all(axis=1).argmax())]
            yield begin, np.concatenate([head, tail])

    def _ahead(self, width: int, open_from: float = math.inf, most: int | None = None) -> GrownChains:
        """Chains from the base."""
        return GrownChains(self._groups, self._legs, self._bases, width, self._deadline(), open_from, most)

    def _behind(self, other: Groups, width: int, open_from: float = math.inf, most: int | None = None) -> GrownChains:
        """Chains from the target."""
        legs = self._legs[::-1, ::-1].copy()
        return GrownChains(other, legs, self._terminal_poses, width, self._deadline(), open_from, most)

    def _wholes(self, grown: GrownChains, groups: Groups) -> Iterator[tuple[float, Floats]]:
        """Chains (n, 3) that reach the other end by themselves, and their scores."""
        for i in range(min(grown.complete_count, WHOLES)):
            chain, terminal_pose = grown.complete_chain(i)
            if groups is not self._groups:
                chain = reverse_chain(self._groups, problem_from_pose(groups, terminal_pose), chain)
            yield float(grown.scores[grown.segments, i]), chain

    def _given(self, wholes: Iterable[tuple[float, Floats]]) -> Iterator[Floats]:
        """Yield chains, the best first, drawn to the targets."""
        best_first = (chain for _, chain in sorted(wholes, key=lambda whole: whole[0]))
        yield from settle_chains(self._groups, best_first, self._deadline)

    def _joined(self, ahead: GrownChains, behind: GrownChains, most: int, loose: bool = False) -> Iterator[_Placed]:
        """Yield chains (n, 3) that meet both ends, of parts from either end; `loose`: that nearly do."""
        assert self._other is not None
        each = MEETINGS_OF_A_LENGTH if loose else MOST_JUNCTIONS
        for _, k, i, j in self._joints(ahead, behind, each)[:most]:
            (head, base), (tail, terminal_pose) = ahead.chain(k, i), behind.chain(self._n - k, j)
            begun = problem_from_pose(self._other, terminal_pose)
            closed = None if loose else self._closed(self._groups, head, behind.frames[self._n - k, j])
            if closed is not None and closed.code == t.SOLVED:
                head = closed.q
            else:
                closed = self._closed(begun, tail, ahead.frames[k, i])
                if closed.code != t.SOLVED and not loose:
                    continue
                tail = closed.q
            yield base, join_chains(problem_from_pose(self._groups, base), head, begun, tail)

    def _joints(self, ahead: GrownChains, behind: GrownChains, each: int) -> list[_Junction]:
        """Pairs of parts that nearly meet, the best first: up to `each` of every number of segments."""
        joints = []
        for k in range(max(1, self._n + 1 - len(behind.counts)), min(self._n, len(ahead.counts))):
            self._deadline()
            some, others = int(ahead.counts[k]), int(behind.counts[self._n - k])
            if some == 0 or others == 0:
                continue
            one, other = ahead.frames[k, :some, None], behind.frames[self._n - k, None, :others]
            off = np.linalg.norm(one[..., POSE_POSITION:] - other[..., POSE_POSITION:], axis=-1)
            cosine = -(one[..., TANGENT] * other[..., TANGENT]).sum(axis=-1)
            gap = off / self._segment + TURN * np.arccos(np.clip(cosine, -1.0, 1.0))
            score = DEAR * gap + ahead.costs[k, :some, None] + behind.costs[self._n - k, None, :others]
            for flat in np.argpartition(score, min(each, score.size) - 1, axis=None)[:each]:
                i, j = divmod(int(flat), others)
                if gap[i, j] < GAP:
                    joints.append(_Junction(float(score[i, j]), k, i, j))
        return sorted(joints)

    def _closed(self, groups: Groups, chain: Floats, end: Floats) -> Outcome:
        """Search for a chain like this one (k, 3) that ends against a pose (12,)."""
        return search_part(problem_ending_at(groups, len(chain), end), chain[None], (0, 0), self._deadline)


class _IntermediateTarget:
    """Chains in two parts: up to the first intermediate target, to pass it with one tangent, and from there on.

    Parameters
    ----------
    groups, before : tuple of ndarray
        The problem, and that of the segments up to the intermediate target.
    legs, deadline
        See `JoinedChains`.
    terminal_pose : ndarray (12,)
        Pose of the intermediate target, against the tangent.
    """

    def __init__(self, groups: Groups, before: Groups, legs: Floats, terminal_pose: Floats, deadline: Deadline) -> None:
        self._groups, self._before, self._legs, self._deadline = groups, before, legs, deadline
        self._heads = JoinedChains(with_end_tangent(before, -terminal_pose[TANGENT]), legs[:1], deadline)
        self._head: Floats | None = None
        self._tails: JoinedChains | None = None

    def chains_of_width(self, width: int) -> Iterator[Floats]:
        """Yield chains (n, 3); the second part is grown once the first one is proved."""
        if self._tails is None:
            heads = (solve_part(self._before, q[None], 0, self._deadline) for q in self._heads.chains_of_width(width))
            self._head = next((head for head in heads if head is not None), None)
            if self._head is None:
                return
            self._tails = JoinedChains(problem_beyond(self._groups, self._head), self._legs[1:], self._deadline)
        for tail in self._tails.chains_of_width(width):
            yield np.concatenate([self._head, tail])
