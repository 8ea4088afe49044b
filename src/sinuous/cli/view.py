"""The command view: a problem on a page in the browser, or in one file."""

import ipaddress
import sys
import webbrowser
from pathlib import Path

import typer

from sinuous.answer.solution import Solution
from sinuous.base.errors import InputError
from sinuous.cli.app import View
from sinuous.cli.options import SOLVED, as_typed, check_writable
from sinuous.cli.reading import remembered, say_notes
from sinuous.motion.job import Job, load
from sinuous.motion.motion import Motion
from sinuous.solver.memory import Memory
from sinuous.view.page.show import check_page, require_viser, show

TURN = 0.001
"""Seconds after which a thread hands on Python's lock: what answers the mouse shall not wait for what sends."""


def view_file(asked: View) -> int:
    """Show a problem file, with its answer in a file of results where there is one; return the exit code.

    Raises
    ------
    InputError
        When the file or an option is wrong, or viser is missing.
    """
    file, html, demands = asked.file, asked.html, asked.demanded.read()
    if html is not None:
        check_page("--html", html)
        check_writable("--html", html, [file])
    require_viser("view", file)
    alone = is_loopback(asked.host)
    with as_typed(*demands):
        job = load(file, Job).demanding(**demands)
    answer = None if asked.result is None else job.result(asked.result)
    say_notes({file: job.notes})
    with remembered(asked.memory, {file: job.robot}) as known:
        if html is not None:
            show(answer or answer_of(job, known), path=html)
            return SOLVED
        if not alone:
            said = f"whoever reaches {asked.host} can use this page, and read files in"
            typer.echo(f"warning: {said} {Path(file).resolve().parent} by it", err=True)
        return _serve(job, asked, answer, known)


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


def _serve(job: Job, asked: View, answer: Solution | Motion | None, memory: Memory | None) -> int:
    """Serve the page until it is interrupted."""
    from sinuous.view.page.page import Page  # noqa: PLC0415

    job.scene.prepare()
    sys.setswitchinterval(TURN)
    page = Page(job, asked.host, asked.port, answer, memory)
    shown = f"[{asked.host}]" if ":" in asked.host else asked.host
    address = f"http://{shown}:{page.port}"
    try:
        typer.echo(f"{address}  (Ctrl-C ends it)")
        if asked.browser:
            webbrowser.open(address)
        page.wait()
    except KeyboardInterrupt:
        typer.echo("", err=True)
    finally:
        page.stop()
    return SOLVED
