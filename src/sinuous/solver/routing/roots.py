"""Roots: where the part of a robot begins that bends, and how joints and straight segments stand that lead there.

Joints before the arm and a long stage make that a choice, and routes begin at a root. So some are tried, one after the
other: shapes of the leading rows that face the mouth of a narrow place, at a distance that the rest of the robot can
bridge, and scattered ones, those first that are near it and see it. Where mouths are say the tube about the target and
routes to it from anywhere. Chains that are grown from the target through a mouth end where the robot should begin, and
the leading rows are led there.
"""

import math
from collections.abc import Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels import tables as t
from sinuous.kernels.chain.batch import frames_of
from sinuous.kernels.packing import robot_parts
from sinuous.kernels.tables import POSE_POSITION
from sinuous.problem.problem import Problem
from sinuous.solver.attempts import Deadline
from sinuous.solver.polylines import lengths_along
from sinuous.solver.routing.chains import TANGENT, find_terminal_poses
from sinuous.solver.routing.partial_chains import (
    Groups,
    GrownChains,
    end_pose,
    first_segments,
    leading_rows,
    problem_beyond,
    problem_from_pose,
    reverse_chain,
    reverse_problem,
    search_part,
    segments_in,
    set_route_start,
)
from sinuous.solver.routing.searches import Searches
from sinuous.solver.routing.tubes import find_tube_around

MOST_ROOTS = 64
"""Most roots of one solve."""

SHAPES = 512
"""Scattered shapes of the leading rows."""

ROUND = 8
"""Roots of each round, before each of which one more route is searched for."""

APART = 0.5
"""How far the places are apart from which it is, in lengths of the rest of the robot."""

SAME = 0.1
"""How far mouths are apart that are the same, in lengths of the route beyond."""

FARTHER = 4.0
"""Length of a first route at most, in lengths of the rest of the robot."""

STARTS = 4
"""Scattered starts of leading rows that are to face a place."""

LOOSE, SLANT = 0.03, 0.1
"""How far from a place they may end, in lengths of the rest of the robot; and how far they may be turned away, rad."""

ALIKE, TURNED = 0.04, 0.2
"""Roots that are nearer, in lengths of the rest of the robot, and turned by less, in rad, are alike."""

NARROW = 2.5
"""Distance from the obstacles, in radii of the body, below which a place of a route is narrow."""

SHARES, TILT = (1.0, 0.6, 0.3), 0.8
"""How far before a mouth the first roots are, in shares of the length that is left for it. Others are anywhere between,
and tilted by so much at most, rad."""

SEEN = 8
"""Places between a root and a mouth that are looked at; of the best roots, so many that these are `SHAPES` in all."""

UNSEEN, AWAY, SHORT = 1.0, 8.0, 1.0
"""What it counts that a root does not see the mouth; that it is too far away, and that it is too near for a rest that
cannot be so short, in lengths of the rest. Angles, between tangent, sight and mouth, count as 1 less their cosine."""

LED_BACK = 4
"""Most chains of one beam from the target to whose ends the leading rows are led."""

BEFORE = 3
"""Points of a route that its tangent is taken over, on either side."""


class Mouth(NamedTuple):
    """Where a narrow place begins, or the target where there is none.

    Attributes
    ----------
    place : ndarray (3,)
    into : ndarray (3,)
        Unit tangent of the route there, or zero.
    beyond : float
        Length of the route from there to the target.
    line : ndarray (K, 3) or None
        That part of the route.
    """

    place: Floats
    into: Floats
    beyond: float
    line: Floats | None

    def is_like(self, other: "Mouth") -> bool:
        """Whether roots that face one face the other, too."""
        off = float(np.linalg.norm(self.place - other.place)) + abs(self.beyond - other.beyond)
        return off < SAME * max(self.beyond, other.beyond) and bool(self.into @ other.into > math.cos(TURNED))


class Root(NamedTuple):
    """How the leading rows stand (k, 3), and a route (K, 3) to the target from the mouth that they face, if any."""

    chain: Floats
    line: Floats | None


def _tangent(line: Floats, i: int) -> Floats:
    """Unit tangent (3,) of a line (K, 3) at one of its points; zero where it has none."""
    along = line[min(i + BEFORE, len(line) - 1)] - line[max(i - BEFORE, 0)]
    return np.asarray(along / max(1e-12, float(np.linalg.norm(along))))


class Roots:
    """Roots of one question: how leading rows may stand, proved clear.

    Parameters
    ----------
    searches : Searches
    problem : Problem
    deadline : callable
        See `Deadline`.
    """

    def __init__(self, searches: Searches, problem: Problem, deadline: Deadline) -> None:
        self._searches, self._problem, self._deadline = searches, problem, deadline
        robot, scene, settings, _ = groups = searches.groups(problem)
        self._groups, self._count = groups, leading_rows(segments_in(robot))
        rest = segments_in(robot)[self._count :]
        self._shortest, self._longest = (rest[:, which].sum() for which in (t.MIN_LENGTH, t.MAX_LENGTH))
        self._told: list[Floats] = []
        self._rng = np.random.default_rng(0)
        loose = settings.copy()
        loose[t.POSITION_TOLERANCE], loose[t.ANGLE_TOLERANCE] = LOOSE * self._longest, SLANT
        self._lead = first_segments(robot, self._count), scene, loose

    def roots(self, route: Floats | None) -> Iterator[Root]:
        """Yield roots that differ, the likeliest first; `route` (K, 3) is the first one to the target, if one is known.

        More and more mouths are looked for: that of a tube about the target, then those of routes from here and there.
        """
        query = self._searches.at(self._shapes[0]).query(self._problem)
        if query is None:
            return
        goal, back = (query[at : at + 3] for at in (t.QUERY_GOAL, t.QUERY_BACK))
        target = Mouth(goal, -back, 0.0, None)
        ends = self._scattered(target, apart=APART)
        mouths, facing, scattered = list[Mouth](), list[int](), list[Iterator[Floats]]()
        for number in range(MOST_ROOTS):
            if number % ROUND == 0:
                found = self._round(number // ROUND, query, target, route, ends)
                mouths += [mouth for mouth in found if not any(mouth.is_like(other) for other in mouths)]
                facing += [0] * (len(mouths) - len(facing))
                scattered += [self._scattered(mouth) for mouth in mouths[len(scattered) :]]
            which = number // 2 % len(mouths)
            if number % 2:
                chain = next(scattered[which], None)
            else:
                chain = self._facing(mouths[which], facing[which])
                facing[which] += 1
            if chain is not None:
                yield Root(chain, mouths[which].line)

    def _round(
        self, number: int, query: Floats, target: Mouth, route: Floats | None, ends: Iterator[Floats]
    ) -> list[Mouth]:
        """Return mouths of one more route; at first those of a tube about the target, too, and of the known route."""
        found = list[Mouth]()
        if number == 0 and route is not None:
            found += self._mouths(route)
        chain = None if found else next(ends, None)
        route = route if chain is None else self._route_from(chain)
        if chain is not None and route is not None:
            found += self._mouths(route)
        if number == 0:
            ahead = target.into if target.into.any() or route is None else _tangent(route, len(route) - 1)
            ways = [ahead] if target.into.any() else [ahead, -ahead]
            found += [mouth for way in ways if way.any() and (mouth := self._tube_mouth(query, way)) is not None]
            found = found or [target._replace(into=ahead)]
        return found

    def _tube_mouth(self, query: Floats, into: Floats) -> Mouth | None:
        """Return the mouth of the tube that the target lies in, where its end is reached with this tangent (3,)."""
        behind = query.copy()
        set_route_start(behind, query[t.QUERY_GOAL : t.QUERY_GOAL + 3].copy(), -into)
        tube = find_tube_around(self._groups[1], behind, self._deadline())
        if tube is None or not tube.open:
            return None
        line = tube.axis[::-1].copy()
        return Mouth(line[0], _tangent(line, 0), float(lengths_along(line)[-1]), line)

    def start_from(self, chain: Floats) -> Floats:
        """Return a configuration (n, 3) that begins with a root: the best of a few scattered starts of the rest."""
        rest = problem_beyond(self._groups, chain)
        found = search_part(rest, np.empty((0, int(rest[0][0]), 3)), (0, STARTS), self._deadline)
        return np.concatenate([chain, found.q])

    def led_back(self, chain: Floats, legs: Floats, width: int) -> Iterator[Floats]:
        """Yield configurations (n, 3) whose rest is grown from the target, and whose first rows get to where it ends.

        Parameters
        ----------
        chain : ndarray (k, 3)
            A root.
        legs : ndarray (l, K, 3)
            The legs of a route from there.
        width : int
            Of the beams.
        """
        rest = problem_beyond(self._groups, chain)
        terminal_poses = find_terminal_poses(rest, np.concatenate(list(legs)))
        if not len(terminal_poses):
            return
        other = reverse_problem(rest, terminal_poses[0])
        grown = GrownChains(other, legs[::-1, ::-1].copy(), terminal_poses, width, self._deadline())
        for i in range(min(grown.complete_count, LED_BACK)):
            tail, terminal_pose = grown.complete_chain(i)
            mount = grown.frames[grown.segments, i].copy()
            mount[TANGENT] *= -1.0
            exact = self._ending(mount, self._groups[2])
            starts = np.stack([chain, self._shapes[self._nearest(mount)]])
            root = search_part(exact, starts, (1, 1 + STARTS), self._deadline).q
            begun = problem_from_pose(rest, end_pose(self._groups, root))
            yield np.concatenate([root, reverse_chain(begun, problem_from_pose(other, terminal_pose), tail)])

    def _nearest(self, pose: Floats) -> int:
        """Number of the scattered shape that ends most nearly with the place and the tangent of a pose (12,)."""
        off = np.linalg.norm(self._ends[:, POSE_POSITION:] - pose[POSE_POSITION:], axis=1) / self._longest
        return int((off - self._ends[:, TANGENT] @ pose[TANGENT]).argmin())

    @cached_property
    def _shapes(self) -> Floats:
        """Shapes (m, k, 3) of the leading rows, evenly over what they can do (Roberts 2018)."""
        rows = segments_in(self._lead[0])
        moving = [(k, 0) for k in np.flatnonzero(rows[:, t.BEND_SCALE])]
        moving += [(k, 2) for k in np.flatnonzero(rows[:, t.LENGTH_SCALE])]
        ratio = 2.0
        for _ in range(32):
            ratio = (1.0 + ratio) ** (1.0 / (1.0 + len(moving)))
        shares = (0.5 + np.arange(SHAPES)[:, None] * ratio ** -np.arange(1.0, 1.0 + len(moving))) % 1.0
        result = np.zeros((SHAPES, len(rows), 3))
        result[:, :, :2], result[:, :, 2] = rows[:, t.REST : t.REST + 2], rows[:, t.MIN_LENGTH]
        for (k, column), share in zip(moving, shares.T, strict=True):
            if column == 2:
                result[:, k, 2] += share * (rows[k, t.MAX_LENGTH] - rows[k, t.MIN_LENGTH])
            else:
                z = rows[k, t.LOW_BEND] + share * (rows[k, t.HIGH_BEND] - rows[k, t.LOW_BEND])
                result[:, k, :2] += z[:, None] * rows[k, t.PLANE : t.PLANE + 2]
        return result

    @cached_property
    def _ends(self) -> Floats:
        """Poses (m, 12) in which these end."""
        parts = robot_parts(self._lead[0])
        frames = np.empty((SHAPES, self._count + 1, t.POSE_WIDTH))
        frames_of(parts.segments.copy(), self._shapes.copy(), parts.base[None].copy(), frames)
        return frames[:, -1]

    def _scattered(self, mouth: Mouth, apart: float = 0.0) -> Iterator[Floats]:
        """Yield scattered roots, those first from which the rest gets to a mouth most easily.

        `apart`: how far from each other, in lengths of the rest; then they are not noted.
        """
        costs, places = self._costs(mouth), self._ends[:, POSE_POSITION:]
        best = np.argsort(costs, kind="stable")[: SHAPES // SEEN]
        ways = places[best, None] + np.linspace(0.0, 1.0, SEEN + 1)[:-1, None] * (mouth.place - places[best, None])
        free = self._searches.distances(self._problem, ways.reshape(-1, 3)).reshape(len(best), SEEN).min(axis=1)
        costs[best] += UNSEEN * (free < self._searches.radius)
        own: list[Floats] = []
        for i in np.argsort(costs, kind="stable").tolist():
            self._deadline()
            if apart > 0.0:
                if all(np.linalg.norm(places[i] - other) > apart * self._longest for other in own):
                    own.append(places[i])
                    yield self._shapes[i]
            elif self._is_new(self._ends[i], note=False):
                chain = self._clear(self._shapes[i], self._ends[i])
                if chain is not None:
                    yield chain

    def _costs(self, mouth: Mouth) -> Floats:
        """What speaks against each of the shapes (m,)."""
        sight = mouth.place - self._ends[:, POSE_POSITION:]
        far = np.linalg.norm(sight, axis=1)
        sight /= np.maximum(far, 1e-12)[:, None]
        away = np.maximum(0.0, far + mouth.beyond - self._longest)
        near = np.maximum(0.0, self._shortest - far - mouth.beyond)
        ahead = 2.0 - (sight * self._ends[:, TANGENT]).sum(axis=1) - sight @ mouth.into
        return np.asarray(ahead + (AWAY * away + SHORT * near) / self._longest)

    def _facing(self, mouth: Mouth, number: int) -> Floats | None:
        """Return a root that faces a mouth from before it, or nearly so; the first ones in line with it."""
        into, share = mouth.into, 1.0
        if number < len(SHARES):
            share = SHARES[number]
        else:
            share, tilt = self._rng.uniform(SHARES[-1], SHARES[0]), self._rng.uniform(0.0, math.tan(TILT))
            aside = np.cross(into, self._rng.normal(size=3))
            into = into + tilt * aside / max(1e-12, float(np.linalg.norm(aside)))
        length = float(np.linalg.norm(into))
        room = self._longest - mouth.beyond
        if length == 0.0 or room <= 0.0:
            return None
        pose = np.empty(t.POSE_WIDTH)
        pose[POSE_POSITION:], pose[TANGENT] = mouth.place - share * room * into / length, into / length
        start = self._shapes[self._nearest(pose)]
        found = search_part(self._ending(pose), start[None], (1, 1 + STARTS), self._deadline)
        end = end_pose(self._groups, found.q)
        if not self._is_new(end, note=False):
            return None
        return self._clear(found.q, end)

    def _clear(self, chain: Floats, end: Floats) -> Floats | None:
        """Return a root like this one (k, 3), which ends with a pose (12,), that is proved clear; or `None`."""
        found = search_part(self._ending(end), chain[None], (0, 0), self._deadline)
        new = found.code == t.SOLVED and self._is_new(end_pose(self._groups, found.q))
        return found.q if new else None

    def _ending(self, pose: Floats, settings: Floats | None = None) -> Groups:
        """The problem of the leading rows to end with the place and the tangent of a pose (12,), loosely by default."""
        row = np.zeros((1, t.TARGET_WIDTH))
        row[0, t.TARGET_SEGMENT], row[0, t.HAS_POSITION], row[0, t.ORIENTATION] = -1.0, 1.0, t.DIRECTION
        row[0, t.TARGET_POSITION : t.TARGET_POSITION + 3] = pose[POSE_POSITION:]
        row[0, t.GOAL : t.GOAL + 3] = pose[TANGENT]
        robot, scene, loose = self._lead
        return robot, scene, loose if settings is None else settings, row

    def _is_new(self, pose: Floats, note: bool = True) -> bool:
        """Whether no root like a pose (12,) was told, or else note it."""
        near = ALIKE * self._longest
        for other in self._told:
            alike = other[TANGENT] @ pose[TANGENT] > math.cos(TURNED)
            if alike and np.linalg.norm(other[POSE_POSITION:] - pose[POSE_POSITION:]) < near:
                return False
        if note:
            self._told.append(pose)
        return True

    def _route_from(self, chain: Floats) -> Floats | None:
        """Return a route (K, 3) from a root to the target, as far as that may be; `None` where none is found."""
        searches = self._searches.at(chain)
        query = searches.query(self._problem)
        if query is None:
            return None
        query[t.QUERY_LONGEST] *= FARTHER
        for plan in searches.single_plans:
            found = searches.find(self._problem, query, plan, self._deadline())
            if found.routes:
                return found.routes[0]
        return None

    def _mouths(self, route: Floats) -> list[Mouth]:
        """Where narrow places of a route (K, 3) begin, the outermost first, as far as the rest gets."""
        left = lengths_along(route)
        left = left[-1] - left
        narrow = self._searches.distances(self._problem, route) < NARROW * self._searches.radius
        narrow &= left < self._longest
        begins = np.flatnonzero(narrow & ~np.append(False, narrow[:-1])).tolist()
        begins = [i for i in begins if i < len(route) - 2]
        return [Mouth(route[i], _tangent(route, i), float(left[i]), route[i:].copy()) for i in begins]
