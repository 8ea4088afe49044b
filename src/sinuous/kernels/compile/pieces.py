"""What is compiled for which purpose, how long that takes, and who is told before it begins."""

import contextlib
import sys
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from numba import types

from sinuous.base.progress import rich_progress
from sinuous.kernels.compile.store import begun

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
            "kernels.fitting.settle.settle_chain",
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
    Piece(
        "distances",
        3,
        ("kernels.fields.distances.many", "kernels.fields.distances.least_gap"),
        most=FEW,
    ),
    Piece(
        "trees of meshes, clouds and grids",
        1,
        ("kernels.fields.trees.arrange", "kernels.fields.trees.enclose"),
        most=FEW,
    ),
    Piece(
        "sampling of meshes, clouds and grids",
        3,
        (
            "kernels.fields.solids.enclose",
            "kernels.fields.solids.sample",
            "kernels.fields.candidates.list_candidates",
        ),
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
        ),
    ),
    Piece(
        "plans",
        10,
        ("kernels.planning.query.plan", "kernels.planning.query.tighten", "kernels.planning.walk.walk"),
    ),
    Piece(
        "shapes under load",
        15,
        (
            "kernels.statics.equilibrium.equilibrate",
            "kernels.statics.departure.measure_departure",
            "kernels.statics.drive.lay_out",
            "kernels.statics.drive.differentiate",
            "kernels.statics.answers.answer",
            "kernels.solve.loaded.correct",
        ),
    ),
    Piece("control loops", 15, ("kernels.velocity.query.control_step",), most=0),
    Piece(
        "derivatives",
        6,
        ("kernels.derivative.query.derive" + FREE, "kernels.derivative.query.derive_many" + FREE),
        most=FEW,
    ),
    Piece(
        "derivatives among obstacles",
        9,
        tuple(f"kernels.derivative.query.{name}" for name in ("derive", "derive_many", "find_contacts")),
        most=FEW,
    ),
    Piece(
        "the method opti_path",
        10,
        ("methods.opti_path.search.search", "methods.opti_path.potential.sample"),
    ),
    Piece("the method dls", 4, ("methods.dls.search",)),
    Piece("the methods fabrikc, fabrikx and fabrik_avoid", 7, ("methods.fabrik.reaching.search",)),
    Piece("the method slinki", 6, ("methods.slinki.search",)),
    Piece("the method monte_carlo", 4, ("methods.monte_carlo.search",)),
    Piece("the method learned", 4, ("methods.learned.search.search",)),
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
    if piece is not None and piece not in _told:
        _told.append(piece)
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
        hint = "; 'sinuous warm' compiles everything ahead" if len(_told) == 1 else ""
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


_told: list[Piece] = []
_tellers: list[Callable[[Piece], None]] = [_print]
