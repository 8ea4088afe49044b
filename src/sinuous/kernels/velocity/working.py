"""The workspace of a tick."""

from collections import namedtuple

import numpy as np

from sinuous.kernels.between.sweep import carve_sweep, sweep_size
from sinuous.kernels.body.rows import carve_rows, pick_rows, rows_size
from sinuous.kernels.body.self_contacts import MOST_PAIRS, pair_width
from sinuous.kernels.body.self_pairs import SPAN_WIDTH
from sinuous.kernels.chain.kinematics import frame, put_frame
from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import Array

LOW, HIGH, WISHED_LOW, WISHED_HIGH, GAP, KIND_LOW, KIND_HIGH, SEGMENT, OTHER, TAKEN = range(10)
"""Columns of a bound after its weights (3 n), in units of the metric: what the weighted motion must be at least and at
most, and what it is wished to be; for a contact the gap (length), for all others infinite; what the two sides are
called; the segment, and the obstacle, actuator or other segment; and which of the four are among the rows that are
held (bits)."""

BOUND_WIDTH = 10

VALUE, SOFTNESS, FORCE, WHAT, WHERE, WHICH = range(6)
"""Columns of a row that was taken in: what its motion must be at least, the variance that it is held with, with which
force it pushes, and what it is called: kind, segment, and obstacle, actuator or other segment."""

ROW_WIDTH = 6

LENGTH, BEND, CURVATURE, ACTUATOR, CLEARANCE, SELF_CLEARANCE, LENGTH_RATE, BEND_RATE, ACTUATOR_RATE, ACCELERATION = (
    range(10)
)
"""What may bound a tick."""

Tick = namedtuple(
    "Tick",
    [
        "q",
        "trial",
        "frames",
        "columns",
        "rows",
        "root",
        "none",
        "step",
        "bounds",
        "near",
        "pairs",
        "spans",
        "held",
        "sweep",
    ],
)
"""Configurations where it is and where it may go next (n, 3), frames (n + 1, 12) and columns (n, 18) where it is; rows
of what is asked; root of the metric (n, 9), no motion (n, 3) and the step (n, 3); bounds (b, 3 n + 10); numbers of
obstacles (m,) int64; self-contacts and spans as `body.self_contacts` has them; the rows that are held, see `Held`; and
scratch of the proof of a motion, with the clock."""

Held = namedtuple("Held", ["weights", "replies", "about", "system", "scratch", "active", "pushing", "free", "pull"])
"""Rows that a step was found to leave, up to r of them: weights `c` and what each moves, `H^-1 c` (r, 3 n); `about`
them (r, 6); how they move each other (r, r), and scratch (r, r + 1); which of them push (r,) int64, and the numbers of
those (r,) int64; the step without any of them, and a motion (n, 3)."""


def most_bounds(segments: int, obstacles: int, lines: int) -> int:
    """Most bounds of a tick: contacts, self-contacts, lines."""
    return (min(obstacles, 8) * 4 * segments + 8 if obstacles else 0) + MOST_PAIRS + lines


def most_rows(segments: int) -> int:
    """Most rows that are held."""
    return min(32 + 5 * segments, 256)


def tick_size(segments: int, obstacles: int, targets: int, lines: int) -> int:
    """Numbers (float64) that `carve_tick` takes from a buffer."""
    n, b, r = segments, most_bounds(segments, obstacles, lines), most_rows(segments)
    capacity = max(6, 6 * targets)
    own = 2 * 3 * n + 12 * (n + 1) + 18 * n + 9 * n + 3 * n + 3 * n + rows_width(n, capacity)
    held = r * (6 * n + ROW_WIDTH + r + r + 1) + 2 * r + 6 * n
    return (
        own
        + b * (3 * n + BOUND_WIDTH)
        + obstacles
        + MOST_PAIRS * (1 + 3 * n)
        + SPAN_WIDTH * (n + 1)
        + held
        + (sweep_size(n, obstacles))
    )


def rows_width(segments: int, capacity: int) -> int:
    """Numbers of the rows of what is asked."""
    return segments + 1 + 28 * capacity


@kernel
def carve_tick(buffer: Array, base: Array, sizes: tuple[int, int, int, int, int]) -> Tick:
    """Lay out the workspace in `buffer`; `base` (1, 12).

    `sizes`: segments, obstacles, rows of what is asked, bounds, and rows that are held.
    """
    n, m, capacity, b, r = sizes
    a = 6 * n
    c = a + 12 * (n + 1)
    d = c + 18 * n
    e = d + rows_size(n, capacity)
    f = e + 15 * n
    g = f + b * (3 * n + BOUND_WIDTH)
    h = g + m
    i = h + MOST_PAIRS * pair_width(n)
    j = i + SPAN_WIDTH * (n + 1)
    frames = shaped(buffer[a:c], (n + 1, 12))
    rotation, position = frame(base, 0)
    put_frame(frames, 0, rotation, position)
    held, used = _carve_held(buffer[j:], n, r)
    return Tick(
        shaped(buffer[: 3 * n], (n, 3)),
        shaped(buffer[3 * n : a], (n, 3)),
        frames,
        shaped(buffer[c:d], (n, 18)),
        pick_rows(carve_rows(buffer[d:e], 1, n, capacity), 0),
        shaped(buffer[e : e + 9 * n], (n, 9)),
        shaped(buffer[e + 9 * n : e + 12 * n], (n, 3)),
        shaped(buffer[e + 12 * n : f], (n, 3)),
        shaped(buffer[f:g], (b, 3 * n + BOUND_WIDTH)),
        buffer[g:h].view(np.int64),
        shaped(buffer[h:i], (MOST_PAIRS, pair_width(n))),
        shaped(buffer[i:j], (n + 1, SPAN_WIDTH)),
        held,
        carve_sweep(buffer[j + used :], base, n, m),
    )


@kernel
def _carve_held(buffer: Array, n: int, r: int) -> tuple[Held, int]:
    a = 3 * n * r
    b = 2 * a
    c = b + ROW_WIDTH * r
    d = c + r * r
    e = d + r * (r + 1)
    f = e + r
    g = f + r
    held = Held(
        shaped(buffer[:a], (r, 3 * n)),
        shaped(buffer[a:b], (r, 3 * n)),
        shaped(buffer[b:c], (r, ROW_WIDTH)),
        shaped(buffer[c:d], (r, r)),
        shaped(buffer[d:e], (r, r + 1)),
        buffer[e:f].view(np.int64),
        buffer[f:g].view(np.int64),
        shaped(buffer[g : g + 3 * n], (n, 3)),
        shaped(buffer[g + 3 * n : g + 6 * n], (n, 3)),
    )
    return held, g + 6 * n
