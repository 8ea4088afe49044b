"""The options of a solver, kept by its solutions, so that they can solve again."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from sinuous.checks import Floats
from sinuous.methods import registry
from sinuous.problem.problem import Problem
from sinuous.robot.rates import Changes
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.solution.solution import Solution
from sinuous.solving.options import SolveOptions

if TYPE_CHECKING:
    from sinuous.solving.solver import Solver


@dataclass(frozen=True)
class Again:
    """See `sinuous.solution.resolver.ReSolver`.

    Attributes
    ----------
    prepare : callable
        Makes a solver of a robot, a scene and options.
    options : SolveOptions
    """

    prepare: "Callable[[Robot, Scene, SolveOptions], Solver]"
    options: SolveOptions

    @property
    def method(self) -> str:
        """Name of the method."""
        return registry.name_of(self.options.method)

    @property
    def seed(self) -> int:
        """Of the scattered starts."""
        return self.options.seed

    @property
    def seconds(self) -> float:
        """Budget of a solve."""
        return self.options.time

    @property
    def max_starts(self) -> int:
        """Most starts of a solve."""
        return self.options.max_starts

    def solve(
        self, problem: Problem, initial: Floats | None = None, within: Changes | None = None, **options: Any
    ) -> Solution:
        """Solve a problem; `options` replace those of the earlier solve."""
        chosen = replace(self.options, tolerance=problem.tolerance, **options)
        solver = self.prepare(problem.robot, Scene.of(problem.scene), chosen)
        return solver.solve(problem.targets, initial, within=within)
