"""What many tests need: cases, refusals, samples at the delicate places, and the exponential map by other code."""

import ast
import inspect
import math
from collections.abc import Callable, Iterable, Sequence
from functools import cache, lru_cache, partial, wraps
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm

import sinuous as sn
from sinuous.kernels import packing
from sinuous.kernels import problem as kernels
from sinuous.kernels.body.rows import IDLE, Rows
from sinuous.kernels.chain import kinematics as chain
from sinuous.kernels.chain.arc import SERIES_END
from sinuous.kernels.fields import distances
from sinuous.model.robot import robot_group
from sinuous.problem.problem import settings_group
from sinuous.scene.snapshot import Snapshot
from sinuous.statics.rest import Rest

PACKAGE = Path(sn.__file__).parent

Floats = NDArray[np.float64]
T = TypeVar("T")
Vec = tuple[float, float, float]
Mat = tuple[Vec, Vec, Vec]

# Straight, nearly straight, both sides of the end of the power series, around half and whole turns.
BENDS = (
    0.0,
    1e-200,
    1e-12,
    1e-6,
    1e-3,
    0.1,
    0.5,
    1.3,
    math.pi - 1e-7,
    math.pi,
    math.pi + 1e-7,
    math.sqrt(SERIES_END) - 1e-9,
    math.sqrt(SERIES_END) + 1e-9,
    4.5,
    2 * math.pi - 1e-9,
    2 * math.pi,
)
LENGTHS = (0.0, 1e-6, 1.0, 60.0)


class Unpickled:
    """What must not be read from a file."""

    def __reduce__(self) -> Any:
        return pytest.fail, ("unpickled",)


@cache
def parsed(file: Path) -> ast.Module:
    return ast.parse(file.read_text(encoding="utf-8"))


@cache
def statements_of(file: Path) -> list[ast.AST]:
    """All statements of a file, those within others too; expressions, of which there are ten times as many, are not."""
    found: list[ast.AST] = [parsed(file)]
    for node in found:
        inner = ast.iter_child_nodes(node)
        found.extend(each for each in inner if isinstance(each, ast.stmt | ast.excepthandler | ast.match_case))
    return found


def configurations(seed: int, segments: int, count: int) -> list[Floats]:
    """Sample configurations: bends of `BENDS` and between them in all directions, lengths of `LENGTHS` and between."""
    rng = np.random.default_rng(seed)
    out = []
    for _ in range(count):
        shape = (segments,)
        bends = np.where(rng.random(shape) < 0.6, rng.choice(BENDS, shape), rng.uniform(0.0, 2.0 * math.pi, shape))
        lengths = np.where(rng.random(shape) < 0.3, rng.choice(LENGTHS, shape), rng.uniform(0.0, 3.0, shape))
        angles = np.where(rng.random(shape) < 0.2, 0.0, rng.uniform(-math.pi, math.pi, shape))
        out.append(np.stack([bends * np.cos(angles), bends * np.sin(angles), lengths], axis=-1))
    return out


def twist_matrix(q: NDArray[Any]) -> NDArray[Any]:
    """Give the body twist of one segment (3,) as a matrix (4, 4); complex coordinates pass through."""
    ux, uy, length = q
    zero = 0.0 * ux
    return np.array(
        [[zero, zero, ux, zero], [zero, zero, uy, zero], [-ux, -uy, zero, length], [zero, zero, zero, zero]]
    )


def expm_chain(q: NDArray[Any], base: NDArray[Any] | None = None) -> list[NDArray[Any]]:
    """Poses of the base and of every segment's end, by the matrix exponential."""
    poses: list[NDArray[Any]] = [np.eye(4) if base is None else base]
    for row in q:
        poses.append(poses[-1] @ _exponential(*row.tolist()))
    return poses


@lru_cache(maxsize=1024)
def _exponential(ux: complex, uy: complex, length: complex) -> NDArray[Any]:
    """Exponential of the twist of a segment; derivatives in one coordinate ask for those of the others again."""
    return np.asarray(expm(twist_matrix(np.array([ux, uy, length]))))


def complex_columns(function: Callable[[NDArray[Any]], NDArray[Any]], q: Floats) -> Floats:
    """Derivatives of `function` in every coordinate of `q`, last axis, to machine precision: complex step."""
    out = []
    for i in range(q.size):
        stepped = q.astype(complex)
        stepped.flat[i] += 1e-30j
        out.append(np.imag(function(stepped)) / 1e-30)
    return np.stack(out, axis=-1)


def twist_of(rate: Floats, pose: Floats) -> Floats:
    """Spatial twist (omega, v) about the origin of a pose (4, 4) that changes at this rate (4, 4)."""
    spatial = rate @ np.linalg.inv(pose)
    return np.array([spatial[2, 1], spatial[0, 2], spatial[1, 0], *spatial[:3, 3]])


def random_unit(rng: np.random.Generator) -> Floats:
    x = rng.normal(size=3)
    return np.asarray(x / np.linalg.norm(x), np.float64)


def random_rotation(rng: np.random.Generator) -> Floats:
    x = rng.normal(size=3)
    return np.asarray(expm(skew(x)), np.float64)


def skew(x: Any) -> Floats:
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]])


def random_pose(rng: np.random.Generator, size: float = 1.0) -> Floats:
    result = np.eye(4)
    result[:3, :3] = random_rotation(rng)
    result[:3, 3] = rng.normal(size=3) * size
    return result


def as_matrix(rotation: Any, position: Any) -> Floats:
    result = np.eye(4)
    result[:3, :3], result[:3, 3] = rotation, position
    return result


def vec(x: Any) -> Vec:
    """Three numbers as kernels take them."""
    return (float(x[0]), float(x[1]), float(x[2]))


def mat(x: Any) -> Mat:
    return (vec(x[0]), vec(x[1]), vec(x[2]))


def frames_of(q: Floats, base: Floats | None = None) -> Floats:
    """Frames (n + 1, 12) of a configuration, by the kernel."""
    frames = np.zeros((len(q) + 1, 12))
    pose = np.eye(4) if base is None else base
    frames[0] = [*pose[:3, :3].ravel(), *pose[:3, 3]]
    chain.forward(packing.plain_rows(len(q)), q, frames)
    return frames


def columns_of(q: Floats, base: Floats | None = None) -> Floats:
    """Columns (n, 18) of a configuration, about its base, by the kernel."""
    frames, columns = frames_of(q, base), np.full((len(q), 18), np.nan)
    chain.forward_with_columns(packing.plain_rows(len(q)), q, frames, columns)
    return columns


def kernel_scene(scene: sn.Scene | Snapshot) -> distances.Scene:
    """A scene as the kernels take it."""
    return distances.Scene(*packing.scene_parts(scene.group.copy()))


def kernel_groups(problem: sn.Problem) -> tuple[Floats, Floats, Floats, Floats]:
    """Robot, scene, settings and targets of one problem, as entries take them; nobody else holds them."""
    settings = settings_group(problem.robot, problem.tolerance)
    return robot_group(problem.robot), problem.scene.group.copy(), settings, problem.rows.copy()


def kernel_problem(
    robot: sn.Robot, targets: Any, scene: Any = None, tolerance: sn.Tolerance | None = None, **changed: Any
) -> kernels.Problem:
    """One problem as kernels see it; fields can be changed by name."""
    return kernels.read_problem(*kernel_groups(sn.Problem(robot, targets, scene, tolerance)))._replace(**changed)


def make_rows(segments: int, capacity: int) -> Rows:
    """Rows of their own memory, all idle."""
    return Rows(
        np.zeros(segments + 1, np.int64),
        np.full(capacity, IDLE, np.int64),
        np.zeros((capacity, 6)),
        np.zeros((capacity, 3)),
        np.zeros((capacity, 3)),
        np.zeros(capacity),
        np.zeros((capacity, 13)),
        np.zeros(capacity),
    )


def present(value: T | None) -> T:
    """Demand that there is a value, and return it."""
    assert value is not None
    return value


def states_of(rests: Iterable[Rest]) -> tuple[Floats, ...]:
    """Drives, states and displacements of shapes of elastic robots at rest, as judges of these take them."""
    parts = [(each.q, each.found[0], each.displacements) for each in rests if each.displacements is not None]
    return tuple(np.stack(part) for part in zip(*parts, strict=True))


def refused(key: str, call: Callable[[], Any], *words: str, file: Path | str = "") -> sn.InputError:
    """Demand that a call is refused, in one line that names the key, after a file if one is given; return the error."""
    with pytest.raises(sn.InputError) as caught:
        call()
    error = caught.value
    text = str(error)
    assert error.key == key, text
    assert "\n" not in text
    assert len(text) < 400
    assert text.startswith(f"{file}: {key}: " if file else f"{key}: ")
    assert ("expected " in text and (error.value is None or ", got " in text)) or "did you mean " in text
    for word in words:
        assert word in text
    return error


def refused_each(key: str, values: Iterable[Any], call: Callable[[Any], Any], *words: str) -> None:
    """Demand that a call is refused with each of these values."""
    for value in values:
        refused(key, partial(call, value), *words)


NOT_NUMBERS: Sequence[Any] = (float("nan"), float("inf"), -float("inf"), "1", True, None, [1.0], 1j, 10**400)
"""Nothing that a number may be."""

NOT_VECTORS: Sequence[Any] = (
    "abc",
    None,
    3.0,
    True,
    (1.0, 2.0),
    (1.0, 2.0, 3.0, 4.0),
    (1.0, float("nan"), 0.0),
    (1.0, float("inf"), 0.0),
    (1.0, "2", 3.0),
    (1.0, None, 3.0),
    (True, False, True),
    (1.0, True, 0.0),
    (1.0, (2.0, 3.0), 4.0),
    (1j, 0.0, 0.0),
    {"x": 1.0},
    [[1.0, 2.0, 3.0]],
)
"""Nothing that a point may be."""


Test = Callable[..., None]


def with_each(
    names: str | tuple[str, ...], cases: Iterable[Any] | Callable[[], Iterable[Any]]
) -> Callable[[Test], Test]:
    """Try a test with each of these cases, given as to `pytest.mark.parametrize`; an error names the case.

    Of many small cases: pytest alone takes longer for a test of its own than such a case does.

    A function that returns cases is called by the test: what takes long, or compiles, is not made while tests are
    collected, when the other processes wait.
    """
    keys = (names,) if isinstance(names, str) else names
    given = list(cases) if isinstance(cases, Iterable) else cases  # an enumeration can be called, too

    def all_of(test: Test) -> Test:
        @wraps(test)
        def tried(**others: Any) -> None:
            for one in given() if callable(given) else given:
                case = dict(zip(keys, (one,) if isinstance(names, str) else one, strict=True))
                try:
                    test(**others, **case)
                except Exception as error:
                    error.add_note(f"with {case}")
                    raise

        signature = inspect.signature(test)
        rest = [one for name, one in signature.parameters.items() if name not in keys]
        tried.__signature__ = signature.replace(parameters=rest)  # type: ignore[attr-defined]
        return tried

    return all_of
