"""Chains whose ends lie in tubes: found where a route from end to end leaves by the wrong mouth."""

from collections.abc import Iterator

import numpy as np
import pytest

import sinuous as sn
from benchmarks.places import Place
from benchmarks.places.place import right
from sinuous import Solver
from sinuous.solving.routing.ends.ends import Ends
from sinuous.solving.starts import Batch
from sinuous.solving.strategy import ENDS_PRICES
from tests.solving.routing.questions import asked, place

HARD = [("two tubes", 3), ("two tubes", 4), ("two tubes", 17), ("funnel", 11)]
"""Places that take twenty times as many starts, or more, without these chains."""


def ends(at: Place, several: bool = False, seconds: float = 60.0) -> Ends:
    router, question = asked(at, several, seconds)
    query = router.query(question.problem)
    assert query is not None
    return Ends(router, question, query)


def chains(source: Ends) -> Iterator[Batch]:
    """All that comes of it, with more and more effort."""
    for beam in (None, *ENDS_PRICES) if source.possible else ():
        yield from source.made(beam)


@pytest.mark.parametrize(("family", "number"), HARD)
def test_a_chain_leads_from_tube_to_tube(family: str, number: int) -> None:
    at = place(family, number)
    solver = Solver(at.robot, at.scene, tolerance=at.tolerance, routes=False, max_starts=1)
    batch = next(b for b in chains(ends(at)) if solver.solve(at.targets, b.initial[0], time=30.0).solved)
    assert at.robot.excess(batch.initial[0]) <= 1e-9
    (route,) = batch.routes
    assert np.allclose(route[0], at.robot.base[:3, 3])
    assert not route.flags.writeable


@pytest.mark.parametrize(("family", "number"), HARD)
def test_such_places_are_solved(family: str, number: int) -> None:
    at = place(family, number)
    solution = sn.solve(at.robot, at.targets, at.scene, tolerance=at.tolerance, time=60.0)
    assert solution.solved
    assert right(at, solution.q)
    assert solution.start == "route"
    assert solution.starts < 60


def test_it_makes_nothing_in_the_open_without_time_or_for_several_solutions() -> None:
    at = place(*HARD[0])
    assert list(chains(ends(at, seconds=0.0))) == []
    assert list(chains(ends(at, several=True))) == []
    assert list(chains(ends(place("spheres 12", 0)))) == []


def test_a_glance_is_for_a_target_that_is_near_walls(monkeypatch: pytest.MonkeyPatch) -> None:
    for where, count in ((HARD[0], 1), (("open pipe 1.6", 0), 0)):
        source, calls = ends(place(*where)), list[object]()
        monkeypatch.setattr(source, "made", lambda beam, calls=calls: calls.append(beam) or iter(()))
        list(source.glance())
        assert len(calls) == count


def test_a_look_goes_on_to_a_glance_where_the_tip_lies_in_a_tube(monkeypatch: pytest.MonkeyPatch) -> None:
    for where, count in ((HARD[0], 1), (("cells", 15), 0)):
        source, parts = ends(place(*where)), list[bool]()
        monkeypatch.setattr(source, "_parts", lambda parts=parts: parts.append(True) or iter(()))
        list(source.made(None))
        assert len(parts) == count
