"""Keywords that a public function does not have are refused in a line that says which one was meant.

`entrance` puts this around the names that it hands out. It costs a call, so methods of control loops go without: there
Python says what is wrong.
"""

import inspect
import sys
from collections.abc import Callable, Iterable, Mapping
from functools import wraps
from typing import Any, get_args, is_typeddict

from sinuous.base.errors import GUESS, InputError, UnknownOptionError
from sinuous.base.words import suggested

HOT = {"Solver.solve", "Solver.step", "Solution.__init__"}
"""What is called so often that it stays as it is."""

MEANT = {
    "obstacles": "scene, the obstacles as a list or a Scene",
    "world": "scene, the obstacles as a list or a Scene",
    "guess": "initial, the configuration to begin from",
    "q0": "initial, the configuration to begin from",
    "timeout": "time, the budget in seconds",
    "rates": "rates in the call that needs them, solver.step(..., rates=) or motion.timed(rates)",
    "radius": "the radius of the robot's segments, or clearance, a distance that is kept besides",
    "quaternion": "rotation=(w, x, y, z) or xyzw=(x, y, z, w), which say the order",
    "orientation": "rotation: a quaternion (w, x, y, z), a matrix, or a Rotation of SciPy",
    "ratio": "gain: of displacements to what the motors count",
    "gear": "gain of tendons, chambers and stages: of displacements to what the motors count",
}
"""What is meant by keywords that are often guessed, and whose names are unlike."""


def refuse_unknown(given: Mapping[str, Any], names: Iterable[str]) -> None:
    """Refuse keywords that are not among these names.

    Raises
    ------
    UnknownOptionError
        Which is an `InputError`, and a `TypeError`.
    """
    known = tuple(names)
    for key, value in given.items():
        if key not in known:
            meant = f"{GUESS}{MEANT[key]}?" if key in MEANT else suggested(key, known)
            raise UnknownOptionError(key, "unknown option", value, meant) from None


def explain_keywords(public: Any) -> Any:
    """Return a public function, or a class of which constructor and methods do so, that refuses unknown keywords."""
    if inspect.isfunction(public):
        around = _explaining(public)
        setattr(sys.modules[public.__module__], public.__name__, around)  # a pickle finds it there
        return around
    if inspect.isclass(public):
        for owner in public.__mro__:
            if owner.__module__.startswith("sinuous."):
                _explain_methods(owner)
    return public


def _explain_methods(owner: type) -> None:
    for name, value in list(vars(owner).items()):
        function = getattr(value, "__func__", value)
        if not inspect.isfunction(function) or function.__qualname__ in HOT or "__wrapped__" in vars(function):
            continue
        optional = (
            function.__defaults__ or function.__kwdefaults__ or function.__code__.co_flags & inspect.CO_VARKEYWORDS
        )
        if name == "__init__" or (optional and not name.startswith("_")):
            around = _explaining(function)
            setattr(owner, name, around if function is value else type(value)(around))


def _explaining(function: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(function)
    def call(*args: Any, **options: Any) -> Any:
        try:
            return function(*args, **options)
        except (TypeError, InputError):
            refuse_unknown(options, _names(function, options))
            raise

    return call


def _names(function: Callable[..., Any], given: Iterable[str]) -> list[str]:
    """Keywords that a function takes, those that it passes on one by one; whatever is given where it takes any."""
    names: list[str] = []
    for name, each in inspect.signature(function).parameters.items():
        if each.kind is not each.VAR_KEYWORD:
            names.append(name)
        elif (kind := get_args(each.annotation)) and is_typeddict(kind[0]):
            names += kind[0].__annotations__
        else:
            names += given
    return [name for name in names if name not in ("self", "cls")]
