"""Robots, obstacles, targets, lines and axes as nodes of viser. A node is sent again only where it has changed."""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np
import rich
from numpy.typing import NDArray
from viser import (
    BatchedMeshHandle,
    CameraHandle,
    InitialCameraConfig,
    MeshHandle,
    SceneApi,
    SceneNodeHandle,
    ViserServer,
)
from viser.transforms import SO3

from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.problem.target import Target
from sinuous.scene.mesh import Mesh
from sinuous.scene.obstacles import Box, Cylinder, HalfSpace, Obstacle, Sphere
from sinuous.scene.point_cloud import PointCloud
from sinuous.view.display import style
from sinuous.view.display.bounds import Bounds
from sinuous.view.display.contents import Arm
from sinuous.view.display.style import Rgb, arrows_of, rgb
from sinuous.view.display.surfaces import BodySurface, Dotted, Triangles, as_triangles, obstacle_surface, points_of

TICK_SPANS, WIDTH_SPANS, NAME_SPANS = 0.015, 0.0012, 0.06
"""Length of a tick, width of a line, and how far beyond its axis a name stands, in spans of the page."""

NUMBER_SCALE = 0.6
"""Size of numbers, relative to that of other labels."""


def show_axes(scene: SceneApi, bounds: Bounds) -> SceneNodeHandle:
    """Draw axes from the lowest corner of the bounds; return the node that holds them."""
    root, span, low = scene.add_frame("/axes", show_axes=False), bounds.span, bounds.low
    for k, (name, colour) in enumerate(zip("xyz", (style.X, style.Y, style.Z), strict=True)):
        along, aside = np.eye(3)[k], TICK_SPANS * span * np.eye(3)[1 if k == 0 else 0]
        numbers = round_numbers(low[k], bounds.high[k], span / style.AXIS_NUMBERS)
        places = [low + (number - low[k]) * along for number in numbers]
        end = low + (bounds.high[k] - low[k]) * along
        lines = np.array([(low, end), *((place, place - aside) for place in places)])
        scene.add_line_segments(f"/axes/{name}", lines, rgb(colour), thickness=WIDTH_SPANS * span)
        labels = [(f"{number:.6g}", place - 2.5 * aside) for number, place in zip(numbers, places, strict=True)]
        for i, (text, place) in enumerate([*labels, (name, end + NAME_SPANS * span * along)]):
            at, size = f"/axes/{name}/{i}", NUMBER_SCALE if i < len(labels) else 1.0
            scene.add_label(at, text, position=place, font_screen_scale=size, anchor="center-center", depth_test=True)
    return root


def round_numbers(low: float, high: float, apart: float) -> list[float]:
    """Multiples of 1, 2 or 5 times a power of ten that is about `apart`, from low to high."""
    unit = 10.0 ** math.floor(math.log10(apart))
    step = next(size * unit for size in (1.0, 2.0, 5.0, 10.0) if size * unit >= 0.999 * apart)
    return [i * step for i in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


GREY, CHOSEN = rgb(style.OBSTACLE), rgb("#cc79a7")
"""Colours of obstacles, and of the one that is chosen."""

SEE_THROUGH = 0.35
"""Opacity of what hides the robot."""

BODY_AROUND, AROUND = 16, 24
"""Faces around a body, and around a round obstacle."""

GHOST_RADIUS_SHARE = 0.96
"""How much of its radius a ghost has: where it lies in a solid body, that one alone is seen."""

DOT_SPANS, LINE_SPANS = 0.011, 0.003
"""Radius of the point of a target, and width of a line, in spans of the page."""

MARK_SIZE = 1.2
"""Radius of a mark of a place, in those of the point of a target."""

SHADOWLESS: dict[str, Any] = {"cast_shadow": False, "receive_shadow": False}

UNITS: dict[type[Obstacle], Callable[[bool], Obstacle]] = {
    Sphere: lambda inside: Sphere((0, 0, 0), 1.0, inside),
    Box: lambda inside: Box((0, 0, 0), (2, 2, 2), inside=inside),
    Cylinder: lambda inside: Cylinder((0, 0, -1), (0, 0, 1), 1.0, inside),
}
"""Kinds of which all are one solid, scaled; so hundreds of them are one node."""


def quaternion_of(rotation: Floats) -> Floats:
    """Quaternion (4,) of a rotation (3, 3)."""
    return np.asarray(SO3.from_matrix(rotation).wxyz, np.float64)


def rotation_of(quaternion: Floats) -> Floats:
    """Rotation (3, 3) of a quaternion wxyz of any length but zero."""
    return np.asarray(SO3(quaternion / np.linalg.norm(quaternion)).as_matrix(), np.float64)


def update_node(node: Any, **values: Any) -> None:
    """Send what has changed of a node."""
    for name, value in values.items():
        if not np.array_equal(getattr(node, name), value):
            setattr(node, name, value)


def colours_of(arm: Arm) -> list[Rgb]:
    """Colours of the segments of a body."""
    return [rgb(colour) for colour in arm.colours]


class BodyStyle(NamedTuple):
    """How a body is drawn.

    Attributes
    ----------
    span : float
        Of the page: no body is thinner than a share of it.
    pieces : int
        Pieces of a segment that may have colours of their own.
    opacity : float or None
        Of ghosts; None is solid.
    grain : float
        Vertices are multiples of this, so that a recording is small; 0: as they are.
    along : int or None
        Bands along each segment; by default enough for a smooth picture.
    """

    span: float
    pieces: int = 1
    opacity: float | None = None
    grain: float = 0.0
    along: int | None = None


class BodyNode:
    """A robot on a page. Nothing is there before `show`.

    Parameters
    ----------
    scene : SceneApi
    name : str
        Name of its nodes.
    robot : Robot
    look : BodyStyle
    """

    def __init__(self, scene: SceneApi, name: str, robot: Robot, look: BodyStyle) -> None:
        self.robot, self.look = robot, look
        solid = look.opacity is None
        self.surface = BodySurface(
            robot,
            style.THINNEST_SHARE * look.span,
            BODY_AROUND,
            pieces=look.pieces,
            along=look.along,
            fittings=solid,
            share=1.0 if solid else GHOST_RADIUS_SHARE,
        )
        self._scene, self._name = scene, name
        self._nodes: list[MeshHandle] = []
        self._shown: tuple[Floats, Sequence[Rgb]] = np.empty(0), ()

    def show(self, q: Floats, colours: Sequence[Rgb]) -> None:
        """Show a configuration (n, 3) with one colour a piece of the body."""
        if np.array_equal(q, self._shown[0]) and colours == self._shown[1]:
            return
        self._shown = np.array(q), colours
        vertices = [own[0] for own in self.surface.vertices(q[None])]
        if self.look.grain:
            vertices = [np.round(own / self.look.grain) * self.look.grain for own in vertices]
        every = [*colours, *[rgb(style.METAL)] * (len(vertices) - len(colours))]
        if not self._nodes:
            self._nodes = [self._mesh(i, vertices[i], every[i]) for i in range(len(vertices))]
        for node, own, colour in zip(self._nodes, vertices, every, strict=True):
            update_node(node, vertices=own.astype(np.float32), color=colour)

    def remove(self) -> None:
        """Take it from the page."""
        for node in self._nodes:
            node.remove()
        self._nodes = []

    def _mesh(self, i: int, vertices: Floats, colour: Rgb) -> MeshHandle:
        name, faces = f"{self._name}/{i}", as_triangles(self.surface.parts[i].faces)
        arguments: dict[str, Any] = {"color": colour, "opacity": self.look.opacity, **SHADOWLESS}
        return self._scene.add_mesh_simple(name, vertices.astype(np.float32), faces, **arguments)


class _Single(NamedTuple):
    """An obstacle that has nodes of its own."""

    obstacle: Obstacle
    look: tuple[bool, bool]
    nodes: tuple[SceneNodeHandle, ...]


_Key = tuple[type[Obstacle], bool]
"""Obstacles in one node: their kind, and whether the body must stay inside."""


class Obstacles:
    """The obstacles on a page.

    Parameters
    ----------
    scene : SceneApi
    bounds : Bounds
        What is looked at: half-spaces, which have no end, are drawn there.
    on_click : callable, optional
        Told the index of an obstacle that somebody clicks on.
    """

    def __init__(self, scene: SceneApi, bounds: Bounds, on_click: Callable[[int], None] | None = None) -> None:
        self._scene, self._bounds, self._on_click = scene, bounds, on_click
        self._groups: dict[_Key, tuple[BatchedMeshHandle, int]] = {}
        self._members: dict[_Key, list[int]] = {}
        self._singles: dict[int, _Single] = {}
        self._rows: dict[Obstacle, tuple[Floats, Floats, Floats]] = {}
        self._shown: tuple[object, int | None, frozenset[int]] = None, None, frozenset()

    def show(
        self, obstacles: Sequence[Obstacle], chosen: int | None = None, hiding: frozenset[int] = frozenset()
    ) -> None:
        """Show these obstacles: one that is `chosen` has another colour, those that are `hiding` are see-through."""
        if self._shown[0] is obstacles and self._shown[1:] == (chosen, hiding):
            return
        self._shown = obstacles, chosen, hiding
        self._rows = {each: self._rows.get(each) or _scaled(each) for each in obstacles if type(each) in UNITS}
        singles: list[int] = []
        self._members = {}
        for i, obstacle in enumerate(obstacles):
            is_unit = type(obstacle) in UNITS
            same = self._members.setdefault((type(obstacle), obstacle.inside), []) if is_unit else singles
            same.append(i)
        for key in self._groups.keys() - self._members.keys():
            self._groups.pop(key)[0].remove()
        for key, own in self._members.items():
            self._show_group(key, [obstacles[i] for i in own])
        for i in self._singles.keys() - singles:
            _remove(self._singles.pop(i))
        for i in singles:
            self._show_single(i, obstacles[i], (i == chosen, i in hiding))

    def _show_group(self, key: _Key, own: list[Obstacle]) -> None:
        _, chosen, hiding = self._shown
        places, turns, scales = (np.stack(part) for part in zip(*(self._rows[each] for each in own), strict=True))
        colours = np.stack([_linear(CHOSEN if i == chosen else GREY) for i in self._members[key]])
        opacities = np.array([SEE_THROUGH if i in hiding else 1.0 for i in self._members[key]], np.float32)
        arrays: dict[str, Any] = {
            "batched_opacities": opacities if (opacities < 1.0).any() else None,
            "batched_positions": places.astype(np.float32),
            "batched_wxyzs": turns.astype(np.float32),
            "batched_scales": scales.astype(np.float32),
            "batched_colors": colours,
        }
        known = self._groups.get(key)
        if known is not None and known[1] == len(own):
            update_node(known[0], **arrays)
            return
        kind, inside = key
        vertices, faces = self._surface(UNITS[kind](inside))
        name = f"/obstacles/{kind.__name__}{'_inside' if inside else ''}"
        arguments: dict[str, Any] = {"lod": "off", "side": "front", **SHADOWLESS, **arrays}
        node = self._scene.add_batched_meshes_simple(name, vertices, faces, **arguments)
        self._groups[key] = node, len(own)
        self._listen(node, lambda event: self._members[key][event.instance_index or 0])

    def _show_single(self, i: int, obstacle: Obstacle, look: tuple[bool, bool]) -> None:
        known = self._singles.get(i)
        if known is not None:
            if known.look == look and (known.obstacle is obstacle or _move_nodes(known, obstacle)):
                return
            _remove(known)
        self._singles[i] = _Single(obstacle, look, tuple(self._nodes(f"/obstacles/{i}", obstacle, *look)))
        self._listen(self._singles[i].nodes[-1], lambda _: i)

    def _listen(self, node: Any, which: Callable[[Any], int]) -> None:
        """Tell which obstacle is clicked on."""
        if self._on_click is None or not hasattr(node, "on_click"):
            return
        clicked = self._on_click

        @node.on_click  # type: ignore[untyped-decorator]
        async def _(event: Any) -> None:
            clicked(which(event))

    def _nodes(self, name: str, obstacle: Obstacle, chosen: bool, hides: bool) -> Iterator[SceneNodeHandle]:
        colour = CHOSEN if chosen else GREY
        if isinstance(obstacle, Dotted):
            is_cloud = isinstance(obstacle, PointCloud)
            size = 2.0 * float(np.min(obstacle.radius)) if isinstance(obstacle, PointCloud) else obstacle.spacing
            yield self._scene.add_point_cloud(
                name,
                points_of(obstacle),
                colour,
                point_size=max(size, 0.004 * self._bounds.span),
                point_shape="circle" if is_cloud else "square",
                precision="float32",
            )
            return
        both = isinstance(obstacle, Mesh | HalfSpace) and not obstacle.inside
        vertices, faces = self._surface(obstacle)
        arguments: dict[str, Any] = {
            "color": colour,
            "side": "double" if both else "front",
            "flat_shading": isinstance(obstacle, Mesh),
            **SHADOWLESS,
        }
        if hides:  # of a see-through surface only what is nearest is drawn: its triangles are not sorted by their depth
            yield self._scene.add_mesh_simple(f"{name}_depth", vertices, faces, opacity=0.0, **arguments)
        yield self._scene.add_mesh_simple(name, vertices, faces, opacity=SEE_THROUGH if hides else None, **arguments)

    def _surface(self, obstacle: Obstacle) -> tuple[Floats, Triangles]:
        surface = obstacle_surface(obstacle, self._bounds.middle, 2.0 * self._bounds.span, AROUND, pieces=1)
        return surface.vertices, surface.triangles


def _move_nodes(known: _Single, obstacle: Obstacle) -> bool:
    """Move the nodes of an obstacle to where the same obstacle is now; say whether it is the same."""
    (root, before), (same, now) = (each.place or (each, np.eye(4)) for each in (known.obstacle, obstacle))
    if root is not same:
        return False
    motion = now @ np.linalg.inv(before)
    for node in known.nodes:
        node.position, node.wxyz = motion[:3, 3], quaternion_of(motion[:3, :3])
    return True


def _remove(known: _Single) -> None:
    for node in known.nodes:
        node.remove()


def _linear(colour: Rgb) -> NDArray[np.uint8]:
    """The colour as batched nodes take it: pages show theirs without the gamma of all others."""
    return np.round(255.0 * (np.array(colour) / 255.0) ** 2.2).astype(np.uint8)


def _scaled(obstacle: Any) -> tuple[Floats, Floats, Floats]:
    """Place, quaternion and scale of the unit solid that an obstacle is."""
    center, rotation, half, rounding = obstacle.frame
    return center, quaternion_of(rotation), half + rounding


def show_target(scene: SceneApi, name: str, target: Target, place: Floats, span: float) -> None:
    """Draw a point at `place` (3,), an arrow where a direction is asked, three where a whole rotation is."""
    show_ball(scene, name, place, style.TARGET, span)
    arrows = list(arrows_of(target))
    if arrows:
        ends = np.array([(np.zeros(3), style.ARROW_SHARE * span * axis) for axis, _ in arrows])
        shades = np.array([rgb(colour) for _, colour in arrows], np.uint8)
        thin, wide, long = 0.003 * span, 0.008 * span, 0.025 * span
        scene.add_arrows(f"{name}/arrow", ends, shades, shaft_radius=thin, head_radius=wide, head_length=long)


class ChangingNode:
    """A node that comes, changes and goes: `add` makes it of a look, which are arguments of viser by name."""

    def __init__(self, add: Callable[..., Any]) -> None:
        self._add, self._node = add, None

    def show(self, look: dict[str, Any] | None) -> None:
        """Show it so, or not at all."""
        if look is not None:
            self._node = self._node or self._add(**look)
            update_node(self._node, **look)
        if self._node is not None:
            self._node.visible = look is not None


def show_ball(
    scene: SceneApi, name: str, place: Floats, colour: str, span: float, size: float = 1.0
) -> SceneNodeHandle:
    """Draw a ball at a place (3,), `size` times as large as the point of a target."""
    return scene.add_icosphere(name, size * DOT_SPANS * span, color=rgb(colour), position=place, **SHADOWLESS)


def show_line(scene: SceneApi, name: str, points: Floats | Sequence[Floats], colour: str, span: float) -> None:
    """Draw a line through points (k, 3)."""
    places = np.asarray(points, np.float64)
    scene.add_line_segments(name, np.stack([places[:-1], places[1:]], axis=1), rgb(colour), thickness=LINE_SPANS * span)


FIELD_OF_VIEW = math.radians(40.0)
"""Angle that the camera sees, from top to bottom."""


CAMERA_MARGIN = 1.1
"""How far a camera is away, relative to where what is shown fills the view: numbers and names of axes need room."""


def aim_camera(camera: CameraHandle | InitialCameraConfig, bounds: Bounds, side: Floats) -> None:
    """Let a camera show all of the bounds from the side that a unit vector (3,) leads to."""
    right = np.cross((0.0, 0.0, 1.0), side)
    right = right / np.linalg.norm(right) if right.any() else np.array([1.0, 0.0, 0.0])
    corners = (np.array(list(np.ndindex(2, 2, 2))) - 0.5) * (bounds.high - bounds.low)
    across = np.abs(corners @ np.stack([right, np.cross(side, right)], axis=-1)).max(axis=-1)
    away = CAMERA_MARGIN * (float((corners @ side + across / math.tan(0.5 * FIELD_OF_VIEW)).max()) or 1.0)
    camera.position, camera.look_at, camera.fov = bounds.middle + away * side, bounds.middle, FIELD_OF_VIEW
    camera.near, camera.far = 0.01 * away, 100.0 * away


def sees(camera: CameraHandle, point: Floats) -> bool:
    """Whether a point (3,) is in the picture of a camera."""
    right, down, depth = (point - camera.position) @ rotation_of(np.array(camera.wxyz))
    half = depth * math.tan(0.5 * camera.fov)
    return bool(abs(right) < half * camera.aspect and abs(down) < half)


@contextmanager
def silence_console() -> Iterator[None]:
    """Keep viser from printing where it listens and that it stopped."""
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before


def open_server(host: str = "127.0.0.1", port: int = 0) -> ViserServer:
    """Start a server with an empty scene and none of viser's own signs.

    `port` 0: any that is free.
    """
    with silence_console():
        server = ViserServer(host=host, port=port, label="Sinuous", verbose=False)
    server.gui.configure_theme(show_logo=False, show_share_button=False)
    server.scene.world_axes.visible = False
    light_scene(server)
    server.request_share_url = lambda verbose=True: None  # type: ignore[method-assign]  # no page may open a tunnel
    return server


def light_scene(server: ViserServer) -> None:
    """Light the scene evenly and without shadows: clear colours, and quick where pages are drawn in software."""
    scene = server.scene
    scene.configure_environment_map(None)
    scene.configure_default_lights(False)
    scene.add_light_ambient("/light/all", intensity=0.6)
    scene.add_light_hemisphere("/light/sky", sky_color=(255, 255, 255), ground_color=(150, 155, 165), intensity=1.0)
    for name, side, strength in (("left", (-1.0, -2.0, 3.0), 1.5), ("right", (2.0, 1.0, 1.0), 0.7)):
        scene.add_light_directional(f"/light/{name}", intensity=strength, position=side)


def close_server(server: ViserServer) -> None:
    """Stop a server."""
    with silence_console():
        server.stop()
