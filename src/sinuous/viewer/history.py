"""What was decided on a page before, to be taken back and done again."""

import time as clock
from collections.abc import Hashable

from sinuous.viewer.model import Moment

TOGETHER = 1.0
"""Seconds within which changes of the same thing are one step: somebody drags it."""

MOST = 1000
"""Steps that are kept."""


class History:
    """The moments of a page before every step, and those that were taken back."""

    def __init__(self) -> None:
        self._past: list[Moment] = []
        self._taken_back: list[Moment] = []
        self._last: tuple[Hashable, float] = None, 0.0

    def note(self, key: Hashable, before: Moment) -> None:
        """Keep the moment before a change of what `key` stands for."""
        now = clock.monotonic()
        if key != self._last[0] or now - self._last[1] > TOGETHER:
            self._past = [*self._past[1 - MOST :], before]
        self._last = key, now
        self._taken_back = []

    def undo(self, now: Moment) -> Moment:
        """Return the moment before the last step; that of now where there is none."""
        return self._step(self._past, self._taken_back, now)

    def redo(self, now: Moment) -> Moment:
        """Return the moment that was taken back last; that of now where there is none."""
        return self._step(self._taken_back, self._past, now)

    def _step(self, begin: list[Moment], end: list[Moment], now: Moment) -> Moment:
        if not begin:
            return now
        end.append(now)
        self._last = None, 0.0
        return begin.pop()
