"""Pictures one after the other, as an animated GIF (Pillow) or as MP4 (ffmpeg)."""

import subprocess
from collections.abc import Iterable
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous.errors import InputError
from sinuous.pictures.style import ARMS, INK, PATH, ROUTE, TARGET, UNSOLVED

COLOURS = 128
"""Of a GIF."""

KEPT = ("#ffffff", TARGET, PATH, ROUTE, *ARMS[0], *UNSOLVED, INK)
"""Colours that every GIF has as they are."""

NEARLY_WHITE = 246
"""What the mean of white and its neighbours exceeds, of 255: it becomes white."""

HOLD = 1.2
"""Seconds that a GIF stands at its end before it begins anew."""

Pixels = NDArray[np.uint8]


def write_movie(file: Path, frames: Iterable[Pixels], fps: int) -> None:
    """Write pictures (height, width, 3) of one size; the ending of the file says how.

    Raises
    ------
    InputError
        When ffmpeg fails.
    OSError
        When the file cannot be written.
    """
    (_write_gif if file.suffix.lower() == ".gif" else _write_mp4)(file, frames, fps)


def _write_gif(file: Path, frames: Iterable[Pixels], fps: int) -> None:
    """Give all pictures the colours of the first and the last: what does not change between two takes no room."""
    from PIL import Image  # noqa: PLC0415

    images = [Image.fromarray(frame) for frame in frames]
    palette = palette_of(Image.fromarray(np.concatenate([np.asarray(images[0]), np.asarray(images[-1])])))
    flat = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    durations = [round(1000 / fps)] * (len(flat) - 1) + [round(1000 * HOLD)]
    flat[0].save(file, save_all=True, append_images=flat[1:], duration=durations, loop=0, optimize=True)


def palette_of(image: Any, count: int = COLOURS) -> Any:
    """Return a palette of so many colours: those of an image, and those that all our pictures have."""
    from matplotlib.colors import to_rgb  # noqa: PLC0415
    from PIL import Image  # noqa: PLC0415

    kept = [round(255.0 * part) for colour in KEPT for part in to_rgb(colour)]
    found = np.array(image.quantize(count - len(KEPT), method=Image.Quantize.MEDIANCUT).getpalette()).reshape(-1, 3)
    found[(found > NEARLY_WHITE).all(axis=-1)] = 255
    palette = Image.new("P", (1, 1))
    palette.putpalette([*found[: count - len(KEPT)].ravel().tolist(), *kept])
    return palette


def _write_mp4(file: Path, frames: Iterable[Pixels], fps: int) -> None:
    """H.264 in the format of colours that every player knows; sides of an odd length lose one row of pixels."""
    pictures = iter(frames)
    first = next(pictures)
    height, width = (side // 2 * 2 for side in first.shape[:2])
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(fps), "-i", "-"]
    coded = ["-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "20", "-movflags", "+faststart"]
    command = ["ffmpeg", "-y", "-loglevel", "error", *raw, *coded, str(file)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as ffmpeg:
        said = _feed(ffmpeg, (np.ascontiguousarray(each[:height, :width]) for each in chain([first], pictures)))
    if ffmpeg.returncode:
        raise InputError("path", f"ffmpeg: {said}", str(file), "a film that ffmpeg can write")


def _feed(ffmpeg: "subprocess.Popen[bytes]", frames: Iterable[Any]) -> str:
    """Hand pictures over; return what ffmpeg says in the end. It may end before it has them all."""
    assert ffmpeg.stdin is not None
    assert ffmpeg.stderr is not None
    try:
        for frame in frames:
            ffmpeg.stdin.write(frame.tobytes())
        ffmpeg.stdin.close()
    except BrokenPipeError:
        pass
    return " ".join(ffmpeg.stderr.read().decode(errors="replace").split())
