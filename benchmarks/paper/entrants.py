"""Who takes part: every registered method, as a user calls it, and `opti_path` also as published."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import sinuous as sn
from benchmarks.harness.markdown import table
from benchmarks.problems import ProblemSet
from sinuous.files.nouns import read_robot
from sinuous.methods.learned.network import Network
from sinuous.methods.learned.search import Learned
from sinuous.methods.learned.training import train
from sinuous.methods.method import METHODS, Capabilities, capabilities, name_of
from sinuous.methods.opti_path.options import OptiPath

STEP, ALONE = "learned, one step", "learned, alone"
"""Labels of the method that has learned with one step after the answer of its network, and with none."""

FAITHFUL, DIFFERENCES = "opti_path, faithful", "opti_path, differences"
"""Labels of `OptiPath.faithful()`, and of the repaired method with the gradient of the paper."""


@dataclass(frozen=True)
class Entrant:
    """A method that takes part.

    Attributes
    ----------
    label : str
        Its name in tables and figures.
    method : str or options
        What `Solver` takes as `method`.
    tolerance : Tolerance, optional
        What it aims for, where that is more than the problems ask for.
    """

    label: str
    method: Any
    tolerance: sn.Tolerance | None = None

    @property
    def capabilities(self) -> Capabilities:
        """What the method handles."""
        return capabilities(self.method)

    @property
    def limits(self) -> tuple[str, ...]:
        """Which limits it takes account of: `opti_path` without a weight on bends sees lengths alone."""
        if isinstance(self.method, OptiPath) and self.method.bend_weight == 0.0:
            return ("length",)
        return self.capabilities.limits

    def solver(self, problems: ProblemSet, seconds: float, seed: int) -> sn.Solver:
        """Prepare it, to spend at most `seconds` on a solve."""
        method = self.method
        if isinstance(method, Learned):
            place = problems.scene if len(problems.scene) else None
            method = replace(method, network=_trained(json.dumps(problems.robot.to_dict()), place))
        return sn.Solver(
            problems.robot,
            problems.scene,
            tolerance=self.tolerance or problems.tolerance,
            method=method,
            time=seconds,
            seed=seed,
        )

    def refusal(self, problems: ProblemSet) -> str:
        """Say what of these problems the method does not handle; empty when it takes part.

        Limits are no reason: an answer that violates one counts as a failure.
        """
        can, name = self.capabilities, name_of(self.method)
        learned = isinstance(self.method, Learned)  # from answers among these obstacles
        if len(problems.scene) and not (can.obstacles or learned):
            return "does not avoid obstacles"
        problem = sn.Problem(problems.robot, problems.targets[0], problems.scene, problems.tolerance)
        try:
            can.refuse_robot(name, problems.robot)
            can.refuse_targets(name, problem.rows, len(problems.robot))
        except sn.InputError as error:
            return f"{error.key}: takes {error.expected}"
        return ""


@lru_cache(32)
def _trained(robot: str, scene: sn.Scene | None) -> Network:
    """What was learned of a robot, given as JSON, in a scene, for all that take part."""
    return train(read_robot(json.loads(robot)), scene)


def entrants(names: Sequence[str] = ()) -> list[Entrant]:
    """Return the methods of these names, by default all; after `opti_path` what the paper says without our repairs.

    After `learned`, which goes on to the target, come the answer of its network with one step and with none.

    Raises
    ------
    InputError
        When there is no such method.
    """
    found = []
    for name in names or METHODS:
        name_of(name)
        found.append(Entrant(name, Learned() if name == "learned" else name))
        if name == "opti_path":
            found.append(Entrant(FAITHFUL, OptiPath.faithful()))
        if name == "learned":
            found += [Entrant(STEP, Learned(steps=1)), Entrant(ALONE, Learned(steps=0))]
    return found


def gradients(names: Sequence[str] = ()) -> list[Entrant]:
    """Return, as far as they are among these names, our own method, and `opti_path` with both of its gradients."""
    both = [Entrant("opti_path", "opti_path"), Entrant(DIFFERENCES, OptiPath(gradient="differences"))]
    everyone = [Entrant("newton", "newton"), *both]
    return [entrant for entrant in everyone if not names or name_of(entrant.method) in names]


def divide(everyone: Sequence[Entrant], problems: ProblemSet) -> tuple[list[Entrant], dict[str, str]]:
    """Return who takes part, and why the others do not."""
    reasons = {entrant.label: entrant.refusal(problems) for entrant in everyone}
    return [entrant for entrant in everyone if not reasons[entrant.label]], {k: v for k, v in reasons.items() if v}


def roster(everyone: Sequence[Entrant], unable: dict[str, str]) -> str:
    """Return a table of the methods: which limits they see, where they are described."""
    rows = [["method", "takes account of limits on", "takes part", "source"]]
    for entrant in everyone:
        can = entrant.capabilities
        part = unable.get(entrant.label)
        part = "yes" if part is None else f"no: {part}"
        rows.append([entrant.label, ", ".join(entrant.limits) or "nothing", part, can.source])
    return table(rows, words=True)
