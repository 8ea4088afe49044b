"""FABRIKx: forward and backward reaching for sections of variable curvature.

Kolpashchikov, Gerget & Danilov, "FABRIKx: tackling the inverse kinematics problem of continuum robots with variable
curvature" (Robotics 11, 128, 2022). A section of variable curvature is planar and has two links, which differ; here as
there it is approximated by arcs. Its full text could not be had, so chosen here are: which sections there are (`pieces`
segments in a row are one), how curvature varies along them (`taper`), and the rules that all the methods of this family
share (see `sinuous.methods.fabrik.links`). Lengths are those that the start has. Answers are configurations of the
robot's segments like any other. Everything is compiled, one call a solve.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sinuous.methods.compiled import Entry
from sinuous.methods.fabrik.search import search, workspace_size
from sinuous.methods.method import Case
from sinuous.methods.options import Options, count, number


@dataclass(frozen=True, repr=False)
class Fabrikx(Options):
    """Options of the method `fabrikx`.

    Attributes
    ----------
    iterations : int
        Most iterations from one start; each goes from the tip to the base and back.
    pieces : int
        Segments in a row that are bent together as one section; the last section has what is left.
    taper : float
        How bends vary along a section of p segments: as `1 + taper (2 (j + 1/2) / p - 1)`, j = 0 ... p - 1. From
        -0.9 to 0.9; 0 bends all alike.
    """

    method: ClassVar[str] = "fabrikx"

    iterations: int = count(300, 1, 1_000_000)
    pieces: int = count(1, 1, 10_000)
    taper: float = number(0.0, low=-0.9, high=0.9)

    def entry(self, case: Case) -> Entry:
        """Return the compiled search; see `Options.entry`."""
        no_stretch = np.array([*self.vector(), 0.0])
        size = workspace_size(len(case.robot), len(case.scene))
        return Entry(search, lambda _: size, no_stretch)
