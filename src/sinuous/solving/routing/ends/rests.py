"""What is left of a robot whose ends lie in tubes: the segments between what is laid along their axes.

Where the tip lies in a tube the problem is turned round: what begins in a tube has one way to go.
"""

from collections.abc import Callable, Iterator
from itertools import islice
from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.tables import MOUNT
from sinuous.solving.routing.growth import query_of
from sinuous.solving.routing.parts import beyond
from sinuous.solving.routing.tubes import Tube, heads, tube_around
from sinuous.solving.routing.turned import Groups, turned, turned_back

HEADS, TAILS = 3, 4
"""How many ways of laying segments in the tube of the base are tried, and with each of them in that of the tip."""

Left = Callable[[], float]
"""Seconds left."""


class Rest(NamedTuple):
    """What is left of a robot.

    Attributes
    ----------
    groups : tuple of ndarray
        Its problem, see `Groups`.
    whole : callable
        From its chain (m, 3) to that of the robot (n, 3).
    """

    groups: Groups
    whole: Callable[[Floats], Floats]


def rests(groups: Groups, tube: Tube | None, axes: list[Floats], left: Left) -> Iterator[Rest]:
    """Yield what is left of a robot with its base in a tube, or its tip at the beginning of axes (K, 3), or both."""
    if tube is None or not tube.passed:
        yield from _without_tail(groups, axes, left)
        return
    for head, _ in islice(heads(tube, groups, left), HEADS):
        rest = beyond(groups, head)
        if not axes:
            yield Rest(rest, _after(head))
        for other in islice(_without_tail(rest, axes, left), TAILS):
            yield Rest(other.groups, _after(head, other.whole))


def _without_tail(groups: Groups, axes: list[Floats], left: Left) -> Iterator[Rest]:
    """Yield what is left without the segments that lie along an axis (K, 3), from the tip on."""
    robot, scene, settings, targets = groups
    held = settings.copy()
    held[MOUNT] = 0.0  # the holder is at the other end: to keep it clear, too, is more than is asked
    for axis in axes:
        other = turned((robot, scene, held, targets), axis[::-1])
        query = None if other is None else query_of(other)
        if other is None or query is None or left() <= 0.0:
            continue
        tube = tube_around(scene, query, left())
        if tube is not None and tube.passed:
            for head, _ in heads(tube, other, left):
                yield Rest(beyond(other, head), _turned_after(groups, other, head))


def _after(head: Floats, whole: Callable[[Floats], Floats] | None = None) -> Callable[[Floats], Floats]:
    return lambda chain: np.concatenate([head, chain if whole is None else whole(chain)])


def _turned_after(groups: Groups, other: Groups, head: Floats) -> Callable[[Floats], Floats]:
    return lambda chain: turned_back(groups, other, np.concatenate([head, chain]))
