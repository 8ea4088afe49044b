"""Monte Carlo: configurations drawn at random about the best, from a range that shrinks.

Qin et al., "A snake-inspired layer-driven continuum robot" (2022), where it solves the inverse kinematics. The paper
could not be had: what was chosen is said in `sinuous.methods.monte_carlo.search`. Everything is compiled, one call a
solve.
"""

from dataclasses import dataclass
from typing import ClassVar

from sinuous.methods.compiled import Entry
from sinuous.methods.method import Case
from sinuous.methods.monte_carlo.search import search, workspace_size
from sinuous.methods.options import Options, count, number


@dataclass(frozen=True, repr=False)
class MonteCarlo(Options):
    """Options of the method `monte_carlo`.

    Attributes
    ----------
    rounds : int
        Most rounds from one start. They are the iterations of a solution.
    samples : int
        Configurations drawn in a round.
    shrink : float
        What is left of the range after a round that found nothing better.
    """

    method: ClassVar[str] = "monte_carlo"

    rounds: int = count(2000, 1, 1_000_000)
    samples: int = count(50, 1, 1_000_000)
    shrink: float = number(0.8, above=0.0, high=1.0)

    def entry(self, case: Case) -> Entry:
        """Return the compiled search; see `Options.entry`."""
        size = workspace_size(len(case.robot), len(case.scene))
        return Entry(search, lambda _: size, self.vector())
