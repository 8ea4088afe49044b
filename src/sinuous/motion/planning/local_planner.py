"""The local planner: moves a body to a configuration nearby that has room, and proves the motion there.

A solution of a robot with a thicker body leaves the robot itself room. So a configuration that is in contact, or too
near to it for a proof, is solved again with a thicker body, and the motion there is proved.
"""

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.motion.planning.query import Query
from sinuous.problem.problem import Preferences
from sinuous.problem.target import Target, Tolerance
from sinuous.scene.scene import Scene
from sinuous.solver.certificates.steps import Prover
from sinuous.solver.options import SolveOptions
from sinuous.solver.solver import Solver

CLEARANCES = (0.2, 0.05)
"""Room that retractions ask for, in radii of each segment: by so much thicker robots are solved."""

LOOSE = 0.3
"""How far the tip may move while a body is given room, in the largest radius of the body."""

WISHED = 0.02
"""Clearance that is preferred where no room is asked for, in mean lengths of a segment."""

FINEST = 1e-6
"""Length below which the proof of an edge gives up, in robot lengths: an edge may begin near to contact."""

KEPT = 64
"""Thicker robots that are kept in memory."""


class LocalPlanner:
    """Solvers of a robot and of thicker ones, and proofs of short motions; made once for a query.

    Parameters
    ----------
    query : Query
    """

    def __init__(self, query: Query) -> None:
        self.deadline = query.deadline
        self.robot = query.robot if np.array_equal(query.robot.tool, np.eye(4)) else query.robot.changed(tool=None)
        self._scene = query.scene
        self._prover = Prover(query.robot, query.scene, FINEST)
        self._solvers: dict[tuple[float, float], Solver] = {}

    def lead(self, target: Target, begin: Floats, room: float) -> Floats | None:
        """Lead the tip (not the tool) to a target from a configuration (n, 3), with so much room (radii).

        `None` where that fails.
        """
        return self._solve(target, begin, room, 0.0)

    def retract(self, q: Floats, room: float) -> Floats | None:
        """Return a configuration near one (n, 3) that may overlap: with room (radii), and the tip about where it is."""
        return self._solve(Target(self.robot.tip(q)[:3, 3]), q, room, LOOSE * max(self.robot.radii))

    def is_clear(self, p: Floats, q: Floats) -> bool:
        """Whether the motion from `p` to `q` (n, 3) is proved clear."""
        return self._prover.is_clear(p, q, self.deadline.left())

    def _solve(self, target: Target, begin: Floats, room: float, loose: float) -> Floats | None:
        if (room, loose) not in self._solvers:
            self._solvers[room, loose] = self._prepared(room, loose)
        return self._solvers[room, loose].descend(target, begin, max(0.0, self.deadline.left()))

    def _prepared(self, room: float, loose: float) -> Solver:
        """A solver that goes to one target from one configuration, or not at all."""
        wished = WISHED * self.robot.mean_length / len(self.robot) if room == 0.0 else 0.0
        tolerance = Tolerance(position=loose) if loose > 0.0 else Tolerance()
        options = replace(
            SolveOptions(), max_starts=1, routes=False, prefer=Preferences(clearance=wished), tolerance=tolerance
        )
        return Solver._of_checked(with_radii(self.robot, 1.0 + room), Scene.of(self._scene), options)


@lru_cache(maxsize=KEPT)
def with_radii(robot: Robot, share: float) -> Robot:
    """Return a robot whose segments and links have a share of their radii, less or more than all of it."""
    changed = {segment: segment.changed(radius=share * segment.radius) for segment in dict.fromkeys(robot.segments)}
    given: dict[str, Any] = {"segments": [changed[segment] for segment in robot.segments]}
    if robot.joints:
        bodies = [[each._replace(radius=share * each.radius) for each in joint.body] for joint in robot.joints]
        given["joints"] = [joint.changed(body=body) for joint, body in zip(robot.joints, bodies, strict=True)]
    return robot.changed(**given)
