"""How all pictures look: colours that the colour-blind can tell apart (Okabe & Ito 2008), pale grids, few ticks."""

from typing import Any, NamedTuple

from sinuous.arguments import Number

INK, PALE, LINE, GRID = "#2f343a", "#6b7178", "#b4bac1", "#e7eaed"
OBSTACLE, DOTS, METAL = "#b9c1cb", "#98a1ac", "#4a5058"
TARGET, PATH, ROUTE, TIP_PATH = "#d55e00", "#f0b48c", "#009e73", "#d55e00"
X, Y, Z = "#d55e00", "#009e73", "#0072b2"

UNSOLVED = ("#e69f00", "#f3cf80")
"""Two tones of a robot that did not get where it should."""

ARMS = (
    ("#0072b2", "#56b4e9"),
    ("#b0568c", "#dca6c6"),
    ("#00805d", "#67c7a8"),
    ("#5c5c5c", "#a6a6a6"),
    ("#a08600", "#e3d045"),
)
"""Two tones of each robot, for its segments in turn; the first is the only one of most pictures."""

CURVES = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#7a7a7a", "#b3a300")
"""Colours of curves, in turn."""

SMALL, TEXT, TITLE = 8.0, 9.5, 11.0
"""Sizes of letters, in points."""


class View(NamedTuple):
    """Where a picture is looked at from, in degrees.

    Attributes
    ----------
    elevation : float
        Above the xy plane.
    azimuth : float
        About z, from x.
    """

    elevation: Number = 30.0
    azimuth: Number = -60.0


def tidy(axes: Any, title: str, *, x: str, y: str) -> None:
    """Give the axes of a diagram the look of the house, a title, and labels with units."""
    axes.set_title(title, fontsize=TITLE, color=INK, loc="left")
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color(LINE)
    axes.tick_params(which="both", color=LINE, labelcolor=PALE, labelsize=SMALL)
    axes.set_xlabel(x, color=PALE, fontsize=TEXT)
    axes.set_ylabel(y, color=PALE, fontsize=TEXT)
    axes.grid(visible=True, color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)


def tidy_space(axes: Any) -> None:
    """Give axes in space the look of the house."""
    axes.computed_zorder = False
    for axis, label in ((axes.xaxis, "x"), (axes.yaxis, "y"), (axes.zaxis, "z")):
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
        axis.line.set_color(LINE)
        axis._axinfo["grid"].update(color=GRID, linewidth=0.7)
        axis._axinfo["tick"].update(inward_factor=0.0, outward_factor=0.1)
        axis.set_label_text(label, color=PALE, fontsize=TEXT)
        axis.set_tick_params(labelsize=SMALL, labelcolor=PALE, color=LINE, pad=1.0)
        axis.labelpad = 2.0
