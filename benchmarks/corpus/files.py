"""Files in and out, the command line, and what wrong input is answered with."""

import contextlib
import io
import json
import math
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import sinuous as sn
from benchmarks.corpus.answers import CHANGING, CLOCKED, Problem
from benchmarks.wild import odd
from sinuous.cli.app import main

EXAMPLES = Path(__file__).parents[2] / "examples"


def written() -> Iterator[Problem]:
    """Robots, scenes, problems and motions, written and read again; chains of joints; tables of motions."""
    for number in range(150):
        rng = np.random.default_rng([91, number])
        robot = odd.robot(rng)
        scene, q, target = odd.scene(robot, rng), odd.shape(robot, rng), odd.target(robot, rng)
        other = odd.shape(robot, rng)
        yield Problem(f"{number} problem", partial(_saved, sn.Job(robot, target, scene), sn.Job, "job.yaml"))
        yield Problem(f"{number} robot", partial(_saved, robot, sn.Robot, "robot.json"))
        yield Problem(f"{number} joints", partial(_exported, robot, q))
        yield Problem(f"{number} scene", partial(_saved, scene, sn.Scene, "scene.yaml"))
        if not scene.snapshot().moves:
            motion = sn.Motion(robot, [q, other, q])
            yield Problem(f"{number} motion", partial(_tables, motion))


def _saved(value: Any, kind: type[Any], name: str) -> Any:
    with TemporaryDirectory() as folder:
        file = Path(folder) / name
        value.save(file)
        again = sn.load(file, kind)
        return file.read_text(), again.entries(folder) if isinstance(again, sn.Scene) else again.to_dict()


def _exported(robot: sn.Robot, q: Any) -> Any:
    with TemporaryDirectory() as folder:
        urdf, mjcf = Path(folder) / "arm.urdf", Path(folder) / "arm.xml"
        chain = robot.to_urdf(urdf, joints_per_segment=2)
        driven = robot.to_mjcf(mjcf, joints_per_segment=2)
        return urdf.read_text(), chain.values(q), mjcf.read_text(), driven.controls(q)


def _tables(motion: sn.Motion) -> Any:
    with TemporaryDirectory() as folder:
        csv, fine, ros, npz = (Path(folder) / name for name in ("a.csv", "b.csv", "a.json", "a.npz"))
        motion.to_csv(csv)
        motion.to_csv(fine, rate=4.0)
        motion.to_ros(ros, joints_per_segment=2)
        motion.to_npz(npz)
        motion.save(Path(folder) / "motion.json")
        again, tabled = sn.load(Path(folder) / "motion.json", sn.Motion), sn.Motion.from_npz(npz, motion.robot)
        return csv.read_text(), fine.read_text(), json.loads(ros.read_text()), again, tabled.q


def examples() -> Iterator[Problem]:
    """Files of the examples, by the command line, with what is printed as JSON."""
    for file in sorted(EXAMPLES.glob("*.yaml")):
        what = "plan" if file.stem.startswith("plan") else "track" if file.stem.startswith("path") else "solve"
        yield Problem(f"{what} {file.name}", partial(_printed, f"{what} {file} --json --time 20"))
        yield Problem(f"check {file.name}", partial(_printed, f"check {file} --json"))
        yield Problem(f"read {file.name}", partial(_loaded, file))
    for given in COMMANDS:
        yield Problem(given, partial(_with_results, given))


COMMANDS = (
    *(f"solve pose.yaml --method {name} --json" for name in ("dls", "fabrikc", "opti_path", "slinki", "monte_carlo")),
    "solve pose.yaml --all 4 --json --max-starts 40 --time 20",
    "solve insertion_room.yaml --why --json --time 20 --max-starts 40",
    "solve four_poses_a.yaml --seed 3 --clearance 1 --csv OUT.csv --out OUT.json --time 20",
    "plan plan.yaml --csv OUT.csv --out OUT.json --seed 2 --time 20",
    "plan plan_past_a_gate.yaml --csv OUT.csv --time 20",
    "track path_through_spheres.yaml --csv OUT.csv --no-routes --time 20",
    "batch pose.yaml --targets path_through_spheres.csv --out OUT.csv --json --time 20 --workers 1 --max-starts 4",
    "reach pose.yaml --spacing 60 --directions 6 --json --time 20 --workers 1",
    "explore pose.yaml --memory OUT.memory --rounds 1 --max-starts 2 --time 600 --workers 1 --json",
    "calibrate ../benchmarks/data/v4.yaml measured.csv --fit offsets --json --out OUT.yaml",
)
"""What is typed, in the folder of the examples; `OUT` is a file for the time being."""


def _with_results(given: str) -> Any:
    """Run a command; return what it prints, and what it writes, without columns and keys of seconds."""
    with TemporaryDirectory() as folder, contextlib.chdir(EXAMPLES):
        printed = _printed(given.replace("OUT", f"{folder}/out"))
        return printed, {file.suffix: _content(file) for file in sorted(Path(folder).iterdir())}


def _content(file: Path) -> Any:
    if file.suffix == ".json":
        text = file.read_text()
        return [json.loads(each) for each in (text.splitlines() if text.startswith('{"') else [text])]
    if file.suffix == ".csv":
        head, *rows = [line.split(",") for line in file.read_text().splitlines()]
        return [[each for name, each in zip(head, row, strict=True) if name not in CLOCKED] for row in (head, *rows)]
    return file.read_text() if file.suffix == ".yaml" else None


def _loaded(file: Path) -> Any:
    return sn.load(file).to_dict(EXAMPLES)


def _printed(typed: str) -> Any:
    out, error = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
        code = main(typed.split())
    lines = out.getvalue().splitlines()
    told = [json.loads(line) for line in lines if line.startswith("{")]
    said = [line for line in lines if not line.startswith("{")]
    return {"code": code, "told": told, "words": [*said, error.getvalue()]}


ARM = sn.Robot.uniform(3, (45, 70), max_bend=2.0, radius=4.0, tendons=sn.Tendons(3, radius=3.0))
Q = np.array([[0.1, 0.0, 55.0]] * 3)

WRONG: dict[str, Callable[[], Any]] = {
    "length below 0": lambda: sn.Segment(-1.0),
    "length reversed": lambda: sn.Segment((3.0, 2.0)),
    "bend is NaN": lambda: sn.Segment(1.0, max_bend=math.nan),
    "radius is text": lambda: sn.Segment(1.0, radius="thick"),  # type: ignore[arg-type]
    "no segment": lambda: sn.Robot([]),
    "no segments": lambda: sn.Robot.uniform(0, 1.0),
    "base is no pose": lambda: ARM.changed(base=np.zeros((4, 4))),
    "self_collision": lambda: ARM.changed(self_collision="maybe"),  # type: ignore[arg-type]
    "two names": lambda: sn.Robot([sn.Segment(1.0, name="a"), sn.Segment(1.0, name="a")]),
    "tendons none": lambda: sn.Tendons(0, radius=1.0),
    "tendons reversed": lambda: sn.Tendons(3, radius=1.0, displacement=(1.0, -1.0)),
    "chambers flat": lambda: sn.Chambers(3, radius=-1.0),
    "stiffness below 0": lambda: sn.Stiffness(-1.0),
    "target of nothing": sn.Target,
    "target too long": lambda: sn.Target((1.0, 2.0, 3.0, 4.0)),
    "direction of 0": lambda: sn.Target((1.0, 2.0, 3.0), direction=(0.0, 0.0, 0.0)),
    "two orientations": lambda: sn.Target(direction=(0, 0, 1), rotation=(1, 0, 0, 0)),
    "tolerance below 0": lambda: sn.Tolerance(-1.0),
    "sphere below 0": lambda: sn.Sphere((0, 0, 0), -1.0),
    "box without size": lambda: sn.Box((0, 0, 0), (1, 1)),
    "capsule": lambda: sn.Capsule((0, 0, 0), (0, 0), 1.0),
    "half space": lambda: sn.HalfSpace((0, 0, 0), (0, 0, 0)),
    "mesh of no faces": lambda: sn.Scene([sn.Mesh(np.zeros((3, 3)), np.zeros((0, 3), int))]).prepare(),
    "cloud of NaN": lambda: sn.PointCloud([[0, 0, math.nan]], 1.0),
    "grid flat": lambda: sn.Grid(np.zeros((2, 2)), (0, 0, 0), 1.0),
    "moving backwards": lambda: sn.Moving(sn.Sphere((0, 0, 0), 1.0), [1.0, 0.0], [(0, 0, 0), (1, 0, 0)]),
    "two obstacles of one name": lambda: sn.Scene(
        [sn.Sphere((0, 0, 0), 1, name="a"), sn.Sphere((0, 0, 9), 1, name="a")]
    ),
    "scene of a number": lambda: sn.solve(ARM, (0, 0, 150), 3.0),  # type: ignore[arg-type]
    "robot of a list": lambda: sn.solve([1], (0, 0, 150)),  # type: ignore[arg-type]
    "unknown option": lambda: sn.solve(ARM, (0, 0, 150), metod="dls"),  # type: ignore[call-arg]
    "unknown method": lambda: sn.solve(ARM, (0, 0, 150), method="magic"),  # type: ignore[arg-type]
    "time below 0": lambda: sn.solve(ARM, (0, 0, 150), time=-1.0),
    "starts 0": lambda: sn.solve(ARM, (0, 0, 150), max_starts=0),
    "seed": lambda: sn.solve(ARM, (0, 0, 150), seed=-1),
    "without": lambda: sn.solve(ARM, (0, 0, 150), without="thinking"),
    "initial": lambda: sn.solve(ARM, (0, 0, 150), initial=np.zeros((2, 3))),
    "segment": lambda: sn.solve(ARM, sn.Target((0, 0, 150), segment=7)),
    "within alone": lambda: sn.Solver(ARM).solve((0, 0, 150), within=sn.Rates(1.0) * 0.1),
    "solve_all count": lambda: sn.solve_all(ARM, (0, 0, 150), count=0),
    "solve_all by": lambda: sn.solve_all(ARM, (0, 0, 150), by="luck"),  # type: ignore[arg-type]
    "many of nothing": lambda: sn.Solver(ARM).solve_many(),
    "many positions": lambda: sn.Solver(ARM).solve_many(positions=np.zeros((3, 2))),
    "step of nothing": lambda: sn.Solver(ARM).step(Q),
    "step of two": lambda: sn.Solver(ARM).step(Q, (0, 0, 1), 0.1, target=sn.Target((0, 0, 150))),
    "step in no time": lambda: sn.Solver(ARM).step(Q, (0, 0, 1), -0.1),
    "plan from outside": lambda: sn.plan(ARM, Q, 9.0 * Q),
    "plan among moving": lambda: sn.plan(
        ARM, Q, Q, sn.Moving(sn.Sphere((0, 0, 0), 1.0), [0, 1], [(0, 99, 0), (0, 99, 9)])
    ),
    "plan shortcuts": lambda: sn.plan(ARM, Q, Q, shortcuts=-1),
    "track nothing": lambda: sn.track(ARM, []),
    "track times": lambda: sn.track(ARM, [sn.Target((0, 0, 150))] * 2, times=[1.0, 0.0]),
    "leader without advance": lambda: sn.follow_the_leader(sn.Robot.uniform(2, 1.0), [(0, 0, 0), (0, 0, 1)]),
    "rates 0": lambda: sn.Rates(bend=0.0),
    "motion at": lambda: sn.Motion(ARM, [Q, Q]).at(math.nan),
    "motion of nothing": lambda: sn.Motion(ARM, np.zeros((0, 2, 3))),
    "actuators by no name": lambda: ARM.from_actuators({"left": 1.0}),
    "actuators too many": lambda: ARM.from_actuators(np.zeros(17)),
    "load on a rigid body": lambda: ARM.shape(Q, sn.Force((0, 0, 1))),
    "calibrate one row": lambda: sn.studies.calibrate(ARM, np.zeros((1, 2)), np.zeros((1, 3))),
    "design of nothing": lambda: sn.studies.design(ARM, [], vary={"radius": (1.0, 2.0)}, minimise="length"),
    "design field": lambda: sn.studies.design(ARM, [(0, 0, 150)], vary={"colour": (1.0, 2.0)}, minimise="length"),
    "design objective": lambda: sn.studies.design(ARM, [(0, 0, 150)], vary={"radius": (1.0, 2.0)}, minimise="price"),
    "sweep field": lambda: sn.studies.sweep(ARM, {"colour": [1, 2]}),
    "reach spacing": lambda: sn.studies.reach(ARM, spacing=0.0),
    "batch of text": lambda: sn.studies.solve_batch(ARM, "nowhere.csv"),
    "batch out": lambda: sn.studies.solve_batch(ARM, {"positions": [[0, 0, 150]]}, out="results.doc"),
    "explore moving": lambda: sn.studies.explore(
        ARM, sn.Moving(sn.Sphere((0, 0, 0), 1.0), [0, 1], [(0, 99, 0), (0, 99, 9)])
    ),
    "memory of another": lambda: sn.solve(ARM, (0, 0, 150), memory=sn.Memory(sn.Robot.uniform(2, 1.0))),
    "load nothing": lambda: sn.load("nowhere.yaml"),
    "derivative of": lambda: sn.solve(ARM, (0, 0, 150)).derivative("weather"),  # type: ignore[arg-type]
    "unsolved": lambda: sn.solve(ARM, (0, 0, 1e6)).raise_for_status(),
    "pose of two": lambda: sn.pose((0, 0, 0), direction=(0, 0, 1), rotation=(1, 0, 0, 0)),
    "curve of one point": lambda: sn.Curve([(0, 0, 0)]),
}
"""What cannot be meant, each with the exception that says so."""

GOOD = "robot: {segments: [{length: 1}]}\ntarget: {position: [0, 0, 1]}"

FILES: dict[str, str] = {
    "empty": "",
    "no robot": "target: [0, 0, 1]",
    "robot of text": "robot: arm\ntarget: [0, 0, 1]",
    "unknown key": "robot: {segments: [{length: 1}], colour: red}\ntarget: [0, 0, 1]",
    "wrong length": "robot: {segments: [{length: -1}]}\ntarget: {position: [0, 0, 1]}",
    "no target": "robot: {segments: [{length: 1}]}",
    "target too short": "robot: {segments: [{length: 1}]}\ntarget: {position: [0, 1]}",
    "obstacle unknown": "robot: {segments: [{length: 1}]}\nscene: [{cone: {radius: 1}}]\ntarget: {position: [0, 0, 1]}",
    "sphere without radius": f"{GOOD}\nscene: [{{sphere: {{center: [0, 0, 1]}}}}]",
    "mesh nowhere": f"{GOOD}\nscene: [{{mesh: {{file: nowhere.stl}}}}]",
    "goal without start": "robot: {segments: [{length: 1}]}\ngoal: [[0, 0, 1]]",
    "two keys": "robot: {segments: [{length: 1}]}\nrobot: {segments: [{length: 2}]}\ntarget: {position: [0, 0, 1]}",
    "no YAML": "robot: {segments: [",
    "text for a number": "robot: {segments: [{length: long}]}\ntarget: {position: [0, 0, 1]}",
    "infinite": "robot: {segments: [{length: .inf}]}\ntarget: {position: [0, 0, 1]}",
    "path nowhere": "robot: {segments: [{length: 1}]}\npath: nowhere.csv",
    "count and list": "robot: {segments: {count: 0, length: 1}}\ntarget: {position: [0, 0, 1]}",
}


def wrong() -> Iterator[Problem]:
    """Wrong arguments, wrong files, and wrong command lines."""
    for name, call in WRONG.items():
        yield Problem(name, partial(_kind_of, call))
    for name, text in FILES.items():
        yield Problem(f"file: {name}", partial(_read, text))
        yield Problem(f"command: {name}", partial(_read, text, by_command=True))
    for typed in ("solve", "solve nowhere.yaml", "magic", f"plan {EXAMPLES / 'pose.yaml'}", "solve --fast", "track 3"):
        yield Problem(f"command {CHANGING.sub('', typed)}", partial(_printed, typed))


def _kind_of(call: Callable[[], Any]) -> str:
    return type(call()).__name__


def _read(text: str, by_command: bool = False) -> Any:
    with TemporaryDirectory() as folder:
        file = Path(folder) / "job.yaml"
        file.write_text(text)
        if by_command:
            return _printed(f"solve {file} --time 5")
        return sn.load(file, sn.Job).to_dict()


PIECES: dict[str, Callable[[], Iterator[Problem]]] = {"files": written, "command line": examples, "wrong input": wrong}
