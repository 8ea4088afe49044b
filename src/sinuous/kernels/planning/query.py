"""What Python asks of a planner: a path from a start to one of several goals.

`start` (n, 3) is the first configuration, `pair` (2, n, 3) and `scratch` (w,) are memory.
"""

from sinuous.kernels.certificate.obstacles import keep_reachable, measure_balls
from sinuous.kernels.certificate.sweep import CLEARANCES_WIDTH, Motion, carve_sweep
from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.clock import DEADLINE, allow, begin_for, resume
from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import Scene, read_scene
from sinuous.kernels.maths import buffers
from sinuous.kernels.maths.vectors import Array, copy
from sinuous.kernels.planning.shortcuts import Exactness, Path, bound_worst, forget_edges, joins, shorten, skip_knots
from sinuous.kernels.planning.space import Space
from sinuous.kernels.planning.trees import GONE, GrowthTerms, Trees, cut_off, grow, path_through, plant, prove_trees
from sinuous.kernels.problem import Robot, read_robot
from sinuous.kernels.tables import RIGID

EDGE_LENGTH, NODE_SPACING, LEAST_EDGE, FINEST_GUESS, SETBACK = 0.5, 0.25, 1e-3, 1e-2, 0.05
"""Of the trees, in robot lengths; see `GrowthTerms`."""

PATH_SLACK, EDGE_SLACK, FINEST_PROOF = 0.1, 0.5, 1e-7
"""How far below the truth the clearance of the path may be, and that of any edge, as a share of it; and the length, in
robot lengths, below which the proof of an edge of the path gives up."""

FINEST_UNKNOWN = 1e-4
"""The same length for a proof that an edge is clear which is not known to be."""

UNPROVED_DRAWS, UNPROVED_DRAWS_OF_JOINTS = 8, 32
"""Draws of trees in which edges are only examined, unless a path that was found turns out not to be clear; and of an
arm with joints, whose trees are seldom there in fewer."""

FOR_PROOF = 0.1
"""Seconds for the path that was found, its shortcuts and proofs, for each second of the search."""

PlanRequest = tuple[float, float, float, int, int, int, int]
"""Length of backbone that obstacles do not concern; the robot's mean length; seconds of the search; the seed; the first
draw, and the one after the last; how many shortcuts are tried."""


def plan_size(segments: int, nodes: int) -> int:
    """Numbers (float64) of the workspace of a plan with at most so many nodes a tree; first, the squares of levers."""
    q = 3 * segments
    return segments + 2 * CLEARANCES_WIDTH + 3 * q + 2 * nodes * (q + 1) + 2


def _carve_trees(buffer: Array, n: int) -> Trees:
    """Lay out both trees in a buffer, with as many nodes as fit."""
    nodes = (buffer.shape[0] - 3 * n - 2) // (2 * (3 * n + 1))
    q, rest = buffers.cut(buffer, 2, nodes, n, 3)
    parents, rest = buffers.cut_whole(rest, 2, nodes)
    counts, rest = buffers.cut_whole(rest, 2)
    drawn, rest = buffers.cut(rest, n, 3)
    return Trees(q, parents, counts, drawn)


def nodes_of(workspace: Array, segments: int) -> Array:
    """The nodes of the start's tree (m, n, 3) in the workspace of a plan."""
    trees = _carve_trees(workspace[7 * segments + 2 * CLEARANCES_WIDTH :], segments)
    count = trees.counts[0]
    nodes: Array = trees.q[0, :count][trees.parents[0, :count] != GONE]
    return nodes


def _join_straight(space: Space, start: Array, goals: Array, exact: Exactness, path: Path) -> int:
    """Take the straight line to the first of the goals (g, n, 3) that it is clear to: 2 configurations, or 0."""
    for i in range(goals.shape[0]):
        if joins(space, start, goals[i], exact, exact.slack, path.answers[0]):
            copy(start, path.q[0])
            copy(goals[i], path.q[1])
            return 2
    return 0


def _finish_path(
    space: Space, path: Path, count: int, asked: PlanRequest, exact: Exactness, pair: Array, sure: bool
) -> tuple[int, int]:
    """Leave out of a path what can be left out, and prove its edges with bounds.

    Returns how many knots are left, and which edge turned out not to be clear; see `skip_knots`.
    """
    _, _, seconds, seed, _, _, tries = asked
    allow(space.sweep.clock, FOR_PROOF * seconds)
    count, wrong = skip_knots(space, path, count, exact, sure)
    if tries > 0 and count > 2:
        count, _ = skip_knots(space, path, shorten(space, path, count, tries, seed, exact, pair), exact, True)
    bound_worst(space, path, count, exact)
    return count, wrong


def _grow_path(space: Space, trees: Trees, path: Path, asked: PlanRequest, exact: Exactness, pair: Array) -> int:
    """Let trees grow until there is a path between them that is clear; return how many knots it has, or 0."""
    _, unit, _, seed, at, last, _ = asked
    deadline, unproved = space.sweep.clock[DEADLINE], at == 0
    examined = UNPROVED_DRAWS if space.robot.limits[0, RIGID] == 0.0 else UNPROVED_DRAWS_OF_JOINTS
    while at < last:
        terms = GrowthTerms(
            EDGE_LENGTH * unit,
            NODE_SPACING * unit,
            LEAST_EDGE * unit,
            FINEST_GUESS * unit,
            SETBACK * unit,
            seed,
            not unproved,
        )
        one, other, at = grow(space, trees, terms, at, min(last, examined) if unproved else last)
        if one >= 0:
            count = path_through(trees, one, other, path.q)
            if count == 0:
                return 0
            forget_edges(path, count)
            count, wrong = _finish_path(space, path, count, asked, exact, pair, False)
            if wrong < 0:
                return count
            cut_off(trees, one, other, wrong)
            resume(space.sweep.clock, deadline)
        if unproved:
            prove_trees(space, trees, exact.loose)
            unproved = False
    return 0


def _prepare(
    own: Robot, around: Scene, asked: PlanRequest, scratch: Array, workspace: Array
) -> tuple[Space, Array, Array]:
    """Make the space of a robot in a scene; returns it, scratch (2, n, 3), and what is left of the workspace."""
    mount, _, seconds, _, _, _, _ = asked
    n = own.limits.shape[0]
    sweep = carve_sweep(scratch, own.base, n, around.table.shape[0])
    levers, rest = buffers.cut(workspace, n)
    seen, rest = buffers.cut(rest, 2, CLEARANCES_WIDTH)
    pair, rest = buffers.cut(rest, 2, n, 3)
    begin_for(sweep.clock, seconds)
    keep_reachable(own.limits, frame(own.base, 0)[1], around, sweep)
    measure_balls(Motion(own.limits, pair[0], pair[1], around, own.avoids_itself, sweep.still), sweep)
    return Space(own, around, mount, levers, sweep, seen), pair, rest


@entry
def plan(
    robot: Array,
    scene: Array,
    ends: Array,
    count: int,
    asked: PlanRequest,
    scratch: Array,
    workspace: Array,
    q: Array,
    answers: Array,
) -> int:
    """Fill `q` (p, n, 3) with configurations from the first of the `ends` (1 + g, n, 3) to one of the others.

    All ends are within all limits and clear. Fills `answers` (p, 14) about the motions between neighbours, linear in q,
    as `certify_motions` does. Returns how many configurations there are; 0: no path was found. When the first draw is
    not 0, the trees of the last call, which are in the same workspace, grow on, and the goals are more goals. `scratch`
    is that of a proof, see `sweep_size`; `workspace` is for some nodes a tree, see `plan_size`.

    With a `count` the first so many of `q` are a path already, all within all limits, between whose neighbours all is
    clear: of these is left out what can be left out, and the rest is proved.
    """
    own, around = read_robot(robot), read_scene(scene)
    unit, first = asked[1], asked[4]
    exact = Exactness(PATH_SLACK, EDGE_SLACK, FINEST_PROOF * unit, FINEST_GUESS * unit, FINEST_UNKNOWN * unit)
    space, pair, rest = _prepare(own, around, asked, scratch, workspace)
    trees, path = _carve_trees(rest, own.limits.shape[0]), Path(q, answers)
    if count > 0:
        forget_edges(path, count)
        return int(_finish_path(space, path, count, asked, exact, pair, True)[0])
    if first == 0:
        trees.counts[0] = trees.counts[1] = 0
        plant(trees, 0, ends[0])
    for i in range(1, ends.shape[0]):
        plant(trees, 1, ends[i])
    count = _join_straight(space, ends[0], ends[1:], exact, path)
    if count == 0:
        count = _grow_path(space, trees, path, asked, exact, pair)
    else:
        allow(space.sweep.clock, FOR_PROOF * asked[2])
        bound_worst(space, path, count, exact)
    return count
