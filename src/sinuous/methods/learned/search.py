"""The method `learned`: the answer of a network, then damped least-squares steps from it.

Thuruthel et al. 2019 and Wu et al. 2021 let networks learn what a robot does; of both only what others say could be
had. Here it is a perceptron for each kind of target, trained with solutions of this library (see `training`). The
steps after it are those of `dls`; without any, the answer is that of the network.
"""

import math
from collections import namedtuple
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self

import numpy as np

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import Array, copy
from sinuous.kernels.problem import Problem
from sinuous.kernels.tables import GIVEN, GOAL, ORIENTATION, REMEMBERED, TARGET_POSITION
from sinuous.methods.dls import carve as carve_steps
from sinuous.methods.dls import descend, scratch_size
from sinuous.methods.learned.network import CAPABILITIES, MOST_WIDTH, Network
from sinuous.methods.learned.training import train
from sinuous.methods.method import Capabilities, OptionKind, Options, count
from sinuous.methods.search import NO_START, Answer, Check, Start, offer, own_number, search_by
from sinuous.model.robot import Robot
from sinuous.scene.scene import Scene

DAMPING, CLAMP = 0.1, 0.5
"""Of the steps: see `Dls`, whose defaults these are."""

Pass = namedtuple("Pass", ["before", "after"])
"""Scratch: the numbers (1025,) that go into a layer and come out of it."""


def carve(buffer: Array) -> tuple[Pass, Array]:
    """Lay out the scratch in `buffer`; returns it and what is left."""
    before, rest = cut(buffer, 1, MOST_WIDTH)
    after, rest = cut(rest, 1, MOST_WIDTH)
    return Pass(before[0], after[0]), rest


def predict(networks: Array, row: Array, scratch: Pass, q: Array) -> None:
    """Fill `q` (n, 3) with the shape for a target `row` (15,), in rad and the length unit.

    `networks` holds, for each kind of orientation: the length of what follows; how many layers; outputs of each; the
    matrices (inputs + 1, outputs), row by row, of which the last row is added.
    """
    at, kind = 0, int(row[ORIENTATION])
    for _ in range(kind):
        at += int(networks[at]) + 1
    layers = int(networks[at + 1])
    sizes = at + 2
    at = sizes + layers
    inputs = 3 if kind == 0 else 6 if kind == 1 else 12
    for i in range(inputs):
        scratch.before[i] = row[TARGET_POSITION + i] if i < 3 else row[GOAL + i - 3]
    for layer in range(layers):
        outputs = int(networks[sizes + layer])
        for j in range(outputs):
            scratch.after[j] = networks[at + inputs * outputs + j]
        for i in range(inputs):
            x = scratch.before[i]
            for j in range(outputs):
                scratch.after[j] += x * networks[at + i * outputs + j]
        at += (inputs + 1) * outputs
        for j in range(outputs):
            scratch.before[j] = scratch.after[j] if layer == layers - 1 else math.tanh(scratch.after[j])
        inputs = outputs
    for i in range(inputs):
        q[i // 3, i % 3] = scratch.before[i]


def follow(
    problem: Problem, check: Check, scratch: Array, options: Array, start: Start, answer: Answer
) -> tuple[int, bool]:
    """Follow one start; see `sinuous.methods.search`. The `options` are the steps, then the networks."""
    own, rest = carve(scratch)
    work = carve_steps(rest, problem.limits.shape[0])
    number, source = own_number(start), REMEMBERED
    if number > 0:
        return NO_START, False
    if number < 0:
        copy(start.initial[start.index], work.q)
        source = GIVEN
    else:
        predict(options[1:], problem.targets[0], own, work.q)
    used = descend(problem, check, work, int(options[0]), DAMPING, CLAMP)
    return used, offer(problem, check, work.kept, source, answer)


search = search_by(follow)


def _network(key: str, value: Any) -> Network | None:
    checks.instance(key, value, Network | None, "a Network, as sn.methods.train returns it")
    return value


@dataclass(frozen=True, repr=False)
class Learned(Options):
    """Options of the method `learned`.

    Attributes
    ----------
    network : Network, optional
        What was learned of this robot; without it, a solver trains one while it is made, as `train` does by default.
    steps : int
        Most damped least-squares steps from the answer of the network; 0: none.
    """

    compiled_search = staticmethod(search)
    method: ClassVar[str] = "learned"
    capabilities: ClassVar[Capabilities] = CAPABILITIES

    network: Network | None = field(default=None, metadata={"kind": OptionKind(_network, read=Network.load)})
    steps: int = count(200, 0, 1_000_000)

    def refuse(self, robot: Robot) -> None:
        """Refuse a network of another robot; see `Options.refuse`."""
        if self.network is not None:
            self.network.check(robot)

    def ready(self, robot: Robot, scene: Scene) -> Self:
        """Train a network where there is none; see `Options.ready`."""
        return self if self.network is not None else replace(self, network=train(robot, scene))

    def scratch(self, segments: int) -> int:
        """Return the size of the scratch; see `Options.scratch`."""
        return 2 * MOST_WIDTH + scratch_size(segments)

    def told(self, robot: Robot, scene: Scene) -> Floats:
        """Return the number of steps, then the networks; see `Options.told`."""
        network = self.ready(robot, scene).network
        assert network is not None
        return np.concatenate([[float(self.steps)], network.table()])
