"""What `import sinuous` offers, and what it costs."""

import ast
import importlib
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import sinuous as sn
from tests.helpers import with_each
from tests.public import ENTRANCES

MOVED = [(name, home) for home, names in sn._MOVED.items() for name in names.split()]  # type: ignore[attr-defined]


@with_each("entrance", ENTRANCES)
def test_every_name_is_there(entrance: ModuleType) -> None:
    for name in set(entrance.__all__) - {"__version__"}:
        assert getattr(entrance, name).__module__.startswith("sinuous.")  # and no import of the module itself
        assert name in dir(entrance)


@with_each("entrance", ENTRANCES)
def test_type_checkers_see_the_same_names(entrance: ModuleType) -> None:
    stub = ast.parse(Path(str(entrance.__file__)).with_suffix(".pyi").read_text(encoding="utf-8"))
    imported = {(node.module, node.names[0].name) for node in stub.body if isinstance(node, ast.ImportFrom)}
    names = {name for home, name in imported if home != "sinuous"}
    assert names == set(entrance.__all__) - {"__version__"}
    for home, name in imported:
        public = getattr(entrance, name)  # which may put a wrapper in its place there
        assert getattr(importlib.import_module(str(home)), name) is public


@with_each(("name", "home"), MOVED)
def test_a_name_that_has_moved_says_where_it_is(name: str, home: str) -> None:
    with pytest.warns(DeprecationWarning, match=rf"^sinuous\.{name} is {home}\.{name} now$") as caught:
        value = getattr(sn, name)
    assert value is getattr(importlib.import_module(home), name)
    assert caught[0].filename == __file__


def test_a_module_that_has_moved_says_where_it_is() -> None:
    with pytest.warns(DeprecationWarning, match=r"sinuous\.robot(\.rates)? is sinuous\.model") as caught:
        from sinuous.robot.rates import Changes  # type: ignore[import-not-found]
    from sinuous.model.rates import Changes as New

    assert Changes is New
    assert caught[-1].filename == __file__
    with pytest.warns(DeprecationWarning, match=r"sinuous\.errors is sinuous\.base\.errors now"):
        import sinuous.errors  # type: ignore[import-not-found]
    assert sinuous.errors.InputError is sn.InputError
    with pytest.raises(ModuleNotFoundError):
        importlib.import_module("sinuous.teleport")


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="'teleport'"):
        _ = sn.teleport  # type: ignore[attr-defined]


def test_the_import_brings_nothing_heavy_and_kernels_are_as_users_have_them() -> None:
    """The other tests run in a process where Python can call every kernel; users have wrappers for entries alone."""
    code = (
        "import sys, sinuous as sn\n"
        "print(sorted({'numpy', 'numba', 'scipy', 'yaml', 'matplotlib'} & set(sys.modules)))\n"
        "robot = sn.Robot.uniform(3, (0.8, 1.2), radius=0.05)\n"
        "scene = sn.Scene([sn.Sphere((1, 0, 1), 0.2)])\n"
        "solution = sn.solve(robot, sn.Target((0, 1, 2), direction=(0, 1, 1)), scene)\n"
        "robot.jacobian(solution.q), scene.distance(robot.backbone(solution.q))\n"
        "print(solution.status, solution.verify().ok)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.strip()) == (0, "[]\nsolved True"), done.stderr


@with_each(
    ("old", "new"),
    [("hangs", "is Robot.has_external_load now"), ("demands", "is private now"), ("least_demanded", "is private now")],
)
def test_an_attribute_that_was_renamed_says_its_name(old: str, new: str) -> None:
    robot = sn.Robot.uniform(2, 50)
    with pytest.warns(DeprecationWarning, match=rf"^Robot\.{old} {new}$"):
        value = getattr(robot, old)
    assert value in (False, (0.0, 0.0))


def test_a_solver_answers_to_its_old_names() -> None:
    with pytest.warns(DeprecationWarning, match=r"^Solver\.once is private now$"):
        made = sn.Solver.once(sn.Robot.uniform(2, 50))
    assert isinstance(made, sn.Solver)


def test_a_scene_says_how_it_grows() -> None:
    scene: Any = sn.Scene()
    for name in ("add", "append", "remove"):
        with pytest.raises(AttributeError, match=r"sn\.Scene\(\[scene, obstacle\]\) is a new scene"):
            getattr(scene, name)
    with pytest.raises(AttributeError, match="no attribute 'obstacle'"):
        _ = scene.obstacle


def test_attributes_that_one_guesses_say_where_that_is() -> None:
    robot = sn.Robot.uniform(2, 50)
    solution = sn.solve(robot, (0, 0, 100))
    motion = sn.Motion(robot, [solution.q, solution.q])
    for thing, name, words in (
        (robot, "fk", "robot.tip"),
        (robot, "solve", "sn.solve"),
        (solution, "success", "solution.solved"),
        (solution, "to_csv", "solution.actuators"),
        (motion, "plot", "sn.plot"),
    ):
        with pytest.raises(AttributeError, match=words):
            getattr(thing, name)
        assert not hasattr(thing, "nothing")
