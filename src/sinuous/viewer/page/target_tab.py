"""The tab of targets: what is asked, and other solutions to choose from."""

from typing import TYPE_CHECKING

import numpy as np
from viser import GuiApi

from sinuous.checks import Floats
from sinuous.viewer.model.model import ASKED
from sinuous.viewer.page.fields import Fields, step_of

if TYPE_CHECKING:
    from sinuous.viewer.page.page import Page

MOST = 6
"""Targets with fields."""

ASKED_HINT = "What must be met: the position alone, or the direction of the tangent, or a whole rotation too."

COUNT = 6
"""Other solutions that are looked for."""


def build(gui: GuiApi, page: "Page", fields: Fields) -> None:
    """Put the fields into the panel."""
    model = page.model
    if model.job.is_path:
        count = len(model.job.waypoints)
        number = gui.add_slider("waypoint", 1, max(2, count), 1, model.waypoint + 1)
        act = lambda value: page.do("waypoint", lambda: model.go_to_waypoint(min(value, count) - 1))  # noqa: E731
        fields.bind(number, lambda: model.waypoint + 1, act)
    for i in range(min(MOST, len(model.targets))):
        _build_target(gui, page, fields, i)
    found = gui.add_dropdown("solution", _names(page), hint="Distinct solutions, best first; all are on the page.")
    look = gui.add_button("Find other solutions", color="gray")
    fields.press(look, lambda _: page.find_others(COUNT))
    forget = gui.add_button("Forget them", color="gray")
    fields.press(forget, lambda _: page.do("others", page.forget_others))

    def refresh() -> str:
        names = _names(page)
        if tuple(found.options) != names:
            found.options = names
        forget.visible = found.visible = bool(model.ghosts)
        shown = next((i for i, ghost in enumerate(model.ghosts) if ghost is model.answer), None)
        return names[0] if shown is None else names[shown + 1]

    def choose(name: str) -> None:
        names = _names(page)
        if name in names[1:]:
            page.do("solution", lambda: model.choose(names.index(name) - 1))

    fields.bind(found, refresh, choose)


def _names(page: "Page") -> tuple[str, ...]:
    return ("-", *(f"{i}: bends {_bends(each.q):.2f} rad in all" for i, each in enumerate(page.model.ghosts, 1)))


def _bends(q: Floats) -> float:
    return float(np.hypot(q[:, 0], q[:, 1]).sum())


def _build_target(gui: GuiApi, page: "Page", fields: Fields, i: int) -> None:
    model = page.model
    target = model.targets[i]
    whose = "" if len(model.targets) == 1 else f" {i + 1}"
    if target.segment is not None and target.segment < len(model.robot):
        whose += f" of {model.robot.segment_names[target.segment - 1]}"
    if target.position is not None:
        place = gui.add_vector3(
            f"target{whose}", tuple(target.position.tolist()), step=step_of(model.robot.mean_length)
        )
        fields.bind(
            place,
            lambda: tuple(model.target_frame(i)[:3, 3].tolist()),
            lambda value: page.do(("target", i), lambda: model.place_target(i, value)),
        )
    asked = gui.add_dropdown(f"asked{whose}", ASKED, hint=ASKED_HINT)
    fields.bind(asked, lambda: _what(page, i), lambda value: page.do(("asked", i), lambda: model.ask(i, value)))


def _what(page: "Page", i: int) -> str:
    target = page.model.targets[min(i, len(page.model.targets) - 1)]
    return "direction" if target.direction is not None else "rotation" if target.rotation is not None else "position"
