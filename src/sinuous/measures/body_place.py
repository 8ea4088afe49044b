"""A place of the body: where in the world, and where along the robot."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.documents import result_of
from sinuous.base.errors import InputError
from sinuous.base.frozen import ShortRepr
from sinuous.base.words import number, one_of_body


@dataclass(frozen=True, repr=False)
class BodyPlace(ShortRepr):
    """A place of the backbone.

    Attributes
    ----------
    position : (float, float, float)
        In the world.
    segment : int, str or None
        1 = first; or the name of the joint whose link it is on; `None` where lengths that vary decide which it is.
    share : float or None
        How far along the segment, from 0 at its beginning to 1 at its end; `None` without a segment.
    """

    position: tuple[float, float, float]
    segment: Any = None
    share: float | None = None

    @classmethod
    def of(cls, position: Floats, segment: Any = None, share: float | None = None) -> "BodyPlace":
        """Make it of a position (3,), the number of a segment (1 = first), and a share of that."""
        x, y, z = np.asarray(position, np.float64).tolist()
        return cls((x, y, z), segment, None if share is None else float(share))

    def on_robot(self, owners: Sequence[Any], lengths: Floats) -> "BodyPlace":
        """Return it by segments of the robot, where it is on a body of arcs with these owners (N) and lengths (N,)."""
        if not isinstance(self.segment, int) or self.share is None:
            return self
        arc, segment = self.segment - 1, owners[self.segment - 1]
        own = np.array([each == segment for each in owners])
        before = float(lengths[:arc][own[:arc]].sum()) + self.share * float(lengths[arc])
        whole = float(lengths[own].sum())
        return replace(self, segment=segment, share=before / whole if whole > 0.0 else 0.0)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values, in the order of the file format."""
        return result_of(self, "position segment share")

    @classmethod
    def from_dict(cls, values: Any) -> "BodyPlace":
        """Make it of plain values, as `to_dict` writes them.

        Raises
        ------
        InputError
            When they are none.
        """
        try:
            own = {**values, "position": tuple(checks.vector("position", values["position"]).tolist())}
            return cls(**own)
        except (TypeError, KeyError):
            raise InputError("place", "", values, "position, segment and share") from None

    def __str__(self) -> str:
        largest = max(map(abs, self.position))
        digits = 3 - math.floor(math.log10(largest)) if largest > 0.0 else 0
        position = ", ".join(number(round(each, digits), 6) for each in self.position)
        return f"at ({position}){self._along}"

    @property
    def _along(self) -> str:
        """Where along the robot."""
        if self.share is None:
            return ""
        percent = round(100.0 * self.share)
        where = {0: "at the beginning of", 100: "at the end of"}.get(percent, f"{percent} % along")
        return f", {where} {one_of_body(self.segment)}"
