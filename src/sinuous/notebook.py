"""What notebooks show of an object. It is drawn by a face, far above the objects; the front door joins the two."""

from collections.abc import Callable
from typing import Any


class Shown:
    """Shows itself in notebooks with a picture and a small table."""

    __slots__ = ()

    def _repr_html_(self) -> str | None:
        """What a notebook shows; `None`: the text, as anywhere else."""
        return None if Face.html is None else Face.html(self)


class Face:
    """What draws."""

    html: Callable[[Any], str] | None = None
