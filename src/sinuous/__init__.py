"""Inverse kinematics and motion of continuum robots among obstacles.

Names are imported when they are first used, so that `import sinuous` costs next to nothing. Here are those that users
type. The options of methods are in `sinuous.methods`; classes that are only returned are in their modules, like
`sinuous.robot.rates.Changes`.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from sinuous.notebook import NotebookMixin

__version__ = "0.2.0.dev0"

if TYPE_CHECKING:
    from sinuous import methods as methods
    from sinuous.assessing.assess import assess as assess
    from sinuous.assessing.assessment import Assessment as Assessment
    from sinuous.assessing.sweep import sweep as sweep
    from sinuous.assessing.tasks import Cover as Cover
    from sinuous.assessing.tasks import Follow as Follow
    from sinuous.assessing.tasks import Move as Move
    from sinuous.batch.solve import solve_batch as solve_batch
    from sinuous.calibration.calibrate import calibrate as calibrate
    from sinuous.calibration.calibrate import suggest as suggest
    from sinuous.calibration.calibration import Calibration as Calibration
    from sinuous.designing.design import Design as Design
    from sinuous.designing.find import design as design
    from sinuous.errors import InputError as InputError
    from sinuous.errors import NotSolvedError as NotSolvedError
    from sinuous.errors import SuspiciousInput as SuspiciousInput
    from sinuous.errors import UnfinishedError as UnfinishedError
    from sinuous.exploring.exploration import Exploration as Exploration
    from sinuous.exploring.explore import explore as explore
    from sinuous.methods.learned.network import Network as Network
    from sinuous.methods.learned.training import train as train
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
    from sinuous.pictures.charts import plot_assessment as plot_assessment
    from sinuous.pictures.charts import plot_calibration as plot_calibration
    from sinuous.pictures.charts import plot_design as plot_design
    from sinuous.pictures.diagrams import diagram as diagram
    from sinuous.pictures.plot import plot as plot
    from sinuous.pictures.workspace import plot_reach as plot_reach
    from sinuous.poses import pose as pose
    from sinuous.problem.curve import Curve as Curve
    from sinuous.problem.path import Path as Path
    from sinuous.problem.preferences import Preferences as Preferences
    from sinuous.problem.problem import Problem as Problem
    from sinuous.problem.target import Target as Target
    from sinuous.problem.target import Tolerance as Tolerance
    from sinuous.robot.actuators import Actuators as Actuators
    from sinuous.robot.actuators import Chambers as Chambers
    from sinuous.robot.actuators import Stage as Stage
    from sinuous.robot.actuators import Tendons as Tendons
    from sinuous.robot.loads import Force as Force
    from sinuous.robot.loads import Payload as Payload
    from sinuous.robot.rates import Rates as Rates
    from sinuous.robot.robot import Robot as Robot
    from sinuous.robot.segment import Segment as Segment
    from sinuous.robot.segment import arc_parameters as arc_parameters
    from sinuous.robot.segment import from_arc_parameters as from_arc_parameters
    from sinuous.robot.stiffness import Stiffness as Stiffness
    from sinuous.robot.uncertainty import Uncertainty as Uncertainty
    from sinuous.scene.grids import Field as Field
    from sinuous.scene.grids import Grid as Grid
    from sinuous.scene.meshes.mesh import Mesh as Mesh
    from sinuous.scene.moving import Moving as Moving
    from sinuous.scene.obstacles import Box as Box
    from sinuous.scene.obstacles import Capsule as Capsule
    from sinuous.scene.obstacles import Cylinder as Cylinder
    from sinuous.scene.obstacles import HalfSpace as HalfSpace
    from sinuous.scene.obstacles import Sphere as Sphere
    from sinuous.scene.point_cloud import PointCloud as PointCloud
    from sinuous.scene.scene import Scene as Scene
    from sinuous.solution.explanation import Explanation as Explanation
    from sinuous.solution.solution import Solution as Solution
    from sinuous.solution.solutions import Solutions as Solutions
    from sinuous.solution.status import Status as Status
    from sinuous.solution.step import Step as Step
    from sinuous.solution.verification import Verification as Verification
    from sinuous.solution.verification import check as check
    from sinuous.solving.memory import Memory as Memory
    from sinuous.solving.solver import Solver as Solver
    from sinuous.solving.solver import solve as solve
    from sinuous.solving.solver import solve_all as solve_all
    from sinuous.statics.equilibrium import Equilibrium as Equilibrium
    from sinuous.viewer.show import show as show
    from sinuous.workspace.find import reach as reach
    from sinuous.workspace.reach import Reach as Reach

_HOMES = {
    "assessing.assess": ("assess",),
    "assessing.assessment": ("Assessment",),
    "assessing.sweep": ("sweep",),
    "assessing.tasks": ("Cover", "Follow", "Move"),
    "batch.solve": ("solve_batch",),
    "calibration.calibrate": ("calibrate", "suggest"),
    "calibration.calibration": ("Calibration",),
    "designing.design": ("Design",),
    "designing.find": ("design",),
    "errors": ("InputError", "NotSolvedError", "SuspiciousInput", "UnfinishedError"),
    "exploring.exploration": ("Exploration",),
    "exploring.explore": ("explore",),
    "methods.learned.network": ("Network",),
    "methods.learned.training": ("train",),
    "motion.job": ("Job", "load"),
    "motion.leader": ("follow_the_leader", "on_stage"),
    "motion.motion": ("Motion",),
    "motion.plan": ("Planner", "plan"),
    "motion.track": ("track",),
    "motion.trajectory": ("Trajectory",),
    "pictures.animate": ("animate",),
    "pictures.charts": ("plot_assessment", "plot_calibration", "plot_design"),
    "pictures.diagrams": ("diagram",),
    "pictures.plot": ("plot",),
    "pictures.workspace": ("plot_reach",),
    "poses": ("pose",),
    "problem.curve": ("Curve",),
    "problem.path": ("Path",),
    "problem.preferences": ("Preferences",),
    "problem.problem": ("Problem",),
    "problem.target": ("Target", "Tolerance"),
    "robot.actuators": ("Actuators", "Chambers", "Stage", "Tendons"),
    "robot.loads": ("Force", "Payload"),
    "robot.rates": ("Rates",),
    "robot.robot": ("Robot",),
    "robot.segment": ("Segment", "arc_parameters", "from_arc_parameters"),
    "robot.stiffness": ("Stiffness",),
    "robot.uncertainty": ("Uncertainty",),
    "statics.equilibrium": ("Equilibrium",),
    "scene.grids": ("Field", "Grid"),
    "scene.meshes.mesh": ("Mesh",),
    "scene.moving": ("Moving",),
    "scene.obstacles": ("Box", "Capsule", "Cylinder", "HalfSpace", "Sphere"),
    "scene.point_cloud": ("PointCloud",),
    "scene.scene": ("Scene",),
    "solution.explanation": ("Explanation",),
    "solution.solution": ("Solution",),
    "solution.solutions": ("Solutions",),
    "solution.status": ("Status",),
    "solution.step": ("Step",),
    "solution.verification": ("Verification", "check"),
    "solving.memory": ("Memory",),
    "solving.solver": ("Solver", "solve", "solve_all"),
    "viewer.show": ("show",),
    "workspace.find": ("reach",),
    "workspace.reach": ("Reach",),
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [*_HOME, "__version__"]  # noqa: PLE0604


if not TYPE_CHECKING:  # a checker would take every name for one that is there

    def __getattr__(name: str) -> Any:
        if name == "methods":
            return import_module("sinuous.methods")
        if name not in _HOME:
            raise AttributeError(f"module 'sinuous' has no attribute {name!r}")
        value = getattr(import_module(f"sinuous.{_HOME[name]}"), name)
        import_module("sinuous.signatures").make_readable(value)
        globals()[name] = value
        return value


def _html(noun: Any) -> str:
    html: str = import_module("sinuous.pictures.html").html(noun)
    return html


NotebookMixin._html_renderer = _html


def __dir__() -> list[str]:
    return sorted([*__all__, "methods"])
