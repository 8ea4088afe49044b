"""What goes wrong, in words: wrong or suspicious input, names that are not known, a solve that reached no target.

Before them stand numbers and lists in sentences, the same in every message.
"""

import inspect
import math
import re
import reprlib
import sys
import warnings
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from functools import wraps
from typing import TYPE_CHECKING, Any, Self, TypeVar, get_args, is_typeddict

if TYPE_CHECKING:
    import sinuous as sn

Value = TypeVar("Value", bound=Hashable)


def number(value: Any, digits: int = 4) -> str:
    """A number with so many digits; of a vector or an interval all of them."""
    if isinstance(value, bool | str) or value is None:
        return str(value)
    if getattr(value, "shape", ()) or isinstance(value, list | tuple):
        return "[" + ", ".join(number(each, digits) for each in value) + "]"
    return f"{value + 0.0:.{digits}g}"


def degrees(angle: float) -> str:
    """An angle in rad as people imagine it: `17.2 deg`."""
    return f"{number(math.degrees(angle), 3)} deg"


def rounded(value: float) -> float:
    """Drop the last digits, which say what arithmetic rounds."""
    return float(f"{value:.12g}")


def rounded_up(value: float) -> float:
    """Round a number greater than 0 up to three digits."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return rounded(unit * math.ceil(value / unit * (1.0 - 1e-12)))


def duration(seconds: float) -> str:
    """`87 us`, `4.09 ms` or `1.2 s`."""
    for unit, size in (("s", 1.0), ("ms", 1e-3)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-6:.3g} us"


def counted(count: int, noun: str) -> str:
    """`1 edge`, `2 edges`."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def span(pair: Sequence[float]) -> str:
    """`1 to 2`, or `1` where both are the same."""
    low, high = map(number, pair)
    return low if low == high else f"{low} to {high}"


def ranges(numbers: Iterable[int]) -> str:
    """Increasing numbers as `1 to 3, 7`."""
    return ", ".join(span((run[0], run[-1])) if len(run) > 1 else str(run[0]) for run in _runs(numbers))


def _runs(numbers: Iterable[int]) -> list[list[int]]:
    """Increasing numbers in runs without gaps."""
    runs: list[list[int]] = []
    for one in numbers:
        if runs and one == runs[-1][-1] + 1:
            runs[-1].append(one)
        else:
            runs.append([one])
    return runs


def listed(texts: Iterable[str]) -> str:
    """`a, b and c`."""
    *front, last = tuple(texts)
    return f"{', '.join(front)} and {last}" if front else last


def one_of_body(label: int | str | None) -> str:
    """`segment 3`; `link 'elbow'` of a joint's name; `the body` where neither is known."""
    return "the body" if label is None else f"link {label!r}" if isinstance(label, str) else f"segment {label}"


def labelled(labels: Iterable[int | str], count: int | None = None) -> str:
    """What has limits: `joint 'roll' and segments 1 to 3`; see `segments`."""
    every = [*labels]
    numbers = [each for each in every if isinstance(each, int)]
    return listed(
        [f"joint {each!r}" for each in every if isinstance(each, str)] + ([segments(numbers, count)] if numbers else [])
    )


def segments(numbers: Sequence[int], count: int | None = None) -> str:
    """`segment 3`, `segments 1 to 4 and 6`; with the `count` of the robot's segments, `all segments`."""
    if count is not None and len(numbers) == count > 1:
        return "all segments"
    texts = [f"{run[0]} to {run[-1]}" if len(run) > 2 else listed(map(str, run)) for run in _runs(sorted(numbers))]
    return f"segment{'s' if len(numbers) > 1 else ''} {listed(texts)}"


def grouped(values: Mapping[int, Value]) -> list[tuple[list[int], Value]]:
    """Put the numbers together that have the same value, in the order in which values come first."""
    groups: dict[Value, list[int]] = {}
    for each, value in values.items():
        groups.setdefault(value, []).append(each)
    return [(numbers, value) for value, numbers in groups.items()]


GUESS = "did you mean "
"""How a refusal begins to say what is meant, in the place of what was expected."""

_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = 60
_SHORT.maxlist = _SHORT.maxtuple = 6


def shown(value: object) -> str:
    """Text of a value, short enough for one line."""
    try:
        return " ".join(_SHORT.repr(value).split())
    except ValueError:  # whole numbers of more than 4300 digits have no text
        return f"{type(value).__name__} without a text"


LIKE = 0.6
"""How alike a name must be to be suggested, 1 for equal ones."""


def is_meant(name: str, known: Iterable[str]) -> bool:
    """Whether a name that is not known is often guessed for one that is."""
    return name in MEANT and not {*known}.isdisjoint(re.findall(r"\w+", MEANT[name]))


def guessed(name: Any, known: Iterable[str]) -> str | None:
    """What is meant by a name that is not known: `did you mean 'length'?`; `None` where no other is likely."""
    import difflib  # noqa: PLC0415

    word, names = str(name), tuple(known)
    if is_meant(word, names):
        return f"{GUESS}{MEANT[word]}?"
    begun = [each for each in names if len(word) > 2 and each.startswith(word)]
    nearest = begun if len(begun) == 1 else difflib.get_close_matches(word, names, 1, LIKE)
    return f"{GUESS}{nearest[0]!r}?" if nearest else None


def suggested(name: Any, known: Iterable[str]) -> str:
    """What a name that is not known should be: what is likely to be meant, or one of all."""
    names = tuple(known)
    return guessed(name, names) or "one of " + ", ".join(names)


class InputError(ValueError):
    """Input that cannot be meant, in one line: `KEY: PROBLEM; expected EXPECTED, got VALUE`.

    In front stands the file that holds the key, when it came from one; of a file that is wrong itself, no more than its
    name. The problem is left out where the rest says it; a value that is `None` is missing, or left out where there is
    another problem. Of a name that is not known, the one that is meant may be what was expected: `did you mean
    'length'?`.

    Attributes
    ----------
    key : str
        Where the value stands, like `segments[2].length`.
    problem : str
        What is wrong; empty where the value and what was expected say it.
    value : object
        The value as it was given.
    expected : str
        What would have been right.
    file : str or None
        The file that holds the key, when it came from one.
    """

    def __init__(self, key: str, problem: str, value: object, expected: str, file: str | None = None) -> None:
        place = key if file is None else f"{file}: {key}"
        problem = problem or ("missing" if value is None else "")
        wrong = f"{problem}; " if problem else ""
        got = "" if problem and value is None else f", got {shown(value)}"  # nothing was given, as the problem says
        if key == "file" and isinstance(value, str) and value == file:
            place, got = value, ""  # the name in front says both
        right = expected if expected.startswith(GUESS) else f"expected {expected}{got}"
        super().__init__(f"{place}: {wrong}{right}")
        self.key = key
        self.problem = problem
        self.value: Any = value
        self.expected = expected
        self.file = file

    def within(self, outer: str) -> Self:
        """Return the same error, seen from the key that contains this one; a file's keys stay that file's."""
        if self.file is not None or not outer:
            return self
        inner = self.key if self.key.startswith("[") or not self.key else f".{self.key}"
        return type(self)(f"{outer}{inner}", self.problem, self.value, self.expected)

    def in_file(self, file: object) -> Self:
        """Return the same error with the name of the file it is in, unless it names one already."""
        if self.file is not None:
            return self
        return type(self)(self.key, self.problem, self.value, self.expected, str(file))

    @property
    def row(self) -> tuple[str, int] | None:
        """Of which array a row is refused, and which one, 0 = first, where it is one: the key `positions[3]`."""
        found = re.fullmatch(r"(\w+)\[(\d+)\]", self.key)
        return None if found is None else (found[1], int(found[2]))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.key, self.problem, self.value, self.expected, self.file)


class WrongArgumentsError(InputError, TypeError):
    """Arguments that a function does not have, or lacks: for Python a `TypeError`, and said as in a file."""


class SuspiciousInput(UserWarning):
    """Input that can be meant, but hardly is. Nothing is changed for it."""


def warn_of(texts: Iterable[str]) -> None:
    """Give every text to Python's `warnings`, which by default shows each once."""
    for text in texts:
        warnings.warn(text, SuspiciousInput, stacklevel=_level())


def _level() -> int:
    """How far up the first function is that is not of this package: the one that a warning is for."""
    level, frame = 1, sys._getframe(1)
    while frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] == "sinuous":
        level, frame = level + 1, frame.f_back
    return level


class NotSolvedError(RuntimeError):
    """Raised by `raise_for_status()` of a solution or motion that is not solved, in one line; `solution` holds it."""

    def __init__(self, message: str, solution: "sn.Solution | sn.Motion") -> None:
        super().__init__(message)
        self.solution = solution


class UnfinishedError(RuntimeError):
    """Raised when a batch cannot go on; its text is one line that says what happened, and what is kept."""


Kind = TypeVar("Kind")


def answers_attributes(**instead: str) -> Callable[[type[Kind]], type[Kind]]:
    """Let a class say where to look for attributes that are guessed, `instead` of them; no type checker sees it."""

    def around(kind: type[Kind]) -> type[Kind]:
        def missing(self: Any, name: str) -> Any:
            hint = f"; see {instead[name]}" if name in instead else ""
            raise AttributeError(f"{kind.__name__!r} object has no attribute {name!r}{hint}", name=name, obj=self)

        kind.__getattr__ = missing  # type: ignore[attr-defined]
        return kind

    return around


HOT = {"Solution.__init__"}
"""What every solve calls, and no user: no call around it explains its keywords."""

MEANT = {
    "obstacles": "scene, the obstacles as a list or a Scene",
    "world": "scene, the obstacles as a list or a Scene",
    "guess": "initial, the configuration to begin from",
    "q0": "initial, the configuration to begin from",
    "timeout": "time, the budget in seconds",
    "rates": "rates in the call that needs them, where time passes: solver.step(..., rates=) or motion.timed(rates)",
    "radius": "the radius of the robot's segments, or clearance, a distance that is kept besides",
    "quaternion": "rotation=(w, x, y, z) or xyzw=(x, y, z, w), which say the order",
    "orientation": "rotation: a quaternion (w, x, y, z), a matrix, or a Rotation of SciPy",
    "ratio": "gain: of displacements to what the motors count",
    "gear": "gain of tendons, chambers and stages: of displacements to what the motors count",
    "diameter": "radius, half of it",
    "file": "'path'",
    "path": "'file'",
    "unit": "scale: units of the scene in one of the file, 0.001 from mm to m",
    "units": "scale: units of the scene in one of the file, 0.001 from mm to m",
    "r": "'radius'",
    "n": "'count'",
    "number": "'count'",
    "extents": "size, the full extents",
    "dimensions": "size, the full extents",
    "ball": "'sphere'",
    "plane": "'half_space'",
    "goal": "'target'",
    "nx": "dx,dy,dz, the direction of the tangent",
    "rx": "qw,qx,qy,qz, a quaternion",
    "roll": "qw,qx,qy,qz, a quaternion",
}
"""What is meant by names that are often guessed, and are unlike; said where one of these words is a name that is known.
"""


WANTED = {
    "scale": "units of the scene in one of the file: 0.001 for a file in mm and a robot in m",
    "length": "a number or [low, high]",
    "radius": "a number",
    **dict.fromkeys(("center", "start", "end", "point", "normal", "size"), "3 finite numbers"),
}
"""What an argument, or a key of a file, that is missing would say."""


def refuse_unknown(given: Mapping[str, Any], names: Iterable[str]) -> None:
    """Refuse keywords that are not among these names.

    Raises
    ------
    WrongArgumentsError
        Which is an `InputError`, and a `TypeError`.
    """
    known = tuple(names)
    for key, value in given.items():
        if key not in known:
            raise WrongArgumentsError(key, "unknown option", value, suggested(key, known)) from None


def explain_keywords(public: Any) -> Any:
    """Return a public function, or a class of which constructor and methods do so, that refuses unknown keywords.

    `entrance` does so to the names that it hands out.
    """
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
        if name == "__init__" or not name.startswith("_"):
            around = _explaining(function)
            setattr(owner, name, around if function is value else type(value)(around))


def _explaining(function: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(function)
    def call(*args: Any, **options: Any) -> Any:
        try:
            return function(*args, **options)
        except (TypeError, InputError):
            refuse_unknown(options, _names(function, options))
            _refuse_missing(function, args, options)
            raise

    return call


def _refuse_missing(function: Callable[..., Any], args: Sequence[Any], options: Mapping[str, Any]) -> None:
    """Refuse arguments of which one that has no default is missing."""
    parameters = inspect.signature(function).parameters.values()
    left = [each for each in parameters if each.kind is not each.VAR_POSITIONAL][len(args) :]
    for each in left:
        if each.default is each.empty and each.kind is not each.VAR_KEYWORD and each.name not in options:
            raise WrongArgumentsError(each.name, "", None, WANTED.get(each.name, "a value")) from None


def _names(function: Callable[..., Any], given: Iterable[str]) -> list[str]:
    """Keywords that a function takes, those that it passes on one by one; whatever is given where it takes any."""
    names: list[str] = []
    for name, each in inspect.signature(function).parameters.items():
        if each.kind is each.VAR_KEYWORD:
            kind = get_args(each.annotation)
            names += kind[0].__annotations__ if kind and is_typeddict(kind[0]) else given
        elif each.kind is not each.VAR_POSITIONAL:
            names.append(name)
    return [name for name in names if name not in ("self", "cls")]
