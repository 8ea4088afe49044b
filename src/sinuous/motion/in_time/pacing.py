"""How a robot paces a path that is given: on, waiting, or back, from tick to tick (after Kant & Zucker 1986).

The path is cut into pieces, time into ticks. From each place that is reached at a tick some others are, at the next.
Whether the step there is clear is proved where it is asked for, layer by layer; of the ways to one place the shortest
is kept.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.motion.in_time.question import ROUNDING, TimedQuestion, TimedWay

PIECES, TICKS = 16, 24
"""Pieces of a path; and ticks of a motion whose duration is given, where no rates say how many there may be."""

MOST_TICKS = 400

AT_ONCE = 3
"""Pieces that are passed in a tick, at most, where no rates say it."""


class _Came(NamedTuple):
    """How a place was reached: from which at the tick before, how far it went so far, and what is proved (14,)."""

    before: int
    far: int
    answer: Floats | None


def paced(question: TimedQuestion, path: Floats) -> TimedWay | None:
    """Pace a path of configurations (p, n, 3) so that every step is clear; `None` where that was not found."""
    places = _evenly_cut(question, path)
    most, ticks = _ticks(question, places)
    if ticks is None:
        return None
    last = len(places) - 1
    layers = [{0: _Came(0, 0, None)}]
    for k in range(1, len(ticks)):
        if question.seconds_left() <= 0.0:
            return None
        layers.append(_layer(question, places, layers[-1], (ticks[k - 1], ticks[k]), most, len(ticks) - 1 - k))
        if not layers[-1]:
            return None
        if question.early and last in layers[-1]:
            break
    return _way(places, ticks, layers) if last in layers[-1] else None


def _layer(
    question: TimedQuestion,
    places: Floats,
    before: dict[int, _Came],
    when: tuple[float, float],
    most: int,
    left: int,
) -> dict[int, _Came]:
    """Places that are reached at the next tick, when so many are left after it."""
    reached: dict[int, _Came] = {}
    last = len(places) - 1
    for i, came in sorted(before.items(), key=lambda each: each[1].far):
        for j in range(max(0, i - most), min(last, i + most) + 1):
            if j in reached or last - j > most * left:
                continue
            answer = question.clear(places[i], places[j], *when)
            if answer is not None:
                reached[j] = _Came(i, came.far + abs(j - i), answer)
    return reached


def _evenly_cut(question: TimedQuestion, path: Floats) -> Floats:
    """Cut a path into pieces, each on one straight leg, that take about as long or, without rates, are as far."""
    moves = np.diff(path, axis=0)
    sizes = question.least(moves)
    if not (sizes > 0.0).all():
        sizes = np.abs(moves).sum(axis=(1, 2))
    counts = np.maximum(1, np.ceil(PIECES * sizes / max(float(sizes.sum()), 1e-300) - 1e-9)).astype(np.intp)
    return cut(path, counts)


def cut(path: Floats, counts: NDArray[np.intp]) -> Floats:
    """Return a path (p, n, 3) with its legs cut into so many even pieces (p - 1,): all their ends (N, n, 3)."""
    pieces = [path[:1]]
    for a, b, count in zip(path[:-1], path[1:], counts.tolist(), strict=True):
        share = (np.arange(1, count + 1) / count)[:, None, None]
        pieces.append((1.0 - share) * a + share * b)
    return np.concatenate(pieces)


def _ticks(question: TimedQuestion, places: Floats) -> tuple[int, Floats | None]:
    """How many pieces may be passed in a tick, and the ticks; `None` where there is no time for all pieces."""
    window = question.end - question.begin
    if question.rates is None:
        even: Floats = np.linspace(question.begin, question.end, TICKS + 1, dtype=np.float64)
        return max(AT_ONCE, -(-len(places) // (TICKS // 3))), even
    longest = float(question.least(np.diff(places, axis=0)).max()) * (1.0 + ROUNDING)
    longest = max(longest, window / MOST_TICKS)
    count = int(window / longest * (1.0 + ROUNDING))
    if count < len(places) - 1:
        return 1, None
    ticks = question.begin + (longest if question.early else window / count) * np.arange(count + 1.0)
    if not question.early:
        ticks[-1] = question.end
    return 1, ticks


def _way(places: Floats, ticks: Floats, layers: list[dict[int, _Came]]) -> TimedWay:
    """Go back from the last place of the path at the last tick."""
    at, reached, answers = len(places) - 1, [len(places) - 1], []
    for layer in layers[:0:-1]:
        came = layer[at]
        assert came.answer is not None
        answers.append(came.answer)
        at = came.before
        reached.append(at)
    return TimedWay(places[reached[::-1]], ticks[: len(reached)], np.stack(answers[::-1]))
