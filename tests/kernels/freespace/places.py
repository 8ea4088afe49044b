"""Grids, memories and scenes that the tests of the route search share."""

import math
from typing import Any

import numpy as np

import sinuous as sn
from sinuous.kernels import packing
from sinuous.kernels import tables as t
from sinuous.kernels.clock import DEADLINE
from sinuous.kernels.fields.solids import INTERPOLATED
from sinuous.kernels.freespace.cells import Memory, carve, forget_cells, memory_size
from sinuous.kernels.freespace.grid import HALF_DIAGONAL, SearchGrid
from tests.helpers import Floats
from tests.kernels.workspace import NEVER

CELL, RADIUS, REACH = 0.2, 0.25, 1.8
GOAL = (0.8, 0.4, 0.6)


def memory(most: int = 1 << 14, deadline: int = NEVER) -> Memory:
    """Memory of a search that knows no cell yet; the deadline (ns) is that of its clock."""
    work = carve(np.zeros(memory_size(most)), most)
    forget_cells(work)
    work.clock[DEADLINE] = deadline
    return work


def grid(**changed: Any) -> SearchGrid:
    """A grid of cells of one size, unless `levels` says more."""
    values: dict[str, Any] = {
        "origin": (0.0, 0.0, 0.0),
        "cell": CELL,
        "levels": 0,
        "clearance": RADIUS - HALF_DIAGONAL * CELL,
        "radius": RADIUS,
        "free_margin": 0.3,
        "reach": REACH,
        "start": (0.0, 0.0, 0.0),
        "start_radius": 0.5 * CELL,
        "goal": GOAL,
        "goal_radius": 0.0,
        "inflation": 1.0,
        "clearance_weight": 1.0,
        "longest": math.inf,
        "mode": INTERPOLATED,
        "normal": (0.0, 0.0, 0.0),
    }
    values |= changed
    clearance = values["clearance"]
    return SearchGrid(**({"ample": max(clearance, 2.0 * HALF_DIAGONAL * values["cell"] - clearance)} | values))


def query(**changed: Any) -> Floats:
    """A query for routes straight up, from the origin to (0, 0, 2); names as in `freespace.query.Query`."""
    values: dict[str, Any] = {
        "origin": (0.0, 0.0, 0.0),
        "axis": (0.0, 0.0, 1.0),
        "goal": (0.0, 0.0, 2.0),
        "back": (0.0, 0.0, 0.0),
        "goal_radius": 0.0,
        "goal_slack": 1e-4,
        "radius": 0.1,
        "shortest": 2.0,
        "longest": 3.0,
        "free_length": 0.0,
        "cell": 0.05,
        "clearance": 0.1 - HALF_DIAGONAL * 0.05,
        "free_margin": 0.1,
        "most_cells": 1 << 14,
        "prove": True,
    }
    out = np.zeros(t.QUERY_WIDTH)
    for name, value in (values | changed).items():
        at = getattr(t, f"QUERY_{name.upper()}")
        out[at : at + np.size(value)] = value
    return packing.plan_search(
        out, **{name: (values | changed)[name] for name in ("cell", "clearance", "free_margin", "most_cells", "prove")}
    )


def spheres(seed: int) -> sn.Scene:
    """Balls that leave origin and goal free."""
    rng = np.random.default_rng(seed)
    found: list[sn.Sphere] = []
    while len(found) < 12:
        center, radius = rng.uniform(-1.0, 1.0, 3), rng.uniform(0.1, 0.3)
        if min(np.linalg.norm(center), np.linalg.norm(center - GOAL)) > radius + RADIUS + 0.05:
            found.append(sn.Sphere(center, radius))
    return sn.Scene(found)


def room(wall: float, half: float = 0.6, center: Any = GOAL) -> sn.Scene:
    """Six thin walls about the goal."""
    goal, full = np.array(center, np.float64), 2.0 * half + wall
    walls = []
    for axis in range(3):
        for side in (-half, half):
            middle, size = goal.copy(), np.full(3, full)
            middle[axis] += side
            size[axis] = wall
            walls.append(sn.Box(middle, size))
    return sn.Scene(walls)
