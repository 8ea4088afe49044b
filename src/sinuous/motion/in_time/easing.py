"""How a robot paces a path under limits of acceleration: faster, slower, waiting or back, from tick to tick.

As in `pacing`, the path is cut into pieces and time into ticks, but what is reached at a tick is a place and how many
pieces the last step passed. The next step may differ from it as much as accelerations allow. How many ticks are left at
least, without obstacles, is known of all; what has the fewest is looked at first (A*). From rest a body under an even
acceleration a gets as far as a h^2 / 2 in the first tick h, so no piece is longer than that.
"""

import heapq
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.motion.in_time.pacing import cut
from sinuous.motion.in_time.question import ROUNDING, TimedQuestion, TimedWay

TICKS = 16
"""Ticks in which the path would be passed without obstacles, at most about so many."""

FASTEST = 8
"""Most pieces that are passed in a tick."""

HASTE = 1.5
"""How much more a tick that is left counts than one that is over: with 1 the first way found is the shortest."""

SHARE = 0.3
"""Of the time that is left, what one path may take."""

MOST_PIECES, MOST_TICKS = 300, 400

Reached = tuple[int, int]
"""A place of the path, and how many pieces the step there passed."""


class _Came(NamedTuple):
    """What was reached at the tick before, and what is proved (14,) of the step."""

    before: Reached
    answer: Floats | None


class _Next(NamedTuple):
    """What is looked at next: the least worth first, the later tick of equal ones (as its negative)."""

    worth: float
    later: int
    there: Reached
    before: Reached


class _Grid(NamedTuple):
    """A path in pieces: its places (N, n, 3), the ticks, and what steps may be taken.

    `fast` (N, j): whether rates allow to pass j - FASTEST pieces from a place. `smooth` (N, j, k): whether
    accelerations allow that after a step of k - FASTEST pieces to this place. `still` (N, j): whether it may come from
    rest, and `stops` (N, j): whether rest may follow a step of so many pieces to this place.
    """

    places: Floats
    ticks: Floats
    fast: NDArray[np.bool_]
    smooth: NDArray[np.bool_]
    still: NDArray[np.bool_]
    stops: NDArray[np.bool_]


def eased(question: TimedQuestion, path: Floats) -> TimedWay | None:
    """Pace a path of configurations (p, n, 3) so that every step is clear; `None` where that was not found.

    Between neighbouring steps the speed changes by no more than accelerations allow in the mean of their durations; at
    both ends, from and to rest, in half the duration of the step.
    """
    grid = _grid(question, path)
    if grid is None:
        return None
    left, last = _ticks_left(grid), len(grid.ticks) - 1
    until = (1.0 - SHARE) * question.seconds_left()
    came: dict[tuple[int, Reached], _Came] = {}
    waiting: list[_Next] = [_Next(0.0, 0, (0, 0), (0, 0))]
    while waiting and question.seconds_left() > until:
        _, later, there, before = heapq.heappop(waiting)
        k = -later
        if (k, there) in came:  # wherever it came from, the step there is the same
            continue
        answer = None
        if k > 0:
            ends = grid.places[before[0]], grid.places[there[0]]
            answer = question.clear(*ends, float(grid.ticks[k - 1]), float(grid.ticks[k]))
        came[k, there] = _Came(before, answer)
        if k > 0 and answer is None:
            continue
        if k > 0 and left[there[0], there[1] + FASTEST] == 0.0 and (question.early or k == last):
            return _way(grid, came, k, there)
        for each in _next(grid, left, k, there, question.early):
            heapq.heappush(waiting, each)
    return None


def _next(grid: _Grid, left: Floats, k: int, there: Reached, early: bool) -> Iterator[_Next]:
    """Yield what may be reached from there, at tick k, with the next step.

    To be early it is best to have few ticks left. With a duration that is given it is best to go on evenly, so that
    it neither stands long where obstacles still come nor has to make up for time.
    """
    (i, passed), last = there, len(grid.ticks) - 1
    allowed = grid.fast[i] & (grid.still[i] if k == 0 else grid.smooth[i, :, passed + FASTEST])
    even = float(left[0, FASTEST]) * (1.0 - (k + 1) / last)
    for jump in (np.flatnonzero(allowed) - FASTEST).tolist():
        ahead = float(left[i + jump, jump + FASTEST])
        if k + 1 + ahead <= last:
            worth = k + 1 + HASTE * ahead if early else last - k - 1 + HASTE * abs(ahead - even)
            yield _Next(worth, -k - 1, (i + jump, jump), there)


def _way(grid: _Grid, came: dict[tuple[int, Reached], _Came], last: int, end: Reached) -> TimedWay:
    """Go back from what was reached last, at this tick."""
    at, reached, answers = end, [end[0]], []
    for k in range(last, 0, -1):
        step = came[k, at]
        assert step.answer is not None
        answers.append(step.answer)
        at = step.before
        reached.append(at[0])
    return TimedWay(grid.places[reached[::-1]], grid.ticks[: last + 1], np.stack(answers[::-1]))


def _ticks_left(grid: _Grid) -> Floats:
    """Return how many ticks it takes at least to come to rest at the end (N, j), after steps of j - FASTEST pieces."""
    left = np.full(grid.fast.shape, np.inf)
    left[-1, grid.stops[-1]] = 0.0
    to = np.clip(np.arange(len(left))[:, None] + np.arange(-FASTEST, FASTEST + 1), 0, len(left) - 1)
    for _ in range(len(grid.ticks)):
        on = np.where(grid.fast, left[to, np.arange(len(left[0]))], np.inf)
        fewer = np.minimum(left, 1.0 + np.where(grid.smooth, np.expand_dims(on, 2), np.inf).min(axis=1))
        if np.array_equal(fewer, left):
            break
        left = fewer
    return left


def _grid(question: TimedQuestion, path: Floats) -> _Grid | None:
    """Cut a path into pieces, and time into ticks; `None` where there is no time for them."""
    moves = np.diff(path, axis=0)
    speeds, gains = question.speeds(moves), question.gains(moves)
    tick = _tick(speeds, gains, question.end - question.begin)
    window = question.end - question.begin
    counts = _counts(speeds, gains, tick)
    while counts.sum() > MOST_PIECES:
        tick *= 1.25
        counts = _counts(speeds, gains, tick)
    number = int(window / tick * (1.0 + ROUNDING))
    if number < 2:
        return None
    if not question.early:
        tick = window / number
    ticks = question.begin + tick * np.arange(min(number, MOST_TICKS) + 1.0)
    if not question.early:
        if number > MOST_TICKS:
            return None
        ticks[-1] = question.end
    return _allowed(question, cut(path, counts), ticks, tick)


def _tick(speeds: Floats, gains: Floats, window: float) -> float:
    """Return how long a tick is: some of them a path, and few until the robot is as fast as it may be."""
    tops = np.minimum(speeds, np.sqrt(gains))
    ramps = np.divide(tops, gains, out=np.zeros(len(tops)), where=np.isfinite(gains))
    longest = float((1.0 / tops).sum() + ramps.max(initial=0.0))
    return max(longest / TICKS, 2.0 * float(ramps.max(initial=0.0)) / FASTEST, window / MOST_TICKS)


def _counts(speeds: Floats, gains: Floats, tick: float) -> NDArray[np.intp]:
    """Return into how many pieces each leg is cut."""
    most = np.minimum(speeds * tick, 0.5 * gains * tick * tick)
    counts: NDArray[np.intp] = np.maximum(1, np.ceil(1.0 / most - ROUNDING)).astype(np.intp)
    return counts


def _allowed(question: TimedQuestion, places: Floats, ticks: Floats, tick: float) -> _Grid:
    """Say which steps rates and accelerations allow."""
    count, jumps = len(places), np.arange(-FASTEST, FASTEST + 1)
    to, back = np.arange(count)[:, None] + jumps, np.arange(count)[:, None] - jumps
    is_there, came = (to >= 0) & (to < count), (back >= 0) & (back < count)
    on = places[np.clip(to, 0, count - 1)] - places[:, None]
    before = places[:, None] - places[np.clip(back, 0, count - 1)]
    flat = (-1, *places.shape[1:])
    least = (1.0 - ROUNDING) / tick
    fast = is_there & (question.speeds(on.reshape(flat)) >= least).reshape(is_there.shape)
    turns = on[:, :, None] - before[:, None]
    square = least / tick
    smooth = (question.gains(turns.reshape(flat)) >= square).reshape(turns.shape[:3])
    still, stops = ((question.gains(each.reshape(flat)) >= 2.0 * square).reshape(fast.shape) for each in (on, before))
    return _Grid(places, ticks, fast, smooth & came[:, None], still & is_there, stops & came)
