"""A picture of a design: the robots that no other is better than."""

from pathlib import Path

from sinuous.designing.design import Design
from sinuous.display.style import CURVES
from sinuous.errors import InputError
from sinuous.pictures.diagrams import tidy
from sinuous.pictures.files import check_picture, save_figure, stills
from sinuous.pictures.space import new_figure

MOST_LABELS = 12
"""Robots of the front whose fields are written beside them."""


def plot_design(found: Design, file: str | Path) -> None:
    """Draw the front: two objectives against each other, or one for each robot.

    Parameters
    ----------
    found : Design
    file : path
        Its ending says which kind of picture.

    Raises
    ------
    InputError
        When no robot was found, Matplotlib is missing or does not know the kind of file, or it cannot be written.
    """
    check_picture("file", Path(file), stills())
    if not found.front:
        raise InputError("found", "no robot does all tasks", str(found), "a design with a robot")
    figure = new_figure(figsize=(7.0, 5.0), dpi=110, layout="constrained")
    axes = figure.subplots()
    first, *others = found.minimise
    x = [each.objectives[first] for each in found.front]
    y = [each.objectives[others[0]] if others else 0.0 for each in found.front]
    axes.step(x, y, where="post", color=CURVES[1], linewidth=1.0)
    axes.plot(x, y, "o", color=CURVES[0])
    for each, place in list(zip(found.front, zip(x, y, strict=True), strict=True))[:MOST_LABELS]:
        said = ", ".join(f"{value:.3g}" if isinstance(value, float) else str(value) for value in each.values.values())
        axes.annotate(f" {said}", place, fontsize=8)
    tidy(axes, ", ".join(found.front[0].values), x=first, y=others[0] if others else "")
    save_figure(figure, Path(file))
