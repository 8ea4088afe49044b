"""Problem files become nouns, or are refused in one line that names file, key, value and expectation."""

import json
import time
from pathlib import Path

import numpy as np
import pytest

from sinuous.base.errors import InputError
from sinuous.files.problem_file import read_problem
from sinuous.model.poses import pose
from sinuous.model.rates import Rates
from sinuous.scene.grids import Grid
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Sphere
from sinuous.scene.point_cloud import PointCloud
from tests.scene.shapes import cube, together

ROBOT = "robot: {segments: {count: 2, length: [1, 2]}}\n"
TARGET = "target: {position: [0, 0, 3]}\n"

EVERYTHING = """
robot:
  segments:
    - {length: [0, 1.5], max_bend: 0}
    - count: 2
      length: 1
      max_bend: 2
      max_curvature: 1.5
      radius: 0.2
      tendons: {count: 4, radius: 0.1, angle: 0.5, displacement: [-1e-1, 1e-1]}
    - {length: [0.5, 1.5], chambers: {angles: [0, 2, 4], radius: 0.1, length: [0.4, 1.6]}}
  radius: 0.1
  mount: 0.25
  base: {position: [1, 2, 3], direction: [1, 0, 0]}
  tool: {position: [0, 0, 0.5], rotation: [1, 0, 0, 1]}
scene:
  - sphere: {center: [0, 0, 9], radius: 1, name: ball}
  - box: {center: [0, 0, 0], size: [20, 20, 20], rotation: [[0, -1, 0], [1, 0, 0], [0, 0, 1]], inside: true}
  - capsule: {start: [0, 0, 0], end: [0, 0, -1], radius: 0.5}
  - cylinder: {start: [0, 0, 0], end: [0, 0, -1], radius: 0.5}
  - half_space: {point: [0, 0, -5], normal: [0, 0, 2]}
targets:
  - {position: [2, 2, 3], direction: [1, 1, 0]}
  - {position: [1, 2, 3], segment: 1}
tolerance: {position: 1e-3, angle: 0.01}
start: [[0, 0, 1], [0.1, 0, 1], [0.1, 0, 1], [0, 0.5, 1]]
prefer: {start: 1, bends: 0.5, clearance: 0.1}
rates: {bend: 1.5, length: [1, 2, 3, 4], acceleration: {bend: 10}}
"""


def _write(folder: Path, text: str, name: str = "problem.yaml") -> Path:
    file = folder / name
    file.write_text(text, encoding="utf-8")
    return file


def test_every_key_arrives(tmp_path: Path) -> None:
    problem = read_problem(_write(tmp_path, EVERYTHING))
    robot, scene = problem.robot, problem.scene
    assert len(robot) == 4
    assert [segment.length for segment in robot.segments] == [(0.0, 1.5), (1.0, 1.0), (1.0, 1.0), (0.5, 1.5)]
    assert robot.radii == (0.1, 0.2, 0.2, 0.1)
    assert robot.mount == 0.25
    np.testing.assert_allclose(robot.base, pose((1, 2, 3), direction=(1, 0, 0)))
    np.testing.assert_allclose(robot.tool, pose((0, 0, 0.5), rotation=(1, 0, 0, 1)))
    tendons, chambers = robot.segments[2].tendons, robot.segments[3].chambers
    assert tendons is not None
    assert chambers is not None
    assert tendons.displacement == (-0.1, 0.1)
    np.testing.assert_allclose(chambers.angles, [0, 2, 4])
    assert [type(obstacle) for obstacle in scene.obstacles] == [Sphere, Box, Capsule, Cylinder, HalfSpace]
    assert scene.name(0) == "ball"
    assert len(problem.waypoints) == 1
    assert [target.segment for target in problem.waypoints[0]] == [None, 1]
    assert (problem.tolerance.position, problem.tolerance.angle) == (1e-3, 0.01)
    assert (problem.prefer.start, problem.prefer.bends, problem.prefer.clearance) == (1.0, 0.5, 0.1)
    acceleration = Rates(bend=10)
    assert problem.rates.equals(Rates(bend=1.5, length=(1, 2, 3, 4), acceleration=acceleration))
    assert problem.start is not None
    assert problem.start.shape == (4, 3)


def test_obstacles_from_files_are_found_beside_the_problem(tmp_path: Path) -> None:
    folder = tmp_path / "shapes"
    folder.mkdir()
    _write(folder, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n", "corner.obj")
    _write(folder, "0 0 1\n0 0 2\n", "scan.xyz")
    np.savez(folder / "mask.npz", values=np.ones((2, 2, 2), bool), origin=(5, 5, 5), spacing=0.5)
    scene = read_problem(
        _write(
            tmp_path,
            ROBOT
            + TARGET
            + "scene:\n"
            + "  - mesh: {file: shapes/corner.obj, scale: 2, position: [5, 0, 0], rotation: [1, 0, 0, 1], name: c}\n"
            + "  - points: {file: shapes/scan.xyz, scale: 1e-1, radius: 0.2}\n"
            + "  - grid: {file: shapes/mask.npz, name: mask}\n"
            + "  - sphere: {center: [0, 9, 0], radius: 1}\n",
        )
    ).scene
    mesh, cloud, grid, _ = scene.obstacles
    assert isinstance(mesh, Mesh)
    assert mesh.watertight
    np.testing.assert_allclose(mesh.vertices.max(axis=0), (5, 2, 2), atol=1e-12)
    np.testing.assert_allclose(mesh.vertices.min(axis=0), (3, 0, 0), atol=1e-12)
    assert isinstance(cloud, PointCloud)
    np.testing.assert_allclose(cloud.points, [[0, 0, 0.1], [0, 0, 0.2]])
    assert isinstance(grid, Grid)
    assert grid.occupancy
    assert [scene.name(0), scene.name(2)] == ["c", "mask"]


def test_bodies_of_a_mesh_that_overlap_are_obstacles_of_their_own(tmp_path: Path) -> None:
    vertices, faces = together(cube(), cube(1.0, (0.5, 0.0, 0.0)))
    rows = [f"v {x} {y} {z}" for x, y, z in vertices.tolist()] + [f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()]
    _write(tmp_path, "\n".join(rows), "parts.obj")
    scene = read_problem(
        _write(
            tmp_path,
            ROBOT
            + TARGET
            + "scene:\n"
            + "  - mesh: {file: parts.obj, scale: 2, name: engine}\n"
            + "  - mesh: {file: parts.obj, scale: 3}\n"
            + "  - sphere: {center: [0, 9, 0], radius: 1}\n",
        )
    ).scene
    assert [scene.name(i) for i in range(len(scene))] == ["engine", "engine", "mesh[1]", "mesh[1]", "sphere[2]"]


@pytest.mark.parametrize("scale", [1e5, 1e-5])
def test_a_mesh_in_another_unit_is_refused(tmp_path: Path, scale: float) -> None:
    _write(tmp_path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 2\n", "sheet.obj")
    scene = f"scene: [{{mesh: {{file: sheet.obj, scale: {scale}}}}}]"
    with pytest.raises(InputError) as caught:
        read_problem(_write(tmp_path, ROBOT + TARGET + scene))
    assert "problem.yaml: scene[0].mesh.scale: expected a mesh in the unit of the robot, which is 3 long" in str(
        caught.value
    )
    assert f", got {scale} (makes " in str(caught.value)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig"])
@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
def test_json_says_the_same(tmp_path: Path, encoding: str, line_end: str) -> None:
    text = json.dumps(
        {"robot": {"segments": {"count": 2, "length": [1, 2]}}, "target": {"position": [0, 0, 3]}}, indent=1
    )
    for name in ("problem.json", "problem.yaml"):
        file = tmp_path / name
        file.write_bytes(text.replace("\n", line_end).encode(encoding))
        problem = read_problem(file)
        assert len(problem.robot) == 2
        assert problem.file == str(file)
        assert not problem.is_path


def test_a_path_may_be_a_list_or_a_table_beside_the_problem(tmp_path: Path) -> None:
    listed = read_problem(
        _write(
            tmp_path,
            ROBOT + "path: [{position: [0, 0, 3]}, [{direction: [0, 0, 1]}, {position: [0, 0, 1.5], segment: 1}]]",
        )
    )
    assert listed.is_path
    assert [len(waypoint) for waypoint in listed.waypoints] == [1, 2]
    _write(tmp_path, "x, y, z, dx, dy, dz\r\n0, 0, 3, 0, 0, 1\r\n\r\n0,1e-1,2.9,0,0,2\r\n", "tips.csv")
    table = read_problem(_write(tmp_path, ROBOT + "path: tips.csv"))
    assert len(table.waypoints) == 2
    np.testing.assert_array_equal(table.waypoints[1][0].position, [0, 0.1, 2.9])
    np.testing.assert_array_equal(table.waypoints[1][0].direction, [0, 0, 1])


@pytest.mark.parametrize("orientation", ["", "direction", "rotation"])
def test_a_long_path_is_read_as_its_targets_are_one_by_one(tmp_path: Path, orientation: str) -> None:
    numbers = np.random.default_rng(2).normal(size=(40, 7)).round(3).tolist()
    size = {"": 0, "direction": 3, "rotation": 4}[orientation]
    rows = [{"position": row[:3]} | ({orientation: row[3 : 3 + size]} if size else {}) for row in numbers]
    rows[7]["position"] = [1, 2, 3]  # whole numbers are numbers
    listed = read_problem(_write(tmp_path, ROBOT + "path: " + json.dumps(rows)))
    # One that is not like the others has all of them read one by one.
    single = read_problem(_write(tmp_path, ROBOT + "path: " + json.dumps([*rows, {"direction": [0, 0, 1]}])))
    for (a,), (b,) in zip(listed.waypoints, single.waypoints[:-1], strict=True):
        np.testing.assert_array_equal(a.table, b.table)


@pytest.mark.parametrize(
    "wrong", ["[0, 0]", "[0, 0, a]", "[0, 0, true]", "7", "[0, 0, [1]]", "[0, 0, " + "9" * 330 + "]"]
)
def test_one_wrong_target_of_a_long_path_is_named(tmp_path: Path, wrong: str) -> None:
    good = "  - {position: [0, 0, 3]}\n"
    with pytest.raises(InputError) as caught:
        read_problem(_write(tmp_path, ROBOT + "path:\n" + 30 * good + f"  - {{position: {wrong}}}\n" + good))
    assert caught.value.key.startswith("path[30].position")


def test_a_start_may_be_numbers_a_result_or_a_file_with_one(tmp_path: Path) -> None:
    q = [[0.1, 0.2, 1.5], [0.0, 0.0, 1.25]]
    result = {"status": "solved", "q": q}
    _write(tmp_path, json.dumps(result) + "\n", "earlier.jsonl")
    _write(tmp_path, json.dumps({"status": "solved", "knots": [[[0, 0, 1], [0, 0, 1]], q]}), "track.jsonl")
    for start in (json.dumps(q), json.dumps(result), "earlier.jsonl", "track.jsonl"):
        problem = read_problem(_write(tmp_path, ROBOT + TARGET + f"start: {start}"))
        np.testing.assert_array_equal(problem.start, q)


BAD = {
    "robot: {segments: {count: 1000000000, length: 1}}": "robot.segments.count: "
    "expected a whole number from 1 to 10000, got 1000000000",
    "robot: {segments: [{count: 9000, length: 1}, {count: 9000, length: 1}]}": "robot.segments: "
    "expected at most 10000 segments in all, got 18000",
    "robot: {segments: {count: 2.0, length: 1}}": "robot.segments.count: "
    "expected a whole number from 1 to 10000, got 2.0",
    "robot: {segments: {count: 0, length: 1}}": "robot.segments.count: expected a whole number from 1 to 10000, got 0",
    "robot: {segments: {lenght: 1}}": "robot.segments.lenght: expected length ... (unknown key)",
    "robot: {segments: {count: 2}}": "robot.segments.length: expected a value, got {'count': 2} (missing)",
    "robot: {segments: {length: [2, 1]}}": "robot.segments.length: "
    "expected [low, high] with low <= high ... (lower limit above the upper one)",
    "robot: {segments: {length: 0}}": "robot.segments: "
    "expected at least one segment that can be longer than 0 ... (Segment(length=0, max_bend=3.14159, radius=0),)",
    "robot: {segments: {length: -1}}": "robot.segments.length: expected a number of at least 0, got -1",
    "robot: {segments: {length: one}}": "robot.segments.length: expected a number or [low, high], got 'one'",
    "robot: {segments: {length: true}}": "robot.segments.length: expected a number or [low, high], got True",
    "robot: {segments: {length: 1, max_bend: .nan}}": "robot.segments.max_bend: expected a finite number, got nan",
    "robot: {segments: {length: 1, radius: -1}}": "robot.segments.radius: expected a number of at least 0, got -1",
    "robot: {segments: {length: 1, tendons: {count: 3}}}": "robot.segments.tendons.radius: "
    "expected a number greater than 0, got None",
    "robot: {segments: {length: 1, tendons: {count: 3, angles: [0], radius: 1}}}": "robot.segments.tendons.count: "
    "expected either count (and angle) or angles ... (they say where the lines are)",
    "robot: {segments: []}": "robot.segments: expected a list of segments, got []",
    "robot: {segments: [{length: 1}, 3]}": "robot.segments[1]: expected a mapping with count, length, max_bend ... 3",
    "robot: {segments: {length: 1}, radius: thick}": "robot.radius: expected a number of at least 0, got 'thick'",
    "robot: {segments: {length: 1}, base: {direction: [0, 0, 0]}}": "robot.base.direction: "
    "expected a vector that is not zero, got [0, 0, 0]",
    "robot: {segments: {length: 1}, base: {direction: [0, 0, 1], rotation: [1, 0, 0, 0]}}": "robot.base.rotation: "
    "expected one of direction, rotation, xyzw, matrix ... (cannot be combined with another orientation)",
    "robot: {segments: {length: 1}, tool: {rotation: [[1, 0, 0], [0, 2, 0], [0, 0, 1]]}}": "robot.tool.rotation: "
    "expected a rotation: orthonormal rows and determinant 1 ... [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]]",
    "robot: {segments: {length: 1}, base: {matrix: [[1]]}}": "robot.base.matrix: "
    "expected 4 rows of 4 finite numbers, as sn.pose(position, direction=) gives them, got [[1]] (shape (1, 1))",
    "robot: {segments: {count: 2, length: 1, name: a}}": "robot.segments[1].name: "
    "expected a name of its own, got 'a' (is that of segments[0].name already)",
    "robot: {segments: {length: 1}, actuators: {matrix: [[1, 2]]}}": "robot.actuators.matrix: "
    "expected shape (1, 3), for 1 segments, got (1, 2)",
    "robot: {segments: {length: 1}, actuators: {matrix: [[0, 0, 0]]}}": "robot.actuators.matrix[0]: "
    "expected a row that is not zero ... ",
    "robot: {segments: {length: [1, 2]}, actuators: {matrix: [[1, 0, 2]], limits: [0, 3]}}": "robot.actuators"
    ".limits[0]: expected limits that contain [2, 4], got (0.0, 3.0) (excludes straight robots)",
    "robot: {segments: {length: 1}, actuators: [[1, 0, 0]]}": "robot.actuators: "
    "expected a mapping with matrix, names, limits, gain, offset, unit, got [[1, 0, 0]]",
    "robot: {segments: {length: 1}, actuators: {rows: 1}}": "robot.actuators.rows: expected one of matrix ... ",
    "robot: {segments: {length: 1, tendons: {count: 2, radius: 1, names: [a]}}}": "robot.segments.tendons.names: "
    "expected a list of 2 names, got ['a']",
    "robot: 3": "robot: expected a mapping with segments, radius, mount, base, tool, self_collision, actuators, name, "
    "clearance, self_clearance, uncertainty, stiffness, mass, arcs, gravity, payload, got 3",
    ROBOT + "scene: {}": "scene: expected a list of obstacles, got {}",
    ROBOT + "scene: [ball]": "scene[0]: expected a mapping with sphere, box, capsule, cylinder, half_space ... 'ball'",
    ROBOT + "scene: [{spere: {}}]": "scene[0].spere: expected sphere ... (unknown key)",
    ROBOT + "scene: [{sphere: {}, box: {}}]": "scene[0]: "
    "expected one of sphere, box, capsule, cylinder, half_space, mesh ... {'box': {}, 'sphere': {}}",
    ROBOT + "scene: [{sphere: {center: [0, 0, 0]}}]": "scene[0].sphere.radius: "
    "expected a value, got {'center': [0, 0, 0]} (missing)",
    ROBOT
    + "scene: [{sphere: {center: [0, 0], radius: 1}}]": "scene[0].sphere.center: expected 3 finite numbers, got [0, 0]",
    ROBOT + "scene: [{sphere: {center: [0, 0, true], radius: 1}}]": "scene[0].sphere.center: "
    "expected 3 finite numbers, got [0, 0, True]",
    ROBOT + "scene: [{sphere: {center: [0, 0, 0], radius: 0}}]": "scene[0].sphere.radius: "
    "expected a number greater than 0, got 0",
    ROBOT + "scene: [{sphere: {center: [0, 0, 0], radius: 1, inside: 1}}]": "scene[0].sphere.inside: "
    "expected true or false, got 1",
    ROBOT + "scene: [{half_space: {point: [0, 0, 0], normal: [0, 0, 1], inside: true}}]": "scene[0].half_space.inside: "
    "expected one of point, normal, name, got True (unknown key)",
    ROBOT + "scene: [{mesh: {file: a.stl}}]": "scene[0].mesh.scale: expected a value, got {'file': 'a.stl'} (missing)",
    ROBOT + "scene: [{mesh: {file: a.stl, scale: 1}}]": "scene[0].mesh.file: "
    "expected the name of a file that can be read ... (cannot be read: No such file or directory)",
    ROBOT + "scene: [{mesh: {file: a.step, scale: 1}}]": "scene[0].mesh.file: "
    "expected a name that ends in .stl, .ply, .obj, .glb ... ",
    ROBOT + "scene: [{mesh: {file: [a.stl], scale: 1}}]": "scene[0].mesh.file: expected a text, got ['a.stl']",
    ROBOT + "scene: [{mesh: {file: a.stl, scale: 0}}]": "scene[0].mesh.scale: expected a number greater than 0, got 0",
    ROBOT + "scene: [{mesh: {fiel: a.stl, scale: 1}}]": "scene[0].mesh.fiel: expected file ... (unknown key)",
    ROBOT
    + "scene: [{points: {file: a.ply}}]": "scene[0].points.radius: expected a value, got {'file': 'a.ply'} (missing)",
    ROBOT + "scene: [{points: {file: a.pcd, radius: 1}}]": "scene[0].points.file: "
    "expected the name of a file that can be read ... (cannot be read: No such file or directory)",
    ROBOT + "scene: [{points: {file: a.pcd, radius: -1}}]": "scene[0].points.file: "
    "expected the name of a file that can be read ... (cannot be read: No such file or directory)",
    ROBOT + "scene: [{grid: {file: a.npz}}]": "scene[0].grid.file: "
    "expected the name of a file that can be read ... (cannot be read: No such file or directory)",
    ROBOT + "scene: [{grid: {file: a.npz, scale: 1}}]": "scene[0].grid.scale: "
    "expected one of file, name, exact, truncated, got 1 (unknown key)",
    ROBOT: "target: expected one of target, targets, path, goal, got ['robot'] (missing)",
    ROBOT + TARGET + "path: tips.csv": "target: "
    "expected one of target, targets, path, goal, got {'position': [0, 0, 3]} (cannot be combined with path)",
    ROBOT
    + "target: {}": "target.position: expected position, direction or rotation ... (nothing is asked of the target)",
    ROBOT + "target: [0, 0, 1]": "target: "
    "expected a mapping with position, direction, rotation, segment, xyzw, got [0, 0, 1]",
    ROBOT + "target: {position: [0, 0, a]}": "target.position: expected 3 finite numbers, got [0, 0, 'a']",
    ROBOT + "target: {position: [0, 0, 1], segment: 3}": "target.segment: expected a whole number from 1 to 2, got 3",
    ROBOT + "target: {direction: [1, 0, 0], rotation: [1, 0, 0, 0]}": "target.direction: "
    "expected one of direction, rotation, got [1, 0, 0] (cannot be combined with rotation)",
    ROBOT + "targets: []": "targets: expected a list of targets, got []",
    ROBOT + "targets: [{position: [0, 0, 1]}, {direction: [0, 0, 0]}]": "targets[1].direction: "
    "expected a vector that is not zero, got [0, 0, 0]",
    ROBOT + "path: []": "path: expected a list of targets or the name of a CSV file, got []",
    ROBOT
    + "path: [{position: [0, 0, 1]}, [{position: [0]}]]": "path[1][0].position: expected 3 finite numbers, got [0]",
    ROBOT + "path: missing.csv": "path: "
    "expected the name of a file that can be read ... (cannot be read: No such file or directory)",
    ROBOT + TARGET + "tolerance: {position: 0}": "tolerance.position: expected a number greater than 0, got 0",
    ROBOT
    + TARGET
    + "tolerance: {angel: 1}": "tolerance.angel: expected angle (or one of position), got 1 (unknown key)",
    ROBOT + TARGET + "start: [[0, 0, 1]]": "start: expected 2 rows of 3 finite numbers, got [[0, 0, 1]] (shape (1, 3))",
    ROBOT
    + TARGET
    + "start: {status: solved}": "start.q: expected a result of an earlier solve, got {'status': 'solved'} (missing)",
    ROBOT + "goal: [[0, 0, 1]]": "goal: expected 2 rows of 3 finite numbers, got [[0, 0, 1]] (shape (1, 3))",
    ROBOT + TARGET + "start: missing.json": "start: "
    "expected the name of a file that can be read ... (cannot be read: No such file or directory)",
    ROBOT
    + TARGET
    + "prefer: {bend: 1}": "prefer.bend: expected bends (or one of start, clearance), got 1 (unknown key)",
    ROBOT + TARGET + "rates: {bend: 0}": "rates.bend: expected a number greater than 0, got 0",
    ROBOT + TARGET + "rates: {length: [1, 2, 3]}": "rates.length: expected one number, or 2, got [1.0, 2.0, 3.0]",
    ROBOT + TARGET + "rates: {speed: 1}": "rates.speed: "
    "expected one of bend, length, actuator, acceleration, got 1 (unknown key)",
    ROBOT
    + TARGET
    + "rates: {acceleration: {bend: -1}}": "rates.acceleration.bend: expected a number greater than 0, got -1",
    ROBOT + TARGET + "tagret: 1": "tagret: expected target ... (unknown key)",
    ROBOT + TARGET + '"a b\\n\\e[31m": 1': "'a b\\n\\x1b[31m': "
    "expected one of robot, scene, target, targets, path, goal, tolerance ... (unknown key)",
    "": "file: expected a mapping with robot, scene, target, targets, path, goal, tolerance ... None",
    "just a text": "file: expected a mapping with robot, scene, target, targets, path, goal, ... 'just a text'",
}


@pytest.mark.parametrize(("text", "refusal"), BAD.items(), ids=range(len(BAD)))
def test_bad_input_is_one_line_that_says_where_and_why(tmp_path: Path, text: str, refusal: str) -> None:
    asks = any(key in text for key in ("target", "path", "goal"))
    if text.startswith("robot") and not asks and text != ROBOT:
        text += "\n" + TARGET
    file = _write(tmp_path, text)
    began = time.process_time()
    with pytest.raises(InputError) as caught:
        read_problem(file)
    assert time.process_time() - began < 0.5
    message = str(caught.value)
    front, _, back = refusal.partition(" ... ")
    assert message.startswith(f"{file}: {front}")
    assert message.endswith(back)
    assert ": expected " in message
    assert len(message.splitlines()) == 1


@pytest.mark.parametrize(
    ("content", "refusal"),
    [
        (b"\xff\xfe", "(not UTF-8 at byte 0)"),
        (None, "(cannot be read: No such file or directory)"),
    ],
)
def test_unreadable_files(tmp_path: Path, content: bytes | None, refusal: str) -> None:
    file = tmp_path / "problem.yaml"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(InputError, match="problem") as caught:
        read_problem(file)
    assert str(caught.value).startswith(f"{file}: file: expected ")
    assert str(caught.value).endswith(refusal)


def test_a_folder_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"file: expected .* \(cannot be read"):
        read_problem(tmp_path)


def test_a_bad_result_is_refused_in_its_own_file(tmp_path: Path) -> None:
    earlier = _write(tmp_path, '{"q": [[0, 0, NaN]]}', "earlier.json")
    with pytest.raises(InputError) as caught:
        read_problem(_write(tmp_path, ROBOT + TARGET + "start: earlier.json"))
    assert str(caught.value).startswith(f"{earlier}: q[0][2]: expected a finite number, got nan")
