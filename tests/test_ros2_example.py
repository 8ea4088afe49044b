"""The ROS 2 package of `examples/ros2`: its planner as it is, its node with messages that are made here."""

import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

PACKAGE = Path(__file__).parents[1] / "examples" / "ros2" / "sinuous_arm"
JOB = str(PACKAGE / "config" / "arm.yaml")
MESSAGES = {
    "builtin_interfaces.msg": ["Duration"],
    "geometry_msgs.msg": ["PoseStamped"],
    "sensor_msgs.msg": ["JointState"],
    "trajectory_msgs.msg": ["JointTrajectory", "JointTrajectoryPoint"],
    "rclpy.callback_groups": ["ReentrantCallbackGroup"],
    "rclpy.executors": ["MultiThreadedExecutor"],
}


class Clock:
    """A clock that is put forward by hand."""

    time = 100.0

    def __call__(self) -> float:
        return self.time

    def now(self) -> Any:
        return SimpleNamespace(nanoseconds=round(self.time * 1e9), to_msg=lambda: self.time)


class FakeNode:
    """As much of `rclpy.node.Node` as the node needs."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.sent: list[Any] = []
        self.said: list[tuple[str, str]] = []
        self.callbacks: dict[str, Any] = {}
        self.own: dict[str, Any] = {}
        self.clock = Clock()

    def declare_parameter(self, name: str, value: Any) -> None:
        self.own[name] = JOB if name == "job" else value

    def get_parameter(self, name: str) -> Any:
        return SimpleNamespace(value=self.own[name])

    def create_publisher(self, kind: Any, topic: str, depth: int) -> Any:
        return SimpleNamespace(publish=self.sent.append)

    def create_subscription(self, kind: Any, topic: str, callback: Any, depth: int, callback_group: Any = None) -> None:
        self.callbacks[topic] = callback

    def create_timer(self, period: float, callback: Any, callback_group: Any = None) -> None:
        self.callbacks["timer"] = callback

    def get_clock(self) -> Clock:
        return self.clock

    def get_logger(self) -> Any:
        def of(level: str) -> Any:
            return lambda text, **_: self.said.append((level, text))

        return SimpleNamespace(**{level: of(level) for level in ("info", "warning", "error")})


@pytest.fixture
def package(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The package on the path, and messages that are plain objects."""
    monkeypatch.syspath_prepend(str(PACKAGE))

    def message(**fields: Any) -> Any:
        return SimpleNamespace(**{"header": SimpleNamespace(stamp=None), "points": []} | fields)

    for name, kinds in MESSAGES.items():
        module = ModuleType(name)
        for kind in kinds:
            setattr(module, kind, message)
        monkeypatch.setitem(sys.modules, name, module)
        monkeypatch.setitem(sys.modules, name.partition(".")[0], ModuleType(name.partition(".")[0]))
    node = ModuleType("rclpy.node")
    node.Node = FakeNode  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "rclpy.node", node)
    yield
    for name in [name for name in sys.modules if name.startswith("sinuous_arm")]:
        del sys.modules[name]


def planner(clock: Clock, **options: Any) -> Any:
    return import_module("sinuous_arm.planner").ArmPlanner(JOB, clock, **options)


@pytest.mark.usefixtures("package")
def test_pieces_are_one_motion_within_its_rates() -> None:
    clock = Clock()
    arm = planner(clock, rate=100.0)
    assert arm.piece(0.5) is None
    motion = arm.go((60, 20, 170))
    assert motion.solved
    times, values, speeds = [], [], []
    while (piece := arm.piece(0.15)) is not None:
        assert piece.names == [each.name for each in arm.robot.actuators]
        np.testing.assert_allclose(piece.positions[0], arm.robot.to_actuators(arm.q), atol=1e-6)
        times.append(clock.time + piece.times)
        values.append(piece.positions)
        speeds.append(piece.velocities)
        clock.time += 0.1
    assert not arm.moves
    np.testing.assert_allclose(values[-1][-1], arm.robot.to_actuators(motion.q[-1]), atol=1e-6)
    np.testing.assert_array_equal(speeds[-1][-1], 0.0)
    assert np.abs(np.concatenate(speeds)).max() <= 800.0 + 1e-6
    for i in range(len(times) - 1):  # the next one begins where the last one said
        there = [np.interp(times[i + 1][0], times[i], column) for column in values[i].T]
        np.testing.assert_allclose(values[i + 1][0], there, atol=0.2)
    np.testing.assert_allclose(arm.robot.tip(arm.q)[:3, 3], (60, 20, 170), atol=0.1)
    assert arm.go((20, 60, 170)).solved


def pose(place: tuple[float, ...], turn: tuple[float, ...] = (0, 0, 0, 0)) -> Any:
    position = SimpleNamespace(**dict(zip("xyz", place, strict=True)))
    orientation = SimpleNamespace(**dict(zip("xyzw", turn, strict=True)))
    return SimpleNamespace(pose=SimpleNamespace(position=position, orientation=orientation))


@pytest.mark.usefixtures("package")
def test_the_node_streams_messages() -> None:
    node = import_module("sinuous_arm.node").ArmNode()
    assert set(node.callbacks) == {"~/target", "~/joint_states", "timer"}
    node.callbacks["timer"]()
    assert node.sent == []
    node.callbacks["~/target"](pose((60, 20, 170)))
    node.callbacks["timer"]()
    (message,) = node.sent
    assert message.joint_names == node.planner.names
    assert message.header.stamp == node.clock.time
    first, last = message.points[0], message.points[-1]
    assert first.positions == pytest.approx(node.planner.robot.to_actuators(node.planner.q), abs=1e-6)
    assert 0.4 < last.time_from_start.sec + 1e-9 * last.time_from_start.nanosec <= 0.5
    assert len(last.velocities) == 7
    node.callbacks["~/target"](pose((60, 20, 170), (0, 0, 0, 1)))
    node.clock.time += 10.0
    node.callbacks["timer"]()
    assert len(node.sent) == 1
    node.callbacks["~/target"](pose((0, 0, 900)))
    node.callbacks["~/joint_states"](SimpleNamespace(name=["feed"], position=[800.0]))
    assert [level for level, _ in node.said] == ["info", "error", "warning", "error"]
    assert "out_of_reach" in node.said[2][1]
