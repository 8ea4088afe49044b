"""The tab of the robot: limits and radius of one segment or of all."""

import math
from typing import TYPE_CHECKING

from viser import GuiApi

from sinuous.robot.segment import Segment
from sinuous.viewer.page.fields import Fields, step_of

if TYPE_CHECKING:
    from sinuous.viewer.page.page import Page

ALL = "all"


def build(gui: GuiApi, page: "Page", fields: Fields) -> None:
    """Put the fields into the panel."""
    model = page.model
    names = (ALL, *model.robot.segment_names)
    which = gui.add_dropdown("segment", names, hint="Of which limits are changed; of all, the first one's are shown.")

    def index() -> int | None:
        return None if which.value == ALL else names.index(which.value) - 1

    def segment() -> Segment:
        return model.robot.segments[index() or 0]

    def low(value: float) -> None:
        k = index()
        page.do("limit", lambda: model.limit(k, length=(value, segment().length[1])))

    def high(value: float) -> None:
        k = index()
        page.do("limit", lambda: model.limit(k, length=(segment().length[0], value)))

    def bend(value: float) -> None:
        k = index()
        page.do("limit", lambda: model.limit(k, max_bend=value))

    def curvature(value: float) -> None:
        k = index()
        page.do("limit", lambda: model.limit(k, max_curvature=value or None))

    def radius(value: float) -> None:
        k = index()
        page.do("limit", lambda: model.limit(k, radius=value))

    fields.bind(which, lambda: which.value, lambda _: page.do("segment", lambda: None))
    step = step_of(model.robot.mean_length)
    fields.bind(gui.add_number("least length", 0.0, min=0.0, step=step), lambda: segment().length[0], low)
    fields.bind(gui.add_number("greatest length", 0.0, min=0.0, step=step), lambda: segment().length[1], high)
    fields.bind(gui.add_number("max_bend, rad", 0.0, min=0.0, step=0.01), lambda: segment().max_bend, bend)
    hint = "Largest bend divided by length; 0: no limit of its own."
    curved = gui.add_number("max_curvature", 0.0, min=0.0, step=1e-6, hint=hint)
    fields.bind(curved, lambda: segment().max_curvature if math.isfinite(segment().max_curvature) else 0.0, curvature)
    fields.bind(gui.add_number("radius", 0.0, min=0.0, step=step), lambda: segment().radius, radius)
