"""Algorithms for inverse kinematics, all called the same way, and their options: `sinuous.methods.OptiPath(...)`.

Options are imported when they are first used, as the names of `sinuous` are.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sinuous.methods.dls import Dls as Dls
    from sinuous.methods.fabrik.reaching import FabrikAvoid as FabrikAvoid
    from sinuous.methods.fabrik.reaching import Fabrikc as Fabrikc
    from sinuous.methods.fabrik.reaching import Fabrikx as Fabrikx
    from sinuous.methods.learned.search import Learned as Learned
    from sinuous.methods.monte_carlo import MonteCarlo as MonteCarlo
    from sinuous.methods.newton import Newton as Newton
    from sinuous.methods.opti_path.options import OptiPath as OptiPath
    from sinuous.methods.slinki import Slinki as Slinki
else:

    def __getattr__(name: str) -> Any:
        if name[:1].isupper():  # not a module
            from sinuous.methods.registry import METHODS  # noqa: PLC0415

            for options in METHODS.values():
                home, _, own = options.rpartition(".")
                if own == name:
                    return getattr(import_module(f"sinuous.methods.{home}"), name)
        raise AttributeError(f"module 'sinuous.methods' has no attribute {name!r}")
