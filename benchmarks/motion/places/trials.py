"""Plans into narrow places, one by one: what came of each, and how they are summed up."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.times import Times

COUNT, QUICK = 8, 1
"""Places of a family."""

STRIDE = 7
"""From one place's seed to the next: eight places have robots of all sizes, with stages and without."""

SECONDS = 5.0


class Trial(NamedTuple):
    """What came of it: seconds, whether there is such a start, how it ended, and what a judge found."""

    seconds: float
    begins: bool
    status: str
    wrong: str

    @property
    def good(self) -> bool:
        """Whether a motion was called proved, in time, and no judge objects."""
        return self.status == "solved" and self.seconds <= SECONDS and not self.wrong


def lines_of(what: str, begun: Sequence[Trial], planned: str, false: str) -> Iterator[Line]:
    """Sum up trials that have a start, under the headings of what is planned and of what is claimed wrongly."""
    if begun:
        good, times = sum(trial.good for trial in begun), Times.of([trial.seconds for trial in begun])
        reached = 100.0 * good / len(begun)
        yield Line(planned, what, reached, "%", Goal(95.0, at_most=False), times, (good, len(begun)))
    yield Line(false, what, sum(bool(trial.wrong) for trial in begun), "", Goal(0.0, correctness=True))
