"""A picture of an assessment: robots side by side."""

from pathlib import Path

import numpy as np

from sinuous.assessing.assessment import Assessment
from sinuous.display.style import CURVES, UNSOLVED
from sinuous.pictures.diagrams import tidy
from sinuous.pictures.files import check_picture, save_figure, stills
from sinuous.pictures.space import new_figure


def plot_assessment(found: Assessment, file: str | Path) -> None:
    """Draw for every robot how much is done, how clear, and how long it takes.

    Parameters
    ----------
    found : Assessment
    file : path
        Its ending says which kind of picture.

    Raises
    ------
    InputError
        When Matplotlib is missing or does not know the kind of file, or it cannot be written.
    """
    check_picture("file", Path(file), stills())
    totals = found.totals
    names, places = [total.robot for total in totals], np.arange(len(totals))
    figure = new_figure(figsize=(13.0, 1.6 + 0.32 * len(totals)), dpi=110, layout="constrained")
    done, clear, time = figure.subplots(1, 3, sharey=True)
    done.barh(places, [100.0 * total.done / total.tasks for total in totals], color=CURVES[0])
    done.plot([100.0 * total.share for total in totals], places, "o", color=CURVES[1])
    done.set(xlim=(0.0, 105.0))
    done.set_yticks(places, names)
    done.invert_yaxis()
    clear.barh(places, [total.clearance or 0.0 for total in totals], color=CURVES[0])
    time.barh(places, [1e3 * total.seconds for total in totals], color=CURVES[0])
    for place, total in zip(places.tolist(), totals, strict=True):
        if total.binds is not None:
            time.annotate(f" {total.binds}", (0.0, place), va="center", color=UNSOLVED[0], fontsize=8)
    tidy(done, "tasks done (dots: targets met)", x="%", y="")
    tidy(clear, "least proved clearance", x="length unit", y="")
    tidy(time, "longest time to compute, and what limits the robot", x="ms", y="")
    save_figure(figure, Path(file))
