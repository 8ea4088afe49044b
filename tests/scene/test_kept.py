"""Samples kept on disk come back whole or not at all: no damage changes a distance."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.scene import sampling
from tests.helpers import Floats
from tests.scene import shapes

POINTS = np.random.default_rng(1).normal(size=(100, 3))
VALUES = "values"


def distances() -> Floats:
    """Of a mesh that is new to this process."""
    return sn.Scene([sn.Mesh(*shapes.ball(3))]).distance(POINTS)


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.delenv("SINUOUS_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
    monkeypatch.setattr(sampling, "WORTH_KEEPING", 0.0)
    return tmp_path / "sinuous" / "samples"


def flip(file: Path) -> None:
    whole = bytearray(file.read_bytes())
    whole[len(whole) // 2] ^= 1
    file.write_bytes(whole)


def rewrite(change: Callable[[Floats], object], key: str = VALUES) -> Callable[[Path], None]:
    def damage(file: Path) -> None:
        arrays: dict[str, Any] = {key: change(np.load(file)[VALUES])}
        np.savez(file, **arrays)

    return damage


@pytest.mark.parametrize(
    "damage",
    [
        *(lambda file, cut=cut: file.write_bytes(file.read_bytes()[:cut]) for cut in (0, 10, 200, -30)),
        flip,
        rewrite(lambda values: values[:-1]),
        rewrite(lambda values: values.astype(np.float32)),
        rewrite(lambda values: np.full(values.shape, np.nan)),
        rewrite(lambda values: np.array([{}], dtype=object)),
        rewrite(lambda values: values, "others"),
    ],
)
def test_a_damaged_file_is_as_none(home: Path, damage: Callable[[Path], object]) -> None:
    first = distances()
    (file,) = home.iterdir()
    whole = file.read_bytes()
    damage(file)
    np.testing.assert_array_equal(distances(), first)
    assert [each.read_bytes() == whole for each in home.iterdir()] == [True]  # computed and kept again


def test_where_nothing_can_be_kept_nobody_minds(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError("no space left")

    monkeypatch.setattr(np, "savez", full)
    assert np.isfinite(distances()).all()
    assert list(home.iterdir()) == []


def test_what_is_kept_is_not_computed_again(monkeypatch: pytest.MonkeyPatch) -> None:
    first = distances()
    monkeypatch.setattr(sampling, "_compute", lambda *_: pytest.fail("computed again"))
    np.testing.assert_array_equal(distances(), first)
