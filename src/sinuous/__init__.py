"""Inverse kinematics and motion of continuum robots among obstacles.

Names are imported when they are first used, so that `import sinuous` costs next to nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from sinuous.notebook import NotebookMixin

__version__ = "0.2.0.dev0"

if TYPE_CHECKING:
    from sinuous.assessing.assess import assess as assess
    from sinuous.assessing.assessment import Assessment as Assessment
    from sinuous.assessing.moves import Move as Move
    from sinuous.assessing.sweep import sweep as sweep
    from sinuous.assessing.tasks import Follow as Follow
    from sinuous.batch.batch import Batch as Batch
    from sinuous.batch.solve import solve_batch as solve_batch
    from sinuous.errors import InputError as InputError
    from sinuous.errors import NotSolvedError as NotSolvedError
    from sinuous.errors import UnfinishedError as UnfinishedError
    from sinuous.export.chain import JointChain as JointChain
    from sinuous.measures.following import Deviation as Deviation
    from sinuous.methods.dls import Dls as Dls
    from sinuous.methods.fabrik.avoiding import FabrikAvoid as FabrikAvoid
    from sinuous.methods.fabrik.reaching import Fabrikc as Fabrikc
    from sinuous.methods.fabrik.reaching import Fabrikx as Fabrikx
    from sinuous.methods.monte_carlo import MonteCarlo as MonteCarlo
    from sinuous.methods.newton import Newton as Newton
    from sinuous.methods.opti_path.options import OptiPath as OptiPath
    from sinuous.methods.slinki.search import Slinki as Slinki
    from sinuous.motion.job import Job as Job
    from sinuous.motion.job import load as load
    from sinuous.motion.leader import follow_the_leader as follow_the_leader
    from sinuous.motion.leader import on_stage as on_stage
    from sinuous.motion.motion import Motion as Motion
    from sinuous.motion.plan import Planner as Planner
    from sinuous.motion.plan import plan as plan
    from sinuous.motion.track import track as track
    from sinuous.motion.trajectory import Trajectory as Trajectory
    from sinuous.pictures.animate import animate as animate
    from sinuous.pictures.assessment import plot_assessment as plot_assessment
    from sinuous.pictures.diagrams import diagram as diagram
    from sinuous.pictures.plot import plot as plot
    from sinuous.pictures.workspace import plot_reach as plot_reach
    from sinuous.poses import pose as pose
    from sinuous.problem.curve import Curve as Curve
    from sinuous.problem.path import Path as Path
    from sinuous.problem.preferences import Preferences as Preferences
    from sinuous.problem.problem import Problem as Problem
    from sinuous.problem.suspicions import SuspiciousInput as SuspiciousInput
    from sinuous.problem.target import Target as Target
    from sinuous.problem.target import Tolerance as Tolerance
    from sinuous.robot.actuation import Actuator as Actuator
    from sinuous.robot.actuators import Actuators as Actuators
    from sinuous.robot.actuators import Chambers as Chambers
    from sinuous.robot.actuators import Tendons as Tendons
    from sinuous.robot.rates import Changes as Changes
    from sinuous.robot.rates import Rates as Rates
    from sinuous.robot.robot import Robot as Robot
    from sinuous.robot.segment import Segment as Segment
    from sinuous.robot.segment import arc_parameters as arc_parameters
    from sinuous.robot.segment import from_arc_parameters as from_arc_parameters
    from sinuous.scene.clouds.point_cloud import PointCloud as PointCloud
    from sinuous.scene.courses.moving import Moving as Moving
    from sinuous.scene.grids.field import Field as Field
    from sinuous.scene.grids.grid import Grid as Grid
    from sinuous.scene.meshes.mesh import Mesh as Mesh
    from sinuous.scene.obstacles import Box as Box
    from sinuous.scene.obstacles import Capsule as Capsule
    from sinuous.scene.obstacles import Cylinder as Cylinder
    from sinuous.scene.obstacles import HalfSpace as HalfSpace
    from sinuous.scene.obstacles import Sphere as Sphere
    from sinuous.scene.scene import Scene as Scene
    from sinuous.solution.explanation import Explanation as Explanation
    from sinuous.solution.solution import Solution as Solution
    from sinuous.solution.solutions import Solutions as Solutions
    from sinuous.solution.status import Status as Status
    from sinuous.solution.step import Active as Active
    from sinuous.solution.step import Step as Step
    from sinuous.solution.verification import Verification as Verification
    from sinuous.solution.verification import Verifications as Verifications
    from sinuous.solution.verification import check as check
    from sinuous.solving.solver import Solver as Solver
    from sinuous.solving.solver import solve as solve
    from sinuous.solving.solver import solve_all as solve_all
    from sinuous.viewer.show import show as show
    from sinuous.workspace.find import reach as reach
    from sinuous.workspace.reach import Reach as Reach
    from sinuous.workspace.verdicts import Verdict as Verdict

_HOMES = {
    "assessing.assess": ("assess",),
    "assessing.assessment": ("Assessment",),
    "assessing.moves": ("Move",),
    "assessing.sweep": ("sweep",),
    "assessing.tasks": ("Follow",),
    "batch.batch": ("Batch",),
    "batch.solve": ("solve_batch",),
    "errors": ("InputError", "NotSolvedError", "UnfinishedError"),
    "export.chain": ("JointChain",),
    "measures.following": ("Deviation",),
    "methods.dls": ("Dls",),
    "methods.fabrik.avoiding": ("FabrikAvoid",),
    "methods.fabrik.reaching": ("Fabrikc", "Fabrikx"),
    "methods.monte_carlo": ("MonteCarlo",),
    "methods.newton": ("Newton",),
    "methods.opti_path.options": ("OptiPath",),
    "methods.slinki.search": ("Slinki",),
    "motion.job": ("Job", "load"),
    "motion.leader": ("follow_the_leader", "on_stage"),
    "motion.motion": ("Motion",),
    "motion.plan": ("Planner", "plan"),
    "motion.track": ("track",),
    "motion.trajectory": ("Trajectory",),
    "pictures.animate": ("animate",),
    "pictures.diagrams": ("diagram",),
    "pictures.plot": ("plot",),
    "pictures.assessment": ("plot_assessment",),
    "pictures.workspace": ("plot_reach",),
    "poses": ("pose",),
    "problem.curve": ("Curve",),
    "problem.path": ("Path",),
    "problem.preferences": ("Preferences",),
    "problem.problem": ("Problem",),
    "problem.suspicions": ("SuspiciousInput",),
    "problem.target": ("Target", "Tolerance"),
    "robot.actuation": ("Actuator",),
    "robot.actuators": ("Actuators", "Chambers", "Tendons"),
    "robot.rates": ("Changes", "Rates"),
    "robot.robot": ("Robot",),
    "robot.segment": ("Segment", "arc_parameters", "from_arc_parameters"),
    "scene.clouds.point_cloud": ("PointCloud",),
    "scene.courses.moving": ("Moving",),
    "scene.grids.field": ("Field",),
    "scene.grids.grid": ("Grid",),
    "scene.meshes.mesh": ("Mesh",),
    "scene.obstacles": ("Box", "Capsule", "Cylinder", "HalfSpace", "Sphere"),
    "scene.scene": ("Scene",),
    "solution.explanation": ("Explanation",),
    "solution.solution": ("Solution",),
    "solution.solutions": ("Solutions",),
    "solution.status": ("Status",),
    "solution.step": ("Active", "Step"),
    "solution.verification": ("Verification", "Verifications", "check"),
    "solving.solver": ("Solver", "solve", "solve_all"),
    "viewer.show": ("show",),
    "workspace.find": ("reach",),
    "workspace.reach": ("Reach",),
    "workspace.verdicts": ("Verdict",),
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [*_HOME, "__version__"]  # noqa: PLE0604


if not TYPE_CHECKING:  # a checker would take every name for one that is there

    def __getattr__(name: str) -> Any:
        if name not in _HOME:
            raise AttributeError(f"module 'sinuous' has no attribute {name!r}")
        value = getattr(import_module(f"sinuous.{_HOME[name]}"), name)
        globals()[name] = value
        return value


def _html(noun: Any) -> str:
    html: str = import_module("sinuous.pictures.html").html(noun)
    return html


NotebookMixin._html_renderer = _html


def __dir__() -> list[str]:
    return sorted(__all__)
