"""Follow the leader: the body moves along the curve that its tip has made; and the insertion stage that it needs."""

import math
from itertools import pairwise

import numpy as np

from sinuous.answer.solution import Solution
from sinuous.answer.solutions import Solutions
from sinuous.base import checks
from sinuous.base.arguments import Number, OneEach, Rows
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.progress import work_time
from sinuous.measures.following import line_in_front
from sinuous.model.actuators import Stage
from sinuous.model.robot import Robot, Uncertainty
from sinuous.model.segment import Segment
from sinuous.motion.curve_fitting import depths_of, fit_chains_along
from sinuous.motion.motion import Motion
from sinuous.motion.report import Report
from sinuous.problem.path import Curve
from sinuous.problem.target import Tolerance
from sinuous.scene.scene import SceneLike
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.certificates.steps import Prover, Steps, unproved
from sinuous.solver.options import TIME, SolveOptions
from sinuous.solver.solver import Solver
from sinuous.statics.between import bounded
from sinuous.statics.rest import bodies_at

EXACT = 1e-10
"""How exactly the tip is on the curve at every knot, in lengths of the robot."""

TIP_DEVIATION = 3e-6
"""How far the tip may leave the curve between knots, by default, in mean lengths of the segments together."""

TIP_SAMPLES = 7
"""Places of a step, evenly spaced, at which it is measured how far the tip is off the curve."""

SAMPLES = 20
"""Places of each segment of a solution that is followed."""

FITTED = 8
"""Chains that are fitted, for each length of the shortest segment that bends; what lies between is interpolated."""

LEAST_FITTED, MOST_FITTED, MOST_KNOTS = 6, 400, 100_000

TIP_ROUNDS, ROUNDS, DIVIDED = 8, 4, 4
"""How often steps are divided where the tip leaves the curve; and then where they are not proved, into so many."""

SLACK = 0.1
"""How far below the clearances of its ends the bound of a step may be, as a share of them."""

FINEST = 1e-5
"""Length, in robot lengths, below which a proof gives up: a tenth of what solves keep off obstacles."""

SECONDS = 5.0
"""Time for the proof of a step: it ends by its fineness long before, so that the same motion is found at any time."""

FORWARD = 0.5
"""Largest angle, rad, between the axis of the base and the way into the curve."""


def on_stage(robot: Robot, travel: Number, name: str = "stage", motor: Stage | None = None) -> Robot:
    """Put a robot on a stage that pushes it forward along the axis of its base.

    Drawn back as far as it goes, the arm stands straight behind the base of before, at its greatest length, and its tip
    is there. So `robot.base` is where the tip enters, and how. The stage is a first segment that cannot bend.

    Parameters
    ----------
    robot : Robot
    travel : float
        How far the stage goes, in the length unit.
    name : str
        What the segment of the stage is called.
    motor : Stage, optional
        The motor of the stage, which makes it an actuator: `sn.Stage()`, or with its gain.

    Raises
    ------
    InputError
        When the travel is not greater than 0, or a segment has this name.
    """
    reach = checks.number("travel", travel, above=0.0)
    back = np.eye(4)
    back[2, 3] = -sum(segment.length[1] for segment in robot.segments)
    own = checks.text("name", name)
    stage = Segment((0.0, reach), max_bend=0.0, radius=robot.radii[0], name=own, stage=motor)
    linear = robot.linear
    if linear is not None:
        wider = np.hstack([np.zeros((len(linear.matrix), 3)), linear.matrix])
        linear = linear.changed(matrix=wider)
    named = [s.changed(name=n) for s, n in zip(robot.segments, robot.segment_names, strict=True)]
    unsure = robot.uncertainty
    carried = [load if load.segment is None else load.changed(segment=load.segment + 1) for load in robot.payload]
    return robot.changed(
        segments=[stage, *named],
        base=robot.base @ back,
        actuators=linear,
        clearance=_of_stage_too(robot.clearance),
        self_clearance=_of_stage_too(robot.self_clearance),
        uncertainty=None if unsure is None else Uncertainty(_of_stage_too(unsure.bound), unsure.level),
        payload=carried or None,
    )


def _of_stage_too(known: float | tuple[float, ...]) -> float | tuple[float, ...]:
    """What is demanded or not known of each segment; of the stage it is that of the first one."""
    return (known[0], *known) if isinstance(known, tuple) else known


def follow_the_leader(
    robot: Robot,
    curve: Rows | Curve | Solution,
    scene: SceneLike | None = None,
    *,
    tip_deviation: Number | None = None,
    time: Number = TIME,
    clearance: OneEach | None = None,
    self_clearance: OneEach | None = None,
) -> Motion:
    """Lead a body along a curve: at every depth it lies on the part of the curve that its tip has passed.

    Where joints carry the first segment, they move it along the curve, and along a straight line as long as the
    segments behind where it begins. Else the length of the chain is the depth, so the robot has to be able to change
    it: by an insertion stage (a first segment that stretches and cannot bend, see `on_stage`), or by segments that
    stretch, which unroll. The base does not move otherwise. At every knot the tip is on the curve, and shapes are
    fitted to it by least squares; every step is proved. `motion.deviation(curve)` measures both. `motion.reversed()`
    leads out again. Under load it is the loaded body that lies on the curve; where nothing bounds it between two knots,
    their step is `sampled`, not proved.

    Parameters
    ----------
    robot : Robot
    curve : array_like (K, 3), Curve or Solution
        Points from the base, or from where the tip enters, to where it goes: a cubic spline through them is followed,
        with a straight line in front from the base where they begin elsewhere; with joints the tip enters there. Of a
        `Solution` the backbone is followed, so that the motion ends in its shape; its `route` is an array of points.
    scene : Scene or list of obstacles, optional
    tip_deviation : float, optional
        How far the tip may leave the curve between knots, in the length unit, as measured at seven places of every
        step; by default 3e-6 of the mean length of the segments. The smaller, the more knots.
    time : float
        Budget of each knot in seconds; a knot is one solve, from the shape that was fitted.
    clearance, self_clearance : float or array_like (n,), optional
        Distance from obstacles, and from itself, that the body has to keep; see `Robot`.

    Returns
    -------
    Motion
        Its time is the length of the curve that the tip has passed, from the base (of the line behind it, with joints).
        Its waypoints are the first knot and
        the last. It ends before the first knot that is not solved, with the status of that one.

    Raises
    ------
    InputError
        When the robot cannot change its length, the curve does not lead away from the base, or is shorter or longer
        than the robot can be.
    """
    begin = work_time()
    robot = SolveOptions(clearance=clearance, self_clearance=self_clearance).demanded_of(robot)
    path = curve_from_base(robot, curve)
    low, high = depths_of(robot)
    if robot.joints:
        low, high = path.lead, path.length
    if low == high:
        raise InputError("robot", "no segment stretches", robot, "an insertion stage (see on_stage), or such segments")
    slack = 1e-6 * robot.mean_length
    if not low < path.length <= high + slack:
        expected = f"more than {low:g} and at most {high:g} from the base, as long as the robot can be"
        raise InputError("curve", "", path.length, expected)
    allowed = TIP_DEVIATION * 0.5 * sum(depths_of(robot))
    if tip_deviation is not None:
        allowed = checks.number("tip_deviation", tip_deviation, above=0.0)
    body = robot.changed(tool=None)  # the tip is led, not the tool
    solver = Solver(body, scene, tolerance=Tolerance(EXACT * robot.mean_length), max_starts=1, routes=False, time=time)
    leader = _Leader(robot, path, solver, low, min(path.length, high))
    return leader.motion(allowed, begin)


def curve_from_base(robot: Robot, curve: Rows | Curve | Solution) -> Curve:
    """Return the curve from the base on, with a straight line to where it begins.

    Raises
    ------
    InputError
        When it leads elsewhere than the base does.
    """
    path = line_in_front(robot, _backbone(curve) if isinstance(curve, Solution) else curve)
    if robot.joints:
        return path
    axis, onward = robot.base[:3, 2], path.tangent(0.0)
    if float(onward @ axis) < np.cos(FORWARD):
        expected = f"a curve that begins along the axis of the base, {axis.round(3).tolist()} from its position"
        raise InputError("curve", "leads elsewhere", onward.round(3).tolist(), expected)
    return path


def _backbone(solution: Solution) -> Floats:
    """Points (k, 3) of a body, under load of the loaded one, without those where a segment has no length."""
    robot = solution.problem.robot
    body, arcs = bodies_at(robot, solution.configuration[None])
    points = body.backbone(arcs[0], SAMPLES)[body.drive.before * SAMPLES :]
    if robot.joints:  # where the first segment begins is not among the samples of joints and links
        points[0] = body.forward(arcs[0])[body.drive.before - 1, :3, 3]
    apart = np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-9 * robot.mean_length
    return points[np.append(True, apart)]


class _Leader:
    """Knots of one motion, while they are found."""

    def __init__(self, robot: Robot, path: Curve, solver: Solver, low: float, end: float) -> None:
        self.robot, self.path, self.solver = robot, path, solver
        bending = [s.length[1] for s in robot.segments if s.max_bend > 0.0 and s.length[1] > 0.0]
        count = np.clip(int(FITTED * (end - low) / min(bending, default=end)), LEAST_FITTED, MOST_FITTED)
        self.depths = np.linspace(low, end, int(count) + 1)
        self.unbounded = robot.has_external_load and not bounded(robot)  # shorter steps are no more than sampled then
        self.ended: Solution | None = None
        self.answers: dict[tuple[float, float], Floats] = {}
        self.off: dict[tuple[float, float], float] = {}

    def motion(self, allowed: float, begin: float) -> Motion:
        """Find knots until the tip keeps to the curve and all steps are proved, or cannot be."""
        from scipy.interpolate import CubicSpline  # noqa: PLC0415

        self.shapes = CubicSpline(
            self.depths, fit_chains_along(self.robot, self.path, self.depths, None, self.solver.scene)
        )
        self.depths, self.q, self.clear, first = self._solved(self.depths, self.shapes(self.depths))
        for _ in range(TIP_ROUNDS):
            counts = np.ceil(np.sqrt(self._off() / allowed)).astype(np.intp)
            if not self._divide(np.maximum(counts, 1)):
                break
        scene = self.solver.scene.snapshot()
        prover = Prover(self.robot, scene, FINEST)
        for _ in range(ROUNDS):
            steps = self._proved(prover)
            if not self._divide(np.where(steps.proved | (steps.samples > 0) & self.unbounded, 1, DIVIDED)):
                break
        else:
            steps = self._proved(prover)
        return self._put_together(scene, steps, first, work_time() - begin)

    def _solved(self, depths: Floats, near: Floats) -> tuple[Floats, Floats, Floats, Solutions]:
        """Put the tip on the curve at these depths, near these shapes (t, n, 3).

        Those from the first on where that cannot be are left out. Returns depths (t,), configurations (t, n, 3), their
        clearances (t, 2) as `Prover` takes them, and all solutions.
        """
        found = self.solver.solve_many(positions=self.path.at(depths), initial=near, workers=1)
        clear = np.stack([found.clearance, found.self_clearance], axis=1) - self.robot._least_clearances
        clear[np.isnan(clear)] = math.inf  # nothing to be clear of: all that are kept are solved
        failed = np.flatnonzero(~found.solved)
        kept = len(depths)
        if len(failed):
            kept = int(failed[0])
            self.ended = found[kept]
        q = found.configuration[:kept].copy()  # in one piece, and writable: proofs are compiled for such arrays alone
        return depths[:kept], q, clear[:kept], found

    def _off(self) -> Floats:
        """How far the tip is off the curve at `TIP_SAMPLES` places of every step, at most (t - 1,)."""
        ends = list(pairwise(self.depths.tolist()))
        new = np.array([i for i, step in enumerate(ends) if step not in self.off], np.intp)
        shares = (np.arange(1, TIP_SAMPLES + 1) / (TIP_SAMPLES + 1.0))[:, None, None, None]
        between = (1.0 - shares) * self.q[new] + shares * self.q[new + 1]
        body, arcs = bodies_at(self.solver.robot, between.reshape(-1, *self.q.shape[1:]))
        tips = body.tip(arcs)[..., :3, 3]
        off = self.path.distance(tips.reshape(-1, 3)).reshape(TIP_SAMPLES, -1).max(axis=0)
        self.off.update(zip([ends[i] for i in new], off.tolist(), strict=True))
        return np.array([self.off[step] for step in ends])

    def _divide(self, counts: np.ndarray) -> bool:
        """Divide every step into so many (t - 1,); returns False where there is nothing to divide."""
        more = int(counts.sum()) - len(counts)
        if more == 0 or len(self.depths) + more > MOST_KNOTS:
            return False
        shares = np.concatenate([i + np.arange(1, count) / count for i, count in enumerate(counts) if count > 1])
        depths = np.interp(shares, np.arange(len(self.depths)), self.depths)
        new, q, clear, _ = self._solved(depths, self._between(depths))
        end = self.depths[-1] if len(new) == len(depths) else depths[len(new)]
        kept = self.depths <= end
        order = np.argsort(np.concatenate([self.depths[kept], new]), kind="stable")
        self.depths = np.concatenate([self.depths[kept], new])[order]
        self.q = np.concatenate([self.q[kept], q])[order]
        self.clear = np.concatenate([self.clear[kept], clear])[order]
        return True

    def _between(self, depths: Floats) -> Floats:
        """Shapes (t, n, 3) to begin from at other depths: fitted, and as far aside of that as knots have been led."""
        led = (self.q - self.shapes(self.depths)).reshape(len(self.q), -1)
        aside = np.stack([np.interp(depths, self.depths, column) for column in led.T], axis=-1)
        return self.shapes(depths) + aside.reshape(-1, *self.q.shape[1:])

    def _proved(self, prover: Prover) -> Steps:
        """Prove all steps; what was found of one before is kept."""
        ends = list(pairwise(self.depths.tolist()))
        for i, step in enumerate(ends):
            if step not in self.answers:
                pair = slice(i, i + 2)
                self.answers[step] = prover.prove(self.q[pair], SLACK, SECONDS, known=self.clear[pair])[0]
        answers = np.array([self.answers[step] for step in ends]) if ends else unproved(0)
        return Steps(answers, self.robot._least_clearances)

    def _put_together(self, scene: Snapshot, steps: Steps, first: Solutions, seconds: float) -> Motion:
        last = first[-1] if self.ended is None else self.ended
        some = len(self.q) > 0
        report = Report(
            solutions=(first[0], last) if some else (last,),
            waypoint_knots=(0, len(self.q) - 1 if self.ended is None else None) if some else (None,),
            seconds=seconds,
        )
        return Motion.made(self.robot, scene, self.q, self.depths, steps, report)
