"""What every engine does: take a chunk, and give its answer in the future."""

import pickle
from abc import ABC, abstractmethod
from concurrent.futures import Future

from sinuous.batch.tables.blocks import Block
from sinuous.batch.work import Task, Work
from sinuous.errors import InputError
from sinuous.scene.grids.field import Field


class LostError(Exception):
    """The engine is gone, and no chunk can be solved any more; its text says what happened."""


class Engine(ABC):
    """Solves chunks elsewhere.

    Attributes
    ----------
    hands : int
        Chunks that are given out at the same time, so that no worker waits.
    gone : str
        What has happened when chunks are cancelled that nobody cancelled.
    """

    hands: int
    gone = "the workers are gone"

    @abstractmethod
    def submit(self, task: Task) -> "Future[Block]":
        """Give a chunk out.

        Raises
        ------
        LostError, BrokenExecutor
        """

    def mend(self) -> None:
        """Begin anew after workers died, with none of the chunks that were given out.

        Raises
        ------
        LostError
            When this engine cannot.
        """
        raise LostError("the executor broke: a worker died")

    @abstractmethod
    def close(self, now: bool) -> None:
        """End; `now` without waiting for what was given out."""


def pickled(work: Work) -> bytes:
    """Return the work as it travels to other processes.

    Raises
    ------
    InputError
        When the scene holds what cannot travel.
    """
    try:
        return pickle.dumps(work, pickle.HIGHEST_PROTOCOL)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        scene = work.scene
        for i, obstacle in enumerate(scene.obstacles):
            if isinstance(obstacle, Field):
                told = "a function of a module that workers can import too, or the engine threads"
                raise InputError(f"scene[{i}]", f"cannot travel: {error}", obstacle.function, told) from None
        raise
