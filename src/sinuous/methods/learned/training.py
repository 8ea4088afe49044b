"""Training: targets of drawn shapes are solved, and a network learns which shape belongs to which target.

A perceptron that learned the drawn shapes themselves would learn the mean of all that meet a target, which misses it.
So each target is solved by our own method, always from the same start: its answers change little where targets do.

`MLPRegressor` of scikit-learn was tried in the place of `_learn`: its rate of learning does not fall for Adam, so that
networks of the same size missed by 7 to 26 % more, after 2.3 times the CPU time; and it would be one more package.
"""

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Truth, Whole
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.progress import ProgressBar
from sinuous.kernels import tables as t
from sinuous.kernels.compile import code_first
from sinuous.kernels.tables import answer_size
from sinuous.methods.learned.network import INPUTS, KINDS, MOST_WIDTH, Layers, Network, inputs
from sinuous.methods.newton import Newton
from sinuous.model.robot import Robot
from sinuous.problem.problem import Preferences
from sinuous.problem.target import Tolerance
from sinuous.scene.scene import Scene, SceneLike, as_scene

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
