"""What type checkers see of the package: precise types, with which they find mistakes in users' code."""

import inspect
import re
from collections.abc import Iterator
from pathlib import Path
from types import UnionType
from typing import Any, get_args, get_type_hints

import sinuous as sn
from sinuous.base import arguments
from sinuous.base.signatures import Shown
from sinuous.kernels.tables import SOURCES
from sinuous.methods.method import METHODS
from sinuous.methods.opti_path.gradient import OptiPathArguments
from sinuous.model.robot import RobotArguments
from sinuous.model.segment import SegmentArguments
from sinuous.problem.problem import ProblemArguments
from sinuous.problem.target import TargetArguments
from sinuous.solver.options import SolveArguments, SolveOptions
from tests.helpers import with_each
from tests.public import public_names


def test_the_wheel_says_that_it_is_typed() -> None:
    assert (Path(sn.__file__).parent / "py.typed").exists()


RETURN_ANYTHING = {"load", "check"}
"""What depends on a file, or on the shape of an array, which no checker knows."""


def callables() -> Iterator[tuple[str, Any]]:
    """Functions that users call: constructors and methods of public classes, and public functions."""
    for name, noun in public_names():
        if inspect.isclass(noun):
            yield name, noun.__init__
            for key, member in vars(noun).items():
                plain = member.__func__ if isinstance(member, classmethod) else member
                if not key.startswith("_") and inspect.isfunction(plain):
                    yield f"{name}.{key}", plain
        elif inspect.isfunction(noun):
            yield name, noun


def says_nothing(annotation: Any) -> bool:
    annotation = annotation.value if isinstance(annotation, Shown) else annotation
    if isinstance(annotation, str):
        return "Any" in re.split(r"\s*\|\s*", annotation)
    one_of = get_args(annotation) if isinstance(annotation, UnionType) else ()
    return annotation in (Any, inspect.Parameter.empty) or Any in one_of


def test_no_argument_takes_anything() -> None:
    loose = []
    for name, function in callables():
        signature = inspect.signature(function)
        for key, parameter in signature.parameters.items():
            variadic = parameter.kind in (parameter.VAR_KEYWORD, parameter.VAR_POSITIONAL) or parameter.default == ...
            if key not in ("self", "cls") and not variadic and says_nothing(parameter.annotation):
                loose.append(f"{key} of {name}")
        returned = signature.return_annotation
        anything = name.rpartition(".")[2] in RETURN_ANYTHING or returned is signature.empty
        if not anything and says_nothing(returned):
            loose.append(f"what {name} returns")
    assert not loose


def test_words_are_those_that_the_code_has() -> None:
    assert set(get_args(arguments.MethodName)) == set(METHODS)
    assert get_args(arguments.StartKind) == SOURCES


@with_each(
    ("constructor", "keywords"),
    [
        (sn.Robot, RobotArguments),
        (sn.Segment, SegmentArguments),
        (sn.Target, TargetArguments),
        (sn.Problem, ProblemArguments),
        (sn.methods.OptiPath, OptiPathArguments),
        (SolveOptions, SolveArguments),
    ],
)
def test_keyword_arguments_are_those_of_the_constructor(constructor: Any, keywords: Any) -> None:
    parameters = inspect.signature(constructor).parameters
    assert set(get_type_hints(keywords)) == set(parameters)
    if constructor in (sn.Robot, sn.Segment, sn.methods.OptiPath):
        for key, hint in get_type_hints(keywords).items():
            assert hint == parameters[key].annotation, key
