"""Obstacles on a page: equal kinds as one node, so that hundreds of them stay quick; the others one by one."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from viser import BatchedMeshHandle, SceneApi, SceneNodeHandle

from sinuous.checks import Floats
from sinuous.pictures.shapes.dots import Dotted, dots
from sinuous.pictures.style import OBSTACLE
from sinuous.scene.clouds.point_cloud import PointCloud
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Obstacle, Sphere
from sinuous.viewer.drawing import solids
from sinuous.viewer.drawing.colours import Rgb, rgb
from sinuous.viewer.drawing.poses import wxyz

GREY = rgb(OBSTACLE)
CHOSEN = rgb("#cc79a7")
SEE_THROUGH = 0.35
"""Opacity of meshes and planes, which may hide the robot."""

UNITS: dict[type[Obstacle], Callable[[], solids.Solid]] = {
    Sphere: solids.sphere,
    Box: solids.box,
    Cylinder: solids.cylinder,
}
"""Kinds that are all one solid, scaled."""


class View(NamedTuple):
    """What is looked at: half-spaces, which have no end, are drawn there.

    Attributes
    ----------
    middle : ndarray (3,)
    span : float
    """

    middle: Floats
    span: float


class Obstacles:
    """The obstacles on a page."""

    def __init__(self, scene: SceneApi, view: View, on_click: Callable[[int], None] | None = None) -> None:
        self._scene, self._view, self._on_click = scene, view, on_click
        self._groups: dict[tuple[type[Obstacle], bool], tuple[BatchedMeshHandle, int]] = {}
        self._members: dict[tuple[type[Obstacle], bool], list[int]] = {}
        self._singles: dict[int, tuple[Obstacle, bool, SceneNodeHandle]] = {}
        self._rows: dict[Obstacle, tuple[Floats, Floats, Floats]] = {}
        self._shown: tuple[object, int | None] = None, None

    def show(self, obstacles: Sequence[Obstacle], chosen: int | None = None) -> None:
        """Show these obstacles; what stays as it is is not sent again."""
        if self._shown[0] is obstacles and self._shown[1] == chosen:
            return
        self._shown = obstacles, chosen
        self._rows = {each: self._rows.get(each) or _scaled(each) for each in obstacles if type(each) in UNITS}
        members: dict[tuple[type[Obstacle], bool], list[int]] = {}
        singles: list[int] = []
        for i, obstacle in enumerate(obstacles):
            if type(obstacle) in UNITS:
                members.setdefault((type(obstacle), bool(getattr(obstacle, "inside", False))), []).append(i)
            else:
                singles.append(i)
        self._members = members
        for key in [key for key in self._groups if key not in members]:
            self._groups.pop(key)[0].remove()
        for key, own in members.items():
            self._show_group(key, [obstacles[i] for i in own], None if chosen not in own else own.index(chosen))
        for i in [i for i in self._singles if i not in singles]:
            self._singles.pop(i)[2].remove()
        for i in singles:
            self._show_single(i, obstacles[i], i == chosen)

    def _show_group(self, key: tuple[type[Obstacle], bool], own: list[Any], chosen: int | None) -> None:
        places, turns, scales = (
            np.stack(part) for part in zip(*(self._rows[obstacle] for obstacle in own), strict=True)
        )
        colours = np.tile(_linear(GREY), (len(own), 1))
        if chosen is not None:
            colours[chosen] = _linear(CHOSEN)
        arrays: dict[str, Any] = {
            "batched_positions": places.astype(np.float32),
            "batched_wxyzs": turns.astype(np.float32),
            "batched_scales": scales.astype(np.float32),
            "batched_colors": colours,
        }
        known = self._groups.get(key)
        if known is not None and known[1] == len(own):
            for name, values in arrays.items():
                if not np.array_equal(getattr(known[0], name), values):
                    setattr(known[0], name, values)
            return
        solid = UNITS[key[0]]()
        handle = self._scene.add_batched_meshes_simple(
            f"/obstacles/{key[0].__name__}{'_inside' if key[1] else ''}",
            solid.vertices,
            solid.faces,
            lod="off",
            side="back" if key[1] else "front",
            cast_shadow=False,
            receive_shadow=False,
            **arrays,
        )
        self._groups[key] = handle, len(own)
        self._listen(handle, lambda event: self._members[key][event.instance_index or 0])

    def _show_single(self, i: int, obstacle: Obstacle, chosen: bool) -> None:
        known = self._singles.get(i)
        if known is not None:
            if known[0] is obstacle and known[1] == chosen:
                return
            if known[1] == chosen and self._moved(known, obstacle):
                return
            known[2].remove()
        handle = self._single(f"/obstacles/{i}", obstacle, CHOSEN if chosen else GREY)
        self._singles[i] = obstacle, chosen, handle
        self._listen(handle, lambda _: i)

    def _moved(self, known: tuple[Obstacle, bool, SceneNodeHandle], obstacle: Obstacle) -> bool:
        """Move what is shown already, where the same obstacle is elsewhere now; say whether that is so."""
        if known[0].place is None or obstacle.place is None or known[0].place[0] is not obstacle.place[0]:
            return False
        motion = obstacle.place[1] @ np.linalg.inv(known[0].place[1])
        known[2].position, known[2].wxyz = motion[:3, 3], wxyz(motion[:3, :3])
        return True

    def _listen(self, handle: Any, which: Callable[[Any], int]) -> None:
        """Tell which obstacle is clicked on."""
        if self._on_click is None or not hasattr(handle, "on_click"):
            return
        told = self._on_click

        @handle.on_click  # type: ignore[untyped-decorator]
        async def _(event: Any) -> None:
            told(which(event))

    def _single(self, name: str, obstacle: Obstacle, colour: Rgb) -> SceneNodeHandle:
        if isinstance(obstacle, Dotted):
            size = 2.0 * float(obstacle.radii.min()) if isinstance(obstacle, PointCloud) else obstacle.spacing
            return self._scene.add_point_cloud(
                name,
                dots(obstacle),
                colour,
                point_size=max(size, 0.004 * self._view.span),
                point_shape="circle" if isinstance(obstacle, PointCloud) else "square",
                precision="float32",
            )
        solid, flat = _solid(obstacle, self._view)
        see_through = isinstance(obstacle, Mesh | HalfSpace) and not getattr(obstacle, "inside", False)
        return self._scene.add_mesh_simple(
            name,
            solid.vertices,
            solid.faces,
            color=colour,
            opacity=SEE_THROUGH if see_through else None,
            flat_shading=flat,
            side="back" if getattr(obstacle, "inside", False) else "double",
            cast_shadow=False,
            receive_shadow=False,
        )


def _linear(colour: Rgb) -> NDArray[np.uint8]:
    """The colour as nodes of many solids take it: pages show theirs without the gamma of all others."""
    return np.round(255.0 * (np.array(colour) / 255.0) ** 2.2).astype(np.uint8)


def _scaled(obstacle: Any) -> tuple[Floats, Floats, Floats]:
    """Place, quaternion and scale of the unit solid that an obstacle is."""
    center, rotation, half = obstacle.frame
    return center, wxyz(rotation), np.full(3, obstacle.radius) if isinstance(obstacle, Sphere) else half


def _solid(obstacle: Obstacle, view: View) -> tuple[solids.Solid, bool]:
    """Triangles of an obstacle that stands alone, and whether its facets are flat."""
    if isinstance(obstacle, Mesh):
        return solids.Solid(obstacle.vertices, obstacle.faces.astype(np.uint32)), True
    if isinstance(obstacle, Capsule):
        center, rotation, half = obstacle.frame
        local = solids.capsule(obstacle.radius, float(half[2]))
        return solids.Solid(center + local.vertices @ rotation.T, local.faces), False
    if isinstance(obstacle, HalfSpace):
        near = view.middle - (view.middle - obstacle.point) @ obstacle.normal * obstacle.normal
        local = solids.square()
        return solids.Solid(near + view.span * local.vertices @ obstacle.frame.rotation.T, local.faces), True
    raise NotImplementedError(f"no picture of {type(obstacle).__name__}")
