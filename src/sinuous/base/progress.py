"""How far a long run is, on standard error: a bar for a person who waits, lines for a log, nothing else.

The time by which budgets are counted: that of work, as it takes in machine code.

Compiling is no work, and kernels that run as Python take a thousand times as long as they will: so budgets that were
counted on the wall would find less, the first time, than they find ever after. Kernels count work units, each worth
what it takes in machine code (`kernels.clock`). Every thread has a time of its own.
"""

import gc
import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from threading import Lock, Timer, get_ident
from time import perf_counter
from typing import Any

LONG = 10
"""Solves from which on a bar is worth showing."""

LOG_EVERY = 60.0
"""Seconds between two lines where standard error is no terminal."""

LATE = 2.0
"""Seconds from which on somebody waits, and is told of it."""


_open: "list[ProgressBar]" = []
"""Bars that are shown: a terminal has room for one."""


class ProgressBar:
    """Counts what is done, such as solves, and says what is being done.

    Parameters
    ----------
    total : int, optional
        How many there are; a bar is shown from `LONG` on. By default that is not known, as while files are read.
    logged : bool
        Whether to write a line from time to time where standard error is no terminal.
    what : str
        What is done to each.
    late : float
        Seconds after which the bar, or a line, is shown at first; what is done before that shows nothing.
    counted : str
        What is counted, in lines.

    Attributes
    ----------
    shows : bool
        Whether there is a bar: otherwise nobody sees what is said.
    """

    def __init__(
        self,
        total: int | None = None,
        logged: bool = False,
        what: str = "solving",
        late: float = 0.0,
        counted: str = "rows",
    ) -> None:
        self._total, self._done, self._counted = total, 0, counted
        self._began = time.monotonic()
        self._next_line = self._began + (late or LOG_EVERY)
        self._lock = Lock()
        self.shows = sys.stderr.isatty() and (total is None or total >= LONG)
        self._logged = logged and not sys.stderr.isatty()
        if self.shows:
            from rich.progress import BarColumn, SpinnerColumn, TextColumn, TimeRemainingColumn  # noqa: PLC0415

            texts = TextColumn("{task.description}"), TextColumn("{task.fields[count]}")
            self._bar = rich_progress(SpinnerColumn(), texts[0], BarColumn(), texts[1], TimeRemainingColumn())
            self._task = self._bar.add_task(what, total=total, count="")
            self._start = Timer(late, self._bar.start)
            self._start.daemon = True
            (self._start.start if late > 0.0 else self._bar.start)()

    def __enter__(self) -> "ProgressBar":
        if self.shows:
            _open.append(self)
        return self

    def __exit__(self, *_: object) -> None:
        if self.shows:
            _open.remove(self)
            self._start.cancel()
            if self._start.is_alive():
                self._start.join()
            self._bar.stop()

    def advance(self, count: int = 1) -> None:
        """Count so many more; from any thread."""
        if self._total is None or not (self.shows or self._logged):
            return
        with self._lock:
            self._done += count
            now = time.monotonic()
            rate = self._done / max(1e-9, now - self._began)
            told, speed = f"{self._done:,} of {self._total:,}", f", {rate:,.0f} a second" if rate >= 1.0 else ""
            if self.shows:
                self._bar.update(self._task, completed=self._done, count=f"{told}{speed}")
            elif now >= self._next_line:
                self._next_line = now + LOG_EVERY
                left = (self._total - self._done) / rate
                sys.stderr.write(f"sinuous: {told} {self._counted}{speed}, {left:,.0f} s left\n")

    def expect(self, more: int) -> None:
        """Count with so many more than was said before."""
        if self._total:
            self._total += more
            if self.shows:
                self._bar.update(self._task, total=self._total)

    def say(self, what: str, share: float | None = None) -> None:
        """Say what is being done, and which share of it, 0 to 1, is done where nothing is counted."""
        if self.shows and self._total is not None:
            self._bar.update(self._task, description=what)
        elif self.shows:
            self._bar.update(self._task, description=what, total=None if share is None else 1.0, completed=share)

    @contextmanager
    def hidden(self) -> Iterator[None]:
        """Take the bar away while something else is printed."""
        if not self.shows:
            yield
            return
        self._bar.stop()
        yield
        self._bar.start()


@contextmanager
def estimated(what: str, seconds: float) -> Iterator[Callable[[str, float | None], object]]:
    """Tell of something that takes about so many seconds, if that is long: in a bar, or in one line of a log.

    Yields what is called with the name of a part, and the share of it that is done.
    """
    if seconds >= LATE and not sys.stderr.isatty():
        sys.stderr.write(f"sinuous: {what}, about {seconds:,.0f} s\n")
    if _open:
        _open[-1].say(what)
        yield _open[-1].say
        return
    with ProgressBar(what=what, late=LATE) as bar:
        yield bar.say


def rich_progress(*columns: Any) -> Any:
    """Return a `rich` progress display on standard error that disappears in the end.

    Standard output is not redirected: results that are printed there must stay there.
    """
    from rich.console import Console  # noqa: PLC0415
    from rich.progress import Progress  # noqa: PLC0415

    console = Console(stderr=True)
    return Progress(*columns, console=console, transient=True, redirect_stdout=False, redirect_stderr=False)


WORK_UNIT = 5e-9
"""Seconds of a work unit, compiled (see `kernels.clock`)."""

PAUSE = 0.05
"""Seconds between two questions whether an interpreted call is to be abandoned."""


@dataclass(slots=True)
class _Call:
    """An interpreted call that is under way.

    Attributes
    ----------
    since : float
        When it began, by the time of work.
    end : callable
        Says whether it is to be abandoned.
    units : int
        Until now.
    asked : float
        When `end` was asked last, by `time.perf_counter`.
    """

    since: float
    end: Callable[[], bool]
    units: int = 0
    asked: float = -math.inf


class AbandonedError(BaseException):
    """Raised within an interpreted call that is to be made again in another way."""


_calls: dict[int, _Call] = {}
"""Interpreted calls that are under way, by thread: nearly always none."""

_left_out: ContextVar[float] = ContextVar("left_out", default=0.0)
"""Seconds of this thread, until now, that were no work: a solve reads it twice; a `threading.local` takes longer."""


def _call() -> _Call | None:
    """The interpreted call of this thread."""
    return _calls.get(get_ident()) if _calls else None


def work_time() -> float:
    """Seconds of work; differences count, within one thread."""
    if not _calls or (call := _call()) is None:
        return perf_counter() - _left_out.get()
    if (now := perf_counter()) > call.asked + PAUSE:
        call.asked = now
        if call.end():
            raise AbandonedError
    return call.since + WORK_UNIT * call.units


def interpreting() -> bool:
    """Say whether an interpreted call is under way in this thread."""
    return _call() is not None


def count_work(units: int) -> None:
    """Count work units of the interpreted call that is under way."""
    if (call := _call()) is not None:
        call.units += units


@contextmanager
def counting_work(end: Callable[[], bool] = lambda: False) -> Iterator[None]:
    """Let time be what work units are worth: kernels are interpreted within.

    Raises
    ------
    AbandonedError
        Where it is asked for the time after `end` has said so.
    """
    if interpreting():  # an entry that an entry calls
        yield
        return
    call = _calls[get_ident()] = _Call(work_time(), end)
    try:
        yield
    except AbandonedError:
        call.units = 0  # it is done again
        raise
    finally:
        del _calls[get_ident()]
        _left_out.set(perf_counter() - call.since - WORK_UNIT * call.units)


@contextmanager
def no_work() -> Iterator[None]:
    """Let the time stand still: something is compiled or waited for."""
    began = work_time()
    try:
        yield
    finally:
        if not interpreting():
            _left_out.set(perf_counter() - began)


@contextmanager
def gc_paused() -> Iterator[None]:
    """Do not look for garbage within: again and again going through all that was made takes a fifth of the time."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()
