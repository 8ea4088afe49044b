"""Inverse kinematics and motion of continuum robots among obstacles.

What everybody needs is here; the rest is in `sinuous.studies` (what asks the solver many times), `sinuous.methods`,
`sinuous.view` (pictures), `sinuous.files` and `sinuous.answer`.
"""

import sys

from sinuous.base.entrance import MovedModules, entrance

__version__ = "0.2.0"

_HOMES = {
    "sinuous.answer.solution": "Solution",
    "sinuous.answer.status": "Status",
    "sinuous.answer.verification": "check",
    "sinuous.base.errors": "InputError NotSolvedError SuspiciousInput",
    "sinuous.files.urdf_joints": "read_joints",
    "sinuous.model.actuators": "Actuators Chambers Stage Tendons",
    "sinuous.model.joints": "Prismatic Revolute",
    "sinuous.model.loads": "Force Payload",
    "sinuous.model.poses": "pose",
    "sinuous.model.rates": "Rates",
    "sinuous.model.robot": "Robot Uncertainty",
    "sinuous.model.segment": "Segment Stiffness arc_parameters from_arc_parameters",
    "sinuous.motion.job": "Job load",
    "sinuous.motion.leader": "follow_the_leader on_stage",
    "sinuous.motion.motion": "Motion",
    "sinuous.motion.plan": "Planner plan",
    "sinuous.motion.track": "track",
    "sinuous.motion.trajectory": "Trajectory",
    "sinuous.problem.path": "Curve Path",
    "sinuous.problem.problem": "Preferences Problem",
    "sinuous.problem.target": "Target Tolerance",
    "sinuous.scene.grids": "Field Grid",
    "sinuous.scene.mesh": "Mesh",
    "sinuous.scene.moving": "Moving",
    "sinuous.scene.obstacles": "Box Capsule Cylinder HalfSpace Sphere",
    "sinuous.scene.point_cloud": "PointCloud",
    "sinuous.scene.scene": "Scene",
    "sinuous.solver.memory": "Memory",
    "sinuous.solver.solver": "Solver solve solve_all",
    "sinuous.view.page.show": "show",
    "sinuous.view.pictures.plot": "plot",
}

_MOVED = {
    "sinuous.answer": "Equilibrium Explanation Solutions Step Verification",
    "sinuous.methods": "Network train",
    "sinuous.studies": "Assessment Calibration Cover Design Exploration Follow Move Reach UnfinishedError "
    "assess calibrate design explore reach solve_batch suggest sweep",
    "sinuous.view": "animate diagram plot_assessment plot_calibration plot_design plot_reach",
}

_MOVED_MODULES = {
    "sinuous.arguments": "sinuous.base.arguments",
    "sinuous.assessing": "sinuous.studies.tasks",
    "sinuous.batch": "sinuous.studies.batch",
    "sinuous.calibration": "sinuous.studies.calibration",
    "sinuous.derivatives": "sinuous.answer.derivatives",
    "sinuous.designing": "sinuous.studies.designing",
    "sinuous.display": "sinuous.view.display",
    "sinuous.errors": "sinuous.base.errors",
    "sinuous.exploring": "sinuous.studies.exploring",
    "sinuous.export": "sinuous.files",
    "sinuous.export.chain": "sinuous.files.joint_chain",
    "sinuous.pictures": "sinuous.view.pictures",
    "sinuous.poses": "sinuous.model.poses",
    "sinuous.robot": "sinuous.model",
    "sinuous.solution": "sinuous.answer",
    "sinuous.solving": "sinuous.solver",
    "sinuous.workspace": "sinuous.studies.workspace",
}

__getattr__, __dir__, __all__ = entrance(__name__, _HOMES, "answer files methods studies view", _MOVED)
__all__ += ["__version__"]

sys.meta_path.insert(0, MovedModules(_MOVED_MODULES))
