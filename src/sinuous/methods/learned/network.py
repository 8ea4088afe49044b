"""What was learned of one robot: a small network for each kind of target, from its numbers to a shape."""

import hashlib
import json
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, Unpack

import numpy as np

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.documents import read_archive, write_archive
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen
from sinuous.files.nouns import read_robot
from sinuous.kernels.packing import read_only
from sinuous.kernels.tables import GOAL, ORIENTATION, TARGET_POSITION
from sinuous.methods.method import Capabilities
from sinuous.model.robot import Robot, same_body
from sinuous.problem.target import GoalArrays, Targets
from sinuous.problem.target_sets import read_target_sets

FORMAT = 1
"""Version of the file; the kind of file is told by the key `network`."""

KINDS = ("position", "direction", "rotation")
"""What a target of the tip may ask for, in the order of `FREE`, `DIRECTION` and `ROTATION`: each has a network."""

INPUTS = (3, 6, 12)
"""Numbers of such a target: the position, then the direction or the rotation, row by row."""

MOST_WIDTH, MOST_LAYERS = 1024, 8
"""Most units of a hidden layer, and most layers."""

CAPABILITIES = Capabilities("after the idea of Thuruthel et al. 2019 and Wu et al. 2021", rotation=True, planes=True)
"""What a network can be asked for. It has learned from answers among obstacles, but no step after it looks at any."""

Layers = tuple[Floats, ...]
"""Matrices (inputs + 1, outputs), from the first layer on; the last row is what is added."""


class Network(Frozen):
    """What was learned of a robot: networks for positions, positions with directions, and with rotations; see `train`.

    Hidden layers have `tanh`, the last one none: it gives the configuration, in rad and the length unit.

    Parameters
    ----------
    robot : Robot
        The robot whose shapes these are.
    layers : sequence of sequences of array_like (inputs + 1, outputs)
        Of the networks for positions, directions and rotations; the last row of a matrix is what is added.

    Raises
    ------
    InputError
        When an argument is not what it should be.
    """

    def __init__(self, robot: Robot, layers: Sequence[Sequence[Any]]) -> None:
        checks.instance("robot", robot, Robot, "a Robot")
        if len(layers) != len(KINDS):
            raise InputError("layers", "", len(layers), f"{len(KINDS)} networks: for " + ", ".join(KINDS))
        read = [_read(f"layers[{i}]", own, INPUTS[i], 3 * len(robot)) for i, own in enumerate(layers)]
        self._set(robot=robot, layers=tuple(read))

    robot: Robot
    layers: tuple[Layers, ...]

    def shapes(self, targets: Iterable[Targets] | None = None, **arrays: Unpack[GoalArrays]) -> Floats:
        """Return a configuration (m, n, 3) for each target, near to one that meets it: `initial` for a solve.

        Parameters
        ----------
        targets : iterable of Target, optional
            Or arrays, as for `Solver.solve_many`.

        Raises
        ------
        InputError
            When an argument is not what it should be, or a target is not one of the tip with a position.
        """
        sets = read_target_sets(self.robot, targets, arrays)
        found = np.empty((len(sets), len(self.robot), 3))
        for first, last in sets.runs():
            rows = sets.chunk(first, last)
            for each in rows:
                CAPABILITIES.refuse_targets("learned", each, len(self.robot))
            for kind, layers in enumerate(self.layers):
                some = np.flatnonzero(rows[:, 0, ORIENTATION] == kind)
                found[first + some] = evaluate(layers, inputs(rows[some, 0], kind)).reshape(-1, len(self.robot), 3)
        return found

    def save(self, file: str | Path) -> None:
        """Write it as NPZ, in one step: a file that was there stays until the new one is complete.

        Raises
        ------
        InputError
            When the file cannot be written.
        """
        named = zip(KINDS, self.layers, strict=True)
        own: dict[str, Any] = {f"{kind}_{i}": each for kind, layers in named for i, each in enumerate(layers)}
        write_archive(file, network=FORMAT, robot=json.dumps(self.robot.to_dict()), **own)

    @classmethod
    def load(cls, file: str | Path) -> "Network":
        """Read what `save` wrote.

        Raises
        ------
        InputError
            When it is no such file.
        """
        with read_archive(file, "network", (FORMAT,), "a file that Network.save wrote") as data:
            names = [[f"{kind}_{i}" for i in range(MOST_LAYERS + 1)] for kind in KINDS]
            layers = [[data[name] for name in own if name in data] for own in names]
            return cls(read_robot(json.loads(str(data["robot"]))), layers)

    def check(self, robot: Robot) -> None:
        """Refuse to serve another robot, whatever clearances it demands.

        Raises
        ------
        InputError
        """
        if not same_body(robot, self.robot):
            raise InputError("network", "of another robot", self, f"one that was trained for {robot}")

    def table(self) -> Floats:
        """All numbers as the kernel reads them: see `search.predict`."""
        return np.concatenate([_packed(layers) for layers in self.layers])

    def _shown(self) -> Iterator[str]:
        yield f"{len(self.robot.segments)} segments"
        yield hashlib.sha256(self.table().tobytes()).hexdigest()[:12]
        yield "-".join(str(each.shape[1]) for each in self.layers[0][:-1]) + " units"


def _read(key: str, layers: Any, size: int, outputs: int) -> Layers:
    """Check a network from so many numbers to so many."""
    checks.integer(f"len({key})", len(layers), 1, MOST_LAYERS)
    read = []
    for i, given in enumerate(layers):
        last = i == len(layers) - 1
        own = np.asarray(given)
        width = outputs if last else checks.integer(f"{key}[{i}]", own.shape[-1] if own.ndim == 2 else 0, 1, MOST_WIDTH)
        read.append(read_only(checks.array(f"{key}[{i}]", given, (size + 1, width))))
        size = width
    return tuple(read)


def inputs(rows: Floats, kind: int) -> Floats:
    """Numbers (m, 3, 6 or 12) of targets, rows (m, 15), that ask for this kind of orientation."""
    places, goals = rows[:, TARGET_POSITION : TARGET_POSITION + 3], rows[:, GOAL : GOAL + INPUTS[kind] - 3]
    return np.concatenate([places, goals], axis=1)


def evaluate(layers: Layers, values: Floats) -> Floats:
    """What a network makes of its inputs (m, i): outputs (m, o)."""
    for each in layers[:-1]:
        values = np.tanh(values @ each[:-1] + each[-1])
    return values @ layers[-1][:-1] + layers[-1][-1]


def _packed(layers: Layers) -> Floats:
    """Length of what follows; how many layers; outputs of each; matrices, row by row."""
    sizes = [each.shape[1] for each in layers]
    own = np.concatenate([[len(layers)], sizes, *(each.ravel() for each in layers)])
    return np.concatenate([[len(own)], own])
