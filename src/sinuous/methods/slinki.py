"""SLInKi: weighted A* over motion primitives for all segments but two, FABRIKc for these.

Chiang et al., "SLInKi: state lattice based inverse kinematics" (2021). The paper itself could not be had; this follows
what others say of it. The tree grows until a node with two segments left costs least; FABRIKc then reaches from there
for the target. Where it does not get there, or the whole shape is not clear, the search goes on. Chosen here are the
primitives and what they cost, that FABRIKc begins with the single arc, that primitives which run into an obstacle are
left out, and that a tree that found nothing is followed by others with more primitives.

The tree lies in a workspace that is made beforehand. The iterations of a solution are nodes looked at and iterations of
FABRIKc together.

A node is the pose of a segment's end. Its children are the poses that the next segment reaches by one of its
primitives: lengths evenly over its range, straight or bent by one of a few angles (growing with their squares) in one
of a few directions. What a node costs is the sum of its squared bends; what it may still cost is seen from the biarc
(two arcs that meet smoothly, Bolton 1975) from there to the target: its squared bends, shared among the segments that
are left, and by how much it is longer or shorter than they can be, or bends more.
"""

import math
from collections import namedtuple
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sinuous.kernels.body.sampling import sampled_clearance
from sinuous.kernels.chain.arc import pose
from sinuous.kernels.chain.kinematics import compose, forward, frame, put_frame
from sinuous.kernels.chain.single_arc import arc_length
from sinuous.kernels.clock import SEGMENT_WORK, over, spend
from sinuous.kernels.fields.distances import work_of_all
from sinuous.kernels.maths import heap
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import ZERO, Array, Vec, add, add_scaled, dot, get_vec, norm, put_vec, sub, vec_mat
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.limits import bend_cap
from sinuous.kernels.tables import ARC, MAX_LENGTH, MIN_LENGTH
from sinuous.methods.fabrik.links import angle_between, axis_of, end_goal, fold, unit_or
from sinuous.methods.fabrik.reaching import Aside, carve, descend, scratch_size
from sinuous.methods.method import Capabilities, Options, count, number
from sinuous.methods.search import NO_START, Answer, Check, Start, has_obstacles, offer, own_number, search_by

Tree = namedtuple("Tree", ["frames", "q", "effort", "travel", "parent", "depth", "priority", "open"])
"""Nodes: frame (12,) of the end, the segment (3,) that leads there, cost so far, length so far, parent, number of
segments; and the heap of those that are open: what they cost in all, and their numbers."""

PER_NODE = 12 + 3 + 6
"""Numbers (float64) that a node takes from a buffer."""

WIDEST = 0.5 * math.pi
"""Most that a primitive bends."""

MISFIT = 10.0
"""Cost of a length that is off by the mean length of what is left, squared: as much as so many rad, squared."""

IMPOSSIBLE = 1e6
"""Cost of a length that is off by far more than that."""

WIDEST_HALF = 3.1
"""Half the bend from which on there is no single arc, in rad."""


def carve_tree(buffer: Array, nodes: int) -> Tree:
    """Lay out a tree in the beginning of `buffer` (`PER_NODE` numbers a node)."""
    frames, rest = cut(buffer, nodes, 12)
    q, rest = cut(rest, nodes, 3)
    effort, travel, priority = rest[:nodes], rest[nodes : 2 * nodes], rest[2 * nodes : 3 * nodes]
    whole = rest[3 * nodes : 6 * nodes].view(np.int64)
    return Tree(
        frames, q, effort, travel, whole[:nodes], whole[nodes : 2 * nodes], priority, whole[2 * nodes : 3 * nodes]
    )


def biarc(begin: Vec, first: Vec, end: Vec, last: Vec) -> tuple[float, float, float, float]:
    """Bends and lengths of the two arcs with links of equal length from `begin`, tangent `first`, to `end`, `last`.

    The joints `begin + d first` and `end - d last` are `2 d` apart: a quadratic equation with one positive root.
    Infinite lengths where there is none.
    """
    across, sum_of = sub(end, begin), add(first, last)
    along, square = dot(across, sum_of), dot(across, across)
    curve = 2.0 * (dot(first, last) - 1.0)
    below = along + math.sqrt(max(0.0, along * along - curve * square))
    if below <= 1e-9 * math.sqrt(square):
        return 0.0, 0.0, math.inf, math.inf
    d = square / below
    middle = unit_or(add_scaled(across, -d, sum_of), first)
    bend_1, bend_2 = angle_between(first, middle), angle_between(middle, last)
    return bend_1, bend_2, d * stretch_of(bend_1), d * stretch_of(bend_2)


def stretch_of(bend: float) -> float:
    """Length of an arc whose two links have length one."""
    return 2.0 if bend < 1e-6 else bend / math.tan(0.5 * bend)


def single(begin: Vec, first: Vec, end: Vec) -> tuple[float, float]:
    """Bend (rad) and length of the arc from `begin`, tangent `first`, to `end`; infinite where that is behind."""
    across = sub(end, begin)
    half = angle_between(first, unit_or(across, first))
    return 2.0 * half, arc_length(norm(across), half) if half < WIDEST_HALF else math.inf


def _beyond(value: float, low: float, high: float, unit: float) -> float:
    """By how much a length is outside its range, squared, in units."""
    off = max(0.0, low - value, value - high)
    return (off / unit) ** 2 if off < 1e3 * unit else IMPOSSIBLE


def outlook(limits: Array, sums: Array, k: int, begin: Vec, first: Vec, end: Vec, last: Vec, aimed: bool) -> float:
    """What the segments from number k on may cost to get from `begin`, tangent `first`, to `end`.

    `limits` (n, 7); `sums` (n + 1, 3): of segments k and after, the least and greatest length and the largest bend.
    """
    left = sums.shape[0] - 1 - k
    unit = max(0.5 * (sums[k, 0] + sums[k, 1]) / left, 1e-300)
    if not aimed:
        bend, length = single(begin, first, end)
        over = max(0.0, bend - sums[k, 2])
        return bend * bend / left + over * over + MISFIT * _beyond(length, sums[k, 0], sums[k, 1], unit)
    bend_1, bend_2, length_1, length_2 = biarc(begin, first, end, last)
    cost = 2.0 * (bend_1 * bend_1 + bend_2 * bend_2) / left
    if left == 2:
        over_1 = max(0.0, bend_1 - bend_cap(limits, k, limits[k, MAX_LENGTH]))
        over_2 = max(0.0, bend_2 - bend_cap(limits, k + 1, limits[k + 1, MAX_LENGTH]))
        off_1 = _beyond(length_1, limits[k, MIN_LENGTH], limits[k, MAX_LENGTH], unit)
        off_2 = _beyond(length_2, limits[k + 1, MIN_LENGTH], limits[k + 1, MAX_LENGTH], unit)
        return cost + over_1 * over_1 + over_2 * over_2 + MISFIT * (off_1 + off_2)
    over = max(0.0, bend_1 + bend_2 - sums[k, 2])
    return cost + over * over + MISFIT * _beyond(length_1 + length_2, sums[k, 0], sums[k, 1], unit)


def primitive(limits: Array, k: int, number: int, bends: int, directions: int, lengths: int) -> tuple[Vec, bool]:
    """Primitive number `number` of segment k, with these `limits` (n, 7), and whether there is one.

    Numbers run through directions first, then bends, then lengths; every second ring of directions is turned by half a
    step.
    """
    low, high = limits[k, MIN_LENGTH], limits[k, MAX_LENGTH]
    rings = bends if bend_cap(limits, k, high) > 0.0 else 0
    around = 1 + rings * directions
    sizes = lengths if high > low else 1
    which, place = number // around, number % around
    if which >= sizes:
        return (0.0, 0.0, 0.0), False
    length = low + (high - low) * (which / (sizes - 1) if sizes > 1 else 0.5)
    if place == 0:
        return (0.0, 0.0, length), True
    ring, step = (place - 1) // directions + 1, (place - 1) % directions
    bend = (ring / rings) ** 2 * min(WIDEST, bend_cap(limits, k, length))
    angle = 2.0 * math.pi * (step + 0.5 * (ring & 1)) / directions
    return (bend * math.cos(angle), bend * math.sin(angle), length), True


LAST = 2
"""Segments that FABRIKc reaches with."""

LEVELS = 3
"""Trees that are grown, each with more primitives than the one before."""

LOOKS = 4
"""Places of a primitive that are looked at for obstacles."""

Search = namedtuple("Search", ["tree", "work", "sums"])
"""Scratch of one solve: nodes, what FABRIKc works on, and sums (n + 1, 3) of limits (see `outlook`)."""

Goal = namedtuple("Goal", ["place", "tangent", "aimed"])
"""Where the end of the backbone is wanted, its tangent there, and whether that is asked for."""

Growth = namedtuple("Growth", ["bends", "directions", "lengths", "weight"])
"""Primitives of a segment, as bends, directions and lengths; and the weight of what a node may still cost."""


def carve_search(buffer: Array, limits: Array, nodes: int) -> Search:
    """Lay out the scratch in `buffer`, for a robot with these `limits` (n, 7)."""
    n = limits.shape[0]
    sums, rest = cut(buffer, n + 1, 3)
    put_vec(sums, n, 0, ZERO)
    for j in range(n):
        k = n - 1 - j
        sums[k, 0] = sums[k + 1, 0] + limits[k, MIN_LENGTH]
        sums[k, 1] = sums[k + 1, 1] + limits[k, MAX_LENGTH]
        sums[k, 2] = sums[k + 1, 2] + bend_cap(limits, k, limits[k, MAX_LENGTH])
    tree, work = carve_tree(rest, nodes), carve(rest[PER_NODE * nodes :], n, min(LAST, n))
    for i in range(work.chain.bends.shape[0] + 1):
        work.chain.first[i] = max(0, n - LAST) + i
    for k in range(n):
        work.chain.share[k] = 1.0
    return Search(tree, work, sums)


def lay_up(tree: Tree, node: int, frames: Array, q: Array) -> None:
    """Write the segments that lead to a node to `q` (n, 3), and their `frames` (n + 1, 12)."""
    while tree.depth[node] > 0:
        k = tree.depth[node] - 1
        rotation, position = frame(tree.frames, node)
        put_frame(frames, k + 1, rotation, position)
        put_vec(q, k, 0, get_vec(tree.q, node, 0))
        node = tree.parent[node]


def arc_from(frames: Array, first: int, goal: Vec, q: Array) -> None:
    """Put segments `first` and after of `q` (n, 3) on the single arc to the goal, whatever their limits.

    The arc begins where `frames` (n + 1, 12) say that segment `first` does.
    """
    rotation, position = frame(frames, first)
    local = vec_mat(sub(goal, position), rotation)
    bend, length = single(ZERO, (0.0, 0.0, 1.0), local)
    side = math.hypot(local[0], local[1])
    nx, ny = (local[0] / side, local[1] / side) if side > 0.0 else (1.0, 0.0)
    share = 1.0 / (q.shape[0] - first)
    for k in range(first, q.shape[0]):
        put_vec(q, k, 0, (share * bend * nx, share * bend * ny, share * length))


def expand(
    problem: Problem, check: Check, scratch: Search, node: int, size: int, open_nodes: int, goal: Goal, growth: Growth
) -> tuple[int, int]:
    """Give a node its children, as far as there is room and time; returns how many nodes there are, how many open."""
    tree = scratch.tree
    k = tree.depth[node]
    rotation, position = frame(tree.frames, node)
    number, looks = 0, SEGMENT_WORK + LOOKS * work_of_all(problem.scene)
    while size < tree.parent.shape[0] and not spend(check.clock, looks):
        q, there = primitive(problem.limits, k, number, growth.bends, growth.directions, growth.lengths)
        if not there:
            break
        number += 1
        turn, shift = pose(q[0], q[1], q[2])
        to, place = compose(rotation, position, turn, shift)
        put_frame(tree.frames, size, to, place)
        put_vec(tree.q, size, 0, q)
        if (
            has_obstacles(problem)
            and sampled_clearance(problem, rotation, position, q, k, tree.travel[node], LOOKS)[0] < 0.0
        ):
            continue
        tree.parent[size], tree.depth[size] = node, k + 1
        tree.travel[size] = tree.travel[node] + q[2]
        tree.effort[size] = tree.effort[node] + q[0] * q[0] + q[1] * q[1]
        ahead = outlook(problem.limits, scratch.sums, k + 1, place, axis_of(to), goal.place, goal.tangent, goal.aimed)
        cost = tree.effort[size] + growth.weight * ahead
        open_nodes = heap.push(tree.priority, tree.open, open_nodes, cost, size)
        size += 1
    return size, open_nodes


def grow(
    problem: Problem, check: Check, scratch: Search, options: Array, level: int, answer: Answer
) -> tuple[int, bool]:
    """Grow one tree until an answer is solved, nothing is open, or time is over.

    Returns the number of nodes looked at and iterations of FABRIKc, and whether it is solved. `options` (6,): see
    `Slinki`; every `level` has more primitives.
    """
    tree, work, n = scratch.tree, scratch.work, problem.limits.shape[0]
    growth = Growth(int(options[2]) + level, int(options[3]) + 4 * level, int(options[4]) + level, options[5])
    for k in range(n):
        put_vec(work.q, k, 0, (0.0, 0.0, 0.5 * (problem.limits[k, MIN_LENGTH] + problem.limits[k, MAX_LENGTH])))
    forward(problem.limits, work.q, check.frames)
    place, tangent, aimed = end_goal(problem, check.frames)
    goal = Goal(place, tangent, aimed)
    rotation, base = frame(check.frames, 0)
    put_frame(tree.frames, 0, rotation, base)
    tree.effort[0] = tree.travel[0] = 0.0
    tree.parent[0], tree.depth[0] = -1, 0
    first = max(0, n - LAST)
    open_nodes = heap.push(tree.priority, tree.open, 0, 0.0, 0)
    size, effort, looked = 1, 0, 0
    while open_nodes > 0:
        node, open_nodes = heap.pop(tree.priority, tree.open, open_nodes)
        looked += 1
        if tree.depth[node] < first:
            size, open_nodes = expand(problem, check, scratch, node, size, open_nodes, goal, growth)
        else:
            lay_up(tree, node, check.frames, work.q)
            arc_from(check.frames, first, goal.place, work.q)
            fold(problem.limits, work.chain, check.frames, True, work.q)
            effort += descend(problem, check, work, int(options[0]), Aside(0, 0.0, 0.0))[0]
            if offer(problem, check, work.kept, ARC, answer):
                return looked + effort, True
        if over(check.clock):
            break
    return looked + effort, False


def follow(
    problem: Problem, check: Check, scratch: Array, options: Array, start: Start, answer: Answer
) -> tuple[int, bool]:
    """Follow one start; see `sinuous.methods.search`. Initial configurations are counted and passed over.

    The `options` are the fields of `Slinki`. Nothing is random.
    """
    level = own_number(start)
    if level < 0:
        return 0, False
    if level >= LEVELS:
        return NO_START, False
    own = carve_search(scratch, problem.limits, int(options[1]))
    return grow(problem, check, own, options, level, answer)


search = search_by(follow)


@dataclass(frozen=True, repr=False)
class Slinki(Options):
    """Options of the method `slinki`.

    Attributes
    ----------
    iterations : int
        Most iterations of FABRIKc from one node of the tree.
    nodes : int
        Most nodes of one tree; each takes 168 bytes of every thread's workspace.
    bends, directions, lengths : int
        Primitives of a segment: so many angles besides straight (growing with their squares, a quarter turn at most),
        in so many directions, at so many lengths. Every further start takes more of them, three in all.
    weight : float
        Weight of what a node may still cost against what it costs; 1 searches widely, more goes straight ahead.
    """

    compiled_search = staticmethod(search)
    method: ClassVar[str] = "slinki"
    capabilities: ClassVar[Capabilities] = Capabilities("Chiang et al. 2021", obstacles=True, initial=False)

    iterations: int = count(60, 1, 1_000_000)
    nodes: int = count(8192, 2, 100_000_000)
    bends: int = count(3, 1, 100)
    directions: int = count(8, 3, 1000)
    lengths: int = count(3, 1, 100)
    weight: float = number(10.0, low=0.0)

    def scratch(self, segments: int) -> int:
        """Return the size of the scratch; see `Options.scratch`."""
        return 3 * (segments + 1) + PER_NODE * self.nodes + scratch_size(segments)
