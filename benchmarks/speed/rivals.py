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

from collections.abc import Callable, Iterator
from contextlib import suppress
from time import perf_counter
from typing import Any

import casadi
import numpy as np
from scipy.optimize import least_squares

import sinuous as sn
from benchmarks.harness import Goal, Line, Plan, Times, timed
from benchmarks.problems import ProblemSet, arm, reachable
from sinuous.base.checks import Floats
from sinuous.kernels.chain import batch
from sinuous.kernels.compile import entry
from sinuous.kernels.packing import pose_row
from sinuous.kernels.solve.starts import put_single_arc

MOST_STEPS = 300

BLOCK = 10
"""Problems that a solver gets at a time."""

SECTION = (
    "against others: 5 segments, position and direction, to 1e-6 of the length and 1e-6 rad, medians over solved ones"
)

Solve = Callable[[sn.Target], tuple[Floats, float]]
"""From a target to the configuration (n, 3) where a solver ended, and the seconds that it took."""


def start_of(robot: sn.Robot, target: sn.Target) -> Floats:
    """Return the single arc to the target (3 n,), where every method of a comparison begins."""
    q, frames = np.empty((len(robot), 3)), np.tile(pose_row(robot.base), (len(robot) + 1, 1))
    _arc(robot.limits.copy(), frames, len(robot) - 1, np.array(target.position), q)
    return q.ravel()


@entry
def _arc(limits: Floats, frames: Floats, tip: int, goal: Floats, q: Floats) -> None:
    put_single_arc(limits, frames, tip, (goal[0], goal[1], goal[2]), q)


def _bounds(robot: sn.Robot) -> tuple[Floats, Floats]:
    """Lower and upper bounds (3 n,) of a configuration's components."""
    lower = [(-segment.max_bend, -segment.max_bend, segment.length[0]) for segment in robot.segments]
    upper = [(segment.max_bend, segment.max_bend, segment.length[1]) for segment in robot.segments]
    return np.ravel(lower), np.ravel(upper)


class _Met(Exception):  # noqa: N818 - good news, no error
    """The configuration is within tolerance."""


def by_least_squares(problems: ProblemSet, dogbox: bool = False) -> Solve:
    """Prepare SciPy's trust region methods with bounds: `dogbox`, or else `trf`."""
    robot, n, unit = problems.robot, len(problems.robot), problems.robot.mean_length
    options: dict[str, Any] = {"method": "dogbox"}
    if not dogbox:
        options = {"method": "trf", "tr_solver": "lsmr", "x_scale": np.tile([1.0, 1.0, unit / n], n)}
    options |= {"ftol": 1e-15, "xtol": 1e-15, "gtol": 1e-15, "max_nfev": MOST_STEPS}
    base, tool, limits, (lower, upper) = pose_row(robot.base), pose_row(robot.tool), robot.limits.copy(), _bounds(robot)
    allowed, ended = (problems.tolerance.position or 0.0, problems.tolerance.angle), np.empty(3 * n)
    frames, columns, twists = np.empty((1, n + 1, 12)), np.empty((n, 18)), np.zeros((1, 6, 3 * n))

    def forward(x: Floats) -> Floats:
        batch.frames_of(limits, x.reshape(1, -1, 3), base, frames)
        tip: Floats = frames[0, -1]
        return tip

    def residual(x: Floats, position: Floats, direction: Floats) -> Floats:
        tip = forward(x)
        miss, lean = tip[9:] - position, tip[2:9:3] - direction
        ended[:] = x
        if miss @ miss <= allowed[0] ** 2 and lean @ lean <= allowed[1] ** 2:
            raise _Met
        return np.concatenate([miss / unit, lean])

    def jacobian(x: Floats, position: Floats, direction: Floats) -> Floats:
        zx, zy, zz = forward(x)[2:9:3].tolist()
        batch.jacobians_of(limits, x.reshape(1, -1, 3), frames, tool, n - 1, columns, twists)
        minus_cross = np.array([[0.0, zz, -zy], [-zz, 0.0, zx], [zy, -zx, 0.0]])
        return np.concatenate([twists[0, 3:] / unit, minus_cross @ twists[0, :3]])

    def solve(target: sn.Target) -> tuple[Floats, float]:
        start = np.clip(start_of(robot, target), lower, upper)
        goal = np.array(target.position), np.array(target.direction)
        began = perf_counter()
        with suppress(_Met):
            least_squares(residual, start, jacobian, (lower, upper), args=goal, **options)
        return ended.reshape(-1, 3).copy(), perf_counter() - began

    return solve


def by_ipopt(problems: ProblemSet, equalities: bool = False) -> Solve:
    """Prepare the interior point method, with the residual as constraints (`equalities`), or as the objective."""
    robot, n = problems.robot, len(problems.robot)
    x, goal = casadi.SX.sym("x", 3 * n), casadi.SX.sym("goal", 6)
    rotation, position = symbolic_tip(robot, x)
    residual = casadi.vertcat((position - goal[:3]) / robot.mean_length, rotation[:, 2] - goal[3:])
    held = [residual] if equalities else []
    bends = [x[3 * k] ** 2 + x[3 * k + 1] ** 2 for k in range(n)]
    objective = 0 if equalities else 0.5 * casadi.sumsqr(residual)
    # The tolerance of the objective is one of its gradient: below 1e-8, answers are within 1e-6 of the target.
    quiet: Any = {"print_level": 0, "sb": "yes", "max_iter": MOST_STEPS, "tol": 3e-7 if equalities else 1e-8}
    program = {"x": x, "p": goal, "f": objective, "g": casadi.vertcat(*bends, *held)}
    run: Any = casadi.nlpsol("ik", "ipopt", program, {"ipopt": quiet, "print_time": False})
    (lower, upper), zeros = _bounds(robot), [0.0] * (6 if equalities else 0)
    caps = [segment.max_bend**2 for segment in robot.segments]
    limits: dict[str, Any] = {"lbx": lower, "ubx": upper, "lbg": [0.0] * n + zeros, "ubg": caps + zeros}

    def solve(target: sn.Target) -> tuple[Floats, float]:
        start, asked = start_of(robot, target), np.concatenate([np.array(target.position), np.array(target.direction)])
        answer, seconds = timed(run, x0=start, p=asked, **limits)
        return np.array(answer["x"]).reshape(-1, 3), seconds

    return solve


def symbolic_tip(robot: sn.Robot, x: Any) -> tuple[Any, Any]:
    """Rotation and position of the tip, as expressions in the configuration."""
    rotation, position = casadi.SX(robot.base[:3, :3]), casadi.SX(robot.base[:3, 3])
    for k in range(len(robot)):
        bend_x, bend_y, length = x[3 * k], x[3 * k + 1], x[3 * k + 2]
        w = casadi.skew(casadi.vertcat(-bend_y, bend_x, 0))
        angle = casadi.sqrt(bend_x**2 + bend_y**2 + 1e-16)  # never 0, where derivatives have none
        s, g = casadi.sin(angle) / angle, (1.0 - casadi.cos(angle)) / angle**2
        position = position + rotation @ (length * casadi.vertcat(g * bend_x, g * bend_y, s))
        rotation = rotation @ (casadi.SX.eye(3) + s * w + g * (w @ w))
    return rotation, position


def ours(problems: ProblemSet) -> Solve:
    """Prepare `Solver.solve`, called like the others."""
    solver = sn.Solver(problems.robot, tolerance=problems.tolerance)

    def solve(target: sn.Target) -> tuple[Floats, float]:
        solution, seconds = timed(solver.solve, target)
        return solution.q, seconds

    return solve


def measure(plan: Plan) -> Iterator[Line]:
    """Every solver on a few problems, then on the next few: a busy machine is equally unfair to all.

    Not one problem each in turn: then ours would run from cold caches, which cost it more than all of its arithmetic.
    """
    problems = reachable(arm(5, 2.4), plan.count(300, 10), plan.rng(5)).within(1e-6)
    solvers: dict[str, tuple[Solve, float]] = {
        "ours": (ours(problems), 1.0),
        "SciPy least_squares, trf": (by_least_squares(problems), 50.0),
        "SciPy least_squares, dogbox": (by_least_squares(problems, dogbox=True), 50.0),
        "IPOPT, least squares": (by_ipopt(problems), 500.0),
        "IPOPT, equalities": (by_ipopt(problems, equalities=True), 500.0),
    }
    found: dict[str, list[tuple[Floats, float]]] = {name: [] for name in solvers}
    blocks = [problems.targets[i : i + BLOCK] for i in range(0, len(problems.targets), BLOCK)]
    for block in blocks:
        for name, (solve, _) in solvers.items():
            solve(block[0])
            found[name] += [solve(target) for target in block]
    best = np.nan
    for name, (_, factor) in solvers.items():
        good = problems.right(np.array([q for q, _ in found[name]]))
        seconds = np.array([seconds for _, seconds in found[name]])[good]
        times = Times.of(seconds) if good.any() else Times(0, *[np.nan] * 4)
        tally = int(good.sum()), len(good)
        if name == "ours":
            best = times.median
            yield Line(SECTION, name, best, "us", None, times, tally)
        else:
            goal = Goal(factor, at_most=False)
            yield Line(SECTION, f"ours faster than {name}", times.median / best, "x", goal, times, tally)
