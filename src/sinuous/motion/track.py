"""Follow a path: targets solved one after the other, each from the last, and the motion between them proved."""

from collections.abc import Callable, Iterable
from typing import Any, Unpack

from sinuous.answer.solution import Solution
from sinuous.base import checks
from sinuous.base.arguments import Number, Reconfigure, Shortest, Vector
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, refuse_unknown
from sinuous.methods.method import Choice, capabilities
from sinuous.model.rates import Rates
from sinuous.model.robot import Robot
from sinuous.motion.motion import Motion
from sinuous.motion.pace import Pace
from sinuous.motion.report import MOST_WAYPOINTS, RECONFIGURE
from sinuous.motion.timetable import Timetable
from sinuous.motion.tracker import Tracker
from sinuous.problem.path import Path
from sinuous.problem.problem import Preferences
from sinuous.problem.target import KEYS, GoalArrays, Targets
from sinuous.problem.target_sets import read_target_sets
from sinuous.scene.scene import Scene, SceneLike, as_scene
from sinuous.solver.options import SolveArguments
from sinuous.solver.solver import Initial, Solver

WISHED_CLEARANCE = 0.02
"""Clearance that is wished for by default, in mean lengths of a segment."""

HALF = 0.5
"""Share of the wished clearance with which a robot on its way stays as it is."""

SHORTEST: tuple[Shortest, ...] = ("configuration", "actuators")
"""What a motion may be shortest in."""

TOLERANCES = 10.0
"""How far the tip may be from the line between waypoints by default, in tolerances of positions."""


class TimedArguments(SolveArguments, total=False):
    """Options of `Solver`, and how a path is followed, and how fast."""

    rates: Rates | None
    duration: Number | None
    deviation: Number | None
    reconfigure: Reconfigure
    shortest: Shortest | None


class TrackArguments(SolveArguments, GoalArrays, total=False):
    """Options of `track` as keyword arguments, and arrays of goals."""


def track(
    robot: Robot,
    targets: Iterable[Targets] | None = None,
    scene: SceneLike | None = None,
    *,
    start: Initial | None = None,
    deviation: Number | None = None,
    reconfigure: Reconfigure = "refuse",
    shortest: Shortest | None = None,
    times: Vector | None = None,
    rates: Rates | None = None,
    duration: Number | None = None,
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
        Where obstacles are `Moving`, waypoints are solved in the scene at their times, and steps proved in time.
    start : Solution or array_like (n, 3), optional
        The configuration that the robot is in: the first knot of the motion.
    deviation : float, optional
        How far the tip may be from the straight line between waypoints, where these ask for the same of the tip, in the
        length unit. By default ten times the tolerance of positions.
    reconfigure : str
        Whether the tip may leave that line where the robot cannot follow it: `refuse` or `allow`. It then changes its
        configuration on another way, to go on from there, and `Motion.left_steps` says where. Unless that is allowed,
        the motion is `left_path` and not solved; before that is said, where nothing moves, the shapes along the whole
        path are searched for, from the start if one is given, and changes of the shape while the tip stays.
    shortest : str, optional
        `configuration` or `actuators`: at last, the whole motion is made shorter in these, all knots together, as far
        as the waypoints and the line between them leave it open. By default it is not.
    times : array_like (m,), optional
        When the tip is at each waypoint, increasing; by default those of a `Path`, or 0, 1, 2, ... A start that is
        given is as long before the first waypoint as the second is after it.
    rates : Rates, optional
        How fast the robot may be. Without `times` and `duration` it is as fast as that allows; where these are too
        short the motion is `rate_bound`, and takes longer by one factor. Where obstacles move it keeps its times.
    duration : float, optional
        How long all of it takes, instead of `times`.
    progress : callable, optional
        Called with the solution of each waypoint as it is found.
    **options
        As for `Solver`; `time` is the budget of one waypoint. By default `prefer` wishes for a clearance of 0.02 of the
        mean length of a segment, and is content with half of it: along obstacles, steps are proved sooner and are fewer
        then.

    Returns
    -------
    Motion
        Always; look at its status. Its knots are the start, where it is given, and the waypoints that are solved.

    Raises
    ------
    InputError
        When an argument is not what it should be; nothing is solved then.
    """
    refuse_unknown(options, TrackArguments.__annotations__)
    given: dict[str, Any] = dict(options)
    path = read_target_sets(robot, targets, {key: given.pop(key) for key in KEYS if key in given})
    wanted = None if shortest is None else checks.choice("shortest", shortest, SHORTEST)
    if wanted == "actuators" and not robot.actuators:
        raise InputError("shortest", "the robot has no actuators", shortest, "configuration")
    if not 1 <= len(path) <= MOST_WAYPOINTS:
        raise InputError("targets", "", len(path), f"1 to {MOST_WAYPOINTS:,} waypoints")
    given_times = targets.times if times is None and isinstance(targets, Path) else times
    when = None if given_times is None else checks.increasing("times", given_times, len(path))
    pace = Pace.of(robot, rates, duration, times=when)
    when = pace.waypoints(len(path), start is not None) if when is None else when
    given |= {"deviation": deviation, "reconfigure": reconfigure}
    tracker = tracker_of(robot, len(path), scene, start=start, times=when, **given)
    tracker.follow(map(path.targets, range(len(path))), progress=progress)
    if wanted is not None:
        tracker.shorten(wanted)
    return pace.kept(tracker.motion(len(path) - tracker.tried, when))


def tracker_of(
    robot: Robot,
    waypoints: int,
    scene: SceneLike | None = None,
    *,
    start: Initial | None = None,
    times: Floats | None = None,
    deviation: Number | None = None,
    reconfigure: Reconfigure = "refuse",
    **options: Unpack[SolveArguments],
) -> Tracker:
    """Return a tracker for a path of so many waypoints, for which everything is compiled; arguments as for `track`.

    Raises
    ------
    InputError
        When an argument is not what it should be.
    """
    if options.get("prefer") is None:
        options["prefer"] = default_preferences(robot, options.get("method", "newton"))
    place = as_scene(scene)
    timetable = timetable_of(place, times, waypoints, start is not None)
    solver = Solver(robot, place if timetable is None else timetable.live, **options)
    own = read_deviation(solver, deviation), timetable, checks.choice("reconfigure", reconfigure, RECONFIGURE)
    return Tracker(solver, start, *own)


class ClearanceWish(Preferences):
    """A clearance that is wished for on the way: a robot that has half of it goes on as it is.

    It is there for the steps, which are then proved sooner. To strive for the last of it at every waypoint would take
    longer than the steps do.
    """

    def satisfied(self, clearance: float) -> bool:
        """Say whether a solution with this clearance is left as it is."""
        return super().satisfied(clearance / HALF)


def timetable_of(scene: Scene, times: Floats | None, waypoints: int, started: bool) -> Timetable | None:
    """When the robot is where, if obstacles of a scene move; `None` where they all stand still."""
    snapshot = scene.snapshot()
    return Timetable(snapshot, times, waypoints, started) if snapshot.moves else None


def default_preferences(robot: Robot, method: Choice) -> Preferences:
    """Return what a robot on its way prefers by default, where the method takes preferences: some room."""
    checks.instance("robot", robot, Robot, "a Robot")
    if not capabilities(method).preferences:
        return Preferences()
    return ClearanceWish(clearance=robot._least_clearances[0] + WISHED_CLEARANCE * robot.mean_length / len(robot))


def read_deviation(solver: Solver, deviation: Number | None) -> float:
    """Check how far the tip may be from the line between waypoints.

    Raises
    ------
    InputError
        When it is no number greater than the tolerance of positions.
    """
    least = solver.tolerance.position or 0.0
    return TOLERANCES * least if deviation is None else checks.number("deviation", deviation, above=least)
