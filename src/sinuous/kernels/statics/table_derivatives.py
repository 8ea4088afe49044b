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
    evaluate_state,
    fill_replies,
    find_taut,
    hold_taut,
    lay_out,
)
from sinuous.kernels.statics.sweeps import solve


@entry
def differentiate_by_tables(
    base: Array,
    arcs: Array,
    loads: Array,
    lines: Array,
    slopes: int,
    x: Array,
    tensions: Array,
    more_arcs: Array,
    more_loads: Array,
    more_lines: Array,
    given: Array,
    per_unit: Array,
    buffer: Array,
    columns: Array,
    pulls: Array,
) -> None:
    """Fill `columns` (p, N, 4) and `pulls` (p, t): how states and tensions change with p parameters.

    `x` and `tensions` are an equilibrium; the rest as for `equilibrium.equilibrate`, `buffer` has
    `newton.workspace_size` numbers. Tables with a little more of each parameter: `more_arcs` (p, N, 22),
    `more_loads` (p, k, 10) and `more_lines` (p, t, 10), and the changes `given` (p, N, 4) of states that are rigid;
    `per_unit` (p,) is 1 divided by how much more that is.
    """
    body, space = lay_out(base, arcs, loads, lines, slopes, buffer)
    columns[:], pulls[:] = 0.0, 0.0
    for p in range(columns.shape[0]):
        for k in range(x.shape[0]):
            for j in range(4):
                space.trial[k, j] = x[k, j] + given[p, k, j]
        changed = Body(more_arcs[p], more_loads[p], more_lines[p])
        evaluate_state(space.trial, tensions, changed, 1.0, space)
        _add_residuals(changed.lines, tensions, per_unit[p], space, columns[p], pulls[p])
    find_taut(lines, tensions, space)
    evaluate_state(x, tensions, body, 1.0, space)
    fill_replies(lines, x.shape[0], space)
    for p in range(columns.shape[0]):
        _add_residuals(lines, tensions, -per_unit[p], space, columns[p], pulls[p])
        solve(columns[p], space.none, space.stages, columns[p])
        hold_taut(lines, space, columns[p], pulls[p])
        for k in range(x.shape[0]):
            for j in range(4):
                columns[p, k, j] += per_unit[p] * given[p, k, j]


def _add_residuals(lines: Array, tensions: Array, share: float, space: Workspace, column: Array, pulls: Array) -> None:
    """Take a share of residuals off `column` (N, 4), and add it of what lines are too long by to `pulls` (t,)."""
    for k in range(column.shape[0]):
        for j in range(4):
            column[k, j] -= share * space.stages[k, t.RESIDUAL + j]
    for i in range(lines.shape[0]):
        value = lines[i, t.LINE_VALUE] + lines[i, t.COMPLIANCE] * tensions[i]
        pulls[i] += share * (space.small[LENGTHS, i] - value)
