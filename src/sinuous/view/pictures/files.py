"""Files that pictures go into: which there are, and that they can be written."""

import base64
import io
import shutil
from html import escape
from pathlib import Path
from typing import Any

from sinuous.base import checks
from sinuous.base.documents import written
from sinuous.base.errors import InputError

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


def stills() -> tuple[str, ...]:
    """Endings of still pictures."""
    from matplotlib.backend_bases import FigureCanvasBase  # noqa: PLC0415

    return tuple(sorted(FigureCanvasBase.filetypes))


def check_picture(key: str, file: Path, kinds: tuple[str, ...] | None = None) -> None:
    """Refuse a picture that cannot be drawn, before anything is solved.

    `kinds` are the endings that may be meant; by default all that there are.

    Raises
    ------
    InputError
        When Matplotlib or ffmpeg is missing, or the kind of file is another.
    """
    need_matplotlib(key, str(file))
    known = sorted({*stills(), *MOVIES}) if kinds is None else list(kinds)
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
