"""Axes with numbers along three edges of what is shown."""

import math

import numpy as np
from viser import SceneApi, SceneNodeHandle

from sinuous.display.bounds import Bounds
from sinuous.display.style import X, Y, Z, rgb

NUMBERS = 4
"""Numbers along the longest axis, about."""

TICK, WIDTH, NAME = 0.015, 0.0012, 0.06
"""Length of a tick, width of a line, and how far beyond its axis a name stands, in spans of the page."""

LETTERS = 0.6
"""Size of numbers, relative to that of other labels."""


def show_axes(scene: SceneApi, bounds: Bounds) -> SceneNodeHandle:
    """Draw axes from the lowest corner of the bounds; return the node that holds them."""
    root, span, low = scene.add_frame("/axes", show_axes=False), bounds.span, bounds.low
    for k, (name, colour) in enumerate(zip("xyz", (X, Y, Z), strict=True)):
        along, aside = np.eye(3)[k], TICK * span * np.eye(3)[1 if k == 0 else 0]
        numbers = round_numbers(low[k], bounds.high[k], span / NUMBERS)
        places = [low + (number - low[k]) * along for number in numbers]
        end = low + (bounds.high[k] - low[k]) * along
        lines = np.array([(low, end), *((place, place - aside) for place in places)])
        scene.add_line_segments(f"/axes/{name}", lines, rgb(colour), thickness=WIDTH * span)
        labels = [(f"{number:.6g}", place - 2.5 * aside) for number, place in zip(numbers, places, strict=True)]
        for i, (text, place) in enumerate([*labels, (name, end + NAME * span * along)]):
            at, size = f"/axes/{name}/{i}", LETTERS if i < len(labels) else 1.0
            scene.add_label(at, text, position=place, font_screen_scale=size, anchor="center-center", depth_test=True)
    return root


def round_numbers(low: float, high: float, apart: float) -> list[float]:
    """Multiples of 1, 2 or 5 times a power of ten that is about `apart`, from low to high."""
    unit = 10.0 ** math.floor(math.log10(apart))
    step = next(size * unit for size in (1.0, 2.0, 5.0, 10.0) if size * unit >= 0.999 * apart)
    return [i * step for i in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]
