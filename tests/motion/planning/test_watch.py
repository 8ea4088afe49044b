"""The seconds of a plan, but for those of compiling."""

import pytest

from sinuous.motion.planning.watch import Watch


def test_what_is_compiled_meanwhile_does_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [10.0]
    monkeypatch.setattr("sinuous.motion.planning.watch.clock.perf_counter", lambda: now[0])
    spent = Watch(5.0)
    now[0] += 1.0
    assert (spent.seconds, spent.seconds_left()) == (1.0, 4.0)
    with spent.stopped():
        now[0] += 30.0
    assert (spent.seconds, spent.seconds_left()) == (1.0, 4.0)
    now[0] += 7.0
    spent.but_for(2.0)
    assert (spent.seconds, spent.seconds_left()) == (2.0, 3.0)
