"""Nouns do not change, and come back equal and read-only from a pickle."""

import copy
import math
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import sinuous as sn
from sinuous.base.frozen import Frozen
from sinuous.files.joint_chain import ChainJoint, JointChain, Link
from sinuous.scene.obstacles import Placement
from tests.helpers import with_each
from tests.scene.shapes import EACH_KIND

ROBOT = sn.Robot(
    [
        sn.Segment((0.8, 1.2), 2.0, tendons=sn.Tendons(3, 0.05, displacement=(-0.3, 0.3))),
        sn.Segment((0.8, 1.2), 2.0, chambers=sn.Chambers(3, 0.05, length=(0.7, 1.3))),
        sn.Segment(1.0, 2.0, max_curvature=1.9, tendons=sn.Tendons(3, 0.05)),
    ],
    radius=0.05,
    base=sn.pose((0.1, 0.2, 0.3), direction=(0, 1, 1)),
    tool=sn.pose((0, 0, 0.1)),
)
TARGET = sn.Target((0.1, 2.0, 2.0), direction=(0, 1, 1))
LAMP = sn.Sphere((1.5, 0.0, 1.0), 0.3, name="lamp")
SCENE = sn.Scene([LAMP, sn.PointCloud(np.array([[3.0, 0.0, 1.0], [3.0, 0.5, 1.0]]), 0.1)])


TABLES = {"Target": ("_table",), "Problem": ("_rows",), "Snapshot": ("_group",)}
"""What kernels read of targets, problems and snapshots; kernels are compiled for writable arrays alone."""


def solution() -> sn.Solution:
    return sn.Solver(ROBOT, SCENE).solve(TARGET)


NOUNS: dict[str, Callable[[], Any]] = {
    **EACH_KIND,
    "robot": lambda: ROBOT,
    "segment": lambda: ROBOT.segments[0],
    "tendons": lambda: ROBOT.segments[0].tendons,
    "chambers": lambda: ROBOT.segments[1].chambers,
    "actuators": lambda: sn.Actuators(np.eye(3), ["a", "b", "c"], [None, (0, 1), None]),
    "target": lambda: TARGET,
    "rotation": lambda: sn.Target(rotation=np.eye(3), segment=2),
    "tolerance": lambda: sn.Tolerance(0.1, 0.2),
    "preferences": lambda: sn.Preferences(bends=1.0),
    "placement": lambda: Placement(2.0, (1, 2, 3)),
    "snapshot": SCENE.snapshot,
    "problem": lambda: sn.Problem(ROBOT, TARGET, SCENE),
    "job": lambda: sn.Job(ROBOT, TARGET, [LAMP]),
    "problems": lambda: sn.Problem(ROBOT, [TARGET, sn.Target((0, 0, 1), segment=1)]),
    "solution": solution,
    "moving": lambda: sn.Moving(LAMP, [0, 1], [(0, 0, 0), (1, 0, 0)]),
    "curve": lambda: sn.Curve(np.eye(3), start=(3, 0, 0)),
    "path": lambda: sn.Path([0, 1, 2], positions=np.eye(3)),
    "chain": lambda: JointChain(ROBOT, 2),
}


KEPT = ("_lock", "_reason", "_worst", "_binding", "_kept_sizes")
"""Attributes that are found out anew when they are asked for, or a lock."""


def attributes(noun: Any) -> dict[str, Any]:
    """Everything that a noun holds, but locks, and what it computes only when it is asked."""
    slots = [name for kind in type(noun).__mro__ for name in getattr(kind, "__slots__", ())]
    names = [*getattr(noun, "__dict__", {}), *slots]
    return {name: getattr(noun, name) for name in names if name not in KEPT}


def public(noun: Any) -> list[str]:
    """Names of everything that users see."""
    properties = [name for name in dir(type(noun)) if isinstance(getattr(type(noun), name), property)]
    return [name for name in {*attributes(noun), *properties} if not name.startswith("_")]


def assert_equal(a: Any, b: Any) -> None:
    """Equal in content, and as writable."""
    assert type(a) is type(b)
    if isinstance(a, Frozen | sn.Solution):
        mine, other = attributes(a), attributes(b)
        assert mine.keys() == other.keys()
        for name in mine:
            assert_equal(mine[name], other[name])
    elif isinstance(a, sn.Scene):
        assert_equal(a.snapshot(), b.snapshot())
    elif isinstance(a, np.ndarray):
        np.testing.assert_array_equal(a, b)
        assert a.dtype == b.dtype
        assert a.flags.writeable == b.flags.writeable
    elif isinstance(a, CubicSpline):
        assert_equal((a.c, a.x), (b.c, b.x))
    elif isinstance(a, ChainJoint | Link):
        assert_equal(vars(a), vars(b))
    elif isinstance(a, dict):
        assert_equal(tuple(a.items()), tuple(b.items()))
    elif isinstance(a, tuple | list):
        assert len(a) == len(b)
        for one, two in zip(a, b, strict=True):
            assert_equal(one, two)
    else:
        assert a == b or (math.isnan(a) and math.isnan(b))


@with_each("name", NOUNS)
def test_attributes_cannot_be_set(name: str) -> None:
    noun = NOUNS[name]()
    assert public(noun)
    for attribute in [*public(noun), "anything"]:
        with pytest.raises(AttributeError):
            setattr(noun, attribute, None)
    for attribute in public(noun):
        with pytest.raises(AttributeError):
            delattr(noun, attribute)


@with_each("name", NOUNS)
def test_arrays_are_read_only_but_those_for_kernels(name: str) -> None:
    noun = NOUNS[name]()
    for attribute in public(noun):
        value = getattr(noun, attribute)
        if isinstance(value, np.ndarray) and attribute not in ("frame", "row", "arms"):  # made anew for every caller
            assert value.flags.writeable == (attribute in TABLES.get(type(noun).__name__, ())), attribute


@with_each("name", NOUNS)
@with_each("protocol", [2, 5])
def test_pickles_come_back_equal(name: str, protocol: int) -> None:
    noun = NOUNS[name]()
    assert_equal(pickle.loads(pickle.dumps(noun, protocol)), noun)


EQUAL = [name for name in NOUNS if name != "solution"]


@with_each("name", EQUAL)
def test_nouns_are_compared_by_what_they_say(name: str) -> None:
    noun = NOUNS[name]()
    assert noun.equals(noun)
    assert noun.equals(pickle.loads(pickle.dumps(noun)))
    for other in EQUAL:
        assert (noun.equals(NOUNS[other]())) == (other == name), other
    assert not noun.equals(None)


def test_the_last_digit_counts() -> None:
    ball: dict[str, Any] = {"center": (1.0, 2.0, 3.0), "radius": 0.5}
    assert sn.Sphere(**ball).equals(sn.Sphere(**ball))
    center = 1.0, 2.0, np.nextafter(3.0, 4.0)
    for change in ({"center": center}, {"radius": np.nextafter(0.5, 1.0)}, {"inside": True}, {"name": "a"}):
        assert not sn.Sphere(**ball).equals(sn.Sphere(**{**ball, **change}))
    segment = sn.Segment(1.0, tendons=sn.Tendons(3, 0.1))
    assert not segment.equals(sn.Segment(1.0, tendons=sn.Tendons(3, 0.1, angle=1e-9)))
    assert not segment.equals(sn.Segment(1.0, tendons=sn.Tendons(3, 0.1), name="a"))
    cloud = sn.Scene([sn.PointCloud([[0, 0, 1]], 0.1)])
    other = sn.Scene(cloud.obstacles)
    assert cloud.equals(other)
    other.update([[0, 0, 2]])
    assert not cloud.equals(other)
    assert not cloud.equals(sn.Scene())


@pytest.mark.parametrize("name", EACH_KIND)
def test_unpickled_obstacles_are_as_far(name: str) -> None:
    points = np.random.default_rng(0).uniform(-2.0, 3.0, (50, 3))
    scene = sn.Scene([EACH_KIND[name]()])
    expected = scene.distance(points)
    for again in (pickle.loads(pickle.dumps(scene)), sn.Scene([pickle.loads(pickle.dumps(EACH_KIND[name]()))])):
        np.testing.assert_array_equal(again.distance(points), expected)


def copies(noun: Any) -> list[Any]:
    return [pickle.loads(pickle.dumps(noun)), copy.copy(noun), copy.deepcopy(noun)]


def test_copies_of_a_solver_solve_the_same() -> None:
    solver = sn.Solver(ROBOT, SCENE, prefer=sn.Preferences(bends=1.0), seed=3)
    found = solver.solve(TARGET)
    for again in copies(solver):
        assert again.options == solver.options
        assert again.solve(TARGET).q.tobytes() == found.q.tobytes()
    target, robot = pickle.loads(pickle.dumps((TARGET, ROBOT)))
    parts = sn.Solver(robot, pickle.loads(pickle.dumps(SCENE)), prefer=sn.Preferences(bends=1.0), seed=3)
    assert parts.solve(target).q.tobytes() == found.q.tobytes()
