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

    Raises
    ------
    InputError
        For an obstacle that is neither exact nor, with all its parts, from a file.
    """
    entries = []
    first = 0
    while first < len(obstacles):
        obstacle, source = obstacles[first], obstacles[first].source
        parts = 1 if source is None else source.parts
        together = obstacles[first : first + parts]
        if len(together) != parts or any(part.source is not source for part in together):
            raise InputError(f"scene[{first}]", "is a part of what its file holds", obstacle, f"all {parts} parts")
        if source is not None:
            name = {} if obstacle.name is None else {"name": obstacle.name}
            entries.append({obstacle.kind: source.entry(folder) | name})
        elif obstacle.exact:
            entries.append({obstacle.kind: described(obstacle)})
        else:
            raise InputError(f"scene[{first}]", "is not from a file", obstacle, "exact shapes, or obstacles from files")
        first += parts
    return entries
