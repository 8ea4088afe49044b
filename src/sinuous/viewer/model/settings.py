"""How the page solves."""

from dataclasses import dataclass

from sinuous.arguments import MethodName
from sinuous.solving.options import TIME


@dataclass
class Settings:
    """How the page solves.

    Attributes
    ----------
    method : str
    beside : str or None
        A second method, whose answer stands beside that of the first.
    seed : int
    time : float
        Budget in seconds, when nothing is dragged.
    """

    method: MethodName = "newton"
    beside: MethodName | None = None
    seed: int = 0
    time: float = TIME
