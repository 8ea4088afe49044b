"""Chains for narrow places: grown from the base and from the target, and joined where they nearly meet.

Either end may lie in a tube, before its mouth or in a cell, where the first segments have one way to go; a chain that
is grown from the other end is lost there. So chains are grown from both ends, by arcs that follow walls by themselves
(`kernels.growing`). Of k segments from the base and n - k from the target that nearly meet, one part is solved for the
pose in which the other begins: two problems of half the segments are far easier than one of all. An arc does not care
how it is turned about its tangent, so what is joined meets both ends.

An elbow in a narrow place leaves few tangents to pass it with, and chains past all targets seldom arrive with one of
these. So, for some of its tangents, chains are also grown in two parts: up to the elbow, and from there.
"""

import math
from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.tables import POSE_POSITION, POSE_WIDTH, UNIT
from sinuous.solver.routing.bridges import OPEN, bridge_chains
from sinuous.solver.routing.growth import FIRST_WIDTH, GrownChains, segments_of, settle_chains
from sinuous.solver.routing.partial_problems import (
    problem_beyond,
    problem_ending_at,
    problem_up_to,
    solve_part,
    with_end_tangent,
)
from sinuous.solver.routing.reversed_problem import (
    Groups,
    join_chains,
    problem_from_pose,
    reverse_chain,
    reverse_problem,
)
from sinuous.solver.routing.terminal_poses import find_terminal_poses
from sinuous.solver.starts import Deadline

WHOLES = 2
"""Most chains of one beam that reach the other end by themselves and are given."""

MOST_JUNCTIONS = 4
"""Most joints of beams that are `FIRST_WIDTH` wide; with their width goes its square root."""

GAP = 2.5
"""Greatest gap that is joined, in lengths of a segment."""

TURN = 0.5
"""Gap that a radian between the tangents counts as, in lengths of a segment."""

DEAR = 2.0
"""What a gap of a segment counts beside the scores of both parts."""

TANGENT = slice(2, POSE_POSITION, 3)
"""The tangent (3,) in a pose (12,)."""

MOST_TANGENTS = 4
"""Most tangents of an elbow with which chains are led past it."""


class _Junction(NamedTuple):
    """Chain number `i` of `k` segments from the base, and number `j` of all others from the target, nearly meet."""

    score: float
    k: int
    i: int
    j: int


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
    """

    def __init__(self, groups: Groups, legs: Floats, deadline: Deadline) -> None:
        self._groups, self._legs, self._deadline = groups, legs, deadline
        self._n = int(groups[0][0])
        self._segment = float(groups[2][UNIT]) / self._n
        self._roots = find_terminal_poses(groups, np.concatenate(list(legs)))
        self._other = reverse_problem(groups, self._roots[0]) if len(self._roots) else None

    def chains_of_width(self, width: int) -> Iterator[Floats]:
        """Yield chains (n, 3) of beams that are so wide, the likeliest first."""
        yield from self.chains_past_all_targets(width, OPEN)
        for elbow in self._elbows:
            yield from elbow.chains_of_width(width)

    @cached_property
    def _elbows(self) -> "list[_IntermediateTarget]":
        """Ways to pass the first elbow, where there is one; made once chains past all targets are not enough."""
        if len(self._legs) == 1:
            return []
        before = problem_up_to(self._groups, segments_of(self._groups)[0] + 1)
        ends = find_terminal_poses(before, self._legs[0])[:MOST_TANGENTS]
        return [_IntermediateTarget(self._groups, before, self._legs, end, self._deadline) for end in ends]

    def chains_past_all_targets(self, width: int, open_from: float = math.inf) -> Iterator[Floats]:
        """Yield chains (n, 3) of beams that lead past all targets; first those that are bridged, see `Grown`."""
        if self._other is None:
            yield from self._given(self._wholes(self._ahead(width), self._groups))
            return
        ahead, behind = self._ahead(width, open_from), self._behind(self._other, width, open_from)
        yield from bridge_chains(self._groups, self._other, ahead, behind, width, self._deadline)
        ahead = self._ahead(width) if ahead.open else ahead
        behind = self._behind(self._other, width) if behind.open else behind
        yield from self._joined(ahead, behind, round(MOST_JUNCTIONS * math.sqrt(width / FIRST_WIDTH)))
        yield from self._given([*self._wholes(ahead, self._groups), *self._wholes(behind, self._other)])

    def _ahead(self, width: int, open_from: float = math.inf) -> GrownChains:
        """Chains from the base."""
        base = self._groups[0][None, -2 * POSE_WIDTH : -POSE_WIDTH]
        return GrownChains(self._groups, self._legs, base.copy(), width, self._deadline(), open_from)

    def _behind(self, other: Groups, width: int, open_from: float = math.inf) -> GrownChains:
        """Chains from the target."""
        return GrownChains(other, self._legs[::-1, ::-1].copy(), self._roots, width, self._deadline(), open_from)

    def _wholes(self, grown: GrownChains, groups: Groups) -> Iterator[tuple[float, Floats]]:
        """Chains (n, 3) that reach the other end by themselves, and their scores."""
        for i in range(min(grown.complete_count, WHOLES)):
            chain, root = grown.complete_chain(i)
            if groups is not self._groups:
                chain = reverse_chain(self._groups, problem_from_pose(groups, root), chain)
            yield float(grown.scores[grown.segments, i]), chain

    def _given(self, wholes: Iterable[tuple[float, Floats]]) -> Iterator[Floats]:
        """Yield chains, the best first, drawn to the targets."""
        best_first = (chain for _, chain in sorted(wholes, key=lambda whole: whole[0]))
        yield from settle_chains(self._groups, best_first, self._deadline)

    def _joined(self, ahead: GrownChains, behind: GrownChains, most: int) -> Iterator[Floats]:
        """Yield chains (n, 3) that meet both ends, of parts from either end."""
        assert self._other is not None
        for _, k, i, j in self._joints(ahead, behind)[:most]:
            if self._deadline() <= 0.0:
                return
            (head, _), (tail, root) = ahead.chain(k, i), behind.chain(self._n - k, j)
            begun = problem_from_pose(self._other, root)
            closed = self._closed(self._groups, head, behind.frames[self._n - k, j])
            if closed is not None:
                head = closed
            else:
                closed = self._closed(begun, tail, ahead.frames[k, i])
                if closed is None:
                    continue
                tail = closed
            yield join_chains(self._groups, head, begun, tail)

    def _joints(self, ahead: GrownChains, behind: GrownChains) -> list[_Junction]:
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
            for flat in np.argsort(score, axis=None)[:MOST_JUNCTIONS]:
                i, j = divmod(int(flat), others)
                if gap[i, j] < GAP:
                    joints.append(_Junction(float(score[i, j]), k, i, j))
        return sorted(joints)

    def _closed(self, groups: Groups, chain: Floats, end: Floats) -> Floats | None:
        """Return a chain like this one (k, 3) that ends against a pose (12,); `None` where none is found."""
        return solve_part(problem_ending_at(groups, len(chain), end), chain[None], 0, self._deadline)


class _IntermediateTarget:
    """Chains in two parts: up to the first elbow, to pass it with one tangent, and from there as the first part ends.

    Parameters
    ----------
    groups, before : tuple of ndarray
        The problem, and that of the segments up to the elbow.
    legs, deadline
        See `Chains`.
    root : ndarray (12,)
        Pose of the elbow, against the tangent.
    """

    def __init__(self, groups: Groups, before: Groups, legs: Floats, root: Floats, deadline: Deadline) -> None:
        self._groups, self._before, self._legs, self._deadline = groups, before, legs, deadline
        self._heads = JoinedChains(with_end_tangent(before, -root[TANGENT]), legs[:1], deadline)
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
