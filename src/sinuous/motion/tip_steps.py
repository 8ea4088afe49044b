"""Steps on which the tip stays near its line, each proved: from one knot straight to where the next targets are met."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sinuous.answer.solution import Solution
from sinuous.base.checks import Floats
from sinuous.motion.departure import TURNED
from sinuous.motion.knots import Knot, TipLine
from sinuous.motion.timetable import Timetable
from sinuous.problem.target import Target
from sinuous.solver.certificates.steps import Prover, is_passable, load_motions
from sinuous.solver.certificates.tip import Tip
from sinuous.solver.solver import Solver

SLACK = 0.5
"""How far below the true clearance its proved bound may be, as a share of it: close to obstacles more takes longer."""

SHORTEST = 1.0 / 64.0
"""Share of the way between two waypoints below which steps are not halved."""

NEARLY = 0.95
"""Share of the angle by which the tip may be turned at places of a step: between them it may be more."""


class TipSteps:
    """Makes steps, and proves them in the scene as it was when the last solution was found.

    Parameters
    ----------
    solver : Solver
        Of the waypoints.
    deviation : float
        How far the tip may be from its line (length unit).
    timetable : Timetable, optional
        Where obstacles move: its live scene is that of the solver.

    Attributes
    ----------
    solver : Solver
    deviation : float
    prover : Prover
    meets : int
        How many solves were made between waypoints.
    """

    def __init__(self, solver: Solver, deviation: float, timetable: Timetable | None = None) -> None:
        scene = solver.scene.snapshot() if timetable is None else timetable.scene
        load_motions(solver.robot, scene)
        self.solver, self.deviation = solver, deviation
        self.prover = Prover(solver.robot, scene)
        self.meets = 0
        self._timetable = timetable
        self._follows: Solver | None = None
        self._ends, self._known = np.empty((2, len(solver.robot), 3)), np.empty((2, 2))
        self._tip = Tip(solver.robot)

    @property
    def follower(self) -> Solver:
        """The solver for what lies between waypoints: it goes on from where the robot is, or not at all."""
        if self._follows is None:
            options = replace(self.solver.options, max_starts=1, routes=False)
            self._follows = Solver._of_checked(self.solver.robot, self.solver.scene, options)
        return self._follows

    def take_scene_of(self, solution: Solution) -> bool:
        """Prove from now on in the scene that a solution was found in; say whether that is another one."""
        if self._timetable is not None or self.prover.scene is solution.problem.scene:
            return False
        self.prover = Prover(self.solver.robot, solution.problem.scene)
        return True

    def meet(self, targets: Sequence[Target] | Target, begin: Solution | Floats) -> Solution | None:
        """Meet targets from a configuration beside them; `None` where that fails."""
        self.meets += 1
        found = self.follower.solve(targets if isinstance(targets, Target) else list(targets), begin)
        return found if found.solved else None

    def lead(
        self,
        before: Knot,
        solution: Solution,
        line: TipLine | None,
        shares: tuple[float, float] = (0.0, 1.0),
        end: float = 0.0,
    ) -> list[Knot] | None:
        """Lead the tip straight to targets that a solution meets, in smaller steps where one is not proved.

        Parameters
        ----------
        before : Knot
            Where the robot is.
        solution : Solution
            Where smaller steps come to another one, that is the one of the last knot.
        line : TipLine or None
        shares : (float, float)
            The part of the line, perhaps backwards.
        end : float
            When the robot is there, where obstacles move; it goes on evenly in time.

        Returns
        -------
        list of Knot or None
            Those after `before`; `None` where the tip cannot go straight.
        """
        goal, (first, last), begin = solution.problem.targets, shares, before.time
        knots: list[Knot] = []
        done, step, begun = 0.0, 1.0, first
        while done < 1.0:
            part = min(1.0, done + step)
            share, when = first + part * (last - first) if part < 1.0 else last, (1.0 - part) * begin + part * end
            found: Solution | None = solution
            if line is not None and (part < 1.0 or done > 0.0):
                if self._timetable is not None:
                    self._timetable.set_time(when)
                found = self.meet(line.at(share) if part < 1.0 else goal, before.begin)
            knot = None if found is None else self.step(before, found, line, (begun, share), when)
            if knot is not None:
                before = knot
                knots.append(knot)
                done, begun, step = part, share, min(2.0 * step, 1.0)
            elif line is None or step <= SHORTEST:
                return None
            else:
                step *= 0.5
        return knots

    def step(
        self, before: Knot, found: Solution, line: TipLine | None, shares: tuple[float, float], when: float = 0.0
    ) -> Knot | None:
        """Return the knot at a solution with the proof of the step that leads there; `None` where it is not proved."""
        self.take_scene_of(found)
        knot = Knot(found.configuration, None, found.problem.targets, found, line, shares, time=when)
        proof = self.prove(before, knot)
        return None if proof is None else knot._replace(proof=proof)

    def prove(self, before: Knot, knot: Knot) -> Floats | None:
        """Return what is proved of a step that stays near enough to the line and is clear; `None` of any other."""
        ends, times = self.two(before.q, knot.q), None
        if knot.line is not None:
            knot.line.draw(knot.shares, self._tip.line)
            if self._tip.deviation(ends, self.deviation) > self.deviation or self._turns(knot.line, ends):
                return None
        self._known[0], self._known[1] = self._clear(before), self._clear(knot)
        if self._timetable is not None:
            times = np.array([before.time, knot.time])
        proof = self.prover.prove(ends, SLACK, times=times, known=self._known)
        return proof if is_passable(proof[0]) else None

    def _turns(self, line: TipLine, ends: Floats) -> bool:
        """Whether the tip is seen to turn away from its line between two configurations (2, n, 3)."""
        if not line.oriented:
            return False
        line.draw((0.0, 1.0), self._tip.line)
        return self._tip.angle(ends, line.turn_rows) > NEARLY * TURNED * self.solver.tolerance.angle

    def two(self, q0: Floats, q1: Floats) -> Floats:
        """Put two configurations into one array (2, n, 3), always the same."""
        self._ends[0], self._ends[1] = q0, q1
        return self._ends

    def _clear(self, knot: Knot) -> tuple[float, float]:
        """Proved clearance and self-clearance of a knot in the scene of now; 0 where they are not known."""
        current = (
            self._timetable is not None or knot.solution is None or self.prover.scene is knot.solution.problem.scene
        )
        return knot.clear if current else (0.0, 0.0)
