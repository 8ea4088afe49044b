"""Everything that Python calls is compiled ahead, once, and nothing is compiled for what users do afterwards."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import sinuous
from sinuous.cli.warm_steps import steps
from sinuous.kernels.compiling.pieces import FREE, PIECES
from sinuous.methods.registry import METHODS
from tests.kernels.test_compile import decorated

PACKAGE = Path(sinuous.__file__).parent
ROOT = PACKAGE.parents[1]

USE = """
import numpy as np, pickle, sys
import sinuous as sn
from benchmarks.places import make
from sinuous.kernels import compile as compiling
from sinuous.kernels.compiling.pieces import name_of

made, plain, around = [], compiling.entry, compiling.entry_around
compiling.entry = lambda function: made.append(plain(function)) or made[-1]
compiling.entry_around = lambda inner, function: made.append(around(inner, function)) or made[-1]
from sinuous.cli.warm_steps import steps
for step in steps():
    step.use()
warm = [name_of(one, form) for one in made for form in one.signatures]
forms = {one: len(one.signatures) for one in made}
print(warm)

robot = sn.Robot.uniform(3, (0.8, 1.2), radius=0.05, tendons=sn.Tendons(3, 0.05, displacement=(-1, 1)))
cloud = sn.PointCloud(np.array([[2.0, 2.0, 2.0], [2.0, 2.0, 2.1]]), 0.05)
scene = sn.Scene([sn.Sphere((0.5, 0, 1.5), 0.2), cloud])
target = sn.Target((1, 0, 2), direction=(1, 0, 0.5))
near = sn.Solver(robot, scene, prefer=sn.Preferences(start=1.0))
solver = sn.Solver(robot, scene)
solution = solver.solve(target)
solver.solve([target, sn.Target((0.5, 0.5, 1.0), segment=2)], initial=solution, time=1)
solver.solve_many([target, target], initial=[solution, solution.q])
apart = [sn.Target((0.5, 0, 1.8), segment=2), sn.Target((0.5, 0, 0.2))]
for given in (None, solution, [solution.q] * 2):
    assert not solver.solve_many([apart, apart], given, time=0.2).solved.any()
solver.solve_many(positions=[[1, 0, 2]] * 2, directions=[[1, 0, 0.5]] * 2, initial=[solution] * 2)
solver.solve_all(target, count=2)
keeping = sn.Solver(robot, scene, memory=sn.Memory(robot))
keeping.solve(target), keeping.solve(target), keeping.solve_many([target, target])
near.solve(target, initial=solution)
near.solve_many([target])
scene.update(np.array([[2.0, 2.0, 2.2]]))
sn.track(robot, sn.Target.each(np.array([[1, 0, 2], [1, 0.1, 2]])), scene)
sn.plan(robot, solution, sn.Target((1, 0.1, 2)), scene), sn.plan(robot, solution, [[0, 0, 1.0]] * 3)
sn.solve(robot, sn.Target((9, 0, 0)), [sn.Box((0, 0, 5), (1, 1, 1), inside=True)])
again = pickle.loads(pickle.dumps(solver))
again.solve(pickle.loads(pickle.dumps(target)))
for q in (solution.q, solution.q.tolist(), np.array([solution.q, solution.q]), np.asfortranarray(solution.q)):
    robot.forward(q), robot.backbone(q), robot.jacobian(q), robot.jacobian(q, 1), robot.tip(q)
solution.verify(), solution.worst, solution.binding, solution.explain(0.2)
sn.solve(robot, sn.Target((9, 0, 0)), scene, time=0.1).explain(0.2)
scene.distance([[0, 0, 0]]), scene.gradient(np.zeros(3))
for family, number in (("cells pipe", 49), ("pipe between", 17), ("door in mesh", 0), ("open pipe 1.3", 1)):
    place = make(family, number)
    assert sn.solve(place.robot, place.targets, place.scene, tolerance=place.tolerance, time=60).solved
late = {name_of(one, ()): one.signatures for one in made if len(one.signatures) > forms[one]}
print(late)
"""


def test_everything_is_compiled_ahead_and_in_one_form() -> None:
    """In a process of its own: other tests call entries with whatever they like."""
    done = subprocess.run([sys.executable, "-c", USE], capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    warm, late = map(ast.literal_eval, done.stdout.splitlines()[-2:])
    assert sorted(warm) == sorted(entry for piece in PIECES for entry in piece.entries)
    assert late == {}


def made_around(file: Path) -> list[str]:
    """Names of the entries of a file that are made around another kernel."""
    return re.findall(r"^(\w+) = search_by\(", file.read_text(encoding="utf-8"), re.MULTILINE)


def test_every_entry_is_in_one_piece() -> None:
    listed = [entry for piece in PIECES for entry in piece.entries]
    assert len(set(listed)) == len(listed)
    entries = {
        ".".join([*file.relative_to(PACKAGE).with_suffix("").parts, name])
        for room in ("kernels", "methods")
        for file in (PACKAGE / room).rglob("*.py")
        for name in (*decorated(file, "entry"), *made_around(file))
    }
    assert {entry.removesuffix(FREE) for entry in listed} == entries


def test_methods_that_are_not_asked_for_are_left_out() -> None:
    named = [step.what for step in steps(["dls", "dls"])]
    geometry = ["kinematics", "starts of a memory", "distances", "classes of routes", "motions", "plans"]
    bodies = ["derivatives", "derivatives among obstacles", "shapes under load"]
    assert named == [*geometry, "control loops", *bodies, "the method dls"]
    assert {step.what for step in steps()} >= {f"the method {name}" for name in METHODS if name != "newton"}
