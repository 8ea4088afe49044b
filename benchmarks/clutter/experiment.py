"""`python -m benchmarks clutter`: intricate places, each of which is known to be possible."""

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

from benchmarks.clutter import far, figures, halls
from benchmarks.clutter.figures import COUNTED
from benchmarks.harness.experiment import Divided, Measurement, OfLines
from benchmarks.harness.plan import Plan
from benchmarks.places import FAMILIES
from benchmarks.solvers.parallel import Abreast
from sinuous.solver.attempts import read_without

PROTOCOL = (
    f"place i of a family is benchmarks.places.make(family, 1000 * seed + i), i below {figures.COUNT} "
    f"({figures.PROTOCOL} for p3 and p4); constants may be tuned on even numbers below 1000 only, and on no place of a "
    f"judging kind, so every seed but 0 judges; {COUNTED}"
)


class Clutter(Abreast, OfLines):
    """The experiment; see `Experiment`. `benchmarks.places.make(family, 1000 * seed + i)` makes place i again.

    Its parts are the families, what a mesh out of reach costs, and the route search alone.

    Parameters
    ----------
    plan : Plan
    """

    protocol = PROTOCOL

    def __init__(self, plan: Plan) -> None:
        super().__init__("clutter", plan)
        self._without: tuple[str, ...] = ()

    def switch_off(self, names: Sequence[str]) -> None:
        """Measure without some attempts of the solver; see `sinuous.solver.attempts.ATTEMPTS`.

        Raises
        ------
        InputError
            Where one is not known.
        """
        self._without = read_without(list(names))

    def settings(self) -> dict[str, Any]:
        """Return what is switched off."""
        return {"without": ",".join(self._without)} if self._without else {}

    def parts(self) -> Iterator[tuple[str, Measurement | Divided]]:
        """Every family, some places a piece."""
        for family in FAMILIES:
            yield family, figures.divided(self.plan, family, self._without)
        yield "far", partial(far.measure, self.plan)
        yield "halls", partial(halls.measure, self.plan)
