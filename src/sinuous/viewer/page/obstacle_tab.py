"""The tab of obstacles: choose, add, delete, resize; the chosen one has a gizmo."""

from functools import partial
from typing import TYPE_CHECKING

from viser import GuiApi

from sinuous.viewer.model.edits import KINDS, sizes_of
from sinuous.viewer.page.fields import Fields, step_of

if TYPE_CHECKING:
    from sinuous.viewer.page.page import Page

NONE = "none"


def build(gui: GuiApi, page: "Page", fields: Fields) -> None:
    """Put the fields into the panel."""
    model = page.model
    names = _names(page)
    chosen = gui.add_dropdown("obstacle", names, hint="Or click on one. The chosen one can be dragged.")

    def shown() -> str:
        now = _names(page)
        if tuple(chosen.options) != now:
            chosen.options = now
        return now[0] if model.grasped is None else now[model.grasped + 1]

    def choose(name: str) -> None:
        own = _names(page)
        page.do("grasp", lambda: model.grasp(own.index(name) - 1 if name in own[1:] else None))

    fields.bind(chosen, shown, choose)
    delete = gui.add_button("Delete it", color="gray")
    fields.press(delete, lambda _: page.do("delete", model.delete))
    kind = gui.add_dropdown("kind", KINDS)
    add = gui.add_button("Add one", color="gray")
    fields.press(add, lambda _: page.do("add", lambda: model.add(kind.value)))


def _names(page: "Page") -> tuple[str, ...]:
    scene = page.model.scene
    return (NONE, *(scene.name(i) for i in range(len(scene))))


def build_sizes(gui: GuiApi, page: "Page", fields: Fields) -> None:
    """Put fields for the lengths of the chosen obstacle into the panel."""
    for label, value in chosen_sizes(page).items():
        field = gui.add_number(label, value, min=0.0, step=step_of(page.model.robot.mean_length))
        fields.bind(field, partial(_size, page, label), partial(_resize, page, label.replace(" ", "_")))


def _size(page: "Page", label: str) -> float:
    return chosen_sizes(page).get(label, 0.0)


def _resize(page: "Page", key: str, value: float) -> None:
    page.do(("size", key), lambda: page.model.resize(**{key: value}))


def chosen_sizes(page: "Page") -> dict[str, float]:
    """Lengths of the chosen obstacle that can be changed."""
    return {} if page.model.chosen is None else sizes_of(page.model.chosen)
