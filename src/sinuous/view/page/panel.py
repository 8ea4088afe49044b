"""The panel beside the scene: what holds of the shape, and tabs with everything that can be changed."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

from viser import GuiApi

from sinuous.view.display.style import CONTACT, SCALE
from sinuous.view.page import tabs
from sinuous.view.page.fields import Fields
from sinuous.view.page.session import Session
from sinuous.view.page.status import STYLE, framed, scale

WIDTH = 440.0
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


class Panel:
    """The panel of a page; `actions` are its first row."""

    def __init__(self, gui: GuiApi, session: Session, actions: Sequence[Action]) -> None:
        self._session = session
        _add_actions(gui, actions)
        self._status = gui.add_html("")
        group = gui.add_tab_group()
        self._sections, places = [], dict[str, Any]()
        for name, build, made_for in (part for part in PARTS if part[0] != "Target" or session.model.targets):
            tab = places[name] = places.get(name) or group.add_tab(name)
            own = Fields(gui, session), partial(build, session), partial(made_for, session)
            self._sections.append(Section(tab, *own))
        gui.main_panel.dock_right()
        gui.main_panel.set_width(WIDTH)

    def refresh(self, status: str, notice: str) -> None:
        """Show what holds, one line about what was refused, and in every field what the model says."""
        content = framed(STYLE, status, self._legend(), notice)
        if self._status.content != content:
            self._status.content = content
        for section in self._sections:
            section.refresh()

    def _legend(self) -> str:
        if self._session.colouring == "bending":
            return scale("straight", "bent as far as it can", SCALE)
        if self._session.colouring == "clearance":
            return scale("touches", "clear", (CONTACT, *SCALE))
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


def _asked(session: Session) -> object:
    asked = ((t.position is None, t.direction is None, t.rotation is None, t.segment) for t in session.model.targets)
    return session.model.job.is_path, *asked


def _limits(session: Session) -> object:
    robot = session.model.robot
    limits = tuple((segment.max_bend, segment.length) for segment in robot.segments)
    return limits, robot.actuators, session.first_segment, session.sliders


def _plot(session: Session) -> object:
    return session.model.motion, session.plotted, session.model.job.rates or None


PARTS: list[tuple[str, Callable[[Session, Fields], None], Callable[[Session], object]]] = [
    ("Target", tabs.target_tab, _asked),
    ("Target", tabs.remedy_fields, lambda own: (own.unsolved, own.explaining, own.model.explanation)),
    ("Motion", tabs.motion_tab, lambda own: own.model.job.is_path),
    ("Motion", tabs.plot_fields, _plot),
    ("Shape", tabs.shape_tab, _limits),
    ("Scene", tabs.scene_tab, lambda own: None),
    ("Scene", tabs.size_fields, lambda own: (own.model.grasped, *tabs.chosen_sizes(own))),
    ("Robot", tabs.robot_tab, lambda own: own.model.robot.segment_names),
    ("Solve", tabs.solve_tab, lambda own: None),
    ("File", tabs.file_tab, lambda own: None),
]
"""What stands below each other in the tabs, and what it is made for."""
