"""The frame around every experiment: packages, journal, progress, interrupt, and where the results go."""

import hashlib
import json
import pickle
import sys
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import Progress

import benchmarks
import sinuous
from benchmarks.harness.experiment import Experiment, Measured, Piece
from benchmarks.harness.lines import Line, tables_of
from benchmarks.harness.machine import describe
from sinuous.base.errors import InputError

INTERRUPTED = 130

NEEDED = {
    "casadi": "casadi",
    "distributed": "distributed",
    "igl": "libigl",
    "matplotlib": "matplotlib",
    "trimesh": "trimesh",
}
"""Modules that a plain installation does not bring, and the packages that do."""

MOMENTARY = ("date", "sinuous", "casadi")
"""Facts of a machine that may change while an experiment goes on; the hash of the sources stands for the version."""

BUSY = 0.1
"""Share of the processor that other processes may have before times mean little."""


def code_version() -> str:
    """Hash of all sources of library and benchmarks: figures from different code do not belong into one table."""
    digest = hashlib.sha256()
    for folder in (Path(str(package.__file__)).parent for package in (sinuous, benchmarks)):
        for source in sorted(folder.rglob("*.py")):
            digest.update(str(source.relative_to(folder)).encode() + b"\0" + source.read_bytes())
    return digest.hexdigest()[:12]


class Journal:
    """The pieces of one experiment that were measured under the same settings, each in a file.

    Parameters
    ----------
    folder : Path
        Made when it is not there.
    settings : dict
        Plain values, all that the figures depend on: what was measured under others is no part of this experiment.

    Attributes
    ----------
    pieces : dict of str to Measured
        By the names of pieces.

    Raises
    ------
    InputError
        When the folder is a file.
    """

    def __init__(self, folder: Path, settings: dict[str, Any]) -> None:
        if folder.exists() and not folder.is_dir():
            raise InputError("--out", "is a file", str(folder), "a folder")
        self._folder = folder / hashlib.sha256(json.dumps(settings).encode()).hexdigest()[:12]
        self._folder.mkdir(parents=True, exist_ok=True)
        files = self._folder.glob("*.piece")
        self.pieces: dict[str, Measured] = dict(pickle.loads(file.read_bytes()) for file in files)

    def add(self, piece: str, measured: Measured) -> None:
        """Keep what was measured, on disk before this returns."""
        new = self._folder / f"{len(self.pieces)}.new"
        new.write_bytes(pickle.dumps((piece, measured)))
        new.replace(new.with_suffix(".piece"))  # whole, whatever stops the computer
        self.pieces[piece] = measured


def require() -> None:
    """Refuse to begin without packages.

    Raises
    ------
    InputError
        That names all that are missing.
    """
    missing = [package for module, package in NEEDED.items() if find_spec(module) is None]
    if missing:
        raise InputError("benchmarks", "not installed", missing, "the packages of pip install -e '.[bench]'")


def conduct(experiment: Experiment, folder: Path | None = None, record: Path | None = None) -> int:
    """Measure what the journal of the folder lacks, write the results, and print them.

    Parameters
    ----------
    experiment : Experiment
    folder : Path, optional
        Of journal and results; default: `bench-` and the name of the experiment.
    record : Path, optional
        Folder of pages of results (`docs/results`), in which to keep what was found.

    Returns
    -------
    int
        Exit code: 0 when all claims and every goal of correctness held, whatever the speed; 1 when not; 130 when
        interrupted.

    Raises
    ------
    InputError
        When the folder is a file.
    """
    folder = Path(f"bench-{experiment.name}") if folder is None else folder
    facts, work = describe(), list(experiment.pieces())
    journal = Journal(folder, _settings(experiment, facts))
    lacking = [(name, measure) for name, measure in work if name not in journal.pieces]
    interrupted = True
    try:
        if not lacking:
            _say("all of this was measured before; another --out measures it again")
        for name, measure in _tracked(experiment.name, lacking):
            journal.add(name, measure())
        interrupted = False
    except KeyboardInterrupt:
        done = sum(name in journal.pieces for name, _ in work)
        _say(f"interrupted after {done} of {len(work)} pieces; the same command goes on from there")
    finally:  # whatever ended it: what was measured until then took minutes
        lines = experiment.lines(journal.pieces)
        text = report(experiment, facts, journal, lines, interrupted)
        (folder / f"{experiment.name}.md").write_text(text, encoding="utf-8")
        if record is not None:
            record.mkdir(parents=True, exist_ok=True)
            (record / f"{experiment.name}.txt").write_text(f"# {experiment.name}\n\n{text}", encoding="utf-8")
        sys.stdout.write(text)
        sys.stdout.flush()
        _say(f"results are in {folder}")
    return INTERRUPTED if interrupted else int(any(line.correctness and not line.held for line in lines))


def _tracked(what: str, pieces: Sequence[Piece]) -> Iterator[Piece]:
    """Go through pieces; in a terminal with a bar, drawn between two: a thread would disturb what is timed."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield from pieces
        return
    with Progress(console=console, auto_refresh=False, transient=True) as progress:
        task = progress.add_task(what, total=len(pieces))
        for piece in pieces:
            yield piece
            progress.update(task, advance=1, refresh=True)


def _settings(experiment: Experiment, facts: dict[str, str]) -> dict[str, Any]:
    return {
        "experiment": experiment.name,
        "seed": experiment.plan.seed,
        "quick": experiment.plan.quick,
        **experiment.settings,
        **{key: value for key, value in facts.items() if key not in MOMENTARY},
        "code": code_version(),
    }


def report(
    experiment: Experiment, facts: dict[str, str], journal: Journal, lines: Sequence[Line], interrupted: bool
) -> str:
    """Return what was found and where, as Markdown."""
    plan = experiment.plan
    shown = {**facts, "seed": str(plan.seed)}
    if experiment.protocol:
        shown["protocol"] = experiment.protocol
    if plan.rounds > 1:
        shown["rounds"] = str(plan.rounds)
    parts = ["\n".join(f"- {key}: {value}" for key, value in shown.items() if value != "not installed")]
    if plan.quick:
        parts.append("A quick run: counts are cut down, figures mean little.")
    most = max((measured.busy for measured in journal.pieces.values()), default=0.0)
    if most > BUSY:
        parts.append(
            f"BUSY: other processes had up to {100.0 * most:.0f} % of the processor while this was measured; "
            "times mean little."
        )
    parts += tables_of(lines)
    if interrupted:
        parts.append("Interrupted: this is what was measured until then.")
    return "\n\n".join(parts) + "\n"


def _say(message: str) -> None:
    sys.stderr.write(f"benchmarks: {message}\n")
