"""What readers of geometry have in common."""

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from sinuous.errors import InputError


def check_file(file: Path, kinds: Sequence[str]) -> None:
    """Refuse a file that is not there or cannot be read, or whose name does not end in one of `kinds`."""
    if file.suffix.lower() not in kinds:
        raise InputError("file", "", str(file), "a name that ends in " + ", ".join(kinds))
    try:
        with file.open("rb"):
            pass
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            "file", f"cannot be read: {reason}", str(file), "the name of a file that can be read"
        ) from None


def needed(package: str, extra: str, file: Path) -> Any:
    """Import a package that an extra brings, or say what to install."""
    try:
        return import_module(package)
    except ImportError:
        raise InputError("file", f"needs {package}", str(file), f"it installed: pip install sinuous[{extra}]") from None
