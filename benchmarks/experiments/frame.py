"""The frame around every experiment: settings, journal, progress, interrupt, and where the results go."""

import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Protocol

from benchmarks import machine
from benchmarks.experiments.journal import Journal, code_version
from benchmarks.plan import Plan
from sinuous.errors import InputError
from sinuous.files.results import json_line, plain

INTERRUPTED = 130

NEEDED = {"fcl": "python-fcl", "matplotlib": "matplotlib"}
"""Modules that a plain installation does not bring, and the packages that do."""

MOMENTARY = ("date", "sinuous", "casadi")
"""Facts of a machine that may change while an experiment goes on; the hash of the sources stands for the version."""


@dataclass
class Findings:
    """What an experiment found.

    Attributes
    ----------
    text : str
        Markdown, which shows the figures by their names.
    data : dict
        The same for programs.
    figures : dict
        Matplotlib figures by name, without ending.
    wrong : int
        Claims of "solved" that verification rejected.
    """

    text: str
    data: dict[str, Any]
    figures: dict[str, Any] = field(default_factory=dict)
    wrong: int = 0


Piece = tuple[str, Callable[[], Any]]
"""A name, and what to call for plain values: some seconds of work, which an interrupt may cost."""


class Experiment(Protocol):
    """What the frame asks of an experiment."""

    name: str
    plan: Plan

    def settings(self) -> dict[str, Any]:
        """Return plain values, all that the figures depend on besides machine, code, seed and size."""
        ...

    def pieces(self) -> Iterable[Piece]:
        """Return the work, in order."""
        ...

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Sum up what was measured, all pieces by their names."""
        ...


def conduct(experiment: Experiment, out: Path | None, *, json: bool, anew: bool) -> int:
    """Measure what the journal of the folder lacks, write the results, and print them.

    Parameters
    ----------
    experiment : Experiment
    out : Path, optional
        Folder of journal and results; default: `bench-` and the name of the experiment.
    json : bool
        Print JSON, one line, instead of Markdown.
    anew : bool
        Whether to throw away what the folder holds.

    Returns
    -------
    int
        Exit code: 0; 1 when a claim of "solved" was wrong; 130 when interrupted.

    Raises
    ------
    InputError
        When packages are missing, or the folder holds measurements under other settings.
    """
    missing = [package for module, package in NEEDED.items() if find_spec(module) is None]
    if missing:
        raise InputError("bench", "needs packages that are not installed", missing, "pip install 'sinuous[bench]'")
    folder = Path(f"bench-{experiment.name}") if out is None else out
    facts = machine.describe()
    journal = Journal.open(folder, _settings(experiment, facts), anew=anew)
    work = list(experiment.pieces())
    try:
        for name, measure in experiment.plan.track(work, experiment.name, len(work)):
            if name not in journal.pieces:
                journal.add(name, measure())
        findings = experiment.findings(journal.pieces)
        text, data = _text(experiment, facts, findings), _data(experiment, facts, findings)
        _write(folder, experiment.name, text, data, findings.figures)
    except KeyboardInterrupt:
        done = sum(name in journal.pieces for name, _ in work)
        _say(f"interrupted after {done} of {len(work)} pieces; the same command goes on from there")
        return INTERRUPTED
    sys.stdout.write(data + "\n" if json else text)
    sys.stdout.flush()
    _say(f"results are in {folder}")
    return 1 if findings.wrong else 0


def _settings(experiment: Experiment, facts: dict[str, str]) -> dict[str, Any]:
    return {
        "experiment": experiment.name,
        "seed": experiment.plan.seed,
        "quick": experiment.plan.quick,
        **experiment.settings(),
        **{key: value for key, value in facts.items() if key not in MOMENTARY},
        "code": code_version(),
    }


def _text(experiment: Experiment, facts: dict[str, str], findings: Findings) -> str:
    shown = {**facts, "seed": str(experiment.plan.seed)}
    parts = ["\n".join(f"- {key}: {value}" for key, value in shown.items() if value != "not installed")]
    if experiment.plan.quick:
        parts.append("A quick run: counts are cut down, figures mean little.")
    if findings.wrong:
        parts.append(f'WRONG: {findings.wrong} claims of "solved" were rejected.')
    return "\n\n".join([*parts, findings.text]) + "\n"


def _data(experiment: Experiment, facts: dict[str, str], findings: Findings) -> str:
    plan = experiment.plan
    head = {"experiment": experiment.name, "machine": facts, "seed": plan.seed, "quick": plan.quick}
    return json_line(plain({**head, "settings": experiment.settings(), "wrong": findings.wrong, **findings.data}))


def _write(folder: Path, name: str, text: str, data: str, figures: dict[str, Any]) -> None:
    for figure, drawn in figures.items():
        drawn.savefig(folder / f"{figure}.png", bbox_inches="tight", pad_inches=0.15)
    (folder / f"{name}.json").write_text(data + "\n", encoding="utf-8")
    (folder / f"{name}.md").write_text(text, encoding="utf-8")


def _say(message: str) -> None:
    sys.stderr.write(f"sinuous: {message}\n")
