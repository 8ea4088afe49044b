"""The union of all obstacles, and how far points are from it."""

import threading
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sinuous.base import checks
from sinuous.base.arguments import Number, Orientation, Rows, Vector
from sinuous.base.documents import described, plain, write_document
from sinuous.base.errors import InputError
from sinuous.base.frozen import NotebookMixin
from sinuous.model.poses import pose
from sinuous.scene.body_points import body_filter, nothing_of_it
from sinuous.scene.moving import Moving, moved
from sinuous.scene.obstacles import Obstacle, Origin
from sinuous.scene.parts import unsampled
from sinuous.scene.point_cloud import Invalid, PointCloud
from sinuous.scene.snapshot import Snapshot, Surroundings

if TYPE_CHECKING:
    import sinuous as sn


def entries_of(obstacles: Sequence[Obstacle], folder: Path) -> list[dict[str, Any]]:
    """Return obstacles as a problem file in `folder` lists them.

    Those from a file stay there; a mesh of which only some parts are left is written out.

    Raises
    ------
    InputError
        For an obstacle that is a function.
    """
    entries = []
    rest = list(obstacles)
    while rest:
        obstacle, source, parts = rest[0], rest[0].source, 1
        if isinstance(obstacle, Moving):
            parts = _as_one(rest, obstacle)
            still = [each.obstacle for each in rest[:parts] if isinstance(each, Moving)]
            entries += [_with_course(entry, obstacle) for entry in entries_of(still, folder)]
        elif source is not None and _whole(rest, source):
            name = {} if obstacle.name is None else {"name": obstacle.name}
            entries.append({obstacle.kind: source.entry(folder) | name})
            parts = source.parts
        elif obstacle.is_function:
            place = f"scene[{len(obstacles) - len(rest)}]"
            raise InputError(place, "is a function", obstacle, "an obstacle that a file can hold")
        else:
            entries.append({obstacle.kind: described(obstacle)})
        del rest[:parts]
    return entries


def _as_one(rest: Sequence[Obstacle], moving: Moving) -> int:
    """How many obstacles, from the first on, move as one."""
    course = moving.course
    others = (i for i, each in enumerate(rest) if not (isinstance(each, Moving) and each.course is course))
    return next(others, len(rest))


def _with_course(entry: dict[str, Any], moving: Moving) -> dict[str, Any]:
    """Add to what a problem file says of an obstacle where it is over time."""
    places: list[Any] = [plain(place) for place in moving.positions]
    if moving.rotations is not None:
        turns = [plain(turn) for turn in moving.rotations]
        places = [{"position": place, "rotation": turn} for place, turn in zip(places, turns, strict=True)]
    course = [[plain(t), place] for t, place in zip(moving.times.tolist(), places, strict=True)]
    return {kind: {**arguments, "moving": course} for kind, arguments in entry.items()}


def _whole(rest: Sequence[Obstacle], source: Origin) -> bool:
    """Whether obstacles begin with all parts of one file, and have the names that a reader gives them.

    A reader names the parts of a file that was divided, and all obstacles after them.
    """
    together = rest[: source.parts]
    named = source.parts == 1 or all(each.name is not None for each in rest)
    whole = len(together) == source.parts and all(part.source is source for part in together)
    return whole and named and len({part.name for part in together}) == 1


GROWING = ("add", "append", "extend", "insert", "remove")
"""What a list has, and a scene has not."""


class Scene(NotebookMixin, Surroundings):
    """A union of obstacles. Distances are positive outside, negative inside, in the length unit.

    Where obstacles are `Moving`, there are distances and solutions `at` a time only. `track`, `plan` and `Motion` look
    at all times of a motion.

    Nothing of it changes but by `update` and `move`; `snapshot` gives what is there now, frozen. A copy goes on by
    itself.

    Meshes, clouds and grids of cubes are sampled on a grid when the scene is first used, or by `prepare`; large ones
    are kept on disk, in the user's cache directory.

    Parameters
    ----------
    obstacles : Obstacle, or iterable of Obstacle or Scene
        A scene among them gives all its obstacles.

    Raises
    ------
    InputError
        When something among them is neither.
    """

    def __init__(self, obstacles: "Obstacle | Iterable[Obstacle | Scene]" = ()) -> None:
        if isinstance(obstacles, Obstacle):
            obstacles = (obstacles,)
        if isinstance(obstacles, str) or not isinstance(obstacles, Iterable):
            hint = "sinuous.load reads files" if isinstance(obstacles, str) else ""
            raise InputError("scene", hint, obstacles, "a list of obstacles")
        flat: list[Obstacle] = []
        for i, item in enumerate(obstacles):
            if isinstance(item, Scene):
                flat += item.obstacles
            elif isinstance(item, Obstacle):
                flat.append(item)
            else:
                raise InputError(f"scene[{i}]", "", item, "an obstacle or a scene")
        self._lock = threading.Lock()
        self._described: dict[str, Obstacle] = {}
        self._snapshot = Snapshot(tuple(flat))

    @classmethod
    def of(cls, snapshot: Snapshot) -> "Scene":
        """Make a scene that begins with these obstacles; nothing is sampled again."""
        scene = cls()
        scene._snapshot = snapshot
        return scene

    def __getattr__(self, name: str) -> Any:
        if name in GROWING:
            wanted = "sn.Scene([scene, obstacle]) is a new scene with one more, for a new Solver"
            raise AttributeError(f"a Scene has no {name!r}, {wanted}; `update` and `move` change what is in it")
        raise AttributeError(f"'Scene' object has no attribute {name!r}", name=name, obj=self)

    def snapshot(self) -> Snapshot:
        """Return the obstacles as they are now, frozen; the same object until the next update."""
        return self._snapshot

    def at(self, t: Number) -> "Scene":
        """Return the scene as it is at a time, with all obstacles standing still.

        What was computed of meshes, clouds and grids serves for all times.
        """
        return Scene.of(self._snapshot.at(t))

    def prepare(self, progress: Callable[[str, float], object] | None = None) -> None:
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
        self._snapshot.prepare(progress)

    def equals(self, other: object) -> bool:
        """Whether `other` is a scene of equal obstacles in the same order, as both are now."""
        return isinstance(other, Scene) and self.snapshot().equals(other.snapshot())

    def entries(self, folder: str | Path = ".") -> list[dict[str, Any]]:
        """Return the obstacles as a problem file in `folder` lists them.

        Raises
        ------
        InputError
            When an obstacle is neither exact nor from a file.
        """
        return entries_of(self.obstacles, Path(folder))

    def save(self, file: str | Path) -> None:
        """Write the obstacles into a file, JSON when it is called so, YAML otherwise; `sinuous.load` reads it.

        Obstacles that were read from files stay there; the new file names them.

        Raises
        ------
        InputError
            When an obstacle is neither exact nor from a file, or the file cannot be written.
        """
        write_document(file, self.entries(Path(file).parent))

    def update(
        self,
        points: Rows,
        radius: Number | Vector | None = None,
        name: str | None = None,
        *,
        invalid: Invalid = "refuse",
        ignore_robot: "sn.Solution | sn.answer.Equilibrium | tuple[sn.Robot, Rows] | None" = None,
        margin: Number = 0.0,
    ) -> None:
        """Replace a point cloud by what is seen now; a `Solver` made before goes on with the new one.

        A solve that is under way ends with the old one, and a solution keeps the one that it was solved in. The new
        cloud is not sampled: only its tree is built. With no points nothing is there.

        Parameters
        ----------
        points : array_like (m, 3)
        radius : float or array_like (m,), optional
            By default that of the cloud before, which must then be the same for all points.
        name : str, optional
            Of the cloud, when there are several.
        invalid : str
            `refuse` or `drop` points that are not finite.
        ignore_robot : Solution, Equilibrium or (Robot, array_like (n, 3)), optional
            The shape that the robot has: points of its body, which a camera sees, too, are left out.
        margin : float
            How far from that body, and its radius, points still belong to it.

        Raises
        ------
        InputError
            When there is no such cloud, or more than one, or the points are not what they should be.
        """
        width = checks.number("margin", margin, low=0.0)
        own = nothing_of_it if ignore_robot is None else body_filter(ignore_robot, width)
        with self._lock:
            before = self._snapshot
            index, old = _find_cloud(before, name)
            cloud = old.seen_now(points, radius, invalid, own)
            self._snapshot = before.replaced(index, cloud, unsampled(cloud, old))
            self._described.pop(before.name(index), None)

    def move(
        self,
        name: str,
        position: Vector | None = None,
        rotation: Orientation | None = None,
        *,
        xyzw: Vector | None = None,
    ) -> None:
        """Move an obstacle as a whole; a `Solver` made before goes on with it where it is then.

        The pose says where the frame is in which the obstacle was described when it came into the scene, as for
        `Moving`. Nothing of it is computed again, so that meshes and large clouds move as quickly as spheres.

        Parameters
        ----------
        name : str
            Of the obstacle.
        position : array_like (3,), optional
            By default the origin.
        rotation : array_like (3, 3) or (4,), or Rotation of SciPy, optional
            A matrix or a quaternion wxyz.
        xyzw : array_like (4,), optional
            A quaternion in the order of SciPy and ROS, instead of `rotation`.

        Raises
        ------
        InputError
            When no obstacle, or more than one, has this name, it is `Moving`, or the pose is not what it should be.
        """
        there = pose(position, rotation=rotation, xyzw=xyzw)
        with self._lock:
            before = self._snapshot
            found = before._called(name)
            if len(found) != 1 or isinstance(before.obstacles[found[0]], Moving):
                expected = "the name of one obstacle that stands still"
                raise InputError("name", "" if len(found) < 2 else "is that of several", name, expected)
            own = self._described.setdefault(name, before.obstacles[found[0]])
            self._snapshot = before.replaced(found[0], moved(own, there))

    def become(self, snapshot: Snapshot) -> None:
        """Hold these obstacles from now on, as many as before; a `Solver` made before goes on with them.

        Not for methods that look at the scene once and for all, like `opti_path`.

        Raises
        ------
        InputError
            When there are more or fewer of them.
        """
        with self._lock:
            if len(snapshot) != len(self._snapshot):
                raise InputError("snapshot", "", len(snapshot), f"as many obstacles as before: {len(self._snapshot)}")
            self._snapshot = snapshot
            self._described.clear()

    def __getstate__(self) -> tuple[Snapshot, dict[str, Obstacle]]:
        return self._snapshot, dict(self._described)

    def __setstate__(self, state: tuple[Snapshot, dict[str, Obstacle]]) -> None:
        self._snapshot, self._described = state
        self._lock = threading.Lock()


def _find_cloud(snapshot: Snapshot, name: str | None) -> tuple[int, PointCloud]:
    """Find the only point cloud, or the one of this name."""
    clouds = [(i, obstacle) for i, obstacle in enumerate(snapshot.obstacles) if isinstance(obstacle, PointCloud)]
    names = [snapshot.name(i) for i, _ in clouds]
    found = [cloud for cloud, own in zip(clouds, names, strict=True) if name in (None, own)]
    if len(found) != 1:
        problem = "names no point cloud" if not found else "leaves open which point cloud"
        raise InputError("name", problem, name, f"one of {', '.join(names)}" if names else "a scene with a point cloud")
    return found[0]


SceneLike = Scene | Obstacle | Iterable[Obstacle | Scene]
"""What may be given for a scene."""


def as_scene(scene: SceneLike | None) -> Scene:
    """Check a scene; `None` is the empty one, an obstacle one of it alone, a list of obstacles their union."""
    if scene is None:
        return Scene()
    return scene if isinstance(scene, Scene) else Scene(scene)


def as_snapshot(scene: SceneLike | Snapshot | None) -> Snapshot:
    """Check a scene, and take its obstacles as they are now."""
    return scene if isinstance(scene, Snapshot) else as_scene(scene).snapshot()
