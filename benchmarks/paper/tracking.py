"""`python -m benchmarks tracking`: a path of 180 points behind random spheres, the direction free."""

import math
from collections.abc import Mapping, Sequence
from statistics import median

from benchmarks.harness.markdown import figure, span
from benchmarks.harness.plan import Plan
from benchmarks.paper.contest import Column, Contest, Record, Records, follow_in_turns
from benchmarks.paper.entrants import Entrant, entrants
from benchmarks.paper.pictures import Figure, draw_waypoints
from benchmarks.paper.scenes import POINTS, TOTAL, path_through
from benchmarks.problems import ProblemSet

SEGMENTS = 8
BUDGET = 0.1
"""Seconds of one waypoint, with all starts."""

SCENES = {10: 2, 20: 2, 40: 2, 70: 12}
"""Scenes by their number of spheres."""

JUMP = 0.1 * TOTAL
"""Motion (mm) of some point of the body between two waypoints that is a jump to another shape; a step of the path is a
tenth of that."""

Tracks = list[list[Record]]


def _least_clearance(tracks: Tracks) -> float:
    return min((record["clearance"] for track in tracks for record in track if record["right"]), default=math.nan)


COLUMNS: dict[str, Column] = {
    "whole paths": lambda _, tracks: str(sum(all(record["right"] for record in track) for track in tracks)),
    "from the last shape": lambda _, tracks: str(
        sum(record["right"] and record["start"] == "given" for track in tracks for record in track)
    ),
    "least clearance, mm": lambda _, tracks: figure(_least_clearance(tracks), ".2g"),
    "jumps": lambda _, tracks: str(sum(record.get("motion", 0.0) > JUMP for track in tracks for record in track)),
    "preparing": lambda _, tracks: span(median(track[0]["prepared"] for track in tracks)),
}


class Tracking(Contest):
    """The experiment; see `Experiment`. A group is a number of spheres, a piece a scene."""

    name = "tracking"
    columns = COLUMNS
    about = (
        f"{SEGMENTS} segments of {TOTAL / SEGMENTS:g} mm, lengths within a tenth, 1 mm thick, follow a closed figure "
        f"of eight of {POINTS} points behind spheres of random places and radii; only the position of the tip is asked "
        "for, to 1e-4 of the length. Each waypoint begins from the last one solved; a method that fails from there may "
        f"try its other initial configurations, for at most {1e3 * BUDGET:g} ms in all. Methods take turns of ten "
        "waypoints. Nothing guarantees that a waypoint can be reached. Preparing a method for a scene, `opti_path`'s "
        f"grid included, comes once before. A jump: some point of the body moved more than {JUMP:g} mm."
    )

    def __init__(self, plan: Plan, names: Sequence[str] = ()) -> None:
        super().__init__(plan, entrants(names))

    def groups(self) -> Mapping[str, tuple[str, int]]:
        """Return the numbers of spheres."""
        scenes = {10: 1, 40: 1} if self.plan.quick else SCENES
        return {str(spheres): (f"{spheres} spheres, {count} scenes", count) for spheres, count in scenes.items()}

    def problems(self, group: str, number: int) -> ProblemSet:
        """Return a path through a scene."""
        rng = self.plan.rng(20, int(group), number)
        return path_through(SEGMENTS, int(group), rng, self.plan.count(POINTS, 8))

    def solve(self, entrants: Sequence[Entrant], problems: ProblemSet) -> dict[str, list[Record]]:
        """Follow the path."""
        return follow_in_turns(entrants, problems, seconds=BUDGET, seed=self.plan.seed)

    def pictures(self, found: Mapping[str, Records]) -> dict[str, Figure]:
        """Draw the time of every waypoint."""
        return {"tracking_times": draw_waypoints(found)}
