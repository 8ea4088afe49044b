"""Axes in space: figures for them, the box that they show, and how it fills the room that there is."""

import base64
import io
import math
import shutil
import subprocess
from collections.abc import Iterable
from contextlib import suppress
from html import escape
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.checks import Floats, written
from sinuous.base.errors import InputError
from sinuous.view.display import style
from sinuous.view.display.bounds import Bounds, bounds_of, direction_of
from sinuous.view.display.contents import Contents
from sinuous.view.display.style import Viewpoint

MARGIN_SHARE = 0.03
"""Between what is shown and the sides of the box, as a share of its longest side."""

LEAST_SIDE_SHARE = 0.3
"""Least side of the box, as a share of its longest."""

FILL_ROUNDS = 3
"""How often the size of the box is corrected; numbers and names keep theirs."""

PICTURE_INCHES, EDGE_INCHES, HEAD_INCHES = 6.4, 0.1, 0.3
"""Longer side of a picture, what is left free at its sides, and the height of a title, in inches."""


def axes_box(contents: Contents) -> Bounds:
    """Return the box that axes show: the bounds of the contents with a margin, and no side much shorter than others."""
    bounds = bounds_of(contents)
    sides = bounds.high - bounds.low
    longest = max(float(sides.max()), 1e-9)
    half = np.maximum(0.5 * sides, 0.5 * LEAST_SIDE_SHARE * longest) + MARGIN_SHARE * longest
    return Bounds(bounds.middle - half, bounds.middle + half)


def screen_axes(view: Viewpoint) -> Floats:
    """Return the unit vectors (2, 3) to the right and upwards on the screen."""
    a = math.radians(view.azimuth)
    right = np.array([-math.sin(a), math.cos(a), 0.0])
    return np.stack([right, np.cross(direction_of(view), right)])


def figure_size(bounds: Bounds, view: Viewpoint, area: float = PICTURE_INCHES) -> dict[str, Any]:
    """Return size and resolution of a figure that the bounds fill."""
    width, height = np.abs(screen_axes(view)) @ (bounds.high - bounds.low)
    longest = max(width, height)
    return {"figsize": (area * max(width / longest, 0.6) + 0.6, area * max(height / longest, 0.5) + 0.6), "dpi": 150}


def new_figure(**size: Any) -> Any:
    """Return a figure of its own, which touches neither pyplot nor the backend of a caller."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415
    from matplotlib.figure import Figure  # noqa: PLC0415

    figure = Figure(**size)
    FigureCanvasAgg(figure)
    return figure


def new_axes(figure: Any) -> Any:
    """Return axes in space as large as the figure; `fill_room` moves them to their place."""
    width, height = figure.get_size_inches()
    side = max(width, height)
    axes = figure.add_axes((0.0, 0.0, side / width, side / height), projection="3d", computed_zorder=False)
    axes.patch.set_visible(False)
    return axes


def room_of(figure: Any, head: float = HEAD_INCHES) -> Floats:
    """Opposite corners (2, 2), in pixels, of the room in a figure under a title of this height (inches)."""
    width, height = figure.get_size_inches()
    return figure.dpi * np.array([[EDGE_INCHES, EDGE_INCHES], [width - EDGE_INCHES, height - EDGE_INCHES - head]])


def set_bounds(axes: Any, bounds: Bounds, view: Viewpoint) -> None:
    """Show a box from a side, at equal scales."""
    from matplotlib.ticker import MaxNLocator  # noqa: PLC0415

    _tidy(axes)
    limits = zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), bounds.low, bounds.high, strict=True)
    for set_limits, low, high in limits:
        set_limits(low, high)
    for axis, side in zip((axes.xaxis, axes.yaxis, axes.zaxis), bounds.high - bounds.low, strict=True):
        most = max(2, round(style.AXIS_NUMBERS * side / bounds.span))
        axis.set_major_locator(MaxNLocator(most, steps=(1, 2, 2.5, 5, 10)))
    axes.set_proj_type("ortho")
    axes.view_init(elev=view.elevation, azim=view.azimuth)
    axes.set_box_aspect(bounds.high - bounds.low)


def fill_room(axes: Any, bounds: Bounds, frame: Floats | None = None) -> None:
    """Draw the box as large as there is room for it, its numbers and its names.

    `frame` (2, 2) are opposite corners of the room, in pixels, and the axes are moved to its middle; by default the
    room is that of the axes, which stay.
    """
    figure, zoom = axes.get_figure(root=True), 1.0
    for _ in range(FILL_ROUNDS):
        axes.set_box_aspect(bounds.high - bounds.low, zoom=zoom)
        low, high = _drawn(axes, bounds)
        room = np.array([axes.bbox.p0, axes.bbox.p1]) if frame is None else frame
        zoom *= max(float(((room[1] - room[0]) / np.maximum(high - low, 1.0)).min()), 0.1)
        if frame is not None:
            shift = (room.mean(axis=0) - 0.5 * (low + high)) / [figure.bbox.width, figure.bbox.height]
            place = axes.get_position()
            axes.set_position([place.x0 + shift[0], place.y0 + shift[1], place.width, place.height])


def _drawn(axes: Any, bounds: Bounds) -> tuple[Floats, Floats]:
    """Opposite corners, in pixels, of the room that the box takes with its numbers and names."""
    from mpl_toolkits.mplot3d.proj3d import proj_transform  # noqa: PLC0415

    axes.apply_aspect()
    axes.M = axes.get_proj()
    corners = np.array([[(bounds.low, bounds.high)[i >> k & 1][k] for k in range(3)] for i in range(8)])
    x, y, _ = proj_transform(*corners.T, axes.M)
    points = [axes.transData.transform(np.stack([x, y], axis=-1))]
    renderer = axes.get_figure(root=True)._get_renderer()
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis) if axes._axis3don else ():
        box = axis.get_tightbbox(renderer)
        points.append(np.array([box.p0, box.p1]))
    every = np.concatenate(points)
    return every.min(axis=0), every.max(axis=0)


def _tidy(axes: Any) -> None:
    """Give axes in space a pale grid and few ticks."""
    axes.computed_zorder = False
    for axis, label in ((axes.xaxis, "x"), (axes.yaxis, "y"), (axes.zaxis, "z")):
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
        axis.line.set_color(style.LINE)
        axis._axinfo["grid"].update(color=style.GRID, linewidth=0.7)
        axis._axinfo["tick"].update(inward_factor=0.0, outward_factor=0.1)
        axis.set_label_text(label, color=style.PALE, fontsize=style.TEXT_PT)
        axis.set_tick_params(labelsize=style.SMALL_PT, labelcolor=style.PALE, color=style.LINE, pad=1.0)
        axis.labelpad = 2.0


MOVIES = ("gif", "mp4")
"""Kinds of moving pictures."""


def need_matplotlib(key: str, value: object = None) -> None:
    """Refuse to draw where there is no Matplotlib.

    Raises
    ------
    InputError
        That names the extra to install.
    """
    checks.needed("matplotlib.backend_bases", "plot", key, value, "Matplotlib")


def check_picture(key: str, file: Path, *, still: bool = True, others: tuple[str, ...] = MOVIES) -> None:
    """Refuse a picture that cannot be drawn, before anything is solved.

    What may be meant are still pictures, unless that is not `still`, and the endings of `others`.

    Raises
    ------
    InputError
        When Matplotlib or ffmpeg is missing, or the kind of file is another.
    """
    need_matplotlib(key, str(file))
    from matplotlib.backend_bases import FigureCanvasBase  # noqa: PLC0415

    stills = ("png", "svg", "pdf", *others, *sorted(FigureCanvasBase.filetypes))  # what is meant most stands first
    known = tuple(dict.fromkeys(stills if still else others))
    kind = file.suffix.lower().lstrip(".")
    if kind not in known:
        raise InputError(key, "", str(file), "a name that ends in ." + ", .".join(known))
    if kind == "mp4" and shutil.which("ffmpeg") is None:
        raise InputError(key, "needs the program ffmpeg", str(file), "ffmpeg installed, or a name that ends in .gif")


TIGHT = {"bbox_inches": "tight", "pad_inches": 0.15}
"""How a figure is saved without its empty border."""


def image_in_page(figure: Any, said: str, **options: Any) -> str:
    """Return the element of a page that holds a figure as a PNG, and a text for those who do not see it."""
    file = io.BytesIO()
    figure.savefig(file, format="png", **options)
    return f'<img alt="{escape(said)}" src="data:image/png;base64,{base64.b64encode(file.getvalue()).decode()}">'


def save_figure(figure: Any, file: Path) -> None:
    """Write a figure, without its empty border.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    with written(file, "file"):
        figure.savefig(file, **TIGHT)


GIF_COLOURS = 128
"""Colours of a GIF."""

HOLD_SECONDS = 1.2
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
    ends = Image.fromarray(np.concatenate([np.asarray(images[0]), np.asarray(images[-1])]))
    palette = ends.quantize(GIF_COLOURS, method=Image.Quantize.MAXCOVERAGE)  # keeps white white, as others do not
    flat = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    durations = [round(1000 / fps)] * (len(flat) - 1) + [round(1000 * HOLD_SECONDS)]
    flat[0].save(file, save_all=True, append_images=flat[1:], duration=durations, loop=0, optimize=True)


def _write_mp4(file: Path, frames: Iterable[Pixels], fps: int) -> None:
    """H.264 in the format of colours that every player knows; sides of an odd length lose one row of pixels."""
    pictures = iter(frames)
    first = next(pictures)
    height, width = (side // 2 * 2 for side in first.shape[:2])
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(fps), "-i", "-"]
    coded = ["-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "20", "-movflags", "+faststart"]
    command = ["ffmpeg", "-y", "-loglevel", "error", *raw, *coded, str(file)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as ffmpeg:
        assert ffmpeg.stdin is not None
        with suppress(BrokenPipeError):  # it may end before it has them all
            for frame in chain([first], pictures):
                ffmpeg.stdin.write(frame[:height, :width].tobytes())
        said = " ".join(ffmpeg.communicate()[1].decode(errors="replace").split())
    if ffmpeg.returncode:
        raise InputError("path", f"ffmpeg: {said}", str(file), "a film that ffmpeg can write")
