"""`show`: robots, scenes, targets, solutions and motions on a page that can be turned, and played where they move."""

import html as markup
import sys
import tempfile
import webbrowser
from collections.abc import Callable
from pathlib import Path
from typing import Any

from sinuous.base import checks
from sinuous.base.checks import written
from sinuous.base.errors import InputError
from sinuous.view.display.contents import gather

FRAME_PIXELS = 480
"""Of a page in a notebook, in pixels."""


def show(*things: Any, path: str | Path | None = None) -> None:
    """Show things on a page that can be turned with the mouse: inline in a notebook, otherwise in the browser.

    Needs the extra `view`. The page holds all that it shows, and works offline. Motions have a time slider.

    Parameters
    ----------
    *things : Robot, Scene, Obstacle, Target, Solution, Solutions, Motion, Problem, Job, or lists of them
        Of several solutions the first is solid, the others are ghosts. After a robot may stand an array of
        configurations (..., n, 3). A robot that gravity bends is shown with its load, and as a ghost without.
    path : path, optional
        Write the page into this file, `x.html`, and open nothing.

    Raises
    ------
    InputError
        When there is nothing to show, something cannot be shown, the extra is missing, or the file cannot be written.
    """
    if path is not None:
        check_page("path", Path(path))
    require_viser("path" if path is not None else "things", path)
    from sinuous.view.page.record import record_page  # noqa: PLC0415  # which needs viser

    page = record_page(gather(things))
    if path is not None:
        with written(path, "path"):
            Path(path).write_text(page, encoding="utf-8")
    elif "IPython" in sys.modules and (shell := _notebook()) is not None:
        shell(_inline(page))
    else:
        with tempfile.NamedTemporaryFile("w", suffix=".html", delete=False, encoding="utf-8") as file:
            file.write(page)
        webbrowser.open(Path(file.name).as_uri())


def check_page(key: str, file: Path) -> None:
    """Refuse a file name that does not end in `.html`, before anything is solved.

    Raises
    ------
    InputError
        For another ending, or when viser is missing.
    """
    if file.suffix.lower() != ".html":
        raise InputError(key, "", str(file), "a name that ends in .html")
    require_viser(key, file)


def require_viser(key: str, value: object) -> None:
    """Refuse to go on without viser.

    Raises
    ------
    InputError
        When it is missing.
    """
    checks.needed("viser", "view", key, None if value is None else str(value))


def _notebook() -> Callable[[str], object] | None:
    """Return what shows HTML in the notebook that runs this; None outside of one."""
    from IPython import get_ipython  # noqa: PLC0415

    shell = get_ipython()
    if shell is None or not hasattr(shell, "kernel"):
        return None
    from IPython.display import HTML, display  # noqa: PLC0415

    return lambda text: display(HTML(text))


def _inline(page: str) -> str:
    """The page as a frame within another page."""
    style = f"width:100%;height:{FRAME_PIXELS}px;border:1px solid #ddd"
    return f'<div><iframe srcdoc="{markup.escape(page, quote=True)}" style="{style}"></iframe></div>'
