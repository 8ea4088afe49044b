"""SLInKi: weighted A* over motion primitives for the first segments, FABRIKc for the last two.

Chiang et al., "SLInKi: state lattice based inverse kinematics" (2021). The paper itself could not be had: what was
chosen is said in `sinuous.methods.slinki.search` and `sinuous.methods.slinki.motion_primitives`. Everything is
compiled, one call a solve; the tree of shapes lies in a workspace that is made beforehand. The iterations of a solution
are nodes looked at and iterations of FABRIKc together.
"""

from dataclasses import dataclass
from typing import ClassVar

from sinuous.methods.compiled import Entry
from sinuous.methods.method import Case
from sinuous.methods.options import Options, count, number
from sinuous.methods.slinki.search import search, workspace_size


@dataclass(frozen=True, repr=False)
class Slinki(Options):
    """Options of the method `slinki`.

    Attributes
    ----------
    iterations : int
        Most iterations of FABRIKc from one node of the tree.
    nodes : int
        Most nodes of one tree; each takes 168 bytes of every thread's workspace.
    bends, directions, lengths : int
        Primitives of a segment: so many angles besides straight (growing with their squares, a quarter turn at most),
        in so many directions, at so many lengths. Every further start takes more of them, three in all.
    weight : float
        Weight of what a node may still cost against what it costs; 1 searches widely, more goes straight ahead.
    """

    method: ClassVar[str] = "slinki"

    iterations: int = count(60, 1, 1_000_000)
    nodes: int = count(8192, 2, 100_000_000)
    bends: int = count(3, 1, 100)
    directions: int = count(8, 3, 1000)
    lengths: int = count(3, 1, 100)
    weight: float = number(10.0, low=0.0)

    def entry(self, case: Case) -> Entry:
        """Return the compiled search; see `Options.entry`."""
        size = workspace_size(len(case.robot), len(case.scene), self.nodes)
        return Entry(search, lambda _: size, self.vector())
