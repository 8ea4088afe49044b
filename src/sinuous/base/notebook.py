"""What a notebook shows of an object."""

from collections.abc import Callable
from typing import Any, ClassVar


class NotebookMixin:
    """Lets a notebook show an object as HTML: a picture and a small table."""

    __slots__ = ()

    _html_renderer: ClassVar[Callable[[Any], str] | None] = None
    """Makes the HTML. It needs `sinuous.view.pictures`, which no noun may import, so `sinuous/__init__.py` sets it."""

    def _repr_html_(self) -> str | None:
        """HTML for a notebook; `None`: the notebook shows the text."""
        render = NotebookMixin._html_renderer
        return None if render is None else render(self)
