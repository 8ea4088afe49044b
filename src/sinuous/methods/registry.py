"""The registry of all algorithms for inverse kinematics.

A method is chosen by its name, or by its options (`OptiPath(...)`). It is prepared once for a robot, a scene and
tolerances; `run` then follows a range of starts to the targets of a problem, and returns the best configuration that it
found.
"""

from collections.abc import Iterable
from importlib import import_module
from typing import cast

from sinuous.base.arguments import MethodName
from sinuous.base.errors import InputError, shown, suggested
from sinuous.methods.options import Options
from sinuous.methods.prepared import Capabilities, Prepared
from sinuous.model.robot import Robot
from sinuous.problem.problem import Preferences
from sinuous.problem.target import Tolerance
from sinuous.scene.scene import Scene

Choice = MethodName | Options
"""How a method is chosen: its name, or its options."""

METHODS: dict[MethodName, str] = {
    "newton": "newton.Newton",
    "opti_path": "opti_path.options.OptiPath",
    "dls": "dls.Dls",
    "fabrikc": "fabrik.reaching.Fabrikc",
    "slinki": "slinki.Slinki",
    "fabrikx": "fabrik.reaching.Fabrikx",
    "fabrik_avoid": "fabrik.reaching.FabrikAvoid",
    "monte_carlo": "monte_carlo.MonteCarlo",
    "learned": "learned.search.Learned",
}
"""Where the options of every method are, within `sinuous.methods`; they are imported when they are asked for. Ours is
the first."""


def options_class(name: str) -> type[Options]:
    """Return the class of the options of the method called `name`.

    Raises
    ------
    InputError
        When there is no such method.
    """
    home, _, class_name = METHODS[_known(name)].rpartition(".")
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
    return _known(method.method if isinstance(method, Options) else method)


def _known(name: str) -> MethodName:
    if not isinstance(name, str) or name not in METHODS:
        raise InputError("method", f"unknown method {shown(name)}", name, suggested(name, METHODS))
    return name


def options_of(method: Choice) -> Options:
    """Return the options of a method, by default those of its name."""
    return method if isinstance(method, Options) else options_class(name_of(method))()


def capabilities(method: Choice) -> Capabilities:
    """What a method handles."""
    return options_class(name_of(method)).capabilities


def ready(method: Choice, robot: Robot, scene: Scene, preferences: Preferences) -> Choice:
    """Return the choice with all that is found out once for a robot in a scene: see `Options.ready`.

    Raises
    ------
    InputError
        When there is no such method, or it does not handle this robot or these preferences.
    """
    name, chosen = name_of(method), options_of(method)
    chosen.capabilities.refuse_robot(name, robot)
    if preferences and not chosen.capabilities.preferences:
        raise InputError("prefer", f"not handled by the method {name}", preferences, "no preferences")
    own = chosen.ready(robot, scene)
    return method if own is chosen else own


def prepare(method: Choice, robot: Robot, scene: Scene, tolerance: Tolerance, preferences: Preferences) -> Prepared:
    """Prepare a method that is ready."""
    return options_of(method).prepare(robot, scene, tolerance, preferences)
