"""FABRIKc, FABRIKx and FABRIK with obstacle avoidance: forward and backward reaching for sections of arcs.

With one segment a section this is FABRIKc: Zhang et al., "FABRIKc: an efficient iterative inverse kinematics solver for
continuum robots" (2018). The paper has segments of fixed length; those that stretch are what others call exFABRIKc, of
which no description could be had.

With several segments a section, bent in a fixed proportion, it is FABRIKx: Kolpashchikov, Gerget & Danilov, "FABRIKx:
tackling the inverse kinematics problem of continuum robots with variable curvature" (Robotics 11, 128, 2022). A section
of variable curvature is planar and has two links, which differ; here as there it is approximated by arcs. Its full text
could not be had, so chosen here are: which sections there are (`pieces` segments in a row are one), and how curvature
varies along them (`taper`). Lengths are those that the start has. Answers are configurations of the robot's segments
like any other.

FABRIK with obstacle avoidance is FABRIKc that steps aside: Wu et al., "A novel obstacle avoidance heuristic algorithm
of continuum robot based on FABRIK" (2022), which could not be had either. After every iteration each segment is looked
at in some places; where one is inside an obstacle, the joints that shape the segment (its key points) are moved away
from the obstacle, along the gradient of the distance. Chosen here are the places, that the deepest of a segment counts,
that its own joint moves by all of a push and the joint before by half, and that the push aims a little beyond contact,
farther whenever the proof of the whole body finds an overlap that the places had missed.

What else was chosen where the papers could not be had is said in `sinuous.methods.fabrik.links`.
"""

import math
from collections import namedtuple
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.body.sampling import sampled_clearance
from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.clock import SEGMENT_WORK, over, spend
from sinuous.kernels.fields.distances import obstacle, work_of_all
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import Array, add_scaled, copy, get_vec, put_vec
from sinuous.kernels.problem import Problem
from sinuous.methods.fabrik.links import (
    Chain,
    axis_of,
    carve_chain,
    end_goal,
    fold,
    group,
    reach_back,
    reach_out,
    unfold,
)
from sinuous.methods.method import Capabilities, Options, count, flag, number
from sinuous.methods.search import Answer, Check, Start, begin_from, has_obstacles, offer, search_by, target_errors
from sinuous.model.robot import Robot
from sinuous.scene.scene import Scene

PATIENCE, PATIENCE_ASIDE = 25, 40
"""Iterations in a row that gain less than a hundredth before a start is given up; the same while it steps aside."""

Work = namedtuple("Work", ["chain", "q", "kept"])
"""Scratch of one solve: the links, the configuration (n, 3) that they stand for, and the best of one start."""

Aside = namedtuple("Aside", ["looks", "push", "margin"])
"""How obstacles are avoided: places of every segment that are looked at, none where they are not avoided; how far a
joint is moved, as a share of what is missing to a clearance; and that clearance (length unit)."""


def scratch_size(segments: int) -> int:
    """Numbers (float64) of the scratch for so many segments, in any sections."""
    return 22 * segments + 7


def carve(buffer: Array, n: int, sections: int) -> Work:
    """Lay out the scratch in `buffer`, for n segments in so many sections."""
    q, rest = cut(buffer, n, 3)
    kept, rest = cut(rest, n, 3)
    return Work(carve_chain(rest, n, sections), q, kept)


def reach(problem: Problem, chain: Chain, frames: Array, q: Array) -> None:
    """One iteration: back from the target and out again to it; fills `q` (n, 3) and `frames` (n + 1, 12)."""
    goal, wanted, aimed = end_goal(problem, frames)
    rotation, base = frame(frames, chain.first[0])
    reach_back(chain, problem.limits, goal, wanted, aimed)
    reach_out(chain, problem.limits, base, axis_of(rotation), wanted, aimed)
    unfold(chain, frames, q)


def push_away(problem: Problem, check: Check, chain: Chain, q: Array, aside: Aside) -> float:
    """Move the joints of segments that overlap; returns the deepest overlap that was seen.

    `q` (n, 3) is the configuration, the frames of `check` what follows from it. Segments are looked at while there is
    time.
    """
    if aside.looks == 0 or not has_obstacles(problem):
        return 0.0
    overlap = travel = 0.0
    cost = aside.looks * work_of_all(problem.scene)
    for k in range(q.shape[0]):
        if spend(check.clock, cost):
            break
        rotation, position = frame(check.frames, k)
        clearance, which, place = sampled_clearance(
            problem, rotation, position, get_vec(q, k, 0), k, travel, aside.looks
        )
        travel += q[k, 2]
        overlap = max(overlap, -clearance)
        if clearance < 0.0:
            _, away = obstacle(problem.scene, which, place, math.inf)
            push = aside.push * (aside.margin - clearance)
            put_vec(chain.joints, k, 0, add_scaled(get_vec(chain.joints, k, 0), push, away))
            if k > 0:
                put_vec(chain.joints, k - 1, 0, add_scaled(get_vec(chain.joints, k - 1, 0), 0.5 * push, away))
    return overlap


def descend(problem: Problem, check: Check, work: Work, most: int, aside: Aside) -> tuple[int, bool]:
    """Reach back and out, and step aside, until the target is met, nothing is gained any more, or time is over.

    Begins at `work.chain`; fills `work.kept` with the best. Returns the number of iterations, and whether the target is
    met by a shape that is clear in the places that were looked at.
    """
    patience = PATIENCE if aside.looks == 0 else PATIENCE_ASIDE
    least, slow = math.inf, 0
    copy(work.q, work.kept)
    for iteration in range(most):
        reach(problem, work.chain, check.frames, work.q)
        off, turn = target_errors(problem, check.frames)
        overlap = push_away(problem, check, work.chain, work.q, aside)
        wrong = (off + overlap) / problem.unit + turn
        met = off <= problem.position_tolerance and turn <= problem.angle_tolerance and overlap == 0.0
        slow = 0 if wrong < 0.99 * least else slow + 1
        if wrong < least or met:
            least = wrong
            copy(work.q, work.kept)
        if met or slow >= patience or spend(check.clock, SEGMENT_WORK * work.q.shape[0]):
            return iteration + 1, met
    return most, False


def follow(
    problem: Problem, check: Check, scratch: Array, options: Array, start: Start, answer: Answer
) -> tuple[int, bool]:
    """Follow one start; see `sinuous.methods.search`. The `options` (7,): see `TOLD`.

    Where obstacles are avoided and the proof finds an overlap that was not seen, the margin doubles; there is as much
    patience for all of that as for nothing that is gained.
    """
    n, most, pieces, looks = problem.limits.shape[0], int(options[0]), int(options[1]), int(options[4])
    work = carve(scratch, n, (n + pieces - 1) // pieces)
    group(work.chain, n, pieces, options[2])
    source = begin_from(problem, check, start, work.q)
    fold(problem.limits, work.chain, check.frames, options[3] != 0.0, work.q)
    used, left, margin = 0, most, options[6] * problem.unit
    while True:
        more, met = descend(problem, check, work, left, Aside(looks, options[5], margin))
        used += more
        solved = offer(problem, check, work.kept, source, answer)
        if solved or not met or looks == 0 or over(check.clock):
            return used, solved
        left, margin = min(left - more, PATIENCE_ASIDE), 2.0 * margin


search = search_by(follow)


TOLD = {"iterations": 1, "pieces": 1, "taper": 0.0, "stretch": False, "looks": 0, "push": 0.0, "margin": 0.0}
"""Options in the order in which the kernel reads them, each with its value for methods that do not have it."""


class Fabrik(Options):
    """What the three methods have in common."""

    compiled_search = staticmethod(search)

    scratch = staticmethod(scratch_size)

    def told(self, robot: Robot, scene: Scene) -> Floats:
        """Return the options as the kernel reads them; see `Options.told`."""
        return np.array([getattr(self, name, other) for name, other in TOLD.items()], np.float64)


@dataclass(frozen=True, repr=False)
class Fabrikc(Fabrik):
    """Options of the method `fabrikc`.

    Attributes
    ----------
    iterations : int
        Most iterations from one start; each goes from the tip to the base and back.
    stretch : bool
        Whether segments may change the lengths that the start gave them, within their limits (exFABRIKc).
    """

    method: ClassVar[str] = "fabrikc"
    capabilities: ClassVar[Capabilities] = Capabilities("Zhang et al. 2018")

    iterations: int = count(300, 1, 1_000_000)
    stretch: bool = flag(True)


@dataclass(frozen=True, repr=False)
class Fabrikx(Fabrik):
    """Options of the method `fabrikx`.

    Attributes
    ----------
    iterations : int
        Most iterations from one start; each goes from the tip to the base and back.
    pieces : int
        Segments in a row that are bent together as one section; the last section has what is left.
    taper : float
        How bends vary along a section of p segments: as `1 + taper (2 (j + 1/2) / p - 1)`, j = 0 ... p - 1. From
        -0.9 to 0.9; 0 bends all alike.
    """

    method: ClassVar[str] = "fabrikx"
    capabilities: ClassVar[Capabilities] = Capabilities("Kolpashchikov et al. 2022")

    iterations: int = count(300, 1, 1_000_000)
    pieces: int = count(1, 1, 10_000)
    taper: float = number(0.0, low=-0.9, high=0.9)


@dataclass(frozen=True, repr=False)
class FabrikAvoid(Fabrik):
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
