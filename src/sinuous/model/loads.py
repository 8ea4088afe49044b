"""What pulls at a robot: what it carries, and forces and moments at places of its body."""

from collections.abc import Iterable, Sequence
from typing import Any

from sinuous.base import checks
from sinuous.base.arguments import Number, Vector, Which
from sinuous.base.checks import Floats, any_segment, segment_number
from sinuous.base.errors import InputError
from sinuous.base.frozen import Noun


class Payload(Noun):
    """A mass that a robot carries.

    Parameters
    ----------
    mass : float
        Its weight is mass x gravity, in the unit of force of `stiffness`.
    position : array_like (3,)
        Its center of gravity in the frame of the end of the segment.
    segment : int or str, optional
        Which segment's end carries it, 1 = first, or its name; by default the last.

    Raises
    ------
    InputError
        When the mass is negative.
    """

    mass: float
    position: Floats
    segment: int | None

    def __init__(self, mass: Number, position: Vector = (0.0, 0.0, 0.0), segment: Which | None = None) -> None:
        self._set(
            mass=checks.number("mass", mass, low=0.0),
            position=checks.array("position", position, (3,)),
            segment=any_segment(segment),
        )


class Force(Noun):
    """A force and a moment at the end of a segment; both stay as they are in the world while the body moves.

    Parameters
    ----------
    force : array_like (3,)
        In world axes, in the unit of force of `stiffness`.
    moment : array_like (3,)
        In world axes, force x length.
    segment : int or str, optional
        At which segment's end, 1 = first, or its name; by default the last.
    position : array_like (3,)
        Where the force acts, in the frame of that end.
    """

    force: Floats
    moment: Floats
    segment: int | None
    position: Floats

    def __init__(
        self,
        force: Vector = (0.0, 0.0, 0.0),
        moment: Vector = (0.0, 0.0, 0.0),
        segment: Which | None = None,
        position: Vector = (0.0, 0.0, 0.0),
    ) -> None:
        self._set(
            force=checks.array("force", force, (3,)),
            moment=checks.array("moment", moment, (3,)),
            segment=any_segment(segment),
            position=checks.array("position", position, (3,)),
        )


Load = Force | Payload
"""What a robot may carry beside what it is made for."""

Loads = Load | Iterable[Load]
"""One load or several."""


def load_list(key: str, loads: Any, names: Sequence[str]) -> tuple[Load, ...]:
    """Check one load or several, for a robot with segments of these names; returns them with numbers of segments."""
    listed = (loads,) if isinstance(loads, Force | Payload) else loads
    if not isinstance(listed, Iterable):
        raise InputError(key, "", loads, "a Force, a Payload, or a list of these")
    result = list(listed)
    for i, each in enumerate(result):
        place = key if len(result) == 1 else f"{key}[{i}]"
        checks.instance(place, each, Force | Payload, "a Force or a Payload")
        if each.segment is not None:
            result[i] = each.changed(segment=segment_number(f"{place}.segment", each.segment, names))
    return tuple(result)


def payload_list(payload: Any, names: Sequence[str]) -> tuple[Payload, ...]:
    """Check what a robot with segments of these names carries."""
    listed = load_list("payload", payload, names)
    for i, each in enumerate(listed):
        checks.instance(f"payload[{i}]", each, Payload, "a Payload")
    return tuple(each for each in listed if isinstance(each, Payload))
