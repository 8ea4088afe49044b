"""What a control step is asked for, as Python writes it, and what it works on.

The group `asked` is flat: the header; a row for every segment with its rates; and a row for every actuator that has a
limit or a rate. Rates hold for the step as a whole, from the configuration that it begins with. Infinite: no limit.

A *constraint* is `weights . dq >= value`. A *bound* is a row of weights with up to four of them: least and greatest
value, and least and greatest value that is wished for. The *working set* holds the constraints that the step was found
to violate; those whose multipliers are positive are *active* (Nocedal & Wright, chapter 16).

`asked` (w,) is the group.
"""

from collections import namedtuple
from typing import Any

from sinuous.kernels.body.rows import carve_rows, pick_rows, rows_size
from sinuous.kernels.body.self_contacts import MOST_PAIRS, pair_width
from sinuous.kernels.body.self_pairs import SPAN_WIDTH
from sinuous.kernels.certificate.sweep import carve_sweep, sweep_size
from sinuous.kernels.chain.kinematics import put_base
from sinuous.kernels.maths.buffers import cut, cut_whole
from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import Array

ASKED_KIND, ASKED_TWIST, ASKED_ROUNDS, ASKED_WISH, ASKED_SECONDS, ASKED_ACTUATORS, ASKED_BOUNDS, ASKED_CONSTRAINTS = (
    0,
    1,
    7,
    8,
    9,
    10,
    11,
    12,
)
"""Places in the header: TARGETS, POSITION or POSE; the motion of the tip (6): rotation (rad) and displacement (length
unit), in world axes; most Newton steps; the clearance up to which the body is pushed away from obstacles, negative
where contacts do not matter; seconds for all; how many rows of actuators there are; and how many bounds and constraints
of the working set there is room for."""

HEADER = 13

MEET_TARGETS, MOVE_POSITION, MOVE_POSE = range(3)
"""What is asked: that targets are met, a displacement of the tip, or both its displacement and its rotation."""

BEND_CHANGE, LENGTH_CHANGE, BEND_SECOND, LENGTH_SECOND, CHANGE_BEFORE = range(5)
"""Columns of a segment's rates: largest change of the bending vector (rad) and of the length; how much these changes
may differ from those of the step before (second differences); and those (3)."""

STEP_RATES_WIDTH = 7

LOWEST, HIGHEST, LARGEST_CHANGE, SECOND_DIFFERENCE, LAST_CHANGE = range(5)
"""Columns of an actuator after the derivatives of its value (3 n): limits of its value; its largest change; how much
this change may differ from that of the step before; and that."""

ACTUATOR_COLUMNS = 5

StepRequest = namedtuple(
    "StepRequest", ["kind", "twist", "rounds", "wish", "seconds", "capacity", "rates", "actuators"]
)
"""The header by its names, `twist` (1, 6), `capacity` for bounds and constraints; rates of segments (n, 7) and
actuators (p, 3 n + 5)."""

LOW, HIGH, WISHED_LOW, WISHED_HIGH, GAP, KIND_LOW, KIND_HIGH, BOUND_SEGMENT, BOUND_OTHER, TAKEN = range(10)
"""Columns of a bound after its weights (3 n), in units of the metric: what the weighted motion must be at least and at
most, and what it is wished to be; for a contact the gap (length), for all others infinite; the kinds of the two sides;
the segment, and the obstacle, actuator or other segment; and which of the four are in the working set (bits)."""

BOUND_WIDTH = 10

CONSTRAINT_VALUE, CONSTRAINT_VARIANCE, MULTIPLIER, CONSTRAINT_KIND, CONSTRAINT_SEGMENT, CONSTRAINT_OTHER = range(6)
"""Columns of a constraint in the working set: its value, the variance that it is kept with, its multiplier, and what it
is called: kind, segment, and obstacle, actuator or other segment."""

CONSTRAINT_WIDTH = 6

(
    LENGTH_LIMIT,
    BEND_LIMIT,
    CURVATURE_LIMIT,
    ACTUATOR_LIMIT,
    CLEARANCE_LIMIT,
    SELF_CLEARANCE_LIMIT,
    LENGTH_RATE_LIMIT,
    BEND_RATE_LIMIT,
    ACTUATOR_RATE_LIMIT,
    ACCELERATION_LIMIT,
) = range(10)
"""Kinds of constraints, in the order of `StepConstraint` of `sinuous.base.arguments`; a new one comes last."""

WorkingSet = namedtuple("WorkingSet", "weights replies about system scratch active listed free pull")
"""Constraints that the step was found to violate, up to r of them: weights `c` (r, 3 n); what a multiplier of 1 moves,
`H^-1 c` (r, 3 n); `about` them (r, 6); how they move each other, `c_a . H^-1 c_b` (r, r), and scratch (r, r + 1);
which of them are active (r,) int64, and the numbers of those (r,) int64; the step without any of them, and a motion
(n, 3)."""

Control = namedtuple("Control", "q trial frames columns rows root none step bounds near pairs spans working sweep body")
"""Configurations where it is and where it may go next (n, 3), frames (n + 1, 12) and columns (n, 18) where it is; rows
of what is asked; root of the metric (n, 9), no motion (n, 3) and the step (n, 3); bounds (b, 3 n + 10); numbers of
obstacles (m,) int64; self-contacts and spans as `body.self_contacts` has them; the working set; scratch of the
proof of a motion, with the clock; and the body, `None` for a rigid one, see `velocity.body`."""


def most_bounds(segments: int, obstacles: int, actuators: int) -> int:
    """Most bounds of a control step: contacts, self-contacts, actuators."""
    return (min(obstacles, 8) * 4 * segments + 8 if obstacles else 0) + MOST_PAIRS + actuators


def most_constraints(segments: int) -> int:
    """Most constraints of the working set."""
    return min(32 + 5 * segments, 256)


def control_size(segments: int, obstacles: int, targets: int, actuators: int) -> int:
    """Numbers (float64) that `carve_control` takes from a buffer."""
    n, b, r = segments, most_bounds(segments, obstacles, actuators), most_constraints(segments)
    rows = rows_size(n, max(6, 6 * targets))
    own = 6 * n + 12 * (n + 1) + 18 * n + rows + 15 * n + b * (3 * n + BOUND_WIDTH) + obstacles
    working = r * (6 * n + CONSTRAINT_WIDTH + r + r + 1) + 2 * r + 6 * n
    return own + MOST_PAIRS * pair_width(n) + SPAN_WIDTH * (n + 1) + working + sweep_size(n, obstacles)


def read_asked(asked: Array, n: int) -> StepRequest:
    """Take the group apart, for n segments."""
    p, actuators = int(asked[ASKED_ACTUATORS]), HEADER + STEP_RATES_WIDTH * n
    return StepRequest(
        int(asked[ASKED_KIND]),
        shaped(asked[ASKED_TWIST:ASKED_ROUNDS], (1, 6)),
        int(asked[ASKED_ROUNDS]),
        asked[ASKED_WISH],
        asked[ASKED_SECONDS],
        (int(asked[ASKED_BOUNDS]), int(asked[ASKED_CONSTRAINTS])),
        shaped(asked[HEADER:actuators], (n, STEP_RATES_WIDTH)),
        shaped(asked[actuators : actuators + p * (3 * n + ACTUATOR_COLUMNS)], (p, 3 * n + ACTUATOR_COLUMNS)),
    )


def carve_control(buffer: Array, base: Array, sizes: tuple[int, int, int, int, int], body: Any) -> Control:
    """Lay out the workspace in `buffer`; `base` (1, 12). The scratch of proofs of a `body` is that of its arcs.

    `sizes`: segments, obstacles, rows of what is asked, bounds, and constraints of the working set.
    """
    n, m, capacity, b, r = sizes
    q, rest = cut(buffer, n, 3)
    trial, rest = cut(rest, n, 3)
    frames, rest = cut(rest, n + 1, 12)
    put_base(frames, base)
    columns, rest = cut(rest, n, 18)
    size = rows_size(n, capacity)
    rows, rest = pick_rows(carve_rows(rest[:size], 1, n, capacity), 0), rest[size:]
    root, rest = cut(rest, n, 9)
    none, rest = cut(rest, n, 3)
    step, rest = cut(rest, n, 3)
    bounds, rest = cut(rest, b, 3 * n + BOUND_WIDTH)
    near, rest = cut_whole(rest, m)
    pairs, rest = cut(rest, MOST_PAIRS, pair_width(n))
    spans, rest = cut(rest, n + 1, SPAN_WIDTH)
    weights, rest = cut(rest, r, 3 * n)
    replies, rest = cut(rest, r, 3 * n)
    about, rest = cut(rest, r, CONSTRAINT_WIDTH)
    system, rest = cut(rest, r, r)
    scratch, rest = cut(rest, r, r + 1)
    active, rest = cut_whole(rest, r)
    listed, rest = cut_whole(rest, r)
    free, rest = cut(rest, n, 3)
    pull, rest = cut(rest, n, 3)
    working = WorkingSet(weights, replies, about, system, scratch, active, listed, free, pull)
    sweep = carve_sweep(rest, base, n, m) if body is None else body.arcs.sweep
    return Control(q, trial, frames, columns, rows, root, none, step, bounds, near, pairs, spans, working, sweep, body)
