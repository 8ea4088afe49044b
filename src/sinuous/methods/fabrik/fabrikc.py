"""FABRIKc: forward and backward reaching for constant-curvature segments.

Zhang et al., "FABRIKc: an efficient iterative inverse kinematics solver for continuum robots" (2018).
The paper has segments of fixed length. Those that stretch are what others call exFABRIKc, of which no description could
be had: what was chosen is said in `sinuous.methods.fabrik.links`. Everything is compiled, one call a solve.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sinuous.methods.compiled import Entry
from sinuous.methods.fabrik.search import search, workspace_size
from sinuous.methods.method import Case
from sinuous.methods.options import Options, count, flag


@dataclass(frozen=True, repr=False)
class Fabrikc(Options):
    """Options of the method `fabrikc`.

    Attributes
    ----------
    iterations : int
        Most iterations from one start; each goes from the tip to the base and back.
    stretch : bool
        Whether segments may change the lengths that the start gave them, within their limits (exFABRIKc).
    """

    method: ClassVar[str] = "fabrikc"

    iterations: int = count(300, 1, 1_000_000)
    stretch: bool = flag(True)

    def entry(self, case: Case) -> Entry:
        """Return the compiled search; see `Options.entry`."""
        one_segment_a_section = np.array([float(self.iterations), 1.0, 0.0, float(self.stretch)])
        size = workspace_size(len(case.robot), len(case.scene))
        return Entry(search, lambda _: size, one_segment_a_section)
