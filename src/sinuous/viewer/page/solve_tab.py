"""The tab of solving: methods, seed, budget and tolerances."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from viser import GuiApi

from sinuous.methods.registry import METHODS
from sinuous.problem.target import Tolerance
from sinuous.viewer.model.model import MOST_SECONDS
from sinuous.viewer.page.fields import Fields, step_of

if TYPE_CHECKING:
    from sinuous.viewer.page.page import Page

NONE = "none"


def build(gui: GuiApi, page: "Page", fields: Fields) -> None:
    """Put the fields into the panel."""
    model = page.model

    def put(**values: Any) -> None:
        page.do("method", lambda: model.set_method(**vars(replace(model.settings, **values))))

    names = tuple(METHODS)
    fields.bind(gui.add_dropdown("method", names), lambda: model.settings.method, lambda value: put(method=value))
    beside = gui.add_dropdown("beside it", (NONE, *names), hint="A second method, shown beside the first.")
    fields.bind(
        beside, lambda: model.settings.beside or NONE, lambda value: put(beside=None if value == NONE else value)
    )
    seed = gui.add_number("seed", 0, min=0, max=2**31 - 1, step=1)
    fields.bind(seed, lambda: model.settings.seed, lambda value: put(seed=int(value)))
    seconds = gui.add_number("time, s", 1.0, min=0.001, max=MOST_SECONDS, step=0.001)
    fields.bind(seconds, lambda: model.settings.time, lambda value: put(time=value))

    def tolerance() -> Tolerance:
        return model.job.tolerance.for_robot(model.robot)

    step = step_of(0.01 * model.robot.mean_length)
    off = gui.add_number("tolerance", tolerance().position or 0.0, step=step, hint="Of the position.")
    fields.bind(
        off,
        lambda: tolerance().position,
        lambda value: page.do("tolerance", lambda: model.tolerate(value, tolerance().angle)),
    )
    angle = gui.add_number("tolerance, rad", tolerance().angle, step=1e-4, hint="Of directions and rotations.")
    fields.bind(
        angle,
        lambda: tolerance().angle,
        lambda value: page.do("tolerance", lambda: model.tolerate(tolerance().position or 0.0, value)),
    )
