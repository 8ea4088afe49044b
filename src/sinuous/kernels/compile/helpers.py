"""Processes that compile entries while the program goes on without them.

There are as many as cores, over all programs of this user, of low priority. A helper is told one entry after the other
on its standard input, and keeps the code in the store, where the program finds it. It ends when nothing is left to do,
and as soon as its standard input or its program ends, however that ends.
"""

import atexit
import contextlib
import os
import pickle
import subprocess
import sys
import threading
from importlib import import_module
from pathlib import Path
from queue import SimpleQueue
from typing import Any, NamedTuple

from sinuous.kernels.compile.locks import locked, use_own_locks
from sinuous.kernels.compile.sources import PACKAGE
from sinuous.kernels.compile.store import ENTRIES

IDLE = 5.0
"""Seconds without anything to do after which a helper ends."""

NICE = 19
"""By how much helpers give way to others: as far as can be."""

COMMAND = f"""
import os
if hasattr(os, "nice"):
    os.nice({NICE})  # before anything is imported, which takes a second
from sinuous.kernels.compile.helpers import help_out
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
    """Hands orders to helpers, one thread to each.

    Attributes
    ----------
    given_up : bool
        Whether helpers cannot be had.
    """

    def __init__(self, cores: int) -> None:
        self._cores = cores
        self._due: list[CompileOrder] = []
        self._expected: dict[Path, bool] = {}
        self._processes: list[subprocess.Popen[bytes]] = []
        self._idle = list(range(cores))
        self._changed = threading.Condition()
        self.given_up = False

    def order(self, order: CompileOrder) -> bool:
        """Have an entry compiled, if that is not ordered yet; say whether that can be expected."""
        with self._changed:
            if self.given_up or not sys.executable or getattr(sys, "frozen", False):
                return False
            if order.path not in self._expected:
                self._expected[order.path] = True
                self._due.append(order)
                self._changed.notify()
                if self._idle:
                    number = self._idle.pop()
                    threading.Thread(target=self._work, args=(number,), daemon=True, name="sinuous-helper").start()
            return self._expected[order.path]

    def dismiss(self) -> None:
        """End all helpers, now."""
        with self._changed:
            self._due.clear()
            processes, self._processes = self._processes, []
        for process in processes:
            with contextlib.suppress(OSError), process:  # which closes its pipes, and waits for it
                process.kill()

    def forget(self) -> None:
        """Begin anew in a process that was forked: helpers are those of its parent."""
        processes = self._processes
        self.__init__(self._cores)  # type: ignore[misc]
        for process in processes:
            if process.stdin is not None:
                with contextlib.suppress(OSError):
                    os.close(process.stdin.fileno())

    def _work(self, number: int) -> None:
        """Give orders to one helper, until there are none; as many are at work as cores, in all programs together."""
        process: subprocess.Popen[bytes] | None = None
        order: CompileOrder | None = None
        try:
            while (order := self._next()) is not None:
                with locked(order.path.parent / "lock", f"helper {number}"):
                    if not order.path.exists():
                        process = process or self._begin()
                        self._expected[order.path] = _ask(process, order)
        except (OSError, EOFError, ValueError, pickle.PickleError):  # none may be begun, or it, or its pipe, is gone
            if order is not None:
                self._expected[order.path] = False
            self.given_up = process is None
        finally:
            with self._changed:
                self._idle.append(number)
            if process is not None and process.stdin is not None:
                with contextlib.suppress(OSError):
                    process.stdin.close()

    def _next(self) -> CompileOrder | None:
        with self._changed:
            if not self._due:
                self._changed.wait(IDLE)
            return self._due.pop(0) if self._due else None

    def _begin(self) -> "subprocess.Popen[bytes]":
        with self._changed:
            process = begin_helper()
            self._processes.append(process)
        return process


def begin_helper() -> "subprocess.Popen[bytes]":
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
        env=words,
        **flags,
    )


def _ask(process: "subprocess.Popen[bytes]", order: CompileOrder) -> bool:
    """Have a helper compile an entry; say whether it did.

    Raises
    ------
    OSError, EOFError, ValueError
        When it is gone, or its pipe was closed meanwhile.
    """
    assert process.stdin is not None
    assert process.stdout is not None
    pickle.dump(order, process.stdin)
    process.stdin.flush()
    return bool(pickle.load(process.stdout))


def help_out() -> None:
    """Be a helper: compile what is told on standard input, until it ends."""
    use_own_locks("helper's ")
    answers, sys.stdout = sys.stdout.buffer, sys.stderr
    orders: SimpleQueue[CompileOrder] = SimpleQueue()

    def listen() -> None:
        try:
            while True:
                orders.put(pickle.load(sys.stdin.buffer))
        finally:
            os._exit(0)  # wherever it is: what it wrote is there in full, or not at all

    threading.Thread(target=listen, daemon=True).start()
    while True:
        order = orders.get()
        try:
            import_module(order.module)
            ENTRIES[order.module, order.name].compile(order.signature)
            done = True
        except Exception:  # the program compiles it itself, and shows what is wrong
            done = False
        pickle.dump(done, answers)
        answers.flush()


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


foreman = Foreman(cores())
atexit.register(foreman.dismiss)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=foreman.forget)
