"""A way in time: a straight one, paced; a path past what stands still, or past all places of what moves; a tree."""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from sinuous.checks import Floats
from sinuous.motion.configurations import overlap_at
from sinuous.motion.in_time.easing import eased
from sinuous.motion.in_time.pacing import paced
from sinuous.motion.in_time.question import TimedQuestion, TimedWay
from sinuous.motion.in_time.tree import Tree
from sinuous.motion.planning.question import Question
from sinuous.motion.planning.watch import Watch
from sinuous.motion.planning.ways import find_way
from sinuous.scene.moving import Moving
from sinuous.scene.snapshot import Snapshot
from sinuous.solving.between.steps import Prover
from sinuous.solving.planning.trees import load_trees

FIRST_GOALS = 4
"""Goals to which the straight line is tried."""

PATHS = 4
"""Seeds with which paths past what stands still are looked for."""

MOMENTS = 5
"""Times at which all obstacles that move are taken for standing still, at once, and one after the other."""

SHARE = 0.1
"""Of the time that is left, what a path that is planned may take."""


def find_in_time(question: TimedQuestion) -> TimedWay | None:
    """Find a way to one of the goals, every step of which is proved clear; `None` when the time is over."""
    if question.accelerations is not None:
        return _find_eased(question)
    direct = question.goals(question.start[None])[0]
    answer = None
    if not question.early:
        answer = question.passes(question.start, direct, question.begin, question.end)
    if answer is not None:
        ends = np.stack([question.start, direct]), np.array([question.begin, question.end])
        return question.tightened(TimedWay(*ends, answer[None]))
    way = _first(question, paced)
    if way is None and question.seconds_left() > 0.0:
        way = Tree(question).grow()
    return None if way is None else question.tightened(way)


def _find_eased(question: TimedQuestion) -> TimedWay | None:
    """Find a way that keeps limits of acceleration; ways of trees, which do not, are paths to be paced."""
    way, seed = _first(question, eased), question.seed
    while way is None and question.seconds_left() > 0.0:
        grown = Tree(replace(question, seed=seed)).grow()
        if grown is not None:
            moves = np.abs(np.diff(grown.q, axis=0)).max(axis=(1, 2)) > 0.0
            way = eased(question, grown.q[np.append(True, moves)])
        seed = (seed + 1) % 2**31
    return None if way is None else question.tightened(way)


def _first(question: TimedQuestion, pace: Callable[[TimedQuestion, Floats], TimedWay | None]) -> TimedWay | None:
    """Pace one path after the other; `None` where none can be, or the time is over."""
    for path in _paths(question):
        way = pace(question, path)
        if way is not None or question.seconds_left() <= 0.0:
            return way
    return None


def standing(scene: Snapshot) -> Snapshot:
    """Return what stands still of a scene."""
    if not scene.moves:
        return scene
    return Snapshot(tuple(own for own in scene.obstacles if not isinstance(own, Moving)))


def _paths(question: TimedQuestion) -> Iterator[Floats]:
    """Yield paths of configurations (p, n, 3), without times."""
    goals = question.goals(question.start[None])
    for goal in goals[:FIRST_GOALS]:
        yield np.stack([question.start, goal])
    there = [question.scene.at(t) for t in np.linspace(question.begin, question.end, MOMENTS).tolist()]
    still, moving = standing(question.scene), sorted(question.scene.courses)
    everywhere = Snapshot((*still.obstacles, *(moment.obstacles[i] for moment in there for i in moving)))
    places = [everywhere, *there[: MOMENTS // 2 + 1], *[still] * PATHS]
    for seed, place in enumerate(places):
        path = _path(question, place, question.seed + seed)
        if path is not None and len(path) > 2:
            yield path


def _path(question: TimedQuestion, scene: Snapshot, seed: int) -> Floats | None:
    """Plan a path in a scene that stands still, where its ends are clear."""
    prover = Prover(question.robot, scene)
    goals = question.goals(question.start[None])
    ends = (question.start, goals[0])
    if any(overlap_at(question.robot, q, prover) is not None for q in ends):
        return None
    load_trees(question.robot, scene)
    watch = Watch(SHARE * question.seconds_left())
    way = find_way(Question(question.robot, scene, question.start, question.goals, seed % 2**31, 0, watch))
    return None if way is None else way.q
