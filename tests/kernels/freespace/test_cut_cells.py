"""Cells that a wall cuts in two, against the finest cells in them."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sinuous as sn
from sinuous.kernels.freespace import cut_cells
from sinuous.kernels.freespace.cells import NONE
from sinuous.kernels.freespace.grid import middle
from sinuous.kernels.freespace.keys import key_of
from tests.helpers import kernel_scene
from tests.kernels.freespace.places import RADIUS, grid
from tests.kernels.freespace.test_octree import middles

WHERE = grid(cell=0.5 * RADIUS, clearance=0.5 * RADIUS, levels=4, reach=1e3)


def plate(seed: int, far: float = 40.0) -> sn.Box:
    """A wide thin box, askew, through the middle of space."""
    rng = np.random.default_rng(seed)
    turn = Rotation.from_rotvec(rng.normal(size=3)).as_matrix()
    return sn.Box(rng.uniform(-0.2, 0.2, 3), np.roll((far, far, rng.uniform(0.02, 0.4)), seed), turn)


def cut(scene: sn.Scene, cell: tuple[int, int, int, int]) -> int:
    key = key_of(*cell)
    edge = WHERE.cell * 2 ** cell[0]
    which = int(np.argmin([float(sn.Scene([o]).distance(np.array(middle(WHERE, key)))) for o in scene.obstacles]))
    return int(cut_cells.find_cut(WHERE, kernel_scene(scene), middle(WHERE, key), edge, which))


@pytest.mark.parametrize("seed", range(6))
def test_sides_are_told_apart_and_nothing_leads_across(seed: int) -> None:
    scene, cell = sn.Scene([plate(seed)]), (3, 0, 0, -1)
    found = cut(scene, cell)
    assert found // 3 == 0
    points = middles(WHERE, cell)
    free = points[scene.distance(points) >= WHERE.clearance]
    sides = np.array([cut_cells.side_of(kernel_scene(scene), found, tuple(p)) for p in free])
    for p, side in zip(free[::29], sides[::29], strict=True):
        lines = p + np.linspace(0.0, 1.0, 65)[:, None, None] * (free - p)
        least = scene.distance(lines).min(axis=0)
        assert (least[sides != side] < 0.0).all()
        assert (least[sides == side] >= WHERE.clearance - 1e-12).all()
    if len(free):
        there = cut_cells.place_beside(kernel_scene(scene), found, int(sides[0]), tuple(-free[0]), 0.7)
        assert float(scene.distance(np.array(there))) == pytest.approx(0.7, abs=1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_links_lead_wherever_two_finest_cells_do(seed: int) -> None:
    scene = sn.Scene([plate(seed)])
    one, other = (3, 0, 0, -1), ((3, 0, 0, 0), (2, 2, 1, -1), (0, 8, 3, -2), (3, -1, -1, -2))[seed % 4]
    first, second = cut(scene, one), cut(scene, other) if other[0] else NONE
    assert first != NONE
    whole = kernel_scene(scene)
    a, b = (p[scene.distance(p) >= WHERE.clearance] for p in (middles(WHERE, one), middles(WHERE, other)))
    near = np.abs(a[:, None] - b[None]).max(axis=-1, initial=0.0) <= 1.01 * WHERE.cell
    free = np.argwhere(near)
    told = set()
    for i, j in free:
        side, there = (cut_cells.side_of(whole, first, tuple(p)) for p in (a[i], b[j]))
        if side == there:  # else the wall is between them
            told.add((side, there if second != NONE else 0))
    for side, there in told:
        assert cut_cells.linked(WHERE, whole, (key_of(*one), first, side), (key_of(*other), second, there))
    if second != NONE:
        for side in range(2):
            assert not cut_cells.linked(WHERE, whole, (key_of(*one), first, side), (key_of(*other), second, 1 - side))
