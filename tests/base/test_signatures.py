"""What `help` shows of public names: kinds of arguments by name, options one by one, and nothing else changed."""

import inspect
import pydoc
import re
from typing import Any

import pytest

import sinuous as sn
from sinuous.motion.plan import PlanArguments
from sinuous.solver.options import SolveArguments
from tests.helpers import refused

SHOWN = [
    name
    for name in sn.__all__
    if callable(getattr(sn, name)) and not issubclass(type(getattr(sn, name)), type(sn.Status))
]
SHOWN = [
    name for name in SHOWN if not (inspect.isclass(getattr(sn, name)) and issubclass(getattr(sn, name), Exception))
]


def test_signatures_name_kinds_of_arguments() -> None:
    for name in SHOWN:
        public = getattr(sn, name)
        own = [value for key, value in vars(public).items() if inspect.isfunction(value) and not key.startswith("_")]
        for each in (public, *(own if inspect.isclass(public) else [])):
            shown = f"{name}: {inspect.signature(each)}"
            assert not re.search(r"numpy|collections\.abc|typing|sinuous\.|ForwardRef|\bTypedDict|'[A-Z]", shown), shown


def test_options_stand_one_by_one() -> None:
    for function in (sn.solve, sn.Solver, sn.Job.solve):
        own = inspect.signature(function).parameters
        assert set(SolveArguments.__annotations__) <= set(own)
    assert set(PlanArguments.__annotations__) <= set(inspect.signature(sn.plan).parameters)
    assert "time: Number = ..." in str(inspect.signature(sn.solve))
    assert "initial: Initial | None = None" in str(inspect.signature(sn.Solver.solve))
    refused("seeds", lambda: sn.solve(sn.Robot.uniform(1, 50), (0, 0, 50), seeds=3))  # type: ignore[call-arg]


@pytest.mark.parametrize("kind", [sn.Tendons, sn.Chambers])
def test_help_of_lines_is_whole(kind: Any) -> None:
    text = pydoc.plain(pydoc.render_doc(kind))
    assert "`Lines`" not in text
    described = set(re.findall(r"^ \|  (\w[\w, ]*) : ", text, re.MULTILINE))
    names = {name for line in described for name in line.split(", ")}
    assert set(inspect.signature(kind).parameters) <= names
