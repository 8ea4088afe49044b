"""Calibration: what was changed is found, exact derivatives, bounds that hold, and what rows cannot say."""

import itertools
import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.files.documents import parse_yaml
from sinuous.files.nouns import read_robot
from sinuous.model.joints import moved_joints
from sinuous.studies.calibration import calibrate
from sinuous.studies.calibration.fit import begun, extended, fitted, moved, predict
from sinuous.studies.calibration.measurements import Place, read, read_table
from sinuous.studies.calibration.model import at_rest, derivatives, holds, model, predicted
from sinuous.studies.calibration.parameters import (
    GROUPS,
    Values,
    can_stretch,
    changed,
    elastic,
    group,
    with_joint_motors,
)
from tests.helpers import Floats, present, refused, refused_each

DRAWN = sn.Robot([sn.Segment(length, tendons=sn.Tendons(3, 4.0, 0.5 * k)) for k, length in enumerate((50.0, 60.0))])
POSE = sn.pose((20.0, -5.0, 7.0), rotation=(0.5, 0.5, -0.5, 0.5))


def settings(robot: sn.Robot, count: int, seed: int = 0) -> Floats:
    rng = np.random.default_rng(seed)
    q = np.zeros((count, len(robot), 3))
    q[..., :2] = rng.normal(0.0, 0.4, (count, len(robot), 2))
    q[..., 2] = [segment.length[0] for segment in robot.segments]
    return robot.to_actuators(q)


def real_robot() -> sn.Robot:
    """An elastic robot that differs from the drawing."""
    soft = elastic(DRAWN)
    groups = tuple(group(soft, name) for name in ("stiffness", "offsets", "circles"))
    x = np.array([0.3, -0.2, 0.4, -0.3, 0.2, 0.5, 0.1, -0.4, 0.05, -0.04])
    return changed(soft, Values(groups, x)).changed(base=POSE)


def measured(robot: sn.Robot, values: Floats, noise: float = 0.0) -> Floats:
    tips = robot.tip(robot.from_actuators(values))[:, :3, 3]
    return tips + np.random.default_rng(1).normal(0.0, noise, tips.shape) if noise else tips


def sample(count: int, noise: float) -> tuple[sn.Robot, Floats, Floats]:
    """The elastic robot, settings of its actuators, and what is measured of its tip there."""
    real = real_robot()
    values = settings(real, count)
    return real, values, measured(real, values, noise)


def tip_errors(found: sn.studies.Calibration, robot: sn.Robot, values: Floats) -> Floats:
    error: Floats = np.linalg.norm(found.predict(values)[:, :3, 3] - measured(robot, values), axis=1)
    return error


HANGING = sn.Robot(
    [
        sn.Segment(50.0, tendons=sn.Tendons(3, 4.0), stiffness=sn.Stiffness(3e3, 2.5e3), mass=2e-4, arcs=3),
        sn.Segment(60.0, tendons=sn.Tendons(3, 4.0, 0.5), stiffness=sn.Stiffness(2e3, 1.5e3), mass=1e-4, arcs=2),
    ],
    gravity=(0.0, 0.0, -9.81),
    payload=sn.Payload(0.01),
    base=sn.pose(direction=(1.0, 0.3, 0.2)),
)
"""In mm, kg and N: its weight moves the tip by a seventh of its length."""


@pytest.mark.parametrize(
    "robot", [DRAWN, elastic(DRAWN), HANGING, elastic(HANGING)], ids=["rigid", "elastic", "hanging", "hanging elastic"]
)
def test_derivatives_are_exact(robot: sn.Robot) -> None:
    groups = tuple(each for name in GROUPS[2:] if (each := group(robot, name)).names)
    values = Values(groups, np.random.default_rng(2).normal(0.0, 0.03, sum(len(each.names) for each in groups)))
    values = values.with_x(np.clip(values.x, 0.5 * values.lowest, -0.5 * values.lowest))
    places = Place(1, 1.0, np.zeros(3)), Place(0, 0.4, np.array([3.0, 1.0, 2.0]))
    actuators = settings(robot, 6) + np.random.default_rng(4).normal(0.0, 0.4, (6, 6))

    def points(x: Floats) -> Floats:
        return predicted(model(robot, values.with_x(x), places), actuators)

    at, slopes = derivatives(model(robot, values, places), actuators)
    np.testing.assert_allclose(at, points(values.x), atol=1e-10)
    for i in range(len(values.x)):
        step = np.zeros(len(values.x))
        step[i] = 1e-6
        numeric = (points(values.x + step) - points(values.x - step)) / 2e-6
        np.testing.assert_allclose(slopes[..., i], numeric, atol=1e-5 * (1.0 + np.abs(numeric).max()))


def tips_at_rest(robot: sn.Robot, values: Floats) -> Floats:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sn.SuspiciousInput)  # tendons whose values contradict each other
        return np.array([robot.equilibrium(each).tip[:3, 3] for each in values])


@pytest.mark.parametrize("frame", ["base", "device"])
def test_a_payload_is_found_under_gravity(frame: Any) -> None:
    """What is drawn carries nothing, and is nowhere near: the base tilts it, or the device lies askew."""
    drawn, values = HANGING.changed(payload=None), settings(HANGING, 12)
    tilted = HANGING.changed(base=sn.pose((20.0, -5.0, 7.0), direction=(1.0, -0.5, -0.4)))
    real = tilted if frame == "base" else HANGING
    tips = tips_at_rest(real, values)
    if frame == "device":
        tips = tips @ POSE[:3, :3].T + POSE[:3, 3]
    found = sn.studies.calibrate(drawn, values, tips, fit=["payload"], frame=frame)
    assert found.robot.payload[0].mass == pytest.approx(0.01, rel=1e-6)
    assert found.fitted.worst < 1e-6
    np.testing.assert_allclose(found.robot.base, real.base, atol=1e-6)
    np.testing.assert_allclose(found.predict(values)[:, :3, 3], tips_at_rest(real, values), atol=1e-6)
    own = next(each for each in found.parameters if each.group == "payload")
    assert (own.name, own.kind) == ("mass of the payload", "mass")
    assert own.value == pytest.approx(0.01)


def test_a_pose_turns_a_robot_under_gravity() -> None:
    values = settings(HANGING, 6)
    rows = read(HANGING, values, tips_at_rest(HANGING, values) + 1.0, None, None, None, 1.0)
    last = fitted(HANGING, extended(begun(HANGING, rows, levelled=True), group(HANGING, "payload")), rows, 1)
    for i in range(7):
        step = np.zeros(7)
        step[i] = 1e-6
        sides = [predict(HANGING, moved(last.state, sign * step), rows) for sign in (1.0, -1.0)]
        numeric = (sides[0] - sides[1]) / 2e-6
        np.testing.assert_allclose(last.slopes[..., i], numeric, atol=1e-5 * (1.0 + np.abs(numeric).max()))


def test_an_elastic_robot_is_found_from_its_tips() -> None:
    real, values, tips = sample(24, 0.1)
    found = sn.studies.calibrate(DRAWN, values, tips)
    assert found.robot.drive.elastic is not None
    assert tip_errors(found, real, settings(real, 20, seed=9)).mean() < 0.3
    assert found.fitted.mean < 0.3
    np.testing.assert_allclose(found.robot.base, POSE, atol=0.5)
    assert "elastic tendons" in found.explain()


def test_outliers_and_rows_that_were_not_seen_count_little() -> None:
    real = DRAWN.changed(base=POSE)
    values = settings(DRAWN, 60)
    tips = measured(real, values, 0.05)
    tips[::10] += 25.0
    tips[5] = math.nan
    found = sn.studies.calibrate(DRAWN, values, tips, fit=["base"])
    assert found.dropped == (5,)
    assert 5 not in found.rows
    assert tip_errors(found, real, values).max() < 1.0


@pytest.fixture(scope="module")
def in_its_own_unit() -> sn.studies.Calibration:
    _, values, tips = sample(30, 0.1)
    return sn.studies.calibrate(DRAWN, values, tips, fit=["offsets", "stiffness"])


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_the_unit_of_length_does_not_matter(scale: float, in_its_own_unit: sn.studies.Calibration) -> None:
    drawn = sn.Robot(
        [
            s.changed(length=scale * s.length[0], tendons=s.tendons.changed(radius=scale * s.tendons.radius))
            for s in DRAWN.segments
            if s.tendons is not None
        ]
    )
    _, values, tips = sample(30, 0.1)
    found = sn.studies.calibrate(drawn, scale * values, tips, unit=scale, fit=["offsets", "stiffness"])
    assert found.groups == in_its_own_unit.groups
    assert found.fitted.mean == pytest.approx(scale * in_its_own_unit.fitted.mean, rel=1e-3)


def test_poses_and_points_of_the_body() -> None:
    real = DRAWN.changed(base=POSE)
    values = settings(DRAWN, 40)
    q = real.from_actuators(values)
    poses = sn.studies.calibrate(DRAWN, values, real.tip(q), fit=["base", "angles"])
    assert poses.fitted.worst < 1e-6
    points = np.stack([real.forward(q)[:, 0, :3, 3], real.tip(q)[:, :3, 3]], axis=1)
    points[3, 0] = math.nan
    found = sn.studies.calibrate(DRAWN, values, points, places=[50.0 / 110.0, 1.0], fit=["base"])
    assert found.fitted.worst < 1e-6
    assert len(found.rows) == 40


def test_the_bound_holds_for_rows_that_are_held_back_and_proofs_know_it() -> None:
    _, values, rows = sample(120, 1.0)
    found = sn.studies.calibrate(DRAWN, values[:80], rows[:80], fit=["offsets", "stiffness", "circles"])
    off = np.linalg.norm(found.predict(values[80:])[:, :3, 3] - rows[80:], axis=1)
    assert (off <= found.bound()).mean() >= 0.9
    assert found.bound(0.95, "rows") <= found.bound(0.95)
    own = present(found.robot.uncertainty)
    assert isinstance(own.bound, float)
    assert own.bound == pytest.approx(found.bound())
    q = found.robot.from_actuators(values[0])
    target = found.robot.tip(q)[:3, 3]
    beside = target + np.array([own.bound + 3.0, 0.0, 0.0])
    kept = sn.solve(found.robot, sn.Target(target), [sn.Sphere(beside, 1.0)])
    assert kept.solved
    assert "at 95 %" in str(kept)
    assert kept.to_dict()["uncertainty"] == {"bound": own.bound}
    near = target + np.array([0.9 * own.bound, 0.0, 0.0])
    assert not sn.solve(found.robot, sn.Target(target), [sn.Sphere(near, 0.5)], time=0.05).solved


def test_rows_that_a_tracker_lost_are_left_out_and_named() -> None:
    real, values, tips = sample(40, 0.5)
    whole = sn.studies.calibrate(DRAWN, values, tips, fit=["offsets"])
    tips[[4, 17]] = 0.0
    found = sn.studies.calibrate(DRAWN, values, tips, fit=["offsets"])
    assert found.dropped == (4, 17)
    assert found.notes == ("rows that say 0, 0, 0, taken as not seen: 4, 17", *whole.notes)
    assert found.bound() < 1.2 * whole.bound()
    relative = measured(real, values) - measured(real, values)[7]  # here the origin is a place of the tip
    assert sn.studies.calibrate(DRAWN, values, relative, fit=["base"]).dropped == ()


def test_outliers_and_rows_that_stall_are_named() -> None:
    _, values, tips = sample(40, 0.5)
    whole = sn.studies.calibrate(DRAWN, values, tips, fit=["offsets"])
    assert whole.outliers == ()
    assert not any("off by more" in note or "repeat" in note for note in whole.notes)
    tips[9] += (100.0, 0.0, 0.0)
    tips[21:23] = tips[20]
    found = sn.studies.calibrate(DRAWN, values, tips, fit=["offsets"])
    assert {9} <= set(found.outliers) <= {9, 20, 21, 22}
    assert "rows that repeat the points of the row before, while actuators moved: 21, 22" in found.notes
    assert found.notes[-1].startswith("rows that are off by more than 8 times the median")
    tip = whole.predict(values[3])[:3, 3]
    solution, unsure = sn.solve(whole.robot, sn.Target(tip), [sn.Sphere(tip + 60.0, 5)]), whole.robot.uncertainty
    least = present(solution.clearance) + float(np.min(present(unsure).bound))
    assert whole.confidence(solution) == whole.confidence(least)
    refused("error", lambda: found.confidence(-1.0), "at least 0")


def test_a_mistake_that_explains_most_of_the_error_is_told() -> None:
    _, values, tips = sample(30, 0.5)
    order = [1, 0, *range(2, values.shape[1])]
    signs = np.where(np.arange(values.shape[1]) == 2, -1.0, 1.0)
    names = [actuator.name for actuator in DRAWN.actuators]
    for wrong, told in (
        (values, None),
        (values[:, order], f"exchanging the columns {names[0]} and {names[1]}"),
        (values * signs, f"turning the sign of {names[2]}"),
        (values / 25.4, "actuator values times 25.4"),
        (np.roll(values, -1, axis=0), "measurements that come 1 row late"),
    ):
        notes = sn.studies.calibrate(DRAWN, wrong, tips, fit=["offsets"]).notes
        explained = [note for note in notes if "would explain these rows" in note]
        assert [note.split(" would")[0] for note in explained] == ([] if told is None else [told])


def test_play_is_told_and_fitted() -> None:
    """Tips follow motors late where these turn round: simulated by holding each motor's last direction."""
    random = np.random.default_rng(4)
    ends = settings(DRAWN, 8)
    pulls = np.concatenate([np.linspace(a, b, 6, endpoint=False) for a, b in itertools.pairwise(ends)])
    play, followed, now = 0.4, np.empty_like(pulls), pulls[0].copy()
    for i, row in enumerate(pulls):
        back, forth = row - now > 0.5 * play, now - row > 0.5 * play
        now = np.where(back, row - 0.5 * play, np.where(forth, row + 0.5 * play, now))
        followed[i] = now
    real = DRAWN.changed(base=POSE)
    tips = real.tip(real.from_actuators(followed, tolerance=1.0))[:, :3, 3]
    tips += random.normal(scale=0.01, size=tips.shape)
    told = sn.studies.calibrate(DRAWN, pulls, tips)
    assert any("play of 0." in note for note in told.notes)
    assert told.play == 0.0
    found = sn.studies.calibrate(DRAWN, pulls, tips, fit=["play"])
    assert found.play == pytest.approx(play, rel=0.2)
    off = np.linalg.norm(found.predict(pulls, in_order=True)[:, :3, 3] - tips, axis=1)
    late = np.linalg.norm(found.predict(pulls)[:, :3, 3] - tips, axis=1)
    assert off.mean() < 0.3 * late.mean()
    assert late.mean() == pytest.approx(found.expected.mean, rel=0.1)  # the bound knows nothing of the motion before
    plain = sn.studies.calibrate(DRAWN, followed, tips)
    assert not any("play" in note for note in plain.notes)


def test_a_calibrated_robot_is_saved_and_loaded(tmp_path: Path, in_its_own_unit: sn.studies.Calibration) -> None:
    in_its_own_unit.save(tmp_path / "robot.yaml")
    assert read_robot(parse_yaml((tmp_path / "robot.yaml").read_text())).equals(in_its_own_unit.robot)
    assert sn.view.plot_calibration(in_its_own_unit, tmp_path / "found.png").axes
    assert (tmp_path / "found.png").stat().st_size > 1000


def test_what_rows_do_not_determine_is_named() -> None:
    values = np.tile(settings(DRAWN, 30), (1, 1))
    values[:, 3:] = values[:, :3] * 0.5
    values[:, 5] = 0.7
    real = elastic(DRAWN)
    found = sn.studies.calibrate(real, values, measured(real, values, 0.3), fit=["offsets", "circles", "gains"])
    assert found.undetermined
    assert any("s2.t3" in note for note in found.notes)
    few = sn.studies.calibrate(real, values[:5], measured(real, values[:5]), fit=["offsets"])
    assert any("too few rows to fit offsets: offset of s1.t1" in note for note in few.notes)
    assert few.groups == ("base",)


@pytest.fixture(autouse=True)
def few_settings_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calibrate, "CANDIDATES", 60)


def test_settings_are_suggested_that_hold_the_load() -> None:
    heavy = HANGING.changed(payload=sn.Payload(1e8))  # of less, all is found at rest
    assert not holds(heavy, settings(heavy, 50)).all()
    assert holds(heavy, sn.studies.suggest(heavy, 3, fit=["payload"])).all()


def test_bad_measurements_are_refused() -> None:
    values = settings(DRAWN, 30)
    tips = measured(DRAWN, values)
    refused("measured", lambda: sn.studies.calibrate(DRAWN, values, tips / 1000.0), "unit=1000 would fit")
    refused("measured", lambda: sn.studies.calibrate(DRAWN, values, tips * 1000.0), "unit=0.001 would fit")
    refused("measured", lambda: sn.studies.calibrate(DRAWN, values, tips[:-1]), "30 rows")
    refused("measured", lambda: sn.studies.calibrate(DRAWN, values, np.tile(tips[0], (30, 1))), "equal")
    refused("actuators", lambda: sn.studies.calibrate(DRAWN, np.tile(values[0], (30, 1)), tips), "equal")
    refused("actuators", lambda: sn.studies.calibrate(DRAWN, values[:, :3], tips), "6 numbers")
    refused("measured", lambda: sn.studies.calibrate(DRAWN, values, np.full((30, 3), math.nan)), "no row")
    refused("groups", lambda: sn.studies.calibrate(DRAWN, values, tips, groups=["a"]), "30")
    refused("fit[0]", lambda: sn.studies.calibrate(DRAWN, values, tips, fit=["bases"]), "base")
    refused("robot", lambda: sn.studies.calibrate(sn.Robot([sn.Segment(1.0)]), values, tips), "actuators")
    loose = DRAWN.changed(segments=[each.changed(length=(40, 60)) for each in DRAWN.segments])
    told = "no actuator determines length of s1 (segment 1), length of s2"
    refused("robot", lambda: sn.studies.calibrate(loose, values, tips), told)
    refused("robot", lambda: sn.studies.suggest(loose, 5), told)
    stage = sn.Robot([sn.Segment((0.0, 100.0), stage=sn.Stage(), max_bend=0.0)])
    assert not can_stretch(stage)
    lengths = np.linspace(1.0, 90.0, 20)[:, None]
    refused(
        "fit",
        lambda: sn.studies.calibrate(stage, lengths, stage.tip(stage.from_actuators(lengths))[:, :3, 3], fit=["rest"]),
    )
    refused("fit", lambda: sn.studies.calibrate(DRAWN, values, tips, fit=["payload"]), "no weight bends the robot")
    heavy = HANGING.changed(payload=sn.Payload(1.0))
    refused("actuators", lambda: sn.studies.calibrate(heavy, values, tips), "no stable equilibrium")
    bad: Any = "rows"
    refused_each("measured", (bad, None, [[1.0]]), lambda m: sn.studies.calibrate(DRAWN, values, m))


def test_a_table_of_measurements(tmp_path: Path) -> None:
    file = tmp_path / "rows.csv"
    file.write_text("# cameras\npattern,b,x,y,z,a\nup,1,2,3,4,5\ndown,6,,8,9,nan\n")
    table = read_table(file, ["a", "b"])
    np.testing.assert_array_equal(table.actuators, [[5.0, 1.0], [math.nan, 6.0]])
    np.testing.assert_array_equal(table.measured, [[2.0, 3.0, 4.0], [math.nan, 8.0, 9.0]])
    assert table.groups == ("up", "down")
    refused("header", lambda: read_table(file, ["a", "c"]), "no column c", file=file)
    file.write_text("a,x,y,z\n1,2,3,far\n")
    refused("line 2.z", lambda: read_table(file, ["a"]), "number", file=file)
    file.write_text("a,x1,y1,z1,x2,y2,z2\n1,2,3,4,5,6,7\n")
    assert read_table(file, ["a"]).measured.shape == (1, 2, 3)


def jointed(**more: Any) -> sn.Robot:
    """A tilting and sliding base below one segment, with offsets of the joints if any are given."""
    offsets = more.pop("offsets", (0.0, 0.0))
    joints = [
        sn.Revolute((0, 1, 0.3), (-1.2, 1.2), (0, 0, 20), name="tilt"),
        sn.Prismatic((0, 0.1, 1), (0, 60), name="feed"),
    ]
    return sn.Robot(
        [sn.Segment(60.0, tendons=sn.Tendons(3, 4.0), **more)], joints=moved_joints(joints, np.array(offsets))
    )


@pytest.mark.parametrize("hangs", [False, True])
def test_offsets_of_joints_are_found(hangs: bool) -> None:
    soft: dict[str, Any] = {"stiffness": sn.Stiffness(2e3, 1.5e3), "mass": 2e-4, "arcs": 2} if hangs else {}
    drawn = with_joint_motors(jointed(**soft))
    real, offsets = with_joint_motors(jointed(**soft, offsets=(0.06, -2.0))), [0.06, -2.0]
    if hangs:
        drawn, real = (each.changed(gravity=(0.0, 0.0, -9.81)) for each in (drawn, real))
    assert [each.name for each in drawn.actuators][-2:] == ["tilt", "feed"]
    rng = np.random.default_rng(4)
    q = np.concatenate([rng.normal(0.0, 0.4, (30, 1, 2)), np.full((30, 1, 1), 60.0)], axis=2)
    values = drawn.to_actuators(drawn.with_joints(q, rng.uniform((-1.0, 5.0), (1.0, 55.0), (30, 2))))
    tips = at_rest(real, values).tips()
    groups = (group(drawn, "joints"),)
    own = model(drawn, Values(groups, np.array([0.03, -1.0])), (Place(len(drawn) - 1, 1.0, np.zeros(3)),))
    for i, step in enumerate((1e-6, 1e-4)):
        ends = [
            predicted(model(drawn, own.values.with_x(own.values.x + side * step * np.eye(2)[i]), own.places), values)
            for side in (1.0, -1.0)
        ]
        slope = derivatives(own, values)[1][..., i]
        np.testing.assert_allclose(slope, (ends[0] - ends[1]) / (2.0 * step), atol=1e-4 * np.abs(slope).max())
    found = sn.studies.calibrate(jointed(**soft).changed(gravity=drawn.gravity), values, tips, fit=["joints"])
    assert {each.kind for each in found.parameters if each.group == "joints"} == {"angle", "length"}
    assert np.linalg.norm((found.predict(values) - tips)[:, :3, 3], axis=1).max() < 1e-3
    moved_by = [each.value for each in found.parameters if each.group == "joints"]
    base = found.robot.base  # an offset of the first joint, and of the base, are told apart by what is drawn alone
    assert abs(moved_by[0] - offsets[0]) < 0.03 or np.abs(base - np.eye(4)).max() > 1e-3
    assert moved_by[1] == pytest.approx(offsets[1], abs=0.5)
    assert sn.studies.suggest(jointed(**soft), 4, fit=["joints"]).shape == (4, 5)
