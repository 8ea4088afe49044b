"""An interrupted command: whatever ends it, the same command goes on, and its answers are those of one that was not."""

import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.cli import journal
from sinuous.cli.answers import read_solution, write_solution
from sinuous.cli.app import main
from sinuous.motion.plan import Planner
from sinuous.motion.tracker import Tracker
from sinuous.solver.solver import Solver

PATIENCE = 300.0
"""Seconds until a process that does nothing fails a test."""

ARM = sn.Robot.uniform(3, (0.8, 1.2), max_bend=2, radius=0.05)
BALL = sn.Sphere((0.1, 0, 2), radius=0.2, name="ball")
COMING = sn.Moving(sn.Sphere((0, 0, 0), 0.4, name="coming"), [0, 2, 4], [(0, 0, 2.2), (0, 0, 2.2), (0, 3, 2.2)])
LEFT, RIGHT = ([[bend, 0.0, 1.0]] * 3 for bend in (0.6, -0.6))
RATES = sn.Rates(bend=0.8, length=0.3)


def circle(count: int, out_of_reach: int | None = None) -> list[sn.Target]:
    """Waypoints so near to each other that no way around is planned, which would depend on the clock."""
    angle = 0.3 * np.arange(count)
    places = np.stack([np.cos(angle), np.sin(angle), 2.1 + 0.1 * np.sin(7 * angle)], axis=1)
    if out_of_reach is not None:
        places[out_of_reach] = 0.0, 0.0, 9.0
    return [sn.Target(place) for place in places]


@cache
def jobs() -> dict[str, list[sn.Job]]:
    """What commands are given; not made when tests are collected, since a start is solved for."""
    return {
        "solve": [  # solved, out of reach, among obstacles
            sn.Job(ARM, sn.Target((1, 0, 2))),
            sn.Job(ARM, sn.Target((0, 0, 9)), [BALL]),
            sn.Job(ARM, sn.Target((0.6, 0, 2.2)), [BALL], start=LEFT),
        ],
        "track": [  # short, with a waypoint out of reach, from a start, past what moves
            sn.Job(ARM, scene=[BALL], path=circle(7)),
            sn.Job(ARM, scene=[BALL], path=circle(25, 11)),
            sn.Job(ARM, scene=[BALL], path=circle(5), start=sn.solve(ARM, circle(5)[0], [BALL]).q),
            sn.Job(ARM, scene=[COMING], path=circle(5), times=[0, 1, 2, 3, 4]),
        ],
        "plan": [  # solved, to a configuration, out of reach, blocked where it starts, and past what moves
            sn.Job(ARM, sn.Target((-1, 0, 2)), [BALL], start=LEFT),
            sn.Job(ARM, scene=[BALL], start=LEFT, goal=RIGHT),
            sn.Job(ARM, sn.Target((0, 0, 9)), [BALL], start=LEFT),
            sn.Job(ARM, sn.Target((-1, 0, 2)), [BALL], start=[[0.0, 0.0, 1.0]] * 3),
            sn.Job(ARM, scene=[COMING], start=LEFT, goal=RIGHT, rates=RATES),
            sn.Job(ARM, sn.Target((-1.5, 0, 1.9)), [COMING], start=LEFT, rates=RATES),
        ],
        "solve --all 3": [sn.Job(ARM, sn.Target((1, 0, 2))), sn.Job(ARM, sn.Target((0, 0, 9)))],
    }


STEPS: dict[str, tuple[type[Any], str]] = {
    "solve": (Solver, "solve"),
    "solve --all 3": (Solver, "solve_all"),
    "track": (Tracker, "go_to"),
    "plan": (Planner, "plan"),
}
"""What is called for every entry of a journal."""

COMMANDS = list(STEPS)

SLOWLY = """
import sys, time
from sinuous.cli import journal
from sinuous.cli.app import main
from {module} import {kind}
journal.EVERY = 0.05
step = {kind}.{name}
def slow(self, *arguments, **options):
    time.sleep({seconds})
    return step(self, *arguments, **options)
{kind}.{name} = slow
sys.exit(main(sys.argv[1:]))
"""
"""The command line, where every step takes longer, so that the end finds it at work."""


@pytest.fixture
def command(request: pytest.FixtureRequest, tmp_path: Path) -> list[str]:
    """A command with its files, but without `--out`."""
    names = []
    for i, job in enumerate(jobs()[request.param]):
        names.append(str(tmp_path / f"{i}.yaml"))
        job.save(names[-1])
    return [*request.param.split(), *names]


class Steps:
    """Counts the steps of a command, and interrupts it after so many."""

    def __init__(self, name: str, patch: pytest.MonkeyPatch, most: int = 10**9) -> None:
        self.count = 0
        kind, method = STEPS[name]
        step: Callable[..., Any] = getattr(kind, method)

        def counting(*arguments: Any, **options: Any) -> Any:
            if self.count == most:
                raise KeyboardInterrupt
            self.count += 1
            return step(*arguments, **options)

        patch.setattr(kind, method, counting)


def name_of(command: list[str]) -> str:
    return " ".join(word for word in command if not word.endswith(".yaml"))


def entries(out: Path) -> int:
    """How many entries are kept."""
    chunks = (out.with_name(out.name + ".parts")).glob("chunk-*.npz")
    return sum(len(json.loads(np.load(chunk)["entries"].item())) for chunk in sorted(chunks))


def answers(out: Path) -> list[Any]:
    """What a file of results says, without times."""
    return [untimed(json.loads(line)) for line in out.read_text().splitlines()]


def untimed(values: Any) -> Any:
    if isinstance(values, dict):
        return {key: untimed(value) for key, value in values.items() if key not in ("seconds", "prepare_seconds")}
    return [untimed(value) for value in values] if isinstance(values, list) else values


def whole(command: list[str], folder: Path) -> tuple[int, list[Any]]:
    """What a command answers that is not interrupted, and its exit code."""
    code = main([*command, "--out", str(folder / "whole.jsonl")])
    return code, answers(folder / "whole.jsonl")


@pytest.mark.parametrize("command", COMMANDS, indirect=True)
def test_wherever_it_ends(command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Interrupted again and again: no step is taken twice but the one that was interrupted."""
    with monkeypatch.context() as patch:
        steps = Steps(name_of(command), patch)
        code, expected = whole(command, tmp_path)
    out = tmp_path / "out.jsonl"
    every = 0.0 if "plan" in command else 1.0  # also with chunks of one entry
    monkeypatch.setattr(journal, "EVERY", every)
    for ended in sorted({0, 1, steps.count // 2, steps.count - 1}):
        taken, got = 0, 130
        for most in (ended, 2, 10**9):
            with monkeypatch.context() as patch:
                own = Steps(name_of(command), patch, most)
                got = main([*command, "--out", str(out), "--csv", str(tmp_path / "q.csv")])
            taken += own.count
            if got != 130:
                break
        assert got == code
        assert taken == steps.count
        assert answers(out) == expected
        assert not list(tmp_path.glob("*.parts"))


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to a process alone")
@pytest.mark.parametrize(
    ("command", "seconds", "end"),
    [("track", 0.05, signal.SIGINT), ("plan", 0.3, signal.SIGKILL)],
    indirect=["command"],
)
def test_a_real_end(
    command: list[str], seconds: float, end: signal.Signals, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, (kind, name) = tmp_path / "out.jsonl", STEPS[command[0]]
    program = SLOWLY.format(module=kind.__module__, kind=kind.__name__, name=name, seconds=seconds)
    pipes: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen([sys.executable, "-c", program, *command, "--out", str(out)], **pipes) as process:
        until = time.monotonic() + PATIENCE
        while entries(out) < 3:
            assert process.poll() is None, process.communicate()
            assert time.monotonic() < until
            time.sleep(0.02)
        process.send_signal(end)
        err = process.communicate(timeout=PATIENCE)[1]
    assert process.returncode == (130 if end is signal.SIGINT else -signal.SIGKILL)
    assert ("the same command goes on" in err) == (end is signal.SIGINT)
    kept = entries(out)
    with monkeypatch.context() as patch:
        steps = Steps(command[0], patch)
        code = main([*command, "--out", str(out)])
    with monkeypatch.context() as patch:
        all_steps = Steps(command[0], patch)
        assert (code, answers(out)) == whole(command, tmp_path)
    assert steps.count == all_steps.count - kept  # nothing that was kept is done again
    assert entries(out) == 0


def test_what_is_kept_of_a_solution_is_all_of_it() -> None:
    target = sn.Target((0.6, 0, 2.2))
    solver = sn.Solver(ARM, [BALL])
    for solution in solver.solve_all(target, count=2, by="route"):
        values = json.loads(json.dumps(write_solution(solution)))
        again = read_solution(solver, (target,), None, values)
        assert again.to_dict() == solution.to_dict()
        np.testing.assert_array_equal(again.route, solution.route)


def interrupted(command: list[str], out: Path, most: int, *options: str) -> None:
    with pytest.MonkeyPatch.context() as patch:
        Steps(name_of(command), patch, most)
        assert main([*command, "--out", str(out), *options]) == 130


@pytest.mark.parametrize("command", ["track"], indirect=True)
def test_after_a_loss_of_power_what_is_broken_is_done_again(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(journal, "EVERY", 0.0)
    out = tmp_path / "out.jsonl"
    interrupted(command, out, 5)
    chunk = tmp_path / "out.jsonl.parts" / "chunk-0000002.npz"
    chunk.write_bytes(chunk.read_bytes()[:-20])
    interrupted(command, out, 1)
    assert entries(out) == 3
    assert main([*command, "--out", str(out)]) == 1
    assert answers(out) == whole(command, tmp_path)[1]


@pytest.mark.parametrize(
    ("command", "options", "told"),
    [
        ("solve", ["--seed", "3"], "seed: "),
        ("solve", ["--all", "3"], "--all: "),
        ("track", ["--deviation", "5"], "--deviation: "),
        ("plan", ["--shortcuts", "3"], "--shortcuts: "),
        ("plan", ["--duration", "9"], "--duration: "),
    ],
    indirect=["command"],
)
def test_other_options_are_refused(
    command: list[str], options: list[str], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out.jsonl"
    interrupted(command, out, 1)
    capsys.readouterr()
    assert main([*command, "--out", str(out), *options]) == 2
    err = capsys.readouterr().err
    assert told in err
    assert "it has changed since this command began" in err
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("command", "job", "key"),
    [
        ("solve", sn.Job(ARM, sn.Target((1, 0, 2)), [BALL]), "scene"),
        ("track", sn.Job(ARM, scene=[BALL], path=circle(8)), "path"),
        ("plan", sn.Job(ARM, scene=[BALL], start=LEFT, goal=[[-0.5, 0.0, 1.0]] * 3), "path"),
        ("plan", sn.Job(ARM, sn.Target((-1, 0, 2)), [BALL], start=LEFT, rates=sn.Rates(bend=2.0)), "rates"),
    ],
    indirect=["command"],
)
def test_another_problem_is_refused(
    command: list[str], job: sn.Job, key: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out.jsonl"
    interrupted(command, out, 1)
    job.save(tmp_path / "0.yaml")
    capsys.readouterr()
    assert main([*command, "--out", str(out)]) == 2
    assert f"0.yaml: {key}: it has changed since this command began; expected " in capsys.readouterr().err


@pytest.mark.parametrize("command", ["plan"], indirect=True)
def test_what_cannot_be_read_is_refused_in_a_line(
    command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out.jsonl"
    interrupted(command, out, 2)
    folder = tmp_path / "out.jsonl.parts"
    for text in ('[{"problem": 0}]', "[3]", "no JSON"):
        np.savez(folder / "chunk-0000000.npz", entries=np.array(text.encode()))
        assert main([*command, "--out", str(out)]) == 2
        err = capsys.readouterr().err
        assert "what is kept beside it cannot be read" in err.splitlines()[-1]
    (folder / "record.json").write_text("no record")
    assert main([*command, "--out", str(out)]) == 2
    assert "--out: " in capsys.readouterr().err


@pytest.mark.parametrize("command", ["track"], indirect=True)
def test_nothing_is_left_where_nothing_was_interrupted(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(journal, "EVERY", 0.0)
    assert main([*command[:2], "--out", str(tmp_path / "out.jsonl")]) == 0
    assert not list(tmp_path.glob("*.parts"))
