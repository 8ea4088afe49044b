"""What a robot on its way prefers: some room."""

from sinuous.problem.preferences import Preferences

HALF = 0.5
"""Share of the wished clearance from which on a robot stays as it is."""


class Room(Preferences):
    """A clearance that is wished for on the way: a robot that has half of it goes on as it is.

    It is there for the steps, which are then proved sooner. To strive for the last of it at every waypoint would take
    longer than the steps do.
    """

    def satisfied(self, clearance: float) -> bool:
        """Say whether a solution with this clearance is left as it is."""
        return super().satisfied(clearance / HALF)
