"""Inverse kinematics and motion of continuum robots among obstacles.

Names are imported when they are first used, so that `import sinuous` costs next to nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from sinuous.actuators import Chambers as Chambers
    from sinuous.actuators import Tendons as Tendons
    from sinuous.errors import InputError as InputError
    from sinuous.errors import NotSolvedError as NotSolvedError
    from sinuous.methods.dls import Dls as Dls
    from sinuous.methods.fabrik_avoid import FabrikAvoid as FabrikAvoid
    from sinuous.methods.fabrikc import Fabrikc as Fabrikc
    from sinuous.methods.fabrikx import Fabrikx as Fabrikx
    from sinuous.methods.monte_carlo import MonteCarlo as MonteCarlo
    from sinuous.methods.opti_path import OptiPath as OptiPath
    from sinuous.methods.slinki import Slinki as Slinki
    from sinuous.plotting import plot_solution as plot_solution
    from sinuous.poses import pose as pose
    from sinuous.problem import Preferences as Preferences
    from sinuous.problem import Problem as Problem
    from sinuous.problem import Tolerance as Tolerance
    from sinuous.robot import Robot as Robot
    from sinuous.robot import Segment as Segment
    from sinuous.robot import arc_parameters as arc_parameters
    from sinuous.robot import from_arc_parameters as from_arc_parameters
    from sinuous.scene.field import Field as Field
    from sinuous.scene.grid import Grid as Grid
    from sinuous.scene.mesh import Mesh as Mesh
    from sinuous.scene.obstacles import Box as Box
    from sinuous.scene.obstacles import Capsule as Capsule
    from sinuous.scene.obstacles import Cylinder as Cylinder
    from sinuous.scene.obstacles import HalfSpace as HalfSpace
    from sinuous.scene.obstacles import Sphere as Sphere
    from sinuous.scene.point_cloud import PointCloud as PointCloud
    from sinuous.scene.scene import Scene as Scene
    from sinuous.solution import Solution as Solution
    from sinuous.solution import Status as Status
    from sinuous.solving import Solver as Solver
    from sinuous.solving import solve as solve
    from sinuous.solving import solve_all as solve_all
    from sinuous.target import Target as Target
    from sinuous.tracking import Track as Track
    from sinuous.tracking import track as track

_HOMES = {
    "actuators": ("Chambers", "Tendons"),
    "errors": ("InputError", "NotSolvedError"),
    "methods.dls": ("Dls",),
    "methods.fabrik_avoid": ("FabrikAvoid",),
    "methods.fabrikc": ("Fabrikc",),
    "methods.fabrikx": ("Fabrikx",),
    "methods.monte_carlo": ("MonteCarlo",),
    "methods.opti_path": ("OptiPath",),
    "methods.slinki": ("Slinki",),
    "plotting": ("plot_solution",),
    "poses": ("pose",),
    "problem": ("Preferences", "Problem", "Tolerance"),
    "robot": ("Robot", "Segment", "arc_parameters", "from_arc_parameters"),
    "scene.field": ("Field",),
    "scene.grid": ("Grid",),
    "scene.mesh": ("Mesh",),
    "scene.obstacles": ("Box", "Capsule", "Cylinder", "HalfSpace", "Sphere"),
    "scene.point_cloud": ("PointCloud",),
    "scene.scene": ("Scene",),
    "solution": ("Solution", "Status"),
    "solving": ("Solver", "solve", "solve_all"),
    "target": ("Target",),
    "tracking": ("Track", "track"),
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [*_HOME, "__version__"]  # noqa: PLE0604


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'sinuous' has no attribute {name!r}")
    value = getattr(import_module(f"sinuous.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
