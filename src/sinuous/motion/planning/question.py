"""From where to where a way is sought, in which scene, and with what in hand."""

from collections.abc import Callable
from dataclasses import dataclass

from sinuous.checks import Floats
from sinuous.motion.planning.watch import Watch
from sinuous.robot.robot import Robot
from sinuous.scene.snapshot import Snapshot
from sinuous.solving.planning.trees import Trees


@dataclass(frozen=True)
class Question:
    """What a source of ways is asked.

    Attributes
    ----------
    robot : Robot
    scene : Snapshot
    start : ndarray (n, 3)
        Within all limits and clear.
    goals : callable
        Takes configurations (m, n, 3) that the start is known to reach, and returns all goals so far (g, n, 3): within
        all limits and clear. There may be more of them each time.
    seed : int
    shortcuts : int
        How many are tried on a way that was found.
    watch : Watch
        Says how many seconds are left.
    trees : Trees, optional
        Of this robot and scene, to grow in.
    """

    robot: Robot
    scene: Snapshot
    start: Floats
    goals: Callable[[Floats], Floats]
    seed: int
    shortcuts: int
    watch: Watch
    trees: Trees | None = None
