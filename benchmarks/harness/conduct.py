"""The frame around every experiment: packages, journal, progress, interrupt, and where the results go."""

import hashlib
import json
import os
import sys
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import benchmarks
import sinuous
from benchmarks.harness.experiment import Experiment, Piece, Report
from benchmarks.harness.machine import describe
from sinuous.base.errors import InputError
from sinuous.files.documents import json_line

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


NAME = "journal.jsonl"


def code_version() -> str:
    """Hash of all sources of library and benchmarks: figures from different code do not belong into one table."""
    digest = hashlib.sha256()
    for folder in (Path(str(package.__file__)).parent for package in (sinuous, benchmarks)):
        for source in sorted(folder.rglob("*.py")):
            digest.update(str(source.relative_to(folder)).encode() + b"\0" + source.read_bytes())
    return digest.hexdigest()[:12]


@dataclass
class Journal:
    """The pieces of one experiment, in a file.

    Attributes
    ----------
    file : Path
    pieces : dict
        What was measured, by the name of the piece.
    """

    file: Path
    pieces: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def open(cls, folder: Path, settings: dict[str, Any]) -> "Journal":
        """Open the journal of a folder: a new one, or the one that is there if it was begun with the same settings.

        Parameters
        ----------
        folder : Path
            Made when it is not there.
        settings : dict
            Plain values, all that the figures depend on: what a line measured under other settings says is no part of
            this experiment.

        Raises
        ------
        InputError
            When other settings were used before; it names the first that differs. When the folder is a file.
        """
        if folder.exists() and not folder.is_dir():
            raise InputError("--out", "is a file", str(folder), "a folder")
        folder.mkdir(parents=True, exist_ok=True)
        journal = cls(folder / NAME)
        if not journal.file.exists():
            journal.file.write_text(json_line({"settings": settings}) + "\n", encoding="utf-8")
            return journal
        lines, size = _whole_lines(journal.file)
        before = lines[0].get("settings") if lines else None
        _refuse_others(folder, before, json.loads(json_line(settings)))
        os.truncate(journal.file, size)
        journal.pieces = {line["piece"]: line["measured"] for line in lines[1:]}
        return journal

    def add(self, piece: str, measured: Any) -> None:
        """Keep what was measured, on disk before this returns."""
        line = json_line({"piece": piece, "measured": measured})
        with self.file.open("a", encoding="utf-8") as stream:
            stream.write(line + "\n")
        self.pieces[piece] = json.loads(line)["measured"]


def _whole_lines(file: Path) -> tuple[list[dict[str, Any]], int]:
    """Lines of a journal, and how many bytes they are: its end may be torn, by a computer that stopped."""
    lines: list[dict[str, Any]] = []
    size = 0
    for text in file.read_bytes().splitlines(keepends=True):
        try:
            line = json.loads(text)
        except ValueError:
            break
        if not isinstance(line, dict) or not text.endswith(b"\n"):
            break
        lines.append(line)
        size += len(text)
    return lines, size


def _refuse_others(folder: Path, before: Any, now: dict[str, Any]) -> None:
    if before == now:
        return
    remedy = "the settings of before, or another folder"
    if not isinstance(before, dict):
        raise InputError("--out", "its journal cannot be read", str(folder), remedy)
    key = next(key for key in {**before, **now} if before.get(key) != now.get(key))
    change = f"{key} was {before.get(key, 'not set')}, is {now.get(key, 'not set')}"
    raise InputError("--out", change, str(folder), remedy)


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
        When the folder holds measurements under other settings.
    """
    folder = Path(f"bench-{experiment.name}") if folder is None else folder
    facts = describe()
    journal = Journal.open(folder, _settings(experiment, facts))
    work = list(experiment.pieces())
    try:
        _measure(experiment, work, journal)
        report = Report(experiment, facts, experiment.findings(journal.pieces))
        _give(report, folder, record)
    except BaseException as error:  # whatever ended it: what was measured until then took minutes
        _give(Report(experiment, facts, experiment.findings(journal.pieces), interrupted=True), folder, record)
        if not isinstance(error, KeyboardInterrupt):
            raise
        done = sum(name in journal.pieces for name, _ in work)
        _say(f"interrupted after {done} of {len(work)} pieces; the same command goes on from there")
        return INTERRUPTED
    return 0 if report.findings.correct else 1


def _measure(experiment: Experiment, work: list[Piece], journal: Journal) -> None:
    """Measure what the journal lacks."""
    lacking = [(name, measure) for name, measure in work if name not in journal.pieces]
    if not lacking:
        _say("all of this was measured before; another --out measures it again")
    for name, measured in experiment.plan.track(experiment.done(lacking), experiment.name, len(lacking)):
        journal.add(name, measured)


def _settings(experiment: Experiment, facts: dict[str, str]) -> dict[str, Any]:
    return {
        "experiment": experiment.name,
        "seed": experiment.plan.seed,
        "quick": experiment.plan.quick,
        **experiment.settings,
        **{key: value for key, value in facts.items() if key not in MOMENTARY},
        "code": code_version(),
    }


def _give(report: Report, folder: Path, record: Path | None) -> None:
    """Write the results into the folder, and print them."""
    name = report.experiment.name
    text = report.to_text()
    (folder / f"{name}.json").write_text(json_line(report.to_dict()) + "\n", encoding="utf-8")
    (folder / f"{name}.md").write_text(text, encoding="utf-8")
    if record is not None:
        (record / f"{name}.txt").write_text(f"# {name}\n\n{text}", encoding="utf-8")
    sys.stdout.write(text)
    sys.stdout.flush()
    _say(f"results are in {folder}")


def _say(message: str) -> None:
    sys.stderr.write(f"benchmarks: {message}\n")
