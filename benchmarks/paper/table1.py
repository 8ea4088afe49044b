"""`python -m benchmarks table1`: the paper's four poses, every method, beside what the paper publishes."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from benchmarks.harness.markdown import span
from benchmarks.harness.plan import Plan
from benchmarks.paper.contest import Contest, Record, Records, solve_in_turns
from benchmarks.paper.entrants import FAITHFUL, Entrant, entrants
from benchmarks.paper.pictures import Figure, draw_times
from benchmarks.paper.scenes import PAPER_TOLERANCE, paper_pose
from benchmarks.problems import PAPER_POSES, ProblemSet
from sinuous.problem.target import Tolerance

BUDGET = 0.1
"""Seconds of one solve, with all its initial configurations."""

REPEATS, BLOCKS = 10, 10
"""Solves of a pose in one piece, and pieces."""

EXACT = "newton, to 1e-6"
"""Label of our own method when it goes on to 1e-6 mm and rad."""


class Published(NamedTuple):
    """A line of the paper's table, on the authors' machine: seconds, mm and rad as far as it says them."""

    seconds: float
    position: float | None = None
    angle: float | None = None

    def __str__(self) -> str:
        """Return it as a cell."""
        errors = (
            f"{value:g} {unit}" for value, unit in ((self.position, "mm"), (self.angle, "rad")) if value is not None
        )
        return ", ".join([span(self.seconds), *errors])


PUBLISHED: dict[str, dict[str, Published]] = {
    "A": {
        "fabrikc": Published(0.183, 0.863, 0.0),
        "dls": Published(0.112, 4.52, 0.85),
        "slinki": Published(0.0122, 0.766, 0.0),
        FAITHFUL: Published(0.0169, 0.0, 0.014),
    },
    "B": {
        "fabrikc": Published(0.206, 0.775, 0.0),
        "dls": Published(0.124, 0.0, 0.0),
        "slinki": Published(0.0118, 0.632, 0.0),
        FAITHFUL: Published(0.0028, 0.0, 0.017),
    },
    "C": {FAITHFUL: Published(0.0159)},
    "D": {FAITHFUL: Published(0.172)},
}
"""By pose, and by the method here that is nearest: exFABRIKc as `fabrikc`, Opti.DLS as `dls`, Opti.path as what we
read in the paper."""


class Table1(Contest):
    """The experiment; see `Experiment`. A group is a pose."""

    name = "table1"
    about = (
        f"Five segments of 45 to 70 mm, no obstacles; to {PAPER_TOLERANCE.position:g} mm and {PAPER_TOLERANCE.angle} "
        f"rad. Each method {REPEATS * BLOCKS} times a pose, in turns, each time for at most {1e3 * BUDGET:g} ms. "
        "Errors (mm, rad) are those that verification computed; times are around the whole call."
    )

    def __init__(self, plan: Plan, names: Sequence[str] = ()) -> None:
        chosen = entrants(names)
        exact = [Entrant(EXACT, "newton", Tolerance(1e-6, 1e-6))] if chosen[0].label == "newton" else []
        super().__init__(plan, [*chosen[: len(exact)], *exact, *chosen[len(exact) :]])

    def groups(self) -> Mapping[str, tuple[str, int]]:
        """Return the poses, and in their headings what the paper prints for the methods of these names."""
        told = {pose: "; ".join(f"{label} {own}" for label, own in PUBLISHED[pose].items()) for pose in PAPER_POSES}
        words = "pose {}: position {} mm, direction {} (published, on other hardware: {})"
        return {
            pose: (words.format(pose, *asked, told[pose]), self.plan.count(BLOCKS, 1))
            for pose, asked in PAPER_POSES.items()
        }

    def problems(self, group: str, number: int) -> ProblemSet:
        """Return one pose many times over."""
        return paper_pose(group, self.plan.count(REPEATS, 2))

    def solve(self, entrants: Sequence[Entrant], problems: ProblemSet) -> dict[str, list[Record]]:
        """Solve from cold."""
        return solve_in_turns(entrants, problems, seconds=BUDGET, seed=self.plan.seed)

    def pictures(self, found: Mapping[str, Records]) -> dict[str, Figure]:
        """Draw the times beside what is published."""
        published = {pose: {label: own.seconds for label, own in each.items()} for pose, each in PUBLISHED.items()}
        return {"table1_times": draw_times(found, published)}
