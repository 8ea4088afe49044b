"""How obstacles are written into problem files."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sinuous.errors import InputError
from sinuous.scene.moving import Moving
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.reading import Source
from sinuous.writing.plain import described, plain


def entries_of(obstacles: Sequence[Obstacle], folder: Path) -> list[dict[str, Any]]:
    """Return obstacles as a problem file in `folder` lists them.

    Those from a file stay there; a mesh of which only some parts are left is written out.

    Raises
    ------
    InputError
        For an obstacle that is a function.
    """
    entries = []
    rest = list(obstacles)
    while rest:
        obstacle, source, parts = rest[0], rest[0].source, 1
        if isinstance(obstacle, Moving):
            parts = _as_one(rest, obstacle)
            still = [each.obstacle for each in rest[:parts] if isinstance(each, Moving)]
            entries += [_with_course(entry, obstacle) for entry in entries_of(still, folder)]
        elif source is not None and _whole(rest, source):
            name = {} if obstacle.name is None else {"name": obstacle.name}
            entries.append({obstacle.kind: source.entry(folder) | name})
            parts = source.parts
        elif obstacle.is_function:
            place = f"scene[{len(obstacles) - len(rest)}]"
            raise InputError(place, "is a function", obstacle, "an obstacle that a file can hold")
        else:
            entries.append({obstacle.kind: described(obstacle)})
        del rest[:parts]
    return entries


def _as_one(rest: Sequence[Obstacle], moving: Moving) -> int:
    """How many obstacles, from the first on, move as one."""
    course = moving.course
    others = (i for i, each in enumerate(rest) if not (isinstance(each, Moving) and each.course is course))
    return next(others, len(rest))


def _with_course(entry: dict[str, Any], moving: Moving) -> dict[str, Any]:
    """Add to what a problem file says of an obstacle where it is over time."""
    places: list[Any] = [plain(place) for place in moving.positions]
    if moving.rotations is not None:
        turns = [plain(turn) for turn in moving.rotations]
        places = [{"position": place, "rotation": turn} for place, turn in zip(places, turns, strict=True)]
    course = [[plain(t), place] for t, place in zip(moving.times.tolist(), places, strict=True)]
    return {kind: {**arguments, "moving": course} for kind, arguments in entry.items()}


def _whole(rest: Sequence[Obstacle], source: Source) -> bool:
    """Whether obstacles begin with all parts of one file, and have the names that a reader gives them.

    It names the parts, and what comes after several of them.
    """
    together = rest[: source.parts]
    named = source.parts == 1 or all(each.name is not None for each in rest)
    whole = len(together) == source.parts and all(part.source is source for part in together)
    return whole and named and len({part.name for part in together}) == 1
