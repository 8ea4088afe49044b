"""The search for a route alone, in halls of a thousand radii of the body with one door."""

from collections.abc import Iterator
from time import perf_counter

from benchmarks.clutter.figures import LIMIT
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from benchmarks.places import Place, make
from sinuous.kernels.freespace.cells import memory_size
from sinuous.problem.problem import Problem
from sinuous.solving.routes import Router

SECTION = "route search alone, in a hall of 1000 radii of the body with one door"
COUNT, QUICK = 20, 2
REPEATS = 3
"""Searches in each hall, of which the quickest counts."""

MEGABYTE = 1e6


def measure(plan: Plan) -> Iterator[Line]:
    """Search until there is a route, from the coarsest plan on."""
    found = [_search(make("hall", 1000 * plan.seed + i)) for i in range(plan.count(COUNT, QUICK))]
    times = Times.of([seconds for seconds, _, _ in found])
    routes = sum(routed for _, _, routed in found)
    missed = ", ".join(str(1000 * plan.seed + i) for i, (_, _, routed) in enumerate(found) if not routed)
    note = f"no route: seeds {missed}" if missed else ""
    yield Line(SECTION, "median", times.median, "ms", Goal(2e-3), times, (routes, len(found)), note)
    yield Line(SECTION, "largest memory", max(size for _, size, _ in found) / MEGABYTE, "MB")


def _search(hall: Place) -> tuple[float, int, bool]:
    """Seconds until a route is found, bytes of the largest table, and whether there is a route."""
    router = Router(hall.robot, hall.scene, hall.tolerance)
    problem = Problem.prepared(hall.robot, hall.targets, hall.scene.snapshot(), hall.tolerance)
    query = router.query(problem)
    assert query is not None  # the tip has a position
    least, largest, routed = LIMIT, 0, False
    for _ in range(REPEATS):
        began = perf_counter()
        for one in router.plans:
            largest = max(largest, 8 * memory_size(one.cells))
            routed = bool(router.find(problem, query, one, began + LIMIT - perf_counter()).routes)
            if routed or perf_counter() - began > LIMIT:
                break
        least = min(least, perf_counter() - began)
    return least, largest, routed
