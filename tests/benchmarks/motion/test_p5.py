"""The benchmark of plans: it runs and holds, and says it when a motion collides or comes too late."""

import numpy as np

import sinuous as sn
from benchmarks.harness.plan import Plan
from benchmarks.motion import p5, peers
from benchmarks.motion.experiment import SECTIONS, Motions
from benchmarks.motion.judged import A_STEP, collides, samples
from benchmarks.motion.pairs import draw
from benchmarks.motion.trials import CONFIGURATION, TARGET, Task, Trial, examine
from sinuous.scene.scene import Scene

RIGHT = Trial(0, 1e-4, "solved", "", 1, {})


def test_a_quick_section_holds() -> None:
    """All is planned; whether that is in time is the machine's affair."""
    for goal in (CONFIGURATION, TARGET):
        lines = {line.section: line for line in p5.measure(Plan(quick=True), 3, 1, goal)}
        planned = lines[p5.PLANNED]
        assert planned.solved is not None
        assert planned.solved[1] == 4
        late = planned.note
        assert late.count("(") == late.count("(solved)")
        assert lines[p5.FALSE].reached == 0


def test_others_plan_the_same_pairs() -> None:
    trial = examine(Task(3, 1, 0, 0, peers=1.0))
    assert trial.solved
    assert set(trial.others) == (set(peers.PLANNERS) if peers.installed() else set())
    assert all(solved for _, solved in trial.others.values())


def test_what_others_were_spared_is_said() -> None:
    trials = [RIGHT._replace(others={"RRTConnect": (0.1, True), "BITstar": (1.0, False)}), RIGHT, RIGHT]
    connect, star = (line for line in p5.lines_of("here", trials, 0.1, 99.5) if line.section == p5.OTHERS)
    assert connect.note == "the first 1 of 3 pairs, 1 s for each"
    assert star.note.startswith(connect.note)
    assert (connect.solved, star.solved) == ((1, 1), (0, 1))


def test_wrong_and_late_motions_count_as_such() -> None:
    trials = [RIGHT, RIGHT._replace(wrong="obstacle"), RIGHT._replace(seconds=0.2), RIGHT._replace(status="time_limit")]
    lines = {line.section: line for line in p5.lines_of("here", trials, 0.1, 99.5)}
    assert lines[p5.PLANNED].reached == 25.0
    assert lines[p5.PLANNED].held is False
    assert lines[p5.FALSE].reached == 1
    assert lines[p5.FALSE].held is False


def test_the_judge_sees_obstacles_the_body_and_limits() -> None:
    robot = sn.Robot([sn.Segment(1.0, np.pi, radius=0.05)] * 3)
    q = np.array([[[1.0, 0.0, 1.0]] * 3, [[-1.0, 0.0, 1.0]] * 3])
    assert len(samples(q)) == A_STEP + 1
    assert collides(robot, Scene([]), q) == ""
    assert collides(robot, Scene([sn.Sphere((0.0, 0.0, 2.5), 0.2)]), q) == "obstacle"
    assert collides(robot, Scene([]), np.array([[[0.0, 0.0, 1.0]] * 3, [[2.5, 0.0, 1.0]] * 3])) == "itself"
    assert collides(robot, Scene([]), 4.0 * q * [1.0, 1.0, 0.25]) == "limit"


def test_pairs_are_the_same_again_and_clear() -> None:
    one, again = draw(3, 1, 5, 0), draw(3, 1, 5, 0)
    np.testing.assert_array_equal(one.start, again.start)
    for q in (one.start, one.goal):
        assert sn.check(one.robot, q, one.scene).ok


def test_all_sections_are_pieces() -> None:
    assert [name for name, _ in Motions(Plan()).parts()] == list(SECTIONS)
