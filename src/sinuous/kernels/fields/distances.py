"""Signed distance, positive outside, to the obstacles of a scene, whatever they are.

A primitive is in its row (see `primitives`); meshes, clouds and grids keep their numbers in the store (see `solids`).
"""

import math
from collections import namedtuple
from typing import Any

from sinuous.kernels import tables as t
from sinuous.kernels.clock import TREE_WORK
from sinuous.kernels.compile import apart, entry, inline, shared
from sinuous.kernels.fields import primitives, solids
from sinuous.kernels.fields.hierarchy import (
    ENTRY_SIZE,
    LEAST_SQUARE,
    LIST_BEYOND,
    LIST_COUNT,
    LIST_SIZE,
    cell_of,
    item_of,
    nearer_leaf,
    tree_over,
)
from sinuous.kernels.fields.primitives import Patch, primitive
from sinuous.kernels.fields.solids import EXACT, INTERPOLATED, UPPER_BOUND
from sinuous.kernels.fields.trees import lift
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import Array, Vec, dot, get_mat, get_vec, mat_vec, norm, sub, vec_mat

MANY_HALVES = 4.0
"""How much longer than what it may lose a patch is that is worth a walk in a tree."""

Scene = namedtuple("Scene", ["table", "store"])
"""Rows (m, 33), and the numbers (s,) that they point to; layout: see `sinuous.kernels.tables`.

Where there is nothing, `None` may stand for it: that is another type, for which nothing is compiled that examines
obstacles. Who takes both asks `scene is None` of its own argument, first of all; Numba leaves out what cannot be."""


def read_scene(scene: Array | None) -> Any:
    """Take the group of a scene apart: a `Scene`, or `None` for `None`."""
    if scene is None:
        return None
    table, store = cut(scene[t.SCENE_HEADER :], int(scene[0]), t.OBSTACLE_WIDTH)
    return Scene(table, store)


def _own(scene: Scene, i: int, p: Vec) -> Vec:
    """The point `p` in the frame in which obstacle `i`, which is in the store, is described."""
    if scene.table[i, t.PLACED] == 0.0:
        return p
    away = sub(p, get_vec(scene.table, i, t.PLACE + t.POSE_POSITION))
    return vec_mat(away, get_mat(scene.table, i, t.PLACE + t.POSE_ROTATION))


@apart
def _evaluate_other(scene: Scene, i: int, p: Vec, reach: float, mode: int) -> tuple[float, float]:
    if scene.table[i, t.KIND] >= t.TREE:
        return solids.evaluate(scene.table, scene.store, i, _own(scene, i, p), reach, mode)
    away, far = sub(p, get_vec(scene.table, i, t.CENTER)), reach + scene.table[i, t.EXTENT]
    if mode == INTERPOLATED and 0.0 < far < math.inf and dot(away, away) >= far * far:
        return norm(away) - scene.table[i, t.EXTENT], math.inf
    d, _ = primitive(scene.table, i, p)
    return d, d


def evaluate(scene: Scene, i: int, p: Vec, reach: float, mode: int) -> tuple[float, float]:
    """Signed distance of the point `p` to obstacle `i`, and an upper bound of it: the same where it is exact.

    `mode` is one of INTERPOLATED, LOWER_BOUND, EXACT and UPPER_BOUND of `solids`; primitives are always exact. What is
    not less than `reach` need not be exact: any lower bound that is not less than `reach` either will do. With
    INTERPOLATED a primitive that a ball about it keeps beyond `reach` has no upper bound.
    """
    if scene.table[i, t.KIND] != t.SPHERE:
        return _evaluate_other(scene, i, p, reach, mode)
    d = scene.table[i, t.SIGN] * (norm(sub(p, get_vec(scene.table, i, t.CENTER))) - scene.table[i, t.ROUNDING_RADIUS])
    return d, d


def slope(scene: Scene, i: int, p: Vec) -> tuple[float, Vec]:
    """Signed distance of the point `p` to obstacle `i`, and its gradient: exact."""
    return slope_known(scene, i, p, math.inf, EXACT, math.inf)


def slope_known(scene: Scene, i: int, p: Vec, reach: float, mode: int, known: float) -> tuple[float, Vec]:
    """The same, INTERPOLATED or EXACT, of what is nearer than `reach`; see `evaluate`.

    Where the distance in this mode is `known` already that saves a search; infinite where it is not.
    """
    if scene.table[i, t.KIND] >= t.TREE:
        d, g = solids.slope(scene.table, scene.store, i, _own(scene, i, p), reach, mode, known)
        if scene.table[i, t.PLACED] != 0.0:
            g = mat_vec(get_mat(scene.table, i, t.PLACE + t.POSE_ROTATION), g)
        return d, g
    return primitive(scene.table, i, p)


def tangents_pay(scene: Scene, i: int, d: float, size: float, slack: float) -> bool:
    """Whether tangents may prove a patch, and sooner than its halves would: its center is at the distance `d`.

    No point of it is farther from there than `size`; its bound may be less than `d` by `slack`. A primitive and a list
    are soon asked; in a tree all parts are met that are near a patch, and beside many parts, as beside a ball, a
    tangent at the center loses some `size * size / (2 d)`. Halves without tangents end no longer than `slack`.
    """
    if scene.table[i, t.KIND] < t.TREE:
        return True
    if slack <= 0.0 or scene.table[i, t.FIRST_CELL] >= 0.0:
        return slack > 0.0
    return bool(size > MANY_HALVES * slack and size * size < 2.0 * d * slack)


def bound_patch(scene: Scene, i: int, patch: Patch, deviation: float, reach: float) -> tuple[float, Vec]:
    """Lower bound of the distance to obstacle `i` of all within `deviation` of a patch; -inf where none is known.

    One point of all that has to be known to be free. Also the gradient, at the center, of the distance to what decides.
    What is not less than `reach` need not be exact.
    """
    if scene.table[i, t.KIND] < t.TREE:
        return primitives.bound_patch(scene.table, i, patch, deviation)
    if scene.table[i, t.PLACED] == 0.0:
        return solids.bound_patch(scene.table, scene.store, i, patch, deviation, reach)
    turn = get_mat(scene.table, i, t.PLACE + t.POSE_ROTATION)
    along, onward, twist = vec_mat(patch.along, turn), vec_mat(patch.onward, turn), vec_mat(patch.twist, turn)
    own = Patch(_own(scene, i, patch.center), along, onward, twist)
    low, g = solids.bound_patch(scene.table, scene.store, i, own, deviation, reach)
    return low, mat_vec(turn, g)


def obstacle(scene: Scene, i: int, p: Vec, known: float) -> tuple[float, Vec]:
    """Signed distance of the point `p` to obstacle `i` and its gradient: interpolated where there are samples.

    `known` is that distance, where it is known already, else infinite.
    """
    return slope_known(scene, i, p, math.inf, INTERPOLATED, known)


def number_of(scene: Scene | None) -> int:
    """How many obstacles there are."""
    if scene is None:
        return 0
    return int(scene.table.shape[0])


def is_large(scene: Scene) -> bool:
    """Whether the scene has a hierarchy: see `hierarchy`. A table of some of its rows has none."""
    count = scene.table.shape[0]
    return bool(count >= t.MANY_OBSTACLES and scene.store[t.HIERARCHY_OBSTACLES] == count)


def coarseness(scene: Scene | None) -> float:
    """Largest spacing of samples that stand in for something exact; 0 without any."""
    if scene is None:
        return 0.0
    if is_large(scene):
        return float(scene.store[t.HIERARCHY_SPACING])
    spacing = 0.0
    for i in range(scene.table.shape[0]):
        if scene.table[i, t.KIND] >= t.TREE and scene.table[i, t.FIRST_SAMPLE] >= 0.0:
            spacing = max(spacing, scene.table[i, t.SPACING])
    return spacing


def work_of(scene: Scene, i: int) -> int:
    """Work units that the distance to obstacle `i` costs, see `kernels.clock`."""
    return TREE_WORK if scene.table[i, t.KIND] >= t.TREE else 1


def work_of_all(scene: Scene) -> int:
    """Work units that the distance to the scene costs."""
    if is_large(scene):
        return int(scene.store[t.HIERARCHY_WORK])
    units = 0
    for i in range(scene.table.shape[0]):
        units += work_of(scene, i)
    return units


SURELY = 1e-9
"""By what share a bound is increased that arithmetic may have made too small."""

TIE = 2.0**-50
"""By what share a distance is increased where another one that is the same should be found, too."""

nearer_leaf_here = inline(nearer_leaf)


@shared
def search(scene: Scene, p: Vec, reach: float, mode: int, side: float, skipped: int) -> tuple[float, float, int]:
    """Find what `closest` does in a large scene, of what is closer than `reach`: else that is returned, inf, and -1.

    To distances `side` times the `ROUNDOFF` of the obstacle is added. An upper bound is returned, too; one obstacle may
    be `skipped`. Of several that are as close it is the first, as if one after the other had been asked.
    """
    store, tree = scene.store, tree_over(scene.store)
    least, most, which, beside, besides = reach, math.inf, -1, 0, tree.items - t.HIERARCHY_HEADER
    node, due = 0, 1
    cell, off = cell_of(store, p)
    entry = cell + LIST_SIZE
    end = entry + ENTRY_SIZE * int(store[cell + LIST_COUNT]) if cell > 0 else 0
    while True:
        if beside < besides:
            at = t.HIERARCHY_HEADER + beside
            beside += 1
        elif cell > 0:
            if entry == end or store[entry + 1] - off >= least:
                if least <= store[cell + LIST_BEYOND] - off:
                    return least, most, which
                cell = 0
                continue
            at = entry
            entry += ENTRY_SIZE
        else:
            node, due = nearer_leaf_here(store, tree, node, due, p, max(lift(least), LEAST_SQUARE))
            if node == 0:
                return least, most, which
            at = item_of(tree, node)
        i = int(store[at])
        if i in (which, skipped):
            continue
        shift = side * scene.table[i, t.ROUNDOFF]
        bound = least - shift
        d, upper = evaluate(scene, i, p, bound + TIE * abs(bound) if i < which else bound, mode)
        d, most = d + shift, min(most, upper)
        if d < least or (d == least and i < which):
            least, which = d, i


def closest(scene: Scene, p: Vec, reach: float, mode: int) -> tuple[float, int]:
    """Least signed distance of the point `p` to the scene, and the obstacle that it is to (-1: there is none).

    `mode` to ask, and `reach`, from which on it may be anything that is not less: see `evaluate`.
    """
    if is_large(scene):
        d, _, found = search(scene, p, reach, mode, 0.0, -1)
        return d, found
    least, which = math.inf, -1
    for i in range(scene.table.shape[0]):
        d, _ = evaluate(scene, i, p, min(least, reach), mode)
        if d < least:
            least, which = d, i
    return least, which


def nearest(scene: Scene, p: Vec) -> tuple[float, int]:
    """Least signed distance of the point `p` to the scene, and the obstacle that it is to (-1: there is none)."""
    return closest(scene, p, math.inf, EXACT)


def at_most(scene: Scene, p: Vec) -> float:
    """Upper bound of the distance of the point `p` to the scene, whatever arithmetic does to that.

    But for that it is exact, unless only samples are known; infinite where these bound nothing.
    """
    if is_large(scene):
        return float(search(scene, p, math.inf, UPPER_BOUND, 1.0, -1)[0])
    least = math.inf
    for i in range(scene.table.shape[0]):
        roundoff = scene.table[i, t.ROUNDOFF]
        least = min(least, evaluate(scene, i, p, least - roundoff, UPPER_BOUND)[0] + roundoff)
    return least


def most_roundoff(scene: Scene) -> float:
    """What arithmetic may make any distance to the scene wrong by; see `tables.ROUNDOFF`."""
    if is_large(scene):
        return float(scene.store[t.HIERARCHY_ROUNDOFF])
    most = 0.0
    for i in range(scene.table.shape[0]):
        most = max(most, scene.table[i, t.ROUNDOFF])
    return most


@entry
def many(
    table: Array, store: Array, points: Array, values: Array, above: Array, gradients: Array, which: Array
) -> None:
    """Fill signed distances `values` (m,), upper bounds `above` (m,), `gradients` (m, 3) and obstacles `which` (m,).

    They are those of `points` (m, 3) in the world.
    Without obstacles inf, inf, 0 and -1.
    """
    scene = Scene(table, store)
    uncertain = False
    for i in range(table.shape[0]):
        uncertain = uncertain or table[i, t.KIND] == t.SAMPLES
    d, there = math.inf, (0.0, 0.0, 0.0)
    for j in range(points.shape[0]):
        p = get_vec(points, j, 0)
        # Points are often in a row: then this one is no farther away than the last one and the way from there.
        reach = d + (1.0 + SURELY) * norm(sub(p, there)) + SURELY * abs(d)
        d, found = closest(scene, p, reach, EXACT)
        if not (d < reach or reach == math.inf):
            d, found = nearest(scene, p)
        values[j], which[j], there = d, found, p
        above[j] = closest(scene, p, math.inf, UPPER_BOUND)[0] if uncertain else values[j]
        if which[j] >= 0:
            _, g = slope(scene, which[j], p)
            gradients[j, 0], gradients[j, 1], gradients[j, 2] = g
        else:
            gradients[j, 0], gradients[j, 1], gradients[j, 2] = 0.0, 0.0, 0.0


@entry
def least_gap(table: Array, store: Array, points: Array, radii: Array, above: bool) -> tuple[float, int, int]:
    """Find the least of `distance - radius` over `points` (m, 3) with `radii` (m,): the value, the point, the obstacle.

    `above`: of upper bounds, which differ for samples alone. Without obstacles or points inf, -1 and -1. Points that
    are sure to be farther, because the one examined last is far enough away, are passed over; samples alone promise
    nothing of the next point.
    """
    scene = Scene(table, store)
    sure = True
    for i in range(table.shape[0]):
        sure = sure and table[i, t.KIND] != t.SAMPLES
    least, place, which = math.inf, -1, -1
    seen, there = -math.inf, (0.0, 0.0, 0.0)
    for j in range(points.shape[0]):
        p = get_vec(points, j, 0)
        if sure and seen - norm(sub(p, there)) - radii[j] >= least:
            continue
        d, nearest_one = closest(scene, p, math.inf, UPPER_BOUND if above else EXACT)
        seen, there = d, p
        if d - radii[j] < least:
            least, place, which = d - radii[j], j, nearest_one
    return least, place, which
