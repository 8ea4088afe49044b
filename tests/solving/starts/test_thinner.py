"""Bodies that begin thin and grow: in what order, how far, and what comes of it where the place is tight."""

from collections.abc import Iterator
from functools import partial
from types import SimpleNamespace
from typing import Any, cast

import numpy as np

import sinuous as sn
from sinuous.kernels.tables import ROUTE, SOURCES
from sinuous.problem.problem import Problem
from sinuous.scene.scene import Scene
from sinuous.solving.options import SolveOptions
from sinuous.solving.solver import ThinSolve
from sinuous.solving.starts.among import A_START
from sinuous.solving.starts.sources import Batch, Question
from sinuous.solving.starts.thinner import OF_TIME, SHARES, STEPS, Thinner, with_radii
from tests.helpers import Floats

ROBOT = sn.Robot.uniform(3, (0.8, 1.2), max_bend=2.0, radius=0.1)
TARGET = sn.Target((0.4, 0.2, 2.6))


class Answer:
    """What a solver says: solved, or not."""

    route = None

    def __init__(self, solved: bool, q: Floats) -> None:
        self.solved, self.q = solved, q


class Solvers:
    """Solve what is thin enough, and keep what was asked: the share of the radius, and whether from somewhere."""

    def __init__(self, most: float) -> None:
        self.asked: list[tuple[float, bool]] = []
        self._most = most

    def prepare(self, robot: sn.Robot, scene: Scene, options: SolveOptions) -> Any:
        return SimpleNamespace(solve=partial(self._solve, robot.radii[0] / ROBOT.radii[0]))

    def _solve(self, share: float, targets: Any, initial: Floats | None, time: float) -> Answer:
        self.asked.append((share, initial is not None))
        return Answer(share <= self._most, np.full((3, 3), share))


class Routes:
    """A source of routes that asks for scattered starts."""

    name = SOURCES[ROUTE]

    def __init__(self, *then: int, laid: int = 1) -> None:
        self._then, self._laid = then, laid

    def batches(self, question: Question) -> Iterator[Batch]:
        for then in self._then:
            yield Batch(self.name, np.zeros((self._laid, 3, 3)), then=then)


def question(several: bool = False, seconds: float = 1.0) -> Question:
    return Question(Problem(ROBOT, TARGET), np.zeros((0, 3, 3)), lambda: seconds, several)


def thinner(solvers: Solvers, *then: int) -> Thinner:
    return Thinner(Routes(*then), ROBOT, SolveOptions(), cast(Any, solvers.prepare))


def test_a_body_grows_from_where_it_was_solved_until_it_is_nearly_as_thick() -> None:
    for share, _ in SHARES:
        solvers = Solvers(1.0)
        (batch,) = thinner(solvers)._begun(question(), share)
        shares = [each for each, _ in solvers.asked]
        assert [begun for _, begun in solvers.asked] == [False] + [True] * (len(shares) - 1)
        assert np.allclose(np.diff(shares), (1.0 - share) / STEPS)
        assert 1.0 - (1.0 - share) / STEPS - 1e-9 <= shares[-1] < 1.0
        assert batch.initial.shape == (1, 3, 3)
        assert np.all(batch.initial == shares[-1])


def test_it_goes_as_far_as_it_can_in_shorter_steps() -> None:
    solvers = Solvers(0.87)
    (batch,) = thinner(solvers)._begun(question(), 0.7)
    assert 0.85 < batch.initial[0, 0, 0] <= 0.87
    assert len(solvers.asked) < 12


def test_it_comes_after_what_routes_have_cost() -> None:
    first, second = (after for _, after in SHARES)
    batches = list(thinner(Solvers(1.0), first - A_START, 0, second, 7).batches(question()))
    assert [len(batch.initial) for batch in batches] == [1, 1, 1, 1, 1, 1]
    assert [batch.then for batch in batches] == [first - A_START, 0, 0, second, 0, 7]
    batches = list(thinner(Solvers(1.0), 0, 1).batches(question()))
    assert [batch.then for batch in batches] == [0, 1, 0, 0]


def test_it_waits_for_a_route_and_leaves_time() -> None:
    source = Thinner(Routes(*[1000] * 3, laid=0), ROBOT, SolveOptions(), cast(Any, Solvers(1.0).prepare))
    assert [len(batch.initial) for batch in source.batches(question())] == [0, 0, 0, 1, 1]
    left: list[float] = []

    def solve(*_: Any, time: float) -> Answer:
        left.append(time)
        return Answer(False, np.zeros((3, 3)))

    def prepare(*_: Any) -> Any:
        return SimpleNamespace(solve=solve)

    list(Thinner(Routes(), ROBOT, SolveOptions(), cast(Any, prepare)).batches(question(seconds=8.0)))
    assert left == [(1.0 - OF_TIME) * 8.0] * len(SHARES)


def test_nothing_comes_of_it_where_nothing_thin_is_solved_or_time_is_over_or_several_are_wanted() -> None:
    solvers = Solvers(0.3)
    assert not list(thinner(solvers).batches(question()))
    assert np.allclose([share for share, _ in solvers.asked], [share for share, _ in SHARES])
    solvers = Solvers(1.0)
    assert not list(thinner(solvers).batches(question(several=True)))
    assert not list(thinner(solvers).batches(question(seconds=0.0)))
    assert not solvers.asked


def test_only_the_radii_change() -> None:
    robot = sn.Robot.uniform(2, (0.8, 1.2), radius=0.1).changed(tool=sn.pose(position=(0, 0, 0.1)), mount=0.2)
    thin = with_radii(robot, 0.5)
    assert thin.radii == tuple(0.5 * radius for radius in robot.radii)
    assert with_radii(thin, 2.0).to_dict() == robot.to_dict()


def test_what_comes_of_it_is_met_and_nearly_clear() -> None:
    """A window that hardly leaves room, and solvers of the library: judged by distances alone."""
    walls = [sn.Box((side * 1.115, 0, 1.6), size=(2, 6, 0.1)) for side in (-1, 1)]
    walls += [sn.Box((0, side * 1.115, 1.6), size=(6, 2, 0.1)) for side in (-1, 1)]
    scene = sn.Scene(walls)
    problem = Problem(ROBOT, TARGET, scene)
    asked = Question(problem, np.zeros((0, 3, 3)), lambda: 20.0)
    source = Thinner(Routes(), ROBOT, SolveOptions(), ThinSolve.prepared)
    batches = list(source.batches(asked))
    assert TARGET.position is not None
    assert len(batches) == len(SHARES)
    for (share, _), batch in zip(SHARES, batches, strict=True):
        q = batch.initial[0]
        assert np.linalg.norm(ROBOT.tip(q)[:3, 3] - TARGET.position) < 1e-3
        assert scene.distance(ROBOT.backbone(q, 60)).min() > share * ROBOT.radii[0]
        assert not ROBOT.violations(q)
