"""What of the model stands in space: bodies, obstacles, targets with gizmos, the line to the nearest place."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from viser import LineSegmentsHandle, TransformControlsHandle, ViserServer

from sinuous.checks import Floats
from sinuous.display.bounds import best_view, bounds_of
from sinuous.display.clearances import clearances
from sinuous.display.contents import Arm, Contents
from sinuous.display.style import TIP_PATH, Rgb, by_bending, by_clearance, rgb
from sinuous.viewer.model import Model
from sinuous.viewer.nodes import LINE, Body, Look, Obstacles, body_tones, rotation_of, show_line, wxyz
from sinuous.viewer.server import aim
from sinuous.viewer.session import Session
from sinuous.viewer.status import Near

BESIDE, GHOST = 0.5, 0.3
"""Opacity of the shape of a second method, and of other solutions."""

FINE = 4
"""Pieces of a segment that are coloured by their clearance."""

FAR = 0.15
"""Clearance, in mean lengths of the robot, at the end of the scale of colours."""

GIZMO = 0.16
"""Size of a gizmo, in spans of the page."""

NEAR = rgb("#333a42")
"""Colour of the line to the nearest place."""

HAND = 3
"""Which of the pairs of tones a body has that was bent by hand."""

MOST_GIZMOS = 8
"""Targets with a gizmo."""

Moved = Callable[[Floats, Floats, bool], None]
"""Told of a gizmo: its position (3,), its rotation (3, 3), and whether it was let go."""


class Scenery:
    """The scene of the page."""

    def __init__(self, server: ViserServer, session: Session) -> None:
        self._server, self._session = server, session
        self._model = model = session.model
        contents = _contents(model)
        self.bounds = bounds_of(contents)
        aim(server, self.bounds, best_view(contents))
        self._obstacles = Obstacles(server.scene, self.bounds, session.choose_obstacle)
        self._body: Body | None = None
        self._second: Body | None = None
        self._ghosts: tuple[list[Any], list[Body]] = ([], [])
        self._gizmos: list[tuple[str, TransformControlsHandle]] = []
        self._grip: TransformControlsHandle | None = None
        self._line: LineSegmentsHandle | None = None
        if model.job.is_path:
            self._show_path()
        if model.job.goal is not None:
            self._ghost("/goal", model.job.goal)

    def show(self, near: Near | None) -> None:
        """Show the model as it is."""
        with self._server.atomic():
            self._show_bodies()
            self._obstacles.show(self._model.there.obstacles, self._model.grasped)
            self._show_gizmos()
            self._show_grip()
            self._show_near(near)

    def _show_bodies(self) -> None:
        model = self._model
        parts = FINE if self._session.colouring == "clearance" else 1
        if self._body is None or self._body.robot is not model.robot or self._body.look.pieces != parts:
            self._body = self._anew(self._body, "body", Look(self.bounds.span, parts))
        self._body.show(model.shown, self._colours(self._body, model.shown))
        if model.beside is None or model.motion is not None:
            if self._second is not None:
                self._second.remove()
            self._second = None
        else:
            if self._second is None or self._second.robot is not model.robot:
                self._second = self._anew(self._second, "second", Look(self.bounds.span, 1, BESIDE))
            self._second.show(model.beside.q, body_tones(len(model.robot), model.beside.solved, 1))
        others = [(i, each) for i, each in enumerate(model.ghosts) if each is not model.answer]
        if self._ghosts[0] != others:
            for body in self._ghosts[1]:
                body.remove()
            self._ghosts = others, [self._ghost(f"/ghosts/{i}", each.q, i) for i, each in others]

    def _anew(self, before: Body | None, name: str, look: Look) -> Body:
        if before is not None:
            before.remove()
        return Body(self._server.scene, f"/{name}", self._model.robot, look)

    def _ghost(self, name: str, q: Floats, i: int = 0) -> Body:
        body = Body(self._server.scene, name, self._model.robot, Look(self.bounds.span, 1, GHOST))
        body.show(q, body_tones(len(self._model.robot), True, 1 + i))
        return body

    def _colours(self, body: Body, q: Floats) -> list[Rgb]:
        """One colour a piece of the body."""
        model, robot = self._model, body.robot
        if self._session.colouring == "bending":
            return by_bending(robot, q)
        if self._session.colouring == "clearance" and len(model.scene):
            places = clearances(robot, model.there, q, body.surface.per_segment)
            least = [float(places[part.middle].min()) for part in body.surface.parts if part.segment is not None]
            return by_clearance(least, FAR * robot.mean_length)
        solved = model.by_hand or not model.targets or (model.answer is not None and model.answer.solved)
        if model.motion is not None:
            solved = model.step_is_proved
        own = body_tones(len(robot), solved, HAND if model.by_hand else 0)
        return [own[part.segment] for part in body.surface.parts if part.segment is not None]

    def _show_gizmos(self) -> None:
        kinds = [_asked(target) for target in self._model.targets[:MOST_GIZMOS]]
        if [kind for kind, _ in self._gizmos] != kinds:
            for _, gizmo in self._gizmos:
                gizmo.remove()
            self._gizmos = [
                (kind, self._gizmo(f"/targets/{i}", kind, partial(self._target_moved, i)))
                for i, kind in enumerate(kinds)
            ]
        for i, (kind, gizmo) in enumerate(self._gizmos):
            frame = self._model.target_frame(i)
            if kind == "position":  # the axes of the world; those of the tip would turn in the hand
                frame[:3, :3] = np.eye(3)
            _place(gizmo, frame)

    def _target_moved(self, index: int, position: Floats, rotation: Floats, let_go: bool) -> None:
        self._session.move_target(index, position, rotation)

    def _gizmo(self, name: str, kind: str, moved: Moved) -> TransformControlsHandle:
        endless = ((-1e9, 1e9),) * 3
        gizmo = self._server.scene.add_transform_controls(
            name,
            scale=GIZMO * self.bounds.span,
            disable_rotations=kind == "position",
            disable_axes=kind == "turn",
            disable_sliders=kind == "turn",
            translation_limits=(endless[0], endless[1], endless[2]),
            depth_test=False,
        )

        @gizmo.on_update
        async def _(event: Any) -> None:
            moved(np.array(gizmo.position), rotation_of(np.array(gizmo.wxyz)), event.phase == "end")

        return gizmo

    def _show_grip(self) -> None:
        place = self._model.grip
        if place is None:
            if self._grip is not None:
                self._grip.remove()
            self._grip = None
            return
        if self._grip is None:
            self._grip = self._gizmo("/grip", "rotation", self._session.move_obstacle)
        _place(self._grip, place)

    def _show_near(self, near: Near | None) -> None:
        if self._line is None:
            ends = np.zeros((1, 2, 3))
            thick = LINE * self.bounds.span
            self._line = self._server.scene.add_line_segments("/near", ends, NEAR, thickness=thick, visible=False)
        if near is not None:
            self._line.points = np.stack([near.body, near.surface])[None].astype(np.float32)
        self._line.visible = near is not None

    def _show_path(self) -> None:
        places = [target.position for targets in self._model.job.waypoints for target in targets[:1]]
        known = [place for place in places if place is not None]
        if len(known) > 1:
            show_line(self._server.scene, "/path", known, TIP_PATH, self.bounds.span)


def _asked(target: Any) -> str:
    """What a gizmo of a target can do: `position`, `turn`, or both."""
    turned = target.direction is not None or target.rotation is not None
    return "position" if not turned else "turn" if target.position is None else "pose"


def _place(gizmo: TransformControlsHandle, frame: Floats) -> None:
    """Put a gizmo where the model has it, unless it is there: it may be in somebody's hand."""
    off = float(np.abs(gizmo.position - frame[:3, 3]).max())
    if off > 1e-12 + 1e-9 * float(np.abs(frame[:3, 3]).max()):
        gizmo.position = frame[:3, 3]
    if float(np.abs(_axis(gizmo.wxyz) - frame[:3, 2]).max()) > 1e-6:
        gizmo.wxyz = wxyz(frame[:3, :3])


def _axis(quaternion: Floats) -> Floats:
    """The z axis (3,) of a frame whose rotation is this quaternion wxyz."""
    w, x, y, z = quaternion.tolist()
    axis: Floats = np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
    return axis


def _contents(model: Model) -> Contents:
    """What must be on the page: the robot, its goal, and the targets of all waypoints."""
    shapes = [model.q] if model.job.goal is None else [model.q, model.job.goal]
    contents = Contents(arms=[Arm(model.robot, q) for q in shapes], obstacles=list(model.scene.obstacles))
    for targets in model.job.waypoints:
        for target in targets:
            contents.add_target(target, contents.arms[0])
    return contents
