"""The names of `__init__.py` for type checkers."""

from sinuous.answer.derivatives.derivative import Derivative as Derivative
from sinuous.answer.derivatives.many import Derivatives as Derivatives
from sinuous.answer.explanation import Explanation as Explanation
from sinuous.answer.observer import Observed as Observed
from sinuous.answer.solutions import Solutions as Solutions
from sinuous.answer.step import Active as Active
from sinuous.answer.step import Step as Step
from sinuous.answer.verification import MotionVerification as MotionVerification
from sinuous.answer.verification import Verification as Verification
from sinuous.answer.verification import Verifications as Verifications
from sinuous.statics.equilibrium import Equilibrium as Equilibrium

__all__: list[str]
