"""The page of `sinuous view`: what browsers show of a session, and what people do in them."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from viser import ClientHandle, TransformControlsHandle, ViserServer

from sinuous.answer.solution import Solution
from sinuous.base.checks import Floats
from sinuous.motion.job import Job
from sinuous.motion.motion import Motion
from sinuous.problem.target import Target
from sinuous.solver.memory import Memory
from sinuous.view.display.bounds import best_view, bounds_of, direction_of, find_hiding, seen_places
from sinuous.view.display.contents import Arm, Contents, arms_of, forces_of, place_of
from sinuous.view.display.results import clearances_along
from sinuous.view.display.style import CONTACT, FORCE, TIP_PATH, Rgb, colour_by_bending, colour_by_clearance, rgb
from sinuous.view.page import nodes
from sinuous.view.page.model import PageModel
from sinuous.view.page.panel import Action, Panel
from sinuous.view.page.session import Session
from sinuous.view.page.status import (
    NearestPlace,
    block_html,
    find_nearest,
    judge_shape,
    missed_distance,
    status_html,
    table_html,
)
from sinuous.view.page.tabs import PARTS

BESIDE, GHOST = 0.5, 0.3
"""Opacity of the shape of a second method, and of other solutions."""

FINE_PIECES, PIECE_STEPS = 4, 3
"""Pieces of a segment that are coloured by their clearance, and steps along each at which it is measured."""

FAR_LENGTHS = 0.15
"""Clearance, in mean lengths of the robot, at the end of the scale of colours."""

GIZMO_SPANS = 0.16
"""Size of a gizmo, in spans of the page."""

NEAREST_COLOUR = rgb("#333a42")
"""Colour of the line to the nearest place."""

HAND_TONES = 3
"""Which of the pairs of tones a body has that was bent by hand."""

MOST_GIZMOS = 8
"""Targets with a gizmo."""

FIRST_WORDS = "drag the arrows"
"""What stands at the target until somebody does."""

KEYS = {
    "target": "drag its arrows, squares and rings",
    "obstacle": "click it, then drag its arrows",
    "view": "drag elsewhere to turn, with the right button to move; the wheel zooms, F fits all",
    "undo, redo": "Ctrl+Z, Ctrl+Shift+Z",
    "commands": "Ctrl+K",
    "this list": "?",
}
"""What mouse and keys do."""

Moved = Callable[[Floats, Floats, bool], None]
"""Told of a gizmo: its position (3,), its rotation (3, 3), and whether it was let go."""


class Scenery:
    """The scene of the page; `words` stand at the target."""

    def __init__(self, server: ViserServer, session: Session) -> None:
        self._server, self._session = server, session
        self._model = model = session.model
        contents = _contents(model)
        self.bounds = bounds_of(contents)
        nodes.aim_camera(server.initial_camera, self.bounds, direction_of(best_view(contents)))
        self._axes = nodes.show_axes(server.scene, self.bounds)
        self._obstacles = nodes.Obstacles(server.scene, self.bounds, session.choose_obstacle)
        self._bodies: dict[str, nodes.BodyNode] = {}
        self._gizmos: dict[str, tuple[str, TransformControlsHandle]] = {}
        self._near = self._lines("/near", NEAREST_COLOUR, 1.0)
        self._forces = self._lines("/forces", rgb(FORCE), 2.0)
        self._missing = self._lines("/missing", rgb(CONTACT), 0.6)
        ball = partial(server.scene.add_icosphere, "/worst", color=rgb(CONTACT), **nodes.SHADOWLESS)
        self._worst = nodes.ChangingNode(ball)
        self._said = nodes.ChangingNode(
            partial(server.scene.add_label, "/said", anchor="bottom-center", font_screen_scale=0.9)
        )
        self.words = ""
        self._seen: list[Floats] = []
        self._hiding: frozenset[int] = frozenset()
        self.update_hiding()
        if model.job.is_path:
            self._show_path()

    def _lines(self, name: str, colour: Rgb, width: float) -> nodes.ChangingNode:
        """Lines between pairs of points, so many times as wide as others."""
        thickness = width * nodes.LINE_SPANS * self.bounds.span
        return nodes.ChangingNode(
            partial(self._server.scene.add_line_segments, name, colors=colour, thickness=thickness)
        )

    def fit(self, client: ClientHandle) -> None:
        """Let a browser show all that is on the page, from the side that it looks from."""
        away = client.camera.position - client.camera.look_at
        self.bounds = bounds_of(_contents(self._model))
        self._axes.remove()
        self._axes = nodes.show_axes(self._server.scene, self.bounds)
        with client.atomic():
            nodes.aim_camera(client.camera, self.bounds, away / np.linalg.norm(away))

    def keep_in_view(self) -> None:
        """Fit the view of every browser that does not see a target which was moved since."""
        before, self._seen = self._seen, [self._model.target_frame(i)[:3, 3] for i in range(len(self._model.targets))]
        if before and not np.array_equal(before, self._seen):
            for client in self._server.get_clients().values():
                if not all(nodes.sees(client.camera, place) for place in self._seen):
                    self.fit(client)

    def update_hiding(self) -> None:
        """Make see-through what hides the body from somebody."""
        clients = self._server.get_clients().values()
        eyes = [client.camera.position for client in clients] or [self._server.initial_camera.position]
        body = Contents(arms=arms_of(self._model.robot, self._model.shown))
        self._hiding = find_hiding(self._model.there.obstacles, seen_places(body), np.array(eyes))

    def show(self, near: NearestPlace | None) -> None:
        """Show the model as it is."""
        with self._server.atomic():
            self._show_bodies()
            forces = forces_of(self._model.robot, self._model.shown)
            self._forces.show({"points": np.stack(forces)} if forces else None)
            self._obstacles.show(self._model.there.obstacles, self._model.grasped, self._hiding)
            self._axes.visible = self._session.axes
            self._show_gizmos()
            self._near.show(None if near is None else {"points": np.stack([near.body, near.surface])[None]})

    def show_why(self) -> None:
        """Mark the place of an answer that is not solved, and say at the target how far away it is, or what to do."""
        model, span = self._model, self.bounds.span
        answer = model.answer if model.motion is None else None
        place = None if answer is None else place_of(answer)
        radius = nodes.MARK_SIZE * nodes.DOT_SPANS * span
        self._worst.show(None if place is None else {"position": np.array(place.position), "radius": radius})
        missed = None if answer is None else missed_distance(answer)
        end = model.target_frame(0)[:3, 3] if model.targets else None
        line = None if missed is None or end is None or place is None else np.stack([place.position, end])[None]
        self._missing.show(None if line is None else {"points": line})
        told = end is not None and (missed is not None or not self._session.dragged)
        self.words = "" if not told else FIRST_WORDS if missed is None else f"{missed:.3g} away"
        if end is None or not told:
            self._said.show(None)
        else:  # above or below, wherever there is more room
            side = 0.6 if end[2] < self.bounds.middle[2] else -0.8
            self._said.show({"position": end + side * GIZMO_SPANS * span * np.eye(3)[2], "text": self.words})

    def _show_bodies(self) -> None:
        wanted = list(self._wanted_bodies())
        for name in self._bodies.keys() - {name for name, *_ in wanted}:
            self._bodies.pop(name).remove()
        for name, look, arm, colours in wanted:
            body = self._bodies.get(name)
            if body is None or body.robot is not arm.robot or body.look != look:
                if body is not None:
                    body.remove()
                body = self._bodies[name] = nodes.BodyNode(self._server.scene, f"/{name}", arm.robot, look)
            body.show(arm.q, colours)

    def _wanted_bodies(self) -> Iterator[tuple[str, nodes.BodyStyle, Arm, list[Rgb]]]:
        """Yield the bodies on the page: a name, how it is drawn, the body, a colour for each of its pieces."""
        model, robot, span = self._model, self._model.robot, self.bounds.span
        body, *around = arms_of(robot, model.shown, self._good(), HAND_TONES if model.by_hand else 0)
        pieces = max(1, FINE_PIECES * len(robot) // len(body.robot)) if self._session.colouring == "clearance" else 1
        yield "body", nodes.BodyStyle(span, pieces), body, self._colours(body, pieces)
        others = {f"ghosts/own{i}": each for i, each in enumerate(around)}
        if model.beside is not None and model.motion is None:
            others["second"] = arms_of(robot, model.beside.configuration, model.beside.solved, 1)[0]
        shapes = {f"ghosts/{i}": each.configuration for i, each in enumerate(model.ghosts) if each is not model.answer}
        if model.job.goal is not None:
            shapes["goal"] = model.job.goal
        others |= {name: arms_of(robot, q, number=i)[0] for i, (name, q) in enumerate(shapes.items(), 1)}
        for name, arm in others.items():
            style = nodes.BodyStyle(span, opacity=BESIDE if name == "second" else GHOST)
            yield name, style, arm, nodes.colours_of(arm)

    def _colours(self, body: Arm, pieces: int) -> list[Rgb]:
        """One colour a piece of the body."""
        model = self._model
        if self._session.colouring == "bending":
            own = colour_by_bending(model.robot, model.shown)
            return [own[k] for k in body.segments]
        if self._session.colouring == "clearance" and len(model.scene):
            places = clearances_along(body.robot, model.there, body.q, pieces * PIECE_STEPS)
            least = [float(places[i : i + PIECE_STEPS + 1].min()) for i in range(0, len(places) - 1, PIECE_STEPS)]
            return colour_by_clearance(least, FAR_LENGTHS * model.robot.mean_length)
        return [colour for colour in nodes.colours_of(body) for _ in range(pieces)]

    def _good(self) -> bool:
        """Whether the shape meets what is asked; of a motion, whether it is proved clear there."""
        model = self._model
        if model.motion is not None:
            return model.step_is_proved
        return model.by_hand or not model.targets or (model.answer is not None and model.answer.solved)

    def gizmo(self, name: str) -> TransformControlsHandle | None:
        """The gizmo of a target, `targets/0`, or of the chosen obstacle, `grip`, where there is one."""
        return self._gizmos[name][1] if name in self._gizmos else None

    def _show_gizmos(self) -> None:
        wanted = {name: (kind, frame, moved) for name, kind, frame, moved in self._wanted_gizmos()}
        for name, (kind, gizmo) in list(self._gizmos.items()):
            if name not in wanted or wanted[name][0] != kind:
                gizmo.remove()
                del self._gizmos[name]
        for name, (kind, frame, moved) in wanted.items():
            if name not in self._gizmos:
                self._gizmos[name] = kind, self._make_gizmo(f"/{name}", kind, moved)
            nodes.update_node(self._gizmos[name][1], scale=GIZMO_SPANS * self.bounds.span)
            _place(self._gizmos[name][1], frame)

    def _wanted_gizmos(self) -> Iterator[tuple[str, str, Floats, Moved]]:
        """Yield the gizmos on the page: a name, what each can do, its frame (4, 4), and who is told that it moves."""
        for i, target in enumerate(self._model.targets[:MOST_GIZMOS]):
            kind, frame = _kind_of(target), self._model.target_frame(i)
            if kind == "position":  # the axes of the world; those of the tip would turn in the hand
                frame[:3, :3] = np.eye(3)
            yield f"targets/{i}", kind, frame, partial(self._target_moved, i)
        if self._model.grip is not None:
            yield "grip", "pose", self._model.grip, self._session.move_obstacle

    def _target_moved(self, index: int, position: Floats, rotation: Floats, let_go: bool) -> None:
        self._session.move_target(index, position, rotation)

    def _make_gizmo(self, name: str, kind: str, moved: Moved) -> TransformControlsHandle:
        endless = ((-1e9, 1e9),) * 3
        gizmo = self._server.scene.add_transform_controls(
            name,
            scale=GIZMO_SPANS * self.bounds.span,
            disable_rotations=kind == "position",
            disable_axes=kind == "turn",
            disable_sliders=kind == "turn",
            translation_limits=(endless[0], endless[1], endless[2]),
            depth_test=False,
        )

        @gizmo.on_update
        async def _(event: Any) -> None:
            moved(np.array(gizmo.position), nodes.rotation_of(np.array(gizmo.wxyz)), event.phase == "end")

        return gizmo

    def _show_path(self) -> None:
        places = [target.position for targets in self._model.job.waypoints for target in targets[:1]]
        known = [place for place in places if place is not None]
        if len(known) > 1:
            nodes.show_line(self._server.scene, "/path", known, TIP_PATH, self.bounds.span)


def _kind_of(target: Target) -> str:
    """What the gizmo of a target can do: `position`, `turn`, or `pose`, which is both."""
    turned = target.direction is not None or target.rotation is not None
    return "position" if not turned else "turn" if target.position is None else "pose"


def _place(gizmo: TransformControlsHandle, frame: Floats) -> None:
    """Put a gizmo where the model has it, unless it is there: it may be in somebody's hand."""
    off = float(np.abs(gizmo.position - frame[:3, 3]).max())
    if off > 1e-12 + 1e-9 * float(np.abs(frame[:3, 3]).max()):
        gizmo.position = frame[:3, 3]
    if float(np.abs(nodes.rotation_of(gizmo.wxyz)[:, 2] - frame[:3, 2]).max()) > 1e-6:
        gizmo.wxyz = nodes.quaternion_of(frame[:3, :3])


def _contents(model: PageModel) -> Contents:
    """What must be on the page: the robot, its goal, and the targets of all waypoints."""
    contents = Contents(obstacles=list(model.scene.obstacles))
    for q in [model.shown] if model.job.goal is None else [model.shown, model.job.goal]:
        contents.add_robot(model.robot, q)
    for targets in model.job.waypoints:
        for target in targets:
            contents.add_target(target)
    return contents


class Page(Session):
    """A page that any number of browsers look at.

    Parameters
    ----------
    job : Job
    host : str
    port : int
        0: any that is free.
    answer : Solution, Motion or None
        What was found before, to begin with.
    memory : Memory, optional
        Shapes to begin from; what is solved is added.
    """

    def __init__(
        self,
        job: Job,
        host: str = "127.0.0.1",
        port: int = 0,
        answer: Solution | Motion | None = None,
        memory: Memory | None = None,
    ) -> None:
        super().__init__(job, answer, memory)
        self.server = nodes.open_server(host, port)
        self.server.on_client_connect(self._watch)
        self._build()
        self.do("begin", lambda: None)

    @property
    def port(self) -> int:
        """Where it listens."""
        return int(self.server.get_port())

    def stop(self) -> None:
        """Close the page."""
        super().stop()
        nodes.close_server(self.server)

    def _actions(self) -> tuple[Action, ...]:
        return (
            Action("Undo", "Z", "cmd/ctrl", lambda _: self.undo()),
            Action("Redo", "Z", "cmd/ctrl+shift", lambda _: self.redo()),
            Action("Fit view", "F", None, lambda client: self.do("fit", lambda: self.scenery.fit(client))),
            Action("Keys", "?", "shift", _show_keys),
        )

    def _build(self) -> None:
        self._answer_quickly()  # so that the camera looks at where the robot first gets to
        self.server.gui.reset()
        self.server.scene.reset()
        nodes.light_scene(self.server)
        self.scenery = Scenery(self.server, self)
        parts = [part for part in PARTS if part[0] != "Target" or self.model.targets]
        self._panel = Panel(self.server.gui, self, self._actions(), parts)

    def _draw(self) -> None:
        model = self.model
        self.near = find_nearest(model.robot, model.there, model.shown)
        self.scenery.show(self.near)

    def _watch(self, client: ClientHandle) -> None:
        client.camera.on_update(lambda _: self.turn_view())

    def _keep_in_view(self) -> None:
        self.scenery.keep_in_view()

    def _update_hiding(self) -> None:
        self.scenery.update_hiding()
        self.scenery.show(self.near)

    def _refresh(self, busy: bool) -> None:
        model = self.model
        judged = judge_shape(model.robot, model.targets, model.q) if model.by_hand else None
        with self.server.atomic():
            self.scenery.show_why()
            self._panel.refresh(*status_html(model, self.near, judged, busy))


def _show_keys(client: ClientHandle) -> None:
    """Say in a browser what mouse and keys do."""
    modal = client.gui.add_modal("Mouse and keys")
    with modal:
        client.gui.add_html(block_html(table_html(KEYS)))
        client.gui.add_button("Close").on_click(lambda _: modal.close())
