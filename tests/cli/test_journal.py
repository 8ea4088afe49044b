"""An interrupted command: whatever ends it, the same command goes on, and its answers are those of one that was not."""

import json
import signal
import sys
import time
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.cli import journal
from sinuous.cli.work import read_solution, write_solution
from sinuous.motion.tracker import Tracker
from tests.base.processes import Command, until
from tests.cli.conftest import Run

ARM = sn.Robot.uniform(3, (0.8, 1.2), max_bend=2, radius=0.05)
BALL = sn.Sphere((0.1, 0, 2), radius=0.2, name="ball")
COMING = sn.Moving(sn.Sphere((0, 0, 0), 0.4, name="coming"), [0, 2, 4], [(0, 0, 2.2), (0, 0, 2.2), (0, 3, 2.2)])
LEFT, RIGHT = ([[bend, 0.0, 1.0]] * 3 for bend in (0.6, -0.6))
RATES = sn.Rates(bend=0.8, length=0.3)
OUT, PARTS = Path("out.jsonl"), Path("out.jsonl.parts")


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
        "track": [  # from a start, with a waypoint out of reach, past what moves
            sn.Job(ARM, scene=[BALL], path=circle(5), start=sn.solve(ARM, circle(5)[0], [BALL]).q),
            sn.Job(ARM, scene=[BALL], path=circle(25, 11)),
            sn.Job(ARM, scene=[COMING], path=circle(5), times=[0, 1, 2, 3, 4]),
        ],
        "plan": [  # solved, to a configuration, blocked where it starts, and past what moves
            sn.Job(ARM, sn.Target((-1, 0, 2)), [BALL], start=LEFT),
            sn.Job(ARM, scene=[BALL], start=LEFT, goal=RIGHT),
            sn.Job(ARM, sn.Target((-1, 0, 2)), [BALL], start=[[0.0, 0.0, 1.0]] * 3),
            sn.Job(ARM, sn.Target((-1.5, 0, 1.9)), [COMING], start=LEFT, rates=RATES),
        ],
        "solve --all 3": [sn.Job(ARM, sn.Target((1, 0, 2))), sn.Job(ARM, sn.Target((0, 0, 9)))],
    }


STEPS: dict[str, tuple[type[Any], str]] = {
    "solve": (sn.Solver, "solve"),
    "solve --all 3": (sn.Solver, "solve_all"),
    "track": (Tracker, "go_to"),
    "plan": (sn.Planner, "plan"),
}
"""What is called for every entry of a journal."""


def take_longer(command: str, seconds: float) -> None:
    """Let every step of a command take longer, so that the end finds it at work."""
    kind, name = STEPS[command]
    journal.WRITE_SECONDS = 0.05
    step = getattr(kind, name)

    def slow(self: Any, *arguments: Any, **options: Any) -> Any:
        time.sleep(seconds)
        return step(self, *arguments, **options)

    setattr(kind, name, slow)


def typed(command: str) -> str:
    """Write the files of a command, and return what is typed."""
    for i, job in enumerate(jobs()[command]):
        job.save(f"{i}.yaml")
    return " ".join([command, *(f"{i}.yaml" for i in range(len(jobs()[command])))])


class Steps:
    """Counts the steps of a command within, and interrupts it after so many."""

    def __init__(self, command: str, most: int = 10**9) -> None:
        self.count, self._most, self._patch = 0, most, pytest.MonkeyPatch()
        self._kind, self._name = STEPS[command]

    def __enter__(self) -> "Steps":
        step: Callable[..., Any] = getattr(self._kind, self._name)

        def counting(*arguments: Any, **options: Any) -> Any:
            if self.count == self._most:
                raise KeyboardInterrupt
            self.count += 1
            return step(*arguments, **options)

        self._patch.setattr(self._kind, self._name, counting)
        return self

    def __exit__(self, *_: object) -> None:
        self._patch.undo()


def entries() -> int:
    """How many entries are kept."""
    return sum(len(json.loads(np.load(chunk)["entries"].item())) for chunk in sorted(PARTS.glob("chunk-*.npz")))


def answers(out: Path = OUT) -> list[Any]:
    """What a file of results says, without times."""
    return [untimed(json.loads(line)) for line in out.read_text().splitlines()]


def untimed(values: Any) -> Any:
    if isinstance(values, dict):
        return {key: untimed(value) for key, value in values.items() if key not in ("seconds", "prepare_seconds")}
    return [untimed(value) for value in values] if isinstance(values, list) else values


def interrupted(run: Run, command: str, most: int) -> str:
    """Interrupt a command after so many steps, and return what was typed."""
    own = typed(command)
    with Steps(command, most):
        run(f"{own} --out {OUT}", 130)
    return own


@pytest.mark.parametrize(("command", "code"), [("solve", 1), ("track", 1), ("plan", 1), ("solve --all 3", 1)])
def test_wherever_it_ends(run: Run, command: str, code: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Interrupted again and again: no step is taken twice but the one that was interrupted."""
    own = typed(command)
    with Steps(command) as whole:
        run(f"{own} --out whole.jsonl", code)
    monkeypatch.setattr(journal, "WRITE_SECONDS", 0.0 if command == "plan" else 1.0)  # also with chunks of one entry
    for ended in sorted({0, 1, whole.count // 2, whole.count - 1}):
        taken = 0
        for most in (ended, 2, 10**9):
            with Steps(command, most) as steps:
                finished = taken + most >= whole.count
                run(f"{own} --out {OUT} --csv q.csv", code if finished else 130)
            taken += steps.count
            if finished:
                break
        assert taken == whole.count
        assert answers() == answers(Path("whole.jsonl"))
        assert not PARTS.exists()


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to a process alone")
@pytest.mark.parametrize(("command", "seconds", "end"), [("track", 0.05, signal.SIGINT), ("plan", 0.3, signal.SIGKILL)])
def test_a_real_end(run: Run, command: str, seconds: float, end: signal.Signals) -> None:
    own = typed(command)
    process = Command([*own.split(), "--out", str(OUT)], Path.cwd(), partial(take_longer, command, seconds))
    assert until(lambda: entries() >= 3 or process.code is not None)
    assert process.code is None
    process.send(end)
    err = process.said()
    assert process.code == (130 if end is signal.SIGINT else -signal.SIGKILL)
    assert ("the same command goes on" in err) == (end is signal.SIGINT)
    assert "Traceback" not in err
    kept = entries()
    with Steps(command) as steps:
        run(f"{own} --out {OUT}", 1)
    with Steps(command) as whole:
        run(f"{own} --out whole.jsonl", 1)
    assert answers() == answers(Path("whole.jsonl"))
    assert steps.count == whole.count - kept  # nothing that was kept is done again
    assert not PARTS.exists()


def test_what_is_kept_of_a_solution_is_all_of_it() -> None:
    target = sn.Target((0.6, 0, 2.2))
    solver = sn.Solver(ARM, [BALL])
    for solution in solver.solve_all(target, count=2, by="route"):
        values = json.loads(json.dumps(write_solution(solution)))
        again = read_solution(solver, (target,), None, values)
        assert again.to_dict() == solution.to_dict()
        np.testing.assert_array_equal(again.route, solution.route)


@pytest.mark.parametrize(
    ("command", "job", "key"),
    [
        ("solve", sn.Job(ARM, sn.Target((1, 0, 2)), [BALL]), "scene"),
        ("track", sn.Job(ARM, scene=[BALL], path=circle(8)), "path"),
        ("plan", sn.Job(ARM, scene=[BALL], start=LEFT, goal=[[-0.5, 0.0, 1.0]] * 3), "path"),
        ("plan", sn.Job(ARM, sn.Target((-1, 0, 2)), [BALL], start=LEFT, rates=sn.Rates(bend=2.0)), "rates"),
    ],
)
def test_another_problem_is_refused(run: Run, command: str, job: sn.Job, key: str) -> None:
    own = interrupted(run, command, 1)
    job.save("0.yaml")
    assert f"0.yaml: {key}: it has changed since this command began; expected " in run(f"{own} --out {OUT}", 2).err


def test_what_cannot_be_read_is_refused_in_a_line(run: Run) -> None:
    own = interrupted(run, "plan", 2)
    for text in ('[{"problem": 0}]', "[3]", "no JSON"):
        np.savez(PARTS / "chunk-0000000.npz", entries=np.array(text.encode()))
        said = run(f"{own} --out {OUT}", 2).err
        assert "what is kept beside it cannot be read" in said.splitlines()[-1]
    (PARTS / "record.json").write_text("no record")
    assert "--out: " in run(f"{own} --out {OUT}", 2).err
