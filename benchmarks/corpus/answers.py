"""What is kept of an answer, as plain values to the last bit, and how two of them differ."""

import dataclasses
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from enum import Enum
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

ATTRIBUTES = {
    "Solution": "status q position_error angle_error clearance self_clearance demanded_clearance "
    "demanded_self_clearance starts start iterations method route route_class reason worst binding actuators tensions "
    "sentence",
    "Solutions": "status q position_error angle_error clearance self_clearance starts start iterations actuators",
    "Explanation": "status reason binding nearest remedies complete sentence misses untried",
    "Step": "status q velocity twist share proved touching clearance self_clearance position_error angle_error active "
    "observed",
    "Motion": "status q times between waypoint_knots reconfigured remaining unproved_steps clearance self_clearance "
    "largest_step worst actuators",
    "Equilibrium": "q states tensions stable reaction iterations arcs poses",
    "Derivative": "q tip actuators clearance regular singular active",
    "Derivatives": "q tip actuators regular",
    "Response": "tip states tensions regular",
    "LeaderDerivative": "q configurations regular",
    "Calibration": "robot device groups trials parameters residuals held_back dropped notes",
    "Design": "minimise front deciding changes cut tried most_done tasks",
    "Assessment": "totals rows",
    "Reach": "verdicts free obstacles names base farthest directions",
    "Memory": "q edges",
    "Batch": "rows counts invalid failed before total results",
    "Exploration": "memory shapes motions tests spacing rounds full parts",
}
"""Public attributes of the answers that hold more than plain values."""

PLACES = ("robot", "scene", "problem", "motor")
"""What answers name of their questions, beside what was found."""

CLOCKED = ("seconds", "prepare_seconds", "version")
"""What no two runs, or versions, have in common."""

WORDS = ("sentence", "misses", "untried", "notes", "note", "words", "deciding")
"""Keys of what is said in words, and may be said in others."""

ADDED = ("place", "step", "time", "in_solid")
"""Keys that answers of earlier versions do not have: what these do not say is no difference."""

CHANGING = re.compile(rf"/[^\s']*/tmp\w{{8}}|{re.escape(str(Path(__file__).parents[2]))}|0x[0-9a-f]+")
"""What texts hold of one run: a folder for the time being, where the repository is, an address."""


class Problem(NamedTuple):
    """A question with its name.

    Attributes
    ----------
    name : str
        Of its piece, unique.
    ask : callable
        Returns the answer.
    right : callable, optional
        Whether independent judges find an answer right.
    """

    name: str
    ask: Callable[[], Any]
    right: Callable[[Any], bool] | None = None


class Difference(NamedTuple):
    """Where two answers differ: the way there, and what each has; `None` where it has nothing."""

    key: str
    before: Any
    after: Any

    @property
    def relative(self) -> float:
        """Of two numbers, the difference over the larger of them; else infinite."""
        numbers = [each for each in (self.before, self.after) if isinstance(each, int | float)]
        if len(numbers) < 2 or not np.isfinite(numbers).all():
            return np.inf
        return abs(numbers[0] - numbers[1]) / max(*map(abs, numbers), 1e-300)

    @property
    def of_words(self) -> bool:
        """Whether only words differ."""
        return any(part.partition("[")[0] in WORDS for part in self.key.split("."))


def plain(value: Any) -> Any:
    """Return the plain values of an answer: of JSON, floats to the last bit.

    Raises
    ------
    AttributeError
        When it holds what is not known here.
    """
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, Enum):
        value = value.value
    if isinstance(value, str):
        return CHANGING.sub("...", value)
    if value is None or isinstance(value, bool | int | float):
        return value
    names = _names(value)
    if names is not None:
        return {name: plain(getattr(value, name)) for name in names}
    if isinstance(value, list | tuple):
        return [plain(each) for each in value]
    entries: Mapping[Any, Any] = value if isinstance(value, Mapping) else value.to_dict()
    return {str(key): plain(each) for key, each in entries.items() if key not in CLOCKED}


def _names(value: Any) -> Sequence[str] | None:
    """Attributes that are kept of an answer; `None` where it is a list, or says itself what it is."""
    if type(value).__name__ in ATTRIBUTES:
        return ATTRIBUTES[type(value).__name__].split()
    if isinstance(value, tuple):
        names = getattr(value, "_fields", None)
    elif dataclasses.is_dataclass(value):
        names = [field.name for field in dataclasses.fields(value) if not field.name.startswith("_")]
    else:
        names = None
    return None if names is None else [name for name in names if name not in (*PLACES, *CLOCKED)]


def differences(before: Any, after: Any, key: str = "") -> Iterator[Difference]:
    """Yield where plain values differ; NaN is equal to NaN, and 0.0 is not -0.0."""
    if isinstance(before, dict) and isinstance(after, dict):
        for name in {**before, **after}:
            if name in ADDED and name not in before:
                continue
            yield from differences(before.get(name), after.get(name), f"{key}.{name}" if key else name)
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        for i, (one, other) in enumerate(zip(before, after, strict=True)):
            yield from differences(one, other, f"{key}[{i}]")
    elif repr(before) != repr(after):
        yield Difference(key, before, after)
