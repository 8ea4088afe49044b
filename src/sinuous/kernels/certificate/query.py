"""What Python asks about motions: whether a path of knots is clear all the way."""

from sinuous.kernels.body.proof import UNDECIDED
from sinuous.kernels.certificate.obstacles import Accuracy, measure_balls
from sinuous.kernels.certificate.proof import certify, certify_from
from sinuous.kernels.certificate.sweep import CLEARANCES_WIDTH, Motion, carve_sweep
from sinuous.kernels.clock import allow_work, begin_for, late, work_left
from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import read_scene
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.problem import read_robot

VERDICT, UNTIL, CLEARANCES = 0, 1, 2
"""Columns of an answer: the verdict, until when everything is proved clear (0 to 1), and what was seen of obstacles (6)
and of the body itself (6)."""

ANSWER_WIDTH = CLEARANCES + 2 * CLEARANCES_WIDTH


MotionTerms = tuple[float, float, float, float, float]
"""Length of backbone that obstacles do not concern; how far below the truth clearances may be, as a share of them (1:
it is enough that they are greater than 0); the length below which nothing is halved; seconds; and work units, which
count instead of these where there are any."""


@entry
def certify_motions(
    robot: Array,
    scene: Array,
    knots: Array,
    known: Array,
    drifts: Array,
    terms: MotionTerms,
    workspace: Array,
    answers: Array,
) -> float:
    """Prove the motions linear in q between neighbouring `knots` (T, n, 3), one after the other.

    `known` (T, 2): proved clearances of the knots from obstacles and from the body itself, infinite where there is
    nothing to be clear of; 0: not known. `drifts` (T - 1, c, 31): how obstacles move in each of them, see `drift`;
    where c is not 0, the rows of these in the scene are written. Fills `answers` (T - 1, 14). What is not proved when
    the time is over is UNDECIDED. Returns the work units that are left.
    """
    own, around = read_robot(robot), read_scene(scene)
    mount, slack, finest, seconds, units = terms
    sweep = carve_sweep(workspace, own.base, own.limits.shape[0], around.table.shape[0])
    begin_for(sweep.clock, seconds)
    if units > 0.0:
        allow_work(sweep.clock, units)
    accuracy = Accuracy(slack, finest, 0.0, mount, False)
    for i in range(knots.shape[0] - 1):
        seen, _ = cut(answers[i, CLEARANCES:], 2, CLEARANCES_WIDTH)
        motion = Motion(own.limits, knots[i], knots[i + 1], around, own.avoids_itself, drifts[i])
        if i == 0:
            measure_balls(motion, sweep)
        clear, apart = min(known[i, 0], known[i + 1, 0]), min(known[i, 1], known[i + 1, 1])
        if clear > 0.0 and apart > 0.0:
            verdict, until = certify_from(motion, sweep, accuracy, seen, clear, apart)
        else:
            verdict, until = certify(motion, sweep, accuracy, seen)
        answers[i, VERDICT], answers[i, UNTIL] = verdict, until
        if late(sweep.clock):
            answers[i:, VERDICT] = UNDECIDED
            answers[i + 1 :, UNTIL] = 0.0
            break
    return work_left(sweep.clock)
