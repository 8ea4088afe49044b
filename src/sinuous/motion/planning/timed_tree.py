"""A tree of configurations and times that grows forwards in time from the start (after LaValle & Kuffner 2001)."""

import math

import numpy as np

from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.motion.configurations import random_configuration
from sinuous.motion.planning.query import ROUNDING, ProvedPath, TimedQuery
from sinuous.motion.planning.tree import Tree

MOST_NODES = 20_000

NEXT = 3
"""Nodes from which an edge to a draw is tried, nearest first."""

PATIENCE = 64
"""Draws after which more goals are looked for."""

SHRINK, LEAST = 0.7, 1e-2
"""Factor by which a draw is moved towards the start while it violates a limit, and the least share that is tried."""

OF_GOALS, OF_NODES = 0.2, 0.3
"""Below the first share of draws, a goal is drawn; below the second, the configuration of a node, to wait there."""


def grow_timed_tree(query: TimedQuery) -> ProvedPath | None:
    """Grow a tree in time until a goal is reached; `None` when the time is over."""
    tree, rng = Tree(query.robot), np.random.default_rng(query.seed)
    tree.add(query.start, time=query.begin)
    goals, draws = query.goals(query.start[None]), 0
    while query.deadline.left() > 0.0 and len(tree) < MOST_NODES:
        draws += 1
        if draws % PATIENCE == 0:
            goals = query.goals(tree.q)
        node = _extend_tree(query, tree, *_draw_state(query, tree, goals, rng))
        if node is None:
            continue
        for goal in goals:
            end = _arrive_at(query, tree, node, goal)
            if end is not None:
                return _path_to(tree, end)
    return None


def _draw_state(query: TimedQuery, tree: Tree, goals: Floats, rng: np.random.Generator) -> tuple[Floats, float]:
    """Draw a configuration (n, 3) and a time."""
    when = query.begin + (query.end - query.begin) * rng.random()
    kind = rng.random()
    if kind < OF_GOALS:
        return goals[rng.integers(len(goals))], when
    if kind < OF_NODES:
        return tree.q[rng.integers(len(tree))].copy(), when
    return _draw_configuration(query.robot, query.start, rng), when


def _extend_tree(query: TimedQuery, tree: Tree, q: Floats, when: float) -> int | None:
    """Add a node towards what was drawn, from the nearest node before it in time; `None` where no edge is clear.

    Far are also nodes from where the way takes longer than the rates allow until then.
    """
    moves, waits = q - tree.q, when - tree.times
    before = waits > 1e-9 * (query.end - query.begin)
    if not before.any():
        return None
    least = query.least(tree.q, moves)
    late = np.maximum(0.0, least / np.maximum(waits, 1e-300) - 1.0)
    far = np.where(before, tree.distances(q) * (1.0 + late), math.inf)
    for node in np.argsort(far)[:NEXT].tolist():
        if not before[node]:
            return None
        share = min(1.0, float(waits[node] / least[node])) if least[node] > 0.0 else 1.0
        for part in (1.0, 0.5):
            end = tree.q[node] + part * share * moves[node]
            new = _add_node(query, tree, node, end, float(when - (1.0 - part) * waits[node]))
            if new is not None:
                return new
    return None


def _arrive_at(query: TimedQuery, tree: Tree, node: int, goal: Floats) -> int | None:
    """Add an edge from a node to a goal (n, 3), at the end of the time or as early as rates allow."""
    begin = float(tree.times[node])
    least = float(query.least(tree.q[node], (goal - tree.q[node])[None])[0]) * (1.0 + ROUNDING)
    left = query.end - begin
    if least > left or left <= 0.0:
        return None
    tries = [left] if not query.early else [min(left, share * max(least, 1e-3 * left)) for share in (1.0, 2.0)]
    for duration in tries:
        end = _add_node(query, tree, node, goal, begin + duration)
        if end is not None:
            return end
    return None


def _add_node(query: TimedQuery, tree: Tree, node: int, q: Floats, when: float) -> int | None:
    """Add an edge from a node where it is quick enough and proved clear."""
    proof = query.prove_in_time(tree.q[node], q, float(tree.times[node]), when)
    if proof is None or len(tree) >= MOST_NODES:
        return None
    return tree.add(q, node, when, proof)


def _path_to(tree: Tree, end: int) -> ProvedPath:
    nodes = tree.branch(end)
    answers = [proof for proof in (tree.proofs[node] for node in nodes[1:]) if proof is not None]
    return ProvedPath(tree.q[nodes], np.stack(answers), tree.times[nodes])


def _draw_configuration(robot: Robot, start: Floats, rng: np.random.Generator) -> Floats:
    """Draw a configuration (n, 3) within all limits, also those of actuators; `start` is within them."""
    move, share = random_configuration(robot, rng) - start, 1.0
    while robot.violations(start + share * move):
        share *= SHRINK
        if share < LEAST:
            return start
    return start + share * move
