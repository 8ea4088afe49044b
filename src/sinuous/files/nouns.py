"""From plain values to nouns: robot, obstacles, their trajectories, targets and configurations as files say them.

At the end stands what a problem file says: a robot, what stands around it, and perhaps one question about it.

The parameters of the constructor of a noun are the keys that may stand in its mapping.
"""

from collections.abc import Callable, Iterable, Mapping
from functools import cache, partial
from inspect import Parameter
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np

from sinuous.base import checks
from sinuous.base.checks import MOST_SEGMENTS, Floats, few, segment_number
from sinuous.base.errors import WANTED, InputError, suggested
from sinuous.base.frozen import parameters
from sinuous.base.text_tables import axis_of, read_table
from sinuous.files.documents import join, parse_json, read_part, read_text
from sinuous.files.urdf_joints import read_joints
from sinuous.model.actuators import Actuators, Chambers, Stage, Tendons
from sinuous.model.joints import Fixed, Joint, Prismatic, Revolute
from sinuous.model.loads import Payload
from sinuous.model.poses import pose
from sinuous.model.rates import Rates
from sinuous.model.robot import Robot, Uncertainty
from sinuous.model.segment import Segment, Stiffness
from sinuous.problem.problem import Preferences
from sinuous.problem.target import Target, Tolerance, Workspace, target_list
from sinuous.scene.grids import Grid
from sinuous.scene.mesh import Mesh
from sinuous.scene.moving import Course, Moving
from sinuous.scene.obstacles import PRIMITIVES, Obstacle
from sinuous.scene.point_cloud import PointCloud
from sinuous.scene.scene import Scene

Noun = TypeVar("Noun")

FROM_FILES: dict[str, Callable[..., Obstacle]] = {"mesh": Mesh.load, "points": PointCloud.load, "grid": Grid.load}
"""Obstacles of which the problem file says in which file they are."""

FROM_ARRAYS: dict[str, tuple[str, Callable[..., Obstacle]]] = {
    "mesh": ("vertices", Mesh),
    "points": ("points", PointCloud),
    "grid": ("values", Grid),
}
"""The same, where the problem file holds them itself: the key that says so, and the noun."""

DRIVES: dict[str, Callable[..., Tendons | Chambers | Stage]] = {
    "tendons": Tendons,
    "chambers": Chambers,
    "stage": Stage,
}
"""What drives a segment."""

MOVING = "moving"
"""Key of an obstacle under which its trajectory stands."""

TRAJECTORY_COLUMNS = "t,x,y,z or t,x,y,z,qw,qx,qy,qz or t,x,y,z,qx,qy,qz,qw"
"""Columns that the table of a trajectory may have."""

SHARED = ("radius", "stiffness", "mass", "arcs")
"""Keys of a robot that stand for those of its segments."""

VECTORS = {"position", "direction", "rotation", "xyzw"}
"""Keys of a target that hold numbers in a list."""


def make(constructor: Callable[..., Noun], value: Any, parts: Mapping[str, Callable[[Any], Any]] | None = None) -> Noun:
    """Call `constructor` with the entries of the mapping `value` as arguments.

    Parameters
    ----------
    constructor : callable
        Its parameters are the keys; those without a default are required.
    value : object
        What the file says; only a mapping is right.
    parts : mapping of callables, optional
        For keys whose values are not plain: how to read them.

    Raises
    ------
    InputError
        When a key is unknown or missing, or when `constructor` or one of `parts` refuses a value.
    """
    entries = known_entries(value, *keys_of(constructor))
    for key, read in (parts or {}).items():
        if entries.get(key) is not None:
            with checks.inside(key):
                entries[key] = read(entries[key])
    return constructor(**entries)


def read_each(read: Callable[[Any], Noun], entries: Iterable[Any]) -> list[Noun]:
    """Read the entries of a list one after the other; a refusal names the place."""
    result = []
    for i, entry in enumerate(entries):
        with checks.inside(f"[{i}]"):
            result.append(read(entry))
    return result


@cache
def keys_of(constructor: Callable[..., Any]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of all parameters, and of those that have no default."""
    known = parameters(constructor)
    return tuple(name for name, _ in known), tuple(name for name, default in known if default is Parameter.empty)


def known_entries(value: Any, known: Iterable[str], required: Iterable[str] = ()) -> dict[str, Any]:
    """Return a copy of a mapping that has all `required` keys and none that is not `known`."""
    names = tuple(known)
    if not isinstance(value, dict):
        raise InputError("", "", value, "a mapping with " + ", ".join(names))
    for key, entry in value.items():
        if key not in names:
            raise InputError(join("", key), "unknown key", entry, suggested(key, names))
    for key in required:
        if key not in value:
            raise InputError(key, "missing", value, WANTED.get(key, "a value"))
    return dict(value)


def read_robot(value: Any, folder: Path = Path()) -> Robot:
    """Read the mapping of a robot; what is in `SHARED` is that of every segment that has none of its own.

    Names of files are relative to `folder`.
    """
    needed = [] if isinstance(value, dict) and value.get("joints") is not None else ["segments"]
    entries = known_entries(value, keys_of(Robot)[0], needed)
    shared = {key: entries.pop(key) for key in SHARED if entries.get(key) is not None}
    checks.number("radius", shared.setdefault("radius", 0.0), low=0.0)
    with checks.inside("segments"):
        entries["segments"] = _read_segments(entries["segments"], shared) if "segments" in entries else []
    read_pose = partial(make, pose)
    parts: dict[str, Callable[[Any], Any]] = {
        "joints": partial(_read_joints, folder=folder),
        "base": read_pose,
        "tool": read_pose,
        "actuators": partial(make, Actuators),
        "payload": lambda own: read_each(partial(make, Payload), own if isinstance(own, list) else [own]),
        "uncertainty": partial(make, Uncertainty),
    }
    return make(Robot, entries, parts)


def _read_joints(value: Any, folder: Path) -> list[Joint]:
    """Read a list of joints, or which chain of a URDF they are."""
    if isinstance(value, dict):
        files = {key: lambda name: folder / checks.text("", name) for key in ("urdf", "srdf")}
        return make(read_joints, value, files)
    return read_each(_read_joint, _list_of("joints", value))


def _read_joint(value: Any) -> Joint:
    kinds = {kind.__name__.lower(): kind for kind in (Revolute, Prismatic, Fixed)}
    kind, description = _one_of(kinds, value)
    with checks.inside(kind):
        joint: Joint = make(kinds[kind], description, {"origin": _read_place_or_pose})
    return joint


def _one_of(kinds: Iterable[str], value: Any) -> tuple[str, Any]:
    """Return the only entry of a mapping, whose key is one of some kinds."""
    entries = known_entries(value, kinds)
    if len(entries) != 1:
        raise InputError("", "", value, "one of " + ", ".join(kinds))
    ((kind, description),) = entries.items()
    return kind, description


def _read_segments(value: Any, shared: dict[str, Any]) -> list[Segment]:
    if isinstance(value, dict):
        return _read_equal_segments(value, shared)
    segments: list[Segment] = []
    for i, entry in enumerate(_list_of("segments", value)):
        with checks.inside(f"[{i}]"):
            segments += _read_equal_segments(entry, shared)
        if len(segments) > MOST_SEGMENTS:
            raise InputError("", "", len(segments), f"at most {MOST_SEGMENTS} segments in all")
    return segments


def _read_equal_segments(value: Any, shared: dict[str, Any]) -> list[Segment]:
    keys, required = keys_of(Segment)
    entries = shared | known_entries(value, ("count", *keys), required)
    count = checks.integer("count", entries.pop("count", 1), 1, MOST_SEGMENTS)
    parts: dict[str, Callable[[Any], Any]] = {key: partial(make, noun) for key, noun in DRIVES.items()}
    parts["stiffness"] = lambda own: make(Stiffness, own) if isinstance(own, dict) else own
    return [make(Segment, entries, parts)] * count


def read_scene(value: Any, robot: Robot | None, folder: Path) -> Scene:
    """Read a list of obstacles; nothing is the empty scene. Names of files are relative to `folder`.

    With a robot, meshes that must be in another length unit are refused.
    """
    obstacles: list[Obstacle] = []
    for i, entry in enumerate([] if value is None else _list_of("obstacles", value, least=0)):
        with checks.inside(f"[{i}]"):
            parts = _read_obstacles(entry, robot, folder)
        if len(parts) > 1 or len(obstacles) > i:  # places in the scene are no longer those in the file
            parts = [part if part.name else part.named(f"{part.kind}[{i}]") for part in parts]
        obstacles += parts
    return Scene(obstacles)


def read_place(entries: dict[str, Any], folder: Path) -> tuple[Robot, Scene]:
    """Read the robot and the scene of a problem, each here or in a file of its own."""
    robot = read_part("robot", entries["robot"], folder, read_robot)
    return robot, read_part("scene", entries.get("scene"), folder, lambda own, inner: read_scene(own, robot, inner))


def _read_obstacles(value: Any, robot: Robot | None, folder: Path) -> list[Obstacle]:
    """Read one obstacle; a mesh of bodies that overlap becomes several."""
    kind, description = _one_of((*PRIMITIVES, *FROM_FILES), value)
    with checks.inside(kind):
        if isinstance(description, dict) and MOVING in description:
            still = {key: value for key, value in description.items() if key != MOVING}
            with checks.inside(MOVING):
                trajectory = _read_trajectory(description[MOVING], folder)
            return [Moving.along(part, trajectory) for part in _read_kind(kind, still, robot, folder)]
        return _read_kind(kind, description, robot, folder)


def _read_kind(kind: str, description: Any, robot: Robot | None, folder: Path) -> list[Obstacle]:
    """Read one obstacle of a kind; what is refused is a key of its description."""
    if kind in PRIMITIVES:
        return [make(PRIMITIVES[kind], description)]
    array, noun = FROM_ARRAYS[kind]
    if isinstance(description, dict) and array in description:
        return [make(noun, description)]
    obstacle = make(FROM_FILES[kind], description, {"file": lambda name: folder / checks.text("", name)})
    if not isinstance(obstacle, Mesh):
        return [obstacle]
    if robot is not None:
        obstacle.check_size(robot.mean_length)
    return [*obstacle.bodies()]


def _read_trajectory(value: Any, folder: Path) -> Course:
    """Read a list of `[time, pose]`, or the CSV file of this name, relative to `folder`."""
    if isinstance(value, str):
        file = folder / value
        text = read_text(file, "")
        with checks.in_file(file):
            return _trajectory_of_table(text)
    if not isinstance(value, list) or not value:
        raise InputError("", "", value, "a list of [time, pose] or the name of a CSV file")
    times, poses = [], []
    for i, entry in enumerate(value):
        with checks.inside(f"[{i}]"):
            if not isinstance(entry, list) or len(entry) != 2:
                raise InputError("", "", entry, "[time, pose]")
            times.append(checks.number("[0]", entry[0]))
            if len(times) > 1 and times[-1] <= times[-2]:
                raise InputError("[0]", "times must increase", times[-1], f"more than {times[-2]:g}")
            with checks.inside("[1]"):
                poses.append(_read_place_or_pose(entry[1]))
    matrices = np.stack(poses)
    turned = bool((matrices[:, :3, :3] != np.eye(3)).any())
    return _trajectory(np.array(times), matrices[:, :3, 3].copy(), matrices[:, :3, :3].copy() if turned else None)


def _read_place_or_pose(value: Any) -> Floats:
    """Read a position, or a mapping with position and orientation, as a pose (4, 4)."""
    if isinstance(value, dict):
        return make(pose, value)
    return pose(checks.array("", value, (3,), "[x, y, z] or a mapping with position and rotation"))


def _trajectory_of_table(text: str) -> Course:
    table = parse_path(text)
    if table.times is None or table.targets[0].direction is not None:
        raise InputError("line 1", "", text.splitlines()[0], TRAJECTORY_COLUMNS)
    positions = np.stack([target.position for target in table.targets if target.position is not None])
    rotations = [target.rotation for target in table.targets if target.rotation is not None]
    return _trajectory(table.times, positions, np.stack(rotations) if rotations else None)


def _trajectory(times: Floats, positions: Floats, rotations: Floats | None) -> Course:
    for array in (times, positions, rotations):
        if array is not None:
            array.flags.writeable = False
    return Course(times, positions, rotations)


def read_target(value: Any, robot: Robot) -> Target:
    """Read one target of a robot."""
    target = make(Target, value)
    if target.segment is None:
        return target
    return target.changed(segment=segment_number("segment", target.segment, robot.segment_names))


def read_targets(value: Any, robot: Robot) -> tuple[Target, ...]:
    """Read a list of targets that are to be met at once."""
    return tuple(read_each(partial(read_target, robot=robot), _list_of("targets", value)))


def targets_together(entries: list[Any]) -> tuple[Target, ...]:
    """Read a long list of targets at once where all have the same keys, with vectors of plain numbers.

    Empty where that is not so, or where something is wrong with one: `read_target` says what.
    """
    keys = entries[0].keys() if isinstance(entries[0], dict) else set()
    if not keys or not keys <= VECTORS or not all(isinstance(e, dict) and e.keys() == keys for e in entries):
        return ()
    columns = {key: [entry[key] for entry in entries] for key in keys}
    for rows in columns.values():
        if set(map(type, rows)) != {list} or len(set(map(len, rows))) > 1:
            return ()
        if not set(map(type, chain.from_iterable(rows))) <= {int, float}:
            return ()
    try:
        return Target.each(**columns)
    except InputError:
        return ()


def read_configuration(key: str, value: Any, robot: Robot, folder: Path) -> Floats:
    """Read `start` or `goal`: rows of `bend_x, bend_y, length`, a result, or the name of a file with one result in it.

    Parameters
    ----------
    key : str
        Which of them.
    value : object
        What the problem file says.
    robot : Robot
    folder : Path
        Where relative file names begin.

    Returns
    -------
    ndarray (n, 3)

    Raises
    ------
    InputError
        When it is none of these, or is for another number of segments.
    """
    return read_part(key, value, folder, lambda own, _: _configuration(own, robot), lambda text, _: parse_json(text))


def _configuration(value: Any, robot: Robot) -> Floats:
    if not isinstance(value, dict):
        return _one_configuration("", value, robot)
    joints = value.get("joints") if robot.joints else None
    if "knots" in value:  # a motion: where it ends
        rows = len(robot) if joints is None else len(robot.segments)
        knots = checks.rows("knots", value["knots"], rows, 3)
        if not len(knots):
            raise InputError("knots", "", value["knots"], "at least one configuration")
        last = None if joints is None else checks.rows("joints", joints, len(robot.joint_names))[-1]
        return _one_configuration("knots", knots[-1], robot, last)
    if "q" not in value:
        raise InputError("q", "missing", value, "a result of an earlier solve")
    return _one_configuration("q", value["q"], robot, joints)


def _one_configuration(key: str, value: Any, robot: Robot, joints: Any = None) -> Floats:
    """Check rows of a configuration, or those of the segments and values of the joints."""
    if not robot.joints:
        return checks.array(key, value, (len(robot), 3))
    found = robot.configuration(key, value, joints)
    return checks.array(key, found, (len(robot), 3))


def _list_of(what: str, value: Any, least: int = 1) -> list[Any]:
    if not isinstance(value, list) or len(value) < least:
        raise InputError("", "", value, f"a list of {what}")
    return value


TIME = "t"
POSITION = ("x", "y", "z")
ORIENTATIONS = {"direction": ("dx", "dy", "dz"), "rotation": ("qw", "qx", "qy", "qz")}
HEADERS = {POSITION: None} | {(*POSITION, *columns): name for name, columns in ORIENTATIONS.items()}
"""What an allowed header says beside the position."""


class PathTable(NamedTuple):
    """What a file says: targets, and their times (m,) where it has some."""

    targets: tuple[Target, ...]
    times: Floats | None


def parse_path(text: str) -> PathTable:
    """Read the targets of a table with names in its first line, and their times.

    Raises
    ------
    InputError
        With the number of the line, when the header is another one, a row has not one finite number for each column, or
        times do not increase.
    """
    table, rows = read_table(text)
    names = [axis_of(name) or name.lower() for name in table.names or ()]
    timed = TIME in names
    columns = next((each for each in HEADERS if sorted([*each, *([TIME] * timed)]) == sorted(names)), None)
    if columns is None:
        known = {name for header in HEADERS for name in (*header, TIME)}
        unknown = [own for own, name in zip(table.names or (), names, strict=True) if name not in known]
        problem = f"unknown columns {few(unknown)}" if unknown else ""
        expected = " or ".join(",".join(h) for h in HEADERS) + ", perhaps with t"
        raise InputError("line 1", problem, ",".join(table.names or ()) or text[:100], expected)
    if not rows:
        raise InputError("line 1", "", text, "at least one target")
    places = [names.index(name) for name in columns]
    table.warn_of_units(places, "path")
    poses, orientation = table.read_finite(rows, places), HEADERS[columns]
    turned: dict[str, Any] = {} if orientation is None else {orientation: poses[:, 3:]}
    try:
        times = checks.increasing("times", table.read_finite(rows, [names.index(TIME)])[:, 0], None) if timed else None
        return PathTable(Target.each(poses[:, :3], **turned), times)
    except InputError as error:
        if error.row is None:
            raise
        name, row = error.row
        key = f"line {rows[row][0]}.{TIME if name == 'times' else name}"
        raise InputError(key, error.problem, error.value, error.expected) from None


QUESTIONS = ("target", "targets", "path", "goal")
DEMANDS = ("clearance", "self_clearance")
KEYS = (
    "robot",
    "scene",
    *QUESTIONS,
    "tolerance",
    "start",
    "prefer",
    "rates",
    "times",
    "reconfigure",
    "workspace",
    *DEMANDS,
)


OPTIONS = ("method", "time", "seed", "routes")
"""Options of a solve that are taken for keys of a problem."""


def problem_arguments(value: Any, file: str, question: bool = True) -> dict[str, Any]:
    """Return what a problem file says, as arguments of `Job`; without its `question`, it may be a robot alone."""
    if not isinstance(value, dict):
        raise InputError("file", "", value, "a mapping with " + ", ".join(KEYS))
    for key in OPTIONS:
        if key in value:
            raise InputError(key, "says how to solve", value[key], f"it in the call, {key}=, or typed, --{key}")
    alone = not question and ("segments" in value or "joints" in value) and "robot" not in value
    entries = {} if alone else known_entries(value, KEYS, ["robot"])
    folder = Path(file).parent
    robot, scene = (read_robot(value, folder), Scene()) if alone else read_place(entries, folder)
    start = entries.get("start")
    return {
        "robot": robot,
        "scene": scene,
        "tolerance": made(entries, "tolerance", Tolerance),
        "start": None if start is None else read_configuration("start", start, robot, folder),
        "prefer": made(entries, "prefer", Preferences),
        "rates": _rates(entries),
        "reconfigure": "refuse" if entries.get("reconfigure") is None else entries["reconfigure"],
        "workspace": made(entries, "workspace", Workspace),
        "clearance": entries.get("clearance"),
        "self_clearance": entries.get("self_clearance"),
        "file": file,
        **(read_question(entries, robot, folder) if question else {}),
    }


def _rates(entries: dict[str, Any]) -> Rates | None:
    if entries.get("rates") is None:
        return None
    with checks.inside("rates"):
        return make(Rates, entries["rates"], {"acceleration": lambda value: make(Rates, value)})


def made(entries: dict[str, Any], key: str, noun: type[Any]) -> Any:
    """Make what stands under `key`; without it, what it is by default."""
    with checks.inside(key):
        return make(noun, {} if entries.get(key) is None else entries[key])


def read_waypoints(key: str, path: Any, robot: Robot | None = None) -> tuple[tuple[Target, ...], ...]:
    """Check waypoints, of a robot where it is known; `key` is what holds them, or `target`, the only one."""
    if isinstance(path, (Target, str, bytes, dict)) or not np.iterable(path):
        raise InputError(key, "", path, "a list of targets")
    result = [target_list(key if key == "target" else f"{key}[{i}]", each, robot) for i, each in enumerate(path)]
    if not result:
        raise InputError(key, "", path, "at least one target")
    return tuple(result)


def read_question(entries: dict[str, Any], robot: Robot, folder: Path) -> dict[str, Any]:
    """What is asked, as an argument of a problem."""
    expected = "one of " + ", ".join(QUESTIONS)
    asked = [key for key in QUESTIONS if key in entries]
    if not asked:
        raise InputError("target", "missing", list(entries), expected)
    key, value = asked[0], entries[asked[0]]
    if len(asked) > 1:
        raise InputError(key, f"cannot be combined with {asked[1]}", value, expected)
    if key == "path":
        targets, times = _read_path(value, robot, folder)
        if times is not None and "times" in entries:
            raise InputError("times", "are in the file of the path, too", entries["times"], "one of both")
        return {"path": targets, "times": entries.get("times") if times is None else times}
    if entries.get("times") is not None:
        raise InputError("times", f"cannot be combined with {key}", entries["times"], "those of a path")
    if key == "goal":
        return {"goal": read_configuration("goal", value, robot, folder)}
    with checks.inside(key):
        return {"target": (read_target(value, robot),) if key == "target" else read_targets(value, robot)}


def _read_path(value: Any, robot: Robot, folder: Path) -> tuple[list[tuple[Target, ...]], Floats | None]:
    """Read targets to be met one after the other, and the times of a file of them."""
    if isinstance(value, str):
        file = folder / value
        text = read_text(file, "path")
        with checks.in_file(file):
            table = parse_path(text)
        return [(target,) for target in table.targets], table.times
    if not isinstance(value, list) or not value:
        raise InputError("path", "", value, "a list of targets or the name of a CSV file")
    together = targets_together(value)
    if together:
        return [(target,) for target in together], None

    def read(entry: Any) -> tuple[Target, ...]:
        return read_targets(entry, robot) if isinstance(entry, list) else (read_target(entry, robot),)

    with checks.inside("path"):
        return read_each(read, value), None
