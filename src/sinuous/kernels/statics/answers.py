"""How an equilibrium moves with anything that its tables say: `dx/dp = -(dr/dx)^-1 dr/dp` (implicit function theorem).

What a parameter does to residuals and to lengths of lines is a difference of tables, with the state as it is. Most of a
table is linear in what it is made of, so that is exact but for rounding, and nearly so in the rest.
"""

from sinuous.kernels.compile import entry
from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.statics import layout as t
from sinuous.kernels.statics.newton import (
    LENGTHS,
    Body,
    Workspace,
    answer_lines,
    begin,
    evaluate_state,
    find_taut,
    hold,
)
from sinuous.kernels.statics.sweeps import solve


@entry
def answer(
    base: Array,
    arcs: Array,
    loads: Array,
    lines: Array,
    slopes: int,
    x: Array,
    tensions: Array,
    beside_arcs: Array,
    beside_loads: Array,
    beside_lines: Array,
    given: Array,
    over: Array,
    buffer: Array,
    columns: Array,
    pulls: Array,
) -> None:
    """Fill `columns` (p, N, 4) and `pulls` (p, t): how states and tensions change with p parameters.

    `x` (N, 4) and `tensions` (t,) are an equilibrium; the rest as for `equilibrium.equilibrate`, `buffer` has
    `newton.workspace_size` numbers. Tables with a little more of each parameter: `beside_arcs` (p, N, 9),
    `beside_loads` (p, k, 10) and `beside_lines` (p, t, 10), and the changes `given` (p, N, 4) of what is rigid; `over`
    (p,) is one by how much more that is.
    """
    body, space = begin(base, arcs, loads, lines, slopes, buffer)
    columns[:], pulls[:] = 0.0, 0.0
    for p in range(columns.shape[0]):
        for k in range(x.shape[0]):
            for j in range(4):
                space.trial[k, j] = x[k, j] + given[p, k, j]
        beside = Body(beside_arcs[p], beside_loads[p], beside_lines[p])
        evaluate_state(space.trial, tensions, beside, 1.0, space)
        _add(beside.lines, tensions, over[p], space, columns[p], pulls[p])
    find_taut(lines, tensions, space)
    evaluate_state(x, tensions, body, 1.0, space)
    answer_lines(lines, x.shape[0], space)
    for p in range(columns.shape[0]):
        _add(lines, tensions, -over[p], space, columns[p], pulls[p])
        solve(columns[p], space.none, space.stages, columns[p])
        hold(lines, space, columns[p], pulls[p])
        for k in range(x.shape[0]):
            for j in range(4):
                columns[p, k, j] += over[p] * given[p, k, j]


def _add(lines: Array, tensions: Array, fraction: float, space: Workspace, column: Array, pulls: Array) -> None:
    """Take a share of the residuals (N, 4) off `column`, and add as much of what lines (t,) are too long by."""
    for k in range(column.shape[0]):
        for j in range(4):
            column[k, j] -= fraction * space.stages[k, t.RESIDUAL + j]
    for i in range(lines.shape[0]):
        value = lines[i, t.LINE_VALUE] + lines[i, t.COMPLIANCE] * tensions[i]
        pulls[i] += fraction * (space.small[LENGTHS, i] - value)
