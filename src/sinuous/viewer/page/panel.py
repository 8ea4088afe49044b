"""The panel beside the scene: what holds of the shape, and tabs with everything that can be changed."""

from typing import TYPE_CHECKING, Any

from sinuous.viewer.drawing.colours import CLOSE, SCALE
from sinuous.viewer.page import (
    file_tab,
    motion_tab,
    obstacle_tab,
    robot_tab,
    shape_tab,
    solve_tab,
    target_tab,
    words,
)
from sinuous.viewer.page.fields import Section

if TYPE_CHECKING:
    from sinuous.viewer.page.page import Page

WIDTH = 440.0
"""Of the panel, in pixels: all tabs stand in one row."""


class Panel:
    """The panel of a page; `refresh` shows what the model says."""

    def __init__(self, page: "Page") -> None:
        self._page = page
        gui, model = page.server.gui, page.model
        self._status = gui.add_html("")
        tabs = gui.add_tab_group()
        sections: list[tuple[str, Any, Any]] = [
            ("Target", target_tab.build, lambda: (_asked(page), model.job.is_path)),
            ("Motion", motion_tab.build, lambda: model.job.is_path),
            ("Shape", shape_tab.build, lambda: (_sliders(page), page.first_segment)),
            ("Scene", obstacle_tab.build, lambda: None),
            ("Robot", robot_tab.build, lambda: model.robot.segment_names),
            ("Solve", solve_tab.build, lambda: None),
            ("File", file_tab.build, lambda: None),
        ]
        if not model.targets:
            del sections[0]
        self._sections = []
        for name, build, made_for in sections:
            tab = tabs.add_tab(name)
            self._sections.append(Section(page, tab, build, made_for))
            if name == "Scene":
                sizes = lambda: (model.grasped, *obstacle_tab.chosen_sizes(page))  # noqa: E731
                self._sections.append(Section(page, tab, obstacle_tab.build_sizes, sizes))
        gui.main_panel.dock_right()
        gui.main_panel.set_width(WIDTH)
        self.shows_nearest = True

    def refresh(self, status: str, notice: str) -> None:
        """Show what holds, one line about what was refused, and in every field what the model says."""
        content = words.framed(words.STYLE, status, self._legend(), notice)
        if self._status.content != content:
            self._status.content = content
        for section in self._sections:
            section.refresh()

    def _legend(self) -> str:
        colouring = self._page.scenery.colouring
        if colouring == "bending":
            return words.scale("straight", "bent as far as it can", SCALE)
        if colouring == "clearance":
            return words.scale("touches", "clear", (CLOSE, *SCALE))
        return ""


def _asked(page: "Page") -> object:
    return tuple((target.position is None, target.segment) for target in page.model.targets)


def _sliders(page: "Page") -> object:
    return tuple((segment.max_bend, segment.length) for segment in page.model.robot.segments)
