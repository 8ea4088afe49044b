"""When the search for classes ends, and which solutions of each it keeps."""

import numpy as np

from sinuous.kernels.tables import RANDOM, ROUTE, SOLVED, Outcome
from sinuous.scene.scene import Scene
from sinuous.solver.distinct_solutions import CANDIDATES, CLASS_PATIENCE, DistinctSearch, RouteClasses
from sinuous.solver.route_classes.curves import RouteCurves
from tests.helpers import Floats
from tests.solver.route_classes.places import ROBOT, pillar

CURVES = RouteCurves(ROBOT, Scene(pillar()).snapshot())


def beside(side: float, bend: float = 0.0) -> Floats:
    """A shape that passes the pillar on this side, and bends along it as it is told."""
    q = np.zeros((len(ROBOT), 3))
    q[:, 0], q[:, 1], q[:, 2] = side * np.array([0.5, 0.5, -0.5, -0.5, -0.5, 0.5]), bend, 50.0
    return q


def outcome(q: Floats, source: int = RANDOM) -> Outcome:
    return Outcome(q, SOLVED, 5, 1, source, 0.0, 0.0, 1.0, 1.0, False, 0.0, 0.1)


def search(count: int = 2, seconds: float = 60.0, most: int = 10_000) -> DistinctSearch:
    def dislike(found: list[Floats]) -> Floats:
        return np.array([float((q[:, :2] ** 2).sum()) for q in found])

    classes = RouteClasses(CURVES, count, dislike)
    return DistinctSearch(CANDIDATES * count, 1e-3, lambda q: ROBOT.backbone(q, 8), most, seconds, classes=classes)


def test_solutions_are_put_into_classes_and_the_best_are_kept() -> None:
    one = search()
    assert one.classes is not None
    bends = [0.05, 0.01, 0.04, 0.02, 0.03, 0.0]
    for bend in bends:
        one.take(outcome(beside(1.0, bend)))
    one.take(outcome(beside(-1.0)))
    assert [len(members) for members in one.classes.members] == [CANDIDATES, 1]
    assert [each.q[0, 1] for each in one.classes.members[0]] == sorted(bends)[:CANDIDATES]
    assert one.classes.has(CURVES.of(beside(-1.0, 0.02)))
    assert len(one.found) == 7


def test_it_ends_with_enough_classes_and_enough_to_choose_from() -> None:
    one = search(count=2)
    assert one.classes is not None
    one.take(outcome(beside(1.0)))
    one.take(outcome(beside(-1.0)))
    assert one.open
    for i in range(1, 2 * CANDIDATES - 1):
        one.take(outcome(beside(1.0, 0.01 * i)))
    assert not one.open


def test_it_ends_after_many_starts_in_vain_but_not_after_routes() -> None:
    one = search(count=9)
    assert one.classes is not None
    one.take(outcome(beside(1.0)))
    for _ in range(2 * CLASS_PATIENCE):
        one.take(outcome(beside(1.0), ROUTE))
    assert one.open
    for _ in range(CLASS_PATIENCE - 1):
        one.take(outcome(beside(1.0)))
    assert one.open
    one.take(outcome(beside(-1.0)))
    for _ in range(CLASS_PATIENCE):
        assert one.open
        one.take(outcome(beside(1.0)))
    assert not one.open


def test_what_there_was_no_time_to_compare_is_no_class() -> None:
    one = search(seconds=0.0)
    assert one.classes is not None
    one.take(outcome(beside(1.0)))
    assert one.classes.members == []
