"""Radius continuation: where a thinner body finds a way, it is led on while it grows as thick as the robot is.

A tight place has few shapes for the body, and more for a thinner one: free space is dilated (Hsu et al. 2006). What
solves it there is near to what solves it here, mostly, and each step of growing begins from the one before.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Protocol

from sinuous.checks import Floats
from sinuous.kernels.tables import ROUTE, SOURCES
from sinuous.problem.preferences import Preferences
from sinuous.problem.target import Targets
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.solution.solution import Solution
from sinuous.solving.options import SolveOptions
from sinuous.solving.starts import Batch, Question

OF_TIME = 0.5
"""Of the time that is left, what one of them may take: routes that come later may be better."""

STARTS = 300
"""Most starts of such a solve."""

STEPS, HALVINGS = 6, 3
"""Steps in which a body grows, and how often one of them is halved that does not succeed."""


class Solves(Protocol):
    """A solver."""

    def solve(self, target: Targets, initial: Floats | None = None, *, time: float) -> Solution:
        """Solve from a configuration (n, 3)."""
        ...


Prepare = Callable[[Robot, Scene, SolveOptions], Solves]
"""Makes a solver."""


class Thinner:
    """What solves the problem for thinner bodies, and lets them grow.

    Parameters
    ----------
    robot : Robot
    options : SolveOptions
    prepare : callable
        Makes a solver of a robot, a scene and options.
    """

    def __init__(self, robot: Robot, options: SolveOptions, prepare: Prepare) -> None:
        self._robot, self._whole, self._prepare = robot, options, prepare

    @property
    def _options(self) -> SolveOptions:
        """The options of a thinner body."""
        without, most = (*self._whole.without, "thinner"), min(STARTS, self._whole.most_starts)
        return replace(self._whole, prefer=Preferences(), max_starts=most, without=without)

    def begun(self, question: Question, share: float) -> Iterator[Batch]:
        """Yield the configuration of a body that began with a share of its radii, grown as far as that went."""
        if not any(self._robot.radii):
            return
        later = (1.0 - OF_TIME) * question.seconds_left()
        question = question._replace(seconds_left=partial(_sooner, question.seconds_left, later))
        thin = self._solved(question, share, self._options, None)
        if thin is not None:
            routes = () if thin.route is None else (thin.route,)
            yield Batch(SOURCES[ROUTE], self._grown(question, share, thin.q)[None].copy(), routes=routes)

    def _grown(self, question: Question, share: float, q: Floats) -> Floats:
        """Let a body grow from a share of its radii; return its configuration (n, 3) when it was thickest."""
        alone = replace(self._options, routes=False, max_starts=1)
        whole = step = (1.0 - share) / STEPS
        while share + step < 1.0 and step > whole * 0.5 ** (HALVINGS + 0.5):
            thicker = self._solved(question, share + step, alone, q)
            if thicker is None:
                step *= 0.5
            else:
                q, share = thicker.q, share + step
        return q

    def _solved(self, question: Question, share: float, options: SolveOptions, begin: Floats | None) -> Solution | None:
        """Return a solution of a robot with a share of the radii; `None` where there is none, or no time."""
        if question.seconds_left() <= 0.0:
            return None
        solver = self._prepare(with_radii(self._robot, share), Scene.of(question.problem.scene), options)
        solution = solver.solve(question.problem.targets, begin, time=max(0.0, question.seconds_left()))
        return solution if solution.solved else None


def with_radii(robot: Robot, share: float) -> Robot:
    """Return a robot whose segments have a share of their radii, less or more than all of it."""
    return robot.changed(segments=[segment.changed(radius=share * segment.radius) for segment in robot.segments])


def _sooner(seconds_left: Callable[[], float], by: float) -> float:
    return seconds_left() - by
