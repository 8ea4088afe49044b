"""`python -m benchmarks tracking`: a path of 180 points behind random spheres, the direction free."""

from collections.abc import Iterable, Sequence
from functools import partial
from typing import Any

from benchmarks.harness.experiment import Findings, Indivisible, Piece
from benchmarks.harness.plan import Plan
from benchmarks.paper.contest import Judge, Record, Tally, follow_in_turns, judge_track
from benchmarks.paper.entrants import divide, entrants, roster
from benchmarks.paper.scenes import POINTS, TOTAL, path_through
from benchmarks.paper.tracking.pictures import draw_fractions, draw_scene, draw_times
from benchmarks.paper.tracking.tables import density_table
from benchmarks.paper.tracking.tracks import JUMP, flat, plain
from benchmarks.problems import ProblemSet

SEGMENTS = 8
BUDGET = 0.1
"""Seconds of one waypoint, with all starts."""

SCENES = {10: 2, 20: 2, 40: 2, 70: 12}
"""Scenes by their number of spheres."""


class Tracking(Indivisible):
    """The experiment; see `Experiment`."""

    name = "tracking"

    def __init__(self, plan: Plan, names: Sequence[str] = ()) -> None:
        self.plan = plan
        self._entrants = entrants(names)
        self._able, self._unable = divide(self._entrants, self._problems(1, 0))

    def settings(self) -> dict[str, Any]:
        """Return what the figures depend on."""
        return {
            "methods": [entrant.label for entrant in self._entrants],
            "segments": SEGMENTS,
            "scenes": {str(spheres): count for spheres, count in self._scenes.items()},
            "waypoints": self._points,
            "seconds_a_waypoint": BUDGET,
        }

    @property
    def _scenes(self) -> dict[int, int]:
        return SCENES if not self.plan.quick else {10: 1, 40: 1}

    @property
    def _points(self) -> int:
        return self.plan.count(POINTS, 8)

    def _problems(self, spheres: int, scene: int) -> ProblemSet:
        return path_through(SEGMENTS, spheres, self.plan.rng(20, spheres, scene), self._points)

    def pieces(self) -> Iterable[Piece]:
        """One scene, followed by all methods, is one piece."""
        for scene in range(max(self._scenes.values())):
            for spheres, count in self._scenes.items():
                if scene < count:
                    yield _name(spheres, scene), partial(self._measure, spheres, scene)

    def _measure(self, spheres: int, scene: int) -> dict[str, list[Record]]:
        problems = self._problems(spheres, scene)
        found = follow_in_turns(self._able, problems, seconds=BUDGET, seed=self.plan.seed)
        judge_of = Judge(problems)
        return {label: judge_track(judge_of, followed, keep=scene == 0) for label, followed in found.items()}

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Sum up by density and method, and draw the first scene of each density."""
        by_density: dict[int, dict[str, list[list[Record]]]] = {
            spheres: {
                entrant.label: [pieces[_name(spheres, scene)][entrant.label] for scene in range(count)]
                for entrant in self._able
            }
            for spheres, count in self._scenes.items()
        }
        text = [
            f"{SEGMENTS} segments of {TOTAL / SEGMENTS:g} mm, lengths within a tenth, 1 mm thick, follow a closed "
            f"figure of eight of {self._points} points behind spheres of random places and radii; only the position of "
            "the tip is asked for, to 1e-4 of the length. Each waypoint begins from the last one solved; a method that "
            "fails from there may try its other initial configurations, for at most "
            f"{1e3 * BUDGET:g} ms in all. Methods take turns of "
            'ten waypoints. Nothing guarantees that a waypoint can be reached; "by any" counts those that some method '
            "reached. Times are of confirmed waypoints; "
            "preparing a method for a scene, `opti_path`'s grid included, comes once before."
            f" A jump: some point of the body moved more than {JUMP:g} mm.",
            "![Time of every waypoint](tracking_times.png)",
            "![Tracked fraction and least clearance](tracking_fractions.png)",
            "![One scene](tracking_scene.png)",
        ]
        for spheres, tracks in by_density.items():
            text += [f"## {spheres} spheres, {self._scenes[spheres]} scenes", density_table(tracks)]
        text += ["## Methods", roster(self._entrants, self._unable)]
        spheres = max(self._scenes)
        figures = {
            "tracking_times": draw_times(by_density),
            "tracking_fractions": draw_fractions(by_density),
            "tracking_scene": draw_scene(self._problems(spheres, 0), by_density[spheres], spheres),
        }
        data = {"densities": {str(m): {k: plain(t) for k, t in tracks.items()} for m, tracks in by_density.items()}}
        wrong = sum(Tally.of(flat(t)).wrong for tracks in by_density.values() for t in tracks.values())
        return Findings(text="\n\n".join(text), data={**data, "not_run": self._unable}, pictures=figures, wrong=wrong)


def _name(spheres: int, scene: int) -> str:
    return f"{spheres} spheres, scene {scene}"
