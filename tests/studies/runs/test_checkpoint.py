"""A checkpoint holds what was written, whole or not at all, and goes on with the record that it began with."""

import errno
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sinuous.studies.runs.engine import Checkpoint
from tests.helpers import refused

CHUNK: dict[str, Any] = {"q": np.arange(6.0).reshape(2, 3), "text": np.array(["a", "größe"]), "none": np.empty((0, 3))}


def begun(folder: Path, **record: Any) -> Checkpoint:
    checkpoint = Checkpoint(folder / "out.csv", {"seed": "0", **record}, "this run")
    checkpoint.open()
    return checkpoint


@pytest.mark.parametrize("in_memory", [True, False])
def test_what_is_written_is_read(in_memory: bool, tmp_path: Path) -> None:
    chunks = Checkpoint(None, {}, "this run") if in_memory else begun(tmp_path)
    for number in (12, 3, 1_234_567_890):
        chunks.write(number, CHUNK)
    assert chunks.done() == [3, 12, 1_234_567_890]
    for name, array in chunks.read(12).items():
        np.testing.assert_array_equal(array, CHUNK[name])
    assert list(chunks.read(3, "text")) == ["text"]


def test_the_same_record_goes_on_and_another_one_is_refused_by_its_entry(tmp_path: Path) -> None:
    begun(tmp_path).write(0, CHUNK)
    assert begun(tmp_path).done() == [0]
    refused("seed", lambda: begun(tmp_path, seed="1"), "it has changed since this run began; expected 0, as in ")
    for text in ("[]", "no record"):
        (tmp_path / "out.csv.parts" / "record.json").write_text(text)
        refused("out", lambda: begun(tmp_path), "the record of a run")


def test_a_chunk_is_there_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    checkpoint = begun(tmp_path)
    checkpoint.write(0, CHUNK)
    checkpoint.write(1, CHUNK)
    assert checkpoint.folder is not None
    file = checkpoint.folder / "chunk-0000000.npz"
    file.write_bytes(file.read_bytes()[:100])

    def full(*_: Any, **__: Any) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    with pytest.raises(OSError, match="No space left"):
        checkpoint.write(2, CHUNK)
    assert checkpoint.done() == [1]
    assert sorted(each.name for each in checkpoint.folder.iterdir()) == ["chunk-0000001.npz", "record.json"]


def test_what_is_made_once_is_kept_where_there_is_a_folder(tmp_path: Path) -> None:
    made: list[int] = []

    def make() -> dict[str, Any]:
        made.append(1)
        return CHUNK

    for _ in range(2):
        np.testing.assert_array_equal(begun(tmp_path).once(4, make)["q"], CHUNK["q"])
    assert len(made) == 1
    assert Checkpoint(None, {}, "this run").once(4, make) == CHUNK
    assert len(made) == 2


def test_nothing_is_left_in_the_end(tmp_path: Path) -> None:
    checkpoint = begun(tmp_path)
    checkpoint.write(0, CHUNK)
    checkpoint.remove()
    assert not checkpoint.begun
    checkpoint.remove()
    assert not list(tmp_path.iterdir())
