"""Beam search over chains: every segment is one arc within its limits, and the best chains of every length go on.

A route is a curve that a ball can follow, and a body may not turn as tightly. So chains are grown from a pose, segment
after segment, by arcs that the segment can have (motion primitives; Pivtoraiko, Knepper & Kelly 2009), each bent off
the obstacles. The route says from every place how long the rest of the way is. Of every number of segments some chains
are kept.

Without a route, arcs are drawn at random: what counts is only that the rest of the chain is long enough to get there.
"""

import math

import numpy as np

from sinuous.kernels.chain.kinematics import frame, put_frame
from sinuous.kernels.clock import SEGMENT_WORK, begin_for, spend
from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import closest, work_of_all
from sinuous.kernels.fields.solids import INTERPOLATED
from sinuous.kernels.growing.arcs import ARCS, Start, ahead_of, count_arcs, end_of, make_arc, start_of, thickness
from sinuous.kernels.growing.beam import (
    CHAIN_LENGTH,
    COST,
    END_DISTANCE,
    FINE_SPACING,
    FINE_TANGENT_CELLS,
    FRAME,
    GUIDE_POINT,
    LAST_SEGMENT_Q,
    PARENT,
    SCORE,
    SEGMENT_BEFORE_Q,
    Beam,
    carve_beam,
    empty_buckets,
    keep_best,
    note_new_end,
)
from sinuous.kernels.growing.bending import RELIEF_STEPS, RELIEF_STEPS_AT_RANDOM, bend_off_walls
from sinuous.kernels.growing.guide import is_route, last_seen, needed_length
from sinuous.kernels.growing.legs import Leg, distance_to_target, make_leg
from sinuous.kernels.growing.meeting import meets_itself
from sinuous.kernels.maths import heap
from sinuous.kernels.maths.vectors import ZERO, Array, Vec, get_vec, put_vec
from sinuous.kernels.problem import Problem, read_problem
from sinuous.kernels.step.limits import length_range
from sinuous.kernels.step.scattered import scattered, uniform
from sinuous.kernels.tables import BEND_SCALE, MAX_LENGTH, POSE_WIDTH

APART = np.uint64(0x85EBCA77)
"""How far the keys of random numbers of one segment are from those of the next."""

OVERLAP_COST = 16.0
"""Score of the square of an overlap, in radii."""

PRESSURE_COST = 1.0
"""Score of the mean pressure of an arc, see `bending`."""

SHORT_COST, LONG_COST = 2.0, 3.0
"""Score of what a chain lacks in length, or is off at the end, in segments; and of what it has too much in length, in
segments for each one that is left."""

LEEWAY = 1.05
"""How much longer than needed the rest of a chain may be at no cost."""

UNSEEN_COST = 1.0
"""Score of a segment from whose end no point of the guide is seen: it may be on another way."""

ARCS_PER_CHAIN = 2
"""Arcs that are examined for each chain that is made, at most: in a tube all of them turn into the same one."""

ARC_WORK = 100
"""Distances that one arc takes, about."""


def _tangent(start: Start) -> Vec:
    return start[0][0][2], start[0][1][2], start[0][2][2]


def _score_chain(problem: Problem, leg: Leg, k: int, end: Start, seen: int) -> float:
    """What is amiss with a chain whose segment `k` is the last and ends with this pose."""
    mean = problem.unit / problem.limits.shape[0]
    if k == leg.last:
        return SHORT_COST * distance_to_target(problem, leg, end) / mean
    low, high = length_range(problem.limits[k + 1 : leg.last + 1])
    need = max(0.0, needed_length(leg.guide, end[1], _tangent(end), seen) - leg.around)
    short = max(0.0, need - high) / mean
    long = max(0.0, low - LEEWAY * need) / (mean * (leg.last - k)) if is_route(leg.guide) else 0.0
    return SHORT_COST * short + LONG_COST * long


def _list_arcs(problem: Problem, leg: Leg, beam: Beam, k: int, count: int) -> int:
    """Put the arcs that continue the `count` chains of `k` segments into the heap, by the scores that they promise.

    Obstacles are left out, and the new end is taken to see what the old one did, or what is half a segment beyond it.
    Returns how many there are: none where the time is over.
    """
    level, size = beam.levels[k], 0
    low, high = length_range(problem.limits[k : leg.last + 1])
    for i in range(count):
        start, seen = frame(level, i), int(level[i, GUIDE_POINT])
        need = needed_length(leg.guide, start[1], _tangent(start), seen) - leg.around
        fraction = min(1.0, max(0.0, (need - low) / (high - low))) if high > low else 0.0
        ahead = max(seen, ahead_of(leg.guide, start, seen, 1.5, problem.limits[k, MAX_LENGTH]))
        if spend(beam.clock, SEGMENT_WORK * ARCS):
            return 0
        for number in range(count_arcs(problem, k)):
            q = make_arc(problem, leg.guide, start, (k, number), seen, fraction)
            score = level[i, COST] + _score_chain(problem, leg, k, end_of(start, q), ahead)
            put_vec(beam.arcs, i * ARCS + number, 0, q)
            size = heap.push(beam.heap, beam.items, size, score, i * ARCS + number)
    return size


def _draw_arcs(problem: Problem, leg: Leg, beam: Beam, k: int, count: int) -> int:
    """Do the same with arcs drawn at random, as many in all for few chains as for many; chance puts them in order."""
    level, each, size = beam.levels[k], beam.arcs.shape[0] // count, 0
    for item in range(each * count):
        if spend(beam.clock, SEGMENT_WORK):
            return 0
        i = item // each
        scattered(problem.limits[k : k + 1], item, beam.levels.shape[1] + k, math.inf, beam.arcs[item : item + 1])
        end = end_of(frame(level, i), get_vec(beam.arcs, item, 0))
        score = level[i, COST] + _score_chain(problem, leg, k, end, 1)
        chance = uniform(np.uint64(item) + np.uint64(k) * APART)
        size = heap.push(beam.heap, beam.items, size, score + chance, item)
    return size


def _continue_chain(problem: Problem, leg: Leg, beam: Beam, k: int, which: tuple[int, int], made: int) -> bool:
    """Make number `made` of the new chains, by an arc that continues one of `k` segments; False where it cannot be.

    `which`: the number of the chain that is continued, and that of the arc.
    """
    level, new, (i, item) = beam.levels[k], beam.made, which
    start, along, mean = frame(level, i), level[i, CHAIN_LENGTH], problem.unit / problem.limits.shape[0]
    own, aim = get_vec(level, i, LAST_SEGMENT_Q), get_vec(beam.arcs, item, 0)
    joint = k > leg.first and problem.limits[k - 1, BEND_SCALE] > 0.0
    before = (start_of(start, own), k - 1, along - own[2]) if joint else (start, k, along)
    steps = RELIEF_STEPS if is_route(leg.guide) else RELIEF_STEPS_AT_RANDOM
    (own, q), overlap, tight = bend_off_walls(problem, before, (start, k, along), (own, aim), joint, beam.nearby, steps)
    start = end_of(before[0], own) if joint else start
    if overlap == math.inf or (problem.avoids_itself and meets_itself(problem, beam.levels, k, i, start, q)):
        return False
    end = end_of(start, q)
    if not note_new_end(beam, end, FINE_SPACING * mean, FINE_TANGENT_CELLS):
        return False
    seen, cost = int(level[i, GUIDE_POINT]), OVERLAP_COST * max(0.0, overlap) ** 2 + PRESSURE_COST * tight
    looks = is_route(leg.guide) and along + q[2] > problem.mount
    found = last_seen(problem.scene, leg.guide, end[1], seen) if looks else seen
    seen = found if found >= 0 else seen
    put_frame(new, made, end[0], end[1])
    put_vec(new, made, LAST_SEGMENT_Q, q)
    put_vec(new, made, SEGMENT_BEFORE_Q, own)
    new[made, CHAIN_LENGTH], new[made, PARENT], new[made, GUIDE_POINT] = along + q[2], i, seen
    new[made, COST] = level[i, COST] + cost
    new[made, SCORE] = new[made, COST] + _score_chain(problem, leg, k, end, seen) + (UNSEEN_COST if found < 0 else 0.0)
    if k == leg.last:
        new[made, COST] = new[made, SCORE]
    return True


def _make_chains(problem: Problem, leg: Leg, beam: Beam, k: int, size: int, each: int) -> int:
    """Examine the `size` arcs in the heap, `each` for a chain, the most promising first.

    Without a route scores tell little, so no more chains are made than are kept. Returns how many chains that makes.
    """
    most = beam.made.shape[0] if is_route(leg.guide) else beam.levels.shape[1]
    count, left, units = 0, ARCS_PER_CHAIN * most, ARC_WORK * work_of_all(problem.scene)
    empty_buckets(beam)
    while size > 0 and (left > 0 or count == 0) and count < most:
        if spend(beam.clock, units):
            return 0
        item, size = heap.pop(beam.heap, beam.items, size)
        left -= 1
        count += 1 if _continue_chain(problem, leg, beam, k, (item // each, item), count) else 0
    return count


def _find_open_ends(problem: Problem, beam: Beam, k: int, count: int, open_from: float) -> bool:
    """Whether one of the `count` chains of `k` segments ends so far from the obstacles, in radii; notes how far."""
    level, found = beam.levels[k], False
    n = problem.limits.shape[0]
    radius = max(thickness(problem, max(0, k - 1)), thickness(problem, min(k, n - 1)))
    for i in range(count):
        if spend(beam.clock, work_of_all(problem.scene)):
            return False
        d, _ = closest(problem.scene, frame(level, i)[1], open_from * radius, INTERPOLATED)
        level[i, END_DISTANCE] = d / radius
        found = found or level[i, END_DISTANCE] >= open_from
    return found


@entry
def grow_chains(
    robot: Array,
    scene: Array,
    settings: Array,
    targets: Array,
    legs: Array,
    roots: Array,
    open_from: float,
    seconds: float,
    workspace: Array,
    levels: Array,
    counts: Array,
) -> bool:
    """Grow chains along a route, from target to target, or until one of them ends in the open; say whether one does.

    Parameters
    ----------
    robot, scene, settings : ndarray
        Groups, laid out as `sinuous.kernels.tables` says.
    targets : ndarray (t, 15)
        Of which at least one has a position.
    legs : ndarray (l, K, 3)
        Routes, evenly spaced, in the length unit: from the base to the first target that has a position, from there to
        the next one, and so on, in the order of their segments. Of two points: none is known but where it ends.
    roots : ndarray (r, 12)
        Poses that chains may begin with: at most as many as are kept.
    open_from : float
        How far from the obstacles the open is, in radii of the body; inf: nowhere.
    seconds : float
        Budget.
    workspace : ndarray (s,)
        Scratch, see `beam.beam_size`.
    levels : ndarray (m + 1, w, CHAIN_WIDTH)
        Filled with the chains of every number of segments up to m, the best first, see `beam`; w is a power of two.
    counts : ndarray (m + 1,) int64
        Filled with the number of chains of every number of segments: 0 beyond those that were grown in time.
    """
    problem = read_problem(robot, scene, settings, targets)
    beam = carve_beam(levels, workspace, problem.scene.table.shape[0])
    begin_for(beam.clock, seconds)
    for k in range(counts.shape[0]):
        counts[k] = 0
    counts[0] = min(roots.shape[0], levels.shape[1])
    for i in range(counts[0]):
        for j in range(POSE_WIDTH):
            levels[0, i, FRAME + j] = roots[i, j]
        levels[0, i, COST] = levels[0, i, CHAIN_LENGTH] = 0.0
        put_vec(levels[0], i, LAST_SEGMENT_Q, ZERO)
    k, mean = 0, problem.unit / problem.limits.shape[0]
    for number in range(legs.shape[0]):
        leg = make_leg(problem, legs[number], number, k)
        for i in range(counts[k]):
            seen = max(0, last_seen(problem.scene, leg.guide, frame(levels[k], i)[1], 0)) if is_route(leg.guide) else 1
            levels[k, i, GUIDE_POINT] = seen
        while k <= min(leg.last, counts.shape[0] - 2) and counts[k] > 0:
            if open_from < math.inf and _find_open_ends(problem, beam, k, counts[k], open_from):
                return True
            if is_route(leg.guide):
                each, promised = ARCS, _list_arcs(problem, leg, beam, k, counts[k])
            else:
                each, promised = beam.arcs.shape[0] // counts[k], _draw_arcs(problem, leg, beam, k, counts[k])
            made = _make_chains(problem, leg, beam, k, promised, each)
            k += 1
            counts[k] = keep_best(beam, k, made, mean)
        if counts[k] == 0 or k == counts.shape[0] - 1:
            return False
    return False
