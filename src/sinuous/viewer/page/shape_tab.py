"""The tab of the shape: what its colours mean, and sliders for every segment."""

import math
from functools import partial
from typing import TYPE_CHECKING, get_args

import numpy as np
from viser import GuiApi

from sinuous.robot.segment import Segment
from sinuous.viewer.drawing.colours import Colouring
from sinuous.viewer.page.fields import Fields, step_of

if TYPE_CHECKING:
    from sinuous.viewer.page.page import Page

AT_ONCE = 8
"""Segments with sliders at one time; of more, a field says which."""

COORDINATES = ("bend_x", "bend_y", "length")


def build(gui: GuiApi, page: "Page", fields: Fields) -> None:
    """Put the fields into the panel."""
    model = page.model
    colour = gui.add_dropdown("colours say", get_args(Colouring))
    fields.bind(colour, lambda: page.scenery.colouring, page.colour)
    again = gui.add_button("Solve from here", color="gray", hint="Ask for the target again, from this shape.")
    fields.press(again, lambda _: page.do("again", model.solve_from_here))
    count = len(model.robot)
    if count > AT_ONCE:
        first = gui.add_slider("from segment", 1, count - AT_ONCE + 1, 1, page.first_segment + 1)
        fields.bind(first, lambda: page.first_segment + 1, lambda value: page.show_segments(value - 1))
    for k in range(page.first_segment, min(count, page.first_segment + AT_ONCE)):
        _build_segment(gui, page, fields, k)


def _build_segment(gui: GuiApi, page: "Page", fields: Fields, k: int) -> None:
    model = page.model
    segment, name = model.robot.segments[k], model.robot.segment_names[k]

    def changed(coordinate: int, value: float) -> None:
        def bend() -> None:
            row = model.shown[k].tolist()
            row[coordinate] = value
            model.bend(k, *row)

        page.do(("bend", k, coordinate), bend)

    for c, (low, high) in enumerate(_ranges(segment)):
        if low < high:
            now = partial(_within, page, k, c, (low, high))
            slider = gui.add_slider(f"{name} {COORDINATES[c]}", low, high, step_of(high - low), now())
            fields.bind(slider, now, partial(changed, c))


def _within(page: "Page", k: int, c: int, ends: tuple[float, float]) -> float:
    """A coordinate of the shape, as the slider shows it: rounded to its steps, and within its ends."""
    digits = round(-math.log10(step_of(ends[1] - ends[0])))
    return float(np.clip(round(float(page.model.shown[k, c]), digits), *ends))


def _ranges(segment: Segment) -> list[tuple[float, float]]:
    """What the sliders of a segment go from and to."""
    bend = (-segment.max_bend, segment.max_bend)
    return [bend, bend, segment.length]
