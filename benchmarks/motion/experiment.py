"""`python -m benchmarks motion`: what is planned and tracked, how quickly, and whether it is as clear as it claims."""

from collections.abc import Callable, Iterator
from functools import partial

from benchmarks.harness.experiment import Measurement, OfLines
from benchmarks.harness.lines import Line
from benchmarks.harness.plan import Plan
from benchmarks.motion import leader, letters, loops, p5, tracks
from benchmarks.motion.in_time import clouds, moving
from benchmarks.motion.places import into, known

SECTIONS: dict[str, Callable[[Plan], Iterator[Line]]] = {
    **p5.PARTS,
    **tracks.PARTS,
    **letters.PARTS,
    **leader.PARTS,
    **loops.PARTS,
    **clouds.PARTS,
    **moving.PARTS,
    **into.PARTS,
    **known.PARTS,
}
"""One piece each, by name."""


class Motions(OfLines):
    """The experiment; see `Experiment`."""

    def __init__(self, plan: Plan) -> None:
        super().__init__("motion", plan)

    def parts(self) -> Iterator[tuple[str, Measurement]]:
        """One section is one piece."""
        for name, measure in SECTIONS.items():
            yield name, partial(measure, self.plan)
