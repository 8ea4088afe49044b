"""Work that is done at once, that fails in some tasks, and that kills its worker in others."""

import os
import signal
from collections import Counter
from pathlib import Path

import sinuous as sn
from sinuous.studies.runs.engine import Arrays


class Poisonous:
    """Squares numbers; fails in one task, kills its worker in another, in a third one the first worker that tries it.

    Each task has the number of its first row.
    """

    def __init__(self, folder: Path, raising: int = -1, killing: int = -1, unlucky: int = -1) -> None:
        self.scene = sn.Scene()
        self._folder, self._raising, self._killing, self._unlucky = folder, raising, killing, unlucky

    def prepare(self) -> "Poisonous":
        return self

    def __call__(self, task: Arrays) -> Arrays:
        number = int(task["values"][0])
        with (self._folder / "tried").open("a", encoding="utf-8") as out:
            out.write(f"{number}\n")
        if number == self._raising:
            raise RuntimeError("as  asked")
        if number == self._killing or (number == self._unlucky and self.tried()[number] == 1):
            os.kill(os.getpid(), signal.SIGKILL)
        return {"squares": task["values"] ** 2}

    def tried(self) -> Counter[int]:
        """How often each task was begun."""
        return Counter(map(int, (self._folder / "tried").read_text(encoding="utf-8").split()))
