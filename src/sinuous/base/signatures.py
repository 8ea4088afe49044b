"""Signatures that can be read: kinds of arguments by their names, and options one by one.

Python shows `Number | None` as the union of everything that it stands for, and options as `**options`. What `help`
shows of public names is put right when they are first used; nothing of what they do or accept depends on it.
"""

import inspect
import types
import typing
from collections.abc import Callable, Iterator, Mapping
from itertools import combinations
from typing import Any, Literal, get_args, get_origin, is_typeddict

from sinuous.base import arguments

MOST_NAMES = 3
"""Names of kinds that stand beside each other at most."""

FEW_WORDS = 4
"""Words that an argument may be, up to which they are shown."""


class Shown:
    """What is shown instead of a value, to which it is equal."""

    __slots__ = ("text", "value")

    def __init__(self, text: str, value: Any) -> None:
        self.text, self.value = text, value

    def __repr__(self) -> str:
        return self.text

    def __eq__(self, other: object) -> bool:
        return bool(self.value == (other.value if isinstance(other, Shown) else other))

    def __hash__(self) -> int:
        return hash(self.value)


def make_readable(public: Any) -> None:
    """Let a public function, or a class and its methods, show readable signatures."""
    if inspect.isclass(public):
        for owner in public.__mro__:
            if owner.__module__.partition(".")[0] == "sinuous":
                for name, value in list(vars(owner).items()):
                    function = inspect.unwrap(getattr(value, "__func__", value))
                    if inspect.isfunction(function) and (name == "__init__" or not name.startswith("_")):
                        _put(getattr(value, "__func__", value), function)
    elif inspect.isfunction(public):
        _put(public, inspect.unwrap(public))


def _put(shown: Any, function: Callable[..., Any]) -> None:
    if "__signature__" in vars(shown):
        return
    signature = inspect.signature(function)
    names = dict(_kinds(vars(arguments))) | dict(_kinds(function.__globals__))
    parameters = [new for old in signature.parameters.values() for new in _parameters(old, names)]
    back = signature.return_annotation
    returned = back if back is inspect.Signature.empty else Shown(_text(back, names), back)
    shown.__signature__ = signature.replace(parameters=parameters, return_annotation=returned)


def _kinds(place: Mapping[str, Any]) -> Iterator[tuple[frozenset[Any], str]]:
    """Yield what the named kinds of a module stand for, and their names."""
    for name, value in place.items():
        if name[0].isupper() and isinstance(value, types.UnionType | types.GenericAlias | typing._GenericAlias):  # type: ignore[attr-defined]
            yield frozenset(_members(value)), name


def _parameters(own: inspect.Parameter, names: dict[frozenset[Any], str]) -> Iterator[inspect.Parameter]:
    """Yield a parameter as it is shown; options that are passed on one by one."""
    kind = get_args(own.annotation)[0] if own.kind is own.VAR_KEYWORD and get_args(own.annotation) else None
    if kind is None or not is_typeddict(kind):
        empty = own.annotation is own.empty
        yield own if empty else own.replace(annotation=Shown(_text(own.annotation, names), own.annotation))
        return
    around = {**names, **{members: name for base in _homes(kind) for members, name in _kinds(base)}}
    for name, annotation in kind.__annotations__.items():
        yield inspect.Parameter(
            name,
            inspect.Parameter.KEYWORD_ONLY,
            default=Shown("...", ...),
            annotation=Shown(_text(annotation, around), annotation),
        )


def _homes(kind: Any) -> Iterator[Mapping[str, Any]]:
    """Yield the modules of a `TypedDict` and of those that it stands on."""
    for each in (kind, *getattr(kind, "__orig_bases__", ())):
        module = inspect.getmodule(each)
        if module is not None:
            yield vars(module)


def _members(annotation: Any) -> tuple[Any, ...]:
    if get_origin(annotation) in (types.UnionType, typing.Union):
        return tuple(member for each in get_args(annotation) for member in _members(each))
    return (annotation,)


def _text(annotation: Any, names: dict[frozenset[Any], str]) -> str:
    """Show an annotation by as few and as short names as say the same."""
    if isinstance(annotation, str | typing.ForwardRef):
        return annotation if isinstance(annotation, str) else annotation.__forward_arg__
    members = _members(annotation)
    words = [word for each in members if get_origin(each) is Literal for word in get_args(each)]
    few = words if len(words) <= FEW_WORDS else []
    kept = [each for each in members if each is not type(None) and not (few and get_origin(each) is Literal)]
    parts = [*_cover(kept, names), *map(repr, few), *(["None"] if type(None) in members else [])]
    return " | ".join(parts)


def _cover(members: list[Any], names: dict[frozenset[Any], str]) -> list[str]:
    """Names of kinds that together stand for these members: the fewest, or those that stand for the most."""
    own = {kind: name for kind, name in names.items() if kind <= frozenset(members)}
    own |= {frozenset([each]): _of_one(each, names) for each in members}
    for count in range(1, MOST_NAMES + 1):
        covers = [each for each in combinations(own, count) if frozenset().union(*each) == frozenset(members)]
        if covers:
            return [own[kind] for kind in min(covers, key=lambda each: sum(map(len, each)))]
    rest, found = set(members), list[str]()
    for kind in sorted(own, key=len, reverse=True):
        if kind <= rest:
            rest -= kind
            found.append(own[kind])
    return found


def _of_one(annotation: Any, names: dict[frozenset[Any], str]) -> str:
    if frozenset([annotation]) in names:
        return names[frozenset([annotation])]
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is None or not arguments:
        return getattr(annotation, "__name__", None) or str(annotation).replace("typing.", "")
    if origin is Literal:
        return " | ".join(map(repr, arguments))
    inner = ", ".join("..." if each is Ellipsis else _inner(each, names) for each in arguments)
    return f"{getattr(origin, '__name__', origin)}[{inner}]"


def _inner(argument: Any, names: dict[frozenset[Any], str]) -> str:
    if isinstance(argument, list):
        return "[" + ", ".join(_text(each, names) for each in argument) + "]"
    return _text(argument, names)
