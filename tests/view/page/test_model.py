"""The state of the page: every change asks another question, and what is refused changes nothing.

Where obstacles move, what is asked is asked at the time that is shown.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np

import sinuous as sn
from sinuous.answer.remedies import Remedy
from sinuous.model.segment import straight
from sinuous.view.page.model import History, PageModel, problem_text, read_problem
from sinuous.view.page.session import QUICK_SECONDS, Solvers
from sinuous.view.page.tabs import value_ranges
from tests.helpers import present, refused, with_each

ROBOT = sn.Robot.uniform(3, length=(0.8, 1.2), max_bend=2, radius=0.05)
BALL = sn.Sphere((0.5, 0, 1.5), radius=0.2, name="ball")
ASIDE = sn.Sphere((-0.9, 0, 1.5), radius=0.2, name="aside")
GATE = sn.Moving(sn.Sphere((0, 0, 0), 0.5, name="gate"), [1, 3], [(1, 0, 2), (1, 3, 2)])


def model(**values: object) -> PageModel:
    parts: dict[str, object] = {"target": sn.Target((1, 0, 2)), "scene": [BALL]}
    return PageModel(sn.Job(**({"robot": ROBOT} | parts | values)))  # type: ignore[arg-type]


def moving(**values: object) -> PageModel:
    return model(**({"scene": [ASIDE, GATE], "rates": sn.Rates(bend=0.8, length=0.3)} | values))


def test_a_target_is_moved_and_turned_as_far_as_it_asks() -> None:
    page = model(target=sn.Target((1, 0, 2), direction=(0, 0, 1)))
    turned = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    page.place_target(0, np.array([0.5, 0.5, 2.0]), turned)
    (target,) = page.targets
    assert target.equals(sn.Target((0.5, 0.5, 2), direction=(1, 0, 0)))
    page.ask(0, "position")
    assert page.targets[0].equals(sn.Target((0.5, 0.5, 2)))
    page.ask(0, "rotation")
    rotation = page.targets[0].rotation
    np.testing.assert_allclose(present(rotation), ROBOT.tip(page.q)[:3, :3], atol=1e-12)
    refused("asked", lambda: page.ask(0, "more"))


def test_answers_to_questions_of_before_are_dropped() -> None:
    page, solvers = model(), Solvers(routes=False)
    old = page.question()
    page.place_target(0, np.array([0.9, 0.1, 2.0]))
    assert not page.accept(old.number, solvers.solve(old))
    assert page.answer is None
    new = page.question()
    solution = solvers.solve(new, QUICK_SECONDS)
    assert page.accept(new.number, solution)
    assert page.answer is solution
    np.testing.assert_array_equal(page.shown, solution.q)
    assert solution.solved
    np.testing.assert_allclose(solution.problem.targets[0].position, (0.9, 0.1, 2.0))


def test_solvers_see_obstacles_that_moved_came_and_went() -> None:
    page, solvers = model(), Solvers(routes=False)

    def answered() -> sn.Solution:
        question = page.question()
        solution = solvers.solve(question)
        page.accept(question.number, solution)
        assert solution.problem.scene is page.scene
        return solution

    assert answered().status == "solved"
    page.grasp(0)
    at_target = present(page.grip).copy()
    at_target[:3, 3] = (1, 0, 2)
    page.carry(at_target)
    assert answered().status == "target_blocked"
    page.delete()
    assert len(page.scene) == 0
    assert answered().status == "solved"
    page.add("box")
    assert page.scene.name(0) == "box[0]"
    assert answered().status == "solved"


def test_a_solver_is_made_once_while_targets_move() -> None:
    """The method `learned` trains its networks when a solver is made."""
    page, solvers = model(), Solvers(routes=False)
    first = solvers.solver(page.question())
    page.place_target(0, np.array([0.9, 0.1, 2.0]))
    assert solvers.solver(page.question()) is first
    page.set_method("dls", "newton", 0, 0.5)
    assert solvers.solver(page.question()) is not first


def test_a_shape_that_is_bent_by_hand_stays_until_something_is_asked() -> None:
    page = model()
    page.bend(1, 0.5, -0.25, 0.9)
    np.testing.assert_array_equal(page.q[1], (0.5, -0.25, 0.9))
    assert page.by_hand
    question = page.question()
    assert not page.accept(question.number, Solvers(routes=False).solve(question))
    page.solve_from_here()
    assert not page.by_hand
    np.testing.assert_array_equal(page.question().initial[1], (0.5, -0.25, 0.9))
    refused("segment", lambda: page.bend(3, 0, 0, 1))


def test_what_was_decided_is_taken_back_step_by_step() -> None:
    page, history = model(), History()

    def step(key: str, change: Callable[[], object]) -> None:
        before = page.moment
        change()
        assert not before.decided_like(page.moment)
        history.note(key, before)

    first = page.job
    step("target", lambda: page.place_target(0, np.array([0.9, 0.1, 2.0])))
    second = page.job
    step("limits", lambda: page.limit(None, max_bend=1.0))
    page.grasp(0)
    step("slider", lambda: page.bend(0, 0.1, 0.0, 1.0))
    step("slider", lambda: page.bend(0, 0.2, 0.0, 1.0))  # one step: the same slider goes on
    bent = page.q
    page.come_back(history.undo(page.moment))
    assert not page.by_hand
    assert page.robot.segments[0].max_bend == 1.0
    page.come_back(history.undo(page.moment))
    assert page.job is second
    page.come_back(history.undo(page.moment))
    assert page.job is first
    now = page.moment
    assert history.undo(now) is now
    for _ in range(3):
        page.come_back(history.redo(page.moment))
    assert page.by_hand
    assert page.q is bent
    now = page.moment
    assert history.redo(now) is now
    page.come_back(history.undo(now))
    step("delete", page.delete)
    page.come_back(history.undo(page.moment))
    page.grasp(0)
    page.come_back(history.undo(page.moment))
    assert page.grasped == 0


def test_remedies_are_applied_to_what_is_on_the_page() -> None:
    ball = sn.Sphere((1, 0, 2), radius=0.2, name="at the target")
    page, solvers = model(scene=[BALL, ball]), Solvers(routes=False)
    found = solvers.solve(page.question())
    assert page.accept(page.number, found)
    remedies = {remedy.change: remedy for remedy in found.explain(time=60.0).remedies}
    page.apply(remedies["obstacle at the target"])
    assert [page.scene.name(i) for i in range(len(page.scene))] == ["ball"]
    assert page.targets[0].equals(found.problem.targets[0])
    assert solvers.solve(page.question()).solved
    page = model(scene=[BALL, ball])
    page.accept(page.number, solvers.solve(page.question()))
    page.apply(remedies["target position"])
    assert len(page.scene) == 2
    assert solvers.solve(page.question()).solved
    page.apply(Remedy("time", 1.0, 4.0))
    assert page.settings.time == 4.0
    refused("remedy", lambda: page.apply(Remedy("max_starts", 1, 10)), "from Python")


def test_segments_are_added_and_taken_away_with_all_that_counts_them() -> None:
    start = [[0.1, 0.0, 1.0], [0.2, 0.0, 1.0], [0.3, 0.0, 1.0]]
    page = model(target=[sn.Target((1, 0, 2)), sn.Target((0.2, 0, 1), segment=2)], start=start)
    page.limit(0, radius=0.08)
    page.add_segment(0)
    assert page.robot.radii == (0.08, 0.08, 0.05, 0.05)
    assert page.targets[1].segment == 3
    assert page.job.start is not None
    assert page.job.start[:, 0].tolist() == [0.1, 0.1, 0.2, 0.3]
    page.add_segment(None)
    assert len(page.robot) == len(page.q) == 5
    assert page.targets[1].segment == 3
    refused("segment", lambda: page.remove_segment(2), "a target asks for its end")
    page.remove_segment(None)
    page.remove_segment(0)
    assert page.targets[1].segment == 2
    assert page.job.start.shape == (3, 3)
    assert page.question().initial.shape == (3, 3)
    page = model()
    page.remove_segment(0)
    page.remove_segment(0)
    refused("segments", lambda: page.remove_segment(0))
    assert len(page.robot) == 1


def test_joints_stay_where_segments_are_changed() -> None:
    joints = [sn.Revolute(limits=(0.5, 1.0)), sn.Prismatic(limits=(-1, 1)), sn.Revolute(origin=(0, 0, 0.1))]
    page = model(robot=ROBOT.changed(joints=joints))
    assert page.robot.excess(page.shown) == 0.0  # the first joint cannot be at 0
    page.limit(0, max_bend=1.0)
    page.limit(None, radius=0.08)
    page.add_segment(None)
    page.remove_segment(0)
    assert [segment.max_bend for segment in page.robot.segments] == [2, 2, 2]
    assert page.robot.body_radii == (0.08, 0.08, 0.08)
    assert page.robot.joints == tuple(joints)
    assert len(page.q) == len(page.robot)


def test_a_second_method_begins_from_its_own_shape() -> None:
    page, solvers = model(), Solvers(routes=False)
    assert page.question_beside() is None
    page.set_method("newton", "newton", 3, 0.5)
    page.accept(page.number, solvers.solve(page.question()))
    second = present(page.question_beside())
    np.testing.assert_array_equal(second.initial, straight(ROBOT.segments))
    solution = solvers.solve(second)
    assert page.accept_beside(second.number, solution)
    page.place_target(0, np.array([0.9, 0.0, 2.0]))
    assert page.beside is None
    again = page.question_beside()
    np.testing.assert_array_equal(present(again).initial, solution.q)
    assert not page.accept_beside(second.number, solution)


def test_motions_begin_in_the_shape_and_at_the_time_on_the_page(tmp_path: Path) -> None:
    page = moving(target=sn.Target((-1.0, 0.3, 2.0)), start=[[0.3, 0.0, 1.0]] * 3)
    page.play(1.5)
    page.begin_here()
    assert page.begin == 1.5
    text = problem_text(page)
    assert text.startswith("# sinuous plan FILE --method newton --seed 0 --time 1 --begin 1.5\n")
    again = read_problem("saved.yaml", text.encode(), tmp_path)
    assert again.equals(page.job)
    motion = again.plan(begin=page.begin)
    assert motion.solved
    page.show_motion(motion)
    assert page.window == (motion.times[0], motion.times[-1])
    assert page.time == 1.5
    page.play(float(motion.times[-1]))
    assert page.there.equals(page.scene.at(float(motion.times[-1])))
    np.testing.assert_array_equal(page.shown, motion.q[-1])


def test_a_waypoint_is_asked_at_its_time() -> None:
    path = [sn.Target((1, 0, 2)), sn.Target((1, 0.1, 2)), sn.Target((1, 0.2, 2))]
    page = moving(target=None, path=path, times=[0.5, 2.0, 4.0])
    assert page.window == (0.0, 4.0)
    page.go_to_waypoint(1)
    assert page.time == 2.0
    page = moving(target=None, path=path, start=[[0.3, 0.0, 1.0]] * 3)
    page.go_to_waypoint(1)
    assert page.time == 2.0


@with_each("lines", [sn.Tendons(3, 0.04, stiffness=50.0, gain=-20.0, offset=3.0), sn.Chambers(4, 0.04, stiffness=9.0)])
def test_sliders_of_elastic_motors_reach_what_holds_any_shape(lines: sn.Tendons | sn.Chambers) -> None:
    """They ended where rigid motors would, short of what a solution says of its motors, by all of the stretch."""
    own = {"tendons": lines} if isinstance(lines, sn.Tendons) else {"chambers": lines}
    robot = sn.Robot([sn.Segment(1.0, max_bend=2.0, radius=0.05, stiffness=1.0, **own)] * 3)
    low, high = value_ranges(robot).T
    rng = np.random.default_rng(3)
    q = np.tile(np.array(robot.straight), (200, 1, 1))
    turns = rng.uniform(0.0, 2.0 * np.pi, (200, 3))
    q[..., :2] = 2.0 * rng.choice([0.3, 1.0], (200, 3, 1)) * np.stack([np.cos(turns), np.sin(turns)], axis=-1)
    values = robot.to_actuators(q)
    assert robot.drive.stretch(q).max() > 0.1 * np.ptp([low, high]) / 20.0
    assert (values > low - 0.01 * (high - low)).all()
    assert (values < high + 0.01 * (high - low)).all()
    page = model(robot=robot)
    for i in (0, 4):
        page.drive(i, 0.2 * low[i] + 0.8 * high[i])
        assert page.actuators[i] == 0.2 * low[i] + 0.8 * high[i], "it shows another value than was set"
