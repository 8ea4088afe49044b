"""Options of a method: a frozen dataclass whose fields say what may stand in them, for Python, shell and kernels."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.methods.capabilities import Capabilities
from sinuous.reprs import ShortRepr

if TYPE_CHECKING:
    from sinuous.methods.prepared import Compiled, Prepared
    from sinuous.problem.problem import Preferences
    from sinuous.problem.target import Tolerance
    from sinuous.robot.robot import Robot
    from sinuous.scene.scene import Scene


@dataclass(frozen=True)
class Kind:
    """What a value may be: how to check it, to read it from text, and to hand it to a kernel as a number."""

    check: Callable[[str, Any], Any]
    read: Callable[[str, str], Any]
    encode: Callable[[Any], float] = float


def number(default: float, *, low: float = -np.inf, above: float = -np.inf, high: float = np.inf) -> Any:
    """Field for a finite number in a range; `above` is excluded, the other ends are allowed."""

    def check(key: str, value: Any) -> float:
        return checks.number(key, value, low=low, above=above, high=high)

    return field(default=default, metadata={"kind": Kind(check, _read_number)})


def count(default: int, low: int, high: int) -> Any:
    """Field for a whole number from `low` to `high`."""

    def check(key: str, value: Any) -> int:
        return checks.integer(key, value, low, high)

    return field(default=default, metadata={"kind": Kind(check, _read_count)})


def choice(default: str, names: Sequence[str]) -> Any:
    """Field for one of several words; the kernel sees its place among them."""
    expected = "one of " + ", ".join(names)

    def check(key: str, value: Any) -> str:
        if not isinstance(value, str) or value not in names:
            raise InputError(key, "is not known", value, expected)
        return value

    return field(default=default, metadata={"kind": Kind(check, lambda _, text: text, lambda v: float(names.index(v)))})


def flag(default: bool) -> Any:
    """Field for yes or no."""

    def check(key: str, value: Any) -> bool:
        if not isinstance(value, (bool, np.bool_)):
            raise InputError(key, "is neither yes nor no", value, "True or False")
        return bool(value)

    return field(default=default, metadata={"kind": Kind(check, _read_flag)})


def _read_number(key: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(key, "not a number", text, "a number") from None


def _read_count(key: str, text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise InputError(key, "not usable as a count", text, "a whole number") from None


def _read_flag(key: str, text: str) -> bool:
    if text.lower() not in ("true", "false"):
        raise InputError(key, "is neither yes nor no", text, "true or false")
    return text.lower() == "true"


@dataclass(frozen=True, repr=False)
class Options(ShortRepr):
    """Base of the options of every method: values are checked as they come in.

    A class of options says of its method what it is called (`method`), what it handles (`capabilities`), sets of values
    that have a name (`presets`), and how it is compiled.

    Raises
    ------
    InputError
        That names the option, when a value is not what it should be.
    """

    method: ClassVar[str] = ""
    capabilities: ClassVar[Capabilities] = Capabilities("")
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = MappingProxyType({})

    def __post_init__(self) -> None:
        for each in fields(self):
            object.__setattr__(self, each.name, each.metadata["kind"].check(each.name, getattr(self, each.name)))

    @classmethod
    def parse(cls, pairs: Iterable[str]) -> Self:
        """Read options as they are typed: `KEY=VALUE` each; `preset=NAME` gives the others their values.

        Raises
        ------
        InputError
            When one is not of this form, not known, given twice, or refused.
        """
        kinds = {each.name: each.metadata["kind"] for each in fields(cls)}
        if cls.presets:
            kinds["preset"] = choice("", tuple(cls.presets)).metadata["kind"]
        known = "one of " + ", ".join(kinds) if kinds else "none: this method has no options"
        values: dict[str, Any] = {}
        for pair in pairs:
            key, equals, text = pair.partition("=")
            if not equals:
                raise InputError("", "not an option", pair, "KEY=VALUE")
            if key not in kinds:
                raise InputError(key, "unknown option", text, known)
            if key in values:
                raise InputError(key, "given twice", text, "every option once")
            values[key] = kinds[key].read(key, text)
        chosen = values.pop("preset", None)
        if chosen is not None:
            values = {**cls.presets[kinds["preset"].check("preset", chosen)], **values}
        return cls(**values)

    def refuse(self, robot: "Robot") -> None:
        """Refuse a robot that these options are not meant for; none by default.

        Raises
        ------
        InputError
        """

    def ready(self, robot: "Robot", scene: "Scene") -> Self:
        """Return the same with all that is found out once for a robot in a scene: by default there is no such thing."""
        return self

    def vector(self) -> Floats:
        """All values in the order of the fields, as the kernel of the method reads them."""
        return np.array([each.metadata["kind"].encode(getattr(self, each.name)) for each in fields(self)], np.float64)

    def prepare(self, robot: "Robot", scene: "Scene", tolerance: "Tolerance", preferences: "Preferences") -> "Prepared":
        """Prepare the method for a robot in a scene: compile or load its kernels."""
        from sinuous.methods.prepared import Prepared  # noqa: PLC0415

        compiled = self.compiled(robot, scene)
        return Prepared(self.method, self.capabilities, compiled, robot, scene, tolerance, preferences)

    def compiled(self, robot: "Robot", scene: "Scene") -> "Compiled":
        """Return the compiled search of the method, and what it needs for this robot and scene."""
        raise NotImplementedError
