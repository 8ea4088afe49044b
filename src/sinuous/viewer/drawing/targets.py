"""Targets, paths and routes on a page."""

from collections.abc import Sequence

import numpy as np
from viser import SceneApi

from sinuous.checks import Floats
from sinuous.pictures.style import TARGET, X, Y, Z
from sinuous.problem.target import Target
from sinuous.viewer.drawing.colours import rgb

DOT, ARROW = 0.011, 0.13
"""Radius of the point and length of the arrow of a target, in spans of the picture."""


def show_target(scene: SceneApi, name: str, target: Target, place: Floats, span: float) -> None:
    """Draw a point at `place` (3,), an arrow where a direction is asked, three where a whole rotation is."""
    scene.add_icosphere(name, DOT * span, color=rgb(TARGET), position=place, cast_shadow=False, receive_shadow=False)
    arrows, colours = [], []
    if target.direction is not None:
        arrows, colours = [target.direction], [TARGET]
    elif target.rotation is not None:
        arrows, colours = list(target.rotation.T), [X, Y, Z]
    if arrows:
        ends = np.stack([np.zeros((len(arrows), 3)), ARROW * span * np.stack(arrows)], axis=1)
        shades = np.array([rgb(colour) for colour in colours], np.uint8)
        thin, wide, long = 0.003 * span, 0.008 * span, 0.025 * span
        scene.add_arrows(f"{name}/arrow", ends, shades, shaft_radius=thin, head_radius=wide, head_length=long)


def show_line(scene: SceneApi, name: str, points: Floats | Sequence[Floats], colour: str, width: float = 3.0) -> None:
    """Draw a line through points (k, 3)."""
    places = np.asarray(points, np.float64)
    pieces = np.stack([places[:-1], places[1:]], axis=1)
    scene.add_line_segments(name, pieces, rgb(colour), thickness=width)
