"""`python -m benchmarks methods`: all methods on common random problems, each of which can be solved."""

from collections.abc import Callable, Mapping, Sequence

from numpy.random import Generator

import sinuous as sn
from benchmarks.harness.plan import Plan
from benchmarks.judges.kinematics import tip_poses
from benchmarks.paper.contest import Contest, Record, Records, solve_in_turns
from benchmarks.paper.entrants import Entrant, entrants
from benchmarks.paper.pictures import Figure, draw_overview, draw_profiles
from benchmarks.paper.scenes import FREE_BEND, PAPER_TOLERANCE
from benchmarks.problems import ProblemSet, among_spheres, arm, direction_targets, random_configurations

BUDGET = 0.05
"""Seconds of one solve, with all its initial configurations."""

TOGETHER, PIECES = 20, 10
"""Problems in one piece, among obstacles in one scene; and pieces of each kind."""

SPHERES, BEND = 40, 2.4

Draw = Callable[[int, Generator], ProblemSet]
"""From how many, and random numbers, to problems."""


def _free(robot: sn.Robot, targets: list[sn.Target], tolerance: sn.Tolerance = PAPER_TOLERANCE) -> ProblemSet:
    return ProblemSet(robot, targets, sn.Scene(), tolerance.for_robot(robot))


def _directions(robot: sn.Robot, asked: sn.Robot | None = None) -> Draw:
    """Positions and directions of shapes of one robot, asked of it, or of another."""
    return lambda count, rng: _free(asked or robot, direction_targets(robot, random_configurations(robot, count, rng)))


def _exact(count: int, rng: Generator) -> ProblemSet:
    return _directions(arm(5, BEND))(count, rng).with_tolerance(sn.Tolerance().for_robot(arm(5, BEND)))


def _positions(count: int, rng: Generator) -> ProblemSet:
    tips = tip_poses(arm(5, BEND), random_configurations(arm(5, BEND), count, rng))
    return _free(arm(5, BEND), [sn.Target(tip[:3, 3]) for tip in tips])


def _rotations(count: int, rng: Generator) -> ProblemSet:
    tips = tip_poses(arm(5, BEND), random_configurations(arm(5, BEND), count, rng))
    return _free(arm(5, BEND), [sn.Target(tip[:3, 3], rotation=tip[:3, :3]) for tip in tips])


def _spheres(robot: sn.Robot, spheres: int) -> Draw:
    return lambda count, rng: among_spheres(robot, spheres, count, rng).with_tolerance(PAPER_TOLERANCE)


def _spheres_positions(count: int, rng: Generator) -> ProblemSet:
    drawn = _spheres(arm(5, BEND, radius=4.0), SPHERES)(count, rng)
    return ProblemSet(drawn.robot, [sn.Target(t.position) for t in drawn.targets], drawn.scene, drawn.tolerance)


FAMILIES: dict[str, tuple[str, Draw]] = {
    "gentle": ("Gentle poses: drawn with bends to 1.2, no limit on bends", _directions(arm(5, 1.2), arm(5, FREE_BEND))),
    "direction": (f"Position and direction, bends to {BEND}", _directions(arm(5, BEND))),
    "exact": ("Position and direction, to 1e-4 of the length and 1e-3 rad", _exact),
    "position": ("Position alone", _positions),
    "rotation": ("Position and whole rotation", _rotations),
    "fixed lengths": (
        "Position and direction, lengths fixed at 57.5 mm",
        _directions(sn.Robot.uniform(5, 57.5, BEND, base=arm(5, BEND).base)),
    ),
    "20 segments": ("Position and direction, 20 segments, bends to 1.2", _directions(arm(20, 1.2))),
    "spheres, direction": (
        f"Position and direction among {SPHERES} spheres, 4 mm thick",
        _spheres(arm(5, BEND, radius=4.0), SPHERES),
    ),
    "spheres, position": (f"Position alone among {SPHERES} spheres, 4 mm thick", _spheres_positions),
    "spheres, thicket": (
        f"Position and direction, 8 segments with bends to 1.5, 8 mm thick, among {3 * SPHERES} spheres",
        _spheres(arm(8, 1.5, radius=8.0), 3 * SPHERES),
    ),
}
"""What each is, and how its problems are drawn."""


class Methods(Contest):
    """The experiment; see `Experiment`. A group is a kind of problem."""

    name = "methods"
    about = (
        f"Segments of 45 to 70 mm, mostly five; {TOGETHER * PIECES} problems of each kind, every one the pose of a "
        f"configuration within limits and free of obstacles, to {PAPER_TOLERANCE.position:g} mm and "
        f"{PAPER_TOLERANCE.angle} rad mostly, from cold, at most {1e3 * BUDGET:g} ms each. Methods take turns of ten "
        "problems; a solve during which another process had the processor is repeated. Times and errors (mm, rad) are "
        "medians of confirmed answers; `limits`, `obstacle` and `target` count the answers that verification found "
        "outside a limit, touching, or off the target."
    )

    def __init__(self, plan: Plan, names: Sequence[str] = ()) -> None:
        super().__init__(plan, entrants(names))

    def groups(self) -> Mapping[str, tuple[str, int]]:
        """Return the kinds of problems."""
        return {family: (words, self.plan.count(PIECES, 1)) for family, (words, _) in FAMILIES.items()}

    def problems(self, group: str, number: int) -> ProblemSet:
        """Draw problems."""
        rng = self.plan.rng(30, list(FAMILIES).index(group), number)
        return FAMILIES[group][1](self.plan.count(TOGETHER, 2), rng)

    def solve(self, entrants: Sequence[Entrant], problems: ProblemSet) -> dict[str, list[Record]]:
        """Solve from cold."""
        return solve_in_turns(entrants, problems, seconds=BUDGET, seed=self.plan.seed)

    def pictures(self, found: Mapping[str, Records]) -> dict[str, Figure]:
        """Draw success and times."""
        labels = [entrant.label for entrant in self.entrants]
        return {"methods_overview": draw_overview(found, labels), "methods_profiles": draw_profiles(found, BUDGET)}
