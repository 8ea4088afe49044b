"""Calibration: what was changed is found, exact derivatives, bounds that hold, and what rows cannot say."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.calibration.measurements import Place, read
from sinuous.calibration.model import derivatives, model, predicted, shapes
from sinuous.calibration.parameters import GROUPS, Values, can_stretch, changed, elastic, group
from sinuous.calibration.table import read_table
from sinuous.files.nouns import read_robot
from sinuous.files.yaml_syntax import parse_yaml
from tests.helpers import Floats, refused, refused_each

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


def tip_errors(found: sn.Calibration, robot: sn.Robot, values: Floats) -> Floats:
    error: Floats = np.linalg.norm(found.predict(values)[:, :3, 3] - measured(robot, values), axis=1)
    return error


@pytest.mark.parametrize("soft", [False, True])
def test_derivatives_are_exact(soft: bool) -> None:
    robot = elastic(DRAWN) if soft else DRAWN
    groups = tuple(each for name in GROUPS[2:] if (each := group(robot, name)).names)
    values = Values(groups, np.random.default_rng(2).normal(0.0, 0.03, sum(len(each.names) for each in groups)))
    places = Place(1, 1.0, np.zeros(3)), Place(0, 0.4, np.array([3.0, 1.0, 2.0]))
    actuators = settings(robot, 6) + np.random.default_rng(4).normal(0.0, 0.4, (6, 6))

    def points(x: Floats) -> Floats:
        own = model(changed(robot, values.with_x(x)), values.with_x(x), places)
        return predicted(own, shapes(own, actuators))

    own = model(changed(robot, values), values, places)
    at, slopes = derivatives(own, actuators, shapes(own, actuators))
    np.testing.assert_allclose(at, points(values.x), atol=1e-10)
    for i in range(len(values.x)):
        step = np.zeros(len(values.x))
        step[i] = 1e-6
        numeric = (points(values.x + step) - points(values.x - step)) / 2e-6
        np.testing.assert_allclose(slopes[..., i], numeric, atol=1e-5 * (1.0 + np.abs(numeric).max()))


def test_an_elastic_robot_is_found_from_its_tips() -> None:
    real = real_robot()
    values = settings(real, 100)
    found = sn.calibrate(DRAWN, values, measured(real, values, 0.1))
    assert found.robot.drive.elastic is not None
    assert tip_errors(found, real, settings(real, 100, seed=9)).mean() < 0.3
    assert found.fitted.mean < 0.3
    np.testing.assert_allclose(found.robot.base, POSE, atol=0.5)
    assert "elastic tendons" in found.explain()


def test_groups_that_are_told_are_fitted_alone() -> None:
    real = DRAWN.changed(base=POSE)
    values = settings(DRAWN, 40)
    found = sn.calibrate(DRAWN, values, measured(real, values), fit=["base"])
    np.testing.assert_allclose(found.robot.base, POSE, atol=1e-6)
    assert found.groups == ("base",)
    assert found.robot.changed(base=None, uncertainty=None).equals(DRAWN)
    device = sn.calibrate(DRAWN, values, measured(real, values), fit=["lengths"], frame="device")
    np.testing.assert_allclose(device.device @ POSE, np.eye(4), atol=1e-6)
    assert np.array_equal(device.robot.base, np.eye(4))


def test_outliers_and_rows_that_were_not_seen_count_little() -> None:
    real = DRAWN.changed(base=POSE)
    values = settings(DRAWN, 60)
    tips = measured(real, values, 0.05)
    tips[::10] += 25.0
    tips[5] = math.nan
    found = sn.calibrate(DRAWN, values, tips, fit=["base"])
    assert found.dropped == (5,)
    assert 5 not in found.rows
    assert tip_errors(found, real, values).max() < 1.0


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_the_unit_of_length_does_not_matter(scale: float) -> None:
    drawn = sn.Robot(
        [
            s.changed(length=scale * s.length[0], tendons=s.tendons.changed(radius=scale * s.tendons.radius))
            for s in DRAWN.segments
            if s.tendons is not None
        ]
    )
    real = real_robot()
    values = settings(real, 30)
    names = ["offsets", "stiffness"]
    found = sn.calibrate(drawn, scale * values, measured(real, values, 0.1), unit=scale, fit=names)
    one = sn.calibrate(DRAWN, values, measured(real, values, 0.1), fit=names)
    assert found.groups == one.groups
    assert found.fitted.mean == pytest.approx(scale * one.fitted.mean, rel=1e-3)


def test_poses_and_points_of_the_body() -> None:
    real = DRAWN.changed(base=POSE)
    values = settings(DRAWN, 40)
    q = real.from_actuators(values)
    poses = sn.calibrate(DRAWN, values, real.tip(q), fit=["base", "angles"])
    assert poses.fitted.worst < 1e-6
    points = np.stack([real.forward(q)[:, 0, :3, 3], real.tip(q)[:, :3, 3]], axis=1)
    points[3, 0] = math.nan
    found = sn.calibrate(DRAWN, values, points, places=[50.0 / 110.0, 1.0], fit=["base"])
    assert found.fitted.worst < 1e-6
    assert len(found.rows) == 40


def test_the_bound_holds_for_rows_that_are_held_back_and_proofs_know_it() -> None:
    real = real_robot()
    values = settings(real, 120)
    rows = measured(real, values, 1.0)
    found = sn.calibrate(DRAWN, values[:80], rows[:80], fit=["offsets", "stiffness", "circles"])
    off = np.linalg.norm(found.predict(values[80:])[:, :3, 3] - rows[80:], axis=1)
    assert (off <= found.bound()).mean() >= 0.9
    assert found.bound(0.95, "rows") <= found.bound(0.95)
    own = found.robot.uncertainty
    assert own is not None
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


def test_a_calibrated_robot_is_saved_and_loaded(tmp_path: Path) -> None:
    real = real_robot()
    values = settings(real, 30)
    found = sn.calibrate(DRAWN, values, measured(real, values, 0.1), fit=["offsets"])
    found.save(tmp_path / "robot.yaml")
    assert read_robot(parse_yaml((tmp_path / "robot.yaml").read_text())).equals(found.robot)
    assert sn.plot_calibration(found, tmp_path / "found.png").axes
    assert (tmp_path / "found.png").stat().st_size > 1000


def test_what_rows_do_not_determine_is_named() -> None:
    values = np.tile(settings(DRAWN, 30), (1, 1))
    values[:, 3:] = values[:, :3] * 0.5
    values[:, 5] = 0.7
    real = elastic(DRAWN)
    found = sn.calibrate(real, values, measured(real, values, 0.3), fit=["offsets", "circles", "gains"])
    assert found.undetermined
    assert any("s2.t3" in note for note in found.notes)
    few = sn.calibrate(real, values[:5], measured(real, values[:5]), fit=["offsets"])
    assert any("too few rows to fit offsets: offset of s1.t1" in note for note in few.notes)
    assert few.groups == ("base",)


def test_suggested_settings_determine_more_than_random_ones() -> None:
    suggested = sn.suggest(DRAWN, 12)
    assert suggested.shape == (12, 6)
    assert np.array_equal(suggested, sn.suggest(DRAWN, 12))
    real = real_robot()

    def spread(values: Floats) -> float:
        rows = read(DRAWN, values, measured(real, values, 0.1), None, None, None, 1.0)
        soft = elastic(DRAWN)
        groups = tuple(group(soft, name) for name in ("stiffness", "offsets"))
        own = model(soft, Values(groups, np.zeros(8)), rows.places)
        slopes = derivatives(own, values, shapes(own, values))[1].reshape(-1, 8)
        return float(np.linalg.slogdet(slopes.T @ slopes + 1e-3 * np.eye(8))[1])

    drawn = [spread(settings(elastic(DRAWN), 12, seed)) for seed in range(5)]
    assert spread(suggested) > float(np.mean(drawn))


def test_bad_measurements_are_refused() -> None:
    values = settings(DRAWN, 30)
    tips = measured(DRAWN, values)
    refused("measured", lambda: sn.calibrate(DRAWN, values, tips / 1000.0), "unit=1000 would fit")
    refused("measured", lambda: sn.calibrate(DRAWN, values, tips * 1000.0), "unit=0.001 would fit")
    refused("measured", lambda: sn.calibrate(DRAWN, values, tips[:-1]), "30 rows")
    refused("measured", lambda: sn.calibrate(DRAWN, values, np.tile(tips[0], (30, 1))), "equal")
    refused("actuators", lambda: sn.calibrate(DRAWN, np.tile(values[0], (30, 1)), tips), "equal")
    refused("actuators", lambda: sn.calibrate(DRAWN, values[:, :3], tips), "6 numbers")
    refused("measured", lambda: sn.calibrate(DRAWN, values, np.full((30, 3), math.nan)), "no row")
    refused("groups", lambda: sn.calibrate(DRAWN, values, tips, groups=["a"]), "30")
    refused("fit[0]", lambda: sn.calibrate(DRAWN, values, tips, fit=["bases"]), "base")
    refused("robot", lambda: sn.calibrate(sn.Robot([sn.Segment(1.0)]), values, tips), "actuators")
    loose = DRAWN.changed(segments=[each.changed(length=(40, 60)) for each in DRAWN.segments])
    told = "no actuator determines length of s1 (segment 1), length of s2"
    refused("robot", lambda: sn.calibrate(loose, values, tips), told)
    refused("robot", lambda: sn.suggest(loose, 5), told)
    stage = sn.Robot([sn.Segment((0.0, 100.0), stage=sn.Stage(), max_bend=0.0)])
    assert not can_stretch(stage)
    lengths = np.linspace(1.0, 90.0, 20)[:, None]
    refused(
        "fit", lambda: sn.calibrate(stage, lengths, stage.tip(stage.from_actuators(lengths))[:, :3, 3], fit=["rest"])
    )
    bad: Any = "rows"
    refused_each("measured", (bad, None, [[1.0]]), lambda m: sn.calibrate(DRAWN, values, m))


def test_a_table_of_measurements(tmp_path: Path) -> None:
    file = tmp_path / "rows.csv"
    file.write_text("# cameras\npattern,b,x,y,z,a\nup,1,2,3,4,5\ndown,6,,8,9,nan\n")
    table = read_table(file, ["a", "b"])
    np.testing.assert_array_equal(table.actuators, [[5.0, 1.0], [math.nan, 6.0]])
    np.testing.assert_array_equal(table.measured, [[2.0, 3.0, 4.0], [math.nan, 8.0, 9.0]])
    assert table.groups == ("up", "down")
    with pytest.raises(sn.InputError, match="no column c"):
        read_table(file, ["a", "c"])
    file.write_text("a,x,y,z\n1,2,3,far\n")
    with pytest.raises(sn.InputError, match=r"row 0: .*column z"):
        read_table(file, ["a"])
    file.write_text("a,x1,y1,z1,x2,y2,z2\n1,2,3,4,5,6,7\n")
    assert read_table(file, ["a"]).measured.shape == (1, 2, 3)
