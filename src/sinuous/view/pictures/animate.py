"""Moving pictures: robots on their way, or a scene that turns once."""

import subprocess
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.arguments import Number, Whole
from sinuous.base.documents import written
from sinuous.base.errors import InputError
from sinuous.scene.moving import Moving
from sinuous.view.display.bounds import Bounds
from sinuous.view.display.contents import Contents, Things, gather
from sinuous.view.display.style import ARMS, INK, PATH, ROUTE, TARGET, TIP_PATH, UNSOLVED, Viewpoint
from sinuous.view.pictures.figures import (
    MOVIES,
    axes_box,
    check_picture,
    fill,
    new_axes,
    new_figure,
    room_of,
    set_bounds,
    sizes,
)
from sinuous.view.pictures.paint import add, paint_arms, paint_walls, places_of, walls_of
from sinuous.view.pictures.plot import as_view, draw_dots, draw_forces, draw_head, draw_lines, draw_surfaces, tip_paths

AREA, DPI = 4.6, 110.0
"""Longer side of a moving picture, in inches, and pixels in one."""

LOOKS = 24
"""Places on its way at which obstacles are made see-through where they hide a robot."""

COLOURS = 128
"""Of a GIF."""

KEPT = ("#ffffff", TARGET, PATH, ROUTE, *ARMS[0], *UNSOLVED, INK)
"""Colours that every GIF has as they are."""

NEARLY_WHITE = 246
"""What the mean of white and its neighbours exceeds, of 255: it becomes white."""

HOLD = 1.2
"""Seconds that a GIF stands at its end before it begins anew."""

Pixels = NDArray[np.uint8]


def animate(
    *things: Things,
    path: str | Path,
    view: Sequence[Number] = (30, -60),
    seconds: Number = 4.0,
    fps: Whole = 15,
) -> None:
    """Write an animation: motions from beginning to end; what has none is shown from all sides.

    Parameters
    ----------
    *things
        As for `plot`.
    path : path
        Ends in `.gif`, or in `.mp4` where the program ffmpeg is.
    view : (float, float)
        Elevation and azimuth in degrees, as for `plot`.
    seconds : float
        How long it takes. Several motions begin together and end together.
    fps : int
        Pictures a second.

    Raises
    ------
    InputError
        When something that is needed is missing, a thing cannot be drawn, or the file cannot be written.
    """
    file = Path(path)
    check_picture("path", file, MOVIES)
    seen = as_view(view)
    rate = checks.integer("fps", fps, 1, 100)
    count = max(2, round(checks.number("seconds", seconds, above=0.0) * rate))
    contents = gather(things)
    with written(file, "path"):
        write_movie(file, frames(contents, seen, count), rate)


def frames(contents: Contents, view: Viewpoint, count: int, *, area: float = AREA) -> Iterator[Pixels]:
    """Yield pictures (height, width, 3), all of one size."""
    return _moving(contents, view, count, area) if contents.moving else _turning(contents, view, count, area)


def _moving(contents: Contents, view: Viewpoint, count: int, area: float) -> Iterator[Pixels]:
    """The view stays; obstacles are see-through wherever they hide a robot on its way."""
    box = axes_box(contents)
    figure = new_figure(**sizes(box, view, area) | {"dpi": DPI})
    axes = _prepared(figure, contents, box, view)
    fill(axes, box, room_of(figure))
    bodies = places_of(contents.arms_at(*np.linspace(0.0, 1.0, LOOKS).tolist()), box)
    still = [obstacle for obstacle in contents.obstacles if not isinstance(obstacle, Moving)]
    walls = paint_walls(walls_of(still, box), *bodies, view)
    draw_dots(axes, still, box)
    draw_lines(axes, contents, box, moving=False)
    paths = tip_paths(contents)
    for share in np.linspace(0.0, 1.0, count).tolist():
        arms = contents.arms_at(share)
        there = [own for own in contents.obstacles_at(share) if not any(own is one for one in still)]
        moved = paint_walls(walls_of(there, box), *bodies, view) if there else []
        drawn = [add(axes, walls + moved + paint_arms(arms, box, view)), *draw_dots(axes, there, box)]
        for moving in contents.moving:
            drawn += draw_forces(axes, moving.forces_at(share))
        for path in paths:
            until = 1 + round(share * (len(path) - 1))
            drawn += axes.plot(*path[:until].T, color=TIP_PATH, linewidth=1.6, zorder=4)
        yield _pixels(figure)
        for artist in drawn:
            artist.remove()


def _turning(contents: Contents, view: Viewpoint, count: int, area: float) -> Iterator[Pixels]:
    """The viewer goes once around, as far away as is needed from the worst side."""
    box = axes_box(contents)
    half = 0.5 * np.array([*np.full(2, np.hypot(*(box.high - box.low)[:2])), (box.high - box.low)[2]])
    around = Bounds(box.middle - half, box.middle + half)
    figure = new_figure(**sizes(around, Viewpoint(view.elevation, 0.0), area) | {"dpi": DPI})
    for turn in np.linspace(0.0, 360.0, count, endpoint=False).tolist():
        figure.clear()
        seen = Viewpoint(view.elevation, view.azimuth + turn)
        axes = _prepared(figure, contents, box, seen)
        axes.set_axis_off()
        fill(axes, box, room_of(figure))
        draw_surfaces(axes, contents, box, seen)
        draw_lines(axes, contents, box)
        yield _pixels(figure)


def _prepared(figure: Any, contents: Contents, box: Bounds, view: Viewpoint) -> Any:
    axes = new_axes(figure)
    set_bounds(axes, box, view)
    draw_head(figure, contents, room_of(figure))
    return axes


def _pixels(figure: Any) -> Pixels:
    figure.canvas.draw()
    return np.array(figure.canvas.buffer_rgba())[..., :3]


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
