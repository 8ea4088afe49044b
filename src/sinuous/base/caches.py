"""Where things are kept that took long to compute, and can be computed again."""

import os
import sys
import tempfile
from pathlib import Path


def places(name: str) -> list[Path]:
    """Directories of this name to try, best first: in the user's cache, or where temporary files are.

    `SINUOUS_CACHE`, if it is set, names the one directory that all of it goes into.
    """
    own = os.environ.get("SINUOUS_CACHE")
    if own:
        return [Path(own).expanduser() / name]
    user = os.getuid() if hasattr(os, "getuid") else 0
    return [_of_user() / "sinuous" / name, Path(tempfile.gettempdir()) / f"sinuous-{user}" / name]


def writable(directory: Path) -> bool:
    """Make a directory, and tell whether files can be made in it, by this user and nobody else."""
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=directory):
            return own(directory)
    except OSError:
        return False


def own(directory: Path) -> bool:
    """Tell whether nobody but this user, and the system, may write into a directory: others could plant files."""
    if not hasattr(os, "getuid"):
        return True
    found = directory.stat()
    return found.st_uid in {os.getuid(), 0} and not found.st_mode & 0o002


def _of_user() -> Path:
    """The platform's directory for caches of this user."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    named = os.environ.get("XDG_CACHE_HOME")
    if named:
        return Path(named)
    return Path.home() / ("Library/Caches" if sys.platform == "darwin" else ".cache")
