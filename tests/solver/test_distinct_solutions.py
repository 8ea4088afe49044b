"""`solve_all` by route finds the classes that are known of a place, each once; by shape it says which is which."""

import time
from functools import cache
from typing import Literal

import numpy as np
import pytest

import sinuous as sn
from benchmarks.places import Place, make
from sinuous.base.checks import Floats
from sinuous.scene.obstacles import Obstacle
from tests.helpers import present
from tests.solver.route_classes.places import BARS, DOORS, ROBOT, TARGET, bars, crossing, pillar, wall


def solver(scene: list[Obstacle]) -> sn.Solver:
    return sn.Solver(ROBOT, scene, time=60.0, max_starts=150)


@cache
def past_pillar() -> list[sn.Solution]:
    return solver(pillar()).solve_all(TARGET)


def gap(q: Floats, z: float, edges: tuple[float, ...]) -> tuple[int, ...]:
    """Between which edges along x a body crosses a height, each time."""
    return tuple(int(np.searchsorted(edges, x)) for x in crossing(q, z))


def test_both_sides_of_a_pillar() -> None:
    found = past_pillar()
    assert sorted(gap(s.q, 150.0, (0.0,)) for s in found) == [(0,), (1,)]
    for solution in found:
        side = "+x" if crossing(solution.q, 150.0)[0] > 0.0 else "-x"
        assert str(solution.route_class).endswith(f"past pillar on its {side} side")
        assert solution.verify().ok
    assert [s.route_class.number for s in found if s.route_class] == [1, 2]
    assert " class 1: past pillar" in str(found[0])


def test_both_doors_of_a_wall() -> None:
    found = solver(wall()).solve_all(TARGET)
    edges = (*DOORS[0], *DOORS[1])
    assert sorted(gap(s.q, 150.0, edges) for s in found) == [(1,), (3,)]
    for solution in found:
        passed = {each.obstacle: each.side for each in solution.route_class.passes} if solution.route_class else {}
        assert passed["post"] == ("-x" if crossing(solution.q, 150.0)[0] < 0.0 else "+x")


def test_all_gaps_between_bars() -> None:
    found = solver(bars()).solve_all(TARGET, count=4)
    assert sorted(gap(s.q, 140.0, BARS) for s in found) == [(0,), (1,), (2,), (3,)]
    bends = [float((s.q[:, :2] ** 2).sum()) for s in found]
    assert bends == sorted(bends)
    for solution in found:
        assert solution.route_class is not None
        (at,) = gap(solution.q, 140.0, BARS)
        sides = {each.obstacle: each.side for each in solution.route_class.passes}
        assert all(side == ("+x" if int(name[-1]) < at else "-x") for name, side in sides.items())
        assert {f"bar {i}" for i in (at - 1, at) if 0 <= i < 3} <= set(sides)


def plate_with_holes() -> sn.Mesh:
    """A plate of no thickness but its shell's, with two square holes at x = -40 and 40."""
    xs, ys = (-240.0, -60.0, -20.0, 20.0, 60.0, 240.0), (-200.0, -20.0, 20.0, 200.0)
    vertices = np.array([(x, y, 125.0) for x in xs for y in ys])
    corners = [4 * i + j for i in range(5) for j in range(3) if (i, j) not in ((1, 1), (3, 1))]
    faces = [face for a in corners for face in ((a, a + 4, a + 5), (a, a + 5, a + 1))]
    return sn.Mesh(vertices, faces, thickness=8.0, name="plate")


def test_what_is_all_around_is_gone_through() -> None:
    """A plate with two holes is one obstacle: each class goes through it, at another place."""
    found = solver([plate_with_holes()]).solve_all(TARGET, count=2)
    assert sorted(np.sign(crossing(s.q, 125.0)[0]) for s in found) == [-1.0, 1.0]
    for solution in found:
        assert solution.route_class is not None
        (through,) = solution.route_class.passes
        assert through.side is None
        assert np.sign(through.at[0]) == np.sign(crossing(solution.q, 125.0)[0])
        assert str(solution.route_class).startswith(f"class {solution.route_class.number}: through plate at [")


def test_by_shape_all_distinct_ones_are_found_and_named() -> None:
    found = sn.Solver(ROBOT, pillar(), time=60.0, max_starts=60).solve_all(TARGET, count=12, by="shape")
    assert len(found) > 4
    sides: dict[int, set[int | None]] = {}
    for solution in found:
        (side,) = gap(solution.q, 150.0, (0.0,)) or (None,)
        sides.setdefault(present(solution.route_class).number, set()).add(side)
    assert all(len(own) == 1 for own in sides.values())
    assert present(found[0].route_class).number == 1


def test_without_obstacles_shapes_are_distinct_and_have_no_class() -> None:
    found = sn.solve_all(ROBOT, TARGET, count=3, max_starts=40, time=60.0)
    assert len(found) == 3
    assert all(solution.route_class is None for solution in found)
    (one,) = sn.solve_all(ROBOT, TARGET, count=3, max_starts=40, time=60.0, by="route")
    assert one.route_class is not None


@cache
def solved_place(family: str, number: int) -> tuple[Place, sn.Solver]:
    """A place that one solve manages."""
    there = make(family, number)
    in_there = sn.Solver(there.robot, there.scene, tolerance=there.tolerance, time=60.0, max_starts=200)
    assert in_there.solve(there.targets).solved
    return there, in_there


@pytest.mark.parametrize(("family", "number", "by"), [("folded", 0, "shape"), ("two doors", 4, "route")])
def test_what_one_solve_finds_is_among_them(family: str, number: int, by: Literal["route", "shape"]) -> None:
    there, in_there = solved_place(family, number)
    found = in_there.solve_all(there.targets, count=1, by=by, time=2.0)  # thirty times what one solve takes
    assert len(found) == 1
    assert found[0].verify().ok


def test_the_time_is_kept() -> None:
    place = solver(bars())
    place.solve_all(TARGET, time=0.01)
    began = time.process_time()  # other work on the machine does not count
    place.solve_all(TARGET, time=0.02)
    assert time.process_time() - began < 0.2  # all that there is to find takes longer


def test_what_is_asked_for_must_be_one_of_two() -> None:
    with pytest.raises(sn.InputError, match="by: expected route or shape, got 'side'"):
        solver(pillar()).solve_all(TARGET, by="side")  # type: ignore[arg-type]
