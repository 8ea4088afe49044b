"""A tree of configurations and times that grows forwards in time from the start (after LaValle & Kuffner 2001)."""

import math

import numpy as np

from sinuous.checks import Floats
from sinuous.motion.configurations import lever_metric
from sinuous.motion.in_time.question import TimedQuestion, TimedWay
from sinuous.robot.robot import Robot

MOST_NODES = 20_000

NEXT = 3
"""Nodes from which the way to what was drawn is tried, nearest first."""

PATIENCE = 64
"""Draws after which more goals are asked for."""


class Tree:
    """Nodes: configurations, times, where each was reached from, and what is proved of that step.

    Parameters
    ----------
    question : TimedQuestion
    """

    def __init__(self, question: TimedQuestion) -> None:
        self._question, self._rng = question, np.random.default_rng(question.seed)
        self._metric = lever_metric(question.robot)
        self._q = np.repeat(question.start[None], MOST_NODES, axis=0)
        self._times = np.full(MOST_NODES, question.begin)
        self._from = np.zeros(MOST_NODES, np.intp)
        self._answers: list[Floats | None] = [None]

    def grow(self) -> TimedWay | None:
        """Grow until a goal is reached; `None` when the time is over."""
        asked = self._question
        goals, draws = asked.goals(asked.start[None]), 0
        while asked.seconds_left() > 0.0 and len(self._answers) < MOST_NODES:
            draws += 1
            if draws % PATIENCE == 0:
                goals = asked.goals(self._q[: len(self._answers)])
            node = self._extend(self._drawn(goals))
            if node is None:
                continue
            for goal in goals:
                end = self._arrive(node, goal)
                if end is not None:
                    return self._way(end)
        return None

    def _drawn(self, goals: Floats) -> tuple[Floats, float]:
        """A configuration and a time: a goal now and then, the start's own configuration now and then."""
        asked, rng = self._question, self._rng
        when = asked.begin + (asked.end - asked.begin) * rng.random()
        kind = rng.random()
        if kind < 0.2:
            return goals[rng.integers(len(goals))], when
        if kind < 0.3:
            return self._q[rng.integers(len(self._answers))], when
        return _drawn_shape(asked.robot, asked.start, rng), when

    def _extend(self, drawn: tuple[Floats, float]) -> int | None:
        """Add a node on the way to what was drawn, from the nearest node before it; `None` where none is clear."""
        q, when = drawn
        count = len(self._answers)
        moves, waits = q - self._q[:count], when - self._times[:count]
        before = waits > 1e-9 * (self._question.end - self._question.begin)
        if not before.any():
            return None
        far = np.sqrt(np.einsum("tnk,tnk->t", moves * self._metric, moves * self._metric))
        least = self._question.least(moves)
        hurry = np.where(before, far * (1.0 + np.maximum(0.0, least / np.maximum(waits, 1e-300) - 1.0)), math.inf)
        for i in np.argsort(hurry)[:NEXT]:
            if not before[i]:
                return None
            share = min(1.0, float(waits[i] / least[i])) if least[i] > 0.0 else 1.0
            there = self._q[i] + share * moves[i]
            node = self._add(int(i), there, when)
            if node is None:
                node = self._add(int(i), self._q[i] + 0.5 * share * moves[i], 0.5 * (when + self._times[i]))
            if node is not None:
                return node
        return None

    def _add(self, before: int, q: Floats, when: float) -> int | None:
        node = len(self._answers)
        answer = self._question.passes(self._q[before], q, self._times[before], when)
        if answer is None or node >= MOST_NODES:
            return None
        self._q[node], self._times[node], self._from[node] = q, when, before
        self._answers.append(answer)
        return node

    def _arrive(self, node: int, goal: Floats) -> int | None:
        """Go from a node to a goal, at the end of the time or as early as rates allow."""
        asked = self._question
        least = float(asked.least((goal - self._q[node])[None])[0]) * (1.0 + 1e-9)
        left = asked.end - self._times[node]
        if least > left or left <= 0.0:
            return None
        tries = [left] if not asked.early else [min(left, share * max(least, 1e-3 * left)) for share in (1.0, 2.0)]
        for duration in tries:
            end = self._add(node, goal, float(self._times[node] + duration))
            if end is not None:
                return end
        return None

    def _way(self, end: int) -> TimedWay:
        nodes = [end]
        while nodes[-1] != 0:
            nodes.append(int(self._from[nodes[-1]]))
        nodes.reverse()
        answers = [answer for answer in (self._answers[i] for i in nodes[1:]) if answer is not None]
        return TimedWay(self._q[nodes], self._times[nodes], np.stack(answers))


def _drawn_shape(robot: Robot, start: Floats, rng: np.random.Generator) -> Floats:
    """A random configuration (n, 3) within all limits; `start` is within them."""
    rows = []
    for segment, curvature in zip(robot.segments, robot.curvatures, strict=True):
        length = rng.uniform(*segment.length)
        most = min(segment.max_bend, 2.0 * math.pi, curvature * length if length > 0.0 else 0.0)
        bend, angle = most * math.sqrt(rng.random()), rng.uniform(0.0, 2.0 * math.pi)
        rows.append([bend * math.cos(angle), bend * math.sin(angle), length])
    drawn = np.array(rows)
    share = 1.0
    while share > 1e-2 and robot.violations(start + share * (drawn - start)):
        share *= 0.7
    shape: Floats = start + (share if share > 1e-2 else 0.0) * (drawn - start)
    return shape
