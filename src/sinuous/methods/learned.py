"""The method `learned`: the answer of a network, then damped steps from it; the networks, and their training.

A network for each kind of target leads from its numbers to a shape. In training, targets of drawn shapes are solved,
and a network learns which shape belongs to which target. A perceptron that learned the drawn shapes themselves would
learn the mean of all that meet a target, which misses it. So each target is solved by our own method, always from the
same start: its answers change little where targets do.

`MLPRegressor` of scikit-learn was tried in the place of `_learn`: its rate of learning does not fall for Adam, so that
networks of the same size missed by 7 to 26 % more, after 2.3 times the CPU time; and it would be one more package.

Thuruthel et al. 2019 and Wu et al. 2021 let networks learn what a robot does; of both only what others say could be
had. Here it is a perceptron for each kind of target, trained with solutions of this library. The steps after it are
those of `dls`; without any, the answer is that of the network.
"""

import hashlib
import json
import math
from collections import namedtuple
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any, ClassVar, Self, Unpack

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Truth, Whole
from sinuous.base.checks import Floats
from sinuous.base.documents import read_archive, write_archive
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen
from sinuous.base.progress import ProgressBar
from sinuous.files.nouns import read_robot
from sinuous.kernels import tables as t
from sinuous.kernels.compile import code_first
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import Array, copy
from sinuous.kernels.packing import read_only
from sinuous.kernels.problem import Problem
from sinuous.kernels.tables import GIVEN, GOAL, ORIENTATION, REMEMBERED, TARGET_POSITION, answer_size
from sinuous.methods.dls import carve as carve_steps
from sinuous.methods.dls import descend, scratch_size
from sinuous.methods.method import Capabilities, OptionKind, Options, count
from sinuous.methods.newton import Newton
from sinuous.methods.search import NO_START, Answer, Check, Start, offer, own_number, search_by
from sinuous.model.robot import Robot, same_body
from sinuous.problem.problem import Preferences
from sinuous.problem.target import GoalArrays, Targets, Tolerance
from sinuous.problem.target_sets import read_target_sets
from sinuous.scene.scene import Scene, SceneLike, as_scene

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


LARGEST_BEND = 0.5 * math.pi
"""Most bend of a segment of drawn shapes, in rad, where its limits allow as much."""

SOLVE_STARTS, SOLVE_SECONDS = 4, 10.0
"""Most starts of a target, which end it, and a time that no machine needs for them: a seed gives one network."""

FEWEST_TARGETS = 100
"""Solved targets from which a network can learn; where obstacles leave fewer, the robot alone is learned."""

HIDDEN_LAYERS, BATCH_SIZE = 2, 64
"""Hidden layers; most targets of a step."""

ONE_THREAD_PRODUCTS = 280_000
"""Multiplications of a product of matrices up to which it is done in one thread: more only wait for each other."""

FIRST_RATE, MEAN_DECAY, SQUARE_DECAY = 1e-2, 0.9, 0.999
"""Of Adam (Kingma & Ba 2015): the first rate, which falls to 0 as a cosine, and how long averages remember."""


def train(
    robot: Robot,
    scene: SceneLike | None = None,
    *,
    samples: Whole = 5_000,
    width: Whole = 64,
    rounds: Whole = 40,
    seed: Whole = 0,
    progress: Truth = False,
) -> Network:
    """Let networks learn the shapes of a robot, for the method `learned` and as starts of others.

    Shapes are drawn, and their tips are solved as targets of each kind: positions, with directions, with rotations.
    In a scene, what is learned is clear. It takes some seconds; the same seed gives the same network.

    Parameters
    ----------
    robot : Robot
    scene : Scene or list of obstacles, optional
    samples : int
        Targets of each kind.
    width : int
        Units of each of the two hidden layers.
    rounds : int
        How often all targets are gone through.
    seed : int
    progress : bool
        Whether to show on a terminal how far it is.

    Returns
    -------
    Network

    Raises
    ------
    InputError
        When an argument is not what it should be, or the robot hardly reaches any of its own tips.
    """
    checks.instance("robot", robot, Robot, "a Robot")
    robot._refuse_load()
    place = as_scene(scene)
    count = checks.integer("samples", samples, FEWEST_TARGETS, 10_000_000)
    hidden = checks.integer("width", width, 1, MOST_WIDTH)
    most = checks.integer("rounds", rounds, 1, 1_000_000)
    rng = np.random.default_rng(checks.integer("seed", seed, 0, 2**31 - 1))
    with ProgressBar(len(KINDS) * most if checks.truth("progress", progress) else 0) as bar, code_first():
        lessons = [_lessons(robot, place, kind, count, rng) for kind in range(len(KINDS))]
        return Network(robot, [_learn(*each, hidden, most, rng, bar.advance) for each in lessons])


def _lessons(robot: Robot, scene: Scene, kind: int, count: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Numbers (m, i) of solved targets of this kind, and the shapes (m, 3 n) that meet them."""
    tips = robot.tip(_draw(robot, count, rng))
    rows = np.zeros((count, 1, t.TARGET_WIDTH))
    rows[:, 0, t.TARGET_SEGMENT], rows[:, 0, t.HAS_POSITION], rows[:, 0, t.ORIENTATION] = -1, 1.0, kind
    rows[:, 0, t.TARGET_POSITION : t.TARGET_POSITION + 3] = tips[:, :3, 3]
    goals = tips[:, :0, 0], tips[:, :3, 2], tips[:, :3, :3].reshape(count, 9)
    rows[:, 0, t.GOAL : t.GOAL + INPUTS[kind] - 3] = goals[kind]
    for place in (scene, Scene()) if len(scene) else (scene,):
        method = Newton().prepare(robot, place, Tolerance().for_robot(robot), Preferences())
        answers = np.empty((count, answer_size(len(robot))))
        initial = np.empty((count, 0, len(robot), 3))
        method.run_many(place.snapshot(), rows, initial, (0, SOLVE_STARTS, 0, SOLVE_SECONDS), answers)
        good = answers[:, t.CODE] == t.SOLVED
        if good.sum() >= FEWEST_TARGETS:
            return inputs(rows[good, 0], kind), answers[good, t.RECORD_WIDTH :]
    raise InputError(
        "robot", "too few training targets are solved", int(good.sum()), f"at least {FEWEST_TARGETS} of {count} solved"
    )


def _draw(robot: Robot, count: int, rng: np.random.Generator) -> Floats:
    """Shapes (count, n, 3) within the limits of lengths and bends, evenly in these."""
    columns = t.MIN_LENGTH, t.MAX_LENGTH, t.MAX_BEND, t.MAX_CURVATURE
    low, high, bend, curvature = (robot.limits[:, column] for column in columns)
    lengths = rng.uniform(low, high, (count, len(robot)))
    with np.errstate(invalid="ignore"):  # a joint has no length, and no limit of curvature
        cap = np.minimum(np.fmin(bend, curvature * lengths), LARGEST_BEND)
    size, angle = cap * np.sqrt(rng.random(lengths.shape)), rng.uniform(0.0, 2.0 * math.pi, lengths.shape)
    drawn = np.stack([size * np.cos(angle), size * np.sin(angle), lengths], axis=-1)
    return drawn if robot.drive.coordinates.free else robot.drive.coordinates.project(drawn)


def _learn(
    asked: Floats, shapes: Floats, width: int, rounds: int, rng: np.random.Generator, advance: Callable[[int], object]
) -> Layers:
    """Learn a network from targets (m, i) to shapes (m, o): least mean squares by Adam."""
    centre, scale = asked.mean(axis=0), _spread(asked)
    middle, extent = shapes.mean(axis=0), _spread(shapes)
    x, y = _with_one((asked - centre) / scale), (shapes - middle) / extent
    sizes = [asked.shape[1], *[width] * HIDDEN_LAYERS, y.shape[1]]
    layers = [np.vstack([rng.normal(size=(i, o)) / math.sqrt(i), np.zeros(o)]) for i, o in pairwise(sizes)]
    means, squares = ([np.zeros_like(each) for each in layers] for _ in range(2))
    batch = max(1, min(BATCH_SIZE, ONE_THREAD_PRODUCTS // (width + 1) ** 2))
    most, step = rounds * math.ceil(len(x) / batch), 0
    for _ in range(rounds):
        order = rng.permutation(len(x))
        for first in range(0, len(x), batch):
            some = order[first : first + batch]
            step += 1
            rate = 0.5 * FIRST_RATE * (1.0 + math.cos(math.pi * step / most)) / (1.0 - MEAN_DECAY**step)
            for i, slope in enumerate(_slopes(layers, x[some], y[some])):
                means[i] += (1.0 - MEAN_DECAY) * (slope - means[i])
                squares[i] += (1.0 - SQUARE_DECAY) * (slope * slope - squares[i])
                layers[i] -= rate * means[i] / (np.sqrt(squares[i] / (1.0 - SQUARE_DECAY**step)) + 1e-8)
        advance(1)
    layers[0][:-1] /= scale[:, None]
    layers[0][-1] -= centre @ layers[0][:-1]
    layers[-1] *= extent
    layers[-1][-1] += middle
    return tuple(layers)


def _slopes(layers: list[Floats], x: Floats, y: Floats) -> list[Floats]:
    """Derivatives of the mean squared error in all matrices: inputs (m, i + 1), with a column of 1, wanted (m, o)."""
    passed = [x]
    for each in layers[:-1]:
        passed.append(_with_one(np.tanh(passed[-1] @ each)))
    back = (passed[-1] @ layers[-1] - y) * (2.0 / len(x))
    slopes = []
    for each, own in zip(reversed(layers), reversed(passed), strict=True):
        slopes.append(own.T @ back)
        back = (back @ each[:-1].T) * (1.0 - own[:, :-1] ** 2)
    return slopes[::-1]


def _with_one(values: Floats) -> Floats:
    return np.concatenate([values, np.ones((len(values), 1))], axis=1)


def _spread(values: Floats) -> Floats:
    """Standard deviations (k,); 1 where nothing varies."""
    own = values.std(axis=0)
    return np.where(own > 1e-12 * np.abs(values).max(initial=1.0), own, 1.0)


DAMPING, CLAMP = 0.1, 0.5
"""Of the steps: see `Dls`, whose defaults these are."""

Pass = namedtuple("Pass", ["before", "after"])
"""Scratch: the numbers (1025,) that go into a layer and come out of it."""


def carve(buffer: Array) -> tuple[Pass, Array]:
    """Lay out the scratch in `buffer`; returns it and what is left."""
    before, rest = cut(buffer, 1, MOST_WIDTH)
    after, rest = cut(rest, 1, MOST_WIDTH)
    return Pass(before[0], after[0]), rest


def predict(networks: Array, row: Array, scratch: Pass, q: Array) -> None:
    """Fill `q` (n, 3) with the shape for a target `row` (15,), in rad and the length unit.

    `networks` holds, for each kind of orientation: the length of what follows; how many layers; outputs of each; the
    matrices (inputs + 1, outputs), row by row, of which the last row is added.
    """
    at, kind = 0, int(row[ORIENTATION])
    for _ in range(kind):
        at += int(networks[at]) + 1
    layers = int(networks[at + 1])
    sizes = at + 2
    at = sizes + layers
    inputs = 3 if kind == 0 else 6 if kind == 1 else 12
    for i in range(inputs):
        scratch.before[i] = row[TARGET_POSITION + i] if i < 3 else row[GOAL + i - 3]
    for layer in range(layers):
        outputs = int(networks[sizes + layer])
        for j in range(outputs):
            scratch.after[j] = networks[at + inputs * outputs + j]
        for i in range(inputs):
            x = scratch.before[i]
            for j in range(outputs):
                scratch.after[j] += x * networks[at + i * outputs + j]
        at += (inputs + 1) * outputs
        for j in range(outputs):
            scratch.before[j] = scratch.after[j] if layer == layers - 1 else math.tanh(scratch.after[j])
        inputs = outputs
    for i in range(inputs):
        q[i // 3, i % 3] = scratch.before[i]


def follow(
    problem: Problem, check: Check, scratch: Array, options: Array, start: Start, answer: Answer
) -> tuple[int, bool]:
    """Follow one start; see `sinuous.methods.search`. The `options` are the steps, then the networks."""
    own, rest = carve(scratch)
    work = carve_steps(rest, problem.limits.shape[0])
    number, source = own_number(start), REMEMBERED
    if number > 0:
        return NO_START, False
    if number < 0:
        copy(start.initial[start.index], work.q)
        source = GIVEN
    else:
        predict(options[1:], problem.targets[0], own, work.q)
    used = descend(problem, check, work, int(options[0]), DAMPING, CLAMP)
    return used, offer(problem, check, work.kept, source, answer)


search = search_by(follow)


def _network(key: str, value: Any) -> Network | None:
    checks.instance(key, value, Network | None, "a Network, as sn.methods.train returns it")
    return value


@dataclass(frozen=True, repr=False)
class Learned(Options):
    """Options of the method `learned`.

    Attributes
    ----------
    network : Network, optional
        What was learned of this robot; without it, a solver trains one while it is made, as `train` does by default.
    steps : int
        Most damped least-squares steps from the answer of the network; 0: none.
    """

    compiled_search = staticmethod(search)
    method: ClassVar[str] = "learned"
    capabilities: ClassVar[Capabilities] = CAPABILITIES

    network: Network | None = field(default=None, metadata={"kind": OptionKind(_network, read=Network.load)})
    steps: int = count(200, 0, 1_000_000)

    def refuse(self, robot: Robot) -> None:
        """Refuse a network of another robot; see `Options.refuse`."""
        if self.network is not None:
            self.network.check(robot)

    def ready(self, robot: Robot, scene: Scene) -> Self:
        """Train a network where there is none; see `Options.ready`."""
        return self if self.network is not None else replace(self, network=train(robot, scene))

    def scratch(self, segments: int) -> int:
        """Return the size of the scratch; see `Options.scratch`."""
        return 2 * MOST_WIDTH + scratch_size(segments)

    def told(self, robot: Robot, scene: Scene) -> Floats:
        """Return the number of steps, then the networks; see `Options.told`."""
        network = self.ready(robot, scene).network
        assert network is not None
        return np.concatenate([[float(self.steps)], network.table()])
