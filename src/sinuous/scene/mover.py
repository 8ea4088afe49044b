"""A scene of which one exact obstacle moves, quickly however large the others are."""

import numpy as np

from sinuous import packing
from sinuous.checks import Floats
from sinuous.scene.obstacles import Primitive
from sinuous.scene.prepared.parts import NOTHING, Part
from sinuous.scene.snapshot import Snapshot


class Mover:
    """Makes snapshots of a scene in which one obstacle is elsewhere.

    They take turns with two arrays, of which each move writes one row, where others copy all that is prepared of
    meshes. So only the two latest may be solved in: the kernels find the others changed. It is for one who asks for
    the latest alone, as a hand that drags does.

    Parameters
    ----------
    snapshot : Snapshot
    index : int
        Of the obstacle, which is exact.
    """

    def __init__(self, snapshot: Snapshot, index: int) -> None:
        snapshot.prepare()
        self._index, self._latest = index, snapshot
        self._arrays: list[Floats] = [np.array(snapshot._kernel_group) for _ in range(2)]

    def goes_on(self, snapshot: Snapshot, index: int) -> bool:
        """Whether this is the latest snapshot and the obstacle that moves."""
        return self._latest is snapshot and self._index == index

    def moved(self, obstacle: Primitive) -> Snapshot:
        """Return the scene with this in the place of the obstacle."""
        array = self._arrays.pop(0)
        self._arrays.append(array)
        packing.scene_parts(array)[0][self._index] = obstacle.row
        self._latest = self._latest.with_row(self._index, obstacle, Part(obstacle.row, NOTHING), array)
        return self._latest
