"""A motion: knots, times, and what is proved of all of it.

Configurations: distances, limits of segments, and random ones within them.

The whole path at once, made shorter.
"""

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.arguments import Shortest
from sinuous.kernels.packing import scales_of
from sinuous.motion.configurations import random_configuration, within_limits
from sinuous.motion.report import Report
from sinuous.motion.shortening import metric_of
from sinuous.solver.certificates.steps import Steps
from tests.helpers import Floats, present, refused, with_each

ROBOT = sn.Robot([sn.Segment((0.8, 1.2), 2.0, radius=0.05, tendons=sn.Tendons(3, 0.04)) for _ in range(3)])
BALL = sn.Sphere((0.9, 0.0, 1.2), 0.3, name="ball")
STRAIGHT = np.tile([0.0, 0.0, 1.0], (3, 1))
BENT = np.array([[-0.4, 0.2, 1.1], [-0.3, 0.0, 0.9], [0.2, 0.5, 1.0]])
KNOTS = np.stack([STRAIGHT, BENT, 0.5 * (STRAIGHT + BENT)])


def test_one_made_of_knots_is_proved() -> None:
    motion = sn.Motion(ROBOT, KNOTS, [BALL], times=[0.0, 0.5, 2.0])
    assert motion.solved
    assert (motion.between, motion.unproved_steps) == ("proved", ())
    sampled = min(sn.Scene([BALL]).distance(ROBOT.backbone(q)).min() for q in motion.at(np.linspace(0.0, 2.0, 200)))
    assert 0.0 < present(motion.clearance) <= sampled - 0.05 + 1e-12
    assert motion.actuators.shape == (3, 9)
    assert (motion.solutions, motion.waypoint_knots) == ((), ())


def test_a_step_through_an_obstacle_is_blocked_and_says_where() -> None:
    across = np.stack([BENT, BENT * [-1.0, -1.0, 1.0]])
    motion = sn.Motion(ROBOT, across, [sn.Sphere((0.0, 0.0, 2.0), 0.2)])
    assert motion.status is sn.Status.BLOCKED
    assert motion.worst is not None
    assert (motion.worst.obstacle, motion.worst.step) == ("sphere[0]", 1)
    assert "overlaps; step 1, at time" in str(motion)
    assert (motion.between, motion.unproved_steps, motion.clearance) == ("unproved", (1,), None)
    with pytest.raises(sn.NotSolvedError):
        motion.raise_for_status()


@with_each("seed", range(5))
def test_a_motion_is_blocked_where_independent_sampling_sees_an_overlap(seed: int) -> None:
    rng = np.random.default_rng(seed)
    knots = np.stack([ROBOT.clamp(BENT + rng.normal(0.0, 0.3, (3, 3))) for _ in range(4)])
    balls = [sn.Sphere(rng.uniform((-1, -1, 0.8), (1, 1, 3)), 0.25, name=f"ball{i}") for i in range(4)]
    motion, unit = sn.Motion(ROBOT, knots, balls, times=[0.0, 1.0, 3.0, 4.0]), ROBOT.mean_length
    steps = motion.verify()
    deepest = min(min(step.clearance, step.self_clearance) for step in steps)
    if deepest < -1e-3 * unit:
        assert motion.status is sn.Status.BLOCKED
    if motion.status is sn.Status.BLOCKED:
        worst = present(motion.worst)
        assert worst.step is not None
        assert worst.time is not None
        assert motion.times[worst.step - 1] <= worst.time <= motion.times[worst.step]
        there = sn.check(ROBOT, motion.at(worst.time), balls)
        assert worst.amount == pytest.approx(-min(there.clearance, there.self_clearance), abs=1e-3 * unit)
        assert worst.amount >= -deepest - 0.05 * unit
        if worst.constraint == "clearance":
            assert (worst.segment, worst.obstacle) == (there.segment, there.obstacle)
        back = motion.reversed()
        assert back.worst is not None
        assert (back.status, back.worst.step) == (motion.status, len(knots) - worst.step)
        assert np.allclose(back.at(back.worst.time or 0.0), motion.at(worst.time))
    else:
        assert motion.status is (sn.Status.UNPROVED if motion.unproved_steps else sn.Status.SOLVED)


def test_a_motion_that_was_falsified_between_its_waypoints_does_not_verify() -> None:
    """Knots are clear, and somebody says that the step is proved: it leads through a ball, and is looked at."""
    across = np.stack([BENT, BENT * [-1.0, -1.0, 1.0]])
    honest = sn.Motion(ROBOT, across, [sn.Sphere((0.0, 0.0, 2.0), 0.2, name="ball")])
    told = Steps.told(1, (), 0.1, None)
    false = sn.Motion.made(ROBOT, honest.scene, honest.q, honest.times, told, Report())
    assert false.solved
    (step,) = false.verify()
    assert not step.ok
    assert step.clearance < 0.0
    assert step.obstacle == "ball"
    assert all(step.ok for step in sn.Motion(ROBOT, KNOTS, [BALL]).verify())


def test_a_motion_that_was_falsified_in_its_file_does_not_verify() -> None:
    """Knots are told to be others than those that were proved: the step to them breaks a limit."""
    motion = sn.track(ROBOT, [sn.Target(ROBOT.tip(q)[:3, 3]) for q in KNOTS[1:]], start=STRAIGHT)
    assert motion.solved
    assert all(each.ok for each in motion.verify())
    assert len(motion.verify()) == len(motion.solutions) + len(motion.q) - 1
    values = motion.to_dict()
    values["knots"][1][0][2] = 1.3
    read = sn.Motion.from_dict(values, [solution.problem for solution in motion.solutions])
    assert read.solved
    assert not all(each.ok for each in read.verify())


def test_a_table_holds_knots_or_samples(tmp_path: Path) -> None:
    motion = sn.Motion(ROBOT, KNOTS, times=[0.0, 0.5, 2.0])
    motion.to_csv(tmp_path / "knots.csv")
    motion.to_csv(tmp_path / "samples.csv", rate=4)
    with (tmp_path / "samples.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["time"]) for row in rows] == np.arange(0.0, 2.25, 0.25).tolist()
    q = np.array([[float(value) for value in list(row.values())[1:10]] for row in rows]).reshape(-1, 3, 3)
    np.testing.assert_allclose(q, motion.at(np.arange(0.0, 2.25, 0.25)), atol=1e-15)
    assert len((tmp_path / "knots.csv").read_text().splitlines()) == 1 + 3
    for rate in (0, -1, "fast"):
        refused("rate", lambda rate=rate: motion.to_csv(tmp_path / "no.csv", rate=rate))  # type: ignore[misc]


def test_what_is_saved_as_arrays_is_the_same(tmp_path: Path) -> None:
    motion = sn.Motion(ROBOT, KNOTS, [BALL], times=[0.0, 0.5, 2.0])
    motion.to_npz(tmp_path / "motion.npz")
    again = sn.Motion.from_npz(tmp_path / "motion.npz", ROBOT, [BALL])
    np.testing.assert_array_equal(again.q, motion.q)
    np.testing.assert_array_equal(again.times, motion.times)
    assert again.clearance == motion.clearance
    with np.load(tmp_path / "motion.npz") as values:
        assert values["actuator_names"].tolist() == [actuator.name for actuator in ROBOT.actuators]
        np.testing.assert_array_equal(values["actuators"], motion.actuators)
    with pytest.raises(sn.InputError, match=r"motion\.npz: q: .*; expected"):
        sn.Motion.from_npz(tmp_path / "motion.npz", sn.Robot.uniform(2, 1.0))
    (tmp_path / "other.npz").write_text("nothing")
    refused("file", lambda: sn.Motion.from_npz(tmp_path / "other.npz", ROBOT), "no motion")
    refused("file", lambda: sn.Motion.from_npz(tmp_path / "absent.npz", ROBOT), "cannot be read")
    refused("file", lambda: motion.to_npz(tmp_path), "cannot be written")


WRONG: list[tuple[str, dict[str, Any]]] = [
    ("robot", {"robot": 3}),
    ("q", {"q": KNOTS[:1]}),
    ("q", {"q": KNOTS[..., :2]}),
    ("q[1]", {"q": [STRAIGHT, np.full((3, 3), np.nan)]}),
    ("q[1]", {"q": [STRAIGHT, STRAIGHT * 1.5]}),
    ("times", {"times": [0.0, 1.0]}),
    ("times[2]", {"times": [0.0, 1.0, 1.0]}),
    ("times", {"times": [0.0, 1.0, np.inf]}),
    ("scene", {"scene": 3}),
]


@with_each(("key", "given"), WRONG)
def test_what_is_no_motion_is_refused(key: str, given: dict[str, Any]) -> None:
    whole: dict[str, Any] = {"robot": ROBOT, "q": KNOTS, **given}
    refused(key, lambda: sn.Motion(**whole))


def test_among_obstacles_that_move_a_motion_is_proved_for_its_times() -> None:
    ball = sn.Moving(sn.Sphere((0.0, 0.0, 0.0), 0.3), [0, 1, 2], [(2, 0, 1), (0.5, 0, 1), (2, 0, 1)])
    motion = sn.Motion(ROBOT, KNOTS, [ball], times=[0.0, 1.0, 2.0])
    assert motion.scene.moves
    backwards = motion.reversed()
    assert backwards.times.tolist() == motion.times.tolist()
    assert backwards.equals(sn.Motion(ROBOT, KNOTS[::-1], [ball], times=[0.0, 1.0, 2.0]))
    refused("motion", lambda: motion.timed(sn.Rates(bend=1.0, length=1.0)))
    finer = motion.resampled(10.0)
    assert finer.status is motion.status


ON_STAGE = sn.on_stage(sn.Robot.uniform(3, (0.0, 1.2), 2.4, max_curvature=3.0, radius=0.05), 2.0)
ENDLESS = sn.Robot.uniform(2, 1.0, radius=0.01)


@pytest.mark.parametrize("robot", [ON_STAGE, ENDLESS])
def test_random_configurations_are_within_limits(robot: sn.Robot) -> None:
    rng = np.random.default_rng(0)
    drawn = np.stack([random_configuration(robot, rng) for _ in range(500)])
    assert max(robot.excess(q) for q in drawn) < 1e-12
    assert np.hypot(drawn[..., 0], drawn[..., 1]).max() <= 2.0 * np.pi
    moves = np.ptp(drawn, axis=0).ravel() > 0.0
    np.testing.assert_array_equal(moves, scales_of(robot.limits).ravel() > 0.0)


def test_what_is_within_limits_stays_and_the_rest_is_brought_there() -> None:
    rng = np.random.default_rng(1)
    q = rng.normal(size=(300, 4, 3)) * [3.0, 3.0, 1.0] + [0.0, 0.0, 0.8]
    brought = within_limits(ON_STAGE, q)
    assert max(ON_STAGE.excess(each) for each in brought) < 1e-12
    np.testing.assert_allclose(within_limits(ON_STAGE, brought), brought, atol=1e-12)
    cross = q[..., 0] * brought[..., 1] - q[..., 1] * brought[..., 0]
    np.testing.assert_allclose(cross, 0.0, atol=1e-12)  # bends keep their direction


FOUR = sn.Robot.uniform(4, (0.8, 1.2), max_bend=2.0, radius=0.05, tendons=sn.Tendons(3, 0.04))
PATH = [sn.Target((2.0 * np.cos(turn), 2.0 * np.sin(turn), 2.5)) for turn in np.linspace(0.0, 2.0, 12)]
ASIDE = sn.Sphere((0.9, 0.3, 1.2), 0.3, name="ball")


def effort(motion: sn.Motion, metric: Floats) -> float:
    steps = np.diff(motion.q.reshape(len(motion.q), -1), axis=0)
    return float((np.einsum("ti,ij,tj->t", steps, metric, steps) / np.diff(motion.times)).sum())


@pytest.mark.parametrize("shortest", ["configuration", "actuators"])
def test_it_gets_easier_and_stays_proved(shortest: Shortest) -> None:
    plain = sn.track(FOUR, PATH, [ASIDE], deviation=0.05)
    short = sn.track(FOUR, PATH, [ASIDE], deviation=0.05, shortest=shortest)
    metric = metric_of(FOUR, shortest)
    assert effort(short, metric) < 0.95 * effort(plain, metric)
    assert short.solved
    assert all(verification.ok for verification in short.verify())
    for solution, knot in zip(short.solutions, short.waypoint_knots, strict=True):
        np.testing.assert_array_equal(short.q[present(knot)], solution.q)
    tips = FOUR.tip(short.q)[:, :3, 3]
    np.testing.assert_allclose(tips, FOUR.tip(plain.q)[:, :3, 3], atol=2e-3)


def test_what_cannot_be_meant_is_refused() -> None:
    refused("shortest", lambda: sn.track(FOUR, PATH, shortest="time"), "configuration or actuators")  # type: ignore[arg-type]
    bare = sn.Robot.uniform(4, (0.8, 1.2), max_bend=2.0)
    refused("shortest", lambda: sn.track(bare, PATH, shortest="actuators"), "no actuators")
