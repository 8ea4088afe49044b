"""`python -m benchmarks clutter`: intricate places, each of which is known to be possible."""

from collections.abc import Iterator, Sequence
from functools import partial

from benchmarks.clutter import far, figures, halls
from benchmarks.harness.experiment import Measurement, OfLines
from benchmarks.harness.plan import Plan
from benchmarks.places import FAMILIES
from sinuous.errors import InputError


class Clutter(OfLines):
    """The experiment; see `Experiment`. `benchmarks.places.make(family, 1000 * seed + i)` makes place i again.

    Parameters
    ----------
    plan : Plan
    families : sequence of str
        Names of those to measure; none means all, what a mesh out of reach costs, and the route search alone.

    Raises
    ------
    InputError
        When there is no such family.
    """

    def __init__(self, plan: Plan, families: Sequence[str] = ()) -> None:
        super().__init__("clutter", plan)
        for name in families:
            if name not in FAMILIES:
                raise InputError("--family", "", name, "one of " + ", ".join(FAMILIES))
        self._families = families

    def parts(self) -> Iterator[tuple[str, Measurement]]:
        """One family is one piece."""
        for family in self._families or FAMILIES:
            yield family, partial(figures.measure, self.plan, family)
        if not self._families:
            yield "far", partial(far.measure, self.plan)
            yield "halls", partial(halls.measure, self.plan)
