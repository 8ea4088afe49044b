"""What a tick is asked for: a motion of the tip or targets, and how far coordinates and actuators may move.

The group `asked` is flat: the header; a row of `boxes` for every segment; and `lines`, a row for every actuator that
has a limit or a rate. All that has to do with rates holds for the tick as a whole, from the configuration that it
begins with. Infinite: no limit.
"""

from collections import namedtuple

from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import Array

KIND, TWIST, ROUNDS, WISH, SECONDS, LINES, BOUNDS, ROWS = 0, 1, 7, 8, 9, 10, 11, 12
"""Places in the header: TARGETS, POSITION or POSE; the motion of the tip (6): rotation (rad) and displacement (length
unit), in world axes; most steps one after the other; the clearance up to which the body is pushed away from obstacles;
seconds for all; how many lines there are; and how many bounds and rows that are held there is room for."""

HEADER = 13

TARGETS, POSITION, POSE = range(3)
"""What is asked: that targets are met, a displacement of the tip, or both its displacement and its rotation."""

BEND_CHANGE, LENGTH_CHANGE, BEND_TURN, LENGTH_TURN, BEFORE = range(5)
"""Columns of a box: largest change of the bending vector (rad) and of the length; how much these changes may differ
from those of the tick before; and those (3)."""

BOX_WIDTH = 7

LEAST, MOST, CHANGE, TURN, LAST = range(5)
"""Columns of a line after its weights (3 n): limits of its value; its largest change; how much this change may differ
from that of the tick before; and that."""

LINE_WIDTH = 5

Asked = namedtuple("Asked", ["kind", "twist", "rounds", "wish", "seconds", "room", "boxes", "lines"])
"""The header by its names, `twist` (1, 6), `room` for bounds and rows; boxes (n, 7) and lines (p, 3 n + 5)."""


@kernel
def read_asked(asked: Array, n: int) -> Asked:
    """Take the group apart, for n segments."""
    p, lines = int(asked[LINES]), HEADER + BOX_WIDTH * n
    return Asked(
        int(asked[KIND]),
        shaped(asked[TWIST:ROUNDS], (1, 6)),
        int(asked[ROUNDS]),
        asked[WISH],
        asked[SECONDS],
        (int(asked[BOUNDS]), int(asked[ROWS])),
        shaped(asked[HEADER:lines], (n, BOX_WIDTH)),
        shaped(asked[lines : lines + p * (3 * n + LINE_WIDTH)], (p, 3 * n + LINE_WIDTH)),
    )
