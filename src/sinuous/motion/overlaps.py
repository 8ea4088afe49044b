"""Where a motion from elsewhere is seen to overlap an obstacle or itself."""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from sinuous.answer.worst import Worst, compiled_clearance
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.certificate.query import CLEARANCES, VERDICT
from sinuous.kernels.certificate.sweep import CLEARANCES_WIDTH, LEAST_SEEN, WHEN
from sinuous.model.robot import Robot
from sinuous.motion.configurations import overlap_of
from sinuous.problem.problem import ask_body
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.certificates.steps import SAMPLED, Steps

SHAPES = 9
"""Shapes, evenly spaced, at which a step that is not proved is looked at."""

MOST_STEPS = 64
"""Most steps that are looked at: those that the proof saw the deepest in something."""

OF_OBSTACLES, OF_BODY = CLEARANCES, CLEARANCES + CLEARANCES_WIDTH
"""Columns where a proof says what it saw of obstacles, and of the body itself."""


class _Sample(NamedTuple):
    """A shape on the way: how deep it is in something, its step (0 = first), and the share of that."""

    depth: float
    step: int
    share: float


def overlap_on_the_way(robot: Robot, scene: Snapshot, q: Floats, times: Floats, steps: Steps) -> Worst | None:
    """Return where a motion through knots (T, n, 3) at times (T,) is seen to overlap the deepest; `None` where nowhere.

    What is proved, or clear at samples, is not looked at. Where it overlaps itself, the deepest that the proof saw
    counts, not the deepest that there is.
    """
    found: list[Worst] = []
    for sample in _deepest(robot, scene, q, times, steps):
        i, share = sample.step, sample.share
        when = float(times[i] + share * (times[i + 1] - times[i]))
        try:
            worst = overlap_of(robot, _between(q, i, share), scene.at(when))
        except InputError:  # no equilibrium
            continue
        if worst is not None:
            found.append(replace(worst, step=i + 1, time=when))
    return max(found, key=lambda worst: worst.amount, default=None)


def _between(q: Floats, i: int, share: float) -> Floats:
    between: Floats = (1.0 - share) * q[i] + share * q[i + 1]
    return between


def _deepest(robot: Robot, scene: Snapshot, q: Floats, times: Floats, steps: Steps) -> Iterator[_Sample]:
    """Yield the shapes that are the deepest in an obstacle, and in the body itself, of steps that are not proved."""
    answers = steps.answers
    unclear = np.flatnonzero((answers[:, VERDICT] != CLEAR) & (answers[:, VERDICT] != SAMPLED))
    seen = answers[:, [OF_OBSTACLES + LEAST_SEEN, OF_BODY + LEAST_SEEN]]
    unclear = unclear[np.argsort(seen[unclear].min(axis=1), kind="stable")][:MOST_STEPS]
    itself = [
        _Sample(-float(seen[i, 1]), int(i), float(answers[i, OF_BODY + WHEN])) for i in unclear if seen[i, 1] < 0.0
    ]
    yield from (max(itself),) if itself else ()
    samples = [sample for i in unclear.tolist() for sample in _samples(robot, scene, q, times, i, answers[i])]
    yield from (max(samples),) if samples else ()


def _samples(robot: Robot, scene: Snapshot, q: Floats, times: Floats, i: int, answer: Floats) -> Iterator[_Sample]:
    """Yield shapes of a step, evenly spaced and the one that the proof saw the deepest in an obstacle."""
    if len(scene) == 0:
        return
    seen = [float(answer[OF_OBSTACLES + WHEN])] if answer[OF_OBSTACLES + LEAST_SEEN] < 0.0 else []
    for share in (*seen, *np.linspace(0.0, 1.0, SHAPES).tolist()):
        try:
            asked = ask_body(robot, _between(q, i, share), ())
        except InputError:  # no equilibrium
            continue
        there = scene.at(float(times[i] + share * (times[i + 1] - times[i])))
        yield _Sample(-compiled_clearance(asked.body, there, asked.arcs, above=True).distance, i, share)
