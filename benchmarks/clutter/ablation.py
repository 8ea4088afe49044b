"""What each attempt of the solver brings: places are solved with everything, and with one after the other off."""

from collections.abc import Iterator

from benchmarks.clutter.ways import LIMIT, PATIENCE, Row, timed
from benchmarks.places import Place, make
from benchmarks.places.place import right
from sinuous.kernels.tables import ROUTE, SOURCES
from sinuous.solver.options import ATTEMPTS
from sinuous.solver.solver import Solver
from sinuous.solver.strategy import OPENING

EVERYTHING = "everything"

AGAINST = {EVERYTHING: EVERYTHING, **{f"without {name}": EVERYTHING for name in ATTEMPTS if name != "remembered"}}
"""The ways, all held against the first: there is no memory."""


def examined(family: str, seed: int, count: int) -> Iterator[Row]:
    """Solve places of a family in all ways."""
    for number in range(1000 * seed, 1000 * seed + count):
        place = make(family, number)
        whole, opened = _row(place, EVERYTHING)
        for way in AGAINST:  # what the first call solves knows no attempts
            yield whole._replace(way=way) if opened or way == EVERYTHING else _row(place, way)[0]


def _row(place: Place, way: str) -> tuple[Row, bool]:
    without = () if way == EVERYTHING else (way.removeprefix("without "),)
    solver = Solver(place.robot, place.scene, tolerance=place.tolerance, time=PATIENCE * LIMIT, without=without)
    solution, spent = timed(solver.solve, place.targets, runs=2)
    fine = solution.solved and right(place, solution.q)
    solved = fine and spent <= 1e3 * LIMIT
    opened = solution.solved and solution.start != SOURCES[ROUTE] and solution.starts <= OPENING
    return Row(place.family, way, solved, solution.solved and not fine, spent if solved else 1e3 * LIMIT), opened
