"""What asks the solver many times: batches, maps of the workspace, sets of tasks, design, exploring, calibration."""

from sinuous.base.entrance import entrance

__getattr__, __dir__, __all__ = entrance(
    __name__,
    {
        "sinuous.base.errors": "UnfinishedError",
        "sinuous.problem.target": "Workspace",
        "sinuous.studies.batch.batch": "Batch",
        "sinuous.studies.batch.solve": "solve_batch",
        "sinuous.studies.calibration.calibrate": "calibrate suggest",
        "sinuous.studies.calibration.calibration": "Calibration",
        "sinuous.studies.designing.design": "Change Cut Design FoundRobot",
        "sinuous.studies.designing.find": "design",
        "sinuous.studies.exploring.explore": "Exploration explore",
        "sinuous.studies.tasks.assess": "assess Assessment sweep",
        "sinuous.studies.tasks.tasks": "Cover Follow Move",
        "sinuous.studies.workspace.find": "reach",
        "sinuous.studies.workspace.reach": "Reach Verdict",
    },
)
