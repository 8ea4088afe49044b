"""On which side of the obstacles a body passes."""

from dataclasses import dataclass
from typing import Any

from sinuous.base import checks
from sinuous.base.documents import result_of
from sinuous.base.errors import InputError, listed, number

SIDES = ("-x", "+x", "-y", "+y", "-z", "+z")
"""Along which axis of the world a body lies, as seen from what it passes."""


SAID = 4
"""Most obstacles that are named in a sentence."""


@dataclass(frozen=True)
class Passing:
    """An obstacle that a body passes.

    Attributes
    ----------
    obstacle : str
        Its name.
    side : str or None
        On which of `SIDES` the body is, where it is nearest; `None` where the obstacle is on most sides of it: the body
        goes through.
    at : tuple of float (3,)
        Where it is nearest.
    """

    obstacle: str
    side: str | None
    at: tuple[float, float, float]

    def __str__(self) -> str:
        if self.side is not None:
            return f"past {self.obstacle} on its {self.side} side"
        return f"through {self.obstacle} at {number(self.at, 3)}"


@dataclass(frozen=True)
class RouteClass:
    """A class of solutions: bodies that were found to deform into each other and stay clear.

    Attributes
    ----------
    number : int
        1 for that of the best solution, and so on.
    passes : tuple of Passing
        The obstacles that stand between this class and others that were found; empty where it is the only one.
    """

    number: int
    passes: tuple[Passing, ...]

    def __str__(self) -> str:
        more = [f"{len(self.passes) - SAID} more"] if len(self.passes) > SAID else []
        words = [*map(str, self.passes[:SAID]), *more]
        return f"class {self.number}: {listed(words) if words else 'the only one found'}"

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values, in the order of the file format."""
        return result_of(self, "number passes")

    @classmethod
    def from_dict(cls, values: Any) -> "RouteClass":
        """Make it of plain values.

        Raises
        ------
        InputError
            That names the key.
        """
        read = _mapping(values, ("number", "passes"))
        passes = read["passes"]
        checks.instance("passes", passes, list, "a list")
        found = []
        for i, each in enumerate(passes):
            with checks.inside(f"passes[{i}]"):
                found.append(_passing(each))
        return cls(checks.integer("number", read["number"], 1, 2**62), tuple(found))


def _passing(values: Any) -> Passing:
    read = _mapping(values, ("obstacle", "side", "at"))
    side = None if read["side"] is None else checks.choice("side", read["side"], SIDES)
    x, y, z = checks.array("at", read["at"], (3,)).tolist()
    return Passing(checks.text("obstacle", read["obstacle"]), side, (x, y, z))


def _mapping(values: Any, keys: tuple[str, ...]) -> dict[str, Any]:
    if not isinstance(values, dict) or not set(keys) <= set(values):
        raise InputError("", "", values, "a mapping with " + ", ".join(keys))
    return values
