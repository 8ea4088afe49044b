"""Problem files become nouns, or are refused in one line that names file, key, value and expectation."""

import json
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from sinuous.motion.job import read_problem
from sinuous.scene.obstacles import PRIMITIVES
from tests.helpers import present, refused
from tests.scene.shapes import cube, obj, together

ROBOT = "robot: {segments: {count: 2, length: [1, 2]}}\n"
TARGET = "target: {position: [0, 0, 3]}\n"
PATH = "path: [{position: [0, 0, 3]}, {position: [0, 0.1, 3]}]\n"
FROM_FILES = """
scene:
  - mesh: {file: shapes/corner.obj, scale: 2, position: [5, 0, 0], rotation: [1, 0, 0, 1], name: c}
  - points: {file: shapes/scan.xyz, scale: 1e-1, radius: 0.2}
  - grid: {file: shapes/mask.npz, name: mask}
  - sphere: {center: [0, 9, 0], radius: 1}
"""

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


Read = Callable[[str], sn.Job]


@pytest.fixture
def read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Read:
    """Read a problem file of this text, in a folder of the test, where others may stand."""
    monkeypatch.chdir(tmp_path)
    Path("timed.csv").write_text("t,x,y,z\n0,0,0,3\n2.5,0,0.1,3\n")

    def read(text: str) -> sn.Job:
        Path("problem.yaml").write_text(text, encoding="utf-8")
        return read_problem("problem.yaml")

    return read


def test_every_key_arrives(read: Read) -> None:
    problem = read(EVERYTHING)
    robot, scene = problem.robot, problem.scene
    assert [segment.length for segment in robot.segments] == [(0.0, 1.5), (1.0, 1.0), (1.0, 1.0), (0.5, 1.5)]
    assert robot.radii == (0.1, 0.2, 0.2, 0.1)
    assert robot.mount == 0.25
    np.testing.assert_allclose(robot.base, sn.pose((1, 2, 3), direction=(1, 0, 0)))
    np.testing.assert_allclose(robot.tool, sn.pose((0, 0, 0.5), rotation=(1, 0, 0, 1)))
    tendons, chambers = robot.segments[2].tendons, robot.segments[3].chambers
    assert present(tendons).displacement == (-0.1, 0.1)
    np.testing.assert_allclose(present(chambers).angles, [0, 2, 4])
    assert [type(obstacle) for obstacle in scene.obstacles] == [
        sn.Sphere,
        sn.Box,
        sn.Capsule,
        sn.Cylinder,
        sn.HalfSpace,
    ]
    assert scene.name(0) == "ball"
    assert [[target.segment for target in targets] for targets in problem.waypoints] == [[None, 1]]
    assert (problem.tolerance.position, problem.tolerance.angle) == (1e-3, 0.01)
    assert (problem.prefer.start, problem.prefer.bends, problem.prefer.clearance) == (1.0, 0.5, 0.1)
    assert problem.rates.equals(sn.Rates(bend=1.5, length=(1, 2, 3, 4), acceleration=sn.Rates(bend=10)))
    assert present(problem.start).shape == (4, 3)


def test_obstacles_from_files_are_found_beside_the_problem(read: Read, tmp_path: Path) -> None:
    folder = tmp_path / "shapes"
    folder.mkdir()
    corner = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    (folder / "corner.obj").write_text(corner)
    (folder / "scan.xyz").write_text("0 0 1\n0 0 2\n")
    np.savez(folder / "mask.npz", values=np.ones((2, 2, 2), bool), origin=(5, 5, 5), spacing=0.5)
    scene = read(ROBOT + TARGET + FROM_FILES).scene
    mesh, cloud, grid, _ = scene.obstacles
    assert isinstance(mesh, sn.Mesh)
    assert mesh.watertight
    np.testing.assert_allclose(mesh.vertices.max(axis=0), (5, 2, 2), atol=1e-12)
    np.testing.assert_allclose(mesh.vertices.min(axis=0), (3, 0, 0), atol=1e-12)
    assert isinstance(cloud, sn.PointCloud)
    np.testing.assert_allclose(cloud.points, [[0, 0, 0.1], [0, 0, 0.2]])
    assert isinstance(grid, sn.Grid)
    assert grid.occupancy
    assert [scene.name(0), scene.name(2)] == ["c", "mask"]


def test_bodies_of_a_mesh_that_overlap_are_obstacles_of_their_own(read: Read) -> None:
    Path("parts.obj").write_text(obj(together(cube(), cube(1.0, (0.5, 0.0, 0.0)))))
    meshes = "scene: [{mesh: {file: parts.obj, scale: 2, name: engine}}, {mesh: {file: parts.obj, scale: 3}}"
    scene = read(f"{ROBOT}{TARGET}{meshes}, {{sphere: {{center: [0, 9, 0], radius: 1}}}}]").scene
    assert [scene.name(i) for i in range(len(scene))] == ["engine", "engine", "mesh[1]", "mesh[1]", "sphere[2]"]


@pytest.mark.parametrize("scale", [1e5, 1e-5])
def test_a_mesh_in_another_unit_is_refused(read: Read, scale: float) -> None:
    Path("sheet.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 2\n")
    text = ROBOT + TARGET + f"scene: [{{mesh: {{file: sheet.obj, scale: {scale}}}}}]"
    error = refused("scene[0].mesh.scale", lambda: read(text), ": makes ", file="problem.yaml")
    assert str(error).endswith(f"; expected a mesh in the unit of the robot, which is 3 long, got {scale}")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig"])
@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
def test_json_says_the_same(tmp_path: Path, encoding: str, line_end: str) -> None:
    values = {"robot": {"segments": {"count": 2, "length": [1, 2]}}, "target": {"position": [0, 0, 3]}}
    for name in ("problem.json", "problem.yaml"):
        file = tmp_path / name
        file.write_bytes(json.dumps(values, indent=1).replace("\n", line_end).encode(encoding))
        problem = read_problem(file)
        assert len(problem.robot) == 2
        assert problem.file == str(file)
        assert not problem.is_path


def test_a_path_may_be_a_list_or_a_table_beside_the_problem(read: Read) -> None:
    two = "[{direction: [0, 0, 1]}, {position: [0, 0, 1.5], segment: 1}]"
    listed = read(f"{ROBOT}path: [{{position: [0, 0, 3]}}, {two}]")
    assert listed.is_path
    assert [len(waypoint) for waypoint in listed.waypoints] == [1, 2]
    Path("tips.csv").write_text("x, y, z, dx, dy, dz\r\n0, 0, 3, 0, 0, 1\r\n\r\n0,1e-1,2.9,0,0,2\r\n")
    table = read(ROBOT + "path: tips.csv")
    assert len(table.waypoints) == 2
    np.testing.assert_array_equal(table.waypoints[1][0].position, [0, 0.1, 2.9])
    np.testing.assert_array_equal(table.waypoints[1][0].direction, [0, 0, 1])


def test_times_stand_in_the_file_or_in_the_table_of_the_path(read: Read) -> None:
    listed = read(ROBOT + PATH + "times: [0, 2.5]")
    assert present(listed.times).tolist() == [0.0, 2.5]
    assert listed.equals(read(ROBOT + "path: timed.csv"))
    assert read(ROBOT + PATH).times is None


@pytest.mark.parametrize("orientation", ["", "direction", "rotation"])
def test_a_long_path_is_read_as_its_targets_are_one_by_one(read: Read, orientation: str) -> None:
    numbers = np.random.default_rng(2).normal(size=(40, 7)).round(3).tolist()
    size = {"": 0, "direction": 3, "rotation": 4}[orientation]
    rows = [{"position": row[:3]} | ({orientation: row[3 : 3 + size]} if size else {}) for row in numbers]
    rows[7]["position"] = [1, 2, 3]  # whole numbers are numbers
    listed = read(ROBOT + "path: " + json.dumps(rows))
    # One that is not like the others has all of them read one by one.
    single = read(ROBOT + "path: " + json.dumps([*rows, {"direction": [0, 0, 1]}]))
    for (a,), (b,) in zip(listed.waypoints, single.waypoints[:-1], strict=True):
        np.testing.assert_array_equal(a.table, b.table)


@pytest.mark.parametrize(
    "wrong", ["[0, 0]", "[0, 0, a]", "[0, 0, true]", "7", "[0, 0, [1]]", "[0, 0, " + "9" * 330 + "]"]
)
def test_one_wrong_target_of_a_long_path_is_named(read: Read, wrong: str) -> None:
    good = "  - {position: [0, 0, 3]}\n"
    with pytest.raises(sn.InputError, match=r"^problem\.yaml: path\[30\]\.position"):
        read(f"{ROBOT}path:\n{30 * good}  - {{position: {wrong}}}\n{good}")


def test_a_start_may_be_numbers_a_result_or_a_file_with_one(read: Read) -> None:
    q = [[0.1, 0.2, 1.5], [0.0, 0.0, 1.25]]
    result = {"status": "solved", "q": q}
    Path("earlier.jsonl").write_text(json.dumps(result) + "\n")
    Path("track.jsonl").write_text(json.dumps({"status": "solved", "knots": [[[0, 0, 1], [0, 0, 1]], q]}))
    for start in (json.dumps(q), json.dumps(result), "earlier.jsonl", "track.jsonl"):
        np.testing.assert_array_equal(read(f"{ROBOT}{TARGET}start: {start}").start, q)


WRONG = {
    "robot: {segments: {count: 1000000000, length: 1}}": "robot.segments.count: expected a whole number from 1 to",
    "robot: {segments: [{count: 9000, length: 1}, {count: 9000, length: 1}]}": "robot.segments: expected at most",
    "robot: {segments: {lenght: 1}}": "robot.segments.lenght: unknown key; did you mean 'length'?",
    "robot: {segments: {count: 2}}": "robot.segments.length: missing; expected a number or [low, high]",
    "robot: {segments: {length: [2, 1]}}": "robot.segments.length: lower limit above the upper one; expected [low,",
    "robot: {segments: {length: 0}}": "robot.segments: expected at least one segment that can be longer than 0",
    "robot: {segments: {length: 1, max_bend: .nan}}": "robot.segments.max_bend: expected a finite number, got nan",
    "robot: {segments: []}": "robot.segments: expected a list of segments, got []",
    "robot: {segments: [{length: 1}, 3]}": "robot.segments[1]: expected a mapping with count, length, max_bend",
    "robot: {segments: {length: 1, tendons: {count: 3}}}": "robot.segments.tendons.radius: missing; expected a number",
    "robot: {segments: {length: 1}, base: {direction: [0, 0, 0]}}": "robot.base.direction: expected a vector that is",
    "robot: {segments: {count: 2, length: 1, name: a}}": "robot.segments[1].name: is that of segments[0].name",
    "robot: {segments: {length: 1}, actuators: [[1, 0, 0]]}": "robot.actuators: expected a mapping with matrix, names",
    "robot: 3": "robot: expected a mapping with segments, joints, radius, mount, base, tool, self_collision, ",
    "scene: {}": "scene: expected a list of obstacles, got {}",
    "scene: [ball]": f"scene[0]: expected a mapping with {', '.join(PRIMITIVES)}",
    "scene: [{spere: {}}]": "scene[0].spere: unknown key; did you mean 'sphere'?",
    "scene: [{sphere: {}, box: {}}]": f"scene[0]: expected one of {', '.join(PRIMITIVES)}, mesh",
    "scene: [{sphere: {center: [0, 0, 0]}}]": "scene[0].sphere.radius: missing; expected a number, got {'center': [0,",
    "scene: [{sphere: {center: [0, 0], radius: 1}}]": "scene[0].sphere.center: expected 3 finite numbers, got [0, 0]",
    "scene: [{half_space: {normal: [0, 0, 1], inside: true}}]": "scene[0].half_space.inside: unknown key; expected",
    "scene: [{mesh: {file: a.stl, scale: 1}}]": "scene[0].mesh.file: cannot be read: No such file or directory;",
    "scene: [{mesh: {file: [a.stl], scale: 1}}]": "scene[0].mesh.file: expected a text, got ['a.stl']",
    "scene: [{mesh: {file: a.stl}}]": "scene[0].mesh.scale: missing; expected units of the scene in one of the file: ",
    "scene: [{points: {file: a.ply}}]": "scene[0].points.radius: missing; expected a number, got {'file': 'a.ply'}",
    "scene: [{grid: {file: a.npz, scale: 1}}]": "scene[0].grid.scale: unknown key; expected one of file, name, exact, ",
    "target: {position: [0, 0, 1]}\npath: tips.csv": "target: cannot be combined with path; expected one of target, ",
    "target: {}": "target.position: nothing is asked of the target; expected position, direction or rotation",
    "target: [0, 0, 1]": "target: expected a mapping with position, direction, rotation, segment, xyzw, got [0, 0, 1]",
    "target: {position: [0, 0, 1], segment: 3}": "target.segment: expected a whole number from 1 to 2, got 3",
    "targets: []": "targets: expected a list of targets, got []",
    "targets: [{position: [0, 0, 1]}, {direction: [0, 0, 0]}]": "targets[1].direction: expected a vector that is not",
    "path: []": "path: expected a list of targets or the name of a CSV file, got []",
    "path: [{position: [0, 0, 1]}, [{position: [0]}]]": "path[1][0].position: expected 3 finite numbers, got [0]",
    "path: missing.csv": "path: cannot be read: No such file or directory; expected the name of a file that can be",
    PATH + "times: [1, 1]": "times[1]: times must increase; expected more than 1, got 1.0",
    PATH + "times: [1]": "times: expected 2 finite numbers",
    TARGET + "times: [1]": "times: cannot be combined with target; expected those of a path",
    "path: timed.csv\ntimes: [0, 1]": "times: are in the file of the path, too; expected one of both",
    "tolerance: {angel: 1}": "tolerance.angel: unknown key; did you mean 'angle'?",
    "start: [[0, 0, 1]]": "start: shape (1, 3); expected 2 rows of 3 finite numbers, got [[0, 0, 1]]",
    "start: {status: solved}": "start.q: missing; expected a result of an earlier solve, got {'status': 'solved'}",
    "start: missing.json": "start: cannot be read: No such file or directory; expected the name of a file",
    "goal: [[0, 0, 1]]": "goal: shape (1, 3); expected 2 rows of 3 finite numbers, got [[0, 0, 1]]",
    "prefer: {bend: 1}": "prefer.bend: unknown key; did you mean 'bends'?",
    "rates: {length: [1, 2, 3]}": "rates.length: expected one number, or 2, got [1.0, 2.0, 3.0]",
    "rates: {acceleration: {speed: 1}}": "rates.acceleration.speed: unknown key; expected one of bend, length,",
    "tagret: 1": "tagret: unknown key; did you mean 'target'?",
    '"a b\\n\\e[31m": 1': "'a b\\n\\x1b[31m': unknown key; expected one of robot, scene, target, targets, path, goal, ",
}
"""What stands in a file beside a robot and a target, where it has none of its own, and how the refusal begins."""

WHOLE = {
    "robot: [\n": "line 2: a list, mapping or quotation is not closed; expected YAML, got 'the end of the file'",
    "robot: {a: 1\n": "line 2: a list, mapping or quotation is not closed; expected YAML",
    "robot: 'a\n": "line 2: a list, mapping or quotation is not closed; expected YAML",
    ROBOT: "target: missing; expected one of target, targets, path, goal, got ['robot']",
    "": "file: missing; expected a mapping with robot, scene, target, targets, path, goal, tolerance",
    "just a text": "file: expected a mapping with robot, scene, target, targets, path, goal, ",
}


def completed(text: str) -> str:
    """Add a robot and a target where a file has none."""
    lines = [*([] if text.startswith("robot") else [ROBOT]), text]
    asks = any(text.startswith(key) for key in ("target", "path", "goal"))
    return "\n".join([*lines, *([] if asks else [TARGET])])


@pytest.mark.parametrize(
    ("text", "refusal"), [*((completed(text), said) for text, said in WRONG.items()), *WHOLE.items()], ids=str
)
def test_bad_input_is_one_line_that_says_where_and_why(read: Read, text: str, refusal: str) -> None:
    began = time.process_time()
    with pytest.raises(sn.InputError) as caught:
        read(text)
    assert time.process_time() - began < 0.5
    assert str(caught.value).startswith(f"problem.yaml: {refusal}")
    assert len(str(caught.value).splitlines()) == 1


def test_what_cannot_be_read_is_refused_under_its_own_name(read: Read) -> None:
    Path("binary.yaml").write_bytes(b"\xff\xfe")
    for file, refusal in (
        ("binary.yaml", "not UTF-8 at byte 0; expected "),
        ("missing.yaml", "cannot be read: No such file or directory; expected "),
        (".", "cannot be read: "),
    ):
        with pytest.raises(sn.InputError) as caught:
            read_problem(file)
        assert str(caught.value).startswith(f"{file}: {refusal}")
        assert str(caught.value).count(file) == 1
    Path("earlier.json").write_text('{"q": [[0, 0, NaN]]}')
    words = ": expected a finite number, got nan"
    refused("q[0][2]", lambda: read(ROBOT + TARGET + "start: earlier.json"), words, file="earlier.json")
