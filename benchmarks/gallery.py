"""`python -m benchmarks places`: places that `clutter` measures, solved again or drawn."""

from pathlib import Path
from typing import Annotated

import typer

import sinuous as sn
from benchmarks.clutter import examine
from benchmarks.harness.parallel import ignore_suspicions
from benchmarks.places import FAMILIES, make
from sinuous.base import checks
from sinuous.cli.options import check_writable
from sinuous.view.display.bounds import best_view
from sinuous.view.display.contents import gather
from sinuous.view.display.results import caption_of
from sinuous.view.pictures.figures import axes_box, check_picture, fill_room, new_figure
from sinuous.view.pictures.plot import draw_contents

SHOWN = {
    **{"spheres 40": 6, "pipe 1.3": 1, "plates": 16, "drum": 1, "shelf": 1, "duct": 1},
    **{"spheres 40 scan": 6, "pipe 1.6 scan": 7, "plates scan": 1, "drum scan": 1, "shelf scan": 1, "duct scan": 1},
}
"""Families of the picture of all, and the number of the place that stands for each."""

COLUMNS = 4


def solved(family: str, number: int) -> sn.Solution:
    """Solve one place as a user would; the second time, so that the time is that of a solve and not of loading."""
    place = make(family, number)
    solver = sn.Solver(place.robot, place.scene, tolerance=place.tolerance)
    solver.solve(place.targets)
    return solver.solve(place.targets)


def draw(file: Path, shown: dict[str, int]) -> None:
    """Draw one panel for each place."""
    rows, panels = -(-len(shown) // COLUMNS), []
    figure = new_figure(figsize=(4.2 * min(COLUMNS, len(shown)), 4.2 * rows), dpi=80, layout="constrained")
    for i, (family, number) in enumerate(shown.items(), 1):
        axes = figure.add_subplot(rows, min(COLUMNS, len(shown)), i, projection="3d", computed_zorder=False)
        contents = gather([solved(family, number)])
        panels.append((axes, axes_box(contents)))
        draw_contents(axes, contents, panels[-1][1], best_view(contents))
        axes.set_axis_off()
        axes.set_title(f"{family}\n{caption_of(contents.answers)}", fontsize=10)
    figure.canvas.draw()  # puts the panels in their places
    figure.set_layout_engine("none")
    for axes, box in panels:
        fill_room(axes, box)
    figure.savefig(file)


def run(
    family: Annotated[str | None, typer.Argument(metavar="FAMILY", help="Like 'pipe 1.3'.")] = None,
    number: Annotated[int, typer.Argument(metavar="NUMBER", help="The seed that a run says.")] = 0,
    picture: Annotated[Path | None, typer.Option(metavar="FILE", help="Draw it: place.png.")] = None,
) -> None:
    """Solve one place again and judge it, or, without a family, draw one place of each kind.

    The exit code is 1 when the place is not solved.
    """
    if picture is not None:
        check_writable("--picture", picture)
        check_picture("--picture", picture)
    if family is not None:
        checks.choice("FAMILY", family, tuple(FAMILIES))
        checks.integer("NUMBER", number, 0, 2**31 - 1)
    ignore_suspicions()
    if picture is not None:
        draw(picture, SHOWN if family is None else {family: number})
    if family is not None:
        ours = examine(family, number)
        verdict = "right" if ours.right else "WRONG" if ours.false else "not right"
        won = f" by {ours.start}" * ours.solved
        typer.echo(
            f"{family}, {number}: {ours.status}{won} in {1e3 * ours.seconds:.3g} ms; the judge finds it {verdict}"
        )
        raise typer.Exit(0 if ours.solved else 1)
