"""The union of all obstacles, and how far points are from it."""

import threading
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.scene import tables
from sinuous.scene.clouds.point_cloud import PointCloud
from sinuous.scene.grids.field import Field, evaluate
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.tables import WIDTH, Part, Tables

__all__ = ["WIDTH", "Scene"]

DIFFERENCE = 1e-4
"""Step of the differences that stand for the gradient of a `Field`, in units of its spacing."""

_LOCK = threading.RLock()
"""Held by whoever changes a scene; readers need none."""


class _Contents(NamedTuple):
    """All of a scene, replaced as one."""

    obstacles: tuple[Obstacle, ...]
    parts: tuple[Part, ...]
    tables: Tables | None


class Scene:
    """A union of obstacles. Distances are positive outside, negative inside, in the length unit.

    Nothing of it changes but by `update`. Meshes, clouds and grids of cubes are sampled on a grid when the scene is
    first used, or by `prepare`; large ones are kept on disk, in the user's cache directory.

    Parameters
    ----------
    obstacles : iterable of Obstacle or Scene
        A scene among them gives all its obstacles.

    Raises
    ------
    InputError
        When something among them is neither.
    """

    def __init__(self, obstacles: Iterable["Obstacle | Scene"] = ()) -> None:
        if not isinstance(obstacles, Iterable):
            raise InputError("scene", "of the wrong kind", obstacles, "a list of obstacles")
        flat: list[Obstacle] = []
        for i, item in enumerate(obstacles):
            if isinstance(item, Scene):
                flat += item.obstacles
            elif isinstance(item, Obstacle):
                flat.append(item)
            else:
                raise InputError(f"scene[{i}]", "of the wrong kind", item, "an obstacle or a scene")
        self._contents = _Contents(tuple(flat), (), None)

    @property
    def obstacles(self) -> tuple[Obstacle, ...]:
        """All obstacles, as they are now."""
        return self._contents.obstacles

    @property
    def tables(self) -> Tables:
        """Rows (m, 18) and store (s,) for the kernels, as they are now; not to be changed."""
        return self._contents.tables or self._prepared(None)

    @property
    def table(self) -> Floats:
        """Rows (m, 18) for the kernels, read-only."""
        rows = self.tables[0].view()
        rows.flags.writeable = False
        return rows

    @property
    def memory(self) -> int:
        """Bytes that the kernels read: at most 16 MB of samples an obstacle, and some 350 bytes a triangle."""
        return sum(array.nbytes for array in self.tables)

    def __len__(self) -> int:
        return len(self.obstacles)

    def __repr__(self) -> str:
        return f"Scene({len(self)} obstacles)"

    def name(self, index: int) -> str:
        """Name of an obstacle; one that has none is called by its kind and place in the list, like `sphere[3]`."""
        return _name(self.obstacles, index)

    def prepare(self, progress: Callable[[str, float], None] | None = None) -> None:
        """Compute what solving needs to know of meshes, clouds and grids; without this, the first use does.

        Parameters
        ----------
        progress : callable, optional
            Called again and again with the name of an obstacle and the share of it that is done, 0 to 1.

        Raises
        ------
        InputError
            When a mesh cuts through itself, so that its inside is not defined.
        """
        self._prepared(progress)

    def _prepared(self, progress: Callable[[str, float], None] | None) -> Tables:
        with _LOCK:
            obstacles, _, joined = self._contents
            if joined is None:
                parts = tuple(_part(obstacles, i, progress) for i in range(len(obstacles)))
                joined = tables.join(parts)
                self._contents = _Contents(obstacles, parts, joined)
            return joined

    def _now(self) -> tuple[tuple[Obstacle, ...], Tables]:
        """Obstacles and tables that belong together."""
        contents = self._contents
        return (contents.obstacles, contents.tables) if contents.tables else (self.obstacles, self._prepared(None))

    def update(self, points: Any, radius: Any = None, name: str | None = None) -> None:
        """Replace a point cloud by what is seen now; a `Solver` made before goes on with the new one.

        A solve that is under way ends with the old one. The new cloud is not sampled: only its tree is built.

        Parameters
        ----------
        points : array_like (m, 3)
        radius : float or array_like (m,), optional
            By default that of the cloud before, which must then be the same for all points.
        name : str, optional
            Of the cloud, when there are several.

        Raises
        ------
        InputError
            When there is no such cloud, or more than one, or the points are not what they should be.
        """
        with _LOCK:
            self._prepared(None)
            obstacles, parts, _ = self._contents
            index, old = _find_cloud(obstacles, name)
            if radius is None and (old.radii != old.radii[0]).any():
                raise InputError("radius", "missing", None, "one for every point: those before differ")
            cloud = PointCloud(points, old.radii[0] if radius is None else radius, name=old.name)
            swapped = (*parts[:index], tables.live(cloud), *parts[index + 1 :])
            replaced = (*obstacles[:index], cloud, *obstacles[index + 1 :])
            self._contents = _Contents(replaced, swapped, tables.join(swapped))

    def distance(self, points: Any) -> Floats:
        """Signed distance (...) of points (..., 3) to the nearest obstacle; infinite in an empty scene.

        Exact: no samples are interpolated, and a `Field` is asked itself. Of a `Grid` of distances nothing more is
        known than its samples; there it is the most that they prove.
        """
        return self._query(points)[0]

    def at_most(self, points: Any) -> Floats:
        """Upper bound (...) of the distance of points (..., 3): the same, but near a `Grid` of distances."""
        return self._query(points)[3]

    def gradient(self, points: Any) -> Floats:
        """Gradient (..., 3) of the distance at points (..., 3): a unit vector away from the nearest obstacle.

        Where the distance has a kink one of its sides is given; zero in an empty scene. That of a `Field` is taken by
        differences, that of a `Grid` of distances by interpolation; they need not be of length 1.
        """
        return self._query(points)[1]

    def nearest(self, points: Any) -> NDArray[np.int64]:
        """Index (...) of the obstacle nearest to points (..., 3); -1 in an empty scene."""
        return self._query(points)[2]

    def _query(self, points: Any) -> tuple[Floats, Floats, NDArray[np.int64], Floats]:
        from sinuous.kernels.fields import distances  # noqa: PLC0415

        checked = checks.stack("points", points, (3,))
        flat = checked.reshape(-1, 3).copy()
        values, gradients, which = np.empty(len(flat)), np.empty(flat.shape), np.empty(len(flat), np.int64)
        obstacles, (rows, store) = self._now()
        fields = {i: obstacle for i, obstacle in enumerate(obstacles) if isinstance(obstacle, Field)}
        others = np.array([i for i in range(len(rows)) if i not in fields], np.int64)
        above = np.empty(len(flat))
        distances.many(rows[others], store, flat, values, above, gradients, which)
        which = np.where(which >= 0, others[which] if len(others) else -1, -1)
        for i, field in fields.items():
            _ask_field(field, i, flat, values, above, gradients, which)
        lead = checked.shape[:-1]
        return values.reshape(lead), gradients.reshape(*lead, 3), which.reshape(lead), above.reshape(lead)


def _name(obstacles: tuple[Obstacle, ...], index: int) -> str:
    return obstacles[index].name or f"{obstacles[index].kind}[{index}]"


def _part(obstacles: tuple[Obstacle, ...], index: int, progress: Callable[[str, float], None] | None) -> Part:
    name = _name(obstacles, index)
    return tables.prepare(obstacles[index], name, None if progress is None else partial(progress, name))


def _find_cloud(obstacles: tuple[Obstacle, ...], name: str | None) -> tuple[int, PointCloud]:
    """Find the only point cloud, or the one of this name."""
    clouds = [(i, obstacle) for i, obstacle in enumerate(obstacles) if isinstance(obstacle, PointCloud)]
    names = [_name(obstacles, i) for i, _ in clouds]
    found = [cloud for cloud, own in zip(clouds, names, strict=True) if name in (None, own)]
    if len(found) != 1:
        problem = "names no point cloud" if not found else "leaves open which point cloud"
        raise InputError("name", problem, name, f"one of {', '.join(names)}" if names else "a scene with a point cloud")
    return found[0]


def _ask_field(
    field: Field, index: int, points: Floats, values: Floats, above: Floats, gradients: Floats, which: NDArray[np.int64]
) -> None:
    """Put in the distance to a field where it is the nearest obstacle."""
    own = evaluate(field.function, points)
    np.minimum(above, own, out=above)
    nearer = own < values
    values[nearer], which[nearer] = own[nearer], index
    step = DIFFERENCE * field.spacing
    for axis, way in enumerate(step * np.eye(3)):
        if nearer.any():
            beyond, before = (evaluate(field.function, points[nearer] + sign * way) for sign in (1.0, -1.0))
            gradients[nearer, axis] = (beyond - before) / (2.0 * step)
