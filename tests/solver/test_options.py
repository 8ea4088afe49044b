"""The options of a solve: each is checked, each has its default, and old names are answered with new ones."""

from typing import Any

import pytest

import sinuous as sn
from sinuous.solver.options import SolveOptions
from tests.cases import with_each
from tests.helpers import refused

ROBOT = sn.Robot.uniform(2, 1.0)
WRONG: dict[str, tuple[Any, ...]] = {
    "tolerance": (0.1, "fine", (0.1, 0.1), True),
    "prefer": ("short", 1.0, {"bends": 1.0}),
    "time": (-1.0, float("nan"), float("inf"), "1", True, None),
    "max_starts": (0, -3, 1.5, "9", True, 10**10),
    "seed": (-1, 2**31, 0.5, "0", False, None),
    "routes": (0, 1, "yes", None),
    "without": ("hops", ("grown", "hops"), 7, None),
    "memory": ("arm.npz", 7),
}


def test_every_field_is_kept() -> None:
    given: dict[str, Any] = {
        "tolerance": sn.Tolerance(1e-3, 1e-2),
        "method": "dls",
        "prefer": sn.Preferences(bends=1.0),
        "time": 0.5,
        "max_starts": 7,
        "seed": 3,
        "routes": False,
        "without": ("gates",),
        "memory": sn.Memory(ROBOT),
        "clearance": 0.5,
        "self_clearance": 0.25,
    }
    assert set(given) == set(SolveOptions.__dataclass_fields__)
    options = SolveOptions.of(given)
    assert vars(options) == given
    assert sn.Solver(ROBOT, **{**given, "method": "newton"}).options.seed == 3


@with_each(("key", "value"), [(key, value) for key, values in WRONG.items() for value in values])
def test_wrong_values_are_refused_by_name(key: str, value: Any) -> None:
    refused(key, lambda: SolveOptions(**{key: value}))


@pytest.mark.parametrize(
    ("guess", "meant"), [("obstacles", "scene"), ("guess", "initial"), ("timeout", "time"), ("tolerances", "tolerance")]
)
def test_an_option_that_is_guessed_is_answered_with_what_is_meant(guess: str, meant: str) -> None:
    given: Any = {guess: 1}
    refused(guess, lambda: sn.solve(ROBOT, (0.0, 0.0, 1.0), **given), meant)
