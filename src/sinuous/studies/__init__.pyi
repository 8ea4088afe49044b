"""The names of `__init__.py` for type checkers."""

from sinuous.base.errors import UnfinishedError as UnfinishedError
from sinuous.problem.target import Workspace as Workspace
from sinuous.studies.batch.batch import Batch as Batch
from sinuous.studies.batch.solve import solve_batch as solve_batch
from sinuous.studies.calibration.calibrate import calibrate as calibrate
from sinuous.studies.calibration.calibrate import suggest as suggest
from sinuous.studies.calibration.calibration import Calibration as Calibration
from sinuous.studies.designing.design import Change as Change
from sinuous.studies.designing.design import Cut as Cut
from sinuous.studies.designing.design import Design as Design
from sinuous.studies.designing.design import FoundRobot as FoundRobot
from sinuous.studies.designing.find import design as design
from sinuous.studies.exploring.explore import Exploration as Exploration
from sinuous.studies.exploring.explore import explore as explore
from sinuous.studies.tasks.assess import Assessment as Assessment
from sinuous.studies.tasks.assess import assess as assess
from sinuous.studies.tasks.assess import sweep as sweep
from sinuous.studies.tasks.tasks import Cover as Cover
from sinuous.studies.tasks.tasks import Follow as Follow
from sinuous.studies.tasks.tasks import Move as Move
from sinuous.studies.workspace.find import reach as reach
from sinuous.studies.workspace.reach import Reach as Reach
from sinuous.studies.workspace.reach import Verdict as Verdict

__all__: list[str]
