"""Lists of the triangles of a small mesh that may be the closest, for every cell of a grid about it."""

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.tables import COUNT

CELLS, ENTRIES = 29_000, 1_900_000
"""Most cells about a mesh, and most triangles of all their lists: 16 MB."""


def candidates(row: Floats, store: Floats, shape: tuple[int, int, int]) -> Floats:
    """Return cells and lists (l,) as the kernels read them, see `sinuous.kernels.fields.candidates`.

    Of a mesh whose row says where the middles of the cells are.
    """
    from sinuous.kernels.fields.candidates import CELL_SIZE, WORK, list_candidates  # noqa: PLC0415

    cells, lists = np.empty((*shape, CELL_SIZE)), np.empty(ENTRIES)
    count = list_candidates(row.reshape(1, -1).copy(), store, np.empty((WORK, int(row[COUNT]))), cells, lists)
    return np.concatenate([cells.ravel(), lists[:count]])
