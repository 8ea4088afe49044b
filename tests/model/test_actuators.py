"""Tendons and chambers: linear in the bend, and as long as the curves that they are."""

import csv
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.model.actuation import Actuator
from tests.helpers import NOT_NUMBERS, Floats, configurations, expm_chain, refused, refused_each, with_each

LINES = (sn.Tendons, sn.Chambers)


def curve_length(q: Floats, angle: float, radius: float, samples: int = 200) -> float:
    """Length of the curve offset from the backbone of segments, from the chords of many small arcs."""
    offset = np.array([radius * math.cos(angle), radius * math.sin(angle), 0.0, 1.0])
    totals = []
    for count in (samples, 2 * samples):
        chords = [np.diff([pose @ offset for pose in expm_powers(row / count, count)], axis=0) for row in q]
        totals.append(float(np.linalg.norm(chords, axis=-1).sum()))
    return totals[1] + (totals[1] - totals[0]) / 3.0  # chords are short by the square of the spacing


def expm_powers(row: Floats, count: int) -> list[Floats]:
    step = expm_chain(row[None])[-1]
    poses = [np.eye(4)]
    for _ in range(count):
        poses.append(poses[-1] @ step)
    return poses


@pytest.mark.parametrize("seed", range(3))
def test_lengths_are_those_of_the_curves(seed: int) -> None:
    """Tendons of the last segment run through all; offset curves do not turn back on themselves at this radius."""
    rng = np.random.default_rng(seed)
    angles, radius = rng.uniform(-math.pi, math.pi, 3), 0.05
    robot = sn.Robot(
        [sn.Segment((0.0, 3.0), 7.0, tendons=sn.Tendons(angles=angles + k, radius=radius)) for k in range(3)]
    )
    q = configurations(seed, 3, 1)[0]
    q[:, 2] += 0.5
    pulled = robot.to_actuators(q).reshape(3, 3)
    for k in range(3):
        for j in range(3):
            expected = q[: k + 1, 2].sum() - curve_length(q[: k + 1], angles[j] + k, radius)
            assert pulled[k][j] == pytest.approx(expected, abs=1e-7)
    chambered = sn.Robot([sn.Segment((0.0, 4.0), 7.0, chambers=sn.Chambers(angles=angles, radius=radius))] * 3)
    for k, lengths_k in enumerate(chambered.to_actuators(q).reshape(3, 3)):
        assert lengths_k[1] == pytest.approx(curve_length(q[k : k + 1], angles[1], radius), abs=1e-7)


@with_each("kind", LINES)
@with_each("value", [*NOT_NUMBERS, 0.0, -1.0])
def test_bad_radii_are_refused(kind: Any, value: Any) -> None:
    refused("radius", lambda: kind(3, value), "greater than 0")


@with_each("kind", LINES)
@with_each("value", [0, -3, 2.5, True, "3", 65, 10**9])
def test_bad_counts_are_refused(kind: Any, value: Any) -> None:
    refused("count", lambda: kind(value, 1.0), "1 to 64")


@pytest.mark.parametrize("kind", LINES)
def test_places_are_said_one_way(kind: Any) -> None:
    refused("count", lambda: kind(radius=1.0), "angles")
    refused("count", lambda: kind(3, 1.0, angles=[0.0, 1.0]))
    refused("angle", lambda: kind(radius=1.0, angle=0.1, angles=[0.0, 1.0]))
    refused("angle", lambda: kind(3, 1.0, "up"))
    refused_each("angles", ([], [0.0] * 65), lambda angles: kind(radius=1.0, angles=angles), "1 to 64")
    refused_each(
        "angles", ([math.nan], [[0.0]], "east", [True, False], 1.0), lambda angles: kind(radius=1.0, angles=angles)
    )


def test_limits_of_tendons_contain_the_straight_robot() -> None:
    assert sn.Tendons(3, 1.0).displacement == (-math.inf, math.inf)
    assert sn.Tendons(3, 1.0, displacement=(-1, 0)).displacement == (-1.0, 0.0)
    refused_each(
        "displacement",
        ((0.1, 1.0), (-1.0, -0.1), 0.5),
        lambda value: sn.Tendons(3, 1.0, displacement=value),
        "low <= 0 <= high",
    )
    refused_each(
        "displacement", ((1.0, -1.0), (1, 2, 3), "wide", True), lambda value: sn.Tendons(3, 1.0, displacement=value)
    )
    refused("displacement[1]", lambda: sn.Tendons(3, 1.0, displacement=(-1.0, math.inf)))


MOTOR_LINES = (sn.Tendons, sn.Chambers)
GAINS = np.array([40.0, 12.0, -100.0, 0.5, 7.0, 7.0, 7.0, -3.0])
OFFSETS = np.array([5.0, 2048.0, 2048.0, -1.0, 0.0, 0.0, 0.0, 0.25])
UNITS = ["steps", "counts", "counts", None, "kPa", "kPa", "kPa", "rad"]


def arm(motors: bool = True, limited: bool = True) -> sn.Robot:
    """An arm of a stage, a segment with tendons, one with chambers, and a row: with motors or without."""
    own: list[dict[str, Any]] = [{"gain": 40.0, "offset": 5.0, "unit": "steps"}]
    own += [{"gain": GAINS[1:4], "offset": OFFSETS[1:4], "unit": UNITS[1:4]}, {"gain": 7, "unit": "kPa"}]
    own += [{"gain": -3.0, "offset": 0.25, "unit": "rad"}]
    stage, lines, bellows, row = own if motors else [{}] * 4
    displacement, pair = ((-4, 4), (-2.0, 2.0)) if limited else (None, None)
    turned = None if pair is None else (-3.0 * pair[1] + 0.25, -3.0 * pair[0] + 0.25) if motors else pair
    return sn.Robot(
        [
            sn.Segment((0, 40), 0, radius=3, name="feed", stage=sn.Stage(**stage)),
            sn.Segment(70, 2.2, radius=3, tendons=sn.Tendons(3, 4, displacement=displacement, **lines)),
            sn.Segment((40, 70), 2.2, radius=3, chambers=sn.Chambers(3, 4, 0.2, length=(35, 80), **bellows)),
        ],
        actuators=sn.Actuators([[0, 0, 0, 0, 0, 0, 1, 0, 0]], names=["pan"], limits=turned, **row),
    )


PLAIN, DRIVEN = arm(motors=False), arm()


def shapes(count: int) -> Any:
    rng = np.random.default_rng(count)
    bends = rng.uniform(-0.6, 0.6, (count, 3, 2)) * [[0], [1], [1]]
    return np.concatenate([bends, rng.uniform((0, 70, 45), (40, 70, 65), (count, 3))[..., None]], axis=-1)


def test_who_they_are() -> None:
    feed, left = DRIVEN.actuators[0], DRIVEN.actuators[2]
    assert feed == Actuator("feed", "stage", 1, (5.0, 1605.0), 40.0, 5.0, "steps")
    assert left == Actuator("s2.t2", "tendon", 2, (1648.0, 2448.0), -100.0, 2048.0, "counts")
    assert DRIVEN.actuators[4].limits == (245.0, 560.0)
    assert DRIVEN.actuators[-1].limits == (-5.75, 6.25)
    assert [each.unit for each in DRIVEN.actuators] == UNITS
    assert PLAIN.actuators[0] == Actuator("feed", "stage", 1, (0.0, 40.0))


def test_a_value_is_gain_times_displacement_plus_offset() -> None:
    for q in (shapes(1)[0], shapes(7)):
        values = GAINS * PLAIN.to_actuators(q) + OFFSETS
        np.testing.assert_allclose(DRIVEN.to_actuators(q), values, rtol=1e-15)
        np.testing.assert_allclose(DRIVEN.from_actuators(values), q, atol=1e-10)
    np.testing.assert_allclose(DRIVEN.actuator_jacobian(q), GAINS[:, None] * PLAIN.actuator_jacobian(q))


def test_the_same_shapes_are_allowed() -> None:
    np.testing.assert_array_equal(DRIVEN.actuation, PLAIN.actuation)
    for q in 2.0 * shapes(20):
        assert DRIVEN.excess(q) == PLAIN.excess(q)
        assert DRIVEN.violations(q) == PLAIN.violations(q)


def test_limits_in_the_unit_of_the_motors() -> None:
    tendons = sn.Tendons(3, 5, limits=(1000, 3000), gain=[100, -100, 50], offset=2048)
    np.testing.assert_allclose(tendons.displacements, [[-10.48, 9.52], [-9.52, 10.48], [-20.96, 19.04]])
    robot = sn.Robot([sn.Segment(80, tendons=tendons)])
    assert {each.limits for each in robot.actuators} == {(1000.0, 3000.0)}
    bellows = sn.Segment((30, 90), chambers=sn.Chambers(2, 5, limits=(0, 100), gain=[2, 4], offset=-100))
    assert bellows.length == (50.0, 50.0)  # 50 to 100 of the first, 25 to 50 of the second
    refused("limits", lambda: sn.Tendons(3, 5, limits=(10, 20), offset=[15, 15, 25]), "low <= 25 <= high")
    refused("limits", lambda: sn.Tendons(3, 5, limits=(-9, 9), displacement=(0, 9)), "one of displacement, limits")
    refused("limits", lambda: sn.Chambers(3, 5, limits=(-9, 9), length=(0, 9)), "one of length, limits")
    far = sn.Chambers(2, 5, limits=(0, 100), gain=0.5)
    refused("chambers.limits", lambda: sn.Segment(300, chambers=far), "straight")
    row = [[0, 0, 1, 0, 0, 0], [0, 0, 0, 1, 0, 0]]
    stage, bend = sn.Segment((0, 100), 0), sn.Segment(80)
    motors = sn.Actuators(row, limits=[(-300, 200), (-1, 9)], gain=[-4, 2], offset=[100, 4])
    assert sn.Robot([stage, bend], actuators=motors).actuators[1].limits == (-1.0, 9.0)
    narrow = motors.changed(limits=[(-299, 200), None])
    refused("actuators.limits[0]", lambda: sn.Robot([stage, bend], actuators=narrow), "contain [-300, 100]")


@pytest.mark.parametrize("kind", [*MOTOR_LINES, sn.Actuators])
def test_bad_motors_are_refused(kind: Any) -> None:
    def make(**motor: Any) -> Any:
        return kind([[1, 0, 0], [0, 1, 0]], **motor) if kind is sn.Actuators else kind(2, 1.0, **motor)

    refused_each("gain", (0, [1.0, 0.0], math.nan, "fast", True, [1.0], [[1.0, 2.0]]), lambda g: make(gain=g))
    refused_each("offset", (math.inf, "far", [1.0, 2.0, 3.0]), lambda o: make(offset=o))
    refused_each("unit", ("", 3, ["deg"], {"deg": 1}), lambda u: make(unit=u), "text")
    refused("unit[1]", lambda: make(unit=["deg", ""]))
    assert make(unit=["deg", None]).unit == ("deg", None)


def test_a_stage_moves_what_can_change_its_length() -> None:
    refused("stage", lambda: sn.Segment(80, stage=sn.Stage()), "a length that changes, not 80")
    refused("stage", lambda: sn.Segment((0, 80), stage=True), "Stage or nothing")  # type: ignore[arg-type]
    refused_each("gain", (0, "fast", [1.0]), lambda gain: sn.Stage(gain=gain))
    named = sn.Segment((0, 80), stage=sn.Stage(name="push"))
    assert [each.name for each in sn.Robot([named, sn.Segment((1, 2), stage=sn.Stage())]).actuators] == ["push", "s2"]
    refused("segments[1].stage.name", lambda: sn.Robot([named, named]), "a name of its own")
    staged = sn.on_stage(PLAIN, 300, motor=sn.Stage(gain=10, unit="steps"))
    assert staged.actuators[0] == Actuator("stage", "stage", 1, (0.0, 3000.0), 10.0, 0.0, "steps")
    assert staged.actuators[-1].name == "pan"
    assert sn.on_stage(DRIVEN, 300).actuators[-1].gain == -3.0


def test_answers_say_values_and_units(tmp_path: Path) -> None:
    solution = sn.solve(DRIVEN, sn.Target((20, 30, 130)))
    assert solution.solved
    values = solution.actuators or {}
    np.testing.assert_array_equal(DRIVEN.from_actuators(values), DRIVEN.from_actuators(list(values.values())))
    assert f"feed={values['feed']:.4g} steps" in str(solution)
    assert f"s2.t3={values['s2.t3']:.4g}  " in str(solution)
    motion = sn.track(DRIVEN, [sn.Target((20, 30, 130)), sn.Target((25, 30, 130))])
    motion.to_csv(tmp_path / "motors.csv")
    motion.to_ros(tmp_path / "motors.json", of="actuators")
    motion.to_npz(tmp_path / "motion.npz")
    with (tmp_path / "motors.csv").open(encoding="utf-8") as table:
        row = list(csv.DictReader(table))[-1]
    np.testing.assert_allclose([float(row[each.name]) for each in DRIVEN.actuators], motion.actuators[-1], rtol=1e-12)
    points = json.loads((tmp_path / "motors.json").read_text(encoding="utf-8"))["points"]
    np.testing.assert_allclose([point["positions"] for point in points], motion.actuators, rtol=1e-12)
    with np.load(tmp_path / "motion.npz") as arrays:
        assert arrays["actuator_units"].tolist() == [unit or "" for unit in UNITS]
    many = sn.Solver(DRIVEN).solve_many(positions=[(20, 30, 130), (25, 30, 130)])
    np.testing.assert_allclose(DRIVEN.from_actuators(many.actuators or {}), many.q, atol=1e-9)


def test_rates_are_those_of_the_motors() -> None:
    """The same speeds, said of motors and of displacements, make the same times and the same ticks."""
    knots = np.array([[[0, 0, 10], [0.3, 0.1, 70], [0.1, 0.2, 50]], [[0, 0, 12], [0.2, 0.3, 70], [-0.1, 0.2, 55]]])
    speeds = np.array([4.0, 1.0, 2.0, 3.0, 4.0, 4.0, 4.0, 0.2])
    plain = sn.Rates(actuator=speeds, acceleration=sn.Rates(actuator=5.0 * speeds))
    turned = abs(GAINS) * speeds
    driven = sn.Rates(actuator=turned, acceleration=sn.Rates(actuator=5.0 * turned))
    times = [sn.Motion(own, knots).timed(rates).duration for own, rates in ((PLAIN, plain), (DRIVEN, driven))]
    assert times[0] == pytest.approx(times[1], rel=1e-12)
    pairs = (PLAIN, 0.3 * plain), (DRIVEN, 0.3 * driven)
    steps = [sn.Solver(own).solve(sn.Target((40, 30, 100)), initial=knots[0], within=each) for own, each in pairs]
    np.testing.assert_allclose(steps[0].q, steps[1].q, atol=1e-12)
    bound = [each for each in steps[1].binding if each.constraint == "actuator_rate"]
    assert bound
    for each in bound:
        index = [own.name for own in DRIVEN.actuators].index(each.actuator or "")
        assert each.limit == pytest.approx(0.3 * turned[index])
        assert each.value == pytest.approx(each.limit, rel=3e-3)


def test_what_holds_back_is_said_in_the_unit_of_the_motor() -> None:
    """An arm that may turn further than its tendons; the limit of the second one is the other way round."""
    tendons = sn.Tendons(2, 5, displacement=(-3, 9), gain=[10, -10], offset=100, unit="counts")
    robot = sn.Robot([sn.Segment(80, 2.0, tendons=tendons)])
    bent = sn.Target(robot.tip([[1.2, 0, 80]])[:3, 3])  # which pulls by 6, and lets go by as much
    failed = sn.solve(robot, bent, max_starts=8)
    held = [each for each in failed.binding if each.constraint == "actuator"]
    assert {(each.actuator, round(each.value, 3), each.limit) for each in held} == {("s1.t2", 130.0, 130.0)}
    text = str(failed.explain())
    assert "value of s1.t2: at its limit of 130 counts" in text
    assert "tendons.displacement of segment 1" in text
    counts = sn.Robot([sn.Segment(80, 2.0, tendons=tendons.changed(displacement=None, limits=(10, 130)))])
    assert "tendons.limits of segment 1" in str(sn.solve(counts, bent, max_starts=8).explain())


def test_a_tick_names_the_actuator_that_is_limited() -> None:
    """Where not all of them have limits, the numbers of rows are not those of actuators."""
    free, tight = sn.Tendons(3, radius=5), sn.Tendons(3, radius=5, displacement=(-3, 3), gain=-250, offset=9)
    robot = sn.Robot([sn.Segment(80, 2.9, radius=4, tendons=each) for each in (free, tight)])
    ik, step, named = sn.Solver(robot), None, set[str]()
    for _ in range(60):
        step = ik.step([[0.0, 0, 80]] * 2 if step is None else step, (0, 100, -30), dt=0.01)
        named |= {each.actuator for each in step.active if each.actuator}
    assert named <= {"s2.t2", "s2.t3"}
    assert named


def test_files_have_the_stretch_of_elastic_motors(tmp_path: Path) -> None:
    lines = sn.Tendons(3, 4.0, stiffness=50.0)
    soft = sn.Robot([sn.Segment(50.0, 1.5, tendons=lines, stiffness=3e3) for _ in range(2)])
    bends = np.array([[[0.1, 0.2], [0.0, 0.3]], [[0.4, 0.2], [-0.3, 0.5]], [[0.1, -0.2], [0.2, 0.1]]])
    q = np.concatenate([bends, np.full((3, 2, 1), 50.0)], axis=2)
    values = soft.to_actuators(q)
    assert np.abs(values - q.reshape(3, -1) @ soft.drive.value_jacobian.T).max() > 0.1
    targets = soft.tip(q)[:, :3, 3]
    for rows in ([0], [0, 1, 2]):
        batch = sn.studies.solve_batch(soft, targets[rows])
        assert batch.results is not None
        np.testing.assert_allclose(batch.results["actuators"], soft.to_actuators(batch.results["q"]), atol=1e-12)
    sn.Motion(soft, q).to_ros(tmp_path / "motors.json", of="actuators")
    np.testing.assert_allclose(sn.Motion.load(tmp_path / "motors.json", soft).q, q, atol=1e-9)
    timed = sn.Motion(soft, q).timed(sn.Rates(bend=0.5, acceleration=sn.Rates(bend=2.0)))
    timed.to_ros(tmp_path / "timed.json", of="actuators")
    when, step = timed.times[3], 1e-5 * timed.duration
    point = json.loads((tmp_path / "timed.json").read_text(encoding="utf-8"))["points"][3]
    around = soft.to_actuators(timed.at(np.array([when - step, when + step])))
    np.testing.assert_allclose(point["velocities"], (around[1] - around[0]) / (2.0 * step), atol=1e-3)
