"""`python -m benchmarks methods`: all methods on common random problems, with and without obstacles."""

from collections.abc import Iterable, Sequence
from functools import partial
from typing import Any

from benchmarks.harness.experiment import Findings, Indivisible, Piece
from benchmarks.harness.plan import Plan
from benchmarks.paper.contest import Record, Tally, all_records, solve_in_turns
from benchmarks.paper.entrants import divide, entrants, roster
from benchmarks.paper.methods.families import FAMILIES
from benchmarks.paper.methods.pictures import draw_overview, draw_profiles
from benchmarks.paper.methods.tables import family_table, plain
from benchmarks.paper.scenes import PAPER_TOLERANCE
from benchmarks.problems import ProblemSet

BUDGET = 0.05
"""Seconds of one solve, with all its initial configurations."""

TOGETHER = 20
"""Problems in one piece; among obstacles, in one scene."""

PIECES = 10
"""For each set of problems."""


class Methods(Indivisible):
    """The experiment; see `Experiment`."""

    name = "methods"

    def __init__(self, plan: Plan, names: Sequence[str] = ()) -> None:
        self.plan = plan
        self._entrants = entrants(names)

    def settings(self) -> dict[str, Any]:
        """Return what the figures depend on."""
        return {
            "methods": [entrant.label for entrant in self._entrants],
            "problems": list(FAMILIES),
            "of_each": self._together * self._pieces,
            "seconds_a_solve": BUDGET,
        }

    @property
    def _together(self) -> int:
        return self.plan.count(TOGETHER, 2)

    @property
    def _pieces(self) -> int:
        return self.plan.count(PIECES, 1)

    def _problems(self, family: str, number: int) -> ProblemSet:
        return FAMILIES[family].draw(self._together, self.plan.rng(30, list(FAMILIES).index(family), number))

    def pieces(self) -> Iterable[Piece]:
        """Twenty problems of a kind, solved by all methods, are one piece."""
        for number in range(self._pieces):
            for family in FAMILIES:
                yield f"{family}: {number}", partial(self._measure, family, number)

    def _measure(self, family: str, number: int) -> dict[str, list[Record]]:
        problems = self._problems(family, number)
        able, _ = divide(self._entrants, problems)
        return solve_in_turns(able, problems, seconds=BUDGET, seed=self.plan.seed)

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Sum up by kind of problem and method."""
        labels = [entrant.label for entrant in self._entrants]
        found = {
            family: all_records(pieces[f"{family}: {number}"] for number in range(self._pieces)) for family in FAMILIES
        }
        unable = {family: divide(self._entrants, self._problems(family, 0))[1] for family in FAMILIES}
        text = [
            f"Segments of 45 to 70 mm, mostly five; {self._together * self._pieces} problems of each kind, every one "
            f"the pose of a configuration within limits and free of obstacles, to {PAPER_TOLERANCE.position:g} mm "
            f"and {PAPER_TOLERANCE.angle} rad mostly, from cold, at most {1e3 * BUDGET:g} ms each. "
            "Methods take turns of ten problems; a solve during which another process had the processor is "
            "repeated. Times and errors are medians of confirmed answers; `limits`, "
            "`obstacle` and `target` count the answers that verification found outside a limit, touching, or off the "
            "target.",
            "![Success and median time](methods_overview.png)",
            "![Share solved within a time](methods_profiles.png)",
        ]
        for family, records in found.items():
            text += [f"## {FAMILIES[family].words}", family_table(records, unable[family], labels)]
        text += ["## Methods", roster(self._entrants, {})]
        tallies = {family: {k: Tally.of(r) for k, r in records.items()} for family, records in found.items()}
        data = {
            "families": {f: {k: plain(r) for k, r in records.items()} for f, records in found.items()},
            "not_run": unable,
        }
        figures = {"methods_overview": draw_overview(tallies, labels), "methods_profiles": draw_profiles(found, BUDGET)}
        wrong = sum(tally.wrong for each in tallies.values() for tally in each.values())
        return Findings(text="\n\n".join(text), data=data, pictures=figures, wrong=wrong)
