"""What a demanded clearance costs: places are solved with one, and by a body that is thicker by as much.

A clearance is demanded that the hidden shape keeps; the thicker body is as hard to lead among obstacles. A millionth of
the radius demanded is held against the problem without. An answer counts where judges find it as clear as was demanded.
"""

from collections.abc import Iterator

from benchmarks.clutter.ways import LIMIT, PATIENCE, Row, timed
from benchmarks.judges.clearances import least_clearance
from benchmarks.places import make
from benchmarks.places.place import right
from sinuous.solver.solver import Solver

AGAINST = {"as ever": "as ever", "a trace demanded": "as ever", "thicker": "thicker", "demanded": "thicker"}

SHARE, TRACE = 0.5, 1e-6
"""What is demanded, of the clearance of the hidden shape; and a clearance that changes nothing, in radii."""

TURNS = 8
"""Solves in each way, of which the least counts."""


def examined(family: str, seed: int, count: int) -> Iterator[Row]:
    """Solve places of a family in all ways, which take turns."""
    for number in range(1000 * seed, 1000 * seed + count):
        place = make(family, number)
        robot, hidden = place.robot, least_clearance(place.robot, place.scene, place.hidden_q[None])[0]
        clearance, trace = SHARE * max(0.0, float(hidden)), TRACE * max(robot.radii)
        thicker = [each.changed(radius=each.radius + clearance) for each in robot.segments]
        asked = {
            "as ever": (robot, 0.0),
            "a trace demanded": (robot.changed(clearance=trace), trace),
            "thicker": (robot.changed(segments=thicker), clearance),
            "demanded": (robot.changed(clearance=clearance), clearance),
        }
        solvers = [
            (way, Solver(own, place.scene, tolerance=place.tolerance, time=PATIENCE * LIMIT), least)
            for way, (own, least) in asked.items()
        ]
        turns = [[timed(solver.solve, place.targets) for _, solver, _ in solvers] for _ in range(TURNS)]
        for (way, _, least), found in zip(solvers, zip(*turns, strict=True), strict=True):
            solution, spent = found[0][0], min(spent for _, spent in found)
            fine = solution.solved and right(place, solution.q)
            fine = fine and least_clearance(robot, place.scene, solution.q[None])[0] >= least * (1.0 - 1e-9)
            yield Row(family, way, fine and spent <= 1e3 * LIMIT, solution.solved and not fine, spent)
