"""Derivatives of a batch are those of its answers one by one, chunk after chunk, in memory and out of files."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from tests.helpers import Floats, refused
from tests.studies.batch.questions import BAD, BALL, OPTIONS, ROBOT, loop, points

COUNT = 60
GROUPS: Any = ("target", "base", "lengths", "obstacles")


def solve(targets: Any, out: Path | None = None, **options: Any) -> Any:
    return sn.studies.solve_batch(ROBOT, targets, [BALL], out, workers=1, **{**OPTIONS, **options})


def test_they_are_those_of_a_loop_whatever_holds_the_answers(tmp_path: Path) -> None:
    expected, rows = loop(COUNT)
    whole, others = expected.derivative(GROUPS), [row for row in BAD if row < COUNT]
    for out in (None, tmp_path / "out.npz"):
        for _ in range(2):  # the second call finds what the first has finished
            parts = list(solve(points(COUNT), out, chunk=7).derivatives(GROUPS))
            assert [len(part) for part in parts] == [7] * 8 + [4]
            for name in GROUPS:
                found = np.concatenate([part.q[name] for part in parts])
                np.testing.assert_array_equal(found[rows], whole.q[name])
                assert np.isnan(found[others]).all()
            regular = np.concatenate([part.regular for part in parts])
            np.testing.assert_array_equal(regular[rows], whole.regular)
            assert not regular[others].any()


def test_products_agree_with_each_other_and_read_a_chunk_at_a_time(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    batch = solve(points(COUNT), tmp_path / "out.npz", chunk=20)
    np.save(tmp_path / "cotangent.npy", rng.normal(size=(COUNT, 3, 3)))
    cotangent = np.load(tmp_path / "cotangent.npy", mmap_mode="r")
    tangent: dict[Any, Floats] = {"target": rng.normal(size=(COUNT, 3)), "base": rng.normal(size=(COUNT, 6))}
    back, motion = batch.vjp(cotangent, ("target", "base")), batch.jvp(tangent)
    assert motion.shape == (COUNT, 3, 3)
    sides = sum((back[name] * way).sum(axis=1) for name, way in tangent.items())
    np.testing.assert_allclose(sides, (cotangent * motion).sum(axis=(1, 2)), atol=1e-9)
    np.testing.assert_array_equal(batch.jvp(tangent["target"]), batch.jvp({"target": tangent["target"]}))


@pytest.mark.parametrize("keys", [("positions",), ("directions",), ("positions", "rotations")])
def test_a_chunk_without_any_target_has_the_columns_of_the_others(keys: tuple[str, ...]) -> None:
    good = {"positions": [[0.0, 30.0, 160.0]] * 4, "directions": [[0, 0, 1.0]] * 4, "rotations": [np.eye(3)] * 4}
    arrays = {key: np.array(good[key], np.float64) for key in keys}
    arrays[keys[0]][:2] = np.nan
    first, second = solve(arrays, chunk=2).derivatives()
    assert first.q["target"].shape == second.q["target"].shape == (2, 3, 3, 3 * len(keys))
    assert not first.regular.any()


def test_bad_input_is_refused(tmp_path: Path) -> None:
    batch = solve(points(8), chunk=4)
    refused("wrt", lambda: batch.derivatives("colour"), "target, base")
    refused("cotangent", lambda: batch.vjp(np.zeros((7, 3, 3))), "one for each row: 8")
    refused("cotangent", lambda: batch.vjp([[1.0], [1.0, 2.0]]))
    refused("cotangent", lambda: batch.vjp(np.zeros((8, 2, 3))))
    refused("tangent['target']", lambda: batch.jvp(np.zeros((8, 4))))
    table = solve(points(8), tmp_path / "out.csv")
    refused("out", lambda: list(table.derivatives()), "results as .npz")
    part = solve(points(8), tmp_path / "out.npz", chunk=4, shard=(1, 2))
    refused("batch", part.derivatives, "one with all rows")
    targets = tmp_path / "in.npz"
    np.savez(targets, positions=points(8))
    filed = solve(targets)
    np.savez(targets, positions=points(8, seed=1))
    refused("targets", lambda: list(filed.derivatives()), "have changed")
