"""The union of all obstacles, and how far points are from it."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.scene.obstacles import Obstacle, Primitive

WIDTH = 18


class Scene:
    """A union of obstacles; frozen. Distances are positive outside, negative inside, in the length unit.

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
        self.obstacles: tuple[Obstacle, ...] = tuple(flat)
        self.table: Floats = np.array([o.row for o in flat if isinstance(o, Primitive)]).reshape(-1, WIDTH)
        self.table.flags.writeable = False

    def __len__(self) -> int:
        return len(self.obstacles)

    def __repr__(self) -> str:
        return f"Scene({len(self)} obstacles)"

    def name(self, index: int) -> str:
        """Name of an obstacle; one that has none is called by its kind and place in the list, like `sphere[3]`."""
        obstacle = self.obstacles[index]
        kind = "".join(f"_{c.lower()}" if c.isupper() else c for c in type(obstacle).__name__).lstrip("_")
        return obstacle.name or f"{kind}[{index}]"

    def distance(self, points: Any) -> Floats:
        """Signed distance (...) of points (..., 3) to the nearest obstacle; infinite in an empty scene."""
        return self._query(points)[0]

    def gradient(self, points: Any) -> Floats:
        """Gradient (..., 3) of the distance at points (..., 3): a unit vector away from the nearest obstacle.

        Where the distance has a kink one of its sides is given; zero in an empty scene.
        """
        return self._query(points)[1]

    def nearest(self, points: Any) -> NDArray[np.int64]:
        """Index (...) of the obstacle nearest to points (..., 3); -1 in an empty scene."""
        return self._query(points)[2]

    def _query(self, points: Any) -> tuple[Floats, Floats, NDArray[np.int64]]:
        from sinuous.kernels import distances  # noqa: PLC0415

        checked = checks.stack("points", points, (3,))
        flat = checked.reshape(-1, 3).copy()
        values, gradients, which = np.empty(len(flat)), np.empty(flat.shape), np.empty(len(flat), np.int64)
        distances.many(self.table, flat, values, gradients, which)
        lead = checked.shape[:-1]
        return values.reshape(lead), gradients.reshape(*lead, 3), which.reshape(lead)
