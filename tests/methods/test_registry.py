"""What holds for every method that is registered."""

import dataclasses
import inspect
from collections.abc import Mapping
from functools import partial
from typing import Any, ClassVar

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.arguments import MethodName
from sinuous.methods import method as methods
from sinuous.methods.method import LIMITS, METHODS, Options, choice, count, flag, number
from tests.helpers import NOT_NUMBERS, refused, refused_each, with_each
from tests.methods import laws
from tests.methods.laws import quick

ARM = sn.Robot.uniform(5, (45, 70), 2.4)
EASY = sn.Target((60.0, 20.0, 240.0))


@with_each("name", METHODS)
def test_a_method_is_chosen_by_name_or_by_options(name: MethodName) -> None:
    chosen = methods.options_class(name)
    assert methods.name_of(name) == name
    assert methods.with_options(name, []) == name
    assert set(methods.capabilities(name).limits) <= set(LIMITS)
    assert methods.name_of(chosen()) == name
    assert chosen.__name__ == METHODS[name].rpartition(".")[2]
    assert getattr(sn.methods, chosen.__name__) is chosen
    assert chosen.__doc__
    for key in inspect.signature(chosen).parameters:
        assert key in chosen.__doc__, f"{key} is not documented"


@pytest.mark.parametrize("name", METHODS)
def test_a_solved_answer_is_one(name: MethodName) -> None:
    solver = sn.Solver(ARM, method=quick(name, ARM), tolerance=sn.Tolerance(0.5, 0.02))
    solution = solver.solve(EASY)
    assert solution.method == name
    assert solution.solved
    assert solution.verify().ok
    assert solution.q.shape == (5, 3)
    assert solution.to_dict()["method"] == name


@pytest.mark.parametrize(
    ("method", "off", "turn"), [("fabrikc", 1e-3, 1e-6), ("slinki", 0.01, 1e-6), ("dls", 1e-3, 1e-4)]
)
def test_the_papers_poses_better_than_published(method: MethodName, off: float, turn: float) -> None:
    """Published for the first two: within a millimetre, and no error of direction."""
    solver = sn.Solver(laws.ARM, method=method, tolerance=sn.Tolerance(off, turn))
    assert laws.solved_and_verified(solver, laws.PAPER) == 4


@pytest.mark.parametrize(("method", "count", "least"), [("fabrikc", 100, 98), ("slinki", 50, 49)])
@pytest.mark.parametrize("kind", ["position", "direction"])
@pytest.mark.parametrize("max_bend", [1.2, 2.4])
def test_reachable_targets_from_one_start(
    method: MethodName, count: int, least: int, kind: str, max_bend: float
) -> None:
    solver = sn.Solver(laws.ARM, method=method, max_starts=1)
    assert laws.solved_and_verified(solver, laws.tip_targets(laws.ARM, count, max_bend, kind=kind)) >= least


@pytest.mark.parametrize("method", ["dls", "fabrikc", "fabrik_avoid"])
def test_limits_and_starts_and_obstacles(method: MethodName) -> None:
    laws.keeps_its_limits(method, laws.LIMITED)
    laws.begins_from_an_initial_configuration(method)
    laws.does_not_pretend(method)


@with_each("name", METHODS)
def test_what_a_method_does_not_handle_is_refused(name: MethodName) -> None:
    can = methods.capabilities(name)
    upright = np.eye(3)
    cases: tuple[tuple[bool, str, Any], ...] = (
        (can.direction, "target.direction", sn.Target((60, 20, 240), direction=(0, 0, 1))),
        (can.rotation, "target.rotation", sn.Target((60, 20, 240), rotation=upright)),
        (can.orientation_alone and can.direction, "target.position", sn.Target(direction=(0, 0, 1))),
        (can.several_targets, "target.segment", sn.Target((10, 0, 100), segment=2)),
        (can.several_targets, "targets", [EASY, sn.Target((10, 0, 100), segment=2)]),
    )
    solver = sn.Solver(ARM, method=quick(name, ARM), time=0.2)
    for handled, key, target in cases:
        if handled:
            solver.solve(target)
        else:
            refused(key, partial(solver.solve, target), name)
            refused(key, partial(solver.solve_many, [target]), name)
    if not can.tool:
        tooled = sn.Robot.uniform(2, 1.0, tool=sn.pose((0, 0, 1)))
        refused("robot.tool", lambda: sn.Solver(tooled, method=name), name)
    if not can.preferences:
        refused("prefer", lambda: sn.Solver(ARM, method=name, prefer=sn.Preferences(bends=1.0)), name)


def test_what_is_no_method_is_refused() -> None:
    nothing: Any
    for nothing in ("nothing", "", None, 3, Options()):
        refused("method", partial(sn.Solver, ARM, method=nothing), "newton")
    refused("method", lambda: methods.with_options("nothing", []))
    refused("beta", lambda: methods.with_options("newton", ["beta=1"]), "has no options")


def test_a_violated_limit_is_the_worst() -> None:
    """An answer that is out of its limits is never solved, and says which."""
    robot = sn.Robot.uniform(5, (45, 70), 0.26)
    solution = sn.solve(robot, sn.Target((150, -90, 220)), method=sn.methods.OptiPath(restarts=False, bend_weight=0.0))
    assert solution.status is sn.Status.LIMIT_BOUND
    assert not solution.verify().ok
    assert solution.worst is not None
    assert solution.worst.constraint == "bend"
    assert solution.worst.amount == pytest.approx(np.hypot(*solution.q[:, :2].T).max() - 0.26)
    assert "bend of segment" in str(solution.worst)


@dataclasses.dataclass(frozen=True)
class Sample(Options):
    method: ClassVar[str] = "sample"
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = {"slow": {"rate": 0.1, "rounds": 1}}

    rate: float = number(0.5, above=0.0, high=2.0)
    rounds: int = count(3, 1, 10)
    metric: str = choice("second", ("first", "second"))
    careful: bool = flag(True)


def test_what_cannot_be_meant_is_refused() -> None:
    refused_each("rate", [*NOT_NUMBERS, 0.0, -1.0, 2.1], lambda x: Sample(rate=x))
    refused_each("rounds", [0, 11, 2.0, "2", True, None], lambda x: Sample(rounds=x))
    refused_each("metric", ["third", "", None, 1], lambda x: Sample(metric=x), "first or second")
    refused_each("careful", [1, 0, "true", None], lambda x: Sample(careful=x))


def test_options_are_read_as_they_are_typed() -> None:
    assert Sample.parse([]) == Sample()
    typed = Sample.parse(["rate=1e-1", "rounds=7", "metric=first", "careful=False"])
    assert typed == Sample(0.1, 7, "first", False)


def test_a_preset_gives_values_that_others_may_change() -> None:
    assert Sample.parse(["preset=slow"]) == Sample(rate=0.1, rounds=1)
    assert Sample.parse(["rounds=2", "preset=slow"]) == Sample(rate=0.1, rounds=2)
    refused("preset", lambda: Sample.parse(["preset=fast"]), "slow")


def test_what_is_typed_wrongly_is_refused() -> None:
    refused("rate", lambda: Sample.parse(["rate=fast"]))
    refused("rate", lambda: Sample.parse(["rate=nan"]))
    refused("rate", lambda: Sample.parse(["rate=1", "rate=1"]), "twice")
    refused("rounds", lambda: Sample.parse(["rounds=1.5"]))
    refused("careful", lambda: Sample.parse(["careful=maybe"]))
    refused("speed", lambda: Sample.parse(["speed=1"]), "one of rate, rounds, metric, careful, preset")
    refused("", lambda: Sample.parse(["rate"]), "KEY=VALUE")
    refused("rate", lambda: Options.parse(["rate=1"]), "has no options")


def test_a_kernel_sees_numbers_in_the_order_of_the_fields() -> None:
    np.testing.assert_array_equal(Sample().vector(), [0.5, 3.0, 1.0, 1.0])
    np.testing.assert_array_equal(Sample(2.0, 9, "first", False).vector(), [2.0, 9.0, 0.0, 0.0])
