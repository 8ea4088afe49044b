"""What was measured, one JSON line a piece, written as soon as it is there: an interrupted run goes on from it."""

import hashlib
import json
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import benchmarks
import sinuous
from sinuous.base.errors import InputError
from sinuous.files.documents import json_line

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
