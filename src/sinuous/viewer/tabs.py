"""The tabs of the panel: what can be seen and changed of targets, motions, shapes, obstacles, the robot and solving.

Every tab is a function that puts fields into the panel. A field shows what the model says, and posts an event when a
person changes it.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any, get_args

import numpy as np
from viser import GuiApi

from sinuous.checks import Floats
from sinuous.display.style import Colouring
from sinuous.methods.registry import METHODS
from sinuous.problem.target import Tolerance
from sinuous.robot.segment import Segment
from sinuous.viewer.edits import KINDS, sizes_of
from sinuous.viewer.model import ASKED, MOST_SECONDS
from sinuous.viewer.session import Session

MOST_TARGETS = 6
"""Targets with fields."""

OTHERS = 6
"""Distinct solutions that are looked for."""

AT_ONCE = 8
"""Segments with sliders at one time; of more, a field says which."""

COORDINATES = ("bend_x", "bend_y", "length")

NONE, ALL = "none", "all"
"""Entries of lists: no obstacle or method, all segments."""


class Fields:
    """Fields, each with what the model says it holds, and buttons."""

    def __init__(self) -> None:
        self._bound: list[tuple[Any, Callable[[], Any]]] = []
        self._buttons: list[Any] = []

    def bind(self, handle: Any, get: Callable[[], Any], changed: Callable[[Any], None]) -> None:
        """Show `get()` in a field from now on; call `changed` with what a person puts there.

        `changed` runs on the loop of the server and must return at once.
        """
        self._bound.append((handle, get))

        @handle.on_update  # type: ignore[untyped-decorator]
        async def _(event: Any) -> None:
            if event.client is not None:
                changed(handle.value)

    def choose(
        self,
        handle: Any,
        names: Callable[[], tuple[str, ...]],
        current: Callable[[], int],
        chosen: Callable[[int], None],
    ) -> None:
        """Show a list of `names()`, which may change, with the `current()` one; call `chosen` with another's index."""

        def get() -> str:
            own = names()
            if tuple(handle.options) != own:
                handle.options = own
            return own[current()]

        def changed(name: str) -> None:
            own = names()
            if name in own:
                chosen(own.index(name))

        self.bind(handle, get, changed)

    def press(self, handle: Any, act: Callable[[Any], None]) -> None:
        """Call `act` with the event when a button is pressed."""
        self._buttons.append(handle)

        @handle.on_click  # type: ignore[untyped-decorator]
        async def _(event: Any) -> None:
            act(event)

    def refresh(self) -> None:
        """Show what the model says now; what was refused vanishes from the page so."""
        for handle, get in self._bound:
            value = get()
            if handle.value != value:
                handle.value = value

    def clear(self) -> None:
        """Take all fields and buttons from the panel."""
        for handle in [*(handle for handle, _ in self._bound), *self._buttons]:
            handle.remove()
        self._bound, self._buttons = [], []


def target_tab(gui: GuiApi, session: Session, fields: Fields) -> None:
    """Put the fields into the panel."""
    model = session.model
    if model.job.is_path:
        count = len(model.job.waypoints)
        number = gui.add_slider("waypoint", 1, max(2, count), 1, model.waypoint + 1)
        act = lambda value: session.do("waypoint", lambda: model.go_to_waypoint(min(value, count) - 1))  # noqa: E731
        fields.bind(number, lambda: model.waypoint + 1, act)
    for i in range(min(MOST_TARGETS, len(model.targets))):
        _target_fields(gui, session, fields, i)
    found = gui.add_dropdown(
        "solution", _solution_names(session), hint="Distinct solutions, best first; all are on the page."
    )
    look = gui.add_button("Find other solutions", color="gray")
    fields.press(look, lambda _: session.find_others(OTHERS))
    forget = gui.add_button("Forget them", color="gray")
    fields.press(forget, lambda _: session.forget_others())

    def current() -> int:
        forget.visible = found.visible = bool(model.ghosts)
        return next((i for i, ghost in enumerate(model.ghosts, 1) if ghost is model.answer), 0)

    def choose(index: int) -> None:
        if index:
            session.do("solution", lambda: model.choose(index - 1))

    fields.choose(found, partial(_solution_names, session), current, choose)


def _solution_names(session: Session) -> tuple[str, ...]:
    return ("-", *(f"{i}: bends {_bends(each.q):.2f} rad in all" for i, each in enumerate(session.model.ghosts, 1)))


def _bends(q: Floats) -> float:
    return float(np.hypot(q[:, 0], q[:, 1]).sum())


def _target_fields(gui: GuiApi, session: Session, fields: Fields, i: int) -> None:
    model = session.model
    target = model.targets[i]
    whose = "" if len(model.targets) == 1 else f" {i + 1}"
    if target.segment is not None and target.segment < len(model.robot):
        whose += f" of {model.robot.segment_names[target.segment - 1]}"
    if target.position is not None:
        place = gui.add_vector3(
            f"target{whose}", tuple(target.position.tolist()), step=step_of(model.robot.mean_length)
        )
        fields.bind(
            place,
            lambda: tuple(model.target_frame(i)[:3, 3].tolist()),
            lambda value: session.do(("target", i), lambda: model.place_target(i, value)),
        )
    asked = gui.add_dropdown(
        f"asked{whose}",
        ASKED,
        hint="What must be met: the position alone, or the direction of the tangent, or a whole rotation too.",
    )
    fields.bind(asked, lambda: _what(session, i), lambda value: session.do(("asked", i), lambda: model.ask(i, value)))


def _what(session: Session, i: int) -> str:
    target = session.model.targets[min(i, len(session.model.targets) - 1)]
    return "direction" if target.direction is not None else "rotation" if target.rotation is not None else "position"


def motion_tab(gui: GuiApi, session: Session, fields: Fields) -> None:
    """Put the fields into the panel."""
    model = session.model
    if not model.job.is_path:
        here = gui.add_button("Start here", color="gray", hint="Motions begin in the shape on the page.")
        fields.press(here, lambda _: session.do("start", model.begin_here))
    found = gui.add_button("Follow the path" if model.job.is_path else "Plan a motion")
    fields.press(found, lambda _: session.move())
    share = gui.add_slider("moment, %", 0.0, 100.0, 0.1, 0.0)

    def moment() -> float:
        first, last = model.window
        if first == last:
            return 0.0
        return float(min(100.0, max(0.0, 100.0 * (model.time - first) / (last - first))))

    def play(value: float) -> None:
        session.do("time", lambda: session.go_to(0.01 * value))

    fields.bind(share, moment, play)
    run = gui.add_checkbox("play", False)
    fields.bind(run, lambda: session.playing, session.play)


def shape_tab(gui: GuiApi, session: Session, fields: Fields) -> None:
    """Put the fields into the panel."""
    model = session.model
    colour = gui.add_dropdown("colours say", get_args(Colouring))
    fields.bind(colour, lambda: session.colouring, session.colour)
    again = gui.add_button("Solve from here", color="gray", hint="Ask for the target again, from this shape.")
    fields.press(again, lambda _: session.do("again", model.solve_from_here))
    count = len(model.robot)
    if count > AT_ONCE:
        first = gui.add_slider("from segment", 1, count - AT_ONCE + 1, 1, session.first_segment + 1)
        fields.bind(first, lambda: session.first_segment + 1, lambda value: session.show_segments(value - 1))
    for k in range(session.first_segment, min(count, session.first_segment + AT_ONCE)):
        _segment_fields(gui, session, fields, k)


def _segment_fields(gui: GuiApi, session: Session, fields: Fields, k: int) -> None:
    model = session.model
    segment, name = model.robot.segments[k], model.robot.segment_names[k]

    def changed(coordinate: int, value: float) -> None:
        def bend() -> None:
            row = model.shown[k].tolist()
            row[coordinate] = value
            model.bend(k, *row)

        session.do(("bend", k, coordinate), bend)

    for c, (low, high) in enumerate(_ranges(segment)):
        if low < high:
            now = partial(_within, session, k, c, (low, high))
            slider = gui.add_slider(f"{name} {COORDINATES[c]}", low, high, step_of(high - low), now())
            fields.bind(slider, now, partial(changed, c))


def _within(session: Session, k: int, c: int, ends: tuple[float, float]) -> float:
    """A coordinate of the shape, as the slider shows it: rounded to its steps, and within its ends."""
    digits = round(-math.log10(step_of(ends[1] - ends[0])))
    return float(np.clip(round(float(session.model.shown[k, c]), digits), *ends))


def _ranges(segment: Segment) -> list[tuple[float, float]]:
    """What the sliders of a segment go from and to."""
    bend = (-segment.max_bend, segment.max_bend)
    return [bend, bend, segment.length]


def scene_tab(gui: GuiApi, session: Session, fields: Fields) -> None:
    """Put the fields into the panel."""
    model = session.model
    names = partial(_obstacle_names, session)
    listed = gui.add_dropdown("obstacle", names(), hint="Or click on one. The chosen one can be dragged.")

    def current() -> int:
        return 0 if model.grasped is None else model.grasped + 1

    fields.choose(listed, names, current, lambda index: session.choose_obstacle(index - 1 if index else None))
    delete = gui.add_button("Delete it", color="gray")
    fields.press(delete, lambda _: session.do("delete", model.delete))
    kind = gui.add_dropdown("kind", KINDS)
    add = gui.add_button("Add one", color="gray")
    fields.press(add, lambda _: session.do("add", lambda: model.add(kind.value)))


def _obstacle_names(session: Session) -> tuple[str, ...]:
    scene = session.model.scene
    return (NONE, *(scene.name(i) for i in range(len(scene))))


def size_fields(gui: GuiApi, session: Session, fields: Fields) -> None:
    """Put fields for the lengths of the chosen obstacle into the panel."""
    for label, value in chosen_sizes(session).items():
        field = gui.add_number(label, value, min=0.0, step=step_of(session.model.robot.mean_length))
        fields.bind(field, partial(_size, session, label), partial(_resize, session, label.replace(" ", "_")))


def _size(session: Session, label: str) -> float:
    return chosen_sizes(session).get(label, 0.0)


def _resize(session: Session, key: str, value: float) -> None:
    session.do(("size", key), lambda: session.model.resize(**{key: value}))


def chosen_sizes(session: Session) -> dict[str, float]:
    """Lengths of the chosen obstacle that can be changed."""
    return {} if session.model.chosen is None else sizes_of(session.model.chosen)


def robot_tab(gui: GuiApi, session: Session, fields: Fields) -> None:
    """Put the fields into the panel."""
    model = session.model
    names = (ALL, *model.robot.segment_names)
    which = gui.add_dropdown("segment", names, hint="Of which limits are changed; of all, the first one's are shown.")

    def index() -> int | None:
        return None if which.value == ALL else names.index(which.value) - 1

    def segment() -> Segment:
        return model.robot.segments[index() or 0]

    def put(arguments: Callable[[float], dict[str, Any]], value: float) -> None:
        k = index()
        session.do("limit", lambda: model.limit(k, **arguments(value)))

    def add(label: str, step: float, get: Callable[[], float], arguments: Callable[[float], dict[str, Any]]) -> None:
        hint = "Largest bend divided by length; 0: no limit of its own." if label == "max_curvature" else None
        fields.bind(gui.add_number(label, 0.0, min=0.0, step=step, hint=hint), get, partial(put, arguments))

    def curvature() -> float:
        own = segment().max_curvature
        return own if math.isfinite(own) else 0.0

    fields.bind(which, lambda: which.value, lambda _: session.do("segment", lambda: None))
    step = step_of(model.robot.mean_length)
    add("least length", step, lambda: segment().length[0], lambda value: {"length": (value, segment().length[1])})
    add("greatest length", step, lambda: segment().length[1], lambda value: {"length": (segment().length[0], value)})
    add("max_bend, rad", 0.01, lambda: segment().max_bend, lambda value: {"max_bend": value})
    add("max_curvature", 1e-6, curvature, lambda value: {"max_curvature": value or None})
    add("radius", step, lambda: segment().radius, lambda value: {"radius": value})


def solve_tab(gui: GuiApi, session: Session, fields: Fields) -> None:
    """Put the fields into the panel."""
    model = session.model

    def put(**values: Any) -> None:
        session.do("method", lambda: model.set_method(**vars(replace(model.settings, **values))))

    names = tuple(METHODS)
    fields.bind(gui.add_dropdown("method", names), lambda: model.settings.method, lambda value: put(method=value))
    beside = gui.add_dropdown("beside it", (NONE, *names), hint="A second method, shown beside the first.")
    fields.bind(
        beside, lambda: model.settings.beside or NONE, lambda value: put(beside=None if value == NONE else value)
    )
    seed = gui.add_number("seed", 0, min=0, max=2**31 - 1, step=1)
    fields.bind(seed, lambda: model.settings.seed, lambda value: put(seed=int(value)))
    seconds = gui.add_number("time, s", 1.0, min=0.001, max=MOST_SECONDS, step=0.001)
    fields.bind(seconds, lambda: model.settings.time, lambda value: put(time=value))

    def tolerance() -> Tolerance:
        return model.job.tolerance.for_robot(model.robot)

    step = step_of(0.01 * model.robot.mean_length)
    off = gui.add_number("tolerance", tolerance().position or 0.0, step=step, hint="Of the position.")
    fields.bind(
        off,
        lambda: tolerance().position,
        lambda value: session.do("tolerance", lambda: model.tolerate(value, tolerance().angle)),
    )
    angle = gui.add_number("tolerance, rad", tolerance().angle, step=1e-4, hint="Of directions and rotations.")
    fields.bind(
        angle,
        lambda: tolerance().angle,
        lambda value: session.do("tolerance", lambda: model.tolerate(tolerance().position or 0.0, value)),
    )


def file_tab(gui: GuiApi, session: Session, save: Callable[[Any], object], fields: Fields) -> None:
    """Put the buttons into the panel."""
    button = gui.add_button("Save as YAML", hint="A problem file that says exactly what is on the page.")
    fields.press(button, lambda event: session.do(("save", event.client_id), lambda: save(event.client)))
    upload = gui.add_upload_button("Load a problem", color="gray", mime_type=".yaml,.yml,.json")

    @upload.on_upload
    async def _(event: Any) -> None:
        file = upload.value
        session.load(file.name, file.content)


def step_of(size: float) -> float:
    """A step to type and drag lengths of this size in: a thousandth, rounded to a power of ten."""
    return float(10.0 ** math.floor(math.log10(max(size, 1e-300) / 300.0)))
