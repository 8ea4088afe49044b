"""The picture of places."""

from pathlib import Path

import pytest

from benchmarks.clutter import gallery
from benchmarks.places import FAMILIES
from sinuous.base.errors import InputError


def test_families_are_drawn(tmp_path: Path) -> None:
    file = tmp_path / "places.png"
    gallery.draw(file, {"p3": 0, "shelf": 1})
    assert file.stat().st_size > 10_000


def test_what_is_shown_exists() -> None:
    assert set(gallery.SHOWN) <= set(FAMILIES)


def test_no_kind_of_picture_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"^FILE: expected a name that ends in .*\.png.*places\.xyz'$"):
        gallery.draw(tmp_path / "places.xyz")


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ([], "python -m benchmarks.clutter.gallery: Missing argument 'FILE'"),
        (["places.xyz"], "FILE: expected a name that ends in ."),
        (["/nowhere/places.png"], "FILE: expected a file that can be written, got '/nowhere/places.png' ("),
    ],
)
def test_what_cannot_be_meant_is_one_line(
    arguments: list[str],
    complaint: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert gallery.main(arguments) == 2
    captured = capsys.readouterr()
    assert captured.err.startswith(complaint)
    assert captured.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
