"""Laws of timing: limits are kept and used, and the way stays the one that was proved.

Configurations and actuators as a table: all numbers, under their names.

The straight line of the tip between waypoints.
"""

import csv
import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sinuous as sn
from sinuous.answer.solutions import column_names
from sinuous.files.joint_chain import JointChain
from sinuous.measures.following import body_places
from sinuous.motion.knots import TipLine
from tests.helpers import Floats, present, refused, with_each

ARM = sn.Robot.uniform(3, (45, 70), max_bend=2.4, radius=4, tendons=sn.Tendons(3, radius=4))
FAR = sn.Sphere((0, 0, 400), radius=10)
FIRST = sn.Rates(bend=1.0, length=30.0, actuator=6.0)
BOTH = sn.Rates(bend=1.0, length=30.0, actuator=6.0, acceleration=sn.Rates(bend=3.0, length=100.0, actuator=20.0))


def smooth(knots: int) -> sn.Motion:
    t = np.linspace(0.0, 2.0, knots)[:, None, None]
    phase = np.arange(9.0).reshape(3, 3)
    q = np.sin(t + phase) * (0.6, 0.6, 8.0) + (0.0, 0.0, 57.0)
    return sn.Motion(ARM, q, [FAR])


@cache
def wave() -> sn.Motion:
    """A motion of twelve knots; not proved when tests are collected, since that compiles."""
    return smooth(12)


def rates_of(values: Floats) -> Floats:
    """Largest of bends, lengths and actuators (T, 3) of rates (T, n, 3)."""
    bends = np.hypot(values[..., 0], values[..., 1]).max(axis=-1)
    lengths, actuators = np.abs(values[..., 2]).max(axis=-1), np.abs(ARM.to_actuators(values)).max(axis=-1)
    return np.stack([bends, lengths, actuators], axis=-1)


def off_the_way(motion: sn.Motion, q: Floats) -> float:
    """Largest distance of configurations (T, n, 3) from the lines between the knots, as vectors."""
    a, d = motion.q[:-1].reshape(len(motion.q) - 1, -1), np.diff(motion.q, axis=0).reshape(len(motion.q) - 1, -1)
    p = q.reshape(len(q), 1, -1)
    share = np.clip(((p - a) * d).sum(-1) / (d * d).sum(-1), 0.0, 1.0)
    return float(np.linalg.norm(a + share[..., None] * d - p, axis=-1).min(axis=1).max())


@pytest.mark.parametrize("blend", [0.0, 0.3, 1e3])
def test_rates_and_accelerations_are_kept_and_some_is_reached_at_any_time(blend: float) -> None:
    timed = wave().timed(BOTH, blend)
    t = np.linspace(0.0, timed.duration, 5001)
    speed, gain = timed.velocity(t), timed.acceleration(t)
    used = np.concatenate([rates_of(speed) / (1.0, 30.0, 6.0), rates_of(gain) / (3.0, 100.0, 20.0)], axis=1)
    assert used.max() <= 1.0 + 1e-6
    assert np.mean(used.max(axis=1) > 0.95) > 0.95


@pytest.mark.parametrize("blend", [0.0, 0.3])
def test_velocities_and_accelerations_are_derivatives(blend: float) -> None:
    timed = wave().timed(BOTH, blend)
    inner = 0.5 * (timed.times[1:] + timed.times[:-1])
    h = 1e-6
    inner = inner[np.diff(timed.times) > 4 * h]
    moved = (timed.at(inner + h) - timed.at(inner - h)) / (2 * h)
    np.testing.assert_allclose(moved, timed.velocity(inner), atol=1e-6)
    gained = (timed.velocity(inner + h) - timed.velocity(inner - h)) / (2 * h)
    np.testing.assert_allclose(gained, timed.acceleration(inner), atol=1e-5)


def test_without_a_blend_it_stops_in_every_corner_and_stays_on_the_way() -> None:
    timed = wave().timed(BOTH)
    q = timed.at(np.linspace(0.0, timed.duration, 400))
    assert off_the_way(wave(), q) < 1e-12
    at_knots = [timed.at(timed.times)[np.abs(timed.at(timed.times) - q).max(axis=(1, 2)) < 1e-12] for q in wave().q]
    assert all(len(found) for found in at_knots)
    np.testing.assert_allclose(timed.at(0.0), wave().q[0])
    np.testing.assert_allclose(timed.at(timed.duration), wave().q[-1], atol=1e-12)


def test_a_straight_step_takes_the_time_of_a_trapezoid() -> None:
    q = np.tile([0.0, 0.0, 50.0], (2, 3, 1))
    q[1, 0, 0] = 1.5
    motion = sn.Motion(ARM, q)
    limits = sn.Rates(bend=1.0, acceleration=sn.Rates(bend=2.0))
    assert motion.timed(limits).duration == pytest.approx(1.5 / 1.0 + 1.0 / 2.0)
    assert motion.timed(sn.Rates(acceleration=sn.Rates(bend=2.0))).duration == pytest.approx(2.0 * np.sqrt(1.5 / 2.0))
    assert motion.timed(sn.Rates(bend=1.0)).duration == pytest.approx(1.5)
    finer = sn.Motion(ARM, np.linspace(q[0], q[1], 7))
    assert finer.timed(limits).duration == pytest.approx(2.0)


def test_a_blend_saves_time_and_stays_within_what_is_allowed() -> None:
    motion = smooth(40)
    stops, blended = motion.timed(BOTH), motion.timed(BOTH, 0.3)
    assert blended.duration < 0.6 * stops.duration
    t = np.linspace(0.0, blended.duration, 2000)
    body = ARM.backbone(blended.at(t), 6)
    true = ARM.backbone(motion.at(np.linspace(0, 39, 4_000)), 6)
    nearest = np.array([np.linalg.norm(true - one, axis=-1).max(axis=1).min() for one in body[::20]])
    assert nearest.max() <= 0.3
    assert nearest.max() > 1e-4


def test_half_of_what_is_proved_to_be_free_is_left() -> None:
    q = smooth(12).q
    places = body_places(ARM, smooth(12).at(np.linspace(0, 11, 200)))
    beside = places[100, -1, -1] + np.array([0.0, 14.0, 0.0])
    gap = np.linalg.norm(places - beside, axis=-1).min()
    ball = sn.Sphere(beside, radius=float(gap) - 4.0 - 0.5)
    motion = sn.Motion(ARM.changed(self_collision="allow"), q, [ball])
    assert motion.solved
    timed = motion.timed(BOTH, 1e3)
    passed = body_places(ARM, timed.at(np.linspace(0.0, timed.duration, 2000)))
    clearance = np.linalg.norm(passed - ball.center, axis=-1).min() - ball.radius - 4.0
    assert 0.5 * present(motion.clearance) <= clearance
    assert off_the_way(motion, timed.at(np.linspace(0.0, timed.duration, 300))) > 1e-3


def test_files_have_even_times_and_drive_the_joints_of_the_urdf(tmp_path: Path) -> None:
    timed = wave().timed(BOTH)
    timed.to_csv(tmp_path / "way.csv", rate=50)
    rows = (tmp_path / "way.csv").read_text().splitlines()
    assert rows[0].startswith("time,s1.bend_x")
    assert len(rows) == 2 + int(np.ceil(50 * timed.duration))
    timed.to_ros(tmp_path / "way.json", joints_per_segment=2)
    message = json.loads((tmp_path / "way.json").read_text())
    chain = JointChain(ARM, 2)
    assert message["joint_names"] == list(chain.names)
    np.testing.assert_allclose([p["positions"] for p in message["points"]], chain.values(timed.at(timed.times)))
    np.testing.assert_allclose(
        [p["velocities"] for p in message["points"]][3], chain.values(timed.velocity(timed.times[3]))
    )
    timed.to_ros(tmp_path / "way.json", rate=20, of="actuators")
    message = json.loads((tmp_path / "way.json").read_text())
    assert message["joint_names"] == [actuator.name for actuator in ARM.actuators]


@with_each(
    ("rates", "blend", "message"),
    [
        (sn.Rates(), 0.0, "rates: nothing limits step 1 of the motion; expected"),
        (sn.Rates(bend=[1.0]), 0.0, "bend: expected"),
        (FIRST, 0.1, r"blend: rates have no acceleration.*; expected 0, got 0.1"),
        (BOTH, -1.0, "blend: expected a number of at least 0"),
        (7.0, 0.0, "rates: expected Rates, got 7.0"),
    ],
)
def test_what_is_no_limit_is_refused(rates: Any, blend: float, message: str) -> None:
    with pytest.raises(sn.InputError, match=message):
        wave().timed(rates, blend)


def test_what_nothing_limits_and_what_stands_still_is_refused() -> None:
    longer = sn.Motion(ARM, np.stack([wave().q[0], wave().q[0] + (0, 0, 1)]))
    refused("rates", lambda: longer.timed(sn.Rates(bend=1.0)), "nothing limits step 1")
    refused("motion", lambda: sn.Motion(ARM, wave().q[[0, 0]]).timed(FIRST), "stands still")
    refused("t", lambda: wave().timed(FIRST).at(-1.0), "expected times from 0 to")


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e7])
@pytest.mark.parametrize("knots", [50, 1000])
def test_the_way_is_the_same_in_every_unit_of_length(unit: float, knots: int) -> None:
    """Small turns between knots add up: in fine units they were one straight leg through what lies between."""
    arm = sn.Robot.uniform(3, (0.8 * unit, 1.2 * unit), 2.4, radius=0.01 * unit)
    share = np.linspace(0.0, 1.0, knots)
    q = np.zeros((knots, 3, 3))
    q[:, 0, 0], q[:, 1, 1] = 0.3 * share, 0.5 * share**2
    q[:, :, 2] = unit * (0.85 + 0.3 * share)[:, None]
    motion = sn.Motion(arm, q, [sn.Sphere((0, 0, 9 * unit), 0.1 * unit)])
    timed = motion.timed(sn.Rates(bend=1.0, length=unit))
    places = timed.at(np.linspace(0.0, timed.duration, 400))
    lengths = (1.0, 1.0, 1.0 / unit)
    scaled = sn.Motion(sn.Robot.uniform(3, (0.8, 1.2), 2.4), q * lengths, [FAR])
    assert off_the_way(scaled, places * lengths) < 1e-7
    assert len(timed.times) >= 50


ROBOT = sn.Robot(
    [
        sn.Segment((0.0, 0.5), 0.0, name="stage"),
        sn.Segment(1.0, 2.0, tendons=sn.Tendons(3, 0.1)),
        sn.Segment((0.8, 1.2), 2.0, chambers=sn.Chambers(3, 0.1, names=["up", "left", "a, b"])),
    ],
    actuators=sn.Actuators([[0, 0, 1, 0, 0, 0, 0, 0, 0]], names=["feed"]),
)
PATH = [sn.Target((0.1 * i, 0.5, 1.8)) for i in range(3)]


@pytest.fixture(scope="module")
def track() -> sn.Motion:
    return sn.track(ROBOT, [*PATH, sn.Target((0.0, 0.0, 9.0))])


def test_it_holds_every_number_to_the_last_digit(track: sn.Motion, tmp_path: Path) -> None:
    track.to_csv(tmp_path / "motors.csv")
    with (tmp_path / "motors.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["time", *column_names(ROBOT)]
    assert [row["time"] for row in rows] == ["0.0", "1.0", "2.0"]
    for row, solution in zip(rows, track.solutions[:3], strict=True):
        assert solution.actuators is not None
        assert {name: float(row[name]) for name in solution.actuators} == pytest.approx(solution.actuators, abs=1e-15)
        assert [float(row[name]) for name in column_names(ROBOT)[:9]] == solution.q.ravel().tolist()


def test_a_motor_and_a_joint_of_one_name_have_each_their_own_column(tmp_path: Path) -> None:
    """Before, the column of the motor had the value of the joint."""
    drive = sn.Actuators([[1, 0, 0, 0]], names=["roll"], gain=100, offset=5)
    robot = sn.Robot([sn.Segment(1.0, 2.0)], joints=[sn.Revolute(name="roll")], actuators=drive)
    solutions = sn.Solver(robot).solve_many(positions=[[0.0, 0.0, 1.0]])
    motion = sn.Motion(robot, [([0.1], [[0.0, 0.0, 1.0]]), ([0.2], [[0.0, 0.0, 1.0]])])
    motion.to_csv(tmp_path / "all.csv")
    motion.to_csv(tmp_path / "one.csv", columns=["roll.motor"])
    solutions.to_csv(tmp_path / "motors.csv")
    tables = {each.stem: list(csv.reader(each.read_text().splitlines())) for each in tmp_path.iterdir()}
    assert tables["all"][0] == ["time", "roll", "s1.bend_x", "s1.bend_y", "s1.length", "roll.motor"]
    assert [[float(row[1]), float(row[-1])] for row in tables["all"][1:]] == [[0.1, 15.0], [0.2, 25.0]]
    assert [float(row[-1]) for row in tables["one"][1:]] == [15.0, 25.0]
    assert tables["motors"][0] == ["target", "status", "roll.motor"]
    assert float(tables["motors"][1][-1]) == pytest.approx(100.0 * float(solutions[0].joints[0]) + 5.0)
    for name in ("all.csv", "one.csv"):
        np.testing.assert_allclose(sn.Motion.load(tmp_path / name, robot).joints, [[0.1], [0.2]], atol=1e-15)


def asked(target: sn.Target) -> tuple[Floats, Floats, Floats]:
    """Position, direction and rotation of a target; zeros where it asks for none."""
    parts = (target.position, target.direction, target.rotation)
    position, direction, rotation = (np.zeros(3) if part is None else part for part in parts)
    return position, direction, rotation


def test_orientations_go_the_shorter_way_round() -> None:
    turn = Rotation.from_rotvec([0.0, 0.0, 1.0])
    a = sn.Target((0, 0, 3), rotation=np.eye(3))
    b = sn.Target((0, 1, 3), rotation=turn)
    position, _, rotation = asked(TipLine(a, b).at(0.25))
    np.testing.assert_allclose(position, [0.0, 0.25, 3.0])
    np.testing.assert_allclose(rotation, Rotation.from_rotvec([0.0, 0.0, 0.25]).as_matrix(), atol=1e-12)
    a, b = sn.Target((0, 0, 3), direction=(1, 0, 0)), sn.Target((0, 0, 3), direction=(0, 1, 0))
    np.testing.assert_allclose(asked(TipLine(a, b).at(0.5))[1], [0.5**0.5, 0.5**0.5, 0.0], atol=1e-12)
    opposite = TipLine(a, sn.Target((0, 0, 3), direction=(-1, 0, 0)))
    assert asked(opposite.at(0.5))[1] @ [1.0, 0.0, 0.0] == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(asked(opposite.at(1.0))[1], [-1.0, 0.0, 0.0], atol=1e-12)
    same = TipLine(a, sn.Target((0, 0, 2), direction=(1, 0, 0)))
    np.testing.assert_allclose(asked(same.at(0.3))[1], [1.0, 0.0, 0.0])


SOFT: dict[str, Any] = {"stiffness": 400.0, "radius": 4.0}
SLACK = sn.Robot([sn.Segment(60.0, max_bend=2.0, tendons=sn.Tendons(3, 4.0, stiffness=5.0), **SOFT)] * 2)
CURVED = np.array(
    [[[0.5, 0.2, 60], [0.3, -0.4, 60]], [[-0.1, 0.5, 60], [0.4, 0.3, 60]], [[-0.6, -0.2, 60], [0, 0.5, 60]]]
)


@pytest.mark.parametrize("blend", [0.0, 1.0, 1e3])
def test_motors_of_elastic_tendons_keep_rates_on_a_way_on_which_tendons_go_slack(blend: float) -> None:
    rates = sn.Rates(bend=5.0, actuator=3.0, acceleration=sn.Rates(bend=1.0))
    motion = sn.Motion(SLACK, CURVED)
    timed = motion.timed(rates, blend)
    slack = SLACK.tensions(motion.actuators) < 1e-9
    assert (slack != slack[0]).any(), "no tendon goes slack"
    assert (timed.stops == 1) == (blend == 0.0)
    times = np.linspace(0.0, timed.duration, 20_001)
    speeds = np.abs(np.diff(SLACK.to_actuators(timed.at(times)), axis=0)) / np.diff(times)[:, None]
    assert 0.9 * 3.0 < speeds.max() <= 3.0 * (1.0 + 1e-6)


def test_accelerations_of_elastic_tendons_are_kept_by_stops_where_tendons_go_slack() -> None:
    motion = sn.Motion(SLACK, CURVED)
    rates = sn.Rates(bend=5.0, actuator=3.0, acceleration=sn.Rates(actuator=9.0))
    timed = motion.timed(rates)
    assert timed.stops > 1
    times = np.linspace(0.0, timed.duration, 4_001)
    speeds = np.diff(SLACK.to_actuators(timed.at(times)), axis=0) / np.diff(times)[:, None]
    gains = np.abs(np.diff(speeds, axis=0)) / times[1]
    assert 0.9 * 9.0 < gains.max() <= 9.0 * (1.0 + 1e-6)
    assert np.abs(speeds).max() <= 3.0 * (1.0 + 1e-6)
    assert timed.as_motion().solved
    refused("blend", lambda: motion.timed(rates, 1.0))


def test_what_is_not_known_of_elastic_tendons_whose_segments_change_their_lengths_is_refused() -> None:
    softer = sn.Segment((50.0, 70.0), max_bend=2.0, tendons=sn.Tendons(3, 4.0, stiffness=5.0), **SOFT)
    motion = sn.Motion(sn.Robot([softer] * 2), CURVED + [0.0, 0.0, 2.0] * np.arange(3.0)[:, None, None])
    gentle = sn.Rates(bend=5.0, length=9.0, actuator=3.0, acceleration=sn.Rates(bend=20.0, length=50.0))
    refused("blend", lambda: motion.timed(gentle, 1.0))
    hard = sn.Rates(bend=5.0, length=9.0, acceleration=sn.Rates(bend=20.0, length=50.0, actuator=9.0))
    refused("rates.acceleration.actuator", lambda: motion.timed(hard))
    assert motion.timed(gentle).duration > motion.timed(sn.Rates(bend=5.0, length=9.0)).duration
