"""The tube that an elbow lies in, followed from there to both of its mouths."""

from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.tables import QUERY_RADIUS
from sinuous.kernels.tubes.axis import END
from sinuous.solving.routing.growth import departing
from sinuous.solving.routing.tubes import Distance, axis_direction, in_the_open, tube_around


class Inside(NamedTuple):
    """A tube that an elbow lies in.

    Attributes
    ----------
    one, other : ndarray (K, 3)
        Axis from the elbow to each of both mouths; two points alike, where the elbow is in a mouth.
    along : ndarray (3,)
        Unit tangent at the elbow, from the first mouth to the other.
    """

    one: Floats
    other: Floats
    along: Floats

    def turned(self) -> "Inside":
        """The same tube the other way."""
        return Inside(self.other, self.one, -self.along)


def tube_of(scene: Floats, query: Floats, elbow: Floats, distance: Distance, seconds: float) -> Inside | None:
    """Return the tube, open at both ends, that an elbow (3,) lies in, for what a route has to keep (28,)."""
    radius = float(query[QUERY_RADIUS])
    if in_the_open(elbow, radius, distance):
        return None
    along = axis_direction(elbow, radius, distance)
    ways, opens = [], 0
    for ahead in (-along, along):
        asked = query.copy()
        departing(asked, elbow, ahead)
        tube = tube_around(scene, asked, seconds)
        if tube is not None and tube.ended == END:
            return None
        opens += tube is not None
        ways.append(np.stack([elbow, elbow]) if tube is None else tube.axis)
    if opens == 0:
        return None
    one, other = ways
    tangent = other[min(2, len(other) - 1)] - one[min(2, len(one) - 1)]
    return Inside(one, other, tangent / np.linalg.norm(tangent))
