"""What exploring a place came to: shapes, motions, parts, and how much of what can be reached is near."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from sinuous.reprs import ShortRepr
from sinuous.solving.memory import Memory
from sinuous.words import duration

MOST_PARTS = 20
"""Sizes of parts that are told."""

SHARES = ("covered", "joined")


class Exploration(ShortRepr):
    """What `explore` did, and what the memory holds then.

    The shares are of positions that were drawn evenly in the ball of the robot's reach, before anything was known of
    them, and that the solver met without the memory; of the last 400 such positions.

    Attributes
    ----------
    memory : Memory
    shapes, motions : int
        That are kept.
    parts : tuple of int
        Numbers of shapes that motions join, the largest 20.
    tests : int
        Positions that the shares are of.
    covered : float
        Share of positions with the tip of a shape of the largest part within `spacing`; NaN where there are none.
    joined : float
        Share of positions whose shape one proved motion joined to a shape of the largest part; NaN likewise.
    spacing : float
    rounds : int
        Done until now, also by earlier calls.
    full : bool
        Whether it ended because the memory was full.
    seconds : float
        Of this call.
    """

    def __init__(self, memory: Memory, spacing: float, full: bool, seconds: float) -> None:
        self.memory, self.spacing, self.full, self.seconds = memory, spacing, full, seconds
        graph, known = memory._shapes.everything, memory._explored
        self.shapes, self.motions = len(graph), len(graph.edges)
        self.parts = tuple(np.bincount(graph.parts)[:MOST_PARTS].tolist())
        tests = [] if known is None else known.tests
        self.rounds, self.tests = 0 if known is None else known.rounds, len(tests)
        self.covered, self.joined = (
            math.nan if not tests else sum(each[i] for each in tests) / len(tests) for i in (0, 1)
        )

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values; a share of nothing is `None`."""
        names = ("shapes", "motions", "tests", "spacing", "rounds", "full", "seconds")
        shares = {name: None if math.isnan(getattr(self, name)) else getattr(self, name) for name in SHARES}
        return {**{name: getattr(self, name) for name in names}, "parts": list(self.parts), **shares}

    def __str__(self) -> str:
        told = [f"{self.shapes:,} shapes", f"{self.motions:,} motions"]
        if self.parts:
            largest = f"{self.parts[0] / self.shapes:.0%} of the shapes in the largest part"
            told.append(largest)
        if self.tests:
            told.append(
                f"of {self.tests} positions that the robot reaches, {self.covered:.0%} near a shape of it "
                f"and {self.joined:.0%} one motion from it"
            )
        if self.full:
            told.append("the memory is full")
        return f"{', '.join(told)}; {self.rounds} rounds, {duration(self.seconds)}"

    def _shown(self) -> Iterator[str]:
        yield f"{self.shapes} shapes"
        yield f"{self.motions} motions"
