"""Algorithms for inverse kinematics, one file each, all called the same way.

A method is prepared once for a robot, a scene and tolerances; `run` then tries a range of starts on one table of
targets and returns the best that it found.
"""

from typing import TYPE_CHECKING, Protocol

from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.solution import Outcome

if TYPE_CHECKING:
    from sinuous.problem import Preferences, Tolerance
    from sinuous.robot import Robot
    from sinuous.scene.scene import Scene


SOLVED, UNPROVED, FAILED, LATE, OUT_OF_REACH, TARGET_BLOCKED, NO_ROUTE = range(7)


class Method(Protocol):
    """A prepared algorithm."""

    def run(self, rows: Floats, given: Floats, first: int, last: int, seed: int, seconds: float) -> Outcome:
        """Solve for targets `rows` (t, 15) from starts number `first` up to, without it, `last`, for at most `seconds`.

        Starts are counted: those of `given` (g, n, 3), then the method's own. The run ends at the first that is solved.
        """
        ...

    def run_many(self, rows: Floats, given: Floats, first: int, last: int, seed: int, seconds: float) -> list[Outcome]:
        """Solve m problems as `run` does one: `rows` (m, t, 15), `given` (m, g, n, 3), `seconds` for each."""
        ...


METHODS = ("newton",)


def prepare(name: str, robot: "Robot", scene: "Scene", tolerance: "Tolerance", preferences: "Preferences") -> Method:
    """Prepare the method called `name`."""
    if name == "newton":
        from sinuous.methods.newton import Newton  # noqa: PLC0415

        return Newton(robot, scene, tolerance, preferences)
    raise InputError("method", "is not known", name, "one of " + ", ".join(METHODS))
