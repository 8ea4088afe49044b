"""Entries whose machine code is missing run as Python at once, while helpers compile them.

Whether the code is there is asked only where Numba has none for the arguments of a call, so calls of compiled code take
no longer than without this. An interpreted call goes on until it is done, or until its code is there, and is then made
again with that. So the first answer is as soon there as it would be without any compiler. An entry waits for its code

- where interpreted calls of its piece have taken so long that compiling makes it at most `LATER` later: on a machine
  that has no time for helpers;
- where a call would take long, and could not be abandoned, or has to be on time (`Piece.most`);
- where no helper can be had, and within `code_first`.
"""

import contextlib
import os
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np
from numba import types

from sinuous.base.work_time import AbandonedError, no_work
from sinuous.kernels.compile.helpers import CompileOrder, foreman
from sinuous.kernels.compile.pieces import SHORT, Piece, announced, piece_of
from sinuous.kernels.compile.store import ENTRIES, Store, begun

FIRST = 45
"""Seconds that compiling takes about for somebody who begins."""

LATER = 0.3
"""By which share of what it takes interpreted an answer may be later, for the good of those that follow."""

MODES = ("auto", "compiled", "interpreted")

MODE = os.environ.get("SINUOUS_KERNELS", "auto")
"""How entries run."""

if MODE not in MODES:
    raise ValueError(f"unknown SINUOUS_KERNELS {MODE!r}; expected one of {', '.join(MODES)}")


TOOK: list[tuple[str, float]] = []
"""Entries that this process has compiled, or waited for, and the seconds of CPU of each."""


class _Waiting:
    """How many in this process want machine code from the first call on."""

    count = 0
    lock = Lock()


@contextlib.contextmanager
def code_first(wanted: bool = True) -> Iterator[None]:
    """Let entries wait for their code within, in all threads: for what calls them very often, or has to be on time."""
    if not wanted:
        yield
        return
    with _Waiting.lock:
        _Waiting.count += 1
    try:
        yield
    finally:
        with _Waiting.lock:
            _Waiting.count -= 1


def tiered(compiled: Any, interpreted: Callable[..., Any]) -> Any:
    """Let an entry be interpreted while its code is missing.

    Numba asks `_compile_for_args` what to call where it has no code for the arguments of a call.
    """
    compile_for, store = compiled._compile_for_args, compiled._cache
    if not isinstance(store, Store):  # nobody would find what a helper compiles
        return compiled
    ENTRIES[store.module, store.called] = compiled

    def choose(*arguments: Any) -> Any:
        with no_work():
            return chosen(*arguments)

    def chosen(*arguments: Any) -> Any:
        signature = tuple(types.unliteral(compiled.typeof_pyval(one)) for one in arguments)
        codegen = compiled.targetctx.codegen()
        path = store.path(signature, codegen)
        piece = piece_of(compiled, signature)
        if signature in compiled.overloads or store.find(signature, codegen).exists():
            return compile_for(*arguments)
        order = CompileOrder(store.module, store.called, signature, path)
        if piece is None or not _may_come_later(piece, arguments) or not store.usable() or not foreman.order(order):
            return now(piece, *arguments)
        _tell(piece)
        return lambda *given: _interpreted_first(interpreted, choose, piece, path, given)

    def now(piece: Piece | None, *arguments: Any) -> Any:
        began = time.thread_time()
        with announced(piece):
            made = compile_for(*arguments)
        TOOK.append((f"{store.module}.{store.called}", time.thread_time() - began))
        return made

    compiled._compile_for_args = choose
    return compiled


def _may_come_later(piece: Piece, arguments: tuple[Any, ...]) -> bool:
    """Say whether the code of a piece may come later."""
    largest = max((one.size for one in arguments if isinstance(one, np.ndarray)), default=0)
    soon = piece.most is None or largest <= piece.most
    return MODE == "auto" and not _Waiting.count and soon and _spent[piece] <= piece.expected / LATER


def _interpreted_first(
    interpreted: Callable[..., Any],
    choose: Callable[..., Any],
    piece: Piece,
    path: Path,
    arguments: tuple[Any, ...],
) -> Any:
    """Interpret a call; where that is abandoned, put everything back, and call what is chosen now."""
    with no_work():
        before = [(array, array.copy()) for array in _written_to(arguments)]
    began, most = time.thread_time(), piece.expected / LATER - _spent[piece]
    try:
        return interpreted(*arguments, end=lambda: path.exists() or time.thread_time() - began > most)
    except AbandonedError:
        for array, kept in before:
            array[...] = kept
    finally:
        _spent[piece] += time.thread_time() - began
    return choose(*arguments)(*arguments)


_spent: defaultdict[Piece, float] = defaultdict(float)
"""Seconds of CPU of this process that the entries of a piece took, interpreted while their code was missing."""


def _written_to(values: tuple[Any, ...]) -> Iterator[Any]:
    """All arrays among some values, and in tuples of them, that a call may change."""
    for one in values:
        if isinstance(one, tuple):
            yield from _written_to(one)
        elif isinstance(one, np.ndarray) and one.flags.writeable:
            yield one


def _tell(piece: Piece) -> None:
    """Say once that kernels are compiled in the background, and about how long that takes."""
    seconds = piece.expected if begun() else FIRST
    if not _told and seconds > SHORT:
        _told.append(piece)
        text = (
            f"sinuous: first use on this machine: kernels are compiled in the background (about {seconds} s); "
            "until then answers take longer; 'sinuous warm' compiles everything ahead"
        )
        print(text, file=sys.stderr, flush=True)  # noqa: T201


_told: list[Piece] = []
