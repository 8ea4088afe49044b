"""An interrupted plan of several files: whatever ends it, the same command goes on, and nothing is planned twice."""

import signal
import sys
from pathlib import Path
from typing import Any

import pytest

import sinuous as sn
from sinuous.cli.answers import journal
from sinuous.cli.app import main
from sinuous.motion.motion import Motion
from sinuous.motion.plan import Planner
from tests.cli.going_on import answers, ended_at, lines, whole

ARM = sn.Robot.uniform(3, (0.8, 1.2), max_bend=2, radius=0.05)
BALL = sn.Sphere((0.1, 0, 2), radius=0.2, name="ball")
COMING = sn.Moving(sn.Sphere((0, 0, 0), 0.4, name="coming"), [0, 2, 4], [(0, 0, 2.2), (0, 0, 2.2), (0, 3, 2.2)])
LEFT, RIGHT = ([[bend, 0.0, 1.0]] * 3 for bend in (0.6, -0.6))
JOBS = (
    sn.Job(ARM, sn.Target((-1, 0, 2)), [BALL], start=LEFT),
    sn.Job(ARM, scene=[BALL], start=LEFT, goal=RIGHT),
    sn.Job(ARM, sn.Target((0, 0, 9)), [BALL], start=LEFT),
    sn.Job(ARM, sn.Target((-1, 0, 2)), [BALL], start=[[0.0, 0.0, 1.0]] * 3),
    sn.Job(ARM, scene=[COMING], start=LEFT, goal=RIGHT, rates=sn.Rates(bend=0.8, length=0.3)),
    sn.Job(ARM, sn.Target((-1.5, 0, 1.9)), [COMING], start=LEFT, rates=sn.Rates(bend=0.8, length=0.3)),
)
"""Solved, to a configuration, out of reach, blocked where it starts, and past what moves."""

PROCESS = (
    "import sys, time; from sinuous.cli.answers import journal; from sinuous.cli.app import main;"
    "from sinuous.motion.plan import Planner; journal.EVERY = 0.05; plan = Planner.plan;"
    "Planner.plan = lambda self, *ends: (time.sleep(0.3), plan(self, *ends))[1];"
    "sys.exit(main(sys.argv[1:]))"
)
"""The command line, where every plan takes a little longer, so that the end finds it at work."""


@pytest.fixture
def files(tmp_path: Path) -> list[str]:
    names = [tmp_path / f"{i}.yaml" for i in range(len(JOBS))]
    for job, name in zip(JOBS, names, strict=True):
        job.save(name)
    return [str(name) for name in names]


class Counted:
    """Counts plans, and interrupts the one after so many."""

    def __init__(self, patch: pytest.MonkeyPatch, most: int = 1000) -> None:
        self.count, plan = 0, Planner.plan

        def counting(planner: Planner, *ends: Any) -> Motion:
            if self.count == most:
                raise KeyboardInterrupt
            self.count += 1
            return plan(planner, *ends)

        patch.setattr(Planner, "plan", counting)


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to a process alone")
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGKILL])
def test_a_real_end(end: signal.Signals, files: list[str], tmp_path: Path) -> None:
    out = tmp_path / "out.jsonl"
    kept = ended_at(3, end, PROCESS, ["plan", *files], out) - 1
    assert 2 <= kept < len(JOBS)
    with pytest.MonkeyPatch.context() as patch:
        tried = Counted(patch)
        assert main(["plan", *files, "--out", str(out)]) == 1
    assert tried.count == len(JOBS) - kept  # nothing that was kept is planned again
    assert answers(out) == whole(["plan", *files], tmp_path)
    assert lines(out) == 0


def test_wherever_it_ends(files: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(journal, "EVERY", 0.0)
    expected = whole(["plan", *files], tmp_path)
    out, table = tmp_path / "out.jsonl", tmp_path / "q.csv"
    command = ["plan", *files, "--out", str(out), "--csv", str(table), "--rate", "20"]
    for ended in range(len(JOBS)):
        with monkeypatch.context() as patch:
            Counted(patch, ended)
            assert main(command) == 130
        with monkeypatch.context() as patch:
            tried = Counted(patch, len(JOBS) - ended)
            assert main(command) == 1
            assert tried.count == len(JOBS) - ended
        assert answers(out) == expected
        assert len(list(tmp_path.glob("q-*.csv"))) == len(JOBS)
        assert not list(tmp_path.glob("*.journal"))


def test_what_changed_is_refused(
    files: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out.jsonl"
    command = ["plan", *files, "--out", str(out)]
    with monkeypatch.context() as patch:
        Counted(patch, 2)
        assert main(command) == 130
    capsys.readouterr()
    for more, words in ((["--shortcuts", "3"], "--shortcuts: "), (["--duration", "9"], "--duration: ")):
        assert main([*command, *more]) == 2
        err = capsys.readouterr().err
        assert words in err
        assert "it has changed since this command began" in err
        assert err.count("\n") == 1
    for job, word in (
        (sn.Job(ARM, scene=[BALL], start=LEFT, goal=[[-0.5, 0.0, 1.0]] * 3), "goal"),
        (sn.Job(ARM, scene=[BALL], start=LEFT, goal=RIGHT, rates=sn.Rates(bend=2.0)), "rates"),
    ):
        job.save(files[1])
        assert main(command) == 2
        assert f"1.yaml: {word}: expected " in capsys.readouterr().err
    JOBS[1].save(files[1])
    kept = tmp_path / "out.jsonl.journal"
    first = kept.read_text().splitlines()[0]
    kept.write_text(f'{first}\n{{"problem": 0}}\n')
    assert main(command) == 2
    assert "the journal beside it cannot be read" in capsys.readouterr().err
