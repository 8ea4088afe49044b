"""The names of `__init__.py` for type checkers."""

from sinuous.methods.dls import Dls as Dls
from sinuous.methods.fabrik.reaching import FabrikAvoid as FabrikAvoid
from sinuous.methods.fabrik.reaching import Fabrikc as Fabrikc
from sinuous.methods.fabrik.reaching import Fabrikx as Fabrikx
from sinuous.methods.learned import Learned as Learned
from sinuous.methods.learned import Network as Network
from sinuous.methods.learned import train as train
from sinuous.methods.monte_carlo import MonteCarlo as MonteCarlo
from sinuous.methods.newton import Newton as Newton
from sinuous.methods.opti_path.options import OptiPath as OptiPath
from sinuous.methods.slinki import Slinki as Slinki

__all__: list[str]
