"""Entries whose machine code is missing run as Python at once, while helpers compile them; and who is told of it.

Whether the code is there is asked only where Numba has none for the arguments of a call, so calls of compiled code take
no longer than without this. An interpreted call goes on until it is done, or until its code is there, and is then made
again with that. So the first answer is as soon there as it would be without any compiler. An entry waits for its code

- where interpreted calls of its piece have taken so long that compiling makes it at most `LATER` later: on a machine
  that has no time for helpers;
- where a call would take long, and could not be abandoned, or has to be on time (`Piece.most`);
- where no helper can be had, and within `code_first`.

Pieces say what is compiled for which purpose, and how long that takes: whoever waits is told so before it begins.
"""

import contextlib
import os
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Lock
from typing import Any, NamedTuple

import numpy as np
from numba import types

from sinuous.base.progress import AbandonedError, no_work, rich_progress
from sinuous.kernels.compile.helpers import CompileOrder, foreman
from sinuous.kernels.compile.store import ENTRIES, Store, begun

FREE = " without obstacles"
"""What follows the name of an entry for which there are no obstacles at all: the form of it that is compiled for `None`
in the place of a scene."""


class Piece(NamedTuple):
    """Entries that are compiled for one purpose.

    Attributes
    ----------
    what : str
        The purpose, in the words of the user.
    seconds : int
        About how long compiling takes, on a core that nobody else uses, once an entry has been compiled.
    entries : tuple of str
        Module within the package, and name; see `FREE`.
    alone : int
        The same where nothing is compiled yet, if that can be; else 0.
    most : int, optional
        Numbers in the largest array of a call, beyond which it waits for its code: where nothing else tells how long it
        takes. With 0 all calls wait.
    """

    what: str
    seconds: int
    entries: tuple[str, ...]
    alone: int = 0
    most: int | None = None

    @property
    def expected(self) -> int:
        """Seconds that compiling takes about, with what is in the store now."""
        return self.seconds if begun() else max(self.alone, self.seconds)


FEW = 30_000
"""Numbers of which work is soon done, interpreted."""

PIECES = (
    Piece("single solves", 4, ("kernels.solve.search.search" + FREE,), 12),
    Piece("single solves among obstacles", 8, ("kernels.solve.search.search",), 18),
    Piece(
        "routes among obstacles",
        30,
        (
            "kernels.fitting.lines.measure_line",
            "kernels.fitting.lines.respace_line",
            "kernels.fields.scene_cells.list_near",
            "kernels.fitting.lines.distances_along",
            "kernels.fitting.lines.widths_across",
            "kernels.fitting.query.route_query",
            "kernels.freespace.find.find_routes",
            "kernels.roadmap.find.find_by_edges",
            "kernels.fitting.fit.fit_route",
            "kernels.tubes.follow_tube",
            "kernels.tubes.find_tubes",
            "kernels.growing.detours.add_detours",
            "kernels.growing.grow.grow_chains",
            "kernels.growing.turning.turn_round",
        ),
    ),
    Piece("batches of solves", 1, ("kernels.solve.search.search_many" + FREE,), 12),
    Piece("batches of solves among obstacles", 1, ("kernels.solve.search.search_many",), 18),
    Piece("preferences", 5, ("kernels.solve.preferences.prefer" + FREE,)),
    Piece("preferences among obstacles", 6, ("kernels.solve.preferences.prefer",)),
    Piece("starts of a memory", 1, ("kernels.solve.recall.recall", "kernels.solve.recall.compare"), most=FEW),
    Piece(
        "kinematics",
        1,
        tuple(f"kernels.chain.batch.{name}" for name in ("frames_of", "points_of", "jacobians_of")),
        most=FEW,
    ),
    Piece("distances", 3, ("kernels.fields.distances.many", "kernels.fields.distances.least_gap"), most=FEW),
    Piece(
        "trees of meshes, clouds and grids",
        2,
        ("kernels.fields.trees.arrange", "kernels.fields.trees.enclose", "kernels.fields.triangle_pairs.gather_pairs"),
        most=FEW,
    ),
    Piece(
        "decimating meshes",
        2,
        ("kernels.fields.deviation.nearest", "kernels.fields.deviation.largest_distance"),
        most=FEW,
    ),
    Piece(
        "sampling of meshes, clouds and grids",
        3,
        ("kernels.fields.solids.enclose", "kernels.fields.solids.sample", "kernels.fields.candidates.list_candidates"),
        most=0,
    ),
    Piece(
        "classes of routes",
        6,
        tuple(f"kernels.freespace.homotopy.{name}" for name in ("draw_tight", "deforms", "halfway", "trace_lines")),
    ),
    Piece(
        "motions",
        9,
        (
            "kernels.certificate.query.certify_motions",
            "kernels.certificate.courses.fill_drifts",
            "kernels.certificate.tip.leave_line",
            "kernels.certificate.tip.turn_off",
        ),
    ),
    Piece("plans", 7, ("kernels.planning.query.plan", "kernels.planning.walk.walk")),
    Piece(
        "shapes under load",
        15,
        (
            "kernels.statics.equilibrium.equilibrate",
            "kernels.statics.departure.measure_departure",
            "kernels.statics.drive.fill_body_tables",
            "kernels.statics.drive.differentiate_equilibrium",
            "kernels.statics.table_derivatives.differentiate_by_tables",
        ),
    ),
    Piece("control loops", 15, ("kernels.velocity.query.control_step",), most=0),
    Piece(
        "control loops under load",
        15,
        ("kernels.velocity.loaded.loaded_step", "kernels.velocity.loaded.certify_step"),
        most=0,
    ),
    Piece("derivatives", 9, ("kernels.derivative.query.derive", "kernels.derivative.query.derive_many"), most=FEW),
    Piece("the method opti_path", 10, ("methods.opti_path.search.search", "methods.opti_path.path.sample")),
    Piece("the method dls", 4, ("methods.dls.search",)),
    Piece("the methods fabrikc, fabrikx and fabrik_avoid", 7, ("methods.fabrik.reaching.search",)),
    Piece("the method slinki", 6, ("methods.slinki.search",)),
    Piece("the method monte_carlo", 4, ("methods.monte_carlo.search",)),
    Piece("the method learned", 4, ("methods.learned.search",)),
)
"""All that is compiled, what most users need first."""

SHORT = 2
"""Seconds from which on a person should know what takes so long."""


def piece_of(compiled: Any, signature: Any) -> Piece | None:
    """Return the piece that an entry belongs to, for arguments of such types."""
    name = name_of(compiled, signature)
    return next((piece for piece in PIECES if name in piece.entries), None)


def name_of(compiled: Any, signature: Any) -> str:
    """Name of an entry for such arguments as `PIECES` has it."""
    name = f"{compiled.__module__.partition('.')[2]}.{compiled.__name__}"
    return name + FREE if types.none in signature else name


@contextlib.contextmanager
def announced(piece: Piece | None) -> Iterator[None]:
    """Say that somebody waits for a piece within: once, in a line, and to a person in a bar."""
    if piece is not None and piece not in _announced:
        _announced.append(piece)
        _tellers[-1](piece)
    if piece is None or piece.expected <= SHORT or _tellers[-1] is not _print or not sys.stderr.isatty():
        yield
        return
    from rich.progress import BarColumn, TimeElapsedColumn

    with rich_progress(BarColumn(), TimeElapsedColumn()) as bar:
        bar.add_task("", total=None)
        yield


def _print(piece: Piece) -> None:
    """Say on standard error what is about to be compiled, and how long that takes."""
    seconds = piece.expected
    if seconds > SHORT:
        hint = "; 'sinuous warm' compiles everything ahead" if len(_announced) == 1 else ""
        text = f"sinuous: compiling {piece.what}, once on this machine (about {seconds} s){hint}"
        print(text, file=sys.stderr, flush=True)  # noqa: T201


@contextlib.contextmanager
def told_to(teller: Callable[[Piece], None]) -> Iterator[None]:
    """Call `teller` with each piece that is about to be compiled, instead of saying it on standard error."""
    _tellers.append(teller)
    try:
        yield
    finally:
        _tellers.pop()


_announced: list[Piece] = []
_tellers: list[Callable[[Piece], None]] = [_print]


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
    interpreted: Callable[..., Any], choose: Callable[..., Any], piece: Piece, path: Path, arguments: tuple[Any, ...]
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
            f"sinuous: first use of some kernels on this machine: they are compiled in the background "
            f"(about {seconds} s); until then answers take longer; 'sinuous warm' compiles everything ahead"
        )
        print(text, file=sys.stderr, flush=True)  # noqa: T201


_told: list[Piece] = []
