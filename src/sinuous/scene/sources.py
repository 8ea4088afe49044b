"""Which file an obstacle was read from, and how obstacles are written into problem files."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from sinuous.errors import InputError
from sinuous.writing.plain import described, plain

if TYPE_CHECKING:
    from sinuous.scene.obstacles import Obstacle


class Source(NamedTuple):
    """Where an obstacle was read from.

    Attributes
    ----------
    file : Path
        Absolute.
    arguments : dict
        How it was read, in plain values: the keys that stand beside the file in a problem file.
    parts : int
        Into how many obstacles, one after the other in their scene, it was divided.
    """

    file: Path
    arguments: dict[str, Any]
    parts: int = 1

    @classmethod
    def of(cls, file: str | Path, **arguments: Any) -> "Source":
        """Remember a file and how it was read; what says nothing is left out."""
        written = {key: plain(value) for key, value in arguments.items()}
        return cls(Path(file).absolute(), {key: value for key, value in written.items() if value is not None})

    def entry(self, folder: Path) -> dict[str, Any]:
        """Return what a problem file in this folder says."""
        try:
            name = Path(os.path.relpath(self.file, folder.absolute())).as_posix()
        except ValueError:  # on another drive
            name = str(self.file)
        return {"file": name, **self.arguments}


def entries_of(obstacles: Sequence["Obstacle"], folder: Path) -> list[dict[str, Any]]:
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
        if source is not None and _whole(rest, source):
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


def _whole(rest: Sequence["Obstacle"], source: Source) -> bool:
    """Whether obstacles begin with all parts of one file, and have the names that a reader gives them.

    It names the parts, and what comes after several of them.
    """
    together = rest[: source.parts]
    named = source.parts == 1 or all(each.name is not None for each in rest)
    whole = len(together) == source.parts and all(part.source is source for part in together)
    return whole and named and len({part.name for part in together}) == 1
