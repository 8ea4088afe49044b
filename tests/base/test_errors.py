"""A keyword that is not known is refused in a line, wherever it is given, and costs nothing where it is right."""

import inspect
from collections.abc import Callable
from typing import Any

import pytest

import sinuous as sn
from tests.cases import with_each
from tests.helpers import refused
from tests.public import public_names

ROBOT = sn.Robot.uniform(2, 50)
CALLED: Any = sn

LEFT = {"Solution", "Status", "SuspiciousInput", "studies.Reach", "studies.Verdict"}
"""What users do not make."""


def nouns_and_verbs() -> list[tuple[str, Any]]:
    made_here = [(name, value) for name, value in public_names() if name not in LEFT]
    return [(name, value) for name, value in made_here if not hasattr(value, "_fields") and "Error" not in name]


@with_each(("name", "public"), nouns_and_verbs)
def test_every_noun_and_verb_refuses_what_it_does_not_have(name: str, public: Any) -> None:
    own = inspect.isfunction(public) or "__init__" in {
        key for kind in public.__mro__ if kind.__module__.startswith("sinuous.") for key in vars(kind)
    }
    if own:
        error = refused("nonsense", lambda: public(nonsense=1), "unknown option")
        assert isinstance(error, TypeError)  # as Python says it of other functions


@pytest.mark.parametrize(
    ("call", "key", "words"),
    [
        (lambda: CALLED.Robot.uniform(3, 50, max_bnd=2), "max_bnd", "did you mean 'max_bend'?"),
        (lambda: CALLED.Segment(50, max_curve=1), "max_curve", "did you mean 'max_curvature'?"),
        (lambda: CALLED.Tendons(3, 4, ratio=2), "ratio", "did you mean gain"),
        (lambda: CALLED.Robot.uniform(3, 50, gear=2), "gear", "did you mean gain"),
        (lambda: CALLED.Target((0, 0, 1), orientation=(1, 0, 0, 0)), "orientation", "did you mean rotation"),
        (lambda: CALLED.Target((0, 0, 1), quaternion=(1, 0, 0, 0)), "quaternion", "or xyzw=(x, y, z, w)"),
        (lambda: CALLED.solve(ROBOT, (0, 0, 90), timeout=1), "timeout", "did you mean time"),
        (lambda: CALLED.plan(ROBOT, [[0, 0, 50]] * 2, (0, 0, 90), sede=1), "sede", "did you mean 'seed'?"),
        (lambda: CALLED.Scene([]).update(raduis=2), "raduis", "did you mean 'radius'?"),
        (lambda: CALLED.studies.reach(ROBOT, spacin=1), "spacin", "did you mean 'spacing'?"),
    ],
)
def test_the_name_that_was_meant_is_said(call: Callable[[], Any], key: str, words: str) -> None:
    refused(key, call, words)
