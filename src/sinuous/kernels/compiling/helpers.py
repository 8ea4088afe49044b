"""Processes that compile entries while the program goes on without them.

There are as many as cores, over all programs of this user, of low priority. A helper is told one entry after the other
on its standard input, and keeps the code in the store, where the program finds it. It ends when nothing is left to do,
and as soon as its standard input or its program ends, however that ends.
"""

import atexit
import base64
import contextlib
import os
import pickle
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from sinuous.kernels.compiling.locks import free_again, take
from sinuous.kernels.compiling.sources import PACKAGE
from sinuous.kernels.compiling.store import ENTRIES

IDLE = 5.0
"""Seconds without anything to do after which a helper ends."""

PAUSE = 0.2
"""Seconds between two looks whether there is room for another helper."""

NICE = 19
"""By how much helpers give way to others: as far as can be."""

DONE, FAILED = "done", "failed"
"""What a helper answers."""

COMMAND = f"""
import os
if hasattr(os, "nice"):
    os.nice({NICE})  # before anything is imported, which takes a second
from sinuous.kernels.compiling.helpers import help_out
help_out()
"""


class CompileOrder(NamedTuple):
    """An entry that is to be compiled.

    Attributes
    ----------
    module, name : str
        By which it is found once its module is imported.
    signature : tuple
        Types of its arguments.
    path : Path
        File that will hold the code.
    """

    module: str
    name: str
    signature: tuple[Any, ...]
    path: Path


class Foreman:
    """Hands orders to helpers.

    Attributes
    ----------
    given_up : bool
        Whether helpers cannot be had.
    """

    def __init__(self, cores: int) -> None:
        self._cores = cores
        self._due: list[CompileOrder] = []
        self._known: dict[Path, bool] = {}
        self._processes: list[subprocess.Popen[str]] = []
        self._slots: set[int] = set()
        self._threads = 0
        self._changed = threading.Condition()
        self.given_up = False

    def order(self, order: CompileOrder) -> bool:
        """Have an entry compiled, if that is not ordered yet; say whether that can be expected."""
        with self._changed:
            if self.given_up or not sys.executable or getattr(sys, "frozen", False):
                return False
            if order.path not in self._known:
                self._known[order.path] = True
                self._due.append(order)
                self._changed.notify()
                if self._threads < self._cores:
                    self._threads += 1
                    threading.Thread(target=self._supervise, daemon=True, name="sinuous-helper").start()
            return self._known[order.path]

    def dismiss(self) -> None:
        """End all helpers, now."""
        with self._changed:
            self._due.clear()
            processes, self._processes = self._processes, []
        for process in processes:
            with contextlib.suppress(OSError):
                process.kill()
            process.wait()
            for pipe in (process.stdin, process.stdout):
                if pipe is not None:
                    with contextlib.suppress(OSError):
                        pipe.close()

    def forget(self) -> None:
        """Begin anew in a process that was forked: helpers are those of its parent."""
        processes = self._processes
        self.__init__(self._cores)  # type: ignore[misc]
        for process in processes:
            if process.stdin is not None:
                with contextlib.suppress(OSError):
                    os.close(process.stdin.fileno())

    def _supervise(self) -> None:
        """Give orders to one helper, until there are none."""
        process: subprocess.Popen[str] | None = None
        order: CompileOrder | None = None
        try:
            while (order := self._next()) is not None:
                with self._room(order):
                    if not order.path.exists():
                        process = process or self._begin()
                        self._known[order.path] = _ask(process, order)
        except (OSError, ValueError, pickle.PickleError):  # no process may be begun, or it was killed
            if order is not None:
                self._known[order.path] = False
            self.given_up = process is None
        finally:
            with self._changed:
                self._threads -= 1
            if process is not None and process.stdin is not None:
                with contextlib.suppress(OSError):
                    process.stdin.close()

    @contextlib.contextmanager
    def _room(self, order: CompileOrder) -> Iterator[None]:
        """Wait until fewer helpers are at work than there are cores, those of other programs among them."""
        file, slot = order.path.parent / "lock", None
        while slot is None and not order.path.exists():
            with self._changed:
                free = [i for i in range(self._cores) if i not in self._slots]
                slot = next((i for i in free if take(file, f"helper {i}")), None)
                if slot is not None:
                    self._slots.add(slot)
            if slot is None:
                time.sleep(PAUSE)
        try:
            yield
        finally:
            if slot is not None:
                free_again(file, f"helper {slot}")
                self._slots.discard(slot)

    def _next(self) -> CompileOrder | None:
        with self._changed:
            if not self._due:
                self._changed.wait(IDLE)
            return self._due.pop(0) if self._due else None

    def _begin(self) -> "subprocess.Popen[str]":
        with self._changed:
            process = begin_helper()
            self._processes.append(process)
        return process


def begin_helper() -> "subprocess.Popen[str]":
    """Begin a process that waits for orders."""
    paths = [str(PACKAGE.parent), *filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))]
    words = {**os.environ, "SINUOUS_KERNELS": "compiled", "PYTHONPATH": os.pathsep.join(paths)}
    # A group, so that Ctrl-C is not for it, but no session: Linux weighs priorities within one alone (autogroup).
    flags: dict[str, Any] = {"process_group": 0}
    if sys.platform == "win32":
        flags = {"creationflags": subprocess.BELOW_NORMAL_PRIORITY_CLASS | subprocess.CREATE_NEW_PROCESS_GROUP}
    return subprocess.Popen(
        [sys.executable, "-P", "-c", COMMAND],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env=words,
        **flags,
    )


def _ask(process: "subprocess.Popen[str]", order: CompileOrder) -> bool:
    """Have a helper compile an entry; say whether it did.

    Raises
    ------
    OSError
        When it is gone.
    """
    if process.stdin is None or process.stdout is None:
        raise OSError
    told = base64.b64encode(pickle.dumps((order.module, order.name, order.signature))).decode()
    process.stdin.write(f"{told}\n")
    process.stdin.flush()
    answer = process.stdout.readline().strip()
    if answer not in {DONE, FAILED}:
        raise OSError
    return answer == DONE


def help_out() -> None:
    """Be a helper: compile what is told on standard input, until it ends."""
    answers, sys.stdout = sys.stdout, sys.stderr
    orders: list[str] = []
    told = threading.Condition()

    def listen() -> None:
        for line in sys.stdin:
            with told:
                orders.append(line)
                told.notify()
        os._exit(0)  # wherever it is: what it wrote is there in full, or not at all

    parent = os.getppid()

    def watch() -> None:  # others may hold the other end of standard input
        while os.getppid() == parent:
            threading.Event().wait(1.0)
        os._exit(0)

    for task in (listen, watch):
        threading.Thread(target=task, daemon=True).start()
    while True:
        with told:
            told.wait_for(lambda: bool(orders))
            line = orders.pop(0)
        try:
            _compile(*pickle.loads(base64.b64decode(line)))
            answer = DONE
        except Exception:  # the program compiles it itself, and shows what is wrong
            answer = FAILED
        answers.write(f"{answer}\n")
        answers.flush()


def _compile(module: str, name: str, signature: tuple[Any, ...]) -> None:
    import_module(module)
    ENTRIES[module, name].compile(signature)


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


foreman = Foreman(cores())
atexit.register(foreman.dismiss)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=foreman.forget)
