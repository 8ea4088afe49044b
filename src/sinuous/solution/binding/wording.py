"""What holds a configuration back, in words."""

from collections.abc import Iterable

from sinuous.solution.binding.binding import ACTIVE, Binding
from sinuous.words import listed, number, segments

KINDS = {"bend_rate": "bend", "length_rate": "length"}

ENDS = {"length[0]": "least ", "length[1]": "greatest "}


def in_words(binding: Iterable[Binding], count: int, values: bool = False) -> list[str]:
    """Name what holds a configuration back, in the same order: `bend of segments 1 and 2`, `displacement of s1.t4`.

    Segments and actuators with the same limit are named together; `count` is the number of the robot's segments. With
    `values` it is also said what there is, and what is allowed.
    """
    groups: dict[tuple[str, str], list[Binding]] = {}
    for each in binding:
        groups.setdefault((_what(each), _measured(each) if values else ""), []).append(each)
    return [f"{what}{_whose(own, count)}{': ' if values else ''}{measured}" for (what, measured), own in groups.items()]


def _what(binding: Binding) -> str:
    """What is limited, or the name of the obstacle."""
    if binding.obstacle is not None:
        return binding.obstacle
    if binding.other_segment is not None:
        whom = "itself" if binding.other_segment == binding.segment else f"segment {binding.other_segment}"
        return f"segment {binding.segment} touches {whom}"
    if _is_rate(binding):
        return f"change of the {KINDS[binding.constraint]}" if binding.actuator is None else "change"
    if binding.actuator is not None and binding.key is not None:
        name = binding.key.partition("[")[0]
        return "value" if name == "actuators.limits" else name.rpartition(".")[2]
    return f"{ENDS.get(binding.key or '', '')}{binding.constraint}"


def _whose(own: list[Binding], count: int) -> str:
    if own[0].obstacle is not None or own[0].other_segment is not None:
        return ""
    if own[0].actuator is not None:
        return f" of {listed(sorted(each.actuator or '' for each in own))}"
    return f" of {segments([each.segment or 0 for each in own], count)}"


def _measured(binding: Binding) -> str:
    """What there is, and what is allowed."""
    value, limit = binding.value, binding.limit
    if binding.other_segment is not None:
        return f"{number(max(0.0, -value))} too near"
    if binding.obstacle is not None:
        where = "the body" if binding.segment is None else f"segment {binding.segment}"
        return f"{where} is {number(-value)} deep in it" if value < 0.0 else f"{where} touches it"
    thick = ", because the body is that thick" if binding.key == "radius" else ""
    if abs(value - limit) <= ACTIVE * max(1.0, abs(limit)) or _is_rate(binding):
        return f"at its limit of {number(limit)}{thick}"
    bound = "at least" if binding.key is not None and binding.key.endswith("[0]") else "at most"
    return f"{number(value)}, {bound} {number(limit)} is allowed"


def _is_rate(binding: Binding) -> bool:
    """Whether it is a change that is used up, as only such are named."""
    return binding.key is not None and binding.key.startswith("rates.")
