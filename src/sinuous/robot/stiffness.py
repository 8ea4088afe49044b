"""How hard a segment resists bending, twisting and stretching."""

import math

from sinuous import checks
from sinuous.arguments import Number
from sinuous.errors import InputError
from sinuous.frozen import Frozen


class Stiffness(Frozen):
    """Stiffness of a segment, as of a rod with one cross-section; force and length in the units of the robot.

    Parameters
    ----------
    bend : float, optional
        EI, force x length^2: the moment that bends a rod of length `l` by an angle `b` is EI b / l.
    twist : float, optional
        GJ, force x length^2; by default the rod does not twist.
    stretch : float, optional
        EA, force; by default the rod does not stretch.
    youngs_modulus, radius : float, optional
        Force / length^2, and length: those of a round rod that has these stiffnesses, instead of them.
    poisson : float, optional
        Poisson's ratio of that rod, for its twist; by default 0.3.

    Raises
    ------
    InputError
        When a number is not greater than 0, or both ways to say it are mixed.
    """

    bend: float
    twist: float
    stretch: float

    def __init__(
        self,
        bend: Number | None = None,
        twist: Number | None = None,
        stretch: Number | None = None,
        *,
        youngs_modulus: Number | None = None,
        poisson: Number | None = None,
        radius: Number | None = None,
    ) -> None:
        if bend is None:
            if youngs_modulus is None or radius is None:
                raise InputError("bend", "missing", None, "bend, or youngs_modulus and radius")
            young, half = checks.number("youngs_modulus", youngs_modulus, above=0.0), _length(radius)
            ratio = 0.3 if poisson is None else checks.number("poisson", poisson, above=-1.0)
            second = math.pi * half**4 / 4.0
            bend = young * second
            twist = young * second / (1.0 + ratio) if twist is None else twist
            stretch = young * math.pi * half**2 if stretch is None else stretch
        else:
            for key, value in (("youngs_modulus", youngs_modulus), ("poisson", poisson), ("radius", radius)):
                if value is not None:
                    raise InputError(
                        key, "cannot be combined with bend", value, "either bend, or youngs_modulus and radius"
                    )
        self._set(
            bend=checks.number("bend", bend, above=0.0),
            twist=math.inf if twist is None else checks.number("twist", twist, above=0.0),
            stretch=math.inf if stretch is None else checks.number("stretch", stretch, above=0.0),
        )


def _length(radius: Number) -> float:
    return checks.number("radius", radius, above=0.0)
