"""Points from PLY, PCD, NPY and text files."""

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous.errors import InputError
from sinuous.scene.clouds.pcd import parse_pcd
from sinuous.scene.files import check_file
from sinuous.scene.meshes.mesh_files import load


def read_points(file: Path) -> NDArray[Any]:
    """Return the points (m, 3) of a file, the kind of which its name says.

    Raises
    ------
    InputError
        When it cannot be read, is of another kind, or its content is no points.
    """
    check_file(file, tuple(READERS))
    points = READERS[file.suffix.lower()](file)
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError("points", f"shape {points.shape}", points, "three columns x, y, z", str(file))
    return points


def _ply(file: Path) -> NDArray[Any]:
    bodies = load(file).dump()
    return np.concatenate([np.zeros((0, 3)), *(np.asarray(body.vertices, np.float64) for body in bodies)])


def _npy(file: Path) -> NDArray[Any]:
    try:
        with file.open("rb") as stream:
            return np.asarray(np.lib.format.read_array(stream, allow_pickle=False))
    except (ValueError, EOFError) as error:
        reason = " ".join(str(error).split())
        raise InputError("file", f"cannot be read: {reason}", str(file), "an NPY file of numbers") from None


def _pcd(file: Path) -> NDArray[Any]:
    return parse_pcd(file.read_bytes(), str(file))


def _text(file: Path) -> NDArray[Any]:
    lines = file.read_bytes().decode("utf-8-sig", "replace").replace(",", " ").replace(";", " ").splitlines()
    first = next((i for i, line in enumerate(lines) if line.split("#")[0].strip()), 0)
    if first < len(lines) and not any(map(_is_number, lines[first].split())):
        lines[first] = ""
    filled = [line for line in lines if line.split("#")[0].strip()]
    if not filled:
        return np.zeros((0, 3))
    columns = len(filled[0].split("#")[0].split())
    if columns < 3:
        raise InputError("points", f"has {columns} of three columns", filled[0], "x, y, z on every line", str(file))
    try:
        return np.loadtxt(io.StringIO("\n".join(filled)), usecols=(0, 1, 2), ndmin=2)
    except ValueError as error:
        reason = " ".join(str(error).split()).split(";")[0]
        raise InputError("points", "", reason, "x, y, z on every line", str(file)) from None


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


READERS: dict[str, Callable[[Path], NDArray[Any]]] = {
    ".ply": _ply,
    ".pcd": _pcd,
    ".npy": _npy,
    ".xyz": _text,
    ".txt": _text,
    ".csv": _text,
}
