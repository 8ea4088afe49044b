"""Tensions of lines whose lengths are held: those that can only pull are slack, or as long as they are held.

With `S = G' H^-1 G` for the derivatives G of their lengths, a Newton step leaves `(S + C) T = b` for the tensions T of
taut lines (C: compliance), and for slack ones `b - S T` at most 0: a linear complementarity problem, solved by an
active set.
"""

from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.statics import layout as t

TENSION_ROUNDING = 1e-12
"""Tension, relative to the largest, and error of a length that count as none."""


def find_tensions(lines: Array, matrix: Array, wanted: Array, taut: Array, out: Array, scratch: Array) -> int:
    """Fill tensions `out` (t,), where lines are held, and which of these are `taut` (t,), 1 or 0.

    `matrix` (t, t) and `wanted` (t,) are S + C and b; `scratch` (t, t + 1). What is taut at first is where it begins.
    Returns how many pivots of the taut lines are negative.
    """
    count = lines.shape[0]
    negative = 0
    for _ in range(4 * count + 4):
        negative = solve_taut(matrix, wanted, taut, out, scratch)
        largest = 0.0
        for i in range(count):
            largest = max(largest, taut[i] * abs(out[i]))
        worst, which = -TENSION_ROUNDING * largest, -1
        for i in range(count):
            if taut[i] > 0.0 and lines[i, t.PUSHES] == 0.0 and out[i] < worst:
                worst, which = out[i], i
        if which >= 0:
            taut[which] = 0.0
            continue
        most = 0.0
        for i in range(count):
            if lines[i, t.HELD] > 0.0 and taut[i] == 0.0:
                left = wanted[i]
                for j in range(count):
                    left -= taut[j] * matrix[i, j] * out[j]
                if left > most + TENSION_ROUNDING * abs(wanted[i]):
                    most, which = left, i
        if which < 0:
            break
        taut[which] = 1.0
    for i in range(count):
        if lines[i, t.HELD] > 0.0 and (taut[i] == 0.0 or (out[i] < 0.0 and lines[i, t.PUSHES] == 0.0)):
            out[i] = 0.0
    return negative


def solve_taut(matrix: Array, wanted: Array, taut: Array, out: Array, scratch: Array) -> int:
    """Solve the equations of taut lines by elimination; return how many pivots are negative.

    As for `find_tensions`: `matrix` (t, t), `wanted` (t,), `taut` (t,), `out` (t,), `scratch` (t, t + 1).
    """
    count = wanted.shape[0]
    for i in range(count):
        for j in range(count):
            scratch[i, j] = taut[i] * taut[j] * matrix[i, j]
        scratch[i, count] = taut[i] * wanted[i]
        if taut[i] == 0.0:
            scratch[i, i] = 1.0
    negative = 0
    for i in range(count):
        pivot = scratch[i, i]
        negative += int(pivot < 0.0)
        for m in range(i + 1, count):
            factor = scratch[m, i] / pivot
            if factor != 0.0:
                for j in range(i, count + 1):
                    scratch[m, j] -= factor * scratch[i, j]
    for i in range(count - 1, -1, -1):
        total = scratch[i, count]
        for j in range(i + 1, count):
            total -= scratch[i, j] * taut[j] * out[j]
        if taut[i] > 0.0:
            out[i] = total / scratch[i, i]
    return negative
