"""Arrays from NPZ files, without running what may be pickled in them."""

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous.errors import InputError
from sinuous.scene.files import check_file

NAMES = ("values", "origin", "spacing")


def read_arrays(file: Path) -> dict[str, NDArray[Any]]:
    """Return the arrays `values`, `origin` and `spacing` (one number) of an NPZ file.

    Raises
    ------
    InputError
        When it is no such file, one is missing, or one holds Python objects.
    """
    check_file(file, (".npz",))
    if not zipfile.is_zipfile(file):
        raise InputError("file", "cannot be read: no NPZ file", str(file), "an NPZ file")
    try:
        with np.load(file, allow_pickle=False) as arrays:
            found = {name: _array(arrays, name) for name in NAMES}
    except InputError as error:
        raise error.in_file(file) from None
    except (OSError, EOFError, zipfile.BadZipFile, NotImplementedError) as error:
        raise InputError("file", f"cannot be read: {error}", str(file), "an NPZ file") from None
    if found["spacing"].size != 1:
        raise InputError("spacing", "", found["spacing"], "the same spacing along all axes", str(file))
    return found


def _array(arrays: Any, name: str) -> NDArray[Any]:
    if name not in arrays:
        raise InputError(name, "missing", list(arrays), "an array called " + ", ".join(NAMES))
    try:
        return np.asarray(arrays[name])
    except ValueError as error:  # an array of Python objects, or one whose header is no header
        raise InputError(name, "cannot be read", " ".join(str(error).split()), "an array of numbers") from None
