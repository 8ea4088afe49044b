"""`--plot` writes every kind of picture, and a motion with its diagrams."""

import sys
from pathlib import Path

import pytest

import sinuous as sn
from sinuous.view.pictures.reports import write_picture
from tests.helpers import refused
from tests.view.pictures.arms import ROBOT, share_of

matplotlib = pytest.importorskip("matplotlib")


@pytest.mark.parametrize("kind", ["png", "pdf", "svg"])
def test_kinds_of_pictures(tmp_path: Path, kind: str, track: sn.Motion) -> None:
    file = tmp_path / f"shape.{kind}"
    write_picture(file, track.solutions[0])
    assert 5_000 < file.stat().st_size < 3_000_000


def test_a_motion_stands_beside_its_diagrams(tmp_path: Path, track: sn.Motion) -> None:
    for name, thing in (("track", track), ("shape", track.solutions[0])):
        write_picture(tmp_path / f"{name}.png", thing)
    both, alone = (matplotlib.image.imread(tmp_path / f"{name}.png") for name in ("track", "shape"))
    assert both.shape[1] > 1.5 * alone.shape[1]
    right = both[:, -int(0.35 * both.shape[1]) :]
    assert share_of(right, (1.0, 1.0, 1.0)) < 0.98
    assert share_of(alone, (0.0, 0.447, 0.698), 0.2) > 0.005


def test_nothing_global_is_touched(tmp_path: Path, track: sn.Motion) -> None:
    settings = dict(matplotlib.rcParams)
    had_pyplot = "matplotlib.pyplot" in sys.modules
    write_picture(tmp_path / "shape.png", track)
    assert dict(matplotlib.rcParams) == settings
    assert ("matplotlib.pyplot" in sys.modules) == had_pyplot


def test_what_cannot_be_written_is_said(tmp_path: Path) -> None:
    refused("path", lambda: write_picture(tmp_path / "no" / "shape.png", ROBOT), "cannot be written: ")
    refused("path", lambda: write_picture(tmp_path / "shape.exe", ROBOT), "expected a name that ends in .")
