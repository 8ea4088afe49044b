"""Follow a path: targets solved one after the other, each from the last, and the motion between them proved."""

from collections.abc import Callable, Iterable
from typing import Any, Unpack

from sinuous import checks
from sinuous.motion.motion import Motion
from sinuous.motion.plain import MOST_WAYPOINTS
from sinuous.motion.tracker import Tracker
from sinuous.problem.asked import read_asked
from sinuous.problem.goals import KEYS, GoalArrays
from sinuous.problem.target import Targets
from sinuous.robot.robot import Robot
from sinuous.scene.scene import SceneLike
from sinuous.solution.solution import Solution
from sinuous.solving.options import SolveArguments
from sinuous.solving.solver import Initial, Solver


class TrackArguments(SolveArguments, GoalArrays, total=False):
    """Options of `track` as keyword arguments, and arrays of goals."""


def track(
    robot: Robot,
    targets: Iterable[Targets] | None = None,
    scene: SceneLike | None = None,
    *,
    start: Initial | None = None,
    progress: Callable[[Solution], object] | None = None,
    **options: Unpack[TrackArguments],
) -> Motion:
    """Follow a path of targets.

    Parameters
    ----------
    robot : Robot
    targets : iterable of Target or list of Target, optional
        The waypoints; the targets of a list are met at once. Or arrays of the tip's goals: `positions`, `directions`,
        `rotations` and `xyzw`, as for `Solver.solve_many`.
    scene : Scene or list of obstacles, optional
    start : Solution or array_like (n, 3), optional
        The configuration that the robot is in: the first knot of the motion.
    progress : callable, optional
        Called with the solution of each waypoint as it is found.
    **options
        As for `Solver`; `time` is the budget of one waypoint.

    Returns
    -------
    Motion
        Always; look at its status. Its knots are the start, where it is given, and the waypoints that are solved.

    Raises
    ------
    InputError
        When an argument is not what it should be; nothing is solved then.
    """
    given: dict[str, Any] = dict(options)
    path = read_asked(robot, targets, {key: given.pop(key) for key in KEYS if key in given})
    checks.integer("len(targets)", len(path), 1, MOST_WAYPOINTS)
    tracker = Tracker(Solver(robot, scene, **given), start)
    if tracker.blocked is not None:
        return tracker.motion(remaining=len(path))
    for i in range(len(path)):
        solution = tracker.go_to(path.targets(i))
        if progress is not None:
            progress(solution)
    return tracker.motion()
