"""Which file an obstacle was read from."""

import os
from pathlib import Path
from typing import Any, NamedTuple

from sinuous.writing.plain import plain


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
