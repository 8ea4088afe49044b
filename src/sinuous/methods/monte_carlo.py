"""Monte Carlo: draw configurations at random about the best so far, from a range that shrinks.

Qin et al., "A snake-inspired layer-driven continuum robot" (2022), where it solves the inverse kinematics.

A round draws configurations evenly from the range about the best so far; one that is better takes its place at once.
After a round without a better one the range shrinks. The range of a bend's components is twice the largest bend (half
a turn at most), that of a length its own. What is drawn outside the limits is put back within them. Of the paper only
what others say of it could be had; chosen here are the even draws, the squared errors and overlaps that are compared,
and when the range shrinks (after every round, as one might read it, it closed in on the wrong place from two of three
starts).
"""

import math
from collections import namedtuple
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sinuous.kernels.body.sampling import sampled_clearance
from sinuous.kernels.chain.kinematics import forward, frame
from sinuous.kernels.clock import SEGMENT_WORK, over, spend
from sinuous.kernels.fields.distances import work_of_all
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import Array, copy, get_vec, put_vec
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.actuation import straighten
from sinuous.kernels.step.limits import bend_cap, project_segment
from sinuous.kernels.tables import GIVEN, MAX_LENGTH, MIN_LENGTH
from sinuous.methods.method import LIMITS, Capabilities, Options, count, number
from sinuous.methods.search import Answer, Check, Start, begin_from, has_obstacles, offer, search_by, target_errors

LOOKS = 8
"""Places of every segment that are looked at for obstacles."""

NEAR_GIVEN = 0.1
"""Range about an initial configuration, as a share of the whole."""

FINEST = 1e-12
"""Range at which a start is given up, as a share of the whole."""

MARGIN = 1e-6
"""Clearance that is asked for where the proof of the whole body failed, in robot lengths; it doubles every time."""

Work = namedtuple("Work", ["q", "trial", "straight", "state"])
"""Scratch of one solve: the best, a draw, what `straighten` needs (all (n, 3)), and the state of the random numbers."""


def carve(buffer: Array, n: int) -> Work:
    """Lay out the scratch in `buffer` (9 n + 1,), for n segments."""
    q, rest = cut(buffer, n, 3)
    trial, rest = cut(rest, n, 3)
    straight, rest = cut(rest, n, 3)
    return Work(q, trial, straight, rest[:1].view(np.uint64))


def draw(state: Array) -> float:
    """The next number in [-1, 1) of a `state` (1,) of unsigned integers (Steele et al. 2014, splitmix64)."""
    state[0] += np.uint64(0x9E3779B97F4A7C15)
    z = state[0]
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return float((z ^ (z >> np.uint64(31))) >> np.uint64(11)) * 2.0**-52 - 1.0


def project_to_limits(problem: Problem, q: Array, straight: Array) -> None:
    """Bring `q` (n, 3) within all limits; `straight` (n, 3) is scratch."""
    for k in range(q.shape[0]):
        put_vec(q, k, 0, project_segment(problem.limits, k, q[k, 0], q[k, 1], q[k, 2]))
    straighten(problem.limits, problem.actuation, q, straight)


def scatter(problem: Problem, work: Work, share: float) -> None:
    """Draw a configuration into `work.trial`, from this share of the whole range about `work.q`."""
    for k in range(work.q.shape[0]):
        low, high = problem.limits[k, MIN_LENGTH], problem.limits[k, MAX_LENGTH]
        bend = share * min(math.pi, bend_cap(problem.limits, k, high))
        ux, uy, length = get_vec(work.q, k, 0)
        ux, uy = ux + bend * draw(work.state), uy + bend * draw(work.state)
        length += 0.5 * share * (high - low) * draw(work.state)
        put_vec(work.trial, k, 0, (ux, uy, length))
    project_to_limits(problem, work.trial, work.straight)


def judge(problem: Problem, check: Check, q: Array, margin: float, enough: float) -> tuple[float, bool]:
    """What is wrong with `q` (n, 3), squared, in robot lengths and rad, and whether it may be an answer.

    Obstacles are looked at only when the rest is better than `enough`.
    """
    forward(problem.limits, q, check.frames)
    off, turn = target_errors(problem, check.frames)
    wrong = off * off / (problem.unit * problem.unit) + turn * turn
    met = off <= problem.position_tolerance and turn <= problem.angle_tolerance
    if not has_obstacles(problem) or wrong >= enough:
        return wrong, met
    overlap = travel = 0.0
    for k in range(q.shape[0]):
        rotation, position = frame(check.frames, k)
        clearance, _, _ = sampled_clearance(problem, rotation, position, get_vec(q, k, 0), k, travel, LOOKS)
        travel += q[k, 2]
        overlap = max(overlap, margin - clearance)
    return wrong + overlap * overlap / (problem.unit * problem.unit), met and overlap == 0.0


def descend(
    problem: Problem, check: Check, work: Work, options: Array, source: int, answer: Answer
) -> tuple[int, bool]:
    """Draw in rounds until an answer is solved, the range is used up, or time is over.

    Begins at `work.q`; returns the number of rounds, and whether an answer is solved. `options` (3,): see `follow`.
    """
    share = NEAR_GIVEN if source == GIVEN else 1.0
    rounds, samples, shrink = int(options[0]), int(options[1]), options[2]
    margin = 0.0
    cost = work.q.shape[0] * (SEGMENT_WORK + LOOKS * work_of_all(problem.scene))
    least, met = judge(problem, check, work.q, margin, math.inf)
    for done in range(rounds + 1):
        if met:
            if offer(problem, check, work.q, source, answer):
                return done, True
            margin = max(2.0 * margin, MARGIN * problem.unit)
            least, met = judge(problem, check, work.q, margin, math.inf)
        if done == rounds or share < FINEST or over(check.clock):
            return done, offer(problem, check, work.q, source, answer)
        before = least
        for _ in range(samples):
            if spend(check.clock, cost):
                break
            scatter(problem, work, share)
            wrong, found = judge(problem, check, work.trial, margin, least)
            if wrong < least or (found and not met):
                least, met = wrong, found
                copy(work.trial, work.q)
                if met:
                    break
        if not least < before:
            share *= shrink
    return rounds, False


def follow(
    problem: Problem, check: Check, scratch: Array, options: Array, start: Start, answer: Answer
) -> tuple[int, bool]:
    """Follow one start; see `sinuous.methods.search`. The `options` are the fields of `MonteCarlo`."""
    work = carve(scratch, problem.limits.shape[0])
    work.state[0] = np.uint64(start.seed) * np.uint64(0x100000000) + np.uint64(start.first + start.index)
    source = begin_from(problem, check, start, work.q)
    project_to_limits(problem, work.q, work.straight)
    return descend(problem, check, work, options, source, answer)


search = search_by(follow)


@dataclass(frozen=True, repr=False)
class MonteCarlo(Options):
    """Options of the method `monte_carlo`.

    Attributes
    ----------
    rounds : int
        Most rounds from one start. They are the iterations of a solution.
    samples : int
        Configurations drawn in a round.
    shrink : float
        What is left of the range after a round that found nothing better.
    """

    compiled_search = staticmethod(search)
    method: ClassVar[str] = "monte_carlo"
    capabilities: ClassVar[Capabilities] = Capabilities(
        "Qin et al. 2022",
        rotation=True,
        orientation_alone=True,
        several_targets=True,
        limits=LIMITS,
        obstacles=True,
        planes=True,
    )

    rounds: int = count(2000, 1, 1_000_000)
    samples: int = count(50, 1, 1_000_000)
    shrink: float = number(0.8, above=0.0, high=1.0)

    def scratch(self, segments: int) -> int:
        """Return the size of the scratch; see `Options.scratch`."""
        return 9 * segments + 1
