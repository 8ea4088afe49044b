"""The tabs of the panel: what can be seen and changed of targets, motions, shapes, obstacles, the robot and solving.

Every tab is a function that puts fields into the panel.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, get_args

import numpy as np
from viser.transforms import SO3

from sinuous.base.checks import Floats
from sinuous.kernels.packing import BendLine
from sinuous.methods.method import METHODS
from sinuous.model.joints import RigidRow
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment
from sinuous.problem.target import Tolerance
from sinuous.view.display.results import (
    Curves,
    actuators_of,
    bends_of,
    describe_solutions,
    joints_of,
    lengths_of,
    speeds_of,
)
from sinuous.view.display.style import Colouring, largest_bends
from sinuous.view.page.edits import KINDS, least_rates, sizes_of
from sinuous.view.page.model import ASKED, MOST_SECONDS, motion_table, problem_text
from sinuous.view.page.panel import Fields, NumberBox, Part
from sinuous.view.page.session import Session, Sliders

MOST_TARGETS = 6
"""Targets with fields."""

OTHER_SOLUTIONS = 6
"""Distinct solutions that are looked for."""

SEGMENTS_AT_ONCE = 8
"""Segments with sliders at one time; of more, a field says which."""

LENGTH_HINT = "In the unit of the robot's lengths."
"""What is said of numbers that are lengths."""

NONE, ALL = "none", "all"
"""Entries of lists: no obstacle or method, all segments."""


def target_tab(session: Session, fields: Fields) -> None:
    """What is asked, and other solutions."""
    model = session.model
    if model.job.is_path:
        count = len(model.job.waypoints)
        ends = 1, max(2, count)
        put = lambda value: model.go_to_waypoint(min(value, count) - 1)  # noqa: E731
        fields.slider("waypoint", ends, lambda: model.waypoint + 1, put, 1)
    for i in range(min(MOST_TARGETS, len(model.targets))):
        _target_fields(session, fields, i)

    def current() -> int:
        return next((i for i, ghost in enumerate(model.ghosts, 1) if ghost is model.answer), 0)

    def choose(index: int) -> None:
        if index:
            model.choose(index - 1)

    hint = "Distinct solutions, best first; all are on the page."
    found = fields.index("solution", lambda: ("-", *describe_solutions(model.ghosts)), current, choose, hint)
    fields.button("Find other solutions", partial(session.find_others, OTHER_SOLUTIONS))
    forget = fields.button("Forget them", model.forget_ghosts)
    fields.only_while(lambda: bool(model.ghosts), found, forget)


def remedy_fields(session: Session, fields: Fields) -> None:
    """What would help where nothing was solved: each change is a button."""
    model, found = session.model, session.model.explanation
    if not session.unsolved:
        return
    if session.explaining:
        fields.text("Looking for what would help ...")
    elif found is None:
        fields.button("What would help?", session.explain, "Tries changes for about two seconds.", color=None)
    else:
        asked = [
            remedy for remedy in found.remedies if remedy.problem is not None or remedy.change in ("method", "time")
        ]
        said = "Each of these changes was tried, and helps:" if asked else "Nothing that was tried would help."
        fields.text(" ".join([said, found.untried]))
        for remedy in asked:
            fields.button(str(remedy), partial(model.apply, remedy), "Make this change.")


def _target_fields(session: Session, fields: Fields, i: int) -> None:
    model = session.model
    target = model.targets[i]
    whose = "" if len(model.targets) == 1 else f" {i + 1}"
    if target.segment is not None and target.segment < len(model.robot.segments):
        whose += f" of {model.robot.segment_names[target.segment - 1]}"

    def frame() -> Floats:
        return model.target_frame(min(i, len(model.targets) - 1))

    if target.position is not None:
        fields.vector(_xyz(f"target{whose}"), lambda: frame()[:3, 3], partial(model.place_target, i), LENGTH_HINT)
    hint = "What must be met: the position alone, or the direction of the tangent, or a whole rotation too."
    fields.choice(f"asked{whose}", ASKED, partial(_what, session, i), partial(model.ask, i), hint)
    if target.direction is not None:
        hint = "Of the tangent, in the axes of the world; of any length but 0."
        fields.vector(_xyz(f"direction{whose}"), lambda: frame()[:3, 2], partial(model.point_target, i), hint)
    if target.rotation is not None:
        hint = "About x, then y, then z of the world, as in URDF."
        names = [f"{name}{whose}, rad" for name in ("roll", "pitch", "yaw")]
        turned = lambda value: model.place_target(i, None, np.array(SO3.from_rpy_radians(*value).as_matrix()))  # noqa: E731
        fields.vector(names, lambda: _angles(frame()), turned, hint)


def _xyz(label: str) -> list[str]:
    return [f"{label} {axis}" for axis in "xyz"]


def _angles(frame: Floats) -> Floats:
    """Roll, pitch and yaw (3,) of a pose (4, 4)."""
    return np.array(SO3.from_matrix(frame[:3, :3]).as_rpy_radians(), np.float64)


def _what(session: Session, i: int) -> str:
    target = session.model.targets[min(i, len(session.model.targets) - 1)]
    return "direction" if target.direction is not None else "rotation" if target.rotation is not None else "position"


def motion_tab(session: Session, fields: Fields) -> None:
    """Follow the path or plan to the goal, and look at every moment of it, and of what moves."""
    model = session.model
    if not model.job.is_path:
        fields.button("Start here", model.begin_here, "Motions begin in the shape on the page.")
    fields.button("Follow the path" if model.job.is_path else "Plan a motion", session.move, color=None)

    def moment() -> float:
        first, last = model.window
        return 0.0 if first == last else float(np.clip(100.0 * (model.time - first) / (last - first), 0.0, 100.0))

    fields.slider("moment, %", (0.0, 100.0), moment, lambda value: session.go_to(0.01 * value), 0.1)
    play = fields.gui.add_checkbox("play", False)
    fields.field(play, lambda: session.playing, session.play, at_once=True)
    _rate_fields(session, fields)


def _rate_fields(session: Session, fields: Fields) -> None:
    """Put in how fast the robot may move."""
    model = session.model

    def put(index: int, value: Floats) -> None:
        own = [least_rates(model.job.rates), least_rates(model.job.rates.acceleration)]
        own[index][: len(value)] = value
        model.set_rates(*own)

    units = {actuator.unit for actuator in model.robot.actuators}
    kinds = {"bend": "rad/", "length": "per "}
    if units:
        kinds["actuator"] = f"{unit}/" if len(units) == 1 and (unit := next(iter(units))) else "per "
    hint = "Largest speed, of several the least; 0: no limit."
    rates = lambda: least_rates(model.job.rates)[: len(kinds)]  # noqa: E731
    fields.vector([f"{kind} rate, {unit}s" for kind, unit in kinds.items()], rates, partial(put, 0), hint)
    hint = "How fast this speed may change; 0: no limit."
    gains = lambda: least_rates(model.job.rates.acceleration)[: len(kinds)]  # noqa: E731
    names = [f"{kind} accel., {unit}s²" for kind, unit in kinds.items()]
    fields.vector(names, gains, partial(put, 1), hint)
    blend = partial(setattr, session, "blend")
    hint = "How far any place of the body may leave the way to round a corner; 0: the robot stops in each."
    rounding = fields.number("blend, length", lambda: session.blend, blend, low=0.0, hint=hint)
    timed = fields.button("As fast as rates allow", lambda: session.retime(session.blend))

    def has_corners() -> bool:
        motion, rates = model.motion, model.job.rates
        return motion is not None and rates.acceleration is not None and not motion.scene.moves

    fields.only_while(has_corners, rounding, timed)


def plot_fields(session: Session, fields: Fields) -> None:
    """What changes along the motion, over its time."""
    motion, rates = session.model.motion, session.model.job.rates
    if motion is None:
        return
    curves: dict[str, Callable[[], Curves]] = {
        "bends": partial(bends_of, motion),
        "lengths": partial(lengths_of, motion),
    }
    if motion.robot.joint_names:
        curves["joints"] = partial(joints_of, motion)
    if motion.robot.actuators:
        curves["actuators"] = partial(actuators_of, motion)
    if rates:
        curves["speed"] = partial(speeds_of, motion, rates)
    if session.plotted not in curves:
        session.plotted = "bends"
    fields.choice("plot", tuple(curves), lambda: session.plotted, partial(setattr, session, "plotted"))
    fields.plot(curves[session.plotted]())


def shape_tab(session: Session, fields: Fields) -> None:
    """What the colours of the body mean, and sliders for every segment."""
    model = session.model
    colours = partial(setattr, session, "colouring")
    fields.choice("colours say", get_args(Colouring), lambda: session.colouring, colours)
    fields.field(fields.gui.add_checkbox("axes", True), lambda: session.axes, partial(setattr, session, "axes"))
    fields.button("Solve from here", model.solve_from_here, "Ask for the target again, from this shape.")
    if model.robot.actuators:
        fields.choice("sliders", get_args(Sliders), lambda: session.sliders, partial(setattr, session, "sliders"))
    count, before = len(model.robot.segments), len(model.robot) - len(model.robot.segments)
    last = count - SEGMENTS_AT_ONCE
    if last > 0:
        show = lambda value: setattr(session, "first_segment", value - 1)  # noqa: E731
        fields.slider("from segment", (1, last + 1), lambda: session.first_segment + 1, show, 1)
    arcs = range(session.first_segment, min(count, session.first_segment + SEGMENTS_AT_ONCE))
    seen = [*range(before), *(before + k for k in arcs)]
    sliders = _of_segments if session.sliders == "bends and lengths" else _of_actuators
    for label, ends, get, put in sliders(session, seen):
        if ends[0] < ends[1]:
            fields.slider(label, ends, get, put)


Slider = tuple[str, tuple[float, float], Callable[[], Any], Callable[[float], object]]
"""A label, both ends, and how a value is told and changed."""


def _of_segments(session: Session, seen: Sequence[int]) -> Iterator[Slider]:
    """Yield sliders for joints, and for bends and lengths of segments, by their rows (0 = first)."""
    for k in seen:
        name, segment = session.model.robot.row_names[k], session.model.robot.rows[k]
        if isinstance(segment, RigidRow):
            yield from _of_joint(session, k, segment)
            continue
        line = session.model.robot.drive.coordinates.bends[k]
        if isinstance(line, BendLine):
            if line.low < line.high:
                put = partial(_bend_along, session, k, line)
                yield f"{name} bend, rad", (line.low, line.high), partial(_bend_in_plane, session, k, line), put
            bends: list[tuple[int, str, tuple[float, float]]] = []
        else:
            bends = [(c, what, (-line, line)) for c, what in enumerate(("bend_x, rad", "bend_y, rad"))]
        for c, what, ends in [*bends, (2, "length", segment.length)]:
            get = partial(lambda k, c: session.model.shown[k, c], k, c)
            yield f"{name} {what}", ends, get, partial(_bend, session, k, c)


def _of_joint(session: Session, k: int, row: RigidRow) -> Iterator[Slider]:
    """Yield the slider of a joint; links have none."""
    robot, i = session.model.robot, row.joint
    if i >= 0:
        column, shift = int(robot._rigid.columns[i]), float(robot._rigid.shifts[i])
        get = partial(lambda i: robot.split(session.model.shown)[0][i], i)
        yield (
            f"joint {robot.joint_names[i]}{'' if column else ', rad'}",
            robot._rigid.moving[i].limits,
            get,
            lambda value: _bend(session, k, column, value + shift),
        )


def _bend_in_plane(session: Session, k: int, line: BendLine) -> float:
    return float(session.model.shown[k, :2] @ np.array(line.plane))


def _bend_along(session: Session, k: int, line: BendLine, value: float) -> None:
    for c, bend in enumerate(line.at(value)):
        _bend(session, k, c, bend)


def _of_actuators(session: Session, seen: Sequence[int]) -> Iterator[Slider]:
    """Yield sliders for the actuators that end at these rows (0 = first)."""
    model = session.model
    ends = value_ranges(model.robot).tolist()
    for i, actuator in enumerate(model.robot.actuators):
        if model.robot.end_row(actuator.segment) - 1 in seen:
            unit = f", {actuator.unit}" if actuator.unit else ""
            get, put = partial(lambda i: model.actuators[i], i), partial(model.drive, i)
            yield actuator.name + unit, (ends[i][0], ends[i][1]), get, put


TURNS = np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False)
"""Directions in which segments are bent to see how far lines stretch, rad."""


def value_ranges(robot: Robot) -> Floats:
    """Least and largest values (m, 2) of all actuators: their limits, and what limits of the segments leave of them."""
    drive, ends = robot.drive, np.array([row.length for row in robot.rows])
    slopes = drive.value_jacobian.reshape(len(drive), len(robot), 3)
    bends = np.hypot(slopes[..., 0], slopes[..., 1]) @ largest_bends(robot)
    lengths = np.sort(slopes[..., 2, None] * ends, axis=-1).sum(axis=1) + drive.motors.offset[:, None]
    limits = np.array([actuator.limits for actuator in robot.actuators]).reshape(-1, 2)
    stretches = np.sort(drive.motors.speeds(_stretches(robot)).T, axis=-1)
    return np.clip(lengths + np.stack([-bends, bends], axis=-1) + stretches, limits[:, :1], limits[:, 1:])


def _stretches(robot: Robot) -> Floats:
    """About the least and the largest displacement (2, m) by which lines stretch to hold shapes within limits.

    Forces add up from segment to segment: so do stretches of shapes of which one segment is bent.
    """
    count = len(robot)
    q = np.tile(np.array(robot.straight), (count, len(TURNS), 1, 1))
    for k, bend in enumerate(largest_bends(robot)):
        q[k, :, k, :2] = bend * np.stack([np.cos(TURNS), np.sin(TURNS)], axis=-1)
    straight = robot.drive.stretch(robot.straight)
    more = robot.drive.stretch(q) - straight
    ends = np.stack([more.min(axis=1), more.max(axis=1)])
    return straight + np.stack([np.minimum(ends[0], 0.0), np.maximum(ends[1], 0.0)]).sum(axis=1)


def _bend(session: Session, k: int, c: int, value: float) -> None:
    row = session.model.shown[k].tolist()
    row[c] = value
    session.model.bend(k, *row)


def scene_tab(session: Session, fields: Fields) -> None:
    """Choose, add and delete obstacles; the chosen one has a gizmo."""
    model = session.model

    def names() -> tuple[str, ...]:
        return (NONE, *(model.scene.name(i) for i in range(len(model.scene))))

    def current() -> int:
        return 0 if model.grasped is None else model.grasped + 1

    hint = "Or click on one. The chosen one can be dragged."
    fields.index("obstacle", names, current, lambda i: model.grasp(i - 1 if i else None), hint)
    fields.button("Delete it", model.delete)
    kind = fields.gui.add_dropdown("kind", KINDS)
    fields.button("Add one", lambda: model.add(kind.value))


def size_fields(session: Session, fields: Fields) -> None:
    """Lengths of the chosen obstacle."""
    for label in chosen_sizes(session):
        get = partial(lambda label: chosen_sizes(session).get(label, 0.0), label)
        put = partial(lambda key, value: session.model.resize(**{key: value}), label.replace(" ", "_"))
        fields.number(label, get, put, low=0.0, hint=LENGTH_HINT)


def chosen_sizes(session: Session) -> dict[str, float]:
    """Lengths of the chosen obstacle that can be changed."""
    return {} if session.model.chosen is None else sizes_of(session.model.chosen)


def robot_tab(session: Session, fields: Fields) -> None:
    """Limits and radius of one segment or of all."""
    model = session.model
    if not model.robot.segments:
        return
    names = (ALL, *model.robot.segment_names)
    hint = "Of which limits are changed; of all, the first one's are shown."
    which = fields.gui.add_dropdown("segment", names, hint=hint)
    fields.field(which, lambda: which.value, lambda _: None)

    def index() -> int | None:
        return None if which.value == ALL else names.index(which.value) - 1

    def segment() -> Segment:
        return model.robot.segments[index() or 0]

    def box(label: str, get: Callable[[], float], limits: Callable[[float], dict[str, Any]]) -> NumberBox:
        return NumberBox(label, get, lambda value: model.limit(index(), **limits(value)), low=0.0)

    def curvature() -> float:
        return segment().max_curvature if math.isfinite(segment().max_curvature) else 0.0

    hint = "Like the chosen one, right after it; of all, like the last one."
    fields.button("Add a segment", lambda: model.add_segment(index()), hint)
    hint = "The chosen one; of all, the last one."
    fields.button("Remove a segment", lambda: model.remove_segment(index()), hint)
    fields.numbers(
        box("least length", lambda: segment().length[0], lambda value: {"length": (value, segment().length[1])}),
        box("greatest length", lambda: segment().length[1], lambda value: {"length": (segment().length[0], value)}),
        box("radius", lambda: segment().radius, lambda value: {"radius": value}),
        hint=LENGTH_HINT,
    )
    fields.numbers(
        box("max_bend, rad", lambda: segment().max_bend, lambda value: {"max_bend": value}),
        box("max_curvature, rad per length", curvature, lambda value: {"max_curvature": value or None}),
        hint="Of curvature 0: no limit of its own.",
    )


def solve_tab(session: Session, fields: Fields) -> None:
    """Methods, seed, budget and tolerances."""
    model, names = session.model, tuple(METHODS)

    def put(key: str, value: Any) -> None:
        model.set_method(**vars(replace(model.settings, **{key: value})))

    def tolerance() -> Tolerance:
        return model.job.tolerance.for_robot(model.robot)

    def position() -> float:
        return tolerance().position or 0.0

    def beside(value: str) -> None:
        put("beside", None if value == NONE else value)

    hint = "A second method, shown beside the first."
    fields.choice("method", names, lambda: model.settings.method, partial(put, "method"))
    fields.choice("second method", (NONE, *names), lambda: model.settings.beside or NONE, beside, hint)
    fields.numbers(
        NumberBox("time, s", lambda: model.settings.time, partial(put, "time"), 0.001, MOST_SECONDS),
        NumberBox("seed", lambda: model.settings.seed, partial(put, "seed"), 0, 2**31 - 1, whole=True),
    )
    fields.numbers(
        NumberBox("position tolerance, length", position, lambda value: model.tolerate(value, tolerance().angle)),
        NumberBox("angle tolerance, rad", lambda: tolerance().angle, lambda value: model.tolerate(position(), value)),
    )


def file_tab(session: Session, fields: Fields) -> None:
    """Save what is on the page, load another problem."""
    hint = "A problem file that says exactly what is on the page."
    fields.file("Save as YAML", "problem.yaml", partial(problem_text, session.model), hint)
    hint = "Times, bends, lengths and values of all actuators: of the motion, or of the shape on the page."
    fields.file("Save as CSV", "motion.csv", partial(motion_table, session.model), hint)
    upload = fields.gui.add_upload_button("Load a problem", color="gray", mime_type=".yaml,.yml,.json")

    @upload.on_upload
    async def _(_: Any) -> None:
        session.load(upload.value.name, upload.value.content)


def _asked(session: Session) -> object:
    asked = ((t.position is None, t.direction is None, t.rotation is None, t.segment) for t in session.model.targets)
    return session.model.job.is_path, *asked


def _limits(session: Session) -> object:
    robot = session.model.robot
    limits = tuple((segment.max_bend, segment.length) for segment in robot.segments)
    return limits, robot.actuators, session.first_segment, session.sliders


def _plot(session: Session) -> object:
    return session.model.motion, session.plotted, session.model.job.rates or None


PARTS: list[Part] = [
    ("Target", target_tab, _asked),
    ("Target", remedy_fields, lambda own: (own.unsolved, own.explaining, own.model.explanation)),
    ("Motion", motion_tab, lambda own: own.model.job.is_path),
    ("Motion", plot_fields, _plot),
    ("Shape", shape_tab, _limits),
    ("Scene", scene_tab, lambda own: None),
    ("Scene", size_fields, lambda own: (own.model.grasped, *chosen_sizes(own))),
    ("Robot", robot_tab, lambda own: own.model.robot.segment_names),
    ("Solve", solve_tab, lambda own: None),
    ("File", file_tab, lambda own: None),
]
"""What stands below each other in the tabs, and what it is made for."""
