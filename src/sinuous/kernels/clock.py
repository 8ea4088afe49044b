"""The monotonic clock of the operating system, readable from within a kernel."""

import sys
from typing import Any

from numba import types

from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import Array

_WINDOWS = sys.platform == "win32"
_MONOTONIC = 6 if sys.platform == "darwin" else 1

_buffer: Any = types.CPointer(types.int64)  # type: ignore[no-untyped-call]
_read: Any
if _WINDOWS:
    _read = types.ExternalFunction("QueryPerformanceCounter", types.int32(_buffer))
    _read_rate: Any = types.ExternalFunction("QueryPerformanceFrequency", types.int32(_buffer))

    @kernel
    def _seconds(buffer: Array) -> float:
        _read(buffer.ctypes)
        ticks = buffer[0]
        _read_rate(buffer.ctypes)
        return float(ticks / buffer[0])

else:
    _read = types.ExternalFunction("clock_gettime", types.int32(types.int32, _buffer))

    @kernel
    def _seconds(buffer: Array) -> float:
        _read(_MONOTONIC, buffer.ctypes)
        return float(buffer[0] + 1e-9 * buffer[1])


@kernel
def now(buffer: Array) -> float:
    """Seconds of `time.monotonic`; `buffer` (2,) int64 is scratch."""
    return _seconds(buffer)
