"""The narrow places of the lines of one question, and the chains through them."""

from collections.abc import Callable

from sinuous.checks import Floats
from sinuous.solving.routing.crossing import Crossing
from sinuous.solving.routing.gates import Passage
from sinuous.solving.routing.narrow.tunnels import tunnel_on
from sinuous.solving.routing.turned import Groups


class Narrows:
    """The narrowest place of each line: a tube, where there is one, else gates.

    Parameters
    ----------
    groups : tuple of ndarray
        The problem, see `Groups`.
    distance : callable
        How far points (K, 3) are from the obstacles (K,), in the length unit.
    seconds_left : callable
    """

    def __init__(self, groups: Groups, distance: Callable[[Floats], Floats], seconds_left: Callable[[], float]) -> None:
        self._groups, self._distance, self._seconds_left = groups, distance, seconds_left
        self._distances: dict[int, Floats] = {}
        self._passages: dict[int, Passage] = {}
        self._crossings: dict[int, Crossing] = {}

    def room(self, rank: int, legs: Floats) -> float:
        """Distance from the obstacles that line number `rank`, of these legs (l, K, 3), keeps: in radii of the body."""
        return self._passage(rank, legs).room

    def crossing(self, rank: int, legs: Floats) -> Crossing:
        """Return the chains through the narrowest place of line number `rank`, of these legs (l, K, 3)."""
        if rank not in self._crossings:
            seconds = max(0.0, self._seconds_left())
            tunnel = tunnel_on(self._groups, legs, self._distances_of(rank, legs), self._distance, seconds)
            self._crossings[rank] = Crossing(self._groups, tunnel or self._passage(rank, legs))
        return self._crossings[rank]

    def _passage(self, rank: int, legs: Floats) -> Passage:
        if rank not in self._passages:
            self._passages[rank] = Passage(self._groups, legs, self._distances_of(rank, legs))
        return self._passages[rank]

    def _distances_of(self, rank: int, legs: Floats) -> Floats:
        if rank not in self._distances:
            self._distances[rank] = self._distance(legs.reshape(-1, 3)).reshape(legs.shape[:2])
        return self._distances[rank]
