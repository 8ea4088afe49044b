"""By how much a body may be elsewhere than its model says."""

from sinuous import checks
from sinuous.arguments import Number, OneEach
from sinuous.frozen import Frozen


class Uncertainty(Frozen):
    """A bound of the error of a model, as a calibration found it. Proofs thicken the body by it.

    Parameters
    ----------
    bound : float or array_like (n,)
        Distance by which places of the body may be off: of all segments, or one each.
    level : float, optional
        Share of the measurements for which it held.

    Raises
    ------
    InputError
        When the bound is negative, or the level is not between 0 and 1.
    """

    bound: float | tuple[float, ...]
    level: float

    def __init__(self, bound: OneEach, level: Number = 0.95) -> None:
        self._set(bound=checks.one_each("bound", bound, None, "segment"))
        self._set(level=checks.number("level", level, above=0.0, high=1.0))

    def __str__(self) -> str:
        return f"at {100.0 * self.level:.3g} %"
