"""The tabs of the panel: what can be seen and changed of targets, motions, shapes, obstacles, the robot and solving.

Every tab is a function that puts fields into the panel.
"""

import math
from collections.abc import Callable, Sequence
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

NONE, ALL = "none", "all"
"""Entries of lists: no obstacle or method, all segments."""


class Fields:
    """The fields and buttons of a part of the panel.

    A field shows what the model says. What a person puts there, and a button that is pressed, are events of the
    session, keyed by their labels.
    """

    def __init__(self, gui: GuiApi, session: Session) -> None:
        self.gui, self._session = gui, session
        self._bound: list[tuple[Any, Callable[[], Any]]] = []
        self._handles: list[Any] = []

    def bind(self, handle: Any, get: Callable[[], Any], changed: Callable[[Any], object]) -> None:
        """Show `get()` in a field from now on; call `changed` with what a person puts there.

        `changed` runs on the loop of the server and must return at once.
        """
        self._bound.append((handle, get))
        self._handles.append(handle)

        @handle.on_update  # type: ignore[untyped-decorator]
        async def _(event: Any) -> None:
            if event.client is not None:
                changed(handle.value)

    def field(self, handle: Any, get: Callable[[], Any], put: Callable[[Any], object]) -> None:
        """Show `get()` in a field; `put` changes the model by what a person puts there."""
        self.bind(handle, get, lambda value: self._session.do(handle.label, partial(put, value)))

    def number(self, label: str, get: Callable[[], float], put: Callable[[Any], object], **look: Any) -> None:
        """Add a field for a number."""
        self.field(self.gui.add_number(label, get(), **look), get, put)

    def slider(self, label: str, ends: Sequence[float], step: float, get: Callable[[], Any], put: Any) -> None:
        """Add a slider from one end to the other."""
        self.field(self.gui.add_slider(label, ends[0], ends[1], step, get()), get, put)

    def choice(
        self, label: str, options: Sequence[str], get: Callable[[], str], put: Any, hint: str | None = None
    ) -> None:
        """Add a list of which one entry is chosen."""
        self.field(self.gui.add_dropdown(label, options, hint=hint), get, put)

    def index(
        self, label: str, names: Callable[[], tuple[str, ...]], get: Callable[[], int], put: Any, hint: str
    ) -> Any:
        """Add a list of `names()`, which may change; `get` and `put` count its entries. Return its handle."""
        handle = self.gui.add_dropdown(label, names(), hint=hint)

        def chosen() -> str:
            if tuple(handle.options) != names():
                handle.options = names()
            return names()[get()]

        def choose(name: str) -> None:
            if name in names():
                put(names().index(name))

        self.field(handle, chosen, choose)
        return handle

    def button(self, label: str, act: Callable[[], object], hint: str | None = None, color: Any = "gray") -> Any:
        """Add a button; `act` is what happens in the session when it is pressed. Return its handle."""
        handle = self.gui.add_button(label, hint=hint, color=color)
        self._handles.append(handle)

        @handle.on_click
        async def _(_: Any) -> None:
            self._session.do(label, act)

        return handle

    def refresh(self) -> None:
        """Show what the model says now; what was refused vanishes from the page so."""
        for handle, get in self._bound:
            value = get()
            if handle.value != value:
                handle.value = value

    def clear(self) -> None:
        """Take all fields and buttons from the panel."""
        for handle in self._handles:
            handle.remove()
        self._bound, self._handles = [], []


def target_tab(session: Session, fields: Fields) -> None:
    """What is asked, and other solutions."""
    model = session.model
    if model.job.is_path:
        count = len(model.job.waypoints)
        ends = 1, max(2, count)
        put = lambda value: model.go_to_waypoint(min(value, count) - 1)  # noqa: E731
        fields.slider("waypoint", ends, 1, lambda: model.waypoint + 1, put)
    for i in range(min(MOST_TARGETS, len(model.targets))):
        _target_fields(session, fields, i)

    def current() -> int:
        forget.visible = found.visible = bool(model.ghosts)
        return next((i for i, ghost in enumerate(model.ghosts, 1) if ghost is model.answer), 0)

    def choose(index: int) -> None:
        if index:
            model.choose(index - 1)

    hint = "Distinct solutions, best first; all are on the page."
    found = fields.index("solution", partial(_solution_names, session), current, choose, hint)
    fields.button("Find other solutions", partial(session.find_others, OTHERS))
    forget = fields.button("Forget them", model.forget_ghosts)


def _solution_names(session: Session) -> tuple[str, ...]:
    return ("-", *(f"{i}: bends {_bends(each.q):.2f} rad in all" for i, each in enumerate(session.model.ghosts, 1)))


def _bends(q: Floats) -> float:
    return float(np.hypot(q[:, 0], q[:, 1]).sum())


def _target_fields(session: Session, fields: Fields, i: int) -> None:
    model = session.model
    target = model.targets[i]
    whose = "" if len(model.targets) == 1 else f" {i + 1}"
    if target.segment is not None and target.segment < len(model.robot):
        whose += f" of {model.robot.segment_names[target.segment - 1]}"

    def position() -> tuple[float, ...]:
        return tuple(model.target_frame(i)[:3, 3].tolist())

    if target.position is not None:
        x, y, z = position()
        place = fields.gui.add_vector3(f"target{whose}", (x, y, z), step=step_of(model.robot.mean_length))
        fields.field(place, position, partial(model.place_target, i))
    hint = "What must be met: the position alone, or the direction of the tangent, or a whole rotation too."
    fields.choice(f"asked{whose}", ASKED, partial(_what, session, i), partial(model.ask, i), hint)


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

    fields.slider("moment, %", (0.0, 100.0), 0.1, moment, lambda value: session.go_to(0.01 * value))
    fields.bind(fields.gui.add_checkbox("play", False), lambda: session.playing, session.play)


def shape_tab(session: Session, fields: Fields) -> None:
    """What the colours of the body mean, and sliders for every segment."""
    model = session.model
    colours = partial(setattr, session, "colouring")
    fields.choice("colours say", get_args(Colouring), lambda: session.colouring, colours)
    fields.button("Solve from here", model.solve_from_here, "Ask for the target again, from this shape.")
    last = len(model.robot) - AT_ONCE
    if last > 0:
        show = lambda value: setattr(session, "first_segment", value - 1)  # noqa: E731
        fields.slider("from segment", (1, last + 1), 1, lambda: session.first_segment + 1, show)
    for k in range(session.first_segment, min(len(model.robot), session.first_segment + AT_ONCE)):
        name, segment = model.robot.segment_names[k], model.robot.segments[k]
        bend = (-segment.max_bend, segment.max_bend)
        for c, (what, ends) in enumerate((("bend_x", bend), ("bend_y", bend), ("length", segment.length))):
            if ends[0] < ends[1]:
                get, put = partial(_coordinate, session, k, c, ends), partial(_bend, session, k, c)
                fields.slider(f"{name} {what}", ends, step_of(ends[1] - ends[0]), get, put)


def _bend(session: Session, k: int, c: int, value: float) -> None:
    row = session.model.shown[k].tolist()
    row[c] = value
    session.model.bend(k, *row)


def _coordinate(session: Session, k: int, c: int, ends: tuple[float, float]) -> float:
    """A coordinate of the shape, as the slider shows it: rounded to its steps, and within its ends."""
    digits = round(-math.log10(step_of(ends[1] - ends[0])))
    return float(np.clip(round(float(session.model.shown[k, c]), digits), *ends))


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
    step = step_of(session.model.robot.mean_length)
    for label in chosen_sizes(session):
        get = partial(lambda label: chosen_sizes(session).get(label, 0.0), label)
        put = partial(lambda key, value: session.model.resize(**{key: value}), label.replace(" ", "_"))
        fields.number(label, get, put, min=0.0, step=step)


def chosen_sizes(session: Session) -> dict[str, float]:
    """Lengths of the chosen obstacle that can be changed."""
    return {} if session.model.chosen is None else sizes_of(session.model.chosen)


def robot_tab(session: Session, fields: Fields) -> None:
    """Limits and radius of one segment or of all."""
    model = session.model
    names = (ALL, *model.robot.segment_names)
    hint = "Of which limits are changed; of all, the first one's are shown."
    which = fields.gui.add_dropdown("segment", names, hint=hint)
    fields.field(which, lambda: which.value, lambda _: None)

    def index() -> int | None:
        return None if which.value == ALL else names.index(which.value) - 1

    def segment() -> Segment:
        return model.robot.segments[index() or 0]

    def add(label: str, step: float, get: Callable[[], float], limits: Callable[[float], dict[str, Any]]) -> None:
        hint = "Largest bend divided by length; 0: no limit of its own." if label == "max_curvature" else None
        fields.number(label, get, lambda value: model.limit(index(), **limits(value)), min=0.0, step=step, hint=hint)

    def curvature() -> float:
        return segment().max_curvature if math.isfinite(segment().max_curvature) else 0.0

    step = step_of(model.robot.mean_length)
    add("least length", step, lambda: segment().length[0], lambda value: {"length": (value, segment().length[1])})
    add("greatest length", step, lambda: segment().length[1], lambda value: {"length": (segment().length[0], value)})
    add("max_bend, rad", 0.01, lambda: segment().max_bend, lambda value: {"max_bend": value})
    add("max_curvature", 1e-6, curvature, lambda value: {"max_curvature": value or None})
    add("radius", step, lambda: segment().radius, lambda value: {"radius": value})


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
    fields.choice("beside it", (NONE, *names), lambda: model.settings.beside or NONE, beside, hint)
    fields.number(
        "seed", lambda: model.settings.seed, lambda value: put("seed", int(value)), min=0, max=2**31 - 1, step=1
    )
    fields.number("time, s", lambda: model.settings.time, partial(put, "time"), min=0.001, max=MOST_SECONDS, step=0.001)
    step = step_of(0.01 * model.robot.mean_length)
    off = lambda value: model.tolerate(value, tolerance().angle)  # noqa: E731
    fields.number("tolerance", position, off, step=step, hint="Of the position.")
    turned = lambda value: model.tolerate(position(), value)  # noqa: E731
    fields.number("tolerance, rad", lambda: tolerance().angle, turned, step=1e-4, hint="Of directions and rotations.")


def file_tab(save: Callable[[Any], object], session: Session, fields: Fields) -> None:
    """Save what is on the page, load another problem."""
    hint = "A problem file that says exactly what is on the page."
    button = fields.gui.add_button("Save as YAML", hint=hint)
    upload = fields.gui.add_upload_button("Load a problem", color="gray", mime_type=".yaml,.yml,.json")

    @button.on_click
    async def _(event: Any) -> None:
        session.do(("save", event.client_id), lambda: save(event.client))

    @upload.on_upload
    async def _(_: Any) -> None:
        session.load(upload.value.name, upload.value.content)


def step_of(size: float) -> float:
    """A step to type and drag lengths of this size in: a thousandth, rounded to a power of ten."""
    return float(10.0 ** math.floor(math.log10(max(size, 1e-300) / 300.0)))
