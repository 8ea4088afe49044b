"""A picture of the places that `clutter` measures, solved: `python -m benchmarks.clutter.gallery FILE`."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from benchmarks.places import make
from sinuous.cli.app import execute
from sinuous.cli.options import check_writable
from sinuous.pictures.plot import check_picture, draw_shape
from sinuous.solution.solution import Solution
from sinuous.solving.solver import Solver

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
ZOOM = 1.2


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
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415
    from matplotlib.figure import Figure  # noqa: PLC0415

    rows = -(-len(shown) // COLUMNS)
    figure = Figure(figsize=(4.2 * COLUMNS, 4.2 * rows), dpi=80, layout="constrained")
    FigureCanvasAgg(figure)
    for i, (family, seed) in enumerate(shown.items()):
        axes = figure.add_subplot(rows, COLUMNS, i + 1, projection="3d", computed_zorder=False)
        solution = solved(family, seed)
        draw_shape(axes, (solution,))
        axes.set_axis_off()
        axes.set_box_aspect(
            [np.ptp(limits) for limits in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())], zoom=ZOOM
        )
        axes.set_title(f"{family}\n{axes.get_title()}", fontsize=10, color="#333333")
    figure.savefig(file)


app = typer.Typer(add_completion=False, rich_markup_mode=None)


@app.command()
def run(file: Annotated[Path, typer.Argument(metavar="FILE", help="Picture to write, like places.png.")]) -> None:
    """Draw one place of each kind, solved."""
    check_writable("FILE", file)
    draw(file)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code.

    Parameters
    ----------
    arguments : sequence of str, optional
        Default: those of the process.
    """
    return execute(app, "python -m benchmarks.clutter.gallery", arguments)


if __name__ == "__main__":
    sys.exit(main())
