"""One piece of a robot that bends into a circular arc and may stretch, and the arc parameters of the literature."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any, ClassVar, TypedDict, Unpack

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Limits, Number, Stack, Vector, Whole
from sinuous.base.checks import Floats, optional_name
from sinuous.base.documents import described, plain
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen, call, text
from sinuous.kernels.packing import BendLine
from sinuous.model.actuators import Chambers, Stage, Tendons

AXIS = 1e-15
"""Sine of an angle up to which a direction is along an axis."""

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


Locked = Vector | Sequence[Number | None]
"""Values that bend_x and bend_y (rad) and the length hold; None for one that is free."""


class SegmentArguments(TypedDict, total=False):
    """Arguments of `Segment`."""

    length: Limits
    max_bend: Limits
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
    plane: Number | None
    locked: Locked | None


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Segment(Frozen):
    """One constant-curvature piece of a robot, and its limits.

    Parameters
    ----------
    length : float or (float, float)
        Length of the backbone, or its range; one number means inextensible. The lower end may be 0 (an insertion
        stage).
    max_bend : float or (float, float)
        Largest norm of the bending vector, rad; 0 = the segment cannot bend. With a `plane`, the least and the largest
        bend in it, or one number for both sides.
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
        Of how many arcs it is under load (`Robot.shape`, whose `error` says what they leave); without a load all of
        them are alike.
    mass : float
        Per length; its weight is mass x gravity.
    plane : float, optional
        It bends in one plane only, in the direction of this angle about the tangent (rad, from bend_x to bend_y) and
        against it. Across the plane it has its `rest`.
    locked : (float, float, float), optional
        Values that bend_x, bend_y and the length hold, as where it is stuck; None for one that is free. A bend may be
        beyond `max_bend`, which says how far it may be bent; a length must be within `length`.

    Attributes
    ----------
    length, max_bend
        What `locked` leaves of them: the range of the length, and the largest norm of the bend.
    bends : float or BendLine
        Bends that it may have: the largest one to all sides, or those in one plane.

    Raises
    ------
    InputError
        When a limit is negative, NaN, or the wrong way round, or when the straight segment breaks a limit of its
        chambers, a stage is to move a segment whose length is fixed, or a pair of bends has no plane.
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
    plane: float | None
    locked: tuple[float | None, ...] | None
    bends: float | BendLine
    own_length: tuple[float, float]
    own_max_bend: float | tuple[float, float]

    rigid: ClassVar[bool] = False
    """Whether it stands for a joint or a link, see `sinuous.model.joints`."""

    _arguments: ClassVar[Mapping[str, str]] = {"length": "own_length", "max_bend": "own_max_bend"}

    def __init__(
        self,
        length: Limits,
        max_bend: Limits = math.pi,
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
        plane: Number | None = None,
        locked: Locked | None = None,
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
        angle = None if plane is None else checks.number("plane", plane)
        most = _bend_limits(max_bend, plane)
        held = None if locked is None else _locked(locked, (low, high))
        bent = checks.array("rest", rest, (2,))
        bends = _bends(most, angle, held, bent)
        fixed = (low, high) if held is None or held[2] is None else (held[2], held[2])
        self._set(
            length=fixed,
            own_length=(low, high),
            max_bend=bends if isinstance(bends, float) else bends.largest,
            own_max_bend=most,
            bends=bends,
            plane=angle,
            locked=held,
            max_curvature=curvature,
            radius=checks.number("radius", radius, low=0.0),
            tendons=tendons,
            chambers=chambers,
            name=optional_name(name),
            stage=stage,
            stiffness=stiffness,
            rest=bent,
            arcs=checks.integer("arcs", arcs, 1, MOST_ARCS),
            mass=checks.number("mass", mass, low=0.0),
        )

    def changed(self, **values: Unpack[SegmentArguments]) -> "Segment":
        """Return the same segment with other values of some parameters."""
        return self._changed(values)

    def to_dict(self) -> dict[str, Any]:
        """Return the segment as a problem file says it."""
        low, high = self.own_length
        return described(self) | {"length": plain(low if low == high else self.own_length)}

    def __repr__(self) -> str:
        low, high = self.length
        name = [] if self.name is None else [text(self.name)]
        shown = f"length={low:g}" if low == high else f"length={text(self.length)}"
        lines = [
            f"{len(own.angles)} {key}" for key in ("tendons", "chambers") if (own := getattr(self, key)) is not None
        ]
        driven = lines if self.stage is None else [*lines, "stage"]
        bent = [] if self.plane is None else [f"plane={self.plane:g}"]
        held = [] if self.locked is None else [f"locked={text(self.locked)}"]
        most = f"max_bend={text(self.own_max_bend)}" if isinstance(self.own_max_bend, tuple) else ""
        most = most or f"max_bend={self.own_max_bend:g}"
        return call("Segment", [*name, shown, *bent, most, *held, f"radius={self.radius:g}", *driven])


def _bend_limits(max_bend: Limits, plane: Number | None) -> float | tuple[float, float]:
    """Check the largest bend, or with a plane the least and the largest one in it."""
    if plane is None:
        if np.iterable(max_bend) and not isinstance(max_bend, (str, bytes, dict)):
            raise InputError("max_bend", "a pair without a plane", max_bend, "one number, or plane, too")
        most: Any = max_bend
        return checks.number("max_bend", most, low=0.0)
    if np.iterable(max_bend):
        return checks.interval("max_bend", max_bend)
    alone: Any = max_bend
    return checks.number("max_bend", alone, low=0.0)


def _locked(value: Locked, length: tuple[float, float]) -> tuple[float | None, ...] | None:
    """Check what is locked; nothing where all coordinates are free."""
    wanted = "[bend_x, bend_y, length], with null for what is free"
    entries: Any = list(value) if np.iterable(value) and not isinstance(value, (str, bytes, dict)) else []
    if len(entries) != len(COORDINATES):
        raise InputError("locked", "", value, wanted)
    held = tuple(None if e is None else checks.number(f"locked[{c}]", e) for c, e in enumerate(entries))
    if held[2] is not None and not length[0] <= held[2] <= length[1]:
        problem = "a length outside the limits of the segment"
        raise InputError("locked[2]", problem, held[2], f"at least {length[0]:g} and at most {length[1]:g}")
    return held if any(each is not None for each in held) else None


def _bends(
    most: float | tuple[float, float], plane: float | None, locked: tuple[float | None, ...] | None, rest: Floats
) -> float | BendLine:
    """Bends that a segment may have."""
    x, y = (None, None) if locked is None else locked[:2]
    if x is not None and y is not None:
        return locked_bend((x, y))
    if x is not None or y is not None:
        if plane is not None:
            raise InputError("locked", "with a plane", locked, "both bends, or none")
        largest = most if isinstance(most, float) else max(map(abs, most))
        value = abs(x or y or 0.0)
        if value > largest:
            raise InputError("locked", "leaves no bend within max_bend", locked, f"at most {largest:g} rad")
        wide = math.sqrt(largest**2 - value**2)
        return BendLine(*(((x, 0.0), (0.0, 1.0)) if x is not None else ((0.0, y or 0.0), (1.0, 0.0))), -wide, wide)
    if plane is not None:
        low, high = (-most, most) if isinstance(most, float) else most
        along = direction_of(plane)
        return BendLine(across(rest, along), along, low, high)
    assert isinstance(most, float)
    return locked_bend((float(rest[0]), float(rest[1]))) if most == 0.0 and rest.any() else most


def direction_of(angle: float) -> tuple[float, float]:
    """Unit vector of an angle (rad), with exact zeros along the axes."""
    x, y = math.cos(angle), math.sin(angle)
    return (math.copysign(1.0, x), 0.0) if abs(y) < AXIS else (0.0, math.copysign(1.0, y)) if abs(x) < AXIS else (x, y)


def across(bend: Floats, along: tuple[float, float]) -> tuple[float, float]:
    """What a bend (2,) has across a unit vector."""
    part = float(along[0] * bend[1] - along[1] * bend[0])
    return -part * along[1] + 0.0, part * along[0] + 0.0


def locked_bend(value: tuple[float, float]) -> BendLine:
    """Bends of a segment that has this one (rad) whatever happens."""
    return BendLine(value, (1.0, 0.0), 0.0, 0.0)


def coordinate_names(segments: Sequence[str]) -> list[str]:
    """Names of all coordinates of segments of these names: `s1.bend_x`, `s1.bend_y`, `s1.length`, ..."""
    return [f"{name}.{key}" for name in segments for key in COORDINATES]


def segment_names(segments: Sequence[Segment]) -> tuple[str, ...]:
    """Names of all segments; by default `s1`, `s2`, ... from base to tip, without counting joints and links."""
    before = sum(segment.rigid for segment in segments)
    return tuple(segment.name or f"s{k + 1 - before}" for k, segment in enumerate(segments))


ROUND = 1e-9
"""By how much the largest curvature is less than 1 / radius, relative to it: there, half a circle touches itself."""


def curvature_limits(segments: Sequence[Segment], radii: Sequence[float], avoids_itself: bool) -> tuple[float, ...]:
    """Largest curvature of every segment: its own limit and, where it must not run through itself, 1 / radius."""
    return tuple(
        min(segment.max_curvature, (1.0 - ROUND) / radius) if avoids_itself and radius > 0.0 else segment.max_curvature
        for segment, radius in zip(segments, radii, strict=True)
    )


def held_back(segments: Sequence[Segment], radii: Sequence[float], curvatures: Sequence[float]) -> list[str]:
    """Say which segments may bend less than their own limits allow, because they are too thick; one line a kind.

    It is said for their least length, for one that may vanish for its largest: near 0, curvature always limits a bend.
    """
    notes, first = [], 1
    for (segment, radius, curvature), group in groupby(zip(segments, radii, curvatures, strict=True)):
        last = first + len(list(group)) - 1
        length = segment.length[0] or segment.length[1]
        own, allowed = min(segment.max_bend, segment.max_curvature * length), curvature * length
        if allowed < own * (1.0 - 2.0 * ROUND):
            half = "" if radius == segment.radius else ", with half of the demanded clearance from itself,"
            which = f"segment {first}" if first == last else f"segments {first} to {last}"
            notes.append(
                f"{which}: a radius of {radius:g}{half} is above the smallest radius of curvature, {length / own:.4g}; "
                f"while self_collision is avoided, the bend at length {length:g} is at most {allowed:.4g} rad"
            )
        first = last + 1
    return notes


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
