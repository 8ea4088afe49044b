"""The panel beside the scene: what holds of the shape, and tabs with everything that can be changed."""

import html as markup
import itertools
import math
import threading
import time as clock
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from viser import GuiApi, uplot

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.view.display.results import Curves
from sinuous.view.display.style import COLOUR_SCALE, CONTACT, CURVES, MOST_IN_LEGEND
from sinuous.view.page.nodes import update_node
from sinuous.view.page.session import Session
from sinuous.view.page.status import STYLE, block_html, notice_html, scale_html

PLOT_PIXELS = 220
"""Height of a plot, in pixels."""

FIELD_DIGITS, SLIDER_DIGITS = 7, 4
"""Digits of a number in a box, and in one beside a slider."""

TYPING_SECONDS = 1.5
"""Seconds after the last key in which a box is left to who types."""

ROW_STYLE = """{0} {{ display: inline-block; width: {1:.2f}%; vertical-align: bottom; padding-right: 0; }}
{0} > * {{ display: block; }} {0} > * > :first-child {{ width: auto !important; }}"""
"""Places boxes side by side, each below its label."""

SLIDER_STYLE = """{0} {{ display: inline-block; width: 80%; padding-right: 0; }}
{0} .mantine-NumberInput-root {{ display: none; }}
{1} {{ display: inline-block; width: 20%; vertical-align: top; }} {1} > * > :first-child {{ display: none; }}"""
"""Places the box beside a slider, in the place of the slider's own."""

WRONG_STYLE = ":has(> * > {0}) + * input {{ border-color: #c92a2a; }}"
"""Marks a box with what was refused."""


class Fields:
    """The fields and buttons of a part of the panel.

    A field shows what the model says. What a person puts there, and a button that is pressed, are events of the
    session, keyed by their labels.
    """

    def __init__(self, gui: GuiApi, session: Session) -> None:
        self.gui, self._session = gui, session
        self._bound: list[_Bound] = []
        self._conditions: list[tuple[Any, Callable[[], bool]]] = []
        self._handles: list[Any] = []
        self._rows: list[tuple[list[BoundBox], Any]] = []

    def field(
        self, handle: Any, get: Callable[[], Any], put: Callable[[Any], object], *, at_once: bool = False
    ) -> None:
        """Show `get()` in a field; `put` is called with what a person puts there, and changes the model.

        With `at_once` it is called on the loop of the server, where it must return at once, not as an event.
        """
        bound = _Bound(handle, get)
        self._bound.append(bound)
        self._handles.append(handle)

        def change(value: Any) -> None:
            bound.known = value
            put(value)

        @handle.on_update  # type: ignore[untyped-decorator]
        async def _(event: Any) -> None:
            if event.client is not None:
                act = partial(change, handle.value)
                act() if at_once else self._session.do(handle.label, act)

    def numbers(self, *boxes: "NumberBox", hint: str | None = None) -> Any:
        """Add boxes for numbers side by side, with a line below that says what was refused. Return the first one's.

        What is typed and is no number, or cannot be, changes nothing: after a while its box shows the old number again.
        """
        row = [self._box(box, box.label, hint) for box in boxes]
        if len(row) > 1:
            every = ", ".join(map(_around, (box.handle for box in row)))
            self._style(ROW_STYLE.format(f":is({every})", 100 / len(row)))
        self._line(row)
        return row[0].handle

    def _box(self, box: "NumberBox", label: str, hint: str | None = None, digits: int = FIELD_DIGITS) -> "BoundBox":
        bound = BoundBox(self.gui.add_text(label, "", hint=hint), box, self._session.turn_view, digits)
        self._bound.append(bound)
        self._handles.append(bound.handle)

        @bound.handle.on_update  # type: ignore[untyped-decorator]
        async def _(event: Any) -> None:
            if event.client is not None:
                self._session.do(bound, partial(bound.put, bound.hear()))

        return bound

    def _style(self, style: str) -> None:
        self._handles.append(self.gui.add_html(f"<style>{style}</style>"))

    def _line(self, row: "list[BoundBox]") -> None:
        """Add the line that says what was refused in a row."""
        self._rows.append((row, self.gui.add_html("", visible=False)))
        self._handles.append(self._rows[-1][1])

    def number(self, label: str, get: Callable[[], float], put: Callable[[Any], object], **look: Any) -> Any:
        """Add a box for a number; arguments of `NumberBox`, and `hint`. Return its handle."""
        hint = look.pop("hint", None)
        return self.numbers(NumberBox(label, get, put, **look), hint=hint)

    def vector(self, labels: Sequence[str], get: Callable[[], Floats], put: Any, hint: str | None = None) -> None:
        """Add boxes for the components of a vector."""

        def change(i: int, value: float) -> None:
            wanted = np.array(get())
            wanted[i] = value
            put(wanted)

        own = [partial(lambda i: float(get()[i]), i) for i in range(len(labels))]
        self.numbers(*(NumberBox(name, own[i], partial(change, i)) for i, name in enumerate(labels)), hint=hint)

    def slider(self, label: str, ends: Sequence[float], get: Callable[[], Any], put: Any, step: Any = None) -> None:
        """Add a slider with a number, from one end to the other; it is longer while its value is beyond an end."""
        step = step_of(ends[1] - ends[0]) if step is None else step
        digits = max(0, round(-math.log10(step)))

        def shown() -> Any:
            value = type(step)(round(float(get()), digits))
            low, high = min(ends[0], value), max(ends[1], value)
            if (handle.min, handle.max) != (low, high):
                handle.min, handle.max = low, high
            return value

        handle = self.gui.add_slider(label, ends[0], ends[1], step, ends[0])
        self.field(handle, shown, put)
        number = NumberBox(label, get, put, float(ends[0]), float(ends[1]), whole=isinstance(step, int))
        box = self._box(number, "", digits=SLIDER_DIGITS)  # its own takes no number away, and says nothing
        self._style(SLIDER_STYLE.format(_around(handle), _around(box.handle)))
        self._line([box])

    def choice(
        self, label: str, options: Sequence[str], get: Callable[[], str], put: Any, hint: str | None = None
    ) -> None:
        """Add a list of which one entry is chosen."""
        self.field(self.gui.add_dropdown(label, options, hint=hint), get, put)

    def index(
        self, label: str, names: Callable[[], tuple[str, ...]], get: Callable[[], int], put: Any, hint: str
    ) -> Any:
        """Add a list of `names()`, which may change; `get` and `put` count its entries. Return its handle."""
        handle = self.gui.add_dropdown(label, names(), hint=hint)

        def chosen() -> str:
            if tuple(handle.options) != names():
                handle.options = names()
            return names()[get()]

        def choose(name: str) -> None:
            if name in names():
                put(names().index(name))

        self.field(handle, chosen, choose)
        return handle

    def text(self, text: str) -> None:
        """Add a sentence."""
        self._handles.append(self.gui.add_html(block_html(markup.escape(text))))

    def plot(self, curves: Curves) -> None:
        """Add a plot of curves over time, with numbers where the mouse points."""
        colours = itertools.cycle(CURVES)
        series = [uplot.Series(label=name, stroke=next(colours), width=1.5) for name in curves.names]
        few = len(curves.names) <= MOST_IN_LEGEND
        self._handles.append(
            self.gui.add_uplot(
                (curves.times, *curves.values.T),
                (uplot.Series(label="time"), *series),
                title=f"{curves.title}, {curves.unit}",
                scales={"x": uplot.Scale(time=False)},
                legend=uplot.Legend(show=few),
                height=PLOT_PIXELS,
            )
        )

    def button(self, label: str, act: Callable[[], object], hint: str | None = None, color: Any = "gray") -> Any:
        """Add a button; `act` is what happens in the session when it is pressed. Return its handle."""
        return self.answer(label, lambda _: act(), hint, color)

    def answer(self, label: str, act: Callable[[Any], object], hint: str | None = None, color: Any = "gray") -> Any:
        """Add a button; `act` is told the browser in which it is pressed. Return its handle."""
        handle = self.gui.add_button(label, hint=hint, color=color)
        self._handles.append(handle)

        @handle.on_click
        async def _(event: Any) -> None:
            self._session.do((label, object()), partial(act, event.client))  # none takes the place of another one

        return handle

    def file(self, label: str, name: str, content: Callable[[], str], hint: str) -> Any:
        """Add a button that sends a file of that content to the browser. Return its handle."""

        def send(client: Any) -> None:
            client.send_file_download(name, content().encode(), save_immediately=True)

        return self.answer(label, send, hint)

    def refresh(self) -> None:
        """Show what the model says now; what was refused vanishes from the page so."""
        for bound in self._bound:
            bound.refresh()
        for handle, holds in self._conditions:
            if handle.visible != holds():
                handle.visible = holds()
        for row, line in self._rows:
            wrong = [box for box in row if box in self._session.refused]
            said = [
                f"<style>{WRONG_STYLE.format(_label(box.handle))}</style>{notice_html(self._session.refused[box])}"
                for box in wrong
            ]
            update_node(line, visible=bool(said), content=block_html(*said))

    def only_while(self, holds: Callable[[], bool], *handles: Any) -> None:
        """Show fields and buttons only while something holds."""
        self._conditions += [(handle, holds) for handle in handles]

    def clear(self) -> None:
        """Take all fields and buttons from the panel."""
        for handle in self._handles:
            handle.remove()
        self._bound, self._conditions, self._handles, self._rows = [], [], [], []


class _Bound:
    """A field that shows `get()`.

    `known` is what it shows as far as the model knows: not yet what a person has put there since, which would be
    taken back if the field were compared with the model before that event is handled.
    """

    def __init__(self, handle: Any, get: Callable[[], Any]) -> None:
        self.handle, self.known, self._get = handle, handle.value, get

    def refresh(self) -> None:
        """Show what the model says, where that has changed."""
        value = self._get()
        if self.known != value:
            self.handle.value = self.known = value


class NumberBox(NamedTuple):
    """A box for a number.

    Attributes
    ----------
    label : str
        With the unit.
    get, put : callable
        Tell the number, and change it.
    low, high : float
        The least and the largest number that it takes.
    whole : bool
        Whether it takes whole numbers alone.
    """

    label: str
    get: Callable[[], float]
    put: Callable[[Any], object]
    low: float = -math.inf
    high: float = math.inf
    whole: bool = False

    def read(self, text: str) -> float:
        """Return the number that a text says.

        Raises
        ------
        InputError
            When it says none that fits.
        """
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise InputError(self.label, "", text, "a number such as 0.5")
        if self.whole and value == int(value):
            return checks.integer(self.label, int(value), int(self.low), int(self.high))
        return checks.number(self.label, value, low=self.low, high=self.high)


class BoundBox(_Bound):
    """A box for a number on the page: it takes text, and leaves what somebody types alone until that is done."""

    def __init__(self, handle: Any, box: NumberBox, look_again: Callable[[], object], digits: int) -> None:
        super().__init__(handle, box.get)
        self._box, self._look_again, self._rests, self._digits = box, look_again, 0.0, digits
        self._show(box.get())

    def hear(self) -> str:
        """Return what somebody types."""
        self._rests = clock.monotonic() + TYPING_SECONDS
        return str(self.handle.value)

    def put(self, text: str) -> None:
        """Change the model to what was typed."""
        self.known = math.nan
        try:
            self.known = self._box.read(text)
            self._box.put(self.known)
        finally:
            if self.known != self._get():
                later = threading.Timer(TYPING_SECONDS + 0.1, self._look_again)
                later.daemon = True
                later.start()

    def refresh(self) -> None:
        """Show the number of the model, where that has changed and nobody types."""
        value = self._get()
        if self.known != value and clock.monotonic() > self._rests:
            self._show(value)

    def _show(self, value: float) -> None:
        self.handle.value, self.known = f"{value + 0.0:.{self._digits}g}", value


def _label(handle: Any) -> str:
    """What selects the label of a field in a style."""
    return f'label[for="{handle._impl.uuid}"]'


def _around(handle: Any) -> str:
    """What selects a field with its label in a style."""
    return f"div:has(> * > * > * > {_label(handle)})"


def step_of(size: float) -> float:
    """A step to type and drag lengths of this size in: a thousandth, rounded to a power of ten."""
    return float(10.0 ** math.floor(math.log10(max(size, 1e-300) / 300.0)))


PANEL_PIXELS = 440.0
"""Width of the panel, in pixels: all tabs stand in one row."""

Build = Callable[[Fields], None]
"""Puts fields into the panel."""


class Section:
    """A part of the panel; it is built anew when what it is made for changes.

    Parameters
    ----------
    container : handle of a tab or folder
    fields : Fields
    build : callable
        Puts the fields into the container.
    made_for : callable
        Returns what the fields are made for.
    """

    def __init__(self, container: Any, fields: Fields, build: Build, made_for: Callable[[], object]) -> None:
        self._container, self._fields, self._build, self._made_for = container, fields, build, made_for
        self._now: object = None

    def refresh(self) -> None:
        """Show what the model says now."""
        now = (self._made_for(),)
        if now != self._now:
            self._now = now
            self._fields.clear()
            with self._container:
                self._build(self._fields)
        self._fields.refresh()


class Action(NamedTuple):
    """What is always at hand: a button in the first row, and a key.

    Attributes
    ----------
    label : str
    key, modifier : str or None
        As `GuiApi.add_command` has them.
    act : callable
        Told the browser in which it was asked for; returns at once.
    """

    label: str
    key: Any
    modifier: Any
    act: Callable[[Any], object]


Part = tuple[str, Callable[[Session, Fields], None], Callable[[Session], object]]
"""The name of a tab, what puts fields into it, and what tells what these are made for."""


class Panel:
    """The panel of a page; `actions` are its first row, and `parts` stand below each other in its tabs."""

    def __init__(self, gui: GuiApi, session: Session, actions: Sequence[Action], parts: Sequence[Part]) -> None:
        self._session = session
        _add_actions(gui, actions)
        self._status = gui.add_html("")
        self._folder = gui.add_folder("Details", expand_by_default=False)
        with self._folder:
            self._details = gui.add_html("")
        group = gui.add_tab_group()
        self._sections, places = [], dict[str, Any]()
        for name, build, made_for in parts:
            tab = places[name] = places.get(name) or group.add_tab(name)
            own = Fields(gui, session), partial(build, session), partial(made_for, session)
            self._sections.append(Section(tab, *own))
        gui.main_panel.dock_right()
        gui.main_panel.set_width(PANEL_PIXELS)

    def refresh(self, status: str, details: str) -> None:
        """Show what holds, one line about what was refused, and in every field what the model says."""
        refused = [text for key, text in self._session.refused.items() if not isinstance(key, BoundBox)]
        content = block_html(STYLE, status, self._legend(), *map(notice_html, refused))
        update_node(self._status, content=content)
        update_node(self._details, content=block_html(details))
        update_node(self._folder, visible=bool(details))
        for section in self._sections:
            section.refresh()

    def _legend(self) -> str:
        if self._session.colouring == "bending":
            return scale_html("straight", "bent as far as it can", COLOUR_SCALE)
        if self._session.colouring == "clearance":
            return scale_html("touches", "clear", (CONTACT, *COLOUR_SCALE))
        return ""


def _add_actions(gui: GuiApi, actions: Sequence[Action]) -> None:
    """Put actions into a row, and under their keys."""
    acts = {action.label: action.act for action in actions}
    row = gui.add_button_group("", tuple(acts))

    @row.on_click
    async def _(event: Any) -> None:
        acts[event.target.value](event.client)

    for action in actions:
        command = gui.add_command(action.label, hotkey=action.key, modifier=action.modifier)

        @command.on_trigger
        async def _(event: Any, act: Callable[[Any], object] = action.act) -> None:
            act(event.client)
