"""Bodies that begin thin and grow: in what order, how far, and what comes of it where the place is tight."""

from functools import partial
from types import SimpleNamespace
from typing import Any, cast

import numpy as np

import sinuous as sn
from sinuous.problem.problem import Problem
from sinuous.scene.scene import Scene
from sinuous.solving.options import SolveOptions
from sinuous.solving.solver import Solver
from sinuous.solving.starts import Question
from sinuous.solving.strategy import THINNER_PRICES
from sinuous.solving.thinner import OF_TIME, STEPS, Thinner, with_radii
from tests.helpers import Floats

ROBOT = sn.Robot.uniform(3, (0.8, 1.2), max_bend=2.0, radius=0.1)
TARGET = sn.Target((0.4, 0.2, 2.6))
SHARES = tuple(THINNER_PRICES)


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


def question(seconds: float = 1.0) -> Question:
    return Question(Problem(ROBOT, TARGET), np.zeros((0, 3, 3)), lambda: seconds)


def thinner(solvers: Solvers) -> Thinner:
    return Thinner(ROBOT, SolveOptions(), cast(Any, solvers.prepare))


def test_a_body_grows_from_where_it_was_solved_until_it_is_nearly_as_thick() -> None:
    for share in SHARES:
        solvers = Solvers(1.0)
        (batch,) = thinner(solvers).begun(question(), share)
        shares = [each for each, _ in solvers.asked]
        assert [begun for _, begun in solvers.asked] == [False] + [True] * (len(shares) - 1)
        assert np.allclose(np.diff(shares), (1.0 - share) / STEPS)
        assert 1.0 - (1.0 - share) / STEPS - 1e-9 <= shares[-1] < 1.0
        assert batch.initial.shape == (1, 3, 3)
        assert np.all(batch.initial == shares[-1])


def test_it_goes_as_far_as_it_can_in_shorter_steps() -> None:
    solvers = Solvers(0.87)
    (batch,) = thinner(solvers).begun(question(), 0.7)
    assert 0.85 < batch.initial[0, 0, 0] <= 0.87
    assert len(solvers.asked) < 12


def test_it_leaves_time_and_asks_for_no_thinner_body() -> None:
    left: list[float] = []
    options: list[SolveOptions] = []

    def solve(*_: Any, time: float) -> Answer:
        left.append(time)
        return Answer(False, np.zeros((3, 3)))

    def prepare(*given: Any) -> Any:
        options.append(given[-1])
        return SimpleNamespace(solve=solve)

    source = Thinner(ROBOT, SolveOptions(without=("grown",)), cast(Any, prepare))
    assert not list(source.begun(question(seconds=8.0), 0.7))
    assert left == [(1.0 - OF_TIME) * 8.0]
    assert [each.without for each in options] == [("grown", "thinner")]


def test_nothing_comes_of_it_where_nothing_thin_is_solved_or_time_is_over_or_bodies_are_lines() -> None:
    solvers = Solvers(0.3)
    assert not any(list(thinner(solvers).begun(question(), share)) for share in SHARES)
    assert np.allclose([share for share, _ in solvers.asked], SHARES)
    solvers = Solvers(1.0)
    assert not list(thinner(solvers).begun(question(seconds=0.0), 0.7))
    line = Thinner(with_radii(ROBOT, 0.0), SolveOptions(), cast(Any, solvers.prepare))
    assert not list(line.begun(question(), 0.7))
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
    source = Thinner(ROBOT, SolveOptions(), Solver.prepared)
    assert TARGET.position is not None
    for share in SHARES:
        (batch,) = source.begun(asked, share)
        q = batch.initial[0]
        assert np.linalg.norm(ROBOT.tip(q)[:3, 3] - TARGET.position) < 1e-3
        assert scene.distance(ROBOT.backbone(q, 60)).min() > share * ROBOT.radii[0]
        assert not ROBOT.violations(q)
