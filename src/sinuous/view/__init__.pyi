"""The names of `__init__.py` for type checkers."""

from sinuous.view.pictures.diagrams import diagram as diagram
from sinuous.view.pictures.diagrams import plot_assessment as plot_assessment
from sinuous.view.pictures.diagrams import plot_calibration as plot_calibration
from sinuous.view.pictures.diagrams import plot_design as plot_design
from sinuous.view.pictures.plot import animate as animate
from sinuous.view.pictures.workspace import plot_reach as plot_reach

__all__: list[str]
