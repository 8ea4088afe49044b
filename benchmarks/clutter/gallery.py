"""A picture of the places that `clutter` measures, solved: `python -m benchmarks.clutter.gallery FILE`."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from benchmarks.harness.command import command
from benchmarks.pictures.style import INK
from benchmarks.places import make
from sinuous.answer.solution import Solution
from sinuous.cli.options import check_writable
from sinuous.solver.solver import Solver
from sinuous.view.display.bounds import best_view
from sinuous.view.display.captions import caption
from sinuous.view.display.contents import gather
from sinuous.view.pictures.files import check_picture
from sinuous.view.pictures.plot import draw_contents
from sinuous.view.pictures.space import axes_box, fill, new_figure

SHOWN = {
    "spheres 40": 6,
    "pipe 1.3": 1,
    "plates": 16,
    "drum": 1,
    "shelf": 1,
    "duct": 1,
    "spheres 40 scan": 6,
    "pipe 1.6 scan": 7,
    "plates scan": 1,
    "drum scan": 1,
    "shelf scan": 1,
    "duct scan": 1,
}
"""Families, and the seed of the place that stands for each."""

COLUMNS = 4


def solved(family: str, seed: int) -> Solution:
    """Solve one place as a user would; the second time, so that the time is that of a solve and not of loading."""
    place = make(family, seed)
    solver = Solver(place.robot, place.scene, tolerance=place.tolerance)
    solver.solve(place.targets)
    return solver.solve(place.targets)


def draw(file: Path, shown: dict[str, int] = SHOWN) -> None:
    """Draw one panel for each family that is shown.

    Raises
    ------
    InputError
        When Matplotlib is missing, or does not know the kind of file.
    """
    check_picture("FILE", file)
    rows, panels = -(-len(shown) // COLUMNS), []
    figure = new_figure(figsize=(4.2 * COLUMNS, 4.2 * rows), dpi=80, layout="constrained")
    for i, (family, seed) in enumerate(shown.items()):
        axes = figure.add_subplot(rows, COLUMNS, i + 1, projection="3d", computed_zorder=False)
        contents = gather([solved(family, seed)])
        box = axes_box(contents)
        draw_contents(axes, contents, box, best_view(contents))
        axes.set_axis_off()
        panels.append((axes, box))
        axes.set_title(f"{family}\n{caption(contents.answers)}", fontsize=10, color=INK)
    figure.canvas.draw()  # puts the panels in their places
    figure.set_layout_engine("none")
    for axes, box in panels:
        fill(axes, box)
    figure.savefig(file)


def run(file: Annotated[Path, typer.Argument(metavar="FILE", help="Picture to write, like places.png.")]) -> None:
    """Draw one place of each kind, solved."""
    check_writable("FILE", file)
    draw(file)


main = command(run, "benchmarks.clutter.gallery")


if __name__ == "__main__":
    sys.exit(main())
