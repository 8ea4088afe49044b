"""Fields of the panel that show what the model says, and tell when a person changes them."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from viser import GuiApi

if TYPE_CHECKING:
    from sinuous.viewer.page.page import Page


class Fields:
    """Fields, each with what the model says it holds, and buttons."""

    def __init__(self) -> None:
        self._bound: list[tuple[Any, Callable[[], Any]]] = []
        self._buttons: list[Any] = []

    def bind(self, handle: Any, get: Callable[[], Any], changed: Callable[[Any], None]) -> None:
        """Show `get()` in a field from now on; call `changed` with what a person puts there.

        `changed` runs on the loop of the server and must return at once.
        """
        self._bound.append((handle, get))

        @handle.on_update  # type: ignore[untyped-decorator]
        async def _(event: Any) -> None:
            if event.client is not None:
                changed(handle.value)

    def press(self, handle: Any, act: Callable[[Any], None]) -> None:
        """Call `act` with the event when a button is pressed."""
        self._buttons.append(handle)

        @handle.on_click  # type: ignore[untyped-decorator]
        async def _(event: Any) -> None:
            act(event)

    def refresh(self) -> None:
        """Show what the model says now; what was refused vanishes from the page so."""
        for handle, get in self._bound:
            value = get()
            if handle.value != value:
                handle.value = value

    def clear(self) -> None:
        """Take all fields and buttons from the panel."""
        for handle in [*(handle for handle, _ in self._bound), *self._buttons]:
            handle.remove()
        self._bound, self._buttons = [], []


Build = Callable[[GuiApi, "Page", Fields], None]


class Section:
    """A part of the panel; it is built anew when what it is made for changes.

    Parameters
    ----------
    page : Page
    container : handle of a tab or folder
    build : callable
        Puts the fields into the container.
    made_for : callable
        Returns what the fields are made for.
    """

    def __init__(self, page: "Page", container: Any, build: Build, made_for: Callable[[], object]) -> None:
        self._page, self._container, self._build, self._made_for = page, container, build, made_for
        self._fields = Fields()
        self._now: object = None

    def refresh(self) -> None:
        """Show what the model says now."""
        now = (self._made_for(),)
        if now != self._now:
            self._now = now
            self._fields.clear()
            with self._container:
                self._build(self._page.server.gui, self._page, self._fields)
        self._fields.refresh()


def step_of(size: float) -> float:
    """A step to type and drag lengths of this size in: a thousandth, rounded to a power of ten."""
    return float(10.0 ** math.floor(math.log10(max(size, 1e-300) / 300.0)))
