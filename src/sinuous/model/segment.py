"""One piece of a robot that bends into a circular arc and may stretch, and the arc parameters of the literature."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypedDict, Unpack

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Limits, Number, Stack, Vector, Whole
from sinuous.base.checks import Floats
from sinuous.base.documents import described, plain
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen, call, text
from sinuous.model.actuators import Chambers, Stage, Tendons
from sinuous.model.names import optional_name

COORDINATES = ("bend_x", "bend_y", "length")
"""Names of the numbers that a configuration has for a segment: rad, rad, and the length unit."""


class Stiffness(Frozen):
    """Stiffness of a segment, as of a rod with one cross-section; force and length in the units of the robot.

    Parameters
    ----------
    bend : float, optional
        EI, force x length^2: the moment that bends a rod of length `l` by an angle `b` is EI b / l.
    twist : float, optional
        GJ, force x length^2; by default the rod does not twist.
    stretch : float, optional
        EA, force; by default the rod does not stretch.
    youngs_modulus, radius : float, optional
        Force / length^2, and length: those of a round rod that has these stiffnesses, instead of them.
    poisson : float, optional
        Poisson's ratio of that rod, for its twist; by default 0.3.

    Raises
    ------
    InputError
        When a number is not greater than 0, or both ways to say it are mixed.
    """

    bend: float
    twist: float
    stretch: float

    def __init__(
        self,
        bend: Number | None = None,
        twist: Number | None = None,
        stretch: Number | None = None,
        *,
        youngs_modulus: Number | None = None,
        poisson: Number | None = None,
        radius: Number | None = None,
    ) -> None:
        if bend is None:
            if youngs_modulus is None or radius is None:
                raise InputError("bend", "missing", None, "bend, or youngs_modulus and radius")
            young = checks.number("youngs_modulus", youngs_modulus, above=0.0)
            half = checks.number("radius", radius, above=0.0)
            ratio = 0.3 if poisson is None else checks.number("poisson", poisson, above=-1.0)
            second = math.pi * half**4 / 4.0
            bend = young * second
            twist = young * second / (1.0 + ratio) if twist is None else twist
            stretch = young * math.pi * half**2 if stretch is None else stretch
        else:
            for key, value in (("youngs_modulus", youngs_modulus), ("poisson", poisson), ("radius", radius)):
                if value is not None:
                    raise InputError(
                        key, "cannot be combined with bend", value, "either bend, or youngs_modulus and radius"
                    )
        self._set(
            bend=checks.number("bend", bend, above=0.0),
            twist=math.inf if twist is None else checks.number("twist", twist, above=0.0),
            stretch=math.inf if stretch is None else checks.number("stretch", stretch, above=0.0),
        )


MOST_ARCS = 1000
"""Arcs of one segment under load."""


class SegmentArguments(TypedDict, total=False):
    """Arguments of `Segment`."""

    length: Limits
    max_bend: Number
    max_curvature: Number | None
    radius: Number
    tendons: Tendons | None
    chambers: Chambers | None
    name: str | None
    stage: Stage | None
    stiffness: Stiffness | Number | None
    rest: Vector
    arcs: Whole
    mass: Number


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Segment(Frozen):
    """One constant-curvature piece of a robot, and its limits.

    Parameters
    ----------
    length : float or (float, float)
        Length of the backbone, or its range; one number means inextensible. The lower end may be 0 (an insertion
        stage).
    max_bend : float
        Largest norm of the bending vector, rad; 0 = the segment cannot bend.
    max_curvature : float, optional
        Largest bend divided by length, in 1 / length unit.
    radius : float
        Radius of the body.
    tendons : Tendons, optional
        Tendons that end at the end of this segment.
    chambers : Chambers, optional
        Chambers along this segment.
    name : str, optional
        By default the robot calls its segments `s1`, `s2`, ... from base to tip.
    stage : Stage, optional
        A motor that sets the length of this segment.
    stiffness : Stiffness or float, optional
        How hard it is to bend, which elastic tendons and chambers need; a number is EI, force x length^2.
    rest : array_like (2,)
        Bend that it has by itself, where elastic actuators leave it alone, rad.
    arcs : int
        Of how many arcs it is under load (`Robot.shape`); without a load all of them are alike.
    mass : float
        Per length; its weight is mass x gravity.

    Raises
    ------
    InputError
        When a limit is negative, NaN, or the wrong way round, or when the straight segment breaks a limit of its
        chambers, or a stage is to move a segment whose length is fixed.
    """

    length: tuple[float, float]
    max_bend: float
    max_curvature: float
    radius: float
    tendons: Tendons | None
    chambers: Chambers | None
    name: str | None
    stage: Stage | None
    stiffness: Stiffness | None
    rest: Floats
    arcs: int
    mass: float

    def __init__(
        self,
        length: Limits,
        max_bend: Number = math.pi,
        max_curvature: Number | None = None,
        radius: Number = 0.0,
        tendons: Tendons | None = None,
        chambers: Chambers | None = None,
        name: str | None = None,
        stage: Stage | None = None,
        *,
        stiffness: Stiffness | Number | None = None,
        rest: Vector = (0.0, 0.0),
        arcs: Whole = 1,
        mass: Number = 0.0,
    ) -> None:
        low, high = checks.interval("length", length, low=0.0)
        curvature = math.inf if max_curvature is None else checks.number("max_curvature", max_curvature, low=0.0)
        kinds = ("tendons", tendons, Tendons), ("chambers", chambers, Chambers), ("stage", stage, Stage)
        for key, value, kind in kinds:
            checks.instance(key, value, kind | None, f"{kind.__name__} or nothing")
        if chambers is not None:
            least, most = chambers.displacements.T
            low, high = max(low, float(least.max())), min(high, float(most.min()))
            if low > high:
                key = chambers.limited_by
                own = getattr(chambers, key)
                problem = "excludes the straight segment"
                raise InputError(f"chambers.{key}", problem, own, f"lengths that overlap with {length}")
        if stage is not None and low == high:
            raise InputError("stage", "there is nothing to move", stage, f"a length that changes, not {low:g}")
        if stiffness is not None and not isinstance(stiffness, Stiffness):
            stiffness = Stiffness(checks.number("stiffness", stiffness, above=0.0))
        self._set(
            length=(low, high),
            max_bend=checks.number("max_bend", max_bend, low=0.0),
            max_curvature=curvature,
            radius=checks.number("radius", radius, low=0.0),
            tendons=tendons,
            chambers=chambers,
            name=optional_name(name),
            stage=stage,
            stiffness=stiffness,
            rest=checks.array("rest", rest, (2,)),
            arcs=checks.integer("arcs", arcs, 1, MOST_ARCS),
            mass=checks.number("mass", mass, low=0.0),
        )

    def changed(self, **values: Unpack[SegmentArguments]) -> "Segment":
        """Return the same segment with other values of some parameters."""
        return self._changed(values)

    def to_dict(self) -> dict[str, Any]:
        """Return the segment as a problem file says it."""
        low, high = self.length
        return described(self) | {"length": plain(low if low == high else self.length)}

    def __repr__(self) -> str:
        low, high = self.length
        name = [] if self.name is None else [text(self.name)]
        shown = f"length={low:g}" if low == high else f"length={text(self.length)}"
        lines = [
            f"{len(own.angles)} {key}" for key in ("tendons", "chambers") if (own := getattr(self, key)) is not None
        ]
        driven = lines if self.stage is None else [*lines, "stage"]
        return call("Segment", [*name, shown, f"max_bend={self.max_bend:g}", f"radius={self.radius:g}", *driven])


def coordinate_names(segments: Sequence[str]) -> list[str]:
    """Names of all coordinates of segments of these names: `s1.bend_x`, `s1.bend_y`, `s1.length`, ..."""
    return [f"{name}.{key}" for name in segments for key in COORDINATES]


def segment_names(segments: Sequence[Segment]) -> tuple[str, ...]:
    """Names of all segments; by default `s1`, `s2`, ... from base to tip."""
    return tuple(segment.name or f"s{k + 1}" for k, segment in enumerate(segments))


def from_arc_parameters(curvature: Number | Stack, plane_angle: Number | Stack, length: Number | Stack) -> Floats:
    """Configuration (..., 3) of segments with these curvatures (1 / length), bending-plane angles (rad) and lengths.

    Webster & Jones 2010: (kappa, phi, l). The arrays broadcast; `(n,)` arrays make one configuration (n, 3).
    """
    given = (("curvature", curvature), ("plane_angle", plane_angle), ("length", length))
    parts = [checks.stack(key, value, ()) for key, value in given]
    kappa, phi, arc = checks.broadcast("curvature", curvature, *parts)
    return np.stack([kappa * arc * np.cos(phi), kappa * arc * np.sin(phi), arc], axis=-1)


def arc_parameters(q: Stack) -> tuple[Floats, Floats, Floats]:
    """Curvature (1 / length), bending-plane angle (rad; 0 when straight) and length of every segment, each (..., n).

    A segment of length 0 has no curvature unless it is straight (then 0).
    """
    x = checks.stack("q", q, (3,))
    bend = np.hypot(x[..., 0], x[..., 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        curvature = np.where(bend == 0.0, 0.0, bend / x[..., 2])
    if not np.isfinite(curvature).all():
        raise InputError(
            "q", "has a bent segment of length 0", x.tolist(), "a length greater than 0 where there is a bend"
        )
    return curvature, np.arctan2(x[..., 1], x[..., 0]), x[..., 2].copy()


def straight(segments: Sequence[Segment]) -> Floats:
    """Return the straight configuration (n, 3) of segments, each at its mean length."""
    return np.array([(0.0, 0.0, 0.5 * sum(segment.length)) for segment in segments])
