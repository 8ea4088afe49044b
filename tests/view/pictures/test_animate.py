"""Animations have their frames, and robots move in them."""

import shutil
import subprocess
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.view.display.contents import gather
from sinuous.view.display.style import Viewpoint
from sinuous.view.pictures.plot import draw_frames
from tests.helpers import refused
from tests.view.pictures.arms import ROBOT

pytest.importorskip("matplotlib")


def test_a_gif_of_a_motion(track: sn.Motion, tmp_path: Path) -> None:
    from PIL import Image

    file = tmp_path / "track.gif"
    sn.view.animate(track, path=file, seconds=0.5, fps=10)
    with Image.open(file) as image:
        assert image.n_frames == 5  # type: ignore[attr-defined]
        first = np.asarray(image.convert("RGB"), np.float64)
        image.seek(4)
        last = np.asarray(image.convert("RGB"), np.float64)
        assert image.info["duration"] > 1000  # it stands at its end
        assert image.info["loop"] == 0
    assert first.shape == last.shape
    assert 0.002 < (np.abs(first - last).max(axis=-1) > 60).mean() < 0.3
    assert file.stat().st_size < 200_000


def test_what_has_no_motion_turns() -> None:
    bent = np.array([[0.9, 0.0, 1.0]] * 3)
    seen = [frame.astype(np.float64) for frame in draw_frames(gather([ROBOT, bent]), Viewpoint(), 4, area=2.0)]
    assert len({frame.shape for frame in seen}) == 1
    for one, other in pairwise(seen):
        assert (np.abs(one - other).max(axis=-1) > 60).mean() > 0.001


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="no ffmpeg")
def test_a_film(track: sn.Motion, tmp_path: Path) -> None:
    file = tmp_path / "track.mp4"
    sn.view.animate(track, path=file, seconds=0.4, fps=10)
    asked = ["-show_entries", "stream=nb_frames,pix_fmt,codec_name", "-of", "csv=p=0"]
    said = subprocess.run(["ffprobe", "-v", "error", *asked, str(file)], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "h264,yuv420p,4"


def test_without_ffmpeg_it_says_so(track: sn.Motion, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    words = "needs the program ffmpeg; expected ffmpeg installed, or a name that ends in .gif"
    refused("path", lambda: sn.view.animate(track, path=tmp_path / "track.mp4"), words)


@pytest.mark.parametrize(
    ("file", "wrong", "key", "words"),
    [
        ("x.png", {}, "path", "expected a name that ends in .gif, .mp4"),
        ("x.gif", {"fps": 0}, "fps", ": expected"),
        ("x.gif", {"seconds": 0}, "seconds", ": expected"),
        ("no/x.gif", {"seconds": 0.1, "fps": 10}, "path", "cannot be written: "),
    ],
)
def test_wrong_arguments_are_named(tmp_path: Path, file: str, wrong: dict[str, Any], key: str, words: str) -> None:
    refused(key, lambda: sn.view.animate(ROBOT, path=tmp_path / file, **wrong), words)
