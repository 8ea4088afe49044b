"""Pictures, and pages in the browser, of robots, scenes and answers."""

from sinuous.base.entrance import entrance

__getattr__, __dir__, __all__ = entrance(
    __name__,
    {
        "sinuous.view.pictures.plot": "animate",
        "sinuous.view.pictures.diagrams": "diagram plot_assessment plot_calibration plot_design",
        "sinuous.view.pictures.workspace": "plot_reach",
    },
)
