"""Words and keyword arguments of `OptiPath`, as type checkers see them."""

from typing import Literal, TypedDict

Gradient = Literal["adjoint", "differences"]
Exponent = Literal["adjacent", "literal"]
OrientationCost = Literal["squared", "norm"]
Schedule = Literal["constant", "length", "orientation", "cooling", "gated"]
Metric = Literal["identity", "difference", "acceleration"]
PotentialKind = Literal["grid", "exact"]


class OptiPathArguments(TypedDict, total=False):
    """Options of the method `opti_path`; see `sinuous.methods.opti_path.options.OptiPath`."""

    gradient: Gradient
    disturbance: float
    attenuation: float
    exponent: Exponent
    orientation: OrientationCost
    length_weight: float
    orientation_weight: float
    obstacle_weight: float
    schedule: Schedule
    cooling: float
    metric: Metric
    regularisation: float
    largest_step: float
    slope: float
    influence: float
    arcs_weight: float
    samples: int
    project: bool
    potential: PotentialKind
    spacing: float
    iterations: int
    blend: float
    dead_band: float
    bend_weight: float
    bow: float
    other_guess: bool
    restarts: bool
    settle: int
