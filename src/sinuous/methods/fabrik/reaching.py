"""FABRIKc and FABRIKx: forward and backward reaching for sections of one or several arcs.

With one segment a section this is FABRIKc: Zhang et al., "FABRIKc: an efficient iterative inverse kinematics solver for
continuum robots" (2018). The paper has segments of fixed length; those that stretch are what others call exFABRIKc, of
which no description could be had.

With several segments a section, bent in a fixed proportion, it is FABRIKx: Kolpashchikov, Gerget & Danilov, "FABRIKx:
tackling the inverse kinematics problem of continuum robots with variable curvature" (Robotics 11, 128, 2022). A section
of variable curvature is planar and has two links, which differ; here as there it is approximated by arcs. Its full text
could not be had, so chosen here are: which sections there are (`pieces` segments in a row are one), and how curvature
varies along them (`taper`). Lengths are those that the start has. Answers are configurations of the robot's segments
like any other.

What else was chosen where the papers could not be had is said in `sinuous.methods.fabrik.links`.
"""

import math
from collections import namedtuple
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.clock import SEGMENT_LOOKS, spend
from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import Array, copy
from sinuous.kernels.problem import Problem
from sinuous.methods.capabilities import Capabilities
from sinuous.methods.fabrik.conversion import axis_of, end_goal, fold, unfold
from sinuous.methods.fabrik.links import Chain, carve_chain, group, reach_back, reach_out
from sinuous.methods.judge import Answer, Check, offer, target_errors
from sinuous.methods.options import Options, count, flag, number
from sinuous.methods.prepared import Compiled
from sinuous.methods.search import Start, begin_from, compiled_search, cut, search_by
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene

PATIENCE = 25
"""Iterations in a row that gain less than a hundredth before a start is given up."""

Work = namedtuple("Work", ["chain", "q", "kept"])
"""Scratch of one solve: the links, the configuration (n, 3) that they stand for, and the best of one start."""


def scratch_size(n: int) -> int:
    """Numbers (float64) of the scratch for n segments, in any sections."""
    return 6 * n + 16 * n + 7


@kernel
def carve(buffer: Array, n: int, sections: int) -> Work:
    """Lay out the scratch in `buffer`, for n segments in so many sections."""
    q, rest = cut(buffer, n, 3)
    kept, rest = cut(rest, n, 3)
    return Work(carve_chain(rest, n, sections), q, kept)


@kernel
def reach(problem: Problem, chain: Chain, frames: Array, q: Array) -> None:
    """One iteration: back from the target and out again to it; fills `q` (n, 3) and `frames` (n + 1, 12)."""
    goal, wanted, aimed = end_goal(problem, frames)
    rotation, base = frame(frames, chain.first[0])
    reach_back(chain, problem.limits, goal, wanted, aimed)
    reach_out(chain, problem.limits, base, axis_of(rotation), wanted, aimed)
    unfold(chain, frames, q)


@kernel
def descend(problem: Problem, check: Check, work: Work, most: int) -> int:
    """Reach back and out until the target is met, nothing is gained any more, or time is over.

    Begins at `work.chain`; fills `work.kept` with the best and returns the number of iterations.
    """
    least, slow = math.inf, 0
    copy(work.q, work.kept)
    for iteration in range(most):
        reach(problem, work.chain, check.frames, work.q)
        off, turn = target_errors(problem, check.frames)
        wrong = off / problem.unit + turn
        slow = 0 if wrong < 0.99 * least else slow + 1
        if wrong < least:
            least = wrong
            copy(work.q, work.kept)
        met = off <= problem.position_tolerance and turn <= problem.angle_tolerance
        if met or slow >= PATIENCE or spend(check.clock, SEGMENT_LOOKS * work.q.shape[0]):
            return iteration + 1
    return most


@kernel
def follow(
    problem: Problem, check: Check, scratch: Array, options: Array, start: Start, answer: Answer
) -> tuple[int, bool]:
    """Follow one start; see `sinuous.methods.search`.

    `options` (4,): most iterations from one start, segments of a section, their taper, and whether lengths may change.
    """
    n, pieces = problem.limits.shape[0], int(options[1])
    work = carve(scratch, n, (n + pieces - 1) // pieces)
    group(work.chain, n, pieces, options[2])
    source = begin_from(problem, check, start, work.q)
    fold(problem.limits, work.chain, check.frames, options[3] != 0.0, work.q)
    used = descend(problem, check, work, int(options[0]))
    return used, offer(problem, check, work.kept, source, answer)


search = search_by(follow)


@dataclass(frozen=True, repr=False)
class Fabrikc(Options):
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

    def compiled(self, robot: Robot, scene: Scene) -> Compiled:
        """Return the compiled search; see `Options.compiled`."""
        one_segment_a_section = np.array([float(self.iterations), 1.0, 0.0, float(self.stretch)])
        return compiled_search(search, scratch_size(len(robot)), one_segment_a_section, robot, scene)


@dataclass(frozen=True, repr=False)
class Fabrikx(Options):
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

    def compiled(self, robot: Robot, scene: Scene) -> Compiled:
        """Return the compiled search; see `Options.compiled`."""
        no_stretch = np.array([*self.vector(), 0.0])
        return compiled_search(search, scratch_size(len(robot)), no_stretch, robot, scene)
