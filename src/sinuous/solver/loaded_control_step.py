"""One tick of a control loop of a robot under load: the steps that `kernels.velocity` makes, for the loaded body.

How tip and body move follows from the derivative of the equilibrium; all rows then go through one least-distance
problem (Lawson & Hanson 1974, chapter 23). What is proved of the motion is what `between.steps` proves under load.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from sinuous.answer.least_distance import least_distance
from sinuous.answer.observer import vector_of
from sinuous.base.checks import Floats
from sinuous.base.work_time import work_time
from sinuous.kernels import tables as k
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.certificate.query import CLEARANCES as OF_PROOF
from sinuous.kernels.certificate.query import UNTIL, VERDICT
from sinuous.kernels.certificate.sweep import CLEARANCES_WIDTH, PROVED_BOUND
from sinuous.kernels.packing import scales_of
from sinuous.kernels.velocity import layout as a
from sinuous.kernels.velocity import query as t
from sinuous.kernels.velocity.layout import MEET_TARGETS, MOVE_POSE
from sinuous.measures.body import nearest_meeting, segment_ends
from sinuous.model.robot import Robot
from sinuous.problem.target import Target, Tolerance, meets
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.certificates.steps import SAMPLED, Prover
from sinuous.solver.loaded_solve import errors_of
from sinuous.solver.step_query import RateLimits, StepQuery
from sinuous.statics.equilibrium import longest_body
from sinuous.statics.rest import Rest

DIFFERENCE = 1e-5
"""Of a coordinate, rad or relative length, by which the body is moved to see what it does."""

SAMPLES = 8
"""Places of an arc at which it is held against obstacles."""

AHEAD = 1.5
"""How far ahead of a free step contacts are looked for."""

ROOM = 1e-4
"""Gap that a step keeps, in mean lengths of the robot, so that it can be proved."""

EXACT, DAMPING, FASTER, SLOWER = 1e-9, 0.01, 0.3, 10.0
"""Damping of a twist; and of targets, as a share of their residual, squared, and how it changes after a step that was
better or not."""

DONE, HOPELESS = 1e-9, 1e6
"""Steps end that move or gain no more than this, and where they would have to be damped so much more."""

CUTS = 12
"""Most times that tangents to the discs of bends and of their changes are added."""

OUTSIDE = 1e-9
"""How far outside such a disc a step may lead, rad, before it is shortened."""

SHRINKS = (0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.1, 0.5)
"""By how much a step is shortened until rounding leaves it within limits and rates."""

SHY = 0.9
"""How much of what is proved is gone, where the rest is not."""

HALVINGS = 4

NO_BODY = -1.0
"""The verdict about a start at which no equilibrium was found."""


class ControlStepRow(NamedTuple):
    """A bound `weights . y >= low`, y in units of the scale; `wish` comes after all that is not.

    `kind`, `segment` and `other` say what it is, see `kernels.velocity.layout`.
    """

    weights: Floats
    low: float
    kind: int
    segment: int
    other: int
    wish: bool = False


class LinearisedBody(NamedTuple):
    """How a loaded body moves with its drive, in units of the scale.

    Attributes
    ----------
    rest : Rest
    left : ndarray (6 t,)
        What is left of the targets, see `loaded_solve.errors_of`.
    points : ndarray (M, 3)
        Places of the backbone.
    of_points : ndarray (M, 3, 3 n)
    tip : ndarray (6, 3 n)
        Rotation (rad) and displacement of the tool.
    errors : ndarray (6 t, 3 n)
        By how much that shrinks.
    """

    rest: Rest
    left: Floats
    points: Floats
    of_points: Floats
    tip: Floats
    errors: Floats


class LoadedControlStep:
    """Makes ticks of one robot under load in one scene.

    Parameters
    ----------
    robot : Robot
    scene : Snapshot
    tolerance : Tolerance
        With numbers, within which several steps end.
    """

    def __init__(self, robot: Robot, scene: Snapshot, tolerance: Tolerance) -> None:
        self._robot, self.scene, self._tolerance = robot, scene, tolerance
        self._body, self._prover = longest_body(robot), Prover(robot, scene)
        self._scale = scales_of(robot.limits).ravel()
        owners = self._prover.owners
        self._owners = np.repeat(owners, SAMPLES)
        self._radii = np.repeat(np.array(self._body.needed_radii), SAMPLES)

    def __call__(
        self,
        asked: StepQuery,
        goals: tuple[Target, ...],
        start: Floats,
        limits: RateLimits,
        dt: float,
        velocity: Floats | None,
        room: int,
    ) -> Floats:
        """Return the answer of a tick (see `kernels.velocity.query`), with room for so many constraints."""
        answer = np.zeros(t.CONFIGURATION + start.size + t.ACTIVE_WIDTH * room)
        rest = Rest(self._robot, start)
        if rest.states is None:
            return self._stay(answer, start)
        moves = self._moves(rest, goals)
        q, rounds, active = self._advance(asked, goals, moves, limits, dt, velocity)
        q = self._prove(answer, start, q)
        answer[t.REACHED : t.REACHED + 6] = moves.tip @ self._moved(q - start)
        answer[t.ROUNDS] = rounds
        self._judge(answer, q, goals)
        answer[t.CONFIGURATION : t.CONFIGURATION + q.size] = q.ravel()
        listed = active[:room]
        answer[t.ACTIVE] = len(listed)
        first = t.CONFIGURATION + q.size
        for i, (multiplier, row) in enumerate(listed):
            at = first + t.ACTIVE_WIDTH * i
            answer[at : at + t.ACTIVE_WIDTH] = multiplier, row.kind, row.segment, row.other
        return answer

    def _stay(self, answer: Floats, start: Floats) -> Floats:
        """Where no equilibrium is known nothing moves, and nothing is proved."""
        answer[t.START] = NO_BODY
        answer[[t.CLEARANCE, t.SELF_CLEARANCE]] = -math.inf
        answer[[t.POSITION_ERROR, t.ANGLE_ERROR, t.MERIT]] = math.inf
        answer[t.CONFIGURATION : t.CONFIGURATION + start.size] = start.ravel()
        return answer

    def _moves(self, rest: Rest, goals: tuple[Target, ...]) -> LinearisedBody:
        """Look at the bodies beside the one where the drive is, to which its derivative leads."""
        robot, scale = self._robot, self._scale
        moving = np.flatnonzero(scale > 0.0)
        size = len(scale)
        pose, (left, _, _) = rest.pose(None), self._errors(rest, goals)
        tip, errors = np.zeros((6, size)), np.zeros((len(left), size))
        bodies, states = [rest.arcs], rest.found[0]
        for i in moving.tolist():
            q = rest.q.copy()
            q.flat[i] += DIFFERENCE * scale[i]
            other = Rest(robot, q, known=(states + DIFFERENCE * scale[i] * rest.slopes[i], rest.tensions))
            there = other.pose(None)
            tip[:3, i] = vector_of(there[:3, :3] @ pose[:3, :3].T) / DIFFERENCE
            tip[3:, i] = (there[:3, 3] - pose[:3, 3]) / DIFFERENCE
            if goals:
                errors[:, i] = (left - self._errors(other, goals)[0]) / DIFFERENCE
            bodies.append(other.arcs)
        places = self._body.backbone(np.stack(bodies), SAMPLES)[:, 1:]
        of_points = np.zeros((*places.shape[1:], size))
        of_points[..., moving] = np.moveaxis(places[1:] - places[0], 0, -1) / DIFFERENCE
        return LinearisedBody(rest, left, places[0], of_points, tip, errors)

    def _advance(
        self,
        asked: StepQuery,
        goals: tuple[Target, ...],
        moves: LinearisedBody,
        limits: RateLimits,
        dt: float,
        velocity: Floats | None,
    ) -> tuple[Floats, int, list[tuple[float, ControlStepRow]]]:
        """Go on step by step, each kept that brings the targets nearer; a tick is the first, as it is.

        Returns where it ends (n, 3), how many steps there were, and what held the last one back, strongest first.
        """
        start, tolerance, end, easing, rounds = moves.rest.q, self._tolerance, work_time() + asked.seconds, 1.0, 0
        active = list[tuple[float, ControlStepRow]]()
        while rounds < asked.rounds and work_time() < end and easing <= HOPELESS:
            step, active = self._step(asked, goals, moves, start, limits, dt, velocity, easing)
            q = self._within(start, step, limits, dt)
            rounds += 1
            if asked.rounds == 1:
                return q, rounds, active
            before, near = float(moves.left @ moves.left), Rest(self._robot, q)
            left, off, turn = (moves.left, 0.0, 0.0) if near.states is None else self._errors(near, goals)
            moved = float(np.linalg.norm(self._moved(q - moves.rest.q)))
            gained, easing = before - float(left @ left), SLOWER * easing
            if gained > 0.0:
                moves, easing = self._moves(near, goals), max(1e-6, FASTER / SLOWER * easing)
            met = gained > 0.0 and meets(tolerance, off, turn)
            if met or moved < DONE or 0.0 < gained < DONE * before:
                break
        return moves.rest.q, rounds, active

    def _moved(self, change: Floats) -> Floats:
        """A change of the drive (n, 3) in units of the scale (3 n,)."""
        return change.ravel() / np.where(self._scale > 0.0, self._scale, 1.0)

    def _errors(self, rest: Rest, goals: tuple[Target, ...]) -> tuple[Floats, float, float]:
        return errors_of(rest, goals, self._robot.mean_length) if goals else (np.zeros(0), 0.0, 0.0)

    def _step(
        self,
        asked: StepQuery,
        goals: tuple[Target, ...],
        moves: LinearisedBody,
        start: Floats,
        limits: RateLimits,
        dt: float,
        velocity: Floats | None,
        easing: float,
    ) -> tuple[Floats, list[tuple[float, ControlStepRow]]]:
        """Find the motion (3 n,) from the start, in units of the scale, and what holds it back, strongest first.

        All but limits and rates is linear about the drive where the body of `moves` is.
        """
        unit, done = self._robot.mean_length, self._moved(moves.rest.q - start)
        if asked.kind == MEET_TARGETS:
            rows, wanted = moves.errors, moves.left
            damping = max(EXACT, DAMPING * easing * float(wanted @ wanted))
        else:
            weights = np.array([1.0 if asked.kind == MOVE_POSE else 0.0] * 3 + [1.0 / unit] * 3)
            rows, wanted, damping = weights[:, None] * moves.tip, weights * np.array(asked.motion), EXACT
        square: Any = rows.T @ rows + damping * np.eye(len(self._scale))
        root: Floats = np.linalg.cholesky(square)
        free: Floats = np.linalg.solve(square, rows.T @ wanted) * (self._scale > 0.0)
        far = AHEAD * float(np.linalg.norm(moves.of_points @ free, axis=1).max()) if len(moves.points) else 0.0
        touched = [
            row._replace(low=row.low + float(row.weights @ done))
            for row in self._contacts(asked.wish, min(far, unit), moves)
        ]
        free = free + done
        fixed = [*touched, *self._of_limits(start, limits, dt, velocity)]
        for wishes in (True, False):
            bounds = [row for row in fixed if wishes or not row.wish]
            for _ in range(CUTS):
                found = _nearest_within(root, free, bounds)
                if found is None:
                    break
                step, active = found
                cuts = self._cuts(start, step, limits, dt, velocity if wishes else None)
                if not cuts:
                    return step, active
                bounds += cuts
            else:
                return step, active
        return done, []

    def _contacts(self, wish: float, ahead: float, moves: LinearisedBody) -> list[ControlStepRow]:
        """Bounds of places of the body that are near obstacles: of each segment and obstacle the nearest."""
        keep = ROOM * self._robot.mean_length
        wish = max(wish, keep)
        lengths = np.repeat(moves.rest.arcs[:, 2] / SAMPLES, SAMPLES)
        beyond = np.cumsum(lengths) >= self._robot.mount
        rows = []
        for i in range(len(self.scene)):
            distances, slopes = self.scene.distance_to(i, moves.points)
            gaps = np.where(beyond, distances - self._radii, math.inf)
            for segment in range(len(self._robot)):
                own = np.flatnonzero(self._owners == segment)
                at = int(own[gaps[own].argmin()])
                gap = float(gaps[at])
                if gap >= wish + ahead:
                    continue
                weights = slopes[at] @ moves.of_points[at]
                rows.append(ControlStepRow(weights, min(0.0, keep - gap), a.CLEARANCE_LIMIT, segment, i))
                if wish > keep and gap < wish:
                    rows.append(ControlStepRow(weights, wish - gap, a.CLEARANCE_LIMIT, segment, i, True))
        return rows

    def _of_limits(self, start: Floats, limits: RateLimits, dt: float, velocity: Floats | None) -> list[ControlStepRow]:
        """Bounds of lengths and actuators."""
        rows, scale = list[ControlStepRow](), self._scale
        table, own = self._robot.limits, start.size
        for j in np.flatnonzero(scale[2::3] > 0.0).tolist():
            at, rate = np.zeros(len(scale)), limits.segments[j]
            at[3 * j + 2] = scale[3 * j + 2]
            least, most = table[j, k.MIN_LENGTH] - start[j, 2], table[j, k.MAX_LENGTH] - start[j, 2]
            rows += _sides(at, least, most, dt * rate[a.LENGTH_CHANGE], (a.LENGTH_LIMIT, a.LENGTH_RATE_LIMIT), (j, -1))
            if velocity is not None:
                rows += _wished(at, dt * velocity[j, 2], dt * dt * rate[a.LENGTH_SECOND], (j, -1))
        for j, actuator in enumerate(limits.actuators):
            at, value = actuator[:own] * scale, float(actuator[:own] @ start.ravel())
            least, most = actuator[own + a.LOWEST] - value, actuator[own + a.HIGHEST] - value
            rows += _sides(
                at,
                least,
                most,
                dt * actuator[own + a.LARGEST_CHANGE],
                (a.ACTUATOR_LIMIT, a.ACTUATOR_RATE_LIMIT),
                (-1, j),
            )
            if velocity is not None:
                before = dt * float(actuator[:own] @ velocity.ravel())
                rows += _wished(at, before, dt * dt * actuator[own + a.SECOND_DIFFERENCE], (-1, j))
        return [row for row in rows if math.isfinite(row.low) and row.weights.any()]

    def _cuts(
        self, start: Floats, step: Floats, limits: RateLimits, dt: float, velocity: Floats | None
    ) -> list[ControlStepRow]:
        """Tangents to the discs, of bends and of their changes, that a step leaves."""
        found = list[ControlStepRow]()
        table, change = self._robot.limits, (step * self._scale).reshape(-1, 3)
        for j in range(len(start)):
            bend, bent, length = start[j, :2], math.hypot(*start[j, :2]), start[j, 2] + change[j, 2]
            curved = table[j, k.MAX_CURVATURE]
            discs = [(-bend, max(table[j, k.MAX_BEND], bent), 0.0, a.BEND_LIMIT)]
            if curved < math.inf:
                discs.append(
                    (-bend, curved * length + max(0.0, bent - curved * start[j, 2]), curved, a.CURVATURE_LIMIT)
                )
            discs.append((np.zeros(2), dt * limits.segments[j, a.BEND_CHANGE], 0.0, a.BEND_RATE_LIMIT))
            if velocity is not None:
                discs.append(
                    (dt * velocity[j, :2], dt * dt * limits.segments[j, a.BEND_SECOND], 0.0, a.ACCELERATION_LIMIT)
                )
            for center, most, slope, kind in discs:
                off = change[j, :2] - center
                size = math.hypot(*off)
                if size > most + OUTSIDE:
                    weights = np.zeros(len(step))
                    weights[3 * j : 3 * j + 2] = -off / size
                    weights[3 * j + 2] = slope
                    low = -(most - slope * change[j, 2]) - float(off @ center) / size
                    found.append(ControlStepRow(weights * self._scale, low, kind, j, -1))
        return found

    def _within(self, start: Floats, step: Floats, limits: RateLimits, dt: float) -> Floats:
        """Where a step leads: shortened until all limits and rates are kept, as they are convex, and exactly."""
        change = (step * self._scale).reshape(-1, 3)
        for shrink in SHRINKS:
            q = start + (1.0 - shrink) * change
            if self._keeps(start, q, limits, dt):
                return q
        return start.copy()

    def _keeps(self, start: Floats, q: Floats, limits: RateLimits, dt: float) -> bool:
        table, own = self._robot.limits, start.size
        bends, bent = np.hypot(q[:, 0], q[:, 1]), np.hypot(start[:, 0], start[:, 1])
        moved = q - start
        with np.errstate(invalid="ignore"):
            curved = table[:, k.MAX_CURVATURE] * q[:, 2]
            beyond = np.maximum(0.0, bent - table[:, k.MAX_CURVATURE] * start[:, 2])
        kept = [
            bends <= np.maximum(table[:, k.MAX_BEND], bent),
            ~(bends > curved + np.where(np.isfinite(beyond), beyond, 0.0)),
            q[:, 2] >= np.minimum(table[:, k.MIN_LENGTH], start[:, 2]),
            q[:, 2] <= np.maximum(table[:, k.MAX_LENGTH], start[:, 2]),
            np.hypot(moved[:, 0], moved[:, 1]) <= dt * limits.segments[:, a.BEND_CHANGE],
            np.abs(moved[:, 2]) <= dt * limits.segments[:, a.LENGTH_CHANGE],
        ]
        rows = limits.actuators
        before, after = rows[:, :own] @ start.ravel(), rows[:, :own] @ q.ravel()
        kept += [
            after >= np.minimum(rows[:, own + a.LOWEST], before),
            after <= np.maximum(rows[:, own + a.HIGHEST], before),
            np.abs(after - before) <= dt * rows[:, own + a.LARGEST_CHANGE],
        ]
        return all(bool(each.all()) for each in kept)

    def _prove(self, answer: Floats, start: Floats, q: Floats) -> Floats:
        """Prove the motion, which is shortened to what is proved; returns where it ends."""
        proof = self._prover.prove(np.stack([start, q]), 1.0)[0]
        answer[t.CLEARANCES : t.CONFIGURATION] = proof[OF_PROOF : OF_PROOF + 2 * CLEARANCES_WIDTH]
        answer[t.PROVED], answer[t.STEP_FRACTION], answer[t.START] = 1.0, 1.0, CLEAR
        if proof[VERDICT] == CLEAR:
            return q
        if proof[VERDICT] == SAMPLED:
            answer[t.PROVED] = 0.0
            return q
        if proof[UNTIL] > 0.0:
            share = SHY * float(proof[UNTIL])
            answer[t.STEP_FRACTION] = share
            return start + share * (q - start)
        answer[t.START] = self._prover.prove(np.stack([start, start]), 1.0)[0, VERDICT]
        answer[t.STEP_FRACTION] = 0.0
        if answer[t.START] == CLEAR:
            return start.copy()
        answer[t.PROVED] = 0.0
        gap, share = self._gap(start), 1.0
        for _ in range(HALVINGS):
            if self._gap(start + share * (q - start)) >= gap:
                answer[t.STEP_FRACTION] = share
                return start + share * (q - start)
            share *= 0.5
        return start.copy()

    def _gap(self, q: Floats) -> float:
        """Least gap to obstacles and to the body itself at a drive (n, 3), as far as samples show it."""
        rest = Rest(self._robot, q)
        if rest.states is None:
            return -math.inf
        places = self._body.backbone(rest.arcs, SAMPLES)[1:]
        least = nearest_meeting(self._body, rest.arcs, segment_ends(self._body, rest.arcs)).gap
        for i in range(len(self.scene)):
            least = min(least, float((self.scene.distance_to(i, places)[0] - self._radii).min()))
        return least

    def _judge(self, answer: Floats, q: Floats, goals: tuple[Target, ...]) -> None:
        """Fill errors and clearances of where it ends."""
        rest = Rest(self._robot, q)
        at_rest = self._prover.prove(np.stack([q, q]))[0]
        clear = at_rest[VERDICT] == CLEAR
        columns = t.CLEARANCE, t.SELF_CLEARANCE
        for i, column in enumerate(columns):
            low = float(at_rest[OF_PROOF + i * CLEARANCES_WIDTH + PROVED_BOUND])
            answer[column] = low if clear else -math.inf
        if goals and rest.states is not None:
            left, off, turn = self._errors(rest, goals)
            answer[[t.MERIT, t.POSITION_ERROR, t.ANGLE_ERROR]] = float(left @ left), off, turn


def _sides(
    at: Floats, least: float, most: float, change: float, kinds: tuple[int, int], where: tuple[int, int]
) -> list[ControlStepRow]:
    """Both bounds of what moves with `at`: between limits, no farther beyond them than it is, and within its rate."""
    least, most = min(0.0, least), max(0.0, most)
    low, high = (kinds[int(abs(side) > change)] for side in (least, most))
    return [ControlStepRow(at, max(least, -change), low, *where), ControlStepRow(-at, -min(most, change), high, *where)]


def _wished(at: Floats, aim: float, room: float, where: tuple[int, int]) -> list[ControlStepRow]:
    """Both bounds of an acceleration, which come after all else."""
    return [ControlStepRow(side * at, side * aim - room, a.ACCELERATION_LIMIT, *where, True) for side in (1.0, -1.0)]


def _nearest_within(
    root: Floats, free: Floats, bounds: list[ControlStepRow]
) -> tuple[Floats, list[tuple[float, ControlStepRow]]] | None:
    """The step nearest to a free one within bounds, and the active ones, strongest first; `None`: there is none."""
    if not bounds:
        return free, []
    found = least_distance(root, free, np.array([row.weights for row in bounds]), np.array([row.low for row in bounds]))
    if found is None:
        return None
    step, multipliers = found
    order = np.argsort(-multipliers, kind="stable")
    return step, [(float(multipliers[i]), bounds[i]) for i in order if multipliers[i] > 0.0]
