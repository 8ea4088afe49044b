"""What is left of a robot between tubes: solved, it is a chain of the whole robot that lies in the tubes."""

import numpy as np
import pytest

from benchmarks.places import Place
from sinuous import Solver
from sinuous.kernels.tables import QUERY_ORIGIN
from sinuous.solving.routing.crossing import Part
from sinuous.solving.routing.ends.axes import axes_from_goal
from sinuous.solving.routing.ends.rests import HEADS, TAILS, Rest, rests
from sinuous.solving.routing.growth import GLANCE, SOME, query_of
from sinuous.solving.routing.tubes import tube_around
from sinuous.solving.routing.turned import Groups
from tests.helpers import Floats
from tests.solving.routing.questions import asked, place


def taken(at: Place) -> tuple[Groups, list[Rest], list[Floats]]:
    router, (problem, *_) = asked(at)
    groups, query = router.groups(problem), router.query(problem)
    assert query is not None
    axes = axes_from_goal(groups[1], query, at.scene.distance, 60.0)
    return groups, list(rests(groups, tube_around(groups[1], query, 60.0), axes, lambda: 60.0)), axes


def solved(rest: Rest) -> Floats | None:
    query = query_of(rest.groups)
    assert query is not None
    line = np.linspace(query[QUERY_ORIGIN : QUERY_ORIGIN + 3], query[QUERY_ORIGIN + 6 : QUERY_ORIGIN + 9], 20)
    part = Part(rest.groups, line[None])
    return part.solved(GLANCE, lambda: 60.0) if part.segments < 3 else part.solved(SOME, lambda: 60.0)


@pytest.mark.parametrize(("family", "number"), [("two tubes", 1), ("funnel", 2), ("open pipe 1.6", 3)])
def test_with_the_rest_solved_the_whole_is(family: str, number: int) -> None:
    at = place(family, number)
    _, left, axes = taken(at)
    assert left
    assert bool(axes) == (family != "open pipe 1.6")
    assert len(left) <= max(1, HEADS) * max(TAILS, 10)
    solver = Solver(at.robot, at.scene, tolerance=at.tolerance, routes=False, max_starts=1)
    wholes = [rest.whole(chain) for rest in left if (chain := solved(rest)) is not None]
    assert wholes
    assert all(at.robot.excess(whole) <= 1e-9 for whole in wholes)
    assert any(solver.solve(at.targets, whole, time=30.0).solved for whole in wholes)


def test_nothing_is_left_where_no_end_lies_in_a_tube() -> None:
    _, left, axes = taken(place("spheres 12", 0))
    assert left == []
    assert axes == []
