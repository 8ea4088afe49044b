"""SLInKi: weighted A* over motion primitives for all segments but two, FABRIKc for these.

Chiang et al., "SLInKi: state lattice based inverse kinematics" (2021). The paper itself could not be had; this follows
what others say of it. The tree of `sinuous.methods.slinki.lattice` grows until a node with two segments left costs
least; FABRIKc then reaches from there for the target. Where it does not get there, or the whole shape is not clear, the
search goes on. Chosen here are the primitives and what they cost, that FABRIKc begins with the single arc, that
primitives which run into an obstacle are left out, and that a tree that found nothing is followed by others with more
primitives.

The tree lies in a workspace that is made beforehand. The iterations of a solution are nodes looked at and iterations of
FABRIKc together.
"""

import math
from collections import namedtuple
from dataclasses import dataclass
from typing import ClassVar

from sinuous.kernels.body.glance import deepest
from sinuous.kernels.chain.arc import pose
from sinuous.kernels.chain.kinematics import compose, forward, frame, put_frame
from sinuous.kernels.clock import SEGMENT_LOOKS, over, spend
from sinuous.kernels.compile import kernel
from sinuous.kernels.fields.distances import price
from sinuous.kernels.maths import heap
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import ZERO, Array, Vec, get_vec, put_vec, sub, vec_mat
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.limits import bend_cap
from sinuous.kernels.tables import ARC, MAX_LENGTH, MIN_LENGTH
from sinuous.methods.capabilities import Capabilities
from sinuous.methods.fabrik.links import axis_of, end_goal, fold
from sinuous.methods.fabrik.reaching import Aside, carve, descend, scratch_size
from sinuous.methods.judge import Answer, Check, has_obstacles, offer
from sinuous.methods.options import Options, count, number
from sinuous.methods.search import NO_START, Start, own_number, search_by
from sinuous.methods.slinki.lattice import PER_NODE, Tree, carve_tree, outlook, primitive, single

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


@kernel
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


@kernel
def lay_up(tree: Tree, node: int, frames: Array, q: Array) -> None:
    """Write the segments that lead to a node to `q` (n, 3), and their `frames` (n + 1, 12)."""
    while tree.depth[node] > 0:
        k = tree.depth[node] - 1
        rotation, position = frame(tree.frames, node)
        put_frame(frames, k + 1, rotation, position)
        put_vec(q, k, 0, get_vec(tree.q, node, 0))
        node = tree.parent[node]


@kernel
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


@kernel
def expand(
    problem: Problem,
    check: Check,
    scratch: Search,
    node: int,
    size: int,
    open_nodes: int,
    goal: Goal,
    growth: Growth,
) -> tuple[int, int]:
    """Give a node its children, as far as there is room and time; returns how many nodes there are, how many open."""
    tree = scratch.tree
    k = tree.depth[node]
    rotation, position = frame(tree.frames, node)
    number, looks = 0, SEGMENT_LOOKS + LOOKS * price(problem.scene)
    while size < tree.parent.shape[0] and not spend(check.clock, looks):
        q, there = primitive(problem.limits, k, number, growth.bends, growth.directions, growth.lengths)
        if not there:
            break
        number += 1
        turn, shift = pose(q[0], q[1], q[2])
        to, place = compose(rotation, position, turn, shift)
        put_frame(tree.frames, size, to, place)
        put_vec(tree.q, size, 0, q)
        if has_obstacles(problem) and deepest(problem, rotation, position, q, k, tree.travel[node], LOOKS)[0] < 0.0:
            continue
        tree.parent[size], tree.depth[size] = node, k + 1
        tree.travel[size] = tree.travel[node] + q[2]
        tree.effort[size] = tree.effort[node] + q[0] * q[0] + q[1] * q[1]
        ahead = outlook(problem.limits, scratch.sums, k + 1, place, axis_of(to), goal.place, goal.tangent, goal.aimed)
        cost = tree.effort[size] + growth.weight * ahead
        open_nodes = heap.push(tree.priority, tree.open, open_nodes, cost, size)
        size += 1
    return size, open_nodes


@kernel
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
    forward(work.q, check.frames)
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


@kernel
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
