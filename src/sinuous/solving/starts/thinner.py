"""Starts from thinner bodies: where a thin body finds a way, it is led on while it grows as thick as it is.

A tight place has few shapes for the body, and more for a thinner one: free space is dilated (Hsu et al. 2006). What
solves it there is near to what solves it here, mostly, and each step of growing begins from the one before.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from sinuous.checks import Floats
from sinuous.kernels.tables import ROUTE, SOURCES
from sinuous.problem.preferences import Preferences
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.solution.solution import Solution
from sinuous.solving.options import SolveOptions
from sinuous.solving.starts.among import A_START
from sinuous.solving.starts.sources import Batch, Question, Source

if TYPE_CHECKING:
    from sinuous.solving.solver import Solver

SHARES = ((0.7, 60), (0.5, 150))
"""Of the radii, those with which it begins; and what routes have cost before, in scattered starts."""

OF_TIME = 0.5
"""Of the time that is left, what one of them may take: routes that come later may be better."""

STARTS = 300
"""Most starts of such a solve."""

STEPS, HALVINGS = 6, 3
"""Steps in which a body grows, and how often one of them is halved that does not succeed."""


class Thinner:
    """The start source of routes, and of bodies that grow, where routes alone have not led to a solution for long.

    Parameters
    ----------
    routes : Source
    robot : Robot
    options : SolveOptions
    prepare : callable
        Makes a solver that does not ask this source, of a robot, a scene and options.
    """

    name = SOURCES[ROUTE]

    def __init__(
        self,
        routes: Source,
        robot: Robot,
        options: SolveOptions,
        prepare: "Callable[[Robot, Scene, SolveOptions], Solver]",
    ) -> None:
        self._routes, self._robot, self._prepare = routes, robot, prepare
        self._options = replace(options, prefer=Preferences(), max_starts=min(STARTS, options.max_starts))

    def batches(self, question: Question) -> Iterator[Batch]:
        """Yield all batches of routes, and between them or after them a configuration for each share."""
        due, cost, known = [] if question.several or not any(self._robot.radii) else list(SHARES), 0, False
        for batch in self._routes.batches(question):
            yield batch
            cost += batch.then + A_START * len(batch.initial)
            known = known or len(batch.initial) > 0
            while due and known and cost >= due[0][1]:
                yield from self._begun(question, due.pop(0)[0])
        for share, _ in due:
            yield from self._begun(question, share)

    def _begun(self, question: Question, share: float) -> Iterator[Batch]:
        """Yield the configuration of a body that began with a share of its radii, grown as far as that went."""
        later = (1.0 - OF_TIME) * question.seconds_left()
        question = question._replace(seconds_left=partial(_sooner, question.seconds_left, later))
        thin = self._solved(question, share, self._options, None)
        if thin is not None:
            routes = () if thin.route is None else (thin.route,)
            yield Batch(self.name, self._grown(question, share, thin.q)[None].copy(), routes=routes)

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
