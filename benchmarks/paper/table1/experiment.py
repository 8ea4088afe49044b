"""`python -m benchmarks table1`: the paper's four poses, every method, beside what the paper publishes."""

from collections.abc import Iterable, Sequence
from functools import partial
from typing import Any

from benchmarks.harness.experiment import Findings, Indivisible, Piece
from benchmarks.harness.plan import Plan
from benchmarks.paper.contest import Record, solve_in_turns
from benchmarks.paper.entrants import Entrant, divide, entrants, roster
from benchmarks.paper.scenes import FREE_BEND, PAPER_TOLERANCE, paper_pose
from benchmarks.paper.table1.pictures import draw_shapes, draw_times
from benchmarks.paper.table1.rows import EXACT, rows_of
from benchmarks.paper.table1.tables import pose_table
from benchmarks.problems import PAPER_POSES
from sinuous.problem.target import Tolerance

BUDGET = 0.1
"""Seconds of one solve, with all its initial configurations."""

REPEATS = 10
"""In one piece, of which there are ten a pose."""


class Table1(Indivisible):
    """The experiment; see `Experiment`."""

    name = "table1"

    def __init__(self, plan: Plan, names: Sequence[str] = ()) -> None:
        self.plan = plan
        self._entrants = entrants(names)
        if any(entrant.label == "newton" for entrant in self._entrants):
            self._entrants.insert(1, Entrant(EXACT, "newton", Tolerance(1e-6, 1e-6)))

    def settings(self) -> dict[str, Any]:
        """Return what the figures depend on."""
        return {
            "methods": [entrant.label for entrant in self._entrants],
            "repeats": self._repeats * self._blocks,
            "seconds_a_solve": BUDGET,
            "position_tolerance": PAPER_TOLERANCE.position,
            "angle_tolerance": PAPER_TOLERANCE.angle,
            "max_bend": FREE_BEND,
        }

    @property
    def _repeats(self) -> int:
        return self.plan.count(REPEATS, 2)

    @property
    def _blocks(self) -> int:
        return self.plan.count(10, 1)

    def pieces(self) -> Iterable[Piece]:
        """Ten repeats of one pose by all methods are one piece."""
        for block in range(self._blocks):
            for pose in PAPER_POSES:
                yield f"pose {pose}, block {block}", partial(self._measure, pose)

    def _measure(self, pose: str) -> dict[str, list[Record]]:
        problems = paper_pose(pose, self._repeats)
        able, _ = divide(self._entrants, problems)
        return solve_in_turns(able, problems, seconds=BUDGET, seed=self.plan.seed, keep=True)

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Tables, shapes and times."""
        lines = {pose: rows_of(pose, pieces, self._entrants) for pose in PAPER_POSES}
        _, unable = divide(self._entrants, paper_pose("A", 1))
        text = [
            f"Five segments of 45 to 70 mm, no obstacles; to {PAPER_TOLERANCE.position:g} mm and "
            f"{PAPER_TOLERANCE.angle} rad. Each method {self._repeats * self._blocks} times a pose, in turns, each "
            f"time for at most {1e3 * BUDGET:g} ms. Errors are those that verification computed; times are of all "
            'repeats, solved or not, around the whole call. "Published" is what the paper prints for the method of '
            "this name (exFABRIKc stands beside `fabrikc`, Opti.DLS beside `dls`), measured on other hardware.",
            "![Times of all methods on the four poses](table1_times.png)",
            "![Shapes that meet the four poses](table1_shapes.png)",
        ]
        for pose, rows in lines.items():
            position, direction = PAPER_POSES[pose]
            text += [f"## Pose {pose}: position {position} mm, direction {direction}", pose_table(pose, rows)]
        text += ["## Methods", roster(self._entrants, unable)]
        figures = {"table1_times": draw_times(lines), "table1_shapes": draw_shapes(lines)}
        data = {"poses": {pose: {r.label: r.plain(pose) for r in rows} for pose, rows in lines.items()}}
        wrong = sum(row.tally.wrong for rows in lines.values() for row in rows)
        return Findings(text="\n\n".join(text), data={**data, "not_run": unable}, pictures=figures, wrong=wrong)
