"""Bridges: the part of a robot between a chain that comes out of a narrow place at the base, and one at the target.

In a tube a chain has one way to go, and it says itself where it comes out. What is left of the robot between both ends
is short, and in the open: scattered starts solve it. No route has to lead the right way, nor be known at all.
"""

from collections.abc import Iterator
from itertools import product

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.tables import MAX_BEND, MAX_LENGTH, MIN_LENGTH
from sinuous.solver.routing.growth import GrownChains
from sinuous.solver.routing.partial_problems import problem_beyond, problem_ending_at, segments_in, solve_part
from sinuous.solver.routing.reversed_problem import Groups, join_chains, problem_from_pose
from sinuous.solver.starts import Deadline

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
    ahead, behind : Grown
        Chains from the base and from the target that end in the open, or none that do.
    width : int
        Of the beams: about as many bridges are tried.
    deadline : callable
        See `Deadline`.
    """
    n, segments = int(groups[0][0]), segments_in(groups[0])
    freedom = 2 * (segments[:, MAX_BEND] > 0.0) + (segments[:, MAX_LENGTH] > segments[:, MIN_LENGTH])
    pairs = [
        (one, two)
        for one, two in product(_ends(ahead, width), _ends(behind, width))
        if one[0] + two[0] > 0 and freedom[one[0] : n - two[0]].sum() >= FREEDOM
    ]
    pairs.sort(key=lambda pair: n - pair[0][0] - pair[1][0])
    for one, two in pairs[: 2 * width]:
        if deadline() <= 0.0:
            return
        (head, _), (tail, root) = ahead.chain(*one), behind.chain(*two)
        rest = problem_beyond(groups, head)
        if len(tail) > 0:
            rest = problem_ending_at(rest, n - len(head) - len(tail), behind.frames[two])
        bridge = solve_part(rest, np.empty((0, int(rest[0][0]), 3)), min(width, STARTS), deadline)
        if bridge is not None:
            yield join_chains(groups, np.concatenate([head, bridge]), problem_from_pose(other, root), tail)


def _ends(grown: GrownChains, most: int) -> list[End]:
    """Chains beyond which a bridge may begin: those that end in the open, those that they continue, and the root."""
    if not grown.open:
        return [(0, 0)]
    k, outside = grown.outside()
    ends = [(k, i) for i in outside[: max(1, most // 4)]]
    ends += [(k - 1, grown.parent(*end)) for end in ends if k > 0]
    return list(dict.fromkeys([*ends, (0, 0)]))
