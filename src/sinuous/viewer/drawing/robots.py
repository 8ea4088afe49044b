"""A robot on a page: its body as a few meshes that follow the configuration, what it stands on, and its tool."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from viser import MeshHandle, SceneApi

from sinuous.checks import Floats
from sinuous.pictures.style import METAL
from sinuous.poses import least_rotation
from sinuous.robot.robot import Robot
from sinuous.viewer.drawing import solids
from sinuous.viewer.drawing.colours import Rgb, rgb
from sinuous.viewer.drawing.poses import wxyz
from sinuous.viewer.drawing.tube import Tube

FLANGE, PLATE = 2.0, 0.5
"""Radius and half the thickness of what the robot stands on, in radii of its body."""

GHOSTLY = 0.96
"""How much of its radius a ghost has: where it lies in a solid body, that one alone is seen."""

STEM = 0.35
"""Radius of the tool, which has no body, in radii of the last segment."""


class Look(NamedTuple):
    """How a body is drawn.

    Attributes
    ----------
    least_radius : float
        No thinner than this.
    parts : int
        Pieces of a segment that may have colours of their own.
    opacity : float or None
        Of ghosts; None is solid.
    grain : float
        Places are multiples of this, so that a recording is small; 0: as they are.
    along : int or None
        Steps along each piece; by default enough for a smooth picture.
    """

    least_radius: float
    parts: int = 1
    opacity: float | None = None
    grain: float = 0.0
    along: int | None = None


class Body:
    """A robot on a page. Nothing is there before `show`.

    Parameters
    ----------
    scene : SceneApi
    name : str
        Of its nodes.
    robot : Robot
    look : Look
    """

    def __init__(self, scene: SceneApi, name: str, robot: Robot, look: Look) -> None:
        self.robot, self.look = robot, look
        share = 1.0 if look.opacity is None else GHOSTLY
        self.tube = Tube(robot, look.least_radius, look.parts, look.along, share)
        self._scene, self._name = scene, name
        self._pieces: list[MeshHandle] = []
        self._fixed: list[MeshHandle] = []
        self._stem: MeshHandle | None = None

    def show(self, q: Floats, colours: Sequence[Rgb]) -> Floats:
        """Show a configuration (n, 3) with one colour a piece; return the frames (m, 12) along the backbone."""
        frames = self.tube.frames(q[None])
        points = self.tube.points(frames)[0].reshape(-1, 3)
        if self.look.grain:
            points = np.round(points / self.look.grain) * np.float32(self.look.grain)
        around = len(points) // self.tube.pieces[-1].rings.stop
        parts = [points[p.rings.start * around : p.rings.stop * around] for p in self.tube.pieces]
        if not self._pieces:
            self._make(parts, colours)
        for handle, part, colour in zip(self._pieces, parts, colours, strict=True):
            handle.vertices = part
            if handle.color != colour:
                handle.color = colour
        self._place_stem(q)
        along: Floats = frames[0]
        return along

    def remove(self) -> None:
        """Take it from the page."""
        for handle in [*self._pieces, *self._fixed, *([] if self._stem is None else [self._stem])]:
            handle.remove()
        self._pieces, self._fixed, self._stem = [], [], None

    def _make(self, parts: list[Floats], colours: Sequence[Rgb]) -> None:
        for i, (piece, part, colour) in enumerate(zip(self.tube.pieces, parts, colours, strict=True)):
            faces = self.tube.faces(piece)
            self._pieces.append(self._mesh(f"{i}", solids.Solid(part, faces), colour))
        if self.look.opacity is not None:
            return
        base, radius = self.robot.base, max(self.robot.radii[0], self.look.least_radius)
        flange = self._mesh("flange", solids.cylinder(), rgb(METAL))
        flange.scale = (FLANGE * radius, FLANGE * radius, PLATE * radius)
        flange.wxyz, flange.position = wxyz(base[:3, :3]), base[:3, 3] - (1.0 + PLATE) * radius * base[:3, 2]
        neck = self._mesh("neck", solids.cylinder(), rgb(METAL))
        neck.scale = (1.2 * radius, 1.2 * radius, 0.5 * radius)
        neck.wxyz, neck.position = wxyz(base[:3, :3]), base[:3, 3] - 0.5 * radius * base[:3, 2]
        self._fixed = [flange, neck]
        if self.robot.tool[:3, 3].any():
            self._stem = self._mesh("tool", solids.cone(), rgb(METAL))

    def _place_stem(self, q: Floats) -> None:
        if self._stem is None:
            return
        tip, tool = self.robot.forward(q)[-1, :3, 3], self.robot.tip(q)[:3, 3]
        axis, radius = tool - tip, STEM * max(self.robot.radii[-1], self.look.least_radius)
        length = float(np.linalg.norm(axis))
        self._stem.scale = (radius, radius, length)
        self._stem.wxyz, self._stem.position = wxyz(least_rotation(axis / length)), tip

    def _mesh(self, name: str, solid: solids.Solid, colour: Rgb) -> MeshHandle:
        return self._scene.add_mesh_simple(
            f"{self._name}/{name}",
            solid.vertices,
            solid.faces,
            color=colour,
            opacity=self.look.opacity,
            cast_shadow=False,
            receive_shadow=False,
        )
