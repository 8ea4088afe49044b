"""What a solve may be told, in one place: for `Solver`, `solve`, `solve_all`, `track` and the command line."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypedDict

from sinuous.base import checks
from sinuous.base.arguments import Number, OneEach, Truth, Whole
from sinuous.base.errors import InputError, refuse_unknown, shown, suggested
from sinuous.methods.method import Choice, name_of
from sinuous.model.robot import Robot, demanding
from sinuous.problem.problem import Preferences
from sinuous.problem.target import Tolerance, as_tolerance
from sinuous.solver.memory import Memory

TIME = 1.0
"""Default budget of a solve, in seconds."""

UNBOUNDED = 2**62
"""Most starts of a solve where the user gives no bound: more than any time suffices for."""

REMEMBERED, SCATTERED, EDGES, SIDE_TUBES, ROOTS = "remembered", "scattered", "edges", "side_tubes", "roots"
"""Names of attempts that others have to know."""

ATTEMPTS = {
    REMEMBERED: "shapes of a memory whose poses are nearest to the targets",
    SCATTERED: "starts scattered over all shapes, beyond those of the first call",
    "base_tube": "chains fitted to the tube that the base lies in",
    EDGES: "a route around edges",
    SIDE_TUBES: "a route through tubes that open beside edges",
    "cells": "routes over the cells of a grid, coarse and then fine ones",
    "fitted": "chains fitted to routes",
    "grown": "chains grown along routes from both ends, and joined, by wider and wider beams",
    "detours": "chains grown along routes that are led aside until they are as long as the robot",
    "unguided": "chains grown at random from both ends, without a route, and joined where they nearly meet",
    "bottleneck": "chains through the narrowest place of a route, of which each half is solved by itself",
    ROOTS: "routes and chains from several places where the robot may begin to bend: with joints, or on a long stage",
    "passages": "routes through other passages; for `solve_all` those that no solution leads through yet",
}
"""All attempts, by the names with which they are switched off, and what each makes."""

RENAMED_ATTEMPTS = {"laid": "fitted", "gates": "bottleneck"}
"""New names of attempts by those that they had before."""


def read_without(names: object) -> tuple[str, ...]:
    """Check names of attempts that are to be switched off.

    Raises
    ------
    InputError
        Where one is not known.
    """
    given = (names,) if isinstance(names, str) else names
    if not isinstance(given, list | tuple | set | frozenset):
        raise InputError("without", "", names, "names of attempts: " + ", ".join(ATTEMPTS))
    off = set()
    for name in given:
        now = RENAMED_ATTEMPTS.get(name, name) if isinstance(name, str) else None
        if now not in ATTEMPTS:
            raise InputError("without", f"unknown attempt {shown(name)}", name, suggested(name, ATTEMPTS))
        if now != name:
            warnings.warn(f"attempt {name!r} is {now!r} now", DeprecationWarning, stacklevel=2)
        off.add(now)
    return tuple(name for name in ATTEMPTS if name in off)


class SolveArguments(TypedDict, total=False):
    """Options of a solve as keyword arguments; see `SolveOptions`."""

    tolerance: Tolerance | None
    method: Choice
    prefer: Preferences | None
    time: Number
    max_starts: Whole | None
    seed: Whole
    routes: Truth
    without: str | Sequence[str]
    memory: Memory | None
    clearance: OneEach | None
    self_clearance: OneEach | None


@dataclass(frozen=True)
class SolveOptions:
    """The options of a solve; all are checked as they come in.

    Attributes
    ----------
    tolerance : Tolerance
        Default: 1e-4 of the robot's mean length, and 1e-3 rad.
    method : str or Options
        Name of the algorithm, or its options, like `OptiPath(iterations=100)`.
    prefer : Preferences
        What to like better among solutions.
    time : float
        Budget of one solve over all its starts, in seconds.
    max_starts : int, optional
        Most starts of one solve; by default as many as the time allows.
    seed : int
        Of the scattered starts; the same seed gives the same answer, unless the time runs out.
    routes : bool
        Whether to search for routes through free space when the first starts fail; only for methods that take routes
        (see `Capabilities.routes`).
    without : str or sequence of str
        Attempts that are switched off, by the names in `sinuous.solver.options.ATTEMPTS`: to see what they bring.
    memory : Memory, optional
        Shapes that are tried before anything is searched, and where what is solved is kept.
    clearance, self_clearance : float or array_like (n,), optional
        Least distance of the body from obstacles, and from itself, that a solution has to keep, instead of what the
        robot demands: of all segments, or one each. See `Robot`.

    Raises
    ------
    InputError
        That names the option.
    """

    tolerance: Tolerance = field(default_factory=Tolerance)
    method: Choice = "newton"
    prefer: Preferences = field(default_factory=Preferences)
    time: float = TIME
    max_starts: int | None = None
    seed: int = 0
    routes: bool = True
    without: tuple[str, ...] = ()
    memory: Memory | None = None
    clearance: OneEach | None = None
    self_clearance: OneEach | None = None

    def __post_init__(self) -> None:
        prefer, most = Preferences() if self.prefer is None else self.prefer, self.max_starts
        checks.instance("prefer", prefer, Preferences, "Preferences")
        name_of(self.method)
        if not isinstance(self.memory, Memory | None):
            raise InputError("memory", "", self.memory, "a Memory")
        values = {
            "tolerance": as_tolerance(self.tolerance),
            "prefer": prefer,
            "time": checks.number("time", self.time, low=0.0),
            "max_starts": None if most is None else checks.integer("max_starts", most, 1, 10**9),
            "seed": checks.integer("seed", self.seed, 0, 2**31 - 1),
            "routes": checks.truth("routes", self.routes),
            "without": read_without(self.without),
            "clearance": _each("clearance", self.clearance),
            "self_clearance": _each("self_clearance", self.self_clearance),
        }
        for key, value in values.items():
            object.__setattr__(self, key, value)

    def demanded_of(self, robot: Robot) -> Robot:
        """Return the robot with the clearances that are demanded here, where any are."""
        return demanding(robot, self.clearance, self.self_clearance)

    @property
    def most_starts(self) -> int:
        """Most starts of one solve, as a number."""
        return UNBOUNDED if self.max_starts is None else self.max_starts

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> "SolveOptions":
        """Make options of keyword arguments; one that is not known is refused.

        Raises
        ------
        InputError
        """
        refuse_unknown(given, cls.__annotations__)
        return cls(**given)


def _each(key: str, value: OneEach | None) -> OneEach | None:
    """Check what is demanded of every segment; how many there are, and their names, says the robot."""
    if isinstance(value, Mapping):
        return {str(name): checks.number(f"{key}.{name}", each, low=0.0) for name, each in value.items()}
    return None if value is None else checks.one_each(key, value, None)
