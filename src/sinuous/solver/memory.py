"""What one robot has solved before, and what it can move between: starts, and ways, for what is asked next."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.arguments import Batch, Number, Truth
from sinuous.base.checks import Floats
from sinuous.base.documents import read_archive, write_archive
from sinuous.base.errors import InputError
from sinuous.base.frozen import ShortRepr
from sinuous.model.robot import Robot, same_body
from sinuous.problem.target import Targets, target_list, target_table
from sinuous.solver.shapes import NEAREST, Shapes

FORMAT = 2
"""Version of the file; the kind of file is told by the key `memory`."""

MEGABYTES = 100.0
"""Default bound of a memory."""


class Memory(ShortRepr):
    """Shapes of one robot that met earlier targets, and proved motions between some of them.

    A solve with a memory tries the shapes whose poses are nearest to its targets before it searches, and adds what it
    finds. A plan with a memory looks for a way along the motions before it searches; `explore` fills them in ahead.
    What is remembered is where an answer begins and never an answer: it is followed and proved like any other, so the
    memory may be of another scene, or of one that has changed since. For the same memory and seed the answer is the
    same. Safe to share between threads.

    Parameters
    ----------
    robot : Robot
        The robot whose shapes these are.
    megabytes : float
        Most memory that is used, in 10^6 bytes. When it is full, the older half of the shapes that no motion joins is
        forgotten.
    learns : bool
        Whether solves and plans add what they find.

    Attributes
    ----------
    robot : Robot
    megabytes : float
    learns : bool

    Raises
    ------
    InputError
        When an argument is not what it should be.

    Examples
    --------
    >>> memory = sn.Memory(robot)
    >>> solver = sn.Solver(robot, scene, memory=memory)
    >>> memory.save("arm.memory.npz")
    """

    def __init__(self, robot: Robot, megabytes: Number = MEGABYTES, learns: Truth = True) -> None:
        checks.instance("robot", robot, Robot, "a Robot")
        self.robot = robot
        self.megabytes = checks.number("megabytes", megabytes, above=0.0)
        self.learns = checks.truth("learns", learns)
        self._shapes = Shapes(robot, self.megabytes)
        self._explored: Explored | None = None

    def __len__(self) -> int:
        return len(self._shapes)

    @property
    def q(self) -> Floats:
        """All shapes that are kept (m, n, 3), the oldest first; a copy."""
        return self._shapes.q

    @property
    def edges(self) -> NDArray[np.int64]:
        """Numbers (e, 2) of the shapes between which a motion, linear in q, was proved clear; a copy."""
        return self._shapes.edges

    def add(self, q: Batch) -> None:
        """Keep configurations (n, 3) or (m, n, 3), within the limits of the robot or not.

        Raises
        ------
        InputError
            When it is no configuration of this robot.
        """
        shapes = self.robot.configuration("q", q).reshape(-1, len(self.robot), 3)
        self._shapes.add(shapes[-self._shapes.most :])

    def nearest(self, targets: Targets, count: int = NEAREST) -> Floats:
        """Return the `count` shapes (k, n, 3) whose poses are nearest to the targets, the nearest first.

        A rotation of 1 rad counts as far as half of the robot's mean length.

        Raises
        ------
        InputError
            When an argument is not what it should be.
        """
        most = checks.integer("count", count, 1, 10_000)
        rows = target_table(self.robot, target_list("targets", targets, self.robot))[None]
        return self._shapes.nearest(rows, most)[0]

    def _serves(self, robot: Robot) -> bool:
        """Whether these are shapes of this robot, whatever clearances it demands."""
        return same_body(robot, self.robot)

    def check(self, robot: Robot) -> None:
        """Refuse to serve another robot.

        Raises
        ------
        InputError
        """
        if not self._serves(robot):
            raise InputError("memory", "of another robot", self, f"shapes of {robot}")

    def reading(self) -> "Memory":
        """Return the same as a memory that keeps nothing new."""
        other = Memory(self.robot, self.megabytes, learns=False)
        other._take(self.q, self.edges, self._explored)
        return other

    @property
    def fingerprint(self) -> str:
        """A hash (12 hexadecimal digits) of all that is kept."""
        return self._shapes.fingerprint

    def save(self, file: str | Path) -> None:
        """Write it as NPZ, in one step: a file that was there stays until the new one is complete.

        Raises
        ------
        InputError
            When the file cannot be written.
        """
        own: dict[str, Any] = {"megabytes": self.megabytes, "learns": self.learns, "q": self.q, "edges": self.edges}
        if self._explored is not None:
            own["explored"] = json.dumps(self._explored._asdict())
        write_archive(file, memory=FORMAT, robot=json.dumps(self.robot.to_dict()), **own)

    @classmethod
    def load(cls, file: str | Path) -> "Memory":
        """Read what `save` wrote.

        Raises
        ------
        InputError
            When it is no such file.
        """
        return read_memory(file)

    def _take(self, q: Floats, edges: NDArray[np.int64], explored: "Explored | None") -> None:
        """Keep what another memory kept."""
        kept = q[-self._shapes.most :]
        first = len(q) - len(kept)
        self._shapes.add(kept)
        self._shapes.add(kept[:0], (edges - first)[(edges >= first).all(axis=1)])
        self._explored = explored

    def _learn(self, found: Floats, new: NDArray[np.bool_] | None = None) -> None:
        """Keep those of the solutions (m, n, 3) that are `new` (m,).

        By default these are the ones that differ from the kept shape of the nearest tip.
        """
        if self.learns:
            kept = found[self._shapes.is_new(found) if new is None else new]
            if len(kept):
                self._shapes.add(kept)

    def _learn_way(self, q: Floats) -> None:
        """Keep the knots (T, n, 3) of a motion, and that it is proved."""
        if self.learns:
            numbers = len(self) + np.arange(len(q))
            self._shapes.add(q, np.stack([numbers[:-1], numbers[1:]], axis=1))

    def _shown(self) -> Iterator[str]:
        yield f"{len(self.robot.segments)} segments"
        yield f"{len(self)} shapes"
        if len(edges := self.edges):
            yield f"{len(edges)} motions"

    def __getstate__(self) -> dict[str, Any]:
        own = {"q": self.q, "edges": self.edges, "explored": self._explored}
        return {"robot": self.robot, "megabytes": self.megabytes, "learns": self.learns, **own}

    def __setstate__(self, state: dict[str, Any]) -> None:
        Memory.__init__(self, state["robot"], state["megabytes"], state["learns"])
        self._take(state["q"], state["edges"], state["explored"])


class Explored(NamedTuple):
    """What `explore` knows of its work until now.

    Attributes
    ----------
    scene : str
        A hash of the obstacles among which all motions were proved.
    seed : int
    rounds : int
        How many are done.
    tests : list of (int, int)
        Of the last positions drawn evenly that were solved: whether a shape was near before, and whether one proved
        motion joined it to the largest part.
    """

    scene: str
    seed: int
    rounds: int
    tests: list[tuple[int, int]]


def only_reading(options: dict[str, Any]) -> dict[str, Any]:
    """Return options of a solver of which the memory, if there is one, keeps nothing new: for work that goes on later.

    Its answers depend on what the memory held when it began.
    """
    memory = options.get("memory")
    return {**options, "memory": memory.reading()} if isinstance(memory, Memory) else options


def read_memory(file: str | Path) -> Memory:
    """Read a file that `Memory.save` wrote.

    Raises
    ------
    InputError
        When it is no such file.
    """
    from sinuous.files.nouns import read_robot  # noqa: PLC0415

    with read_archive(file, "memory", (1, FORMAT), "a file that Memory.save wrote") as data:
        robot = read_robot(json.loads(str(data["robot"])))
        memory = Memory(robot, float(data["megabytes"]), learns=bool(data["learns"]))
        q = robot.configuration("q", data["q"])
        edges = data["edges"] if "edges" in data else np.empty((0, 2), np.int64)
        if edges.ndim != 2 or edges.shape[1] != 2 or edges.dtype != np.int64:
            raise InputError("edges", "", edges.shape, "pairs of numbers")
        if len(edges) and not 0 <= edges.min() <= edges.max() < len(q):
            raise InputError("edges", "", [int(edges.min()), int(edges.max())], f"numbers of {len(q)} shapes")
        explored = Explored(**json.loads(str(data["explored"]))) if "explored" in data else None
        memory._take(q.reshape(-1, len(robot), 3), edges, explored)
    return memory
