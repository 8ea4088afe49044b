"""Archives of arrays (NPZ): written in one step, and read with all that can be wrong said in one line."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from sinuous.errors import InputError
from sinuous.writing.documents import written


def write_archive(file: str | Path, *, compressed: bool = False, **arrays: Any) -> None:
    """Write arrays by their names, perhaps compressed: a file that was there stays until the new one is complete.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    path = Path(file)
    draft = path.with_name(f".{path.name}.draft")
    with written(path):
        try:
            with draft.open("wb") as out:
                (np.savez_compressed if compressed else np.savez)(out, **arrays)
            draft.replace(path)
        finally:
            draft.unlink(missing_ok=True)


@contextmanager
def read_archive(file: str | Path, key: str, versions: tuple[int, ...], what: str) -> Iterator[Any]:
    """Open an archive that holds under `key` one of these versions, the newest last.

    What is wrong with what it holds, as it turns out within, is said under that key, too.

    Raises
    ------
    InputError
        When it is not `what` is expected.
    """
    try:
        with Path(file).open("rb") as stream, np.load(stream) as data:  # NumPy leaves a file open that is no archive
            if int(data[key]) not in versions:
                raise InputError(key, "of another version", int(data[key]), str(versions[-1]), str(file))
            yield data
    except OSError as error:
        raise InputError(key, f"cannot be read: {error}", str(file), what) from None
    except Exception as error:  # a damaged archive raises errors of zipfile, zlib, numpy, json
        raise InputError(key, f"damaged: {error}", str(file), what) from None
