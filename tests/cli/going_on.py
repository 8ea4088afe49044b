"""What tests of interrupted commands look at."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from sinuous.cli.app import main

PATIENCE = 300.0


def ended_at(least: int, end: signal.Signals, program: str, command: list[str], out: Path) -> int:
    """Run a program of Python with these arguments, and end it when its journal has so many lines; return how many."""
    process_of = [sys.executable, "-c", program, *command, "--out", str(out)]
    pipes: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(process_of, **pipes) as process:
        until = time.monotonic() + PATIENCE
        while lines(out) < least:
            assert process.poll() is None, process.communicate()
            assert time.monotonic() < until
            time.sleep(0.005)
        process.send_signal(end)
        err = process.communicate(timeout=60)[1]
    assert process.returncode == (130 if end is signal.SIGINT else -signal.SIGKILL)
    assert ("the same command goes on" in err) == (end is signal.SIGINT)
    return lines(out)


def whole(command: list[str], folder: Path) -> list[Any]:
    """What a command answers that nothing interrupts."""
    main([*command, "--out", str(folder / "whole.jsonl")])
    return answers(folder / "whole.jsonl")


def answers(out: Path) -> list[Any]:
    """What a file of results says, without times."""
    return [untimed(json.loads(line)) for line in out.read_text().splitlines()]


def untimed(values: Any) -> Any:
    if isinstance(values, dict):
        return {key: untimed(value) for key, value in values.items() if key not in ("seconds", "prepare_seconds")}
    return [untimed(value) for value in values] if isinstance(values, list) else values


def lines(out: Path) -> int:
    """Lines of a journal that are whole."""
    file = out.with_name(out.name + ".journal")
    return file.read_bytes().count(b"\n") if file.exists() else 0
