"""Beam search over chains: every segment is one arc within its limits, and the best chains of every length go on.

A route is a curve that a ball can follow, and a body may not turn as tightly. So chains are grown from the base,
segment after segment, by arcs that the segment can have (motion primitives; Pivtoraiko, Knepper & Kelly 2009), each
bent off the obstacles. The route says from every place how long the rest of the way is. Of every number of segments
some chains are kept: the best of which no two end alike, and only a few that continue the same one, because they would
share what is wrong with it.
"""

import math

from sinuous.kernels.chain.arc import pose
from sinuous.kernels.chain.kinematics import compose, frame, put_frame
from sinuous.kernels.clock import allow, begin, spend
from sinuous.kernels.compile import entry, kernel
from sinuous.kernels.fields.distances import price
from sinuous.kernels.growing.arcs import ARCS, Start, bent_off, count_of, tried
from sinuous.kernels.growing.guide import needed, sighted
from sinuous.kernels.growing.legs import Leg, leg_to, missed
from sinuous.kernels.growing.meeting import meets_itself
from sinuous.kernels.growing.tree import (
    Level,
    Tree,
    carve_tree,
    differs,
    empty_buckets,
    level_of,
    put_chain,
    trace,
    tree_size,
)
from sinuous.kernels.maths import heap
from sinuous.kernels.maths.vectors import Array, Vec, get_vec, put_vec
from sinuous.kernels.problem import Problem, read_problem
from sinuous.kernels.tables import MAX_LENGTH, MIN_LENGTH

OVERLAP, SHORT, LONG = 16.0, 2.0, 3.0
"""Weights in the score of a chain: of the square of an overlap, in radii; of what it lacks in length, or is off at the
end, in segments; and of what it has too much in length, in segments for each one that is left."""

LEEWAY = 1.05
"""How much longer than needed the rest of a chain may be at no cost."""

EDGE = 0.5
"""Edge of the cubes within which chains count as alike, in lengths of a segment."""

CHILDREN = 8
"""No chain is continued by more than one of so many that are kept, and one."""

LOOKS = 40
"""Distances that one arc takes, about."""


def growing_size(segments: int, obstacles: int, width: int) -> int:
    """Numbers (float64) that growing with a beam of this width, a power of two, needs as workspace."""
    return tree_size(segments, width) + obstacles


@kernel
def _lengths(problem: Problem, first: int, last: int) -> tuple[float, float]:
    """Least and greatest length of the segments from `first` to `last`."""
    low = high = 0.0
    for k in range(first, last + 1):
        low += problem.limits[k, MIN_LENGTH]
        high += problem.limits[k, MAX_LENGTH]
    return low, high


@kernel
def _tangent(start: Start) -> Vec:
    return start[0][0][2], start[0][1][2], start[0][2][2]


@kernel
def _score(problem: Problem, leg: Leg, k: int, end: Start, seen: int) -> float:
    """What is amiss with a chain whose segment `k` is the last and ends with this pose."""
    mean = problem.unit / problem.limits.shape[0]
    if k == leg.last:
        return SHORT * missed(problem, leg, end) / mean
    low, high = _lengths(problem, k + 1, leg.last)
    need = max(0.0, needed(leg.guide, end[1], _tangent(end), seen) - leg.around)
    short = max(0.0, need - high) / mean
    long = max(0.0, low - LEEWAY * need) / (mean * (leg.last - k))
    return SHORT * short + LONG * long


@kernel
def _end(start: Start, q: Vec) -> Start:
    """Pose of the end of an arc."""
    turn, shift = pose(q[0], q[1], q[2])
    return compose(start[0], start[1], turn, shift)


@kernel
def _promise(problem: Problem, leg: Leg, tree: Tree, k: int, count: int) -> int:
    """Put the arcs that continue the `count` chains of `k` segments into the heap, by the scores that they promise.

    Obstacles are left out, and what the new end sees is taken to be what the old one did. Returns how many there are.
    """
    level, size = level_of(tree.levels, k), 0
    low, high = _lengths(problem, k, leg.last)
    for i in range(count):
        start, seen = frame(level.frames, i), level.seen[i]
        need = needed(leg.guide, start[1], _tangent(start), seen) - leg.around
        share = min(1.0, max(0.0, (need - low) / (high - low))) if high > low else 0.0
        spend(tree.clock, ARCS)
        for number in range(count_of(problem, k)):
            q = tried(problem, leg.guide, start, (k, number), seen, share)
            score = level.cost[i] + _score(problem, leg, k, _end(start, q), seen)
            put_vec(tree.arcs, i * ARCS + number, 0, q)
            size = heap.push(tree.heap, tree.items, size, score, i * ARCS + number)
    return size


@kernel
def _continued(problem: Problem, leg: Leg, tree: Tree, k: int, item: int, made: int) -> bool:
    """Make number `made` of the new chains, by an arc that continues one of `k` segments; False where it cannot be."""
    level, new, i = level_of(tree.levels, k), level_of(tree.made, 0), item // ARCS
    start, seen, along = frame(level.frames, i), level.seen[i], level.along[i]
    q, depth = bent_off(problem, (start, k, along), get_vec(tree.arcs, item, 0), tree.among)
    if depth == math.inf or (problem.avoids_itself and meets_itself(problem, tree.levels, k, i, q)):
        return False
    end = _end(start, q)
    if along + q[2] > problem.mount:
        seen = sighted(problem.scene, leg.guide, end[1], seen)
    if seen < 0:
        return False
    put_frame(new.frames, made, end[0], end[1])
    put_vec(new.q, made, 0, q)
    new.along[made], new.parent[made], new.seen[made] = along + q[2], i, seen
    new.cost[made] = level.cost[i] + OVERLAP * depth * depth
    new.score[made] = new.cost[made] + _score(problem, leg, k, end, seen)
    if k == leg.last:
        new.cost[made] = new.score[made]
    return True


@kernel
def _make(problem: Problem, leg: Leg, tree: Tree, k: int, size: int) -> int:
    """Look at the `size` arcs in the heap, the most promising first; returns how many chains that makes."""
    count, most, looks = 0, tree.made.score.shape[1], LOOKS * price(problem.scene)
    while size > 0 and count < most:
        if spend(tree.clock, looks):
            return 0
        item, size = heap.pop(tree.heap, tree.items, size)
        count += 1 if _continued(problem, leg, tree, k, item, count) else 0
    return count


@kernel
def _keep(tree: Tree, k: int, made: int, most: int, edge: float) -> int:
    """Keep the best of the chains that are made, at most so many, as those of `k` segments; returns how many."""
    level, before, new = level_of(tree.levels, k), level_of(tree.levels, k - 1), level_of(tree.made, 0)
    width = before.children.shape[0]
    children = 1 + width // CHILDREN if k > 1 else width
    for i in range(width):
        before.children[i] = 0
    empty_buckets(tree)
    size = kept = 0
    for i in range(made):
        size = heap.push(tree.heap, tree.items, size, new.score[i], i)
    while size > 0 and kept < most:
        i, size = heap.pop(tree.heap, tree.items, size)
        parent = new.parent[i]
        if before.children[parent] < children and differs(tree, frame(new.frames, i), edge):
            before.children[parent] += 1
            put_chain(level, kept, new, i)
            kept += 1
    return kept


@kernel
def _look_along(problem: Problem, leg: Leg, level: Level, count: int) -> None:
    """Find out what the first `count` chains of a level see of a leg that begins with them."""
    for i in range(count):
        level.seen[i] = max(0, sighted(problem.scene, leg.guide, frame(level.frames, i)[1], 0))


@kernel
def _grow(problem: Problem, tree: Tree, legs: Array, chains: Array) -> int:
    """Fill `chains` (m, n, 3), the best first; returns how many there are."""
    root, n = level_of(tree.levels, 0), problem.limits.shape[0]
    rotation, place = frame(problem.base, 0)
    put_frame(root.frames, 0, rotation, place)
    root.cost[0], root.along[0] = 0.0, 0.0
    count, k = 1, 0
    for number in range(legs.shape[0]):
        leg = leg_to(problem, legs[number], number)
        _look_along(problem, leg, level_of(tree.levels, k), count)
        while k <= leg.last:
            made = _make(problem, leg, tree, k, _promise(problem, leg, tree, k, count))
            final = number == legs.shape[0] - 1 and k == leg.last
            k += 1
            most = chains.shape[0] if final else tree.levels.q.shape[1]
            count = _keep(tree, k, made, most, EDGE * problem.unit / n)
    for i in range(count):
        trace(tree.levels, k, i, chains[i])
        for beyond in range(k, n):
            put_vec(chains[i], beyond, 0, (0.0, 0.0, problem.limits[beyond, MIN_LENGTH]))
    return count


@entry
def grow_chains(
    robot: Array,
    scene: Array,
    settings: Array,
    targets: Array,
    legs: Array,
    effort: tuple[float, int],
    workspace: Array,
    chains: Array,
) -> int:
    """Grow chains along a route, from target to target.

    Parameters
    ----------
    robot, scene, settings : ndarray
        Groups, laid out as `sinuous.kernels.tables` says.
    targets : ndarray (t, 15)
        Of which at least one has a position.
    legs : ndarray (l, K, 3)
        Routes, each of at least two points, evenly spaced, in the length unit: from the base to the first target that
        has a position, from there to the next one, and so on, in the order of their segments.
    effort : (float, int)
        Seconds; and the width of the beam: how many chains are kept of every number of segments, a power of two.
    workspace : ndarray (w,)
        Scratch, see `growing_size`.
    chains : ndarray (m, n, 3)
        Filled with configurations that lie free, or nearly so, and end near the last of the targets, the best first.

    Returns
    -------
    int
        How many there are; none when the time did not suffice.
    """
    problem = read_problem(robot, scene, settings, targets)
    seconds, width = effort
    tree = carve_tree(workspace, problem, width)
    begin(tree.clock)
    allow(tree.clock, seconds)
    return _grow(problem, tree, legs, chains)
