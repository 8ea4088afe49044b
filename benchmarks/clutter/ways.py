"""`python -m benchmarks ways NAME`: places solved in several ways, which take turns, each held against another.

What counts is the CPU time of the thread, so that other work on the machine hardly matters. Answers count when the
judges find them right.
"""

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from importlib import import_module
from pathlib import Path
from statistics import fmean, median
from time import thread_time
from typing import Annotated, Any, NamedTuple, TypeVar

import numpy as np
import typer

from benchmarks.harness.command import command
from benchmarks.harness.experiment import chosen
from benchmarks.harness.markdown import table
from benchmarks.harness.quiet import ignore_suspicions
from benchmarks.places import FAMILIES
from benchmarks.solvers.parallel import in_processes
from sinuous.base import checks
from sinuous.cli.options import check_writable

NAMES = {
    "ablation": "each attempt of the solver switched off",
    "demanded": "a clearance that is demanded, and a body that is thicker by as much",
    "remembered": "many targets in one place, with a memory and without",
    "explored": "plans into a place that was explored, and without that",
}
"""Modules of this folder, with `AGAINST` and `examined(family, seed, count)`, and what they compare."""

LIMIT = 1.0
"""Seconds of CPU time in which a place has to be solved."""

PATIENCE = 3.0
"""Budget of a solve on the clock, in units of that: the machine may be busy."""

LOST, LONGER, LEAST = 0.01, 0.1, 2.0
"""From which on a way moves a family: share of its places that is lost; growth of its 95 %, as a share, and in ms."""

Answer = TypeVar("Answer")


class Row(NamedTuple):
    """One problem, in one way: whether it is solved, in time and right; whether a claim is false; and CPU time."""

    family: str
    way: str
    solved: bool
    wrong: bool
    milliseconds: float


def timed(work: Callable[..., Answer], *arguments: Any, runs: int = 1) -> tuple[Answer, float]:
    """Do something so often; return what came of it at last, and its milliseconds of CPU time of this thread."""
    for _ in range(runs):
        began = thread_time()
        answer = work(*arguments)
        spent = thread_time() - began
    return answer, 1e3 * spent


def tables(rows: Sequence[Row], against: Mapping[str, str], by_family: bool = True) -> Iterator[str]:
    """Yield a table: how often and how quickly each way solves, and its time as a part of that of another."""
    headings = ["family", "way", "solved", "wrong", "mean, ms", "median", "p95", "worst", "against", "its time", "p95"]
    cells = [[*headings, "families that it moves"]]
    families = list(dict.fromkeys(row.family for row in rows))
    for family in [*families * by_family, "all"]:
        own = {way: [row for row in rows if row.way == way and family in (row.family, "all")] for way in against}
        for way, found in own.items():
            if not found:
                continue
            spent = [row.milliseconds for row in found]
            times = [fmean(spent), *np.quantile(spent, [0.5, 0.95, 1.0]).tolist()]
            pairs = [(a, b) for a, b in zip(own[against[way]], found, strict=False) if a.solved and b.solved]
            ratios = [b.milliseconds / a.milliseconds for a, b in pairs] or [np.nan]
            moved = [_moved(each, rows, way, against[way]) for each in families] if family == "all" else []
            cells.append(
                [
                    *(family, way, f"{sum(row.solved for row in found)}/{len(found)}"),
                    *(str(sum(row.wrong for row in found)), *(f"{value:.3g}" for value in times), against[way]),
                    *(
                        f"{median(ratios):.3f}",
                        f"{float(np.quantile(ratios, 0.95)):.2f}",
                        ", ".join(filter(None, moved)),
                    ),
                ]
            )
    yield table(cells, words=True)


def _moved(family: str, rows: Sequence[Row], way: str, other: str) -> str:
    """How a way matters in a family: how many more places are lost with it, or how much longer 95 % take."""
    with_it, without = ([row for row in rows if (row.family, row.way) == (family, each)] for each in (way, other))
    lost = sum(row.solved for row in without) - sum(row.solved for row in with_it)
    if lost > LOST * len(without):
        return f"{family} ({lost} lost)"
    before, after = (float(np.quantile([row.milliseconds for row in own] or [0.0], 0.95)) for own in (without, with_it))
    return f"{family} (x {after / before:.1f})" if after - before > max(LEAST, LONGER * before) else ""


def run(
    name: Annotated[str, typer.Argument(metavar="NAME", help="; ".join(f"{k}: {v}" for k, v in NAMES.items()) + ".")],
    piece: Annotated[
        list[str] | None, typer.Option(metavar="FAMILY", help="Only this family, or a pattern; repeat for more.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Of the places.")] = 0,
    count: Annotated[int, typer.Option(help="Places, or targets in one place, of each family.")] = 60,
    alone: Annotated[bool, typer.Option("--alone", help="In this process, instead of one for each core.")] = False,
    record: Annotated[Path | None, typer.Option(metavar="FILE", help="Keep the table there, too.")] = None,
) -> None:
    """Compare ways to solve places, family by family; the exit code is 1 when a claim was wrong."""
    checks.choice("NAME", name, tuple(NAMES))
    checks.integer("--seed", seed, 0, 2**31 // 1000 - 1)
    checks.integer("--count", count, 1, 10_000)
    if record is not None:
        check_writable("--record", record)
    fitting = chosen(list(FAMILIES), piece or ["*"])
    ignore_suspicions()
    module: Any = import_module(f"benchmarks.clutter.{name}")
    work: Callable[[str], Iterable[Row]] = partial(module.examined, seed=seed, count=count)
    families = [family for family in FAMILIES if family in fitting]
    rows = [row for some in in_processes(work, families, alone=alone) for row in some]
    text = "\n".join(tables(rows, module.AGAINST, name != "ablation"))
    typer.echo(text)
    if record is not None:
        record.write_text(f"{text}\n", encoding="utf-8")
    raise typer.Exit(int(any(row.wrong for row in rows)))


main = command(run, "benchmarks ways")


if __name__ == "__main__":
    sys.exit(main())
