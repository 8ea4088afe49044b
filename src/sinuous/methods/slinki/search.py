"""SLInKi (Chiang et al. 2021): weighted A* over motion primitives for all segments but two, FABRIKc for these.

The tree of `sinuous.methods.slinki.motion_primitives` grows until a node with two segments left costs least; FABRIKc
then reaches from there for the target. Where it does not get there, or the whole shape is not clear, the search goes
on. Of the paper only what others say of it could be had; chosen here are the primitives and what they cost, that
FABRIKc begins with the single arc, that primitives which run into an obstacle are left out, and that a tree that
found nothing is followed by others with more primitives.
"""

import math
from collections import namedtuple

from sinuous.kernels.body.glance import deepest
from sinuous.kernels.chain.arc import pose
from sinuous.kernels.chain.kinematics import compose, forward, frame, put_frame
from sinuous.kernels.clock import SEGMENT_LOOKS, over, spend
from sinuous.kernels.compile import entry, kernel
from sinuous.kernels.fields.distances import price
from sinuous.kernels.maths import heap
from sinuous.kernels.maths.vectors import ZERO, Array, Vec, get_vec, put_vec, sub, vec_mat
from sinuous.kernels.problem import Problem, read_robot
from sinuous.kernels.solve.driver import NO_START, Start, driver, own_number
from sinuous.kernels.solve.judge import Answer, Check, check_size, has_obstacles, offer
from sinuous.kernels.step.limits import bend_cap
from sinuous.kernels.tables import ARC, MAX_LENGTH, METHOD_OPTIONS, MIN_LENGTH, Budget
from sinuous.methods.fabrik.conversion import axis_of, end_goal, fold
from sinuous.methods.fabrik.search import BESIDE as REACHING_BESIDE
from sinuous.methods.fabrik.search import PER_SEGMENT as REACHING_PER_SEGMENT
from sinuous.methods.fabrik.search import carve, descend
from sinuous.methods.slinki.motion_primitives import PER_NODE, Tree, carve_tree, outlook, primitive, single

LAST = 2
"""Segments that FABRIKc reaches with."""

LEVELS = 3
"""Trees that are grown, each with more primitives than the one before."""

LOOKS = 4
"""Places of a primitive that are looked at for obstacles."""

PER_SEGMENT, BESIDE = REACHING_PER_SEGMENT + 3, REACHING_BESIDE + 3
"""Numbers (float64) that the scratch takes from a buffer without its nodes: for every segment, and beside."""

Search = namedtuple("Search", ["tree", "work", "sums"])
"""Scratch of one solve: nodes, what FABRIKc works on, and sums (n + 1, 3) of limits (see `outlook`)."""

Goal = namedtuple("Goal", ["place", "tangent", "aimed"])
"""Where the end of the backbone is wanted, its tangent there, and whether that is asked for."""

Growth = namedtuple("Growth", ["bends", "directions", "lengths", "weight"])
"""Primitives of a segment, as bends, directions and lengths; and the weight of what a node may still cost."""


def workspace_size(segments: int, obstacles: int, nodes: int) -> int:
    """Numbers (float64) that a search needs as workspace."""
    return check_size(segments, obstacles) + PER_SEGMENT * segments + BESIDE + PER_NODE * nodes


@kernel
def carve_search(buffer: Array, limits: Array, nodes: int) -> Search:
    """Lay out the scratch in the beginning of `buffer` (w,), for a robot with these `limits` (n, 7)."""
    n = limits.shape[0]
    sums = buffer[: 3 * n + 3].reshape((n + 1, 3))
    put_vec(sums, n, 0, ZERO)
    for j in range(n):
        k = n - 1 - j
        sums[k, 0] = sums[k + 1, 0] + limits[k, MIN_LENGTH]
        sums[k, 1] = sums[k + 1, 1] + limits[k, MAX_LENGTH]
        sums[k, 2] = sums[k + 1, 2] + bend_cap(limits, k, limits[k, MAX_LENGTH])
    work = carve(buffer[3 * n + 3 :], n, min(LAST, n))
    for i in range(work.chain.bends.shape[0] + 1):
        work.chain.first[i] = max(0, n - LAST) + i
    for k in range(n):
        work.chain.share[k] = 1.0
    return Search(carve_tree(buffer[PER_SEGMENT * n + BESIDE :], nodes), work, sums)


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
    `follow`; every `level` has more primitives.
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
            effort += descend(problem, check, work, int(options[0]))
            if offer(problem, check, work.kept, ARC, answer):
                return looked + effort, True
        if over(check.clock):
            break
    return looked + effort, False


@kernel
def follow(
    problem: Problem, check: Check, scratch: Search, options: Array, start: Start, answer: Answer
) -> tuple[int, bool]:
    """Follow one start; see `sinuous.kernels.solve.driver`. Initial configurations are counted and passed over.

    `options` (6,): most iterations of FABRIKc from one node, most nodes, rings and directions of bends, lengths, and
    the weight of what a node may still cost. Nothing is random.
    """
    level = own_number(start)
    if level < 0:
        return 0, False
    if level >= LEVELS:
        return NO_START, False
    return grow(problem, check, scratch, options, level, answer)


drive = driver(follow)


@entry
def search(
    robot: Array,
    scene: Array,
    settings: Array,
    targets: Array,
    initial: Array,
    budget: Budget,
    workspace: Array,
    answers: Array,
) -> None:
    """Solve m problems, laid out as `driver` says; `workspace` (w,) is scratch, see `workspace_size`."""
    n, nodes = int(robot[0]), int(settings[METHOD_OPTIONS + 1])
    scratch = carve_search(workspace, read_robot(robot).limits, nodes)
    rest = workspace[PER_SEGMENT * n + BESIDE + PER_NODE * nodes :]
    drive(scratch, (robot, scene, settings), targets, initial, budget, rest, answers)
