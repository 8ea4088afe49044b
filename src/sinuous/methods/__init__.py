"""Algorithms for inverse kinematics, all called the same way, and their options: `sinuous.methods.OptiPath(...)`."""

from sinuous.base.entrance import entrance

__getattr__, __dir__, __all__ = entrance(
    __name__,
    {
        "sinuous.methods.dls": "Dls",
        "sinuous.methods.fabrik.reaching": "FabrikAvoid Fabrikc Fabrikx",
        "sinuous.methods.learned": "Learned Network train",
        "sinuous.methods.monte_carlo": "MonteCarlo",
        "sinuous.methods.newton": "Newton",
        "sinuous.methods.opti_path.options": "OptiPath",
        "sinuous.methods.slinki": "Slinki",
    },
)
