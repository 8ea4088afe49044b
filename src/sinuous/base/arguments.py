"""What users may give, as type checkers see it; at run time `sinuous.base.checks` looks at every value.

NumPy's own `ArrayLike` takes a text, a single number and true or false for an array; these do not.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

Number = float | np.floating[Any] | np.integer[Any]
Whole = int | np.integer[Any]
Truth = bool | np.bool_


class HasArray(Protocol):
    """An array of numbers, or what NumPy can make one of: a data frame, a tensor."""

    def __array__(self) -> NDArray[np.floating[Any] | np.integer[Any]]:
        """Return the array."""
        ...


class HasMatrix(Protocol):
    """A rotation with a matrix, as SciPy's `Rotation` is."""

    def as_matrix(self) -> NDArray[Any]:
        """Return the matrix (3, 3), or many (m, 3, 3)."""
        ...


Vector = HasArray | Sequence[Number]
"""An array with one axis."""

Rows = HasArray | Sequence[Vector]
"""An array with two axes: a configuration (n, 3), points (m, 3)."""

# What stands deeper is one union each time: of several kinds of sequences checkers do not infer which is meant.
Entry = HasArray | Sequence[Number | HasArray | Sequence[Number | HasArray | Sequence[Number]]]
"""What stands in a batch."""

Batch = HasArray | Sequence[Entry]
"""An array with two axes, or with others in front of them."""

Stack = HasArray | Sequence[Number | Entry]
"""An array with at least one axis."""

JointValues = Stack | Mapping[str, Number | Stack]
"""Values (..., j) of the joints that move in the order of `Robot.joint_names`, or (...) under their names."""

Pair = tuple[JointValues, Batch | None]
"""Values (..., j) of the joints of a robot, and q (..., n, 3) of its segments."""

JointsAndBatch = Batch | Pair
"""Configurations of all rows of a robot, or a pair of values of its joints and q of its segments."""

ActuatorValues = Stack | Mapping[str, Number | Stack]
"""Values (..., m) of all actuators in the order of `Robot.actuators`, or (...) under their names."""

Limits = Number | Sequence[Number]
"""A number, or a pair [low, high]."""

OneEach = Number | Vector | Mapping[str, Number]
"""A number for all segments, or one for each (n,), or by their names; what is not named has 0."""

Which = Whole | str
"""A segment: its number, 1 = first, or its name."""

Orientation = HasMatrix | HasArray | Sequence[Number | Vector]
"""A rotation: a quaternion (4,), a matrix (3, 3), or a `Rotation` of SciPy."""

Orientations = HasMatrix | Batch
"""Rotations: quaternions (m, 4), matrices (m, 3, 3), or a `Rotation` of SciPy that holds many."""

Names = list[str] | tuple[str, ...]
"""Names; a single text is none."""

Triangles = NDArray[np.integer[Any]] | Sequence[Sequence[Whole] | NDArray[np.integer[Any]]]
"""Vertex numbers (m, 3)."""

_Cells = HasArray | NDArray[np.bool_]

Occupancy = _Cells | Sequence[_Cells | Sequence[_Cells | Sequence[Number | Truth]]]
"""Numbers or truth values (nx, ny, nz)."""

MethodName = Literal[
    "newton", "opti_path", "dls", "fabrikc", "slinki", "fabrikx", "fabrik_avoid", "monte_carlo", "learned"
]
"""All methods, as `sinuous.methods.method` has them."""

SelfCollision = Literal["avoid", "allow"]
"""What may be said of a body that runs through itself."""

StartKind = Literal["given", "arc", "random", "route", "remembered"]
"""Where a start comes from."""

Reconfigure = Literal["refuse", "allow"]
Shortest = Literal["configuration", "actuators"]
"""What a motion may be shortest in."""

LimitKind = Literal["length", "bend", "curvature", "actuator"]

RateKind = Literal["length_rate", "bend_rate", "actuator_rate"]

Constraint = Literal[LimitKind, RateKind, "clearance", "self_clearance"]
"""What may hold a configuration back."""

Parameter = Literal[
    "target", "base", "tool", "lengths", "bends", "curvatures", "radii", "tendons", "actuators", "obstacles", "initial"
]
"""What an answer can be derived by."""

LoadParameter = Literal["loads", "payload", "gravity", "stiffness", "base", "q", "actuators", "tensions"]
"""What a shape under load can be derived by."""

LeaderParameter = Literal["advance", "curve", "base", "lengths"]
"""What a shape on a curve can be derived by."""

StepConstraint = Literal[
    "length",
    "bend",
    "curvature",
    "actuator",
    "clearance",
    "self_clearance",
    "length_rate",
    "bend_rate",
    "actuator_rate",
    "acceleration",
]
"""What may hold a step of a control loop back: kinds of `sinuous.kernels.velocity.layout`, which a test holds equal."""

StepStatus = Literal["reached", "held_back", "cut_short", "touching"]
"""How such a step ended."""

BoundName = Literal["length", "near", "aside", "behind", "turning", "target", "base", "route"]
"""What may prove that there is no solution."""
