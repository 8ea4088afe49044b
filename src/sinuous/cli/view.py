"""The command view: a problem on a page in the browser, or in one file."""

import ipaddress
import sys
import webbrowser
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import typer

from sinuous.cli.options import SOLVED, as_typed, check_writable
from sinuous.cli.reading import remembered, say_notes
from sinuous.errors import InputError
from sinuous.motion.job import Job, load
from sinuous.motion.motion import Motion
from sinuous.solution.solution import Solution
from sinuous.solving.memory import Memory
from sinuous.viewer.show import check_page, require_viser, show

TURN = 0.001
"""Seconds after which a thread hands on Python's lock: what answers the mouse shall not wait for what sends."""


def view_file(
    file: str,
    html: Path | None,
    host: str,
    port: int,
    result: Path | None = None,
    *,
    browser: bool,
    memory: Path | None = None,
    demands: Mapping[str, Any],
) -> int:
    """Show a problem file, with its answer in a file of results where there is one; return the exit code.

    `memory` is a file of shapes to begin from, which is written in the end. `demands` are clearances that are typed,
    which replace those of the file.

    Raises
    ------
    InputError
        When the file or an option is wrong, or viser is missing.
    """
    if html is not None:
        check_page("--html", html)
        check_writable("--html", html, [file])
    require_viser("view", file)
    alone = is_loopback(host)
    with as_typed(*demands):
        job = load(file, Job).demanding(**demands)
    answer = None if result is None else job.result(result)
    say_notes({file: job.notes})
    with remembered(memory, {file: job.robot}) as known:
        if html is not None:
            show(answer or answer_of(job, known), path=html)
            return SOLVED
        if not alone:
            folder = Path(file).resolve().parent
            typer.echo(f"warning: whoever reaches {host} can use this page, and read files in {folder} by it", err=True)
        return _serve(job, host, port, browser, answer, known)


def answer_of(job: Job, memory: Memory | None = None) -> Solution | Motion:
    """The path followed, the motion to the goal or past obstacles that move, or the target met."""
    if job.is_path:
        return job.track(memory=memory)
    moves = job.goal is not None or job.scene.snapshot().moves
    return job.plan(memory=memory) if moves else job.solve(memory=memory)


def is_loopback(host: str) -> bool:
    """Whether an address is reached from this machine alone.

    Raises
    ------
    InputError
        When it is none.
    """
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        raise InputError("--host", "", host, "an address like 127.0.0.1, or localhost") from None


def _serve(
    job: Job, host: str, port: int, browser: bool, answer: Solution | Motion | None, memory: Memory | None
) -> int:
    """Serve the page until it is interrupted."""
    from sinuous.viewer.page import Page  # noqa: PLC0415

    job.scene.prepare()
    sys.setswitchinterval(TURN)
    page = Page(job, host, port, answer, memory)
    shown = f"[{host}]" if ":" in host else host
    address = f"http://{shown}:{page.port}"
    try:
        typer.echo(f"{address}  (Ctrl-C ends it)")
        if browser:
            webbrowser.open(address)
        page.wait()
    except KeyboardInterrupt:
        typer.echo("", err=True)
    finally:
        page.stop()
    return SOLVED
