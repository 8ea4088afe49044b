"""An interrupted track: whatever ends it, the same command goes on, and the answer is that of one that nobody ended."""

import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.cli.answers import journal
from sinuous.cli.app import main
from sinuous.motion.tracker import Tracker
from sinuous.solution.solution import Solution
from tests.cli.going_on import answers, ended_at, lines, whole

WAYPOINTS = 1500
ARM = sn.Robot.uniform(4, (45, 70), max_bend=1.5, radius=4)
BALL = sn.Sphere((40, 0, 180), radius=15, name="ball")

SLOWLY = (
    "import sys, time; from sinuous.cli.answers import journal; from sinuous.cli.app import main;"
    "from sinuous.motion.tracker import Tracker; journal.EVERY = 0.05; go_to = Tracker.go_to;"
    "Tracker.go_to = lambda self, targets: (time.sleep(0.005), go_to(self, targets))[1];"
    "sys.exit(main(sys.argv[1:]))"
)
"""The command line, where every waypoint takes a little longer, so that the end finds it at work."""


def circle(count: int, out_of_reach: int | None = None) -> list[sn.Target]:
    angle = np.linspace(0.0, 4.0 * np.pi, count)
    places = np.stack([70 * np.cos(angle), 70 * np.sin(angle), 200 + 10 * np.sin(7 * angle)], axis=1)
    if out_of_reach is not None:
        places[out_of_reach] = 0.0, 0.0, 1000.0
    return [sn.Target(place) for place in places]


@pytest.fixture
def files(tmp_path: Path) -> list[str]:
    """A short path, a long one with a waypoint that nothing reaches, and the short one from a start."""
    paths = {"short": circle(7), "long": circle(WAYPOINTS, 40), "begun": circle(5)}
    for name, path in paths.items():
        start = sn.solve(ARM, path[0], [BALL]).q if name == "begun" else None
        sn.Job(ARM, scene=[BALL], path=path, start=start).save(tmp_path / f"{name}.yaml")
    return [str(tmp_path / f"{name}.yaml") for name in paths]


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to a process alone")
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGKILL])
def test_a_real_end(end: signal.Signals, files: list[str], tmp_path: Path) -> None:
    out = tmp_path / "out.jsonl"
    kept = ended_at(60, end, SLOWLY, ["track", *files], out) - 1
    assert 60 <= kept + 1 < WAYPOINTS
    tried = counted()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Tracker, "go_to", tried.go_to)
        assert main(["track", *files, "--out", str(out)]) == 1
    assert tried.count == 7 + WAYPOINTS + 5 - kept  # nothing that was kept is done again
    assert answers(out) == whole(["track", *files], tmp_path)
    assert lines(out) == 0


class counted:  # noqa: N801
    """Counts waypoints that are solved."""

    def __init__(self) -> None:
        self.count, go_to = 0, Tracker.go_to

        def counting(tracker: Tracker, targets: Any) -> Solution:
            self.count += 1
            return go_to(tracker, targets)

        self.go_to: Callable[..., Solution] = counting


@pytest.mark.parametrize("ended", [0, 1, 6, 7, 8, 47, 48, 49, 100])
def test_wherever_it_ends(ended: int, files: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sn.Job(ARM, scene=[BALL], path=circle(60, 40)).save(files[1])
    expected = whole(["track", *files], tmp_path)
    out, tried = tmp_path / "out.jsonl", counted()

    def interrupted(tracker: Tracker, targets: Any) -> Solution:
        if tried.count == ended:
            raise KeyboardInterrupt
        return tried.go_to(tracker, targets)

    code = None
    for _ in range(3):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(Tracker, "go_to", interrupted)
            code = main(["track", *files, "--out", str(out), "--csv", str(tmp_path / "q.csv")])
            tried.count = 0
        if code != 130:
            break
    while code == 130:
        code = main(["track", *files, "--out", str(out), "--csv", str(tmp_path / "q.csv")])
    assert code == 1
    assert answers(out) == expected
    assert not list(tmp_path.glob("*.journal"))


def interrupt_after(count: int, patch: pytest.MonkeyPatch, command: list[str]) -> None:
    tried = counted()

    def interrupted(tracker: Tracker, targets: Any) -> Solution:
        if tried.count == count:
            raise KeyboardInterrupt
        return tried.go_to(tracker, targets)

    with patch.context() as own:
        own.setattr(Tracker, "go_to", interrupted)
        assert main(command) == 130


def test_a_line_that_is_not_whole_is_done_again(
    files: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    command = ["track", files[0], "--out", str(tmp_path / "out.jsonl")]
    interrupt_after(5, monkeypatch, command)
    kept = tmp_path / "out.jsonl.journal"
    kept.write_bytes(kept.read_bytes()[:-20])
    interrupt_after(1, monkeypatch, command)
    assert lines(tmp_path / "out.jsonl") == 1 + 5
    assert main(command) == 0
    assert answers(tmp_path / "out.jsonl") == whole(["track", files[0]], tmp_path)


def test_what_changed_is_refused(
    files: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out.jsonl"
    command = ["track", files[0], "--out", str(out)]
    interrupt_after(3, monkeypatch, command)
    capsys.readouterr()
    for more, words in ((["--seed", "3"], "seed: "), (["--deviation", "5"], "--deviation: ")):
        assert main([*command, *more]) == 2
        err = capsys.readouterr().err
        assert words in err
        assert "it has changed since this command began" in err
        assert err.count("\n") == 1
    sn.Job(ARM, scene=[BALL], path=circle(8)).save(files[0])
    assert main(command) == 2
    assert "short.yaml: path: expected " in capsys.readouterr().err
    (tmp_path / "out.jsonl.journal").write_text("{}\n")
    assert main(command) == 2
    (tmp_path / "out.jsonl.journal").write_text("what is this\n")
    assert main(command) == 2
    assert "the journal beside it cannot be read" in capsys.readouterr().err


def test_nothing_is_left_where_nothing_was_interrupted(files: list[str], tmp_path: Path) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(journal, "EVERY", 0.0)
        assert main(["track", files[0], "--out", str(tmp_path / "out.jsonl")]) == 0
    assert not list(tmp_path.glob("*.journal"))
