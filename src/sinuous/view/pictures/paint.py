"""Facets with colours: lit from above, sorted together by depth, and see-through where they hide a robot.

Facets are arrays (m, 4, 3) of corners in the world, counterclockwise as seen from outside. Matplotlib sorts them by the
distance of their middles, so none may be long. A triangle repeats its last corner.
"""

from typing import Any, NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.scene.mesh import Mesh
from sinuous.scene.obstacles import Obstacle, Primitive
from sinuous.view.display.bounds import Bounds, direction_of
from sinuous.view.display.contents import Arm
from sinuous.view.display.style import METAL, OBSTACLE, THINNEST_SHARE, Viewpoint
from sinuous.view.display.surfaces import FACES_AROUND, BodySurface, Dotted, Surface, obstacle_surface
from sinuous.view.pictures.figures import screen_axes

MOST_TRIANGLES = 12_000
"""Triangles of a mesh that are drawn; of more, vertices that fall together on a grid become one."""

FINEST, COARSEST = 96, 12
"""Cells of that grid along the longest side of the mesh."""

ROUNDING = 1e-9
"""How far corners in a plane may be off, as a share of the extent of the facets."""

LONGEST_SHARE = 0.1
"""Longest side of a facet of a mesh, as a share of the longest side of the mesh."""


def facets_of_mesh(surface: Surface, both: bool) -> Floats:
    """Small facets of a mesh of triangles; `both`: for both sides."""
    drawn = surface if len(surface.faces) <= MOST_TRIANGLES else _thinned(surface)
    facets = split_facets(drawn.facets, LONGEST_SHARE * float(np.ptp(drawn.vertices, axis=0).max()))
    return np.concatenate([facets, facets[:, [2, 1, 0, 0]]]) if both else facets


def _thinned(surface: Surface, cells: int = FINEST) -> Surface:
    """Return a mesh of so few triangles that a picture can have them: vertices in a cell of a grid are their mean."""
    vertices = surface.vertices
    low, edge = vertices.min(axis=0), np.ptp(vertices, axis=0).max() / cells
    places = np.floor((vertices - low) / edge).astype(np.int64)
    _, group, count = np.unique(places, axis=0, return_inverse=True, return_counts=True)
    group = group.ravel()
    sums = np.zeros((len(count), 3))
    np.add.at(sums, group, vertices)
    faces = group[surface.faces]
    a, b, c, _ = faces.T
    thin = Surface(sums / count[:, None], faces[(a != b) & (b != c) & (c != a)])
    return _thinned(surface, 3 * cells // 4) if len(thin.faces) > MOST_TRIANGLES and cells > COARSEST else thin


def normals_of(facets: Floats) -> Floats:
    """Outward unit normals (m, 3) of facets; zero for a facet without area."""
    across = np.cross(facets[:, 2] - facets[:, 0], facets[:, 3] - facets[:, 1])
    return across / np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), 1e-300)


def split_facets(facets: Floats, longest: float) -> Floats:
    """Cut facets in four until no side is longer."""
    whole = []
    while len(facets):
        sides = np.linalg.norm(np.roll(facets, -1, axis=1) - facets, axis=-1).max(axis=1)
        whole.append(facets[sides <= longest])
        rest = facets[sides > longest]
        triangle = (rest[:, 2] == rest[:, 3]).all(axis=-1)
        facets = np.concatenate([_quarters(rest[~triangle], 4), _quarters(rest[triangle, :3], 3)])
    return np.concatenate(whole) if whole else facets


def _quarters(corners: Floats, count: int) -> Floats:
    """Cut triangles (m, 3, 3) or quadrangles (m, 4, 3) in four."""
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    if count == 3:
        parts = [np.stack([corners[:, i], middles[:, i], middles[:, i - 1]], axis=1) for i in range(3)]
        return np.concatenate([*parts, middles])[:, [0, 1, 2, 2]]
    center = corners.mean(axis=1)
    parts = [np.stack([corners[:, i], middles[:, i], center, middles[:, i - 1]], axis=1) for i in range(4)]
    return np.concatenate(parts)


def clip_facets(facets: Floats, low: Floats, high: Floats, solid: bool = False) -> Floats:
    """What of the facets is within a box; those that cross its sides are cut there (Sutherland & Hodgman 1974).

    Those of a convex `solid` are closed again where it is cut.
    """
    for axis in range(3):
        for side, limit in ((1.0, low[axis]), (-1.0, high[axis])):
            facets = _cut_off(facets, axis, side, limit, solid)
    return facets


def _cut_off(facets: Floats, axis: int, side: float, limit: float, solid: bool) -> Floats:
    """What of facets is on one side of a plane across an axis; of a convex solid with a face in the plane."""
    heights = side * (facets[..., axis] - limit)
    below, above = heights.min(axis=1), heights.max(axis=1)
    if not len(facets) or below.min() >= 0.0:
        return facets
    crossed = (below < 0.0) & (above > 0.0)
    polygons = [_above(corners, own) for corners, own in zip(facets[crossed], heights[crossed], strict=True)]
    kept = np.concatenate([facets[below >= 0.0], *(_fan(polygon) for polygon in polygons if len(polygon) > 2)])
    corners = kept.reshape(-1, 3)
    rim = corners[np.abs(corners[:, axis] - limit) < ROUNDING * np.ptp(facets, axis=(0, 1)).max()]
    if not solid or len(rim) < 3:
        return kept
    across, up = (rim[:, (axis + k) % 3] - rim[:, (axis + k) % 3].mean() for k in (1, 2))
    return np.concatenate([kept, _fan(rim[np.argsort(-side * np.arctan2(up, across), kind="stable")])])


def _above(polygon: Floats, heights: Floats) -> Floats:
    """Return the part of a convex polygon (k, 3) whose heights (k,) over a plane are not below 0."""
    kept = []
    for k in range(len(polygon)):
        if heights[k] >= 0.0:
            kept.append(polygon[k])
        after = (k + 1) % len(polygon)
        if heights[k] * heights[after] < 0.0:
            share = heights[k] / (heights[k] - heights[after])
            kept.append(polygon[k] + share * (polygon[after] - polygon[k]))
    return np.array(kept).reshape(-1, 3)


def _fan(polygon: Floats) -> Floats:
    """Facets (m, 4, 3) of a convex polygon (k, 3)."""
    last = len(polygon) - 1
    return np.array([polygon[[0, k, min(k + 1, last), min(k + 2, last)]] for k in range(1, last, 2)])


SOLID, SEE_THROUGH = 1.0, 0.22
"""Opacity of obstacles, and of what of them is in front of a robot."""

NEAR_RADII, FAR_RADII = 1.6, 4.0
"""What is in front of the body within so many radii on the screen is see-through; beyond the other it is solid."""

GHOST = 0.22
"""Opacity of shapes on the way."""

BODY_FACETS_AROUND = 20
"""Facets around the body."""

MANY_OBSTACLES, FEWER_AROUND = 12, 22
"""From so many obstacles on, each has fewer facets around."""

CLIPPED_SHARE = 0.06
"""Longest side of the facets of an obstacle that goes on beyond the picture, as a share of the picture."""

MOST_VECTORS = 6_000
"""Facets of a picture of lines (PDF, SVG); more are drawn as pixels there."""


class Painted(NamedTuple):
    """Facets (m, 4, 3) and their colours (m, 4) with opacity."""

    facets: Floats
    colours: Floats


class Walls(NamedTuple):
    """An obstacle's facets, and whether each becomes see-through by itself, or all of them together."""

    facets: Floats
    each: bool


def obstacle_walls(obstacles: list[Obstacle], bounds: Bounds) -> list[Walls]:
    """Facets of obstacles that have a surface, within the bounds."""
    around = FACES_AROUND if len(obstacles) < MANY_OBSTACLES else FEWER_AROUND
    walls = []
    for obstacle in obstacles:
        if not isinstance(obstacle, Dotted):
            surface = obstacle_surface(obstacle, bounds.middle, 2.0 * bounds.span, around)
            facets = facets_of_mesh(surface, not obstacle.watertight) if isinstance(obstacle, Mesh) else surface.facets
            if (facets < bounds.low).any() or (facets > bounds.high).any():
                # Rooms, half-spaces and meshes stay open where the picture cuts them.
                solid = isinstance(obstacle, Primitive) and obstacle._box is not None and not obstacle.inside
                facets = split_facets(clip_facets(facets, bounds.low, bounds.high, solid), CLIPPED_SHARE * bounds.span)
            walls.append(Walls(facets, isinstance(obstacle, Mesh)))
    return walls


def places_of(arms: list[Arm], bounds: Bounds) -> tuple[Floats, float]:
    """Places (m, 3) of bodies, and the largest of their radii as drawn; ghosts may be hidden."""
    bodies = [arm for arm in arms if not arm.ghost]
    places = [arm.robot.backbone(arm.q) for arm in bodies]
    thickest = max((max(arm.robot.radii) for arm in bodies), default=0.0)
    return np.concatenate(places) if places else np.empty((0, 3)), max(thickest, 0.01 * bounds.span)


def paint_arms(arms: list[Arm], bounds: Bounds, view: Viewpoint) -> list[Painted]:
    """Facets of bodies, those of each robot in tones of its own."""
    return [part for arm in arms for part in paint_arm(arm, bounds, view)]


def paint_arm(arm: Arm, bounds: Bounds, view: Viewpoint) -> list[Painted]:
    """Facets of a body that are seen. A ghost has no fittings."""
    surface = BodySurface(arm.robot, THINNEST_SHARE * bounds.span, BODY_FACETS_AROUND, fittings=not arm.ghost)
    own, opacity = arm.colours, GHOST if arm.ghost else SOLID
    colours = [METAL if part.segment is None else own[part.segment] for part in surface.parts]
    drawn = zip(surface.facets(arm.q), colours, strict=True)
    return [lit(facets, colour, opacity, view) for facets, colour in drawn]


def paint_walls(walls: list[Walls], bodies: Floats, radius: float, view: Viewpoint) -> list[Painted]:
    """Facets of obstacles that are seen. `bodies` (m, 3) are places of robots of this radius, which they may hide."""
    painted = []
    for facets, each in walls:
        hidden = _hiding(facets, bodies, radius, view)
        most = hidden.max(initial=0.0)
        back = each and most > 0.0  # the back of a wall is seen through what of it is see-through
        own = hidden if each else np.full(len(facets), most)
        painted.append(lit(facets, OBSTACLE, SOLID, view, back=back, hidden=own))
    return painted


def add_facets(axes: Any, painted: list[Painted]) -> Any:
    """Put all facets into one collection of the axes, so that they are sorted together; return it."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # noqa: PLC0415

    if not painted:
        return None
    facets, colours = (np.concatenate(list(arrays)) for arrays in zip(*painted, strict=True))
    seams = colours.copy()
    seams[seams[:, 3] < SOLID, 3] = 0.0  # two layers of a see-through colour would show every seam
    pixels = len(facets) > MOST_VECTORS
    drawn = Poly3DCollection(facets, facecolors=colours, edgecolors=seams, linewidths=0.4, zorder=2, rasterized=pixels)
    return axes.add_collection3d(drawn)


def lit(
    facets: Floats, colour: str, opacity: float, view: Viewpoint, *, back: bool = False, hidden: Floats | None = None
) -> Painted:
    """Facets that face the viewer (`back`: others too) under a light from above the viewer's left shoulder."""
    from matplotlib.colors import to_rgb  # noqa: PLC0415

    facing = normals_of(facets)
    seen = np.full(len(facets), True) if back else facing @ direction_of(view) > -0.05
    facing = facing[seen] * np.where(facing[seen] @ direction_of(view) < -0.05, -0.6, 1.0)[:, None]
    light = 0.5 + 0.5 * facing @ direction_of(Viewpoint(50.0, view.azimuth - 40.0))
    base = np.array(to_rgb(colour))
    shades = base * (0.5 + 0.5 * light[:, None]) + 0.3 * (1.0 - base) * light[:, None] ** 4
    alpha = np.full(len(shades), opacity)
    if hidden is not None:
        alpha += (SEE_THROUGH - opacity) * hidden[seen]
    return Painted(facets[seen], np.concatenate([shades, alpha[:, None]], axis=-1))


def _hiding(facets: Floats, bodies: Floats, radius: float, view: Viewpoint) -> Floats:
    """How far each facet (m,) must be see-through: 1 in front of a body, 0 away from all of them."""
    if not len(bodies) or not len(facets):
        return np.zeros(len(facets))
    from scipy.spatial import cKDTree  # noqa: PLC0415

    middles, toward = facets.mean(axis=1), direction_of(view)
    tree = cKDTree(bodies @ screen_axes(view).T)
    count = min(len(bodies), 8)
    seen, far = middles @ screen_axes(view).T, FAR_RADII * radius
    apart, which = tree.query(seen, k=[*range(1, count + 1)], distance_upper_bound=far)
    depth = np.append(bodies @ toward, np.inf)  # one more for neighbours that are not there
    front = (middles @ toward)[:, None] > depth[which] - 0.5 * radius
    share = np.clip((far - apart) / ((FAR_RADII - NEAR_RADII) * radius), 0.0, 1.0)
    return np.where(front, share, 0.0).max(axis=1)
