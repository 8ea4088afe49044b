"""Files by which chunks and their answers travel between processes of one machine.

Pipes carry their names alone. A process that is killed while it writes or reads more than a pipe takes at once leaves
the others waiting for the rest of it, forever.
"""

import os
import pickle
import tempfile
from pathlib import Path
from typing import Any


class Spool:
    """A folder of such files, which is removed with all that is left in it.

    Raises
    ------
    OSError
        When no folder can be made, or a file not be written.
    """

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="sinuous-", ignore_cleanup_errors=True)

    def put(self, value: Any) -> str:
        """Write a value; return the name of the file."""
        return write(value, self._folder.name)

    def close(self) -> None:
        """Remove what is left."""
        self._folder.cleanup()


def write(value: Any, folder: str) -> str:
    """Write a value to a new file in a folder; return its name."""
    handle, name = tempfile.mkstemp(dir=folder)
    with os.fdopen(handle, "wb") as file:
        pickle.dump(value, file, pickle.HIGHEST_PROTOCOL)
    return name


def take(name: str) -> Any:
    """Read a value, and remove its file."""
    with Path(name).open("rb") as file:
        value = pickle.load(file)
    Path(name).unlink()
    return value
