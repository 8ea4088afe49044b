"""Work with chunks that fail, or kill their worker."""

import os
import signal
from pathlib import Path

import sinuous as sn
from sinuous.studies.batch.tables.layout import Block
from sinuous.studies.batch.work import Chunk, ChunkSolver
from tests.studies.batch.questions import BALL, OPTIONS, ROBOT


class Poisonous(ChunkSolver):
    """Fails in one chunk, kills its worker in another, and in a third one kills the first worker that tries it."""

    def __init__(self, folder: Path, raising: int = -1, killing: int = -1, unlucky: int = -1) -> None:
        super().__init__(sn.Solver(ROBOT, [BALL], **OPTIONS))
        self._folder, self._raising, self._killing, self._unlucky = folder, raising, killing, unlucky

    def __call__(self, chunk: Chunk) -> Block:
        with (self._folder / "tried").open("a", encoding="utf-8") as out:
            out.write(f"{chunk.number}\n")
        if chunk.number == self._raising:
            raise RuntimeError("as asked")
        tried = (self._folder / "tried").read_text(encoding="utf-8").split().count(str(chunk.number))
        if chunk.number == self._killing or (chunk.number == self._unlucky and tried == 1):
            os.kill(os.getpid(), signal.SIGKILL)
        return super().__call__(chunk)
