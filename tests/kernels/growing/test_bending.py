"""Arcs that come out: within limits, clear as independent distances say, along tubes, and cut where no more fits."""

import math

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.growing.bending import MOST_OVERLAP, RELIEF_STEPS, Nearby, _solve, bend_off_walls
from tests.helpers import Floats, kernel_problem, mat, vec

RADIUS = 0.1


def nearby(scene: sn.Scene) -> Nearby:
    """Scratch for what is near an arc; nothing of what was there before may matter."""
    return Nearby(np.zeros(max(1, len(scene)), np.int64), np.full(max(1, len(scene)), np.nan))


def out(
    scene: sn.Scene, q: tuple[float, float, float], segment: sn.Segment, mount: float = 0.0
) -> tuple[Floats, float]:
    """An arc that comes out of the origin along z, and its overlap in radii."""
    problem = kernel_problem(sn.Robot([segment], mount=mount), [sn.Target((0.0, 0.0, 1.0))], scene)
    start = mat(np.eye(3)), vec(np.zeros(3))
    new = start, 0, 0.0
    (_, arc), overlap, _ = bend_off_walls(problem, new, new, (q, q), False, nearby(scene), RELIEF_STEPS)
    return np.array(arc), float(overlap)


def gap(scene: sn.Scene, segment: sn.Segment, arc: Floats) -> float:
    """Least distance of the body from the obstacles, by brute force, in radii."""
    line = sn.Robot([segment]).backbone(arc[None], 200)
    return float(scene.distance(line).min()) / RADIUS - 1.0


FREE = sn.Segment((0.2, 2.0), 3.0, radius=RADIUS)


@pytest.mark.parametrize("seed", range(6))
def test_an_arc_that_comes_out_is_within_limits_and_as_clear_as_it_says(seed: int) -> None:
    """Among random balls: near straight and near half a circle, with lengths that may and may not change."""
    rng = np.random.default_rng(seed)
    centres = rng.uniform((-1.5, -1.5, -0.5), (1.5, 1.5, 2.5), (12, 3))
    scene = sn.Scene([sn.Sphere(tuple(c), 0.25) for c in centres if np.linalg.norm(c) > 0.6])
    segment = sn.Segment((1.0, 1.0) if seed % 3 == 0 else (0.2, 2.0), 2.8, max_curvature=4.0, radius=RADIUS)
    bend = (1e-8, 1.0, 2.799)[seed % 3 if seed > 5 else 1]
    turn = rng.uniform(0.0, 2.0 * math.pi)
    q = bend * math.cos(turn), bend * math.sin(turn), 1.0
    arc, overlap = out(scene, q, segment)
    if overlap == math.inf:
        assert tuple(arc) == q
        return
    assert sn.Robot([segment]).excess(arc[None]) <= 1e-12
    assert overlap <= MOST_OVERLAP
    # The overlap is that of places, some of which lie in between.
    assert gap(scene, segment, arc) >= -overlap - 0.15


@pytest.mark.parametrize("offset", [-0.05, 0.0, 0.05])
def test_an_arc_beside_a_wall_is_bent_off_it(offset: float) -> None:
    wall = sn.Scene([sn.Box((0.9 + offset, 0.0, 1.0), (1.0, 4.0, 4.0))])
    arc, overlap = out(wall, (1.0, 0.0, 1.5), FREE)
    assert overlap <= 0.0
    assert gap(wall, FREE, arc) >= 0.0
    assert arc[0] < 1.0


def test_two_arcs_give_way_as_their_system_says() -> None:
    rng = np.random.default_rng(0)
    root, right = rng.normal(size=(4, 4)), rng.normal(size=4)
    whole = root @ root.T
    a, b, c = whole[:2, :2], whole[:2, 2:], whole[2:, 2:]
    first, second = (vec((own[0, 0], own[0, 1], own[1, 1])) for own in (a, c))
    across = b[0, 0], b[0, 1], b[1, 0], b[1, 1]
    found = _solve(first, second, across, vec((*right[:2], 0.0)), vec((*right[2:], 0.0)))
    np.testing.assert_allclose(found, np.linalg.solve(whole, right))
