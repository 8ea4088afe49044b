"""How a robot paces a given path: faster, slower, waiting or back (after Kant & Zucker 1986).

The path is cut into pieces, time into intervals. A state is a place of the path and how many pieces the step there
passed: the next step may differ from it as much as accelerations allow. How many intervals are left at least, without
obstacles, is known of all states, and the one with the fewest comes first (A*). An edge between two states is proved
clear when it is taken from the queue, so few of them are. From rest a body under an even acceleration a gets as far as
a h^2 / 2 in the first interval h, so no piece is longer than that.
"""

import heapq
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.motion.planning.query import ROUNDING, ProvedPath, TimedQuery

SHARE = 0.3
"""Share of the time left that pacing one path may take."""

MOST_INTERVALS = 400
"""Most intervals of a motion."""

EVEN_INTERVALS = 16
"""Intervals in which the path would be passed without obstacles, about so many."""

FASTEST = 8
"""Most pieces that are passed in an interval."""

HURRY = 2.0
"""How many times as quickly as evenly the path would be passed where no rates say how quickly it may be."""

HASTE = 1.5
"""How much more an interval that is left counts than one that is over: with 1, the first path found is the shortest."""

MOST_PIECES = 300
"""Pieces of a path: with more, intervals are made longer."""


class PathState(NamedTuple):
    """A place of the path, and how many pieces the step there passed."""

    place: int
    passed: int


class _Reached(NamedTuple):
    """The state an interval before, and what is proved (14,) of the step."""

    before: PathState
    answer: Floats | None


def pace_path(query: TimedQuery, path: Floats) -> ProvedPath | None:
    """Pace a path of configurations (p, n, 3) so that every step is clear; `None` where that was not found.

    Where accelerations are limited, the speed of neighbouring steps differs by no more than these allow in the mean of
    their durations; at both ends, from and to rest, in half the duration of the step.
    """
    grid = _grid_of(query, path)
    if grid is None:
        return None
    until = (1.0 - SHARE) * query.deadline.left()
    start = PathState(0, 0)
    reached: dict[tuple[int, PathState], _Reached] = {}
    blocked: set[tuple[int, int, int]] = set()
    queue: list[tuple[tuple[float, float], int, PathState, PathState]] = [((0.0, 0.0), 0, start, start)]
    while queue and query.deadline.left() > until:
        _, k, state, before = heapq.heappop(queue)
        edge, answer = (k, before.place, state.place), None
        if (k, state) in reached or edge in blocked:
            continue
        if k > 0:
            ends = grid.places[before.place], grid.places[state.place]
            answer = query.prove(*ends, float(grid.times[k - 1]), float(grid.times[k]))
            if answer is None:
                blocked.add(edge)
                continue
        reached[k, state] = _Reached(before, answer)
        if k > 0 and grid.ends(k, state):
            return _back_from(grid, reached, k, state)
        for following in grid.next(k, state):
            heapq.heappush(queue, (grid.worth(k + 1, following), k + 1, following, state))
    return None


def _back_from(
    grid: "_PathGrid", reached: dict[tuple[int, PathState], _Reached], last: int, end: PathState
) -> ProvedPath:
    """Return the path that leads to a state after `last` intervals."""
    state, places, answers = end, [end.place], []
    for k in range(last, 0, -1):
        state, answer = reached[k, state]
        assert answer is not None
        answers.append(answer)
        places.append(state.place)
    return ProvedPath(grid.places[places[::-1]], np.stack(answers[::-1]), grid.times[: last + 1])


@dataclass(frozen=True)
class _PathGrid:
    """A grid under rates and accelerations; `j` counts steps of j - FASTEST pieces.

    `limited`: whether accelerations are; else it does not matter how many pieces a step passed, which is 0 then.
    `fast` (N, j): whether rates allow such a step from a place. `smooth` (N, j, k): whether accelerations allow it
    after a step of k - FASTEST pieces to this place. `still` (N, j): whether it may come from rest. `left` (N, j):
    intervals until rest at the end, at least, after such a step to this place.
    """

    places: Floats
    times: Floats
    early: bool
    limited: bool
    fast: NDArray[np.bool_]
    smooth: NDArray[np.bool_]
    still: NDArray[np.bool_]
    left: Floats

    def next(self, k: int, state: PathState) -> Iterator[PathState]:
        """Yield the states that may follow, after k + 1 intervals, on one after k."""
        place, passed = state
        allowed = self.fast[place] & (self.still[place] if k == 0 else self.smooth[place, :, passed + FASTEST])
        for step in (np.flatnonzero(allowed) - FASTEST).tolist():
            if k + 1 + self.left[place + step, step + FASTEST] < len(self.times):
                yield PathState(place + step, step if self.limited else 0)

    def worth(self, k: int, state: PathState) -> tuple[float, float]:
        """Return what a state after k intervals is worth, the least first.

        To be early it is best to have few intervals left.
        With a duration that is given it is best to go on evenly, so that the robot neither stands long where obstacles
        still come nor has to make up for time.
        """
        left, last = float(self.left[state.place, state.passed + FASTEST]), len(self.times) - 1
        even = float(self.left[0, FASTEST]) * (1.0 - k / last)
        return k + HASTE * left if self.early else last - k + HASTE * abs(left - even), -k

    def ends(self, k: int, state: PathState) -> bool:
        """Whether the motion may end in a state after k intervals."""
        arrived = self.left[state.place, state.passed + FASTEST] == 0.0
        return bool(arrived and (self.early or k == len(self.times) - 1))


def _grid_of(query: TimedQuery, path: Floats) -> _PathGrid | None:
    """Cut a path into pieces that can be passed from rest in an interval; `None` where there is no time."""
    moves = np.diff(path, axis=0)
    speeds, gains = query.speeds(path[:-1], moves), query.gains(np.diff(query.counted(path), axis=0))
    window = query.end - query.begin
    if query.rates is None:
        sizes = np.abs(moves).sum(axis=(1, 2))
        speeds = HURRY * sizes.sum() / (window * np.maximum(sizes, np.finfo(float).tiny))
    tops = np.minimum(speeds, np.sqrt(gains))
    ramps = np.divide(tops, gains, out=np.zeros(len(tops)), where=np.isfinite(gains))
    ramp = float(ramps.max(initial=0.0))
    interval = max((float((1.0 / tops).sum()) + ramp) / EVEN_INTERVALS, 2.0 * ramp / FASTEST, window / MOST_INTERVALS)
    counts = _counts(speeds, gains, interval)
    while counts.sum() > MOST_PIECES:
        interval *= 1.25
        counts = _counts(speeds, gains, interval)
    number = int(window / interval * (1.0 + ROUNDING))
    if number < 2 or (number > MOST_INTERVALS and not query.early):
        return None
    if not query.early:
        interval = window / number
    return _allowed(query, cut(path, counts), _grid_times(query, interval, min(number, MOST_INTERVALS)), interval)


def _counts(speeds: Floats, gains: Floats, interval: float) -> NDArray[np.intp]:
    """Return into how many pieces each leg is cut."""
    most = np.minimum(speeds * interval, 0.5 * gains * interval * interval)
    return np.maximum(1, np.ceil(1.0 / most - ROUNDING)).astype(np.intp)


def _allowed(query: TimedQuery, places: Floats, times: Floats, interval: float) -> _PathGrid:
    """Say which steps rates and accelerations allow."""
    count, jumps = len(places), np.arange(-FASTEST, FASTEST + 1)
    to, back = np.arange(count)[:, None] + jumps, np.arange(count)[:, None] - jumps
    is_there, came = (to >= 0) & (to < count), (back >= 0) & (back < count)
    counted, last = query.counted(places), count - 1
    on = counted[np.clip(to, 0, last)] - counted[:, None]
    before = counted[:, None] - counted[np.clip(back, 0, last)]
    least, flat = (1.0 - ROUNDING) / interval, (-1, counted.shape[1])
    fast = np.zeros(is_there.shape, bool)
    begin, end = np.nonzero(is_there)[0], to[is_there]
    fast[is_there] = query.speeds(places[begin], places[end] - places[begin]) >= least
    turns = on[:, :, None] - before[:, None]
    square = least / interval
    smooth = (query.gains(turns.reshape(flat)) >= square).reshape(turns.shape[:3]) & came[:, None]
    still, stops = ((query.gains(each.reshape(flat)) >= 2.0 * square).reshape(fast.shape) for each in (on, before))
    left = _intervals_left(fast, smooth, stops & came, len(times))
    return _PathGrid(places, times, query.early, query.accelerations is not None, fast, smooth, still & is_there, left)


def _intervals_left(
    fast: NDArray[np.bool_], smooth: NDArray[np.bool_], stops: NDArray[np.bool_], intervals: int
) -> Floats:
    """Return how many intervals it takes at least to rest at the end (N, j), after steps of j - FASTEST pieces."""
    left = np.full(fast.shape, np.inf)
    left[-1, stops[-1]] = 0.0
    to = np.clip(np.arange(len(left))[:, None] + np.arange(-FASTEST, FASTEST + 1), 0, len(left) - 1)
    for _ in range(intervals):
        on = np.where(fast, left[to, np.arange(len(left[0]))], np.inf)
        fewer = np.minimum(left, 1.0 + np.where(smooth, np.expand_dims(on, 2), np.inf).min(axis=1))
        if np.array_equal(fewer, left):
            break
        left = fewer
    return left


def _grid_times(query: TimedQuery, interval: float, count: int) -> Floats:
    """Return the times (count + 1,) at which intervals begin and end; a duration that is given, they fill exactly."""
    if query.early:
        return query.begin + interval * np.arange(count + 1.0)
    times = query.begin + (query.end - query.begin) / count * np.arange(count + 1.0)
    times[-1] = query.end
    return times


def cut(path: Floats, counts: NDArray[np.intp]) -> Floats:
    """Return a path (p, n, 3) with its legs cut into so many even pieces (p - 1,): all their ends (N, n, 3)."""
    pieces = [path[:1]]
    for a, b, count in zip(path[:-1], path[1:], counts.tolist(), strict=True):
        share = (np.arange(1, count + 1) / count)[:, None, None]
        pieces.append((1.0 - share) * a + share * b)
    return np.concatenate(pieces)
