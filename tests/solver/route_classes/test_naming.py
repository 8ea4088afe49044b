"""Which curves are of one class, and what is said of it."""

import numpy as np

from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.scene import Scene
from sinuous.solver.route_classes.curves import RouteCurves, group_alike, name_classes
from tests.solver.route_classes.places import ROBOT, bars, pillar
from tests.solver.route_classes.test_curves import arch


def test_curves_are_sorted_by_the_first_of_their_class() -> None:
    own = RouteCurves(ROBOT, Scene(pillar()).snapshot())
    tight = [own.along(arch(angle)) for angle in (0.1, 3.0, -0.4, 2.6, 0.0)]
    assert group_alike(own, tight) == [0, 1, 0, 1, 0]
    assert group_alike(own, []) == []


def test_every_class_says_its_side() -> None:
    own = RouteCurves(ROBOT, Scene(pillar()).snapshot())
    left, right = name_classes(own, [own.along(arch(angle)) for angle in (np.pi, 0.0)])
    assert (left.number, right.number) == (1, 2)
    assert [(each.obstacle, each.side) for each in left.passes] == [("pillar", "-x")]
    assert [(each.obstacle, each.side) for each in right.passes] == [("pillar", "+x")]
    assert right.passes[0].at[0] > 25.0


def test_one_class_alone_passes_nothing() -> None:
    own = RouteCurves(ROBOT, Scene(bars()).snapshot())
    (only,) = name_classes(own, [own.along(arch(0.0, 20.0))])
    assert only.passes == ()


def test_what_is_all_around_is_gone_through() -> None:
    """A plate with two holes is one obstacle: each class goes through it, at another place."""
    plate = _plate_with_holes()
    own = RouteCurves(ROBOT, Scene([plate]).snapshot())
    curves = [own.along(arch(angle, 40.0)) for angle in (np.pi, 0.0)]
    assert group_alike(own, curves) == [0, 1]
    for named, side in zip(name_classes(own, curves), (-1.0, 1.0), strict=True):
        (through,) = named.passes
        assert through.side is None
        assert np.sign(through.at[0]) == side
        assert str(named).startswith(f"class {named.number}: through plate at [")


def _plate_with_holes() -> Mesh:
    """A plate of no thickness but its shell's, with two square holes at x = -40 and 40."""
    xs, ys = (-240.0, -60.0, -20.0, 20.0, 60.0, 240.0), (-200.0, -20.0, 20.0, 200.0)
    vertices = np.array([(x, y, 125.0) for x in xs for y in ys])
    faces: list[tuple[int, int, int]] = []
    for i in range(5):
        for j in range(3):
            if (i, j) not in ((1, 1), (3, 1)):
                a, b, c, d = 4 * i + j, 4 * i + j + 1, 4 * i + j + 4, 4 * i + j + 5
                faces += [(a, c, d), (a, d, b)]
    return Mesh(vertices, faces, thickness=8.0, name="plate")
