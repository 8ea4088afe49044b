"""How a body of arcs gives way around a state: the inverse of the second derivative of its energy, without lines."""

from sinuous.kernels.compile import entry
from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.statics import layout as t
from sinuous.kernels.statics.newton import begin, evaluate_state
from sinuous.kernels.statics.sweeps import solve


@entry
def soften(
    base: Array,
    arcs: Array,
    loads: Array,
    lines: Array,
    slopes: int,
    x: Array,
    tensions: Array,
    buffer: Array,
    left: Array,
    out: Array,
) -> None:
    """Fill `out` (m, N, 4) with the change of state for a unit of force on each of the first m coordinates of the arcs.

    Lines hold nothing: their tensions stay what they are. What is rigid does not move. `left` (N, 4) is filled with the
    gradient of the energy. `x` (N, 4) and the rest as for `equilibrium.equilibrate`; `buffer` has
    `newton.workspace_size` numbers.
    """
    body, space = begin(base, arcs, loads, lines, slopes, buffer)
    evaluate_state(x, tensions, body, 1.0, False, space)
    for k in range(x.shape[0]):
        for j in range(4):
            left[k, j] = space.stages[k, t.RESIDUAL + j]
    for i in range(out.shape[0]):
        out[i] = 0.0
        out[i, i // 4, i % 4] = 1.0
        solve(out[i], space.none, space.stages, out[i])
