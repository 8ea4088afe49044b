"""FABRIK with obstacle avoidance: forward and backward reaching that pushes key points away from what it runs into.

Wu et al., "A novel obstacle avoidance heuristic algorithm of continuum robot based on FABRIK" (2022). The paper could
not be had: what was chosen is said in `sinuous.methods.fabrik_avoid.search`. It looks at obstacles in places; that
answers are clear of them is proved afterwards, as for every method. Everything is compiled, one call a solve.
"""

from dataclasses import dataclass
from typing import ClassVar

from sinuous.methods.compiled import Entry
from sinuous.methods.fabrik.search import workspace_size
from sinuous.methods.fabrik_avoid.search import search
from sinuous.methods.method import Case
from sinuous.methods.options import Options, count, flag, number


@dataclass(frozen=True, repr=False)
class FabrikAvoid(Options):
    """Options of the method `fabrik_avoid`.

    Attributes
    ----------
    iterations : int
        Most iterations from one start.
    looks : int
        Places of every segment that are looked at for obstacles.
    push : float
        How far a key point is pushed, as a share of what is missing.
    margin : float
        Clearance that a push aims for, in robot lengths.
    stretch : bool
        Whether segments may change the lengths that the start gave them, within their limits.
    """

    method: ClassVar[str] = "fabrik_avoid"

    iterations: int = count(300, 1, 1_000_000)
    looks: int = count(8, 1, 10_000)
    push: float = number(1.5, above=0.0)
    margin: float = number(0.002, low=0.0)
    stretch: bool = flag(True)

    def entry(self, case: Case) -> Entry:
        """Return the compiled search; see `Options.entry`."""
        size = workspace_size(len(case.robot), len(case.scene))
        return Entry(search, lambda _: size, self.vector())
