"""The clock of a computation: when it has to end, and whether somebody wants to interrupt it.

A clock is an array (`CLOCK_SIZE`,) int64 in the workspace. Who computes `begin`s it, `allow`s some seconds, and then
`spend`s evaluations: one for the distance to a sphere, some 5 ns, and for dearer work in proportion. Every `STRIDE`
evaluations the time is read, which costs some 30 ns. Once it is over, every `spend` says so, until more is allowed: a
loop may end, and the loop around it ends with its next `spend`. What must not depend on how busy the machine is is
allowed work units instead (`allow_work`).

Compiled code does not see signals. So whoever reads the time also listens for them, every `LISTENING` nanoseconds, as
the manual of Python wants it: it takes the interpreter's lock and calls `PyErr_CheckSignals`. Handlers run only in the
main thread; that of `Ctrl-C` raises `KeyboardInterrupt`. Other threads are stopped by an exception that somebody raises
in them (`PyThreadState_SetAsyncExc`): Python tells of it when it runs any statement, so one is run that does nothing.
Then all time is over, and an exception of the same type is raised as soon as the compiled code is back in Python.

Where kernels are interpreted the time is that of work: an evaluation is worth what it takes in machine code
(`work_time`).
"""

import sys
from typing import Any

from numba import types

from sinuous.base.progress import WORK_UNIT, count_work, work_time
from sinuous.kernels.compile import interpreted_as, shared
from sinuous.kernels.maths.vectors import Array

_READ, _REST, DEADLINE, WORK, _LISTENED, STOPPED, _RAISED = range(7)
"""Places in a clock: two that the operating system fills; when all has to end (ns), or, negative, the work units that
are left; evaluations since the time was read; when somebody listened last (ns); whether an exception was raised then;
and scratch for that (3)."""

CLOCK_SIZE = _RAISED + 3

STRIDE = 1024
"""Work units after which the time is read: some 5 us."""

SEGMENT_WORK = 16
"""What a step costs for every segment."""

TREE_WORK = 16
"""What the distance to a mesh, a cloud or a grid costs: between six evaluations, sampled, and some hundred, exact."""

LISTENING = 50_000_000
"""Nanoseconds between two times that signals are listened for."""

PASS, AS_FILE = int.from_bytes(b"pass", "little"), 257
"""The statement that does nothing, as the letters of a word in memory; and how Python reads it (`Py_file_input`)."""

LONGEST = 1e9
"""Most seconds that are allowed: thirty years, in nanoseconds still far from the largest number."""

_WINDOWS = sys.platform == "win32"
_MONOTONIC = 6 if sys.platform == "darwin" else 1

_buffer: Any = types.CPointer(types.int64)  # type: ignore[no-untyped-call]
_read: Any
if _WINDOWS:
    _read = types.ExternalFunction("QueryPerformanceCounter", types.int32(_buffer))
    _read_rate: Any = types.ExternalFunction("QueryPerformanceFrequency", types.int32(_buffer))

    def _nanoseconds(clock: Array) -> int:
        _read(clock.ctypes)
        ticks = clock[_READ]
        _read_rate(clock.ctypes)
        return int(1e9 * (ticks / clock[_READ]))

else:
    _read = types.ExternalFunction("clock_gettime", types.int32(types.int32, _buffer))

    def _nanoseconds(clock: Array) -> int:
        _read(_MONOTONIC, clock.ctypes)
        return 1_000_000_000 * clock[_READ] + clock[_REST]


_take_lock: Any = types.ExternalFunction("PyGILState_Ensure", types.int32())
_give_lock: Any = types.ExternalFunction("PyGILState_Release", types.void(types.int32))
_run_handlers: Any = types.ExternalFunction("PyErr_CheckSignals", types.int32())
_globals: Any = types.ExternalFunction("PyEval_GetGlobals", types.int64())
_run: Any = types.ExternalFunction(
    "PyRun_StringFlags", types.int64(_buffer, types.int32, types.int64, types.int64, types.int64)
)
_fetch: Any = types.ExternalFunction("PyErr_Fetch", types.void(_buffer, _buffer, _buffer))
_forget: Any = types.ExternalFunction("Py_DecRef", types.void(types.int64))
_own_thread: Any = types.ExternalFunction("PyThread_get_thread_ident", types.uintp())
_raise_later: Any = types.ExternalFunction("PyThreadState_SetAsyncExc", types.int32(types.uintp, types.int64))


def _raised(clock: Array) -> bool:
    """Whether Python raises an exception when it runs a statement that does nothing."""
    names = _globals()
    if names == 0:  # no Python around this call
        return False
    clock[_RAISED] = PASS
    nothing = _run(clock[_RAISED:].ctypes, AS_FILE, names, names, 0)
    if nothing != 0:
        _forget(nothing)
    return bool(nothing == 0)


def _listen(clock: Array) -> None:
    """Run the handlers of signals; where one raises an exception, or another thread has raised one, time is over."""
    lock = _take_lock()
    if _run_handlers() != 0 or _raised(clock):
        clock[STOPPED] = 1
        kind, value, trace = clock[_RAISED:], clock[_RAISED + 1 :], clock[_RAISED + 2 :]
        _fetch(kind.ctypes, value.ctypes, trace.ctypes)
        _raise_later(_own_thread(), kind[0])
        _forget(kind[0])
        _forget(value[0])
        _forget(trace[0])
    _give_lock(lock)


@interpreted_as(_nanoseconds)
def _work_nanoseconds(clock: Array) -> int:
    return int(1e9 * work_time())


@interpreted_as(_listen)
def _let_python_listen(clock: Array) -> None:
    """Do nothing: Python itself hears signals."""


def now(clock: Array) -> float:
    """Seconds of `time.monotonic`; of `clock` (2 or more,) int64 the first two places are scratch."""
    return 1e-9 * _nanoseconds(clock)


def begin(clock: Array) -> None:
    """Begin a call from Python: nobody has interrupted it yet."""
    clock[_LISTENED] = _nanoseconds(clock)
    clock[STOPPED] = 0


def allow(clock: Array, seconds: float) -> float:
    """Allow so many seconds from now on; returns the time, in seconds."""
    read = _nanoseconds(clock)
    clock[DEADLINE] = max(0, read + int(1e9 * min(seconds, LONGEST)))
    clock[WORK] = 0
    return 1e-9 * read


def begin_for(clock: Array, seconds: float) -> None:
    """Begin a call from Python that is allowed so many seconds."""
    begin(clock)
    allow(clock, seconds)


def allow_work(clock: Array, units: float) -> None:
    """Allow so many work units from now on, however long they take."""
    clock[DEADLINE] = -int(max(0.0, min(units, LONGEST / WORK_UNIT)))
    clock[WORK] = 0


def work_left(clock: Array) -> float:
    """Work units that are left of those that were allowed; 0 where time is."""
    return float(max(0, -clock[DEADLINE] - clock[WORK]))


def resume(clock: Array, deadline: int) -> None:
    """Go on until a deadline that the clock had before others were allowed."""
    clock[DEADLINE] = deadline
    clock[WORK] = 0


@shared
def over(clock: Array) -> bool:
    """Read the time, and say whether it is over."""
    read = _nanoseconds(clock)
    if read - clock[_LISTENED] > LISTENING:
        clock[_LISTENED] = read
        _listen(clock)
    if clock[DEADLINE] < 0:
        clock[DEADLINE] = min(0, clock[DEADLINE] + clock[WORK])
    if clock[STOPPED] != 0 or 0 <= clock[DEADLINE] < read:
        clock[WORK] = STRIDE
        return True
    clock[WORK] = 0
    return False


def spend(clock: Array, units: int) -> bool:
    """Count evaluations, and say whether the time is over; it is read every `STRIDE` evaluations."""
    clock[WORK] += units
    return clock[WORK] >= STRIDE and over(clock)


@interpreted_as(spend)
def _spend_work(clock: Array, units: int) -> bool:
    count_work(units)
    clock[WORK] += units
    return clock[WORK] >= STRIDE and over(clock)


def late(clock: Array) -> bool:
    """Say whether the time was over when it was read last."""
    return bool(clock[WORK] >= STRIDE)
