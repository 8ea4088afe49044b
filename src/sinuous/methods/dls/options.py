"""DLS: damped least squares on the geometric Jacobian of the tip.

Wampler 1986; Nakamura & Hanafusa 1986; the damping and the clamp that were chosen are those of Chan & Lawrence 1988 and
Buss & Kim 2005 (see `sinuous.methods.dls.search`). Steps that leave the limits are put back within them. Everything is
compiled, one call a solve, with a system of at most six rows whatever the number of segments.
"""

from dataclasses import dataclass
from typing import ClassVar

from sinuous.methods.compiled import Entry
from sinuous.methods.dls.search import search, workspace_size
from sinuous.methods.method import Case
from sinuous.methods.options import Options, count, number


@dataclass(frozen=True, repr=False)
class Dls(Options):
    """Options of the method `dls`.

    Attributes
    ----------
    iterations : int
        Most steps from one start.
    damping : float
        What is added to the diagonal, as a share of the squared error (robot lengths and rad).
    clamp : float
        Largest error that one step goes for, in robot lengths and rad together.
    """

    method: ClassVar[str] = "dls"

    iterations: int = count(200, 1, 1_000_000)
    damping: float = number(0.1, low=0.0)
    clamp: float = number(0.5, above=0.0)

    def entry(self, case: Case) -> Entry:
        """Return the compiled search; see `Options.entry`."""
        size = workspace_size(len(case.robot), len(case.scene))
        return Entry(search, lambda _: size, self.vector())
