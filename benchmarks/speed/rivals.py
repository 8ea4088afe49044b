"""How much faster than what everybody has at hand: SciPy's `least_squares`, and IPOPT by way of casadi, in turns.

All drive the same residual to zero: the tip's position over the robot's mean length, and its direction. (Ours writes
the direction as a rotation vector, these as a difference of unit vectors, equal to first order, with a simple exact
derivative.) All begin at the single arc to the target, and the peers are helped where they can be:

- `least_squares` gets residual and analytic Jacobian from our compiled kernels, and is stopped by an exception at the
  first configuration within tolerance. Its bounds are boxes, so bends are bounded in each component. It runs twice:
  `trf` with the options that solved most (lsmr, lengths scaled), and `dogbox`, which is faster and solves less.
- IPOPT gets exact first and second derivatives and keeps lengths as bounds, bends as constraints. It is stated twice:
  half the square of the residual as the objective, and the residual as equality constraints without an objective.

Of the options that were tried the fastest are set. Building a problem and reading out an answer are outside of all
times.
"""

import contextlib
from collections.abc import Iterator
from time import perf_counter
from typing import Any, Protocol

import casadi
import numpy as np
from scipy.optimize import least_squares

import sinuous as sn
from benchmarks.harness.experiment import Plan
from benchmarks.harness.lines import Goal, Line, Times
from benchmarks.judges.judge import Flags
from benchmarks.problems import ProblemSet, arm, reachable, relative_tolerance
from sinuous.base.checks import Floats
from sinuous.kernels.chain import batch
from sinuous.kernels.compile import entry
from sinuous.kernels.packing import pose_row
from sinuous.kernels.solve.starts import single_arc

MOST_STEPS = 300


class Peer(Protocol):
    """Somebody else's solver, prepared for one robot without obstacles."""

    def solve(self, target: sn.Target) -> tuple[Floats, float]:
        """Return the configuration (n, 3) where it ended, and the seconds that it took."""
        ...


def start_of(robot: sn.Robot, target: sn.Target) -> Floats:
    """Return the single arc to the target (3 n,), where every method of a comparison begins."""
    q, frames = np.empty((len(robot), 3)), np.tile(pose_row(robot.base), (len(robot) + 1, 1))
    _arc(robot.limits.copy(), frames, len(robot) - 1, np.array(target.position), q)
    return q.ravel()


@entry
def _arc(limits: Floats, frames: Floats, tip: int, goal: Floats, q: Floats) -> None:
    single_arc(limits, frames, tip, (goal[0], goal[1], goal[2]), q)


def _bounds(robot: sn.Robot) -> tuple[Floats, Floats]:
    """Lower and upper bounds (3 n,) of a configuration's components."""
    lower = [(-segment.max_bend, -segment.max_bend, segment.length[0]) for segment in robot.segments]
    upper = [(segment.max_bend, segment.max_bend, segment.length[1]) for segment in robot.segments]
    return np.ravel(lower), np.ravel(upper)


class _Met(Exception):  # noqa: N818 - good news, no error
    """The configuration is within tolerance."""


class LeastSquares:
    """SciPy's trust region methods with bounds.

    Parameters
    ----------
    problems : ProblemSet
    dogbox : bool
        Whether to use `dogbox`, not `trf`.
    """

    def __init__(self, problems: ProblemSet, dogbox: bool = False) -> None:
        robot = problems.robot
        scale = np.tile([1.0, 1.0, robot.mean_length / len(robot)], len(robot))
        self._options: dict[str, Any] = (
            {"method": "dogbox"} if dogbox else {"method": "trf", "tr_solver": "lsmr", "x_scale": scale}
        )
        self._robot, self._unit = robot, robot.mean_length
        self._base, self._tool, self._limits = pose_row(robot.base), pose_row(robot.tool), robot.limits.copy()
        self._allowed = problems.tolerance.position or 0.0, problems.tolerance.angle
        self._frames = np.empty((1, len(robot) + 1, 12))
        self._columns = np.empty((len(robot), 18))
        self._twists = np.zeros((1, 6, 3 * len(robot)))
        self._last = np.empty(3 * len(robot))

    def solve(self, target: sn.Target) -> tuple[Floats, float]:
        """Return the configuration (n, 3) where it ended, and the seconds that it took."""
        lower, upper = _bounds(self._robot)
        start = np.clip(start_of(self._robot, target), lower, upper)
        goal = np.array(target.position), np.array(target.direction)
        began = perf_counter()
        with contextlib.suppress(_Met):
            least_squares(
                self._residual,
                start,
                self._jacobian,
                (lower, upper),
                ftol=1e-15,
                xtol=1e-15,
                gtol=1e-15,
                max_nfev=MOST_STEPS,
                args=goal,
                **self._options,
            )
        return self._last.reshape(-1, 3).copy(), perf_counter() - began

    def _residual(self, x: Floats, position: Floats, direction: Floats) -> Floats:
        tip = self._forward(x)
        miss, lean = tip[9:] - position, tip[2:9:3] - direction
        self._last = x
        if miss @ miss <= self._allowed[0] ** 2 and lean @ lean <= self._allowed[1] ** 2:
            raise _Met
        return np.concatenate([miss / self._unit, lean])

    def _jacobian(self, x: Floats, position: Floats, direction: Floats) -> Floats:
        zx, zy, zz = self._forward(x)[2:9:3].tolist()
        q = x.reshape(1, -1, 3)
        batch.jacobians_of(self._limits, q, self._frames, self._tool, len(self._robot) - 1, self._columns, self._twists)
        turn, move = self._twists[0, :3], self._twists[0, 3:]
        minus_cross = np.array([[0.0, zz, -zy], [-zz, 0.0, zx], [zy, -zx, 0.0]])
        return np.concatenate([move / self._unit, minus_cross @ turn])

    def _forward(self, x: Floats) -> Floats:
        batch.frames_of(self._limits, x.reshape(1, -1, 3), self._base, self._frames)
        tip: Floats = self._frames[0, -1]
        return tip


class Ipopt:
    """The interior point method.

    Parameters
    ----------
    problems : ProblemSet
    equalities : bool
        Whether the residual is stated as constraints, not as the objective.
    """

    def __init__(self, problems: ProblemSet, equalities: bool = False) -> None:
        robot = problems.robot
        self._robot = robot
        x, goal = casadi.SX.sym("x", 3 * len(robot)), casadi.SX.sym("goal", 6)
        rotation, position = symbolic_frames(robot, x, 1)[-1][-1]
        direction = rotation[:, 2]
        residual = casadi.vertcat((position - goal[:3]) / robot.mean_length, direction - goal[3:])
        bends = [x[3 * k] ** 2 + x[3 * k + 1] ** 2 for k in range(len(robot))]
        lower, upper = _bounds(robot)
        caps = [segment.max_bend**2 for segment in robot.segments]
        held = [residual] if equalities else []
        objective = 0 if equalities else 0.5 * casadi.sumsqr(residual)
        # The tolerance of the objective is one of its gradient: below 1e-8, answers are within 1e-6 of the target.
        quiet: Any = {"print_level": 0, "sb": "yes", "max_iter": MOST_STEPS, "tol": 3e-7 if equalities else 1e-8}
        program = {"x": x, "p": goal, "f": objective, "g": casadi.vertcat(*bends, *held)}
        self._run = casadi.nlpsol("ik", "ipopt", program, {"ipopt": quiet, "print_time": False})
        zeros = [0.0] * (6 if equalities else 0)
        self._limits: dict[str, Any] = {
            "lbx": lower,
            "ubx": upper,
            "lbg": [0.0] * len(robot) + zeros,
            "ubg": caps + zeros,
        }

    def solve(self, target: sn.Target) -> tuple[Floats, float]:
        """Return the configuration (n, 3) where it ended, and the seconds that it took."""
        start = start_of(self._robot, target)
        goal = np.concatenate([np.array(target.position), np.array(target.direction)])
        began = perf_counter()
        answer = self._run(x0=start, p=goal, **self._limits)
        seconds = perf_counter() - began
        return np.array(answer["x"]).reshape(-1, 3), seconds


def symbolic_frames(robot: sn.Robot, x: Any, places: int) -> list[list[tuple[Any, Any]]]:
    """Rotations and positions at `places` equal steps of each segment, as expressions in the configuration."""
    rotation, position = casadi.SX(robot.base[:3, :3]), casadi.SX(robot.base[:3, 3])
    found = []
    for k in range(len(robot)):
        bend_x, bend_y, length = x[3 * k], x[3 * k + 1], x[3 * k + 2]
        w = casadi.skew(casadi.vertcat(-bend_y, bend_x, 0))
        angle = casadi.sqrt(bend_x**2 + bend_y**2 + 1e-16)  # never 0, where derivatives have none
        segment = []
        for i in range(1, places + 1):
            part = i / places * angle
            s, g = casadi.sin(part) / angle, (1.0 - casadi.cos(part)) / angle**2
            move = length * casadi.vertcat(g * bend_x, g * bend_y, s)
            segment.append((rotation @ (casadi.SX.eye(3) + s * w + g * (w @ w)), position + rotation @ move))
        rotation, position = segment[-1]
        found.append(segment)
    return found


SECTION = (
    "against others: 5 segments, position and direction, to 1e-6 of the length and 1e-6 rad, medians over solved ones"
)
GOALS = {
    "SciPy least_squares, trf": Goal(50.0, at_most=False),
    "SciPy least_squares, dogbox": Goal(50.0, at_most=False),
    "IPOPT, least squares": Goal(500.0, at_most=False),
    "IPOPT, equalities": Goal(500.0, at_most=False),
}


BLOCK = 10
"""Problems that a solver gets at a time."""


class Ours:
    """`Solver.solve`, called like the others."""

    def __init__(self, problems: ProblemSet) -> None:
        self._solver = sn.Solver(problems.robot, tolerance=problems.tolerance)

    def solve(self, target: sn.Target) -> tuple[Floats, float]:
        """Return the configuration, and the seconds around the call."""
        began = perf_counter()
        q = self._solver.solve(target).q
        return q, perf_counter() - began


def measure(plan: Plan) -> Iterator[Line]:
    """Every solver on a few problems, then on the next few: a busy machine is equally unfair to all.

    Not one problem each in turn: then ours would run from cold caches, which cost it more than all of its arithmetic.
    """
    drawn = reachable(arm(5, 2.4), plan.count(300, 10), plan.rng(5))
    problems = drawn.with_tolerance(relative_tolerance(drawn.robot, 1e-6))
    solvers: dict[str, Peer] = {
        "ours": Ours(problems),
        "SciPy least_squares, trf": LeastSquares(problems),
        "SciPy least_squares, dogbox": LeastSquares(problems, dogbox=True),
        "IPOPT, least squares": Ipopt(problems),
        "IPOPT, equalities": Ipopt(problems, equalities=True),
    }
    q: dict[str, list[Floats]] = {name: [] for name in solvers}
    seconds: dict[str, list[float]] = {name: [] for name in solvers}
    targets = problems.targets
    blocks = [targets[i : i + BLOCK] for i in range(0, len(targets), BLOCK)]
    for block in plan.track(blocks, "against others", len(blocks)):
        for name, solver in solvers.items():
            solver.solve(block[0])
            for target in block:
                answer, spent = solver.solve(target)
                q[name].append(answer)
                seconds[name].append(spent)
    good = {name: problems.right(np.array(q[name])) for name in solvers}
    times = {name: _times(seconds[name], good[name]) for name in solvers}
    yield Line(SECTION, "ours", times["ours"].median, "us", None, times["ours"], _tally(good["ours"]))
    for name, goal in GOALS.items():
        ratio = times[name].median / times["ours"].median
        yield Line(SECTION, f"ours faster than {name}", ratio, "x", goal, times[name], _tally(good[name]))


def _times(seconds: list[float], good: Flags) -> Times:
    return Times.of(np.array(seconds)[good]) if good.any() else Times(0, *[float("nan")] * 4)


def _tally(good: Flags) -> tuple[int, int]:
    return int(good.sum()), len(good)
