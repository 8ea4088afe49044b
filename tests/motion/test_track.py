"""Following a path."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sinuous as sn
from sinuous.motion.knots import TipLine
from tests.helpers import present, with_each
from tests.motion.test_departure import ACROSS, PLATE, ROBOT

CIRCLE = [
    sn.Target((2.0 * np.cos(angle), 2.0 * np.sin(angle), 2.5))
    for angle in np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
]
BALL = sn.Sphere((0.9, 0.0, 1.2), 0.3, name="ball")
FAR = sn.Target((0.0, 0.0, 9.0))


def test_every_waypoint_is_solved_and_verifies() -> None:
    track = sn.track(ROBOT, CIRCLE, [BALL], deviation=0.1)
    assert track.solved
    assert track.status is sn.Status.SOLVED
    assert track.q.shape == (40, 4, 3)
    assert len(track.solutions) == 40
    assert all(verification.ok for verification in track.verify())
    assert track.between == "proved"
    assert track.unproved_steps == ()
    assert 0.0 < present(track.clearance) <= min(solution.clearance or 0.0 for solution in track.solutions)
    assert track.raise_for_status() is track


def test_between_poses_the_tip_stays_on_the_line_and_turns_evenly() -> None:
    q = np.array(ROBOT.straight)
    q[:, :2] = [[0.3, 0.1], [-0.2, 0.2], [0.4, -0.1], [0.1, 0.3]]
    here = ROBOT.tip(q)
    place, aside, turn = here[:3, 3], np.array([0.2, -0.1, 0.1]), Rotation.from_rotvec([0.2, 0.3, -0.4]).as_matrix()
    goals = [(place, here[:3, :3]), (place + aside, turn @ here[:3, :3]), (place + aside, here[:3, :3])]
    targets = [sn.Target(at, rotation=rotation) for at, rotation in goals]
    motion = sn.track(ROBOT, targets, start=q)
    assert motion.solved
    ends = [knot for knot in motion.waypoint_knots if knot is not None]
    for (begin, first), (end, last) in pairwise(zip(targets, ends, strict=True)):
        line = TipLine(begin, end)
        times = np.interp(np.linspace(first, last, 50), np.arange(len(motion.times)), motion.times)
        poses = ROBOT.tip(motion.at(times))
        shares = line.shares_of(poses)
        assert line.turned(poses, shares) < 5e-3
        on_line = np.array([line.at(float(share)).position for share in shares])
        assert np.linalg.norm(poses[:, :3, 3] - on_line, axis=1).max() < 5e-3


def test_where_an_obstacle_is_in_the_way_the_robot_goes_around() -> None:
    track = sn.track(ROBOT, ACROSS, [PLATE], deviation=1.0, reconfigure="allow")
    assert track.solved
    assert track.reconfigured == (3,)
    sampled = track.at(np.linspace(0.0, 3.0, 2000))
    assert sn.Scene([PLATE]).distance(ROBOT.backbone(sampled)).min() > 0.05
    for solution, knot in zip(track.solutions, track.waypoint_knots, strict=True):
        np.testing.assert_array_equal(track.q[present(knot)], solution.q)


def test_a_way_around_that_was_searched_for_once_is_walked_from_then_on(monkeypatch: pytest.MonkeyPatch) -> None:
    memory = sn.Memory(ROBOT)
    first = sn.track(ROBOT, ACROSS, [PLATE], deviation=1.0, reconfigure="allow", memory=memory)
    assert first.reconfigured == (3,)
    assert len(memory.edges) > 0
    monkeypatch.setattr("sinuous.motion.tracker.find_path", lambda query, trees: None)
    again = sn.track(ROBOT, ACROSS, [PLATE], deviation=1.0, reconfigure="allow", memory=memory)
    assert again.solved
    assert again.reconfigured == (3,)
    assert all(each.ok for each in again.verify())
    assert not sn.track(ROBOT, ACROSS, [PLATE], deviation=1.0, reconfigure="allow", memory=sn.Memory(ROBOT)).solved


def test_where_no_way_is_found_the_step_is_not_proved(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sinuous.motion.tracker.find_path", lambda query, trees: None)
    track = sn.track(ROBOT, ACROSS, [PLATE], deviation=1.0, reconfigure="allow")
    assert all(solution.solved for solution in track.solutions)
    assert (track.between, len(track.unproved_steps), track.reconfigured) == ("unproved", 1, (3,))
    assert track.status is sn.Status.UNPROVED
    assert "the way from waypoint 2 to 3 is not proved clear" in str(track)
    assert f"1 of {len(track.q) - 1} steps are not proved clear" in str(track)
    assert track.to_dict()["unproved_steps"] == list(track.unproved_steps)
    (step,) = track.unproved_steps
    middle = track.at(np.linspace(track.times[step - 1], track.times[step], 50))
    assert min(float(sn.Scene([PLATE]).distance(ROBOT.backbone(q)).min()) for q in middle) < 0.05


def test_the_start_is_the_first_knot() -> None:
    first = sn.track(ROBOT, CIRCLE[:2], [BALL], deviation=0.1)
    begin = np.tile([0.0, 0.0, 1.0], (4, 1))
    track = sn.track(ROBOT, CIRCLE[:2], [BALL], start=begin, deviation=0.1)
    np.testing.assert_array_equal(track.q[0], begin)
    assert track.waypoint_knots == (1, 2)
    np.testing.assert_array_equal(track.times, [0.0, 1.0, 2.0])
    again = sn.track(ROBOT, CIRCLE[:2], [BALL], start=first.q[0], deviation=0.1)
    assert again.waypoint_knots == (0, 1)
    np.testing.assert_array_equal(again.q, first.q)


@pytest.mark.parametrize(
    ("start", "words"),
    [
        ([[0.0, 0.0, 1.3], *[[0.0, 0.0, 1.0]] * 3], "length of segment 1 is 0.1 beyond its limit"),
        ([[0.0, 0.0, 1.0], [2.0, 1.0, 1.0], *[[0.0, 0.0, 1.0]] * 2], "bend of segment 2 is 0.236 beyond its limit"),
        ([[0.9, 0.0, 1.0], [-0.9, 0.0, 1.0], *[[0.0, 0.0, 1.0]] * 2], "of clearance from ball"),
    ],
)
def test_a_start_where_the_robot_cannot_be_is_told(start: list[list[float]], words: str) -> None:
    wall = sn.Sphere((0.7, 0.0, 1.8), 0.3, name="ball")
    track = sn.track(ROBOT, CIRCLE[:3], [wall], start=start)
    assert track.status is sn.Status.START_BLOCKED
    assert (len(track.solutions), track.remaining, len(track.q)) == (0, 3, 1)
    assert words in str(track)
    assert track.to_dict()["worst"]["constraint"] in words


def test_each_waypoint_begins_at_the_last() -> None:
    track = sn.track(ROBOT, CIRCLE)
    assert all(solution.start == "given" for solution in track.solutions[1:])
    bend, length = track.largest_step
    steps = np.diff(track.q, axis=0)
    assert bend == pytest.approx(np.linalg.norm(steps[..., :2], axis=-1).max())
    assert length == pytest.approx(np.abs(steps[..., 2]).max())
    assert bend < 0.5
    again = sn.track(ROBOT, CIRCLE[:1], start=track.solutions[0])
    assert again.solutions[0].start == "given"
    assert len(again.q) == 1
    assert again.largest_step == (0.0, 0.0)


def test_the_first_failure_is_the_status_and_the_rest_goes_on() -> None:
    track = sn.track(ROBOT, [CIRCLE[0], FAR, CIRCLE[1]])
    assert [solution.status for solution in track.solutions] == ["solved", "out_of_reach", "solved"]
    assert track.status is sn.Status.OUT_OF_REACH
    assert track.solutions[2].start == "given"
    assert "2 of 3 waypoints reached; waypoint 2: " in str(track)
    with pytest.raises(sn.NotSolvedError) as caught:
        track.raise_for_status()
    assert caught.value.solution is track
    assert str(caught.value).startswith("out_of_reach (2 of 3 waypoints reached; waypoint 2: ")
    assert "\n" not in str(caught.value)


@with_each("targets", [CIRCLE[0], [], "path.csv", [CIRCLE[0], 3], [[]], [sn.Target((0, 0, 3), segment=5)], 3])
def test_what_is_no_path_is_refused(targets: object) -> None:
    with pytest.raises(sn.InputError, match="targets"):
        sn.track(ROBOT, targets)  # type: ignore[arg-type]


def test_waypoints_are_reached_at_their_times() -> None:
    times = np.cumsum(np.linspace(1.0, 2.0, 5))
    path = sn.Path(times, positions=[target.position for target in CIRCLE[:5] if target.position is not None])
    timed, told = sn.track(ROBOT, path), sn.track(ROBOT, CIRCLE[:5], times=times)
    started = sn.track(ROBOT, path, start=timed.q[-1])
    for motion in (timed, told, started):
        reached = [motion.times[knot] for knot in motion.waypoint_knots if knot is not None]
        np.testing.assert_allclose(reached, times.tolist())
    assert started.times[0] == pytest.approx(times[0] - (times[1] - times[0]))
