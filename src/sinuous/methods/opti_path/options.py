"""The method of Sun & Wang: the robot as a path of arcs, moved like a path among obstacles until it fits.

The paper leaves parameters open and has formulas that cannot be meant; what was chosen stands with each option. All
lengths among the options are in mean lengths of a segment, so that one setting serves robots of all sizes.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar, Self, Unpack, get_args

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.methods.method import Capabilities, Options, choice, count, flag, number
from sinuous.methods.opti_path.gradient import (
    Exponent,
    Gradient,
    Metric,
    OptiPathArguments,
    OrientationCost,
    PotentialKind,
    Schedule,
)
from sinuous.methods.opti_path.path import sample
from sinuous.methods.opti_path.search import scratch_size, search
from sinuous.model.robot import Robot
from sinuous.scene.scene import Scene

MOST_NODES = 2**24
"""Most nodes of the grid that the potential is sampled on (128 MiB)."""

EXTENT = 200
"""Nodes along an edge of the grid, at most, when the spacing is left open."""

FAITHFUL: Mapping[str, Any] = {
    "gradient": "differences",
    "attenuation": 0.01,
    "orientation_weight": 0.3,
    "schedule": "constant",
    "metric": "acceleration",
    "regularisation": 10.0,
    "arcs_weight": 1.0,
    "blend": 0.0,
    "obstacle_weight": 0.1,
    "dead_band": 0.0,
    "bend_weight": 0.0,
    "bow": 0.0,
    "other_guess": False,
    "restarts": False,
    "settle": 0,
}
"""Where the paper's method differs from the repaired one."""


@dataclass(frozen=True, repr=False)
class OptiPath(Options):
    """Options of the method `opti_path`. The defaults are the repaired method; `OptiPath.faithful()` is the paper's.

    On the command line the latter is `preset=faithful`. Segments must be able to stretch: the end is fixed, so what a
    solve has to find are lengths within their ranges, and a range of one number is never met exactly.

    Parameters
    ----------
    gradient : str
        `adjoint`: exact, by one sweep backwards, linear in the number of segments. `differences`: central differences
        over every coordinate of every point, as in the paper, quadratic.
    disturbance : float
        Step of the differences.
    attenuation : float
        The paper's alpha: how much less an arc counts for every arc between it and the point that is moved.
    exponent : str
        `adjacent`: both arcs that meet in a point count in full. `literal`: the paper's formula, where the arc after
        the point counts alpha already; with a small alpha it does not converge.
    orientation : str
        Cost of the last tangent: `squared` difference to the target's, or its `norm` as in the paper's words, which
        has a kink at the solution.
    length_weight, orientation_weight, obstacle_weight : float
        The paper's alpha_2, alpha_3, alpha_1.
    schedule : str
        How weights change, the paper's "simulated annealing" made deterministic: `constant`; `length` or `orientation`
        (that one rises to its weight while the other falls to a tenth); `cooling` (all fall to a tenth); `gated` (what
        is met counts nothing while it is, so that it does not pull against what is not).
    cooling : float
        Factor of the temperature from one iteration to the next.
    metric : str
        The paper's A: `identity`, `difference` (K, of neighbouring points), `acceleration` (K'K).
    regularisation : float
        The paper's lambda.
    largest_step : float
        Most that a point moves in one iteration; 0: no limit.
    slope, influence : float
        k_o and epsilon of the potential.
    arcs_weight : float
        The paper's beta: weight of the samples on the arcs against that of the points.
    samples : int
        Samples between the ends of every arc.
    project : bool
        Whether updates for obstacles are taken across the path only.
    potential : str
        `grid`: sampled beforehand and interpolated, as in the paper. `exact`: from the obstacles each time.
    spacing : float
        Of the grid; 0: a tenth of a segment, or a 200th of the reach where that is more.
    iterations : int
        Most iterations from one start.
    blend : float
        An initial configuration is carried to the target by moving point i of n by the share `(i / n) ^ blend`; 0: only
        the last.
    dead_band : float
        Share of the range of lengths that costs nothing; 0: lengths are drawn to the mean, as in the paper.
    bend_weight : float
        Weight of bends beyond their limit; 0: there is none in the paper.
    bow : float
        How far a path straight ahead is bowed aside, where symmetry would keep it straight; 0: not.
    other_guess : bool
        Whether a swung curve is tried besides the single arc, and before it where the arc is too long.
    restarts : bool
        Whether to go on when everything before failed: from the initial configuration bowed aside, before the single
        arc, then from bowed arcs and scattered shapes.
    settle : int
        Iterations after the first solved path, among obstacles: it is moved away from them and from the limits before
        it is handed over, so that the next solve, which starts from it, does not get caught.
    """

    compiled_search = staticmethod(search)
    method: ClassVar[str] = "opti_path"
    capabilities: ClassVar[Capabilities] = Capabilities(
        "Sun & Wang, An Optimization-Based Inverse Kinematics Solver for Continuum Manipulators in Intricate "
        "Environments",
        tool=False,
        obstacles=True,
    )
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = MappingProxyType({"faithful": FAITHFUL})

    gradient: Gradient = choice("adjoint", get_args(Gradient))
    disturbance: float = number(2e-4, above=0.0, high=0.1)
    attenuation: float = number(0.5, low=0.0, high=1.0)
    exponent: Exponent = choice("adjacent", get_args(Exponent))
    orientation: OrientationCost = choice("squared", get_args(OrientationCost))
    length_weight: float = number(1.0, low=0.0)
    orientation_weight: float = number(0.25, low=0.0)
    obstacle_weight: float = number(0.3, low=0.0)
    schedule: Schedule = choice("gated", get_args(Schedule))
    cooling: float = number(0.97, above=0.0, high=1.0)
    metric: Metric = choice("difference", get_args(Metric))
    regularisation: float = number(5.0, above=0.0)
    largest_step: float = number(0.2, low=0.0)
    slope: float = number(1.0, low=0.0)
    influence: float = number(0.25, above=0.0)
    arcs_weight: float = number(3.0, low=0.0)
    samples: int = count(8, 0, 1000)
    project: bool = flag(True)
    potential: PotentialKind = choice("grid", get_args(PotentialKind))
    spacing: float = number(0.0, low=0.0)
    iterations: int = count(300, 0, 10**9)
    blend: float = number(2.0, low=0.0)
    dead_band: float = number(0.3, low=0.0, high=1.0)
    bend_weight: float = number(3.0, low=0.0)
    bow: float = number(0.02, low=0.0)
    other_guess: bool = flag(True)
    restarts: bool = flag(True)
    settle: int = count(1, 0, 1000)

    @classmethod
    def faithful(cls, **changes: Unpack[OptiPathArguments]) -> Self:
        """Return the paper's method without repairs, with central differences; `changes` are other options.

        Only what could not work is not literal: the exponent of the attenuation and the square of the orientation cost.
        """
        values: dict[str, Any] = {**FAITHFUL, **changes}
        return cls(**values)

    def scratch(self, segments: int) -> int:
        """Return the size of the scratch; see `Options.scratch`."""
        return scratch_size(segments)

    def told(self, robot: Robot, scene: Scene) -> Floats:
        """All values, then the potential, see `potential.read_potential`: without values where it is not sampled."""
        own = self.vector()
        unit = robot.mean_length / len(robot)
        reach = sum(segment.length[1] for segment in robot.segments)
        spacing = self.spacing * unit if self.spacing > 0.0 else max(0.1 * unit, 2.0 * reach / EXTENT)
        origin = robot.base[:3, 3] - reach - 0.5 * spacing
        place = [*origin, spacing, max(robot.needed_radii)]
        if self.potential == "exact" or len(scene) == 0:
            return np.concatenate([own, [0.0, 0.0, 0.0], place])
        nodes = math.ceil(2.0 * reach / spacing) + 2
        if nodes**3 > MOST_NODES:
            raise InputError(
                "spacing", "too fine for this robot", self.spacing, f"at most {MOST_NODES} nodes of a grid"
            )
        values = np.concatenate([own, [nodes, nodes, nodes], place, np.empty(nodes**3)])
        centre = robot.base[:3, 3].reshape(1, 3).copy()
        sample(scene.snapshot()._kernel_group, values[len(own) :], (self.slope, self.influence * unit), centre, reach)
        return values
