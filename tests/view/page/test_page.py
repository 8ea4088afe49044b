"""The page in a real browser: what people drag, type and press, and what they see then."""

import itertools
import re
import threading
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.view.page import model
from sinuous.view.page.nodes import rotation_of, sees
from sinuous.view.page.page import Page
from tests.helpers import Floats, present
from tests.scene.shapes import cube
from tests.view.page.browser import PATIENCE, choose, chromium, frames, inputs, opened, pixels, projected, until

ROBOT = sn.Robot.uniform(3, length=(0.8, 1.2), max_bend=2, radius=0.08)
JOB = sn.Job(ROBOT, sn.Target((1, 0, 2)), [sn.Sphere((0.2, 0.9, 1.2), radius=0.25, name="ball")])
GOAL = sn.Job(
    ROBOT,
    scene=[sn.Sphere((0.5, 0.0, 1.8), radius=0.4, name="ball")],
    start=[[0.9, 0.0, 1.0], [0.3, 0.0, 1.0], [0.0, 0.0, 1.0]],
    goal=[[-0.9, 0.2, 1.0], [-0.3, 0.0, 1.0], [0.0, 0.0, 0.9]],
)
GATE = sn.Moving(sn.Sphere((0, 0, 0), 0.5, name="gate"), [0, 2, 3], [(1, 0, 2), (1, 0, 2), (1, 3, 2)])
MOVING = sn.Job(ROBOT, sn.Target((1, 0, 2)), [GATE], start=[[-0.3, 0.0, 1.0]] * 3, rates=sn.Rates(bend=0.8, length=0.3))
DRIVEN = sn.Job(
    sn.Robot.uniform(3, (0.5, 0.9), max_bend=2, radius=0.08, tendons=sn.Tendons(3, 0.05, gain=100, unit="mm")),
    sn.Target((1, 0.2, 1.2), direction=(1, 0, 0)),
)


@pytest.fixture(autouse=True)
def every_motion_is_played_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Drawn by software: each picture takes tens of milliseconds of processor time."""
    monkeypatch.setattr(model, "LONGEST_SECONDS", 0.3)
    monkeypatch.setattr(model, "PLAYED_SECONDS", 0.3)


@pytest.fixture(scope="module")
def page() -> Iterator[Page]:
    served = Page(JOB)
    until(lambda: served.model.answer is not None, "the first answer")
    yield served
    served.stop()


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as started:
        yield started


@pytest.fixture(scope="module")
def tab(browser: Any, page: Page) -> Any:
    shown = opened(browser, f"http://127.0.0.1:{page.port}")
    until(page.server.get_clients, "a client")
    return shown


@pytest.fixture
def fresh(page: Page, tab: Any) -> Iterator[Any]:
    """The page as it was in the beginning."""
    load(page, tab, JOB)
    until(lambda: page.model.answer is not None, "the answer")
    settled(page)
    tab.get_by_role("tab", name="Target").click()
    yield tab
    assert tab.problems == []


def load(page: Page, tab: Any, job: sn.Job) -> None:
    """Load a problem, and wait until the browser shows the panel that was built for it: it forgets what was chosen."""
    before = page.model.number
    tab.evaluate("() => { for (const each of document.querySelectorAll('[role=tab]')) each.dataset.old = 'yes'; }")
    page.do("load", lambda: page.replace(job))
    until(lambda: page.model.job is job and page.model.number > before, "the problem")
    new = "document.querySelector('[role=tab]') && !document.querySelector('[role=tab][data-old]')"
    until(lambda: tab.evaluate(f"() => Boolean({new})"), "its panel")


def settled(page: Page) -> None:
    """Wait until all events are handled and no solve goes on."""

    def handled() -> bool:
        done = threading.Event()
        page.do("settled", done.set)
        return done.wait(PATIENCE)

    until(lambda: handled() and not page._busy, "a page at rest")
    assert handled()  # the answer of a solve comes right after its end


def asked(page: Page) -> Floats:
    """Where the target is."""
    place = page.model.targets[0].position
    return present(place)


def camera_of(page: Page) -> Any:
    return next(iter(page.server.get_clients().values())).camera


def drag(tab: Any, begin: Floats, end: Floats) -> None:
    """Drag with the mouse, no faster than the browser draws: what it has not drawn yet cannot be taken hold of."""
    tab.mouse.move(*begin)
    frames(tab, 2)
    tab.mouse.down()
    frames(tab, 1)
    for share in np.linspace(0.0, 1.0, 6)[1:]:
        tab.mouse.move(*(begin + share * (end - begin)))
        frames(tab, 1)
    tab.mouse.up()


def still(page: Page, tab: Any) -> None:
    """Wait until the camera moves no more: a drag that misses the gizmo turns it, and it comes to rest smoothly."""

    def pose() -> tuple[float, ...]:
        camera = camera_of(page)
        return (*camera.position, *camera.look_at, *camera.up_direction)

    def rests() -> bool:
        before = pose()
        frames(tab, 3)
        return pose() == before

    until(rests, "a camera at rest")


def pull(page: Page, tab: Any, gizmo: Callable[[], Any], place: Callable[[], Floats]) -> None:
    """Drag a gizmo by its arrows until what it holds is elsewhere: a slow browser may not have drawn it yet."""
    begin, camera, arrows = place(), camera_of(page), itertools.cycle(range(3))
    position, look_at = camera.position, camera.look_at

    def let_go() -> bool:
        """Whether all that the browser told of a drag has arrived."""
        before = place()
        frames(tab, 2)
        settled(page)
        return np.array_equal(place(), before)

    def pulled() -> bool:
        still(page, tab)
        axis = rotation_of(np.array(gizmo().wxyz))[:, next(arrows)]
        ends = [np.array(projected(camera_of(page), begin + part * gizmo().scale * axis)) for part in (0.8, 1.5)]
        if np.linalg.norm(ends[1] - ends[0]) < 10.0:  # seen from its end
            return False
        drag(tab, ends[0], ends[1])
        until(let_go, "a gizmo that is let go")
        if np.linalg.norm(place() - begin) > 0.05:
            return True
        camera_of(page).position, camera_of(page).look_at = position, look_at
        return False

    until(pulled, "a gizmo that was pulled")


def test_the_page_opens_with_the_robot_and_obstacles_where_they_must_be(page: Page, fresh: Any) -> None:
    picture, camera = pixels(fresh), camera_of(page)
    for name, point, low, high in (
        ("body", ROBOT.backbone(page.model.q)[25], (0, 60, 110), (140, 215, 255)),  # blue
        ("ball", np.array([0.2, 0.9, 1.2]), (80, 80, 80), (245, 245, 250)),  # grey
    ):
        x, y = (round(v) for v in projected(camera, point))
        seen = picture[y - 2 : y + 3, x - 2 : x + 3].reshape(-1, 3).mean(axis=0)
        assert (seen >= low).all(), (name, seen)
        assert (seen <= high).all(), (name, seen)
        spread = float(seen.max() - seen.min())
        assert spread > 40.0 if name == "body" else spread < 25.0, (name, seen)
    assert (picture[20:40, 20:40] > 250).all()  # nothing stands in the corner


def test_the_tip_follows_the_gizmo_to_tolerance(page: Page, fresh: Any) -> None:
    pull(page, fresh, lambda: page.scenery.gizmo("targets/0"), lambda: asked(page))
    settled(page)
    until(lambda: page.model.answer is not None and page.model.answer.solved, "a solution")
    target = asked(page)
    assert np.linalg.norm(ROBOT.tip(page.model.q)[:3, 3] - target) <= 1e-4 * ROBOT.mean_length
    assert fresh.locator(".badge").first.inner_text() == "solved"


def test_arrows_and_keys_are_explained(page: Page, fresh: Any) -> None:
    page.dragged = False
    page.turn_view()
    until(lambda: page.scenery.words == "drag the arrows", "the first words")
    fresh.keyboard.press("Shift+?")
    fresh.get_by_text("Ctrl+Shift+Z").wait_for()
    fresh.get_by_role("button", name="Close").click()
    fresh.get_by_text("Ctrl+Shift+Z").wait_for(state="detached")
    page.move_target(0, np.array([1.0, 0.1, 2.0]), np.eye(3))
    until(lambda: page.scenery.words == "", "no words after the first drag")


def test_a_wrong_number_keeps_the_old_one_and_says_what_was_expected(page: Page, fresh: Any) -> None:
    field = inputs(fresh, "target x")
    field.fill("abc")
    fresh.get_by_text("target x: expected a number such as 0.5, got 'abc'").wait_for()
    assert asked(page)[0] == 1.0
    until(lambda: field.input_value() == "1", "the old number")
    assert fresh.locator(".notice").count() == 1
    field.fill("-.5")
    until(lambda: asked(page)[0] == -0.5, "a good number")
    fresh.locator(".notice").wait_for(state="detached")
    fresh.get_by_role("tab", name="Robot").click()
    inputs(fresh, "radius").fill("-1")
    fresh.get_by_text("radius: expected a number of at least 0").wait_for()
    fresh.get_by_role("tab", name="Shape").click()
    inputs(fresh, "").first.fill("5")  # beside a slider
    fresh.get_by_text("s1 bend_x, rad: expected a number of at least -2, at most 2").wait_for()
    assert not page.model.by_hand
    assert page.model.robot is ROBOT


def test_a_target_out_of_reach_stays_in_view_and_one_figure_says_how_far(page: Page, fresh: Any) -> None:
    inputs(fresh, "target y").fill("60")
    fresh.locator(".badge", has_text="out of reach").wait_for()
    until(lambda: sees(camera_of(page), np.array([1.0, 60.0, 2.0])), "the target in view")
    settled(page)
    answer = page.model.answer
    figure = f"{present(answer).position_error:.3g}"
    until(lambda: page.scenery.words == f"{figure} away", "how far")
    until(lambda: figure in fresh.locator(".sinuous table").first.inner_text(), "its row")
    assert re.findall(r"[\d.]+", fresh.locator(".sinuous table").first.inner_text()) == [figure]
    details = fresh.get_by_text("farther from the base than the robot is long")
    assert not details.is_visible()
    fresh.get_by_text("Details").click()
    details.wait_for()


STEP = 1e-3
"""Less than a press of a key moves the slider of a tendon, mm."""


def test_an_actuator_is_pulled_and_taken_back(page: Page, fresh: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(model, "TOGETHER_SECONDS", PATIENCE)  # all presses are one change, however slowly they arrive
    load(page, fresh, DRIVEN)
    fresh.get_by_role("tab", name="Shape").click()
    choose(fresh, "sliders", "actuators")
    fresh.get_by_text("s1.t1, mm").wait_for()
    settled(page)
    before = page.model.actuators
    slider = fresh.get_by_role("slider").first
    slider.focus()
    for _ in range(5):
        fresh.keyboard.press("ArrowRight")

    def pulled() -> bool:
        """Whether all presses have arrived: the tendon is where the slider is."""
        off = page.model.actuators[0] - float(slider.get_attribute("aria-valuenow"))
        return page.model.by_hand and page.model.actuators[0] > before[0] + 0.01 and abs(off) < STEP

    until(pulled, "a tendon that was pulled")
    settled(page)
    np.testing.assert_allclose(page.model.actuators[:3].sum(), 0.0, atol=1e-9)
    np.testing.assert_allclose(page.model.actuators[3:], before[3:], atol=1e-9)
    fresh.locator(".badge", has_text="bent by hand").wait_for()
    slider.focus()
    fresh.keyboard.press("Control+z")
    until(lambda: not page.model.by_hand, "what was before")
    fresh.get_by_role("button", name="Redo").click()
    until(lambda: page.model.by_hand, "the tendon pulled again")
    fresh.get_by_role("button", name="Undo").click()
    until(lambda: not page.model.by_hand, "what was before, again")
    fresh.locator(".badge", has_text="bent by hand").wait_for(state="detached")
    np.testing.assert_allclose(page.model.actuators, before, atol=0.01)


def test_a_direction_is_typed_and_the_shape_saved_as_csv(page: Page, fresh: Any, tmp_path: Path) -> None:
    load(page, fresh, DRIVEN)
    for field, text in ((inputs(fresh, "direction z"), "-1"), (inputs(fresh, "target x"), "1.00005")):
        field.fill(text)
        field.press("Tab")
    wanted = np.array([1.0, 0.0, -1.0]) / np.sqrt(2.0)
    typed = sn.Target((1.00005, 0.2, 1.2), direction=wanted)
    until(lambda: page.model.targets[0].equals(typed), "the direction")
    settled(page)
    fresh.get_by_role("tab", name="File").click()
    with fresh.expect_download() as download:
        fresh.get_by_role("button", name="Save as CSV").click()
    download.value.save_as(tmp_path / "shape.csv")
    header, row = (tmp_path / "shape.csv").read_text().splitlines()
    numbers = dict(zip(header.split(","), map(float, row.split(",")), strict=True))
    assert numbers["s1.bend_x"] == page.model.q[0, 0]
    assert numbers["s2.t3"] == page.model.actuators[5]


def test_what_stands_before_the_robot_is_see_through(page: Page, fresh: Any) -> None:
    load(page, fresh, sn.Job(ROBOT, JOB.waypoints[0], [sn.Mesh(*cube(0.4, (0.2, 0.9, 1.2)))]))
    settled(page)
    camera, at = camera_of(page), ROBOT.backbone(page.model.q)[25]
    camera.position = at + 5.0 * (np.array([0.2, 0.9, 1.2]) - at)
    camera.look_at = at
    until(lambda: page.scenery._hiding == {0}, "a cube before the robot")
    until(lambda: blueness(fresh, camera, at) > 25.0, "the robot behind it")
    camera.position = at - 5.0 * (np.array([0.2, 0.9, 1.2]) - at)
    camera.look_at = at
    until(lambda: not page.scenery._hiding, "a cube behind the robot")


def blueness(tab: Any, camera: Any, point: Floats) -> float:
    """How much more blue than red there is where a camera sees a point."""
    x, y = (round(v) for v in projected(camera, point))
    seen = pixels(tab)[y - 2 : y + 3, x - 2 : x + 3].reshape(-1, 3).mean(axis=0)
    return float(seen[2] - seen[0])


def test_what_would_help_is_a_button(page: Page, fresh: Any) -> None:
    load(page, fresh, sn.Job(ROBOT, sn.Target((0, 0, 4.0))))
    fresh.locator(".badge", has_text="out of reach").wait_for()
    fresh.get_by_role("button", name="What would help?").click()
    fresh.get_by_role("button", name="length of all segments").click()
    fresh.locator(".badge", has_text="solved").wait_for()
    assert page.model.robot.segments[0].length[1] > 1.2
    fresh.get_by_role("tab", name="Robot").click()
    fresh.get_by_role("button", name="Add a segment").click()
    until(lambda: len(page.model.robot) == 4, "one more")
    fresh.keyboard.press("Control+z")
    until(lambda: len(page.model.robot) == 3, "the longer robot")
    fresh.keyboard.press("Control+z")
    until(lambda: page.model.robot is ROBOT, "the first robot")


def test_an_obstacle_is_chosen_dragged_and_deleted(page: Page, fresh: Any) -> None:
    def chosen() -> bool:
        """Click on the ball; a slow browser may not have drawn it yet."""
        fresh.mouse.click(*projected(camera_of(page), np.array([0.2, 0.9, 1.2])))
        frames(fresh, 4)
        return page.model.grasped == 0

    until(chosen, "the ball chosen")
    until(lambda: page.scenery.gizmo("grip") is not None, "its gizmo")

    def center() -> Floats:
        ball = page.model.scene.obstacles[0]
        assert isinstance(ball, sn.Sphere)
        return ball.center

    pull(page, fresh, lambda: page.scenery.gizmo("grip"), center)
    fresh.get_by_role("tab", name="Scene").click()
    fresh.get_by_role("button", name="Delete it").click()
    until(lambda: len(page.model.scene) == 0, "no ball")
    fresh.get_by_role("button", name="Add one").click()
    until(lambda: len(page.model.scene) == 1, "another one")


def played(page: Page) -> bool:
    """Whether there is a motion, which was played to its end: between the two it does not play yet."""
    motion = page.model.motion
    return motion is not None and not page.playing and np.array_equal(page.model.shown, motion.q[-1])


def test_a_motion_to_a_goal_is_planned_and_played(page: Page, fresh: Any) -> None:
    load(page, fresh, GOAL)
    fresh.locator(".badge", has_text="the start").wait_for()
    assert fresh.get_by_role("tab", name="Target").count() == 0
    fresh.get_by_role("tab", name="Motion").click()
    fresh.get_by_role("button", name="Plan a motion").click()
    until(lambda: played(page), "the motion played to its end")
    assert page.model.motion is not None
    assert page.model.motion.solved
    np.testing.assert_array_equal(page.model.motion.q[0], present(GOAL.start))
    np.testing.assert_allclose(page.model.shown, present(GOAL.goal))
    fresh.locator(".badge", has_text="proved clear here").wait_for()
    limits = sn.Rates(0.4, 0.4, acceleration=sn.Rates(0.4, 0.4))
    for name in ("bend rate, rad/s", "length rate, per s", "bend accel., rad/s²", "length accel., per s²"):
        before = page.model.job
        inputs(fresh, name).fill("0.4")  # of two that come within 50 ms, viser sends the latter alone
        until(partial(changed, page, before), name)
    assert page.model.job.rates.equals(limits)
    choose(fresh, "plot", "speed")
    fresh.get_by_text("% of the rates").wait_for()
    untimed = page.model.motion
    fresh.get_by_role("button", name="As fast as rates allow").click()
    until(lambda: page.model.motion is not untimed and not page.playing, "the timed motion played to its end")
    assert page.model.motion is not None
    np.testing.assert_allclose(page.model.motion.duration, untimed.timed(limits).duration)
    fresh.get_by_role("button", name="Undo").click()  # times, then rates, then the plan
    until(lambda: page.model.motion is untimed, "the motion before")
    for _ in range(5):
        page.undo()
    fresh.locator(".badge", has_text="the start").wait_for()


def changed(page: Page, before: sn.Job) -> bool:
    return page.model.job is not before


def test_obstacles_move_with_the_time_that_is_shown(page: Page, fresh: Any) -> None:
    load(page, fresh, MOVING)
    fresh.locator(".badge", has_text="target blocked").wait_for()
    fresh.get_by_role("tab", name="Motion").click()
    fresh.get_by_label("play").click()
    until(lambda: page.model.time == 3.0 and not page.playing, "the obstacles played to their end")
    fresh.locator(".badge", has_text="solved").wait_for()
    answer = page.model.answer
    assert present(answer).problem.scene.equals(page.model.scene.at(3.0))
    fresh.get_by_role("button", name="Plan a motion").click()
    until(lambda: played(page), "the motion played to its end")
    motion = present(page.model.motion)
    assert motion.solved
    assert page.model.there.equals(page.model.scene.at(float(motion.times[-1])))
    fresh.locator(".badge", has_text="proved clear here").wait_for()
