"""Memory that plans work in, and use again."""

from typing import Any, NamedTuple

from sinuous.robot.robot import Robot
from sinuous.scene.snapshot import Snapshot
from sinuous.solving.between.steps import Prover
from sinuous.solving.planning.trees import Trees


class Workspace(NamedTuple):
    """What proves motions of a robot in a scene, and what grows trees there."""

    scene: Snapshot
    prover: Prover
    trees: Trees


class Workspaces:
    """Workspaces of one robot: each is in the hands of one plan at a time, so that threads may share them.

    Parameters
    ----------
    robot : Robot
    """

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._free: list[Workspace] = []

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._robot,)

    def take(self, scene: Snapshot) -> Workspace:
        """Return a workspace for a scene in which nothing moves: one that was given back, or a new one."""
        while self._free:
            try:
                work = self._free.pop()
            except IndexError:  # another thread was quicker
                break
            if work.scene is scene:
                return work
        return Workspace(scene, Prover(self._robot, scene), Trees(self._robot, scene))

    def give_back(self, work: Workspace) -> None:
        """Keep a workspace for the next plan."""
        self._free.append(work)
