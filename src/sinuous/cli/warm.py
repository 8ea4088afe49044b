"""The command warm: compile everything now, so that nobody waits for it later."""

import multiprocessing
import signal
import time as clock
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, wait
from typing import Any

import numba
import typer

from sinuous.base import checks
from sinuous.base.errors import InputError
from sinuous.base.processes import pool_of
from sinuous.base.progress import ProgressBar
from sinuous.cli.app import Warm
from sinuous.cli.options import INTERRUPTED, SOLVED
from sinuous.cli.warm_steps import FIRST_COMMAND, WarmStep, steps
from sinuous.kernels.compile import code_first, cores
from sinuous.kernels.compile.pieces import Piece, told_to
from sinuous.kernels.compile.sources import COMPILER
from sinuous.kernels.compile.store import CACHE, clear, size_of
from sinuous.kernels.compile.targets import shipped
from sinuous.kernels.compile.tiers import TOOK
from sinuous.methods.method import METHODS


def warm_up(asked: Warm) -> int:
    """Compile what methods need, by default all, or show or empty what is compiled; return the exit code.

    Raises
    ------
    InputError
        When there is no such method, or options contradict each other.
    """
    typed = [name for name in ("where", "clear", "profile") if getattr(asked, name)]
    if len(typed) > 1 or (asked.method and typed not in ([], ["profile"])):
        named = [f"--{name}" for name in [*typed, *(["method"] if asked.method else [])]]
        raise InputError(named[0], f"cannot be combined with {named[1]}", True, f"one of {named[0]}, {named[1]}")
    if asked.where:
        return _show_store()
    if asked.clear:
        typer.echo(f"{clear(CACHE)} compiled kernels removed from {CACHE}")
        return SOLVED
    methods = tuple(asked.method or METHODS)
    for name in methods:
        checks.choice("--method", name, tuple(METHODS))
    return _profile(steps(methods)) if asked.profile else _compile(methods)


def _compile(methods: tuple[str, ...]) -> int:
    """Compile what these methods need."""
    listed = steps(methods)
    if COMPILER == "numba":
        typer.echo(f"sinuous: kernels are compiled by Numba {numba.__version__} alone, which takes longer", err=True)
    began = clock.perf_counter()
    shared = min(cores(), len(listed))
    try:
        with _Shown(len(listed)) as shown:
            if shared > 1:
                _use_in_processes(shared, methods, shown)
            else:
                _use_here(listed, shown)
    except KeyboardInterrupt:
        typer.echo(f"sinuous: interrupted after {shown.done} of {len(listed)}; what is compiled stays so", err=True)
        return INTERRUPTED
    seconds = clock.perf_counter() - began
    typer.echo(f"everything is compiled, in {seconds:.0f} s" if shown.compiled else "everything was compiled before")
    return SOLVED


def _show_store() -> int:
    """Say where compiled kernels are kept, how many they are, and what is shipped."""
    count, size = size_of(CACHE)
    typer.echo(f"{CACHE}: {count} files, {size / 1e6:.1f} MB")
    for folder, _ in shipped():
        typer.echo(f"{folder}: {size_of(folder)[0]} files, shipped")
    return SOLVED


def _profile(listed: list[WarmStep]) -> int:
    """Compile what is missing, one after the other, and print the CPU time of each entry."""
    first = [step for step in listed if step.what in FIRST_COMMAND]
    with _Shown(len(listed)) as shown:
        _use_here(first, shown)
        taken = sum(seconds for _, seconds in TOOK)
        _use_here([step for step in listed if step not in first], shown)
    for name, seconds in sorted(TOOK, key=lambda one: -one[1]):
        typer.echo(f"{seconds:7.2f} s  {name}")
    whole = sum(seconds for _, seconds in TOOK)
    typer.echo(f"{whole:7.2f} s of CPU for {len(TOOK)} entries; kernels count where they came first")
    typer.echo(f"{taken:7.2f} s of CPU for those of the first command of the README")
    return SOLVED


def _use_here(listed: list[WarmStep], shown: "_Shown") -> None:
    """Take one step after the other."""
    with code_first(), told_to(shown.compiling):
        for step in listed:
            shown.begin(step)
            step.use()
            shown.end()


def _use_in_processes(count: int, methods: tuple[str, ...], shown: "_Shown") -> None:
    """Take the steps in so many processes, which share what they compile through the disk."""
    said: Any = multiprocessing.get_context("spawn").SimpleQueue()
    pool = pool_of(count, _begin, said)
    try:
        listed = steps(methods)
        due = {pool.submit(_use, methods, i): step for i, step in enumerate(listed)}
        while due:
            done, _ = wait(due, timeout=0.1, return_when=FIRST_COMPLETED)
            while not said.empty():
                shown.compiling(said.get())
            for one in done:
                due.pop(one)
                one.result()
                shown.end()
            if done and due:
                shown.begin(next(iter(due.values())))
    except BaseException:
        for child in multiprocessing.active_children():
            child.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _begin(said: Any) -> None:
    """Begin a process: tell the first one what is compiled, and let an interrupt end it without a word."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    _tell.append(said.put)


def _use(methods: tuple[str, ...], i: int) -> None:
    """Take a step in a process of the pool."""
    with code_first(), told_to(_tell[-1]):
        steps(methods)[i].use()


_tell: list[Callable[[Piece], None]] = []
"""In a process of the pool: how the first one is told what is compiled."""


class _Shown:
    """Shows what is compiled, how many are done and for how long: as a bar, or in lines where nobody looks at one."""

    def __init__(self, total: int) -> None:
        self.total, self.done, self.compiled = total, 0, 0
        self._bar = ProgressBar(total, what="loading")

    def __enter__(self) -> "_Shown":
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.__exit__()

    def begin(self, step: WarmStep) -> None:
        """Go on to a step: whether anything is to be compiled for it is not known yet."""
        self._bar.say(f"loading {step.what}")

    def end(self) -> None:
        """Count a step that is done."""
        self.done += 1
        self._bar.advance()

    def compiling(self, piece: Piece) -> None:
        """Say what is about to be compiled."""
        self.compiled += 1
        said = f"compiling {piece.what} (about {piece.expected} s)"
        self._bar.say(said)
        if not self._bar.shows:
            typer.echo(f"sinuous: {self.done + 1} of {self.total}: {said}", err=True)
