"""The registry of all algorithms for inverse kinematics.

A method is prepared once for a robot, a scene and tolerances; `run` then follows a range of starts to the targets of a
problem, and returns the best configuration that it found. A method is chosen by its name, or by its options
(`OptiPath(...)`).
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from importlib import import_module
from typing import TYPE_CHECKING, cast

from sinuous.arguments import MethodName
from sinuous.errors import InputError
from sinuous.methods.capabilities import LIMITS, Capabilities
from sinuous.methods.method import Case, Method
from sinuous.methods.options import Options

if TYPE_CHECKING:
    from sinuous.problem.preferences import Preferences
    from sinuous.problem.target import Tolerance
    from sinuous.robot.robot import Robot
    from sinuous.scene.scene import Scene


Choice = MethodName | Options
"""How a method is chosen: its name, or its options."""


@dataclass(frozen=True)
class Registered:
    """A method in the registry.

    Attributes
    ----------
    options : str
        Where the class of its options lives, within `sinuous.methods`.
    capabilities : Capabilities
        What it handles.
    """

    options: str
    capabilities: Capabilities


_OF_THE_TIP = Capabilities(
    direction=True,
    rotation=False,
    orientation_alone=False,
    elbows=False,
    tool=True,
    limits=("length", "bend", "curvature"),
    obstacles=False,
    preferences=False,
    initial=True,
    own_starts=True,
    routes=False,
    compiled="everything, in one call",
    source="",
)
"""Of a method that looks at the tip alone, and at no obstacles."""


METHODS: dict[MethodName, Registered] = {
    "newton": Registered(
        "newton.Newton",
        Capabilities(
            direction=True,
            rotation=True,
            orientation_alone=True,
            elbows=True,
            tool=True,
            limits=LIMITS,
            obstacles=True,
            preferences=True,
            initial=True,
            own_starts=True,
            routes=True,
            compiled="everything, in one call",
            source="this library; docs/design.md",
        ),
    ),
    "opti_path": Registered(
        "opti_path.options.OptiPath",
        replace(
            _OF_THE_TIP,
            tool=False,
            obstacles=True,
            compiled="everything, in one call; the potential is sampled once, compiled too",
            source="Sun & Wang, An Optimization-Based Inverse Kinematics Solver for Continuum Manipulators in "
            "Intricate Environments",
        ),
    ),
    "dls": Registered(
        "dls.options.Dls",
        replace(_OF_THE_TIP, rotation=True, orientation_alone=True, source="Wampler 1986, Nakamura & Hanafusa 1986"),
    ),
    "fabrikc": Registered("fabrik.fabrikc.Fabrikc", replace(_OF_THE_TIP, source="Zhang et al. 2018")),
    "slinki": Registered(
        "slinki.options.Slinki", replace(_OF_THE_TIP, obstacles=True, initial=False, source="Chiang et al. 2021")
    ),
    "fabrikx": Registered("fabrik.fabrikx.Fabrikx", replace(_OF_THE_TIP, source="Kolpashchikov et al. 2022")),
    "fabrik_avoid": Registered(
        "fabrik_avoid.options.FabrikAvoid", replace(_OF_THE_TIP, obstacles=True, source="Wu et al. 2022")
    ),
    "monte_carlo": Registered(
        "monte_carlo.options.MonteCarlo",
        replace(
            _OF_THE_TIP,
            rotation=True,
            orientation_alone=True,
            elbows=True,
            limits=LIMITS,
            obstacles=True,
            source="Qin et al. 2022",
        ),
    ),
}
"""All methods by name, ours first."""


def options_class(name: str) -> type[Options]:
    """Return the class of the options of the method called `name`.

    Raises
    ------
    InputError
        When there is no such method.
    """
    known = _known(name, "")
    home, _, class_name = METHODS[known].options.rpartition(".")
    return cast(type[Options], getattr(import_module(f"sinuous.methods.{home}"), class_name))


def with_options(name: str, pairs: Iterable[str]) -> Choice:
    """Choose the method called `name` with options as they are typed, `KEY=VALUE` each.

    Raises
    ------
    InputError
        When there is no such method, or an option is refused.
    """
    pairs = list(pairs)
    chosen = options_class(name)
    return chosen.parse(pairs) if pairs else name_of(name)


def name_of(method: Choice | str) -> MethodName:
    """Return the name of a chosen method.

    Raises
    ------
    InputError
        When it is none.
    """
    return _known(method.method if isinstance(method, Options) else method, ", or its options")


def _known(name: str, more: str) -> MethodName:
    if not isinstance(name, str) or name not in METHODS:
        raise InputError("method", "is not known", name, "one of " + ", ".join(METHODS) + more)
    return name


def capabilities(method: Choice) -> Capabilities:
    """What a method handles."""
    return METHODS[name_of(method)].capabilities


def prepare(
    method: Choice, robot: "Robot", scene: "Scene", tolerance: "Tolerance", preferences: "Preferences"
) -> Method:
    """Prepare a chosen method.

    Raises
    ------
    InputError
        When there is no such method, or it does not handle this robot or these preferences.
    """
    name = name_of(method)
    can = METHODS[name].capabilities
    can.refuse_robot(name, robot)
    if preferences and not can.preferences:
        raise InputError("prefer", f"not handled by the method {name}", preferences, "no preferences")
    chosen = method if isinstance(method, Options) else options_class(name)()
    return chosen.prepare(Case(robot, scene, tolerance, preferences), can)
