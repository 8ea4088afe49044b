"""What is proved of the motion between neighbouring configurations: linear in q, the whole body, all the way."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.kernels import tables as k
from sinuous.kernels.between.query import ANSWER_WIDTH, SEEN, UNTIL, VERDICT, prove_motions
from sinuous.kernels.between.sweep import DRIFT_WIDTH, SEEN_WIDTH, SEGMENT, WHEN, sweep_size
from sinuous.kernels.body.proof import CLEAR, UNDECIDED
from sinuous.reprs import call
from sinuous.robot.robot import Robot, robot_group
from sinuous.scene.snapshot import Snapshot
from sinuous.solving.between.drifts import Drifts, divided_knots, together
from sinuous.solving.between.loaded import SAMPLED, SAMPLES, StepPiece, Ways, prove_way, unproved
from sinuous.statics.equilibrium import longest_body
from sinuous.work_time import work_time

SLACK = 0.1
"""How far below the true clearance its proved bound may be, as a share of it."""

FINEST = 1e-7
"""Length, in robot lengths, below which a proof gives up."""

SECONDS = 0.05
"""Time that a step may take on average."""

LOOSE_SECONDS = 0.5
"""Time for the proof of a step that is only to be clear, without a tight bound."""


@dataclass(frozen=True, eq=False, repr=False)
class Steps:
    """What is proved of the motions between neighbouring configurations, in their order.

    Attributes
    ----------
    answers : ndarray (m, 14)
        What the kernel found, see `kernels.between.query`.
    demanded : (float, float)
        Clearance and self-clearance that the robot keeps in any case, from which those of the kernel count.
    """

    answers: Floats
    demanded: tuple[float, float] = (0.0, 0.0)

    @cached_property
    def proved(self) -> NDArray[np.bool_]:
        """Whether the body is proved clear of obstacles and of itself all the way (m,)."""
        return self.answers[:, VERDICT] == CLEAR

    @property
    def samples(self) -> NDArray[np.intp]:
        """At how many shapes each motion was looked at (m,) and found clear, where that is all: see `SAMPLED`."""
        return np.where(self.answers[:, VERDICT] == SAMPLED, SAMPLES, 0)

    @classmethod
    def told(
        cls,
        count: int,
        unproved: Sequence[int],
        clearance: float | None,
        self_clearance: float | None,
        demanded: tuple[float, float] = (0.0, 0.0),
    ) -> "Steps":
        """Make what somebody says: so many steps, numbers (1 = first) of those not proved, and bounds of all others."""
        answers = np.zeros((count, ANSWER_WIDTH))
        answers[:, VERDICT], answers[:, UNTIL] = CLEAR, 1.0
        answers[:, SEEN] = math.inf if clearance is None else clearance - demanded[0]
        answers[:, SEEN + SEEN_WIDTH] = math.inf if self_clearance is None else self_clearance - demanded[1]
        wrong = np.array(unproved, np.intp) - 1
        answers[wrong, VERDICT], answers[wrong, UNTIL] = UNDECIDED, 0.0
        return cls(answers, demanded)

    @property
    def until(self) -> Floats:
        """Share of each motion, from its beginning, that is proved (m,)."""
        return self.answers[:, UNTIL]

    @property
    def clearances(self) -> Floats:
        """Proved lower bounds of the clearance in each motion (m,); infinite without obstacles."""
        return self.answers[:, SEEN] + self.demanded[0]

    @property
    def self_clearances(self) -> Floats:
        """Proved lower bounds of the self-clearance in each motion (m,); infinite where it does not matter."""
        return self.answers[:, SEEN + SEEN_WIDTH] + self.demanded[1]

    @property
    def room(self) -> tuple[Floats, Floats]:
        """The same two (m,), beyond what is demanded: by so much the body may come nearer."""
        return self.answers[:, SEEN], self.answers[:, SEEN + SEEN_WIDTH]

    @property
    def clearance(self) -> float | None:
        """Proved lower bound of the clearance in all motions; `None` without obstacles or without a proof."""
        return self._least(self.clearances)

    @property
    def self_clearance(self) -> float | None:
        """Proved lower bound of the self-clearance in all motions; `None` where it is infinite, or without a proof."""
        return self._least(self.self_clearances)

    def reversed(self) -> "Steps":
        """Return the same for the motions backwards, in the opposite order."""
        answers = self.answers[::-1].copy()
        answers[:, UNTIL] = np.where(answers[:, VERDICT] == CLEAR, 1.0, 0.0)
        for seen in (SEEN, SEEN + SEEN_WIDTH):
            answers[:, seen + WHEN] = 1.0 - answers[:, seen + WHEN]
        return Steps(answers, self.demanded)

    def __repr__(self) -> str:
        return call("Steps", [f"{int(self.proved.sum())} of {len(self.proved)} proved clear"])

    def _least(self, bounds: Floats) -> float | None:
        least = float(bounds.min(initial=math.inf))
        return least if self.proved.all() and math.isfinite(least) else None


class Prover:
    """Proves one motion after the other for a robot in a scene, without making anything anew.

    Where obstacles move, motions have times, and where these are between them is looked at in the same time. Of a robot
    under load it proves the loaded body: linear in the coordinates of its arcs, and as far aside of that as equilibria
    may be.

    `finest`: length, in robot lengths, below which a proof gives up. `owners` (N,): the segment of each of its arcs.
    """

    def __init__(self, robot: Robot, scene: Snapshot, finest: float = FINEST) -> None:
        self.scene = scene
        self._ways = Ways(robot) if robot.hangs else None
        body = longest_body(robot) if robot.hangs else robot
        self._group, self._scene_group = robot_group(body), scene.at(0.0)._kernel_group
        self._mount, self._finest = float(robot.mount), finest * robot.mean_length
        self._workspace = np.empty(sweep_size(len(body), len(scene)))
        self.owners = np.arange(len(robot)) if self._ways is None else self._ways.owners
        self._drifts = Drifts(scene) if scene.moves else None
        if self._drifts is not None:
            self._scene_group = self._scene_group.copy()  # rows of it are written

    def prove(
        self,
        knots: Floats,
        slack: float = SLACK,
        seconds: float = SECONDS,
        times: Floats | None = None,
        known: Floats | None = None,
    ) -> Floats:
        """Return answers (T - 1, 14) about the motions between neighbouring `knots`; see `prove_steps`.

        `known` (T, 2): proved clearances and self-clearances of the knots, beyond what is demanded; 0: not known.
        Bounds are no more than `slack` below these, then.
        """
        if self._ways is not None:
            return self._prove_under_load(self._ways, knots, slack, seconds, times)
        return self._prove_in_time(knots, slack, seconds, times, known)

    def _prove_in_time(
        self, knots: Floats, slack: float, seconds: float, times: Floats | None, known: Floats | None
    ) -> Floats:
        clear = np.zeros((len(knots), 2)) if known is None else known
        if self._drifts is None:
            return self._prove(knots, clear, np.empty((len(knots) - 1, 0, DRIFT_WIDTH)), slack, seconds)
        if times is None:
            raise InputError("times", "missing: obstacles move", None, "when the robot is at each knot")
        finer = self._drifts.divided(times)
        if len(finer) == len(times):
            return self._prove(knots, clear, self._drifts.rows(times), slack, seconds)
        divided = divided_knots(knots, times, finer)
        answers = self._prove(divided, np.zeros((len(finer), 2)), self._drifts.rows(finer), slack, seconds)
        return together(answers, times, finer)

    def _prove(self, knots: Floats, known: Floats, drifts: Floats, slack: float, seconds: float) -> Floats:
        answers = np.zeros((len(knots) - 1, ANSWER_WIDTH))
        terms = self._mount, slack, self._finest, seconds * len(answers)
        prove_motions(self._group, self._scene_group, knots, known, drifts, terms, self._workspace, answers)
        return answers

    def _prove_under_load(
        self, ways: Ways, knots: Floats, slack: float, seconds: float, times: Floats | None
    ) -> Floats:
        """Prove the steps of a loaded body, each in as many pieces as it takes."""
        answers = unproved(len(knots) - 1)
        end = work_time() + seconds * len(answers)
        if self._drifts is not None and times is None:
            raise InputError("times", "missing: obstacles move", None, "when the robot is at each knot")
        for i in range(len(answers)):
            begin, more = (0.0, 0.0) if times is None else (float(times[i]), float(times[i + 1] - times[i]))

            def clear(piece: StepPiece, begin: float = begin, more: float = more) -> Floats:
                when = None if times is None else begin + more * np.array([piece.begin, piece.end])
                left = max(0.0, end - work_time())
                return self._prove_piece(piece, slack, left, when)

            answers[i] = prove_way(ways, knots[i], knots[i + 1], clear, end)
        return answers

    def _prove_piece(self, piece: StepPiece, slack: float, seconds: float, times: Floats | None) -> Floats:
        """Prove the way linear in the coordinates of arcs (2, N, 3) for a body that is thicker by `piece.aside`."""
        count = piece.arcs.shape[1]
        rows = self._group[k.ROBOT_HEADER : k.ROBOT_HEADER + count * k.SEGMENT_WIDTH].reshape(count, -1)
        rows[:, k.MAX_LENGTH] = np.maximum(rows[:, k.MAX_LENGTH], piece.arcs[..., 2].max(axis=0))
        for column in (k.RADIUS, k.SELF_RADIUS):
            rows[:, column] += piece.aside
        try:
            answer: Floats = self._prove_in_time(piece.arcs, slack, seconds, times, None)[0]
        finally:
            for column in (k.RADIUS, k.SELF_RADIUS):
                rows[:, column] -= piece.aside
        for at in (SEEN, SEEN + SEEN_WIDTH):
            answer[at + SEGMENT] = self.owners[int(answer[at + SEGMENT])] if answer[at + SEGMENT] >= 0.0 else -1.0
        return answer


def prove_steps(
    robot: Robot,
    scene: Snapshot,
    knots: Floats,
    slack: float = SLACK,
    seconds: float = SECONDS,
    times: Floats | None = None,
) -> Steps:
    """Prove the motions linear in q between neighbouring `knots` (T, n, 3), which are within all limits.

    `slack`: how far below the truth clearances may be, as a share of them; with 1 it is enough that they are greater
    than 0. `seconds` are those of a step, on average. `times` (T,) count where obstacles move; a step whose clearance
    is not bounded so tightly in this time is then proved clear at least, where that is possible.
    """
    prover, path = Prover(robot, scene), np.array(knots, np.float64)
    answers = prover.prove(path, slack, seconds, times)
    if times is not None and scene.moves:
        for i in np.flatnonzero(answers[:, VERDICT] == UNDECIDED).tolist():
            again = prover.prove(path[i : i + 2], 1.0, LOOSE_SECONDS, times[i : i + 2])[0]
            answers[i] = again if again[VERDICT] == CLEAR else answers[i]
    return Steps(answers, robot.least_demanded)


def load_motions(robot: Robot, scene: Snapshot) -> None:
    """Compile what proves motions, or load it."""
    prove_steps(robot, scene, np.zeros((1, len(robot), 3)), times=np.zeros(1))
