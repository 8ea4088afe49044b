"""Options of a method: a frozen dataclass whose fields say what may stand in them, for Python, shell and kernels."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import partial
from types import MappingProxyType
from typing import Any, ClassVar, Self

import numpy as np

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, suggested
from sinuous.base.frozen import ShortRepr
from sinuous.methods.prepared import Capabilities, Compiled, Prepared
from sinuous.methods.search import check_size
from sinuous.model.robot import Robot
from sinuous.problem.problem import Preferences
from sinuous.problem.target import Tolerance
from sinuous.scene.scene import Scene


def _typed(text: str) -> Any:
    """Read what was typed as a problem file says it: a number, true or false, else a word."""
    from sinuous.files.documents import parse_yaml  # noqa: PLC0415

    try:
        return parse_yaml(text)
    except InputError:
        return text


@dataclass(frozen=True)
class OptionKind:
    """What a value may be: how to check it, to read it from text, and to hand it to a kernel as a number."""

    check: Callable[[str, Any], Any]
    encode: Callable[[Any], float] = float
    read: Callable[[str], Any] = _typed


def option(default: Any, kind: OptionKind) -> Any:
    """Field for a value of some kind."""
    return field(default=default, metadata={"kind": kind})


def number(default: float, *, low: float = -np.inf, above: float = -np.inf, high: float = np.inf) -> Any:
    """Field for a finite number in a range; `above` is excluded, the other ends are allowed."""
    return option(default, OptionKind(partial(checks.number, low=low, above=above, high=high)))


def count(default: int, low: int, high: int) -> Any:
    """Field for a whole number from `low` to `high`."""
    return option(default, OptionKind(partial(checks.integer, low=low, high=high)))


def choice(default: str, names: Sequence[str]) -> Any:
    """Field for one of several words; the kernel sees its place among them."""
    return option(default, OptionKind(partial(checks.choice, words=names), names.index, str))


def flag(default: bool) -> Any:
    """Field for yes or no."""
    return option(default, OptionKind(checks.truth))


@dataclass(frozen=True, repr=False)
class Options(ShortRepr):
    """Base of the options of every method: values are checked as they come in.

    A class of options says of its method what it is called (`method`), what it handles (`capabilities`), sets of values
    that have a name (`presets`), its `compiled_search`, and how many numbers of scratch
    that takes (`scratch`).

    Raises
    ------
    InputError
        That names the option, when a value is not what it should be.
    """

    method: ClassVar[str] = ""
    capabilities: ClassVar[Capabilities] = Capabilities("")
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = MappingProxyType({})
    compiled_search: ClassVar[Callable[..., Any]]
    prepared: ClassVar[type[Prepared]] = Prepared

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
        values: dict[str, Any] = {}
        for pair in pairs:
            key, equals, text = pair.partition("=")
            if not equals:
                raise InputError("", "not an option", pair, "KEY=VALUE")
            if key not in kinds:
                known = suggested(key, kinds) if kinds else "none: this method has no options"
                raise InputError(key, "unknown option", text, known)
            if key in values:
                raise InputError(key, "given twice", text, "every option once")
            values[key] = kinds[key].read(text)
        chosen = values.pop("preset", None)
        if chosen is not None:
            values = {**cls.presets[kinds["preset"].check("preset", chosen)], **values}
        return cls(**values)

    def refuse(self, robot: Robot) -> None:
        """Refuse a robot that these options are not meant for; none by default.

        Raises
        ------
        InputError
        """

    def ready(self, robot: Robot, scene: Scene) -> Self:
        """Return the same with all that is found out once for a robot in a scene: by default there is no such thing."""
        return self

    def vector(self) -> Floats:
        """All values in the order of the fields, as the kernel of the method reads them."""
        return np.array([each.metadata["kind"].encode(getattr(self, each.name)) for each in fields(self)], np.float64)

    def told(self, robot: Robot, scene: Scene) -> Floats:
        """What the kernel of the method is told of them, a robot and a scene: by default all values."""
        return self.vector()

    def scratch(self, segments: int) -> int:
        """How many numbers (float64) of scratch the kernel of the method takes."""
        raise NotImplementedError

    def prepare(self, robot: Robot, scene: Scene, tolerance: Tolerance, preferences: Preferences) -> Prepared:
        """Prepare the method for a robot in a scene: compile or load its kernels."""
        compiled = self.compiled(robot, scene)
        return self.prepared(self.method, self.capabilities, compiled, robot, scene, tolerance, preferences)

    def compiled(self, robot: Robot, scene: Scene) -> Compiled:
        """Return the compiled search of the method, and what it needs for this robot and scene."""
        size = check_size(len(robot), len(scene)) + self.scratch(len(robot))
        return Compiled(self.compiled_search, lambda _: size, self.told(robot, scene))
