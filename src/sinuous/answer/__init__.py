"""What solves answer, and all that is read off an answer: checks, explanations, derivatives."""

from sinuous.base.entrance import entrance

__getattr__, __dir__, __all__ = entrance(
    __name__,
    {
        "sinuous.answer.derivatives.derivative": "Derivative",
        "sinuous.answer.derivatives.many": "Derivatives",
        "sinuous.answer.explanation": "Explanation",
        "sinuous.answer.observer": "Observed",
        "sinuous.answer.solutions": "Solutions",
        "sinuous.answer.step": "Active Step",
        "sinuous.answer.verification": "MotionVerification Verification Verifications",
        "sinuous.statics.equilibrium": "Equilibrium",
    },
)
