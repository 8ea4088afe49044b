"""Public calls of odd robots: what is refused about its arguments is an answer, what ends otherwise is counted."""

from typing import Any

import numpy as np
import pytest

from benchmarks.wild import calls, odd
from benchmarks.wild.calls import Called
from sinuous.base.errors import InputError


def only(monkeypatch: pytest.MonkeyPatch, error: Exception | None) -> None:
    def make(*_: Any) -> None:
        if error is not None:
            raise error

    monkeypatch.setattr(calls, "CALLS", {"call": (make, ("rates",))})


def test_an_answer_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    only(monkeypatch, None)
    assert calls.called(0, 0) == Called("call", True, "")


@pytest.mark.parametrize("key", ["rates", "rates.acceleration", "rates[2]", "scene"])
def test_a_refusal_of_what_may_be_refused_is_right(monkeypatch: pytest.MonkeyPatch, key: str) -> None:
    only(monkeypatch, InputError(key, "", 1, "2"))
    assert calls.called(0, 0) == Called("call", False, "")


@pytest.mark.parametrize("error", [InputError("initial", "", 1, "2"), IndexError("out of range"), AssertionError("no")])
def test_what_ends_otherwise_is_wrong(monkeypatch: pytest.MonkeyPatch, error: Exception) -> None:
    only(monkeypatch, error)
    found = calls.called(0, 0)
    assert not found.answered
    assert found.false == f"{type(error).__name__} {error}"
    _, line = calls.lines_of("calls", [found, Called("call", True, "")])
    assert (line.reached, line.held) == (1, False)


def test_shapes_are_within_limits() -> None:
    for number in range(30):
        rng = np.random.default_rng(number)
        robot = odd.robot(rng)
        assert not robot.violations(odd.shape(robot, rng))


@pytest.mark.parametrize("what", ["solve", "track", "check", "job"])
def test_every_call_can_be_made(what: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calls, "CALLS", {what: calls.CALLS[what]})
    made = [calls.called(3, number) for number in range(6)]
    assert any(call.answered for call in made)
    assert not any(call.false for call in made)
