"""Triangles from STL, PLY, OBJ and GLB files, read by trimesh."""

from pathlib import Path
from typing import Any

import numpy as np

from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.scene.files import check_file, needed
from sinuous.scene.meshes.topology import Integers

KINDS = (".stl", ".ply", ".obj", ".glb")


def read_mesh(file: Path) -> tuple[Floats, Integers]:
    """Return vertices (v, 3) and triangles (f, 3) of all bodies in a file, as they are placed in it.

    Raises
    ------
    InputError
        When trimesh is missing, or the file cannot be read, is of another kind, or holds no triangles.
    """
    check_file(file, KINDS)
    scene = load(file)
    triangles = [body for body in scene.dump() if len(getattr(body, "faces", ())) > 0]
    if not triangles:
        raise InputError("file", "", str(file), "a mesh with at least one triangle")
    counts = np.cumsum([0, *(len(body.vertices) for body in triangles)])
    faces = [np.asarray(body.faces, np.int64) + first for body, first in zip(triangles, counts, strict=False)]
    return np.concatenate([np.asarray(body.vertices, np.float64) for body in triangles]), np.concatenate(faces)


def load(file: Path) -> Any:
    """Return what trimesh reads from a file, a scene of geometries, untouched.

    Raises
    ------
    InputError
        When trimesh is missing or cannot read the file.
    """
    trimesh = needed("trimesh", "mesh", file)
    try:
        return trimesh.load_scene(file, process=False, maintain_order=True, skip_materials=True)
    except Exception as error:  # whatever a reader trips over, from a KeyError to a struct.error
        reason = " ".join(str(error).split())[:100] or type(error).__name__
        if getattr(error, "name", None) == "charset_normalizer":  # trimesh would guess which text a broken file is
            reason = "neither the text nor the numbers of such a file"
        raise InputError("file", f"cannot be read: {reason}", str(file), f"a file of the kind {file.suffix}") from None
