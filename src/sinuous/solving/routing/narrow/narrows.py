"""The narrow places of the lines of one question, and the chains through them."""

from collections.abc import Callable

import numpy as np

from sinuous.checks import Floats
from sinuous.solving.routing.crossing import Crossing
from sinuous.solving.routing.gates import Passage, least_room
from sinuous.solving.routing.narrow.tunnels import Tunnel, tunnel_on
from sinuous.solving.routing.turned import Groups

Look = Callable[[Floats], Floats]
"""From points (K, 3) to lengths (K,)."""


class Narrows:
    """The narrowest place of each line: a tube, where there is one, else gates.

    Parameters
    ----------
    groups : tuple of ndarray
        The problem, see `Groups`.
    distance : callable
        How far points (K, 3) are from the obstacles (K,), in the length unit.
    beside : callable
        How much room is beside the points of a line (K, 3), across it (K,), in the length unit.
    seconds_left : callable
    """

    def __init__(self, groups: Groups, distance: Look, beside: Look, seconds_left: Callable[[], float]) -> None:
        self._groups, self._distance, self._beside, self._seconds_left = groups, distance, beside, seconds_left
        self._distances: dict[int, Floats] = {}
        self._crossings: dict[int, Crossing] = {}

    def room(self, rank: int, legs: Floats) -> float:
        """Distance from the obstacles that line number `rank`, of these legs (l, K, 3), keeps: in radii of the body."""
        return least_room(self._groups, self._distances_of(rank, legs))

    def crossing(self, rank: int, legs: Floats) -> Crossing:
        """Return the chains through the narrowest place of line number `rank`, of these legs (l, K, 3).

        What leads along a wall is not narrow: there is room beside it.
        """
        if rank not in self._crossings:
            seconds = max(0.0, self._seconds_left())
            found: Passage | Tunnel | None
            found = tunnel_on(self._groups, legs, self._distances_of(rank, legs), self._distance, seconds)
            if found is None:
                found = Passage(self._groups, legs, np.stack([self._beside(leg) for leg in legs]))
            self._crossings[rank] = Crossing(self._groups, found)
        return self._crossings[rank]

    def _distances_of(self, rank: int, legs: Floats) -> Floats:
        if rank not in self._distances:
            self._distances[rank] = self._distance(legs.reshape(-1, 3)).reshape(legs.shape[:2])
        return self._distances[rank]
