"""What is kept on disk comes back whole or not at all."""

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sinuous.scene.prepared import kept

VALUES = np.random.default_rng(0).normal(size=(3, 4, 5))


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
    return tmp_path / "sinuous" / "samples"


def test_what_was_kept_comes_back(home: Path) -> None:
    assert kept.load("some", VALUES.shape) is None
    kept.save("some", VALUES)
    found = kept.load("some", VALUES.shape)
    assert found is not None
    np.testing.assert_array_equal(found, VALUES)
    assert found.flags.writeable
    assert [file.name for file in home.iterdir()] == ["some.npz"]
    assert kept.load("other", VALUES.shape) is None


@pytest.mark.parametrize("cut", [0, 10, 200, -30])
def test_a_broken_file_is_as_none(home: Path, cut: int) -> None:
    kept.save("some", VALUES)
    whole = (home / "some.npz").read_bytes()
    (home / "some.npz").write_bytes(whole[:cut])
    assert kept.load("some", VALUES.shape) is None
    flipped = bytearray(whole)
    flipped[len(whole) // 2] ^= 1
    (home / "some.npz").write_bytes(flipped)
    assert kept.load("some", VALUES.shape) is None
    kept.save("some", VALUES)
    assert kept.load("some", VALUES.shape) is not None


def test_other_arrays_are_as_none(home: Path) -> None:
    kept.save("some", VALUES)
    assert kept.load("some", (3, 4)) is None
    wrongs: tuple[Any, ...] = (VALUES.astype(np.float32), np.full(VALUES.shape, np.nan))
    for wrong in wrongs:
        kept.save("some", wrong)
        assert kept.load("some", VALUES.shape) is None
    np.savez(home / "some.npz", values=np.array([{}], dtype=object))
    assert kept.load("some", (1,)) is None
    np.savez(home / "some.npz", others=VALUES)
    assert kept.load("some", VALUES.shape) is None


def test_the_oldest_make_room(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept, "MOST", 2)
    for name in ("a", "b", "c"):
        kept.save(name, VALUES)
        file = home / f"{name}.npz"
        os.utime(file, (ord(name), ord(name)))
    assert sorted(file.name for file in home.iterdir()) == ["b.npz", "c.npz"]


def test_without_a_place_nothing_is_kept_and_nobody_minds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept, "writable", lambda directory: False)
    kept.save("some", VALUES)
    assert kept.load("some", VALUES.shape) is None


def test_a_full_disk_leaves_nothing_behind(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError("no space left")

    monkeypatch.setattr(np, "savez", full)
    kept.save("some", VALUES)
    assert list(home.iterdir()) == []
