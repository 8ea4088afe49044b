"""One control step of a robot under load, in compiled code: see `kernels.velocity.loaded`.

What is known of the body where a step ends is kept: that is where the next one begins. An equilibrium is always found
from the body without load, as `Robot.shape` finds it, so an answer does not depend on the steps before.
"""

import math
import threading
from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.progress import WORK_UNIT
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.certificate.query import CLEARANCES as OF_PROOF
from sinuous.kernels.certificate.query import UNTIL, VERDICT
from sinuous.kernels.certificate.sweep import CLEARANCES_WIDTH
from sinuous.kernels.statics import layout as s
from sinuous.kernels.velocity import layout as a
from sinuous.kernels.velocity import loaded as kernel
from sinuous.kernels.velocity import query as t
from sinuous.measures.body import nearest_meeting, segment_ends
from sinuous.model.robot import Robot
from sinuous.problem.problem import settings_group
from sinuous.problem.target import Tolerance
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.certificates.steps import SAMPLED, Prover
from sinuous.solver.step_query import RateLimits, StepQuery
from sinuous.statics.between import bounded
from sinuous.statics.body import body_of, lengths_of_lines
from sinuous.statics.equilibrium import longest_body
from sinuous.statics.rest import Rest, lines_that_follow, stretches_allowed

SAMPLES = 8
"""Places of an arc at which its gaps are measured where nothing is proved."""

SHY = 0.9
"""How much of what is proved is gone, where the rest is not."""

SHORTENINGS, HALVINGS = 8, 4
"""How often a way is shortened until all of it is proved; and how often, until it does not lead into a contact."""


CREEPS = 0.1, 0.01
"""Shares of a way that are tried where a first sixty-fourth of it cannot be proved: shorter ones bend less."""


_SCRATCH = threading.local()
"""The workspace of a thread, whoever needs it."""


class KnownShape(NamedTuple):
    """A body at rest: its drive (n, 3), at what lengths lines are held (t,), states (N, 4) and tensions (t,).

    States are NaN where it is to be found.
    """

    q: Floats
    held: Floats
    states: Floats
    tensions: Floats


def new_answer(q: Floats, room: int) -> Floats:
    """Room for an answer about a drive (n, 3), with so many constraints."""
    return np.zeros(t.CONFIGURATION + q.size + t.ACTIVE_WIDTH * room)


class LoadedControlStep:
    """Makes control steps of one robot under load in one scene.

    Parameters
    ----------
    robot : Robot
    scene : Snapshot
    tolerance : Tolerance
        With numbers, within which several steps end.

    Attributes
    ----------
    lines : tuple of Actuator
        The lines under load, as active constraints number them after the actuators that have a limit or a rate.
    """

    def __init__(self, robot: Robot, scene: Snapshot, tolerance: Tolerance) -> None:
        own = body_of(robot)
        self._robot, self.scene, self._own = robot, scene, own
        # Copies: all kernels would be compiled once more for groups that cannot be written to.
        arcs, settings = longest_body(robot)._group.copy(), settings_group(robot, tolerance)
        self._groups = robot._group.copy(), arcs, scene._kernel_group, settings
        self._stretches = stretches_allowed(robot)
        self._limited = bool(np.isfinite(self._stretches).any())
        self._tables = own.sections, self._stretches, own.carried, own.line_table.copy(), own.slopes
        self._follow = lines_that_follow(robot, np.zeros((len(robot), 3))) if robot.drive.elastic is None else None
        self._bounded, self._last = bounded(robot), KnownShape(*[np.empty(0)] * 4)
        self._space, self._sizes = np.empty(0), (0,) * 5
        self._work = 0.0
        self._asked: tuple[RateLimits | None, float, Floats] = None, 0.0, np.empty(0)
        self.lines = tuple(robot.actuators[i] for i in own.lines.actuators)

    def __call__(
        self, asked: StepQuery, start: Floats, limits: RateLimits, dt: float, velocity: Floats | None, room: int
    ) -> Floats:
        """Return the answer of a step (see `kernels.velocity.query`), with room for so many constraints."""
        answer = new_answer(start, room)
        begin = self._known(start)
        if begin is None:
            return self._stay(answer, start)
        own = begin._replace(states=begin.states.copy(), tensions=begin.tensions.copy())
        q, tip = self.advance(answer, asked, own, self.follow(start), limits, dt, velocity)
        q = self._prove(answer, asked, begin, q)
        answer[t.REACHED : t.REACHED + 6] = tip @ (q - start).ravel()
        answer[t.CONFIGURATION : t.CONFIGURATION + q.size] = q.ravel()
        return answer

    def move_into(self, scene: Snapshot) -> None:
        """Go on among the obstacles of another scene."""
        if scene is not self.scene:
            robot, arcs, _, settings = self._groups
            self.scene, self._groups = scene, (robot, arcs, scene._kernel_group, settings)

    def _known(self, q: Floats) -> KnownShape | None:
        """The body at rest at a drive (n, 3): where the last step ended, or found anew; `None` where there is none."""
        if self._last.q.tobytes() == q.tobytes():
            return self._last
        rest = Rest(self._robot, q)
        return None if rest.states is None else KnownShape(q, rest.tables.lines[:, s.LINE_VALUE].copy(), *rest.found)

    def _stay(self, answer: Floats, start: Floats) -> Floats:
        """Where no equilibrium is known nothing moves, and nothing is proved."""
        answer[t.START] = kernel.NO_BODY
        answer[[t.CLEARANCE, t.SELF_CLEARANCE]] = -math.inf
        answer[[t.POSITION_ERROR, t.ANGLE_ERROR, t.MERIT]] = math.inf
        answer[t.CONFIGURATION : t.CONFIGURATION + start.size] = start.ravel()
        return answer

    def _workspace(self, asked: StepQuery, actuators: int) -> Floats:
        """Scratch that is kept: memory that is new takes longer than the arithmetic."""
        sizes = len(self._robot), len(self._own.owners), len(self.scene), len(asked.targets), actuators
        if sizes != self._sizes:
            size = kernel.loaded_size(*sizes, len(self._own.line_table), self._own.slopes)
            if len(getattr(_SCRATCH, "space", ())) < size:
                _SCRATCH.space = np.empty(size)
            self._sizes, self._space = sizes, _SCRATCH.space
        return self._space

    def follow(self, q: Floats) -> Floats:
        """How lengths of lines follow the drive near `q` (n, 3); see `lines_that_follow`."""
        return lines_that_follow(self._robot, q) if self._follow is None else self._follow

    def unknown(self, q: Floats) -> KnownShape:
        """A body that is to be found at a drive (n, 3)."""
        lines = np.zeros(len(self._own.line_table))
        return KnownShape(q, lines, np.full((len(self._own.owners), s.STATE_WIDTH), np.nan), lines)

    def advance(
        self,
        answer: Floats,
        asked: StepQuery,
        begin: KnownShape,
        follow: Floats,
        limits: RateLimits,
        dt: float,
        velocity: Floats | None,
    ) -> tuple[Floats, Floats]:
        """Where it goes (n, 3), and how the tool turns and moves with the drive (6, 3 n); nothing of it is proved.

        States and tensions of `begin` become those of the body there, where several steps are asked for.
        """
        robot, arcs, scene, settings = self._groups
        if self._asked[:2] != (limits, dt):
            self._asked = limits, dt, np.empty(a.HEADER + limits.segments.size + limits.actuators.size)
            limits.write(self._asked[2][a.HEADER :], dt)
        group, count = self._asked[2], len(limits.actuators)
        group[: a.HEADER] = asked.kind, *asked.motion, asked.rounds, asked.wish, asked.seconds, count, 0, 0
        if velocity is not None:
            limits.write_before(group[a.HEADER :], dt, velocity)
        limits.write_motors(group[a.HEADER :], asked)
        if asked.still:
            self._asked = None, 0.0, np.empty(0)  # what is written here is not that of the next step
        tip, at = np.zeros((6, begin.q.size)), (begin.q, begin.states, begin.tensions)
        groups, space = (robot, arcs, scene, settings, asked.targets, group), self._workspace(asked, count)
        self._work = kernel.loaded_step(*groups, *self._tables, follow, *at, space, tip, answer)
        return answer[t.CONFIGURATION : t.CONFIGURATION + begin.q.size].reshape(begin.q.shape).copy(), tip

    def judge(self, answer: Floats, asked: StepQuery, at: KnownShape, seconds: float) -> Floats:
        """Find the body at a drive anew, prove it, and fill what is known of it; returns tensions (m,), NaN of none."""
        self._work, result = seconds / WORK_UNIT, np.full(len(self._robot.drive), np.nan)
        self._certify(answer, asked, at, at.q, False)
        if answer[t.START] != kernel.NO_BODY:
            result[self._own.lines.actuators] = self._last.tensions
        return result

    def _certify(self, answer: Floats, asked: StepQuery, begin: KnownShape, q: Floats, moves: bool = True) -> None:
        """Prove the way to a drive (n, 3), and fill what is known of it; see `kernel.certify_step`."""
        robot, arcs, scene, settings = self._groups
        lines = self._follow
        if lines is None:
            drive = self._robot.drive
            lines = lengths_of_lines(self._own, drive.displacements(q) + drive.stretch(q))
        both, held, states, tensions = (np.array([known, np.zeros_like(known)]) for known in begin)
        both[1] = q
        groups, way = (robot, arcs, scene, settings, asked.targets), (both, held, states, tensions)
        self._work = kernel.certify_step(*groups, *self._tables, lines, *way, moves, self._work, self._space, answer)
        if answer[t.START] != kernel.NO_BODY:
            self._last = KnownShape(both[1], held[1], states[1], tensions[1])

    def _prove(self, answer: Floats, asked: StepQuery, begin: KnownShape, q: Floats) -> Floats:
        """Prove the way to `q`, which is shortened until all of it is proved; returns where it ends."""
        start, end, share = begin.q, q, 1.0
        for tried in range(SHORTENINGS):
            self._certify(answer, asked, begin, end)
            verdict, until = float(answer[t.START]), float(answer[t.STEP_FRACTION])
            if not self._bounded and verdict != kernel.NO_BODY:
                verdict, until = self._sample(answer, start, end)
            if verdict in (CLEAR, SAMPLED):
                proved = verdict == CLEAR and self._excess(begin.tensions) == 0.0
                answer[t.PROVED], answer[t.STEP_FRACTION], answer[t.START] = proved, share, CLEAR
                return end
            shorter = SHY * until if until > 0.0 else 0.5 * (verdict == kernel.NO_BODY)
            if verdict == kernel.TENSE and self._follow is None and tried < HALVINGS:
                shorter = max(shorter, 0.5)  # lines stretch as the end says, so a shorter way is another one
            if shorter == 0.0:
                break
            end, share = start + shorter * (end - start), shorter * share
        return self._stop(answer, asked, begin, q)

    def _stop(self, answer: Floats, asked: StepQuery, begin: KnownShape, q: Floats) -> Floats:
        """Stay, where nothing of a way is proved; out of a contact, or of too great a tension, go on unproved."""
        start, excess = begin.q, self._excess(begin.tensions)
        self._certify(answer, asked, begin, start)
        found = answer[t.START]
        if found == CLEAR and excess == 0.0:
            return self._creep(answer, asked, begin, q)
        gap, share = self._gap(start), 1.0
        for _ in range(HALVINGS):
            end = start + share * (q - start)
            self._certify(answer, asked, begin, end)
            known = answer[t.START] != kernel.NO_BODY and self._excess(self._last.tensions) <= excess
            if known and self._gap(end) >= gap:
                break
            share *= 0.5
        else:
            self._certify(answer, asked, begin, start)
            end, share = start.copy(), 0.0
        answer[[t.PROVED, t.STEP_FRACTION, t.START]] = 0.0, share, CLEAR if found == kernel.TENSE else found
        return end

    def _creep(self, answer: Floats, asked: StepQuery, begin: KnownShape, q: Floats) -> Floats:
        """Go a little of a way whose first piece was too long for a proof, or stay where it is clear."""
        for share in (*(CREEPS if self._bounded else ()), 0.0):
            end = begin.q + share * (q - begin.q)
            self._certify(answer, asked, begin, end)
            if answer[t.START] == CLEAR:
                break
        answer[t.PROVED], answer[t.STEP_FRACTION], answer[t.START] = 1.0, share, CLEAR
        return end

    def _sample(self, answer: Floats, start: Floats, q: Floats) -> tuple[float, float]:
        """Verdict about a way that nothing bounds, and until when it is proved."""
        proof = Prover(self._robot, self.scene).prove(np.stack([start, q]), 1.0)[0]
        answer[t.CLEARANCES : t.CONFIGURATION] = proof[OF_PROOF : OF_PROOF + 2 * CLEARANCES_WIDTH]
        kept = self._excess(self._last.tensions) == 0.0
        return (float(proof[VERDICT]), float(proof[UNTIL])) if kept else (kernel.TENSE, 0.5)

    def _excess(self, tensions: Floats) -> float:
        """By how much lines (t,) are stretched beyond their limits, at worst."""
        if not self._limited:
            return 0.0
        stretches, rounding = tensions * self._own.lines.compliance, kernel.TENSION_ROUNDING * self._robot.mean_length
        outside = np.maximum(self._stretches[:, 0] - stretches, stretches - self._stretches[:, 1])
        worst = float(outside.max(initial=-math.inf))
        return worst if worst > rounding else 0.0

    def _gap(self, q: Floats) -> float:
        """Least gap to obstacles and to the body itself at a drive (n, 3), as far as samples show it."""
        rest, body = Rest(self._robot, q), longest_body(self._robot)
        if rest.states is None:
            return -math.inf
        places, radii = body.backbone(rest.arcs, SAMPLES)[1:], np.repeat(body.needed_radii, SAMPLES)
        least = nearest_meeting(body, rest.arcs, segment_ends(body, rest.arcs)).gap
        for i in range(len(self.scene)):
            least = min(least, float((self.scene.distance_to(i, places)[0] - radii).min()))
        return least
