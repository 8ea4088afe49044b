"""Discs about triangles: they hold them."""

import numpy as np
import pytest

from sinuous.kernels.fields import discs
from sinuous.kernels.fields.discs import AXIS, CENTER, DISC_SIZE, HALF, RADIUS
from sinuous.kernels.fields.trees import Tree
from sinuous.kernels.tables import TRIANGLES
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.prepared import trees
from sinuous.scene.prepared.trees import Pieces
from tests.helpers import Floats
from tests.scene import shapes

MESHES = {
    "ball": Mesh(*shapes.ball(3)),
    "cube": Mesh(*shapes.cube()),
    "one": Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], thickness=0.1),
    "scraps": Mesh(np.random.default_rng(0).normal(size=(300, 3)), np.arange(300).reshape(-1, 3), thickness=0.1),
}


def made(name: str) -> tuple[Pieces, Floats, Tree, Floats]:
    """Triangles in the order of their tree, the store, the tree and its discs."""
    pieces = trees.triangles(MESHES[name])
    store = np.concatenate([pieces.nodes.ravel(), pieces.items.ravel()])
    tree = Tree(0, pieces.levels, pieces.nodes.size, len(pieces.items), TRIANGLES, 0.0)
    own = np.full((2 << pieces.levels, DISC_SIZE), np.nan)
    discs.enclose(store, tree, own)
    return pieces, store, tree, own


@pytest.mark.parametrize("name", MESHES)
def test_a_disc_holds_what_is_in_its_node(name: str) -> None:
    pieces, _, tree, own = made(name)
    for node in range(1, 2 << tree.levels):
        level = node.bit_length() - 1
        j = node - (1 << level)
        inside = slice((j * tree.count) >> level, ((j + 1) * tree.count) >> level)
        away = pieces.items[inside, :9].reshape(-1, 3) - own[node, CENTER : CENTER + 3]
        height = away @ own[node, AXIS : AXIS + 3]
        beside = np.linalg.norm(away - height[:, None] * own[node, AXIS : AXIS + 3], axis=-1)
        assert (np.abs(height) <= own[node, HALF]).all()
        assert (beside <= own[node, RADIUS] * (1.0 + 1e-12)).all()
