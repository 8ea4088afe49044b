"""`python -m benchmarks wild`: anything that can be built, with a hidden solution each, and every claim judged."""

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from functools import partial
from typing import Any

from benchmarks.harness import reference
from benchmarks.harness.experiment import Findings, InTurn, Piece, chosen
from benchmarks.harness.lines import Line
from benchmarks.harness.plan import Plan
from benchmarks.wild import audit, branches, calls, curled, doors, loaded, motions, worlds
from benchmarks.wild.tally import Tally
from benchmarks.wild.trials import examine
from benchmarks.wild.worlds import World
from sinuous.problem.target import Target

SECTION = "wild problems, each with a hidden solution that is clear of obstacles and of itself; budget 1 s"
THICK = "thick arms (radius 10, segments of 100 to 120, bends to 3.1), targets near the base; budget 1 s"

AUDIT = (
    "what an audit of the proofs strained, each problem with a hidden solution; budget 1 s, of bounds and huge 0.05 s"
)

MISSED = "not solved and found right by the judges"

BLOCK, BLOCKS, AUDITED = 22, 100, 10
"""Worlds of one piece, about a thousand problems; pieces of one round, 100,000 problems; pieces of one audited kind."""

WALLS = "walls with doors"

MOTIONS, MOVED = 100, 5
"""Motions, or calls, of one piece; pieces of one kind of these, in one round."""

ARMS, CURLED_WORLDS = (3, 5, 8), 200
"""Segments of the thick arms; how many times 50 problems each is given."""

MOST, MOST_THICK = 30, 100
"""Of 100,000 problems, how many may be not solved within the budget."""


class Wild(InTurn):
    """The experiment; see `Experiment`. Every round has fresh problems, and all of them are counted together.

    Parameters
    ----------
    plan : Plan
    """

    name = "wild"
    divisible = True

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self._only: frozenset[str] | None = None

    def settings(self) -> dict[str, Any]:
        """Return nothing: seed and size determine everything; more rounds may be added to what is measured."""
        return {}

    def choose(self, patterns: Sequence[str]) -> None:
        """Measure some of the pieces alone; see `chosen`."""
        self._only = chosen([name for name, _ in self._pieces()], patterns)

    def pieces(self) -> Iterator[Piece]:
        """Return all pieces, or those that were chosen."""
        return (piece for piece in self._pieces() if self._only is None or piece[0] in self._only)

    def _pieces(self) -> Iterator[Piece]:
        """First what is short: thick arms, branches and doors; then blocks of wild worlds."""
        seed, count = self.plan.seed, self.plan.count
        size = count(BLOCK, 10)
        for n in ARMS:
            yield _arm(n), partial(_tallied, partial(curled.make, n, seed), range(count(CURLED_WORLDS, 1)))
        for name, poses, max_bend in _poses(seed, count(branches.POSES, 2)):
            yield name, partial(_compared, poses, max_bend)
        for kind, make in audit.KINDS.items():
            for block in range(count(AUDITED, 1) * self.plan.rounds):
                numbers = range(block * size, (block + 1) * size)
                yield f"{kind} {block}", partial(_tallied, partial(make, seed), numbers)
        moved = count(MOTIONS, 2)
        for kind, judge in _judges().items():
            for block in range(count(MOVED, 1) * self.plan.rounds):
                yield (
                    f"{kind} {block}",
                    partial(_moved, partial(judge, seed), range(block * moved, (block + 1) * moved)),
                )
        yield WALLS, partial(_through_doors, seed, count(doors.WALLS, 3))
        for block in range(count(BLOCKS, 1) * self.plan.rounds):
            numbers = range(block * size, (block + 1) * size)
            yield f"{self.name} {block}", partial(_tallied, partial(worlds.make, seed), numbers)

    def again(self, pieces: dict[str, Any], doubtful: Collection[tuple[str, str]]) -> Iterator[Piece]:
        """Nothing: the same problems again say nothing new."""
        return iter(())

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Sum up all blocks, and each of the others."""
        pieces = {name: measured for name, measured in pieces.items() if self._only is None or name in self._only}
        blocks = [pieces[name] for name in pieces if name.startswith(f"{self.name} ")]
        audited = {
            kind: Tally.together(pieces[name] for name in pieces if name.rpartition(" ")[0] == kind)
            for kind in audit.KINDS
        }
        tallies = {_arm(n): Tally.together([pieces[_arm(n)]]) for n in ARMS if _arm(n) in pieces}
        lines: list[Line] = []
        if blocks:
            tallies[self.name] = whole = Tally.together(blocks)
            lines += [*whole.speed(SECTION, MISSED, MOST), *whole.claims(SECTION)]
        for n in ARMS:
            if _arm(n) in tallies:
                own = tallies[_arm(n)]
                lines += [
                    *own.speed(THICK, f"{_arm(n)}, {MISSED}", MOST_THICK),
                    own.claim(THICK, f"{_arm(n)}, false claims"),
                ]
        for kind, own in audited.items():
            if own.seconds:
                tallies[kind] = own
                lines += [*own.speed(AUDIT, f"{kind}, {MISSED}", math.inf), own.claim(AUDIT, f"{kind}, false claims")]
        for kind in _judges():
            judged = [each for name in pieces if name.rpartition(" ")[0] == kind for each in pieces[name]["judged"]]
            if judged and kind in calls.KINDS:
                lines += calls.lines_of(kind, [calls.Called(*each) for each in judged])
            elif judged:
                lines += motions.lines_of(kind, [motions.Judged(*each) for each in judged])
        for name in (name for name, *_ in _poses(0, 0) if name in pieces):
            lines += branches.lines_of(name, [branches.Compared(*each) for each in pieces[name]["compared"]])
        if WALLS in pieces:
            lines += doors.lines_of([doors.Passed(*each) for each in pieces[WALLS]["passed"]], self.plan.seed)
        problems = {name: tally.names() for name, tally in tallies.items()}
        busy = max((measured["busy"] for measured in pieces.values()), default=0.0)
        return Findings(lines, data={"problems": problems}, busy=busy)


def _arm(n: int) -> str:
    return f"{n} segments"


def _poses(seed: int, count: int) -> Iterator[tuple[str, list[Target], float]]:
    """Poses at which to hold `solve_all` against a scan, by name; and how far segments bend."""
    yield "P7, poses on a line, bends to pi", branches.line_poses()[: max(count, 1)], math.pi
    yield "random poses (P2), bends to pi", branches.random_poses(seed, count), math.pi
    yield "random poses (P2), bends to 2 pi", branches.random_poses(seed, count // 5), 2.0 * math.pi


def _tallied(make: Callable[[int], World], numbers: range) -> dict[str, Any]:
    """Solve and judge worlds."""
    examine(make(numbers[0]))  # loads what is compiled, which nobody's time should count
    tally, before = Tally(), reference.look()
    for number in numbers:
        tally.add(number, examine(make(number)))
    return {"busy": max(before.busy, reference.look().busy), **tally.plain()}


def _judges() -> dict[str, Callable[[int, int], Sequence[Any]]]:
    """What makes and judges a motion or a call, from a seed and a number, by kind."""
    return {**motions.KINDS, **loaded.KINDS, **calls.KINDS}


def _moved(judge: Callable[[int], Sequence[Any]], numbers: range) -> dict[str, Any]:
    """Make and judge motions, or calls."""
    before = reference.look()
    judged = [list(judge(number)) for number in numbers]
    return {"busy": max(before.busy, reference.look().busy), "judged": judged}


def _compared(poses: list[Target], max_bend: float) -> dict[str, Any]:
    """Hold `solve_all` against the scan."""
    before = reference.look()
    compared = [list(branches.compare(target, max_bend)) for target in poses]
    return {"busy": max(before.busy, reference.look().busy), "compared": compared}


def _through_doors(seed: int, count: int) -> dict[str, Any]:
    """Hold `solve_all` by route against walls with known doors."""
    doors.compare(doors.make(seed, 0))  # loads what is compiled
    before = reference.look()
    passed = [list(doors.compare(doors.make(seed, number))) for number in range(count)]
    return {"busy": max(before.busy, reference.look().busy), "passed": passed}
