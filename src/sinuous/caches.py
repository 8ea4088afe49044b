"""Where things are kept that took long to compute, and can be computed again."""

import os
import tempfile
from pathlib import Path


def places(name: str) -> list[Path]:
    """Directories of this name to try, best first: in the user's cache, or where temporary files are."""
    cache = os.environ.get("XDG_CACHE_HOME")
    user = os.getuid() if hasattr(os, "getuid") else 0
    return [
        (Path(cache) if cache else Path.home() / ".cache") / "sinuous" / name,
        Path(tempfile.gettempdir()) / f"sinuous-{user}" / name,
    ]


def writable(directory: Path) -> bool:
    """Make a directory, and tell whether files can be made in it."""
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=directory):
            return True
    except OSError:
        return False
