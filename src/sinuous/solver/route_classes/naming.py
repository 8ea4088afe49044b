"""Classes told apart: which curves belong together, and what stands between those that do not."""

from collections.abc import Sequence
from operator import itemgetter

import numpy as np

from sinuous.answer.route_class import SIDES, Passing, RouteClass
from sinuous.base.checks import Floats
from sinuous.solver.route_classes.curves import RouteCurves, across

LOOKS = 16
"""Directions across a curve in which an obstacle is looked for."""

SURROUNDED = 0.5
"""Share of these directions in which an obstacle is met, above which the curve leads through that obstacle."""


def group_alike(curves: RouteCurves, own: Sequence[Floats]) -> list[int]:
    """Return the class of each of m curves (N, 3): the number of the first curve of its class.

    Each curve is compared only with the first curve of each class, so that no two of these are alike. The result
    depends on the order: around a ball each curve may be alike its neighbours, and the last one not alike the first.
    """
    firsts: list[int] = []
    found = []
    for i, curve in enumerate(own):
        at = curves.alike_one(curve, [own[j] for j in firsts])
        if at is None:
            at = len(firsts)
            firsts.append(i)
        found.append(firsts[at])
    return found


def name_classes(curves: RouteCurves, firsts: Sequence[Floats]) -> list[RouteClass]:
    """Number classes in this order; say which obstacles the first curve (N, 3) of each passes on a side of its own."""
    named = []
    for i, own in enumerate(firsts):
        others = [other for j, other in enumerate(firsts) if j != i]
        found = [_passing(curves, own, *each) for each in sorted(_aside(curves, own, others).items())]
        named.append(RouteClass(i + 1, tuple(passing for _, passing in sorted(found, key=itemgetter(0)))))
    return named


def _aside(curves: RouteCurves, own: Floats, others: Sequence[Floats]) -> dict[int, Floats]:
    """Return the obstacles between a curve (N, 3) and others, each with the sum of unit vectors from the others."""
    found: dict[int, Floats] = {}
    for other in others:
        for which in (curves.between(own, other), curves.between(other, own)):  # what each of them sees first
            for obstacle in set(which.tolist()) - {-1}:
                across = (own - other)[which == obstacle]
                units = across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-300)
                found[obstacle] = found.get(obstacle, np.zeros(3)) + units.sum(axis=0)
    return found


def _passing(curves: RouteCurves, own: Floats, which: int, across: Floats) -> tuple[int, Passing]:
    """Where a curve (N, 3) passes an obstacle, by number of the point, and on which side.

    Of the axes of the world that is the one along which the curve is both away from the obstacle and from the others.
    """
    distances, gradients = curves.scene.distance_to(which, own)
    nearest = int(distances.argmin())
    away = gradients[nearest]
    both = away * across
    axis = int((both if both.max() > 0.0 else np.abs(away)).argmax())
    side = None if _surrounds(curves, own, nearest, which) else SIDES[2 * axis + int(away[axis] > 0.0)]
    x, y, z = own[nearest].tolist()
    return nearest, Passing(curves.scene.name(which), side, (x, y, z))


def _surrounds(curves: RouteCurves, own: Floats, at: int, which: int) -> bool:
    """Whether an obstacle is met in most directions across a curve (N, 3), from one of its points."""
    place, tangent = own[at], np.gradient(own, axis=0)[at]
    angles = 2.0 * np.pi / LOOKS * np.arange(LOOKS)
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=1) @ across(tangent)
    reach = np.linalg.norm(np.diff(own, axis=0), axis=1).sum()
    starts = np.repeat(place[None], LOOKS, axis=0)
    met = curves.see(starts, place + reach * rays, 1e-3 * curves.keep).which == which
    return bool(met.mean() > SURROUNDED)
