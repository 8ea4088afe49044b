"""The planners in the order in which they are tried: among obstacles that stand still, and among some that move."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.certificate.query import VERDICT
from sinuous.motion.configurations import overlap_at
from sinuous.motion.planning.local_planner import QueryEnds
from sinuous.motion.planning.path_pacing import pace_path
from sinuous.motion.planning.query import Deadline, ProvedPath, Query, TimedQuery
from sinuous.motion.planning.retraction import retraction
from sinuous.motion.planning.rrt_connect import RRTConnect, load_trees, rrt_connect
from sinuous.motion.planning.timed_tree import grow_timed_tree
from sinuous.scene.moving import Moving
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.certificates.steps import LOOSE_SECONDS, SLACK, Prover

STRAIGHT_GOALS = 4
"""Goals to which straight lines are paced."""

SEEDS = 4
"""Seeds with which paths past obstacles that stand still are planned, to be paced."""

MOMENTS = 5
"""Times at which all obstacles that move are taken for standing still: all times at once, and one after the other."""

SHARE = 0.1
"""Share of the time left that planning a path to be paced may take."""


TURNS, SHARE_OF_TREES = 3, 0.5
"""Turns, and the share of the time left, of planners that do not know limits of tensions, where there are any."""


def find_path(query: Query, trees: RRTConnect | None = None, turns: int | None = None) -> ProvedPath | None:
    """Let the planners take turns; `None` when the time is over, or none has anything left to try.

    Under load only a tree grows, whose edges are proved one by one. So it does, after a while, where tensions are
    limited: the others do not know these.

    Each planner yields a path, or `None` where the other one may go on. `trees`: memory of this robot and scene, to
    grow the first trees in. `turns`: most turns of each; by default as many as the time allows.
    """
    if query.robot.has_external_load:
        return _by_proofs(query)
    if query.robot.limit_set.tension_rows is not None and turns is None:
        first = replace(query, deadline=Deadline(SHARE_OF_TREES * query.deadline.left()))
        path = find_path(first, trees, TURNS)
        return path if path is not None and (path.answers[:, VERDICT] == CLEAR).all() else _by_proofs(query)
    ends, taken = QueryEnds(query), 0
    planners = [rrt_connect(query, ends, trees or RRTConnect(query.robot, query.scene)), retraction(query, ends)]
    while planners and taken != turns:
        taken += 1
        for planner in tuple(planners):
            if query.deadline.left() <= 0.0:
                return None
            try:
                path = next(planner)
            except StopIteration:
                planners.remove(planner)
                continue
            if path is not None:
                return path
    return None


def _by_proofs(query: Query) -> ProvedPath | None:
    """Find a path by a tree whose edges the prover itself proves; it grows in a time that is made up."""
    timed = query.in_time(Prover(query.robot, query.scene), 0.0, 1.0)
    path = _straight(timed) or grow_timed_tree(timed)
    return None if path is None else join_edges(timed, path)._replace(times=None)


def find_timed_path(query: TimedQuery) -> ProvedPath | None:
    """Find a path in time to one of the goals; `None` when the time is over.

    The straight line is tried at even speed; then straight lines and paths past what stands still are paced; then a
    tree grows in time. Edges of that tree do not keep limits of acceleration: under these, its branch is paced again.
    """
    path = None
    if not query.early and query.accelerations is None:
        path = _straight(query)
    if path is None:
        path = _paced(query)
    if path is None:
        path = _grown(query)
    return None if path is None else join_edges(query, path)


def standing(scene: Snapshot) -> Snapshot:
    """Return what stands still of a scene."""
    if not scene.moves:
        return scene
    return Snapshot(tuple(own for own in scene.obstacles if not isinstance(own, Moving)))


def _straight(query: TimedQuery) -> ProvedPath | None:
    goal = query.goals(query.start[None])[0]
    answer = query.prove_in_time(query.start, goal, query.begin, query.end)
    if answer is None:
        return None
    return ProvedPath(np.stack([query.start, goal]), answer[None], np.array([query.begin, query.end]))


def _paced(query: TimedQuery) -> ProvedPath | None:
    """Pace one path after the other; `None` where none can be, or the time is over."""
    for q in _untimed_paths(query):
        path = pace_path(query, q)
        if path is not None or query.deadline.left() <= 0.0:
            return path
    return None


def _untimed_paths(query: TimedQuery) -> Iterator[Floats]:
    """Yield configurations (p, n, 3) of paths without times."""
    goals = query.goals(query.start[None])
    for goal in goals[:STRAIGHT_GOALS]:
        yield np.stack([query.start, goal])
    there = [query.scene.at(t) for t in np.linspace(query.begin, query.end, MOMENTS).tolist()]
    still, moving = standing(query.scene), sorted(query.scene.courses)
    everywhere = Snapshot((*still.obstacles, *(moment.obstacles[i] for moment in there for i in moving)))
    scenes = [everywhere, *there[: MOMENTS // 2 + 1], *[still] * SEEDS]
    for seed, scene in enumerate(scenes):
        q = _untimed_path(query, scene, query.seed + seed)
        if q is not None and len(q) > 2:
            yield q


def _untimed_path(query: TimedQuery, scene: Snapshot, seed: int) -> Floats | None:
    """Plan a path in a scene that stands still, where its ends are clear there."""
    prover = Prover(query.robot, scene)
    ends = query.start, query.goals(query.start[None])[0]
    if any(overlap_at(query.robot, q, prover) is not None for q in ends):
        return None
    load_trees(query.robot, scene)
    deadline = Deadline(SHARE * query.deadline.left())
    path = find_path(Query(query.robot, scene, query.start, query.goals, seed % 2**31, deadline))
    return None if path is None else path.q


def _grown(query: TimedQuery) -> ProvedPath | None:
    """Grow a tree in time; under limits of acceleration, pace its branches, with one seed after the other."""
    seed, path = query.seed, None
    while path is None and query.deadline.left() > 0.0:
        path = grow_timed_tree(replace(query, seed=seed))
        if query.accelerations is None:
            return path
        if path is not None:
            moves = np.abs(np.diff(path.q, axis=0)).max(axis=(1, 2)) > 0.0
            path = pace_path(query, path.q[np.append(True, moves)])
        seed = (seed + 1) % 2**31
    return path


def join_edges(query: TimedQuery, path: ProvedPath) -> ProvedPath:
    """Join edges where the joined one is clear, and bound the clearances of what is left as tightly as is usual.

    Where accelerations are limited no edges are joined: the speed would change more in the corners that are left.
    """
    assert path.times is not None
    when = path.times.tolist()
    kept, answers = [0], []
    last = len(path.q) - 1
    while kept[-1] < last:
        at = kept[-1]
        far = last - at if query.accelerations is None else 1
        joined = None
        while far > 1 and joined is None:
            if query.deadline.left() > 0.0:
                joined = query.prove_in_time(path.q[at], path.q[at + far], when[at], when[at + far])
            far = far if joined is not None else far // 2
        answer = path.answers[at] if joined is None else joined
        kept.append(at + max(1, far))
        tight = query.prover.prove(path.q[[at, kept[-1]]], SLACK, LOOSE_SECONDS, path.times[[at, kept[-1]]])
        answers.append(tight[0] if tight[0, VERDICT] == CLEAR else answer)
    return ProvedPath(path.q[kept], np.stack(answers), path.times[kept])
