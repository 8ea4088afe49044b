"""A keyword that is not known is refused in a line, wherever it is given, and costs nothing where it is right.

Numbers and lists in sentences.

Tests of processes that work for another one.
"""

import inspect
import signal
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.base import errors
from sinuous.base.system import pool_of
from tests.base.processes import alive, until
from tests.helpers import present, refused, with_each
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


@with_each(("name", "noun"), [each for each in nouns_and_verbs() if inspect.isclass(each[1])])
def test_every_method_refuses_what_it_does_not_have(name: str, noun: type) -> None:
    for key, method in inspect.getmembers_static(noun, inspect.isfunction):
        takes_any = inspect.unwrap(method).__code__.co_flags & inspect.CO_VARKEYWORDS
        if not key.startswith("_") and method.__module__.startswith("sinuous.") and not takes_any:
            refused("nonsense", partial(method, None, nonsense=1), "unknown option")


def test_file_and_path_are_understood_for_each_other() -> None:
    refused("path", lambda: CALLED.Robot.save(ROBOT, path="a.yaml"), "did you mean 'file'?")
    refused("file", ROBOT.save, "missing; expected a value")  # type: ignore[call-arg,arg-type,unused-ignore]
    refused("file", lambda: CALLED.show(ROBOT, file="a.html"), "did you mean 'path'?")
    refused("things", lambda: CALLED.show(things=ROBOT), "expected one of path, got")


@with_each(("name", "public"), nouns_and_verbs)
def test_every_noun_and_verb_says_what_it_lacks(name: str, public: Any) -> None:
    parameters = inspect.signature(public).parameters.values()
    named = [each for each in parameters if each.kind not in (each.VAR_POSITIONAL, each.VAR_KEYWORD)]
    needed = [each.name for each in named if each.default is each.empty]
    if needed:
        assert isinstance(refused(needed[0], public, "missing; expected "), TypeError)


@pytest.mark.parametrize(
    ("call", "key", "words"),
    [
        (
            lambda: CALLED.Mesh.load("part.stl"),
            "scale",
            "missing; expected units of the scene in one of the file: 0.001",
        ),
        (lambda: CALLED.Sphere((0, 0, 0)), "radius", "missing; expected a number"),
        (lambda: CALLED.Robot.uniform(3, 50, max_bnd=2), "max_bnd", "did you mean 'max_bend'?"),
        (lambda: CALLED.Segment(50, max_curve=1), "max_curve", "did you mean 'max_curvature'?"),
        (lambda: CALLED.Tendons(3, 4, ratio=2), "ratio", "did you mean gain"),
        (lambda: CALLED.Robot.uniform(3, 50, gear=2), "gear", "did you mean gain"),
        (lambda: CALLED.Target((0, 0, 1), orientation=(1, 0, 0, 0)), "orientation", "did you mean rotation"),
        (lambda: CALLED.Target((0, 0, 1), quaternion=(1, 0, 0, 0)), "quaternion", "or xyzw=(x, y, z, w)"),
        (lambda: CALLED.solve(ROBOT, (0, 0, 90), timeout=1), "timeout", "did you mean time"),
        (lambda: CALLED.Sphere((0, 0, 0), r=1), "r", "did you mean 'radius'?"),
        (lambda: CALLED.Box((0, 0, 0), extents=1), "extents", "did you mean size"),
        (lambda: CALLED.Box((0, 0, 0), radius=1), "radius", "expected one of center, size"),
        (lambda: CALLED.solve(ROBOT, (0, 0, 90), tol=1), "tol", "did you mean 'tolerance'?"),
        (lambda: CALLED.plan(ROBOT, [[0, 0, 50]] * 2, (0, 0, 90), sede=1), "sede", "did you mean 'seed'?"),
        (lambda: CALLED.Scene([]).update(raduis=2), "raduis", "did you mean 'radius'?"),
        (lambda: CALLED.Solver(ROBOT).solve(), "target", "missing; expected a value"),
        (lambda: CALLED.Solver(ROBOT).solve((0, 0, 90), guess=1), "guess", "did you mean initial"),
        (lambda: CALLED.Solver(ROBOT).step(ROBOT.straight, rate=1), "rate", "did you mean 'rates'?"),
        (lambda: CALLED.studies.reach(ROBOT, spacin=1), "spacin", "did you mean 'spacing'?"),
    ],
)
def test_the_name_that_was_meant_is_said(call: Callable[[], Any], key: str, words: str) -> None:
    refused(key, call, words)


@with_each(
    ("numbers", "count", "text"),
    [
        ([3], 5, "segment 3"),
        ([1, 2], 5, "segments 1 and 2"),
        ([4, 2, 3, 6], 9, "segments 2 to 4 and 6"),
        ([1, 2, 3], 3, "all segments"),
        ([1], 1, "segment 1"),
        ([1, 3, 5], None, "segments 1, 3 and 5"),
    ],
)
def test_segments(numbers: list[int], count: int | None, text: str) -> None:
    assert errors.segments(numbers, count) == text


@with_each(
    ("seconds", "text"),
    [(8.7e-6, "8.7 us"), (87.3e-6, "87.3 us"), (1e-3, "1 ms"), (41.63e-3, "41.6 ms"), (1.0, "1 s"), (11.24, "11.2 s")],
)
def test_times_have_the_unit_that_suits_them(seconds: float, text: str) -> None:
    assert errors.duration(seconds) == text


def test_rounding_up_loses_at_most_a_hundredth() -> None:
    rng = np.random.default_rng(0)
    for value in 10.0 ** rng.uniform(-9, 9, 500):
        up = errors.rounded_up(float(value))
        assert value * (1.0 - 1e-11) <= up <= 1.0101 * value
    assert errors.rounded_up(0.2) == 0.2


PROGRAM = """
import os, time
from sinuous.base.system import pool_of
print(pool_of(1, int).submit(os.getpid).result(), flush=True)
time.sleep(600)
"""


def test_a_process_begins_with_what_it_is_given() -> None:
    with pool_of(1, sys.setrecursionlimit, 777) as pool:
        assert pool.submit(sys.getrecursionlimit).result() == 777


@pytest.mark.parametrize("end", [signal.SIGTERM, getattr(signal, "SIGKILL", signal.SIGTERM)])
def test_a_process_ends_however_its_program_ends(end: signal.Signals) -> None:
    with subprocess.Popen([sys.executable, "-c", PROGRAM], stdout=subprocess.PIPE, text=True) as program:
        worker = int(present(program.stdout).readline())
        assert alive(worker)
        program.send_signal(end)
    assert until(lambda: not alive(worker))
