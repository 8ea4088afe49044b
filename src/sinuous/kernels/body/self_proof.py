"""The proof that the body does not run through itself.

`self_pairs` says which places concern each other, which pairs of segments are to be examined, and bounds all others;
`self_pieces` bounds those pairs. So the proved self-clearance holds for all places, also for those never examined.
"""

import math

from sinuous.kernels.body.proof import CLEAR, TOUCHING, UNDECIDED, rounding_of
from sinuous.kernels.body.self_pairs import Meeting, Shape, next_pair, survey
from sinuous.kernels.body.self_pieces import GAP_SLACK, GapAccuracy, gap_at_rest
from sinuous.kernels.clock import late, spend
from sinuous.kernels.compile import shared
from sinuous.kernels.maths.vectors import Array

PAIR_WORK = 16
"""What it costs to examine a pair of pieces, see `kernels.clock`."""


@shared
def prove_self(shape: Shape, finest: float, clock: Array) -> tuple[int, float, Meeting]:
    """Prove that the body does not run through itself, or find where it does.

    Returns the verdict (CLEAR, TOUCHING, UNDECIDED), the self-clearance, and the closest places that were seen. With
    CLEAR the self-clearance is a lower bound of all gaps (infinite: no two places concern each other), else it is the
    least that was seen. Pieces shorter than `finest` are not halved any more; what is not proved when the time of
    the `clock` is over is UNDECIDED.
    """
    most, thickest = survey(shape)
    where = (-1, 0.0, -1, 0.0)
    if thickest == 0.0:
        return CLEAR, math.inf, where
    rounding = rounding_of(shape.limits, shape.q, shape.frames)
    # What the survey bounds needs no better bound; where it bounds nothing, a radius is enough.
    worth = most if 0.0 < most < math.inf else thickest
    accuracy = GapAccuracy(worth, worth, -math.inf, GAP_SLACK, 0.0, finest, rounding, True)
    bound, least = most, math.inf
    i, j = -1, shape.q.shape[0]
    while True:
        i, j, passed = next_pair(shape, i, j, min(worth, (1.0 - GAP_SLACK) * least), thickest)
        bound = min(bound, passed)
        if i == shape.q.shape[0]:
            break
        low, gap, places, evaluations = gap_at_rest(shape, i, j, accuracy, least)
        spend(clock, PAIR_WORK * evaluations)
        bound = min(bound, low)
        if gap < least:
            least, where = gap, places
        if least < 0.0:
            return TOUCHING, least, where
        if late(clock):
            return UNDECIDED, least, where
    if bound > rounding:
        return CLEAR, bound - rounding, where
    return UNDECIDED, min(least, most), where
