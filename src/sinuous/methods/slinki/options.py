"""SLInKi: A* over a state lattice for the first segments, FABRIKc for the last two.

Chiang et al., "SLInKi: state lattice based inverse kinematics" (2021). The paper itself could not be had: what was
chosen is said in `sinuous.methods.slinki.search` and `sinuous.methods.slinki.motion_primitives`. Everything is
compiled, one call a solve; the lattice lies in a workspace that is made beforehand. The iterations of a solution are
nodes looked at and iterations of FABRIKc together.
"""

from dataclasses import dataclass
from typing import ClassVar

from sinuous.methods.compiled import Compiled
from sinuous.methods.options import Options, count, number
from sinuous.methods.registry import METHODS
from sinuous.methods.slinki.search import search, workspace_size
from sinuous.problem.tolerance import Tolerance
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene


@dataclass(frozen=True)
class Slinki(Options):
    """Options of the method `slinki`.

    Attributes
    ----------
    iterations : int
        Most iterations of FABRIKc from one node of the lattice.
    nodes : int
        Most nodes of one lattice; each takes 168 bytes of every thread's workspace.
    bends, directions, lengths : int
        Primitives of a segment: so many angles besides straight (growing with their squares, a quarter turn at most),
        in so many directions, at so many lengths. Every further start takes a finer lattice, three in all.
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

    def prepare(self, robot: Robot, scene: Scene, tolerance: Tolerance) -> Compiled:
        """Prepare the method for a robot in a scene."""
        size = workspace_size(len(robot), len(scene), self.nodes)
        can = METHODS[self.method].capabilities
        return Compiled(self.method, can, search, size, robot, scene, tolerance, self.vector())
