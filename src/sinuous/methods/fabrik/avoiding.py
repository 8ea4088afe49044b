"""FABRIK with obstacle avoidance: forward and backward reaching that pushes joints away from what the body runs into.

Wu et al., "A novel obstacle avoidance heuristic algorithm of continuum robot based on FABRIK" (2022). The paper could
not be had. One iteration is FABRIKc's. Then every segment is looked at in some places; where one is inside an obstacle,
the joints that shape it (its key points) are moved away from the obstacle, along the gradient of the distance, before
the next iteration reaches for the target again. Nothing is done while nothing overlaps. Chosen here are the places,
that the deepest of a segment counts, that its own joint moves by all of a push and the joint before by half, and that
the push aims a little beyond contact, farther whenever the proof of the whole body finds an overlap that the places had
missed.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from sinuous.kernels.body.glance import deepest
from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.clock import SEGMENT_LOOKS, spend
from sinuous.kernels.compile import kernel
from sinuous.kernels.fields.distances import obstacle, price
from sinuous.kernels.maths.vectors import Array, add_scaled, copy, get_vec, put_vec
from sinuous.kernels.problem import Problem
from sinuous.methods.capabilities import Capabilities
from sinuous.methods.fabrik.conversion import fold
from sinuous.methods.fabrik.links import Chain, group
from sinuous.methods.fabrik.reaching import Work, carve, reach, scratch_size
from sinuous.methods.judge import Answer, Check, has_obstacles, offer, target_errors
from sinuous.methods.options import Options, count, flag, number
from sinuous.methods.prepared import Compiled
from sinuous.methods.search import Start, begin_from, compiled_search, search_by
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene

PATIENCE = 40
"""Iterations in a row that gain less than a hundredth before a start is given up."""


@kernel
def push_away(
    problem: Problem, check: Check, chain: Chain, q: Array, looks: int, strength: float, margin: float
) -> float:
    """Move the joints of segments that overlap; returns the deepest overlap that was seen.

    `q` (n, 3) is the configuration, the frames of `check` what follows from it; `looks` places of every segment are
    looked at, while there is time. A joint is moved by `strength` times what is missing to the clearance `margin`.
    """
    if not has_obstacles(problem):
        return 0.0
    overlap = travel = 0.0
    cost = looks * price(problem.scene)
    for k in range(q.shape[0]):
        if spend(check.clock, cost):
            break
        rotation, position = frame(check.frames, k)
        clearance, which, place = deepest(problem, rotation, position, get_vec(q, k, 0), k, travel, looks)
        travel += q[k, 2]
        overlap = max(overlap, -clearance)
        if clearance < 0.0:
            _, away = obstacle(problem.scene, which, place, math.inf)
            push = strength * (margin - clearance)
            put_vec(chain.joints, k, 0, add_scaled(get_vec(chain.joints, k, 0), push, away))
            if k > 0:
                put_vec(chain.joints, k - 1, 0, add_scaled(get_vec(chain.joints, k - 1, 0), 0.5 * push, away))
    return overlap


@kernel
def descend(
    problem: Problem, check: Check, work: Work, options: Array, source: int, answer: Answer
) -> tuple[int, bool]:
    """Reach and step aside until an answer is solved, nothing is gained any more, or time is over.

    Begins at `work.chain`; offers what meets the target, and the best of all at the end. Returns the number of
    iterations, and whether an answer is solved. `options` (5,): see `follow`.
    """
    most, looks, strength, margin = int(options[0]), int(options[1]), options[2], options[3] * problem.unit
    least, slow = math.inf, 0
    copy(work.q, work.kept)
    for iteration in range(most):
        reach(problem, work.chain, check.frames, work.q)
        off, turn = target_errors(problem, check.frames)
        overlap = push_away(problem, check, work.chain, work.q, looks, strength, margin)
        wrong = (off + overlap) / problem.unit + turn
        slow = 0 if wrong < 0.99 * least else slow + 1
        if wrong < least:
            least = wrong
            copy(work.q, work.kept)
        if off <= problem.position_tolerance and turn <= problem.angle_tolerance and overlap == 0.0:
            if offer(problem, check, work.q, source, answer):
                return iteration + 1, True
            margin *= 2.0
        if slow >= PATIENCE or spend(check.clock, SEGMENT_LOOKS * work.q.shape[0]):
            return iteration + 1, offer(problem, check, work.kept, source, answer)
    return most, offer(problem, check, work.kept, source, answer)


@kernel
def follow(
    problem: Problem, check: Check, scratch: Array, options: Array, start: Start, answer: Answer
) -> tuple[int, bool]:
    """Follow one start; see `sinuous.methods.search`. The `options` are the fields of `FabrikAvoid`."""
    n = problem.limits.shape[0]
    work = carve(scratch, n, n)
    group(work.chain, n, 1, 0.0)
    source = begin_from(problem, check, start, work.q)
    fold(problem.limits, work.chain, check.frames, options[4] != 0.0, work.q)
    return descend(problem, check, work, options, source, answer)


search = search_by(follow)


@dataclass(frozen=True, repr=False)
class FabrikAvoid(Options):
    """Options of the method `fabrik_avoid`.

    Attributes
    ----------
    iterations : int
        Most iterations from one start.
    looks : int
        Places of every segment that are looked at for obstacles.
    push : float
        How far a key point is pushed, as a share of what is missing.
    margin : float
        Clearance that a push aims for, in robot lengths.
    stretch : bool
        Whether segments may change the lengths that the start gave them, within their limits.
    """

    method: ClassVar[str] = "fabrik_avoid"
    capabilities: ClassVar[Capabilities] = Capabilities("Wu et al. 2022", obstacles=True)

    iterations: int = count(300, 1, 1_000_000)
    looks: int = count(8, 1, 10_000)
    push: float = number(1.5, above=0.0)
    margin: float = number(0.002, low=0.0)
    stretch: bool = flag(True)

    def compiled(self, robot: Robot, scene: Scene) -> Compiled:
        """Return the compiled search; see `Options.compiled`."""
        return compiled_search(search, scratch_size(len(robot)), self.vector(), robot, scene)
