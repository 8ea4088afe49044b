"""Paths past obstacles that move: every waypoint at its time, every step proved in time."""

import json
from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from tests.helpers import present
from tests.motion.timed_judge import least_clearance

ROBOT = sn.Robot.uniform(3, (0.8, 1.2), radius=0.05, max_bend=2.5)
START = np.tile([0.6, 0.0, 1.0], (3, 1))
PASSING = sn.Moving(sn.Sphere((0, 0, 0), 0.4), [0, 2, 4], [(-2, 0, 2.2), (0.2, 0.3, 2.2), (2, 0, 2.2)])
BLOCKING = sn.Moving(sn.Sphere((0, 0, 0), 0.5), [0, 2], [(0, 2, 1.8), (0, 0.5, 1.8)])
TIMES = np.linspace(0.5, 4.0, 6)
PATH = [sn.Target((1.5 - 3.0 * share, 0.5, 1.8)) for share in np.linspace(0.0, 1.0, 6)]


@pytest.mark.parametrize("started", [False, True])
def test_a_path_is_followed_in_time(started: bool) -> None:
    start = START if started else None
    motion = sn.track(ROBOT, PATH, [PASSING], times=TIMES, start=start, reconfigure="allow")
    assert motion.solved
    np.testing.assert_allclose(motion.times[np.array(motion.waypoint_knots)], TIMES)
    for solution, when in zip(motion.solutions, TIMES.tolist(), strict=True):
        assert solution.problem.scene.equals(motion.scene.at(when))
        assert solution.verify().ok
    assert 0.0 < present(motion.clearance) <= least_clearance(motion) + 1e-9
    assert sn.Motion(ROBOT, motion.q, [PASSING], motion.times).between == "proved"


def test_where_an_obstacle_blocks_the_path_it_is_said() -> None:
    motion = sn.track(ROBOT, PATH, [BLOCKING], times=TIMES)
    assert not motion.solved
    assert motion.status is sn.Status.TARGET_BLOCKED
    assert present(motion.worst).obstacle == "sphere[0]"
    hit = sn.Moving(sn.Sphere((0, 0, 0), 0.5), [0], [tuple(ROBOT.tip(START)[:3, 3])])
    assert sn.track(ROBOT, PATH, [hit], start=START).status is sn.Status.START_BLOCKED


def test_shorter_motions_are_proved_in_time_too() -> None:
    away = sn.Moving(sn.Sphere((0, 0, 0), 0.4), [0, 4], [(-2, 1.5, 1.2), (2, 1.5, 1.2)])
    first = sn.track(ROBOT, PATH, [away], times=TIMES)
    motion = sn.track(ROBOT, PATH, [away], times=TIMES, shortest="configuration")
    assert motion.solved
    assert least_clearance(motion) > 0.0
    assert np.abs(np.diff(motion.q, axis=0)).sum() <= np.abs(np.diff(first.q, axis=0)).sum() * 1.01


def test_results_are_read_again(tmp_path: Path) -> None:
    job = sn.Job(ROBOT, path=PATH, times=TIMES, scene=[PASSING])
    job.save(tmp_path / "job.yaml")
    again = sn.load(tmp_path / "job.yaml", sn.Job)
    assert again.equals(job)
    motion = again.track()
    (tmp_path / "result.json").write_text(json.dumps(motion.to_dict()))
    read = again.result(tmp_path / "result.json")
    assert isinstance(read, sn.Motion)
    assert read.status is motion.status
    assert read.scene.moves
    assert read.clearance == motion.clearance
    assert all(check.ok for check in read.verify())
    motion.to_npz(tmp_path / "motion.npz")
    assert sn.Motion.from_npz(tmp_path / "motion.npz", ROBOT, [PASSING]).between == "proved"
