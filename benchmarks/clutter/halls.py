"""The search for a route alone, in halls of a thousand radii of the body with one door."""

import math
from collections.abc import Iterator
from time import perf_counter

import numpy as np

from benchmarks.clutter.figures import LIMIT
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from benchmarks.places import Place, make
from sinuous.base.checks import Floats
from sinuous.kernels.freespace.cells import memory_size
from sinuous.kernels.roadmap.find import roadmap_size
from sinuous.problem.problem import Problem
from sinuous.solver.routing.searches import POINTS, Searches
from sinuous.solver.strategy import plans_of

SECTION = "route search alone, in a hall of 1000 radii of the body with one door"
COUNT, QUICK = 20, 2
REPEATS = 3
"""Searches in each hall, of which the quickest counts."""

CLEAR = 0.7
"""Least distance of a route from the walls, in radii of the body: what is nearer, the chain cannot be laid along."""

MEGABYTE = 1e6


def measure(plan: Plan) -> Iterator[Line]:
    """Search until there is a route, in the order of a solve."""
    found = [_search(make("hall", 1000 * plan.seed + i)) for i in range(plan.count(COUNT, QUICK))]
    times = Times.of([seconds for seconds, _, _ in found])
    routes = sum(routed for _, _, routed in found)
    missed = ", ".join(str(1000 * plan.seed + i) for i, (_, _, routed) in enumerate(found) if not routed)
    note = f"no route: seeds {missed}" if missed else ""
    yield Line(SECTION, "median", times.median, "ms", Goal(2e-3), times, (routes, len(found)), note)
    yield Line(SECTION, "largest memory", max(size for _, size, _ in found) / MEGABYTE, "MB")


def _search(hall: Place) -> tuple[float, int, bool]:
    """Seconds until a route is found that leads through the door, bytes of the largest memory, whether there is one.

    In the order of a solve: around edges, then over cells. Coarse cells are larger than a wall is thick: a route
    through a wall is none.
    """
    searches = Searches(hall.robot, hall.scene, hall.tolerance)
    problem = Problem.prepared(hall.robot, hall.targets, hall.scene.snapshot(), hall.tolerance)
    query = searches.query(problem)
    assert query is not None  # the tip has a position
    least, largest, routed = LIMIT, 0, False
    for _ in range(REPEATS):
        began = perf_counter()
        around = searches.by_edges(problem, query, LIMIT)
        spent = perf_counter() - began
        largest, routed = max(largest, 8 * roadmap_size(POINTS)), around is not None and _is_clear(hall, around)
        for _, one in () if routed else plans_of(searches):
            largest = max(largest, 8 * memory_size(one.cells))
            began = perf_counter()
            routes = searches.find(problem, query, one, LIMIT - spent).routes
            spent += perf_counter() - began
            routed = any(_is_clear(hall, route) for route in routes)
            if routed or spent >= LIMIT:
                break
        least = min(least, spent)
    return least, largest, routed


def _is_clear(hall: Place, route: Floats) -> bool:
    """Whether a route (K, 3) keeps `CLEAR` radii away from all walls, also between its points."""
    radius = min(hall.robot.radii)
    along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(route, axis=0), axis=1)))
    places = np.linspace(0.0, along[-1], math.ceil(4.0 * along[-1] / radius))
    points = np.stack([np.interp(places, along, route[:, i]) for i in range(3)], axis=-1)
    return bool(hall.scene.distance(points).min() >= CLEAR * radius)
