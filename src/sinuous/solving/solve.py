"""One question, answered at once: a solver is prepared for it, and forgotten."""

from typing import Unpack

from sinuous.arguments import Number, Whole
from sinuous.problem.target import Targets
from sinuous.robot.robot import Robot
from sinuous.scene.scene import SceneLike
from sinuous.solution.solution import Solution
from sinuous.solving.options import SolveArguments
from sinuous.solving.several import Kind
from sinuous.solving.solver import Initial, Solver


def solve(
    robot: Robot,
    target: Targets,
    scene: SceneLike | None = None,
    *,
    initial: Initial | None = None,
    **options: Unpack[SolveArguments],
) -> Solution:
    """Find a configuration of `robot` that meets `target` in `scene`; parameters as for `Solver` and `Solver.solve`."""
    return Solver.once(robot, scene, **options).solve(target, initial)


def solve_all(
    robot: Robot,
    target: Targets,
    scene: SceneLike | None = None,
    *,
    initial: Initial | None = None,
    count: Whole = 8,
    apart: Number = 0.02,
    by: Kind | None = None,
    **options: Unpack[SolveArguments],
) -> list[Solution]:
    """Find several solutions, ranked: by route or by shape; parameters as for `Solver` and `Solver.solve_all`."""
    return Solver(robot, scene, **options).solve_all(target, initial, count=count, apart=apart, by=by)
