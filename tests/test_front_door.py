"""What `import sinuous` offers, and what it costs."""

import subprocess
import sys

import pytest

import sinuous as sn


def test_every_name_is_there() -> None:
    for name in sn.__all__:
        value = getattr(sn, name)
        assert name == "__version__" or value.__module__.startswith("sinuous.")  # and no import of the module itself
        assert name in dir(sn)


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="'teleport'"):
        _ = sn.teleport  # type: ignore[attr-defined]


def test_kernels_as_users_have_them() -> None:
    """The other tests run in a process where Python can call every kernel; users have wrappers for entries alone."""
    code = (
        "import sinuous as sn\n"
        "robot = sn.Robot.uniform(3, (0.8, 1.2), radius=0.05)\n"
        "scene = sn.Scene([sn.Sphere((1, 0, 1), 0.2)])\n"
        "solution = sn.solve(robot, sn.Target((0, 1, 2), direction=(0, 1, 1)), scene)\n"
        "robot.jacobian(solution.q), scene.distance(robot.backbone(solution.q))\n"
        "print(solution.status, solution.verify().ok)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.strip()) == (0, "solved True"), done.stderr


def test_the_import_brings_nothing_heavy() -> None:
    code = "import sys, sinuous; print(sorted({'numpy', 'numba', 'scipy', 'yaml', 'matplotlib'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
