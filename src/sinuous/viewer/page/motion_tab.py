"""The tab of motion: follow the path or plan to the goal, and look at every moment of it, and of what moves."""

from typing import TYPE_CHECKING

from viser import GuiApi

from sinuous.viewer.page.fields import Fields

if TYPE_CHECKING:
    from sinuous.viewer.page.page import Page


def build(gui: GuiApi, page: "Page", fields: Fields) -> None:
    """Put the fields into the panel."""
    model = page.model
    if not model.job.is_path:
        here = gui.add_button("Start here", color="gray", hint="Motions begin in the shape on the page.")
        fields.press(here, lambda _: page.do("start", model.begin_here))
    found = gui.add_button("Follow the path" if model.job.is_path else "Plan a motion")
    fields.press(found, lambda _: page.move())
    share = gui.add_slider("moment, %", 0.0, 100.0, 0.1, 0.0)

    def moment() -> float:
        first, last = model.window
        if first == last:
            return 0.0
        return float(min(100.0, max(0.0, 100.0 * (model.time - first) / (last - first))))

    def play(value: float) -> None:
        page.do("time", lambda: page.go_to(0.01 * value))

    fields.bind(share, moment, play)
    run = gui.add_checkbox("play", False)
    fields.bind(run, lambda: page.playing, page.play)
