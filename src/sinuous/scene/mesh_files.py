"""Files of meshes: triangles as they stand in it, what its format says about axes, and what is wrong with it."""

import io
import re
from pathlib import Path
from typing import Any

import numpy as np

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.scene.obstacles import check_file
from sinuous.scene.triangles import Integers

Y_UP = (".glb", ".gltf")
"""Files in which y is up, as their specification says."""

KINDS = (".stl", ".ply", ".obj", *Y_UP)

STL_HEADER = 84
"""Bytes before the triangles of a binary STL file: a text of 80, and how many there are."""

STL_TRIANGLE = 50
"""Bytes of a triangle of a binary STL file."""

STATEMENT = re.compile(r"\b(SPACE|UNITS?)\s*[=:]\s*(\w+)", re.IGNORECASE)
"""What headers of STL files say of axes and units; no reader of STL uses it."""

END = re.compile(r"\bend\s+(solid|facet|loop)\b", re.IGNORECASE)
"""What some programs write for `endsolid`, `endfacet`, `endloop`."""


def read_mesh(file: Path) -> tuple[Floats, Integers, list[str]]:
    """Return vertices (v, 3) and triangles (f, 3) of all bodies in a file, as placed in it, and what is to be noted.

    Raises
    ------
    InputError
        When trimesh is missing, or the file cannot be read, is of another kind, cut off, or holds no triangles.
    """
    check_file(file, KINDS)
    notes: list[str] = []
    content = None
    if file.suffix.lower() == ".stl":
        content, is_text, notes = _check_stl(file)
        if not is_text:
            return *_binary_stl(content), notes
    triangles = [body for body in load_geometry(file, content) if len(getattr(body, "faces", ())) > 0]
    if not triangles:
        raise InputError("file", "holds no triangles", str(file), "a mesh with at least one triangle")
    counts = np.cumsum([0, *(len(body.vertices) for body in triangles)])
    faces = [np.asarray(body.faces, np.int64) + first for body, first in zip(triangles, counts, strict=False)]
    vertices = np.concatenate([np.asarray(body.vertices, np.float64) for body in triangles])
    return vertices, np.concatenate(faces), notes


def load_geometry(file: Path, content: bytes | None = None) -> list[Any]:
    """Return the geometries that trimesh reads from a file (or from this content of it), placed as in its scene.

    Raises
    ------
    InputError
        When trimesh is missing or cannot read the file.
    """
    trimesh = checks.needed("trimesh", "mesh", "file", str(file))
    given: Any = file if content is None else io.BytesIO(content)
    kind = {} if content is None else {"file_type": file.suffix.lower()[1:]}
    try:
        scene = trimesh.load_scene(given, process=False, maintain_order=True, skip_materials=True, **kind)
        return list(scene.dump())
    except Exception as error:  # whatever a reader trips over, from a KeyError to a struct.error
        reason = " ".join(str(error).split())[:100] or type(error).__name__
        if getattr(error, "name", None) == "charset_normalizer":  # trimesh would guess which text a broken file is
            reason = "neither the text nor the numbers of such a file"
        raise InputError("file", f"cannot be read: {reason}", str(file), f"a file of the kind {file.suffix}") from None


def _binary_stl(content: bytes) -> tuple[Floats, Integers]:
    """Vertices and triangles of a binary STL file; trimesh would take a second to be imported."""
    triangle = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    corners = np.frombuffer(content, triangle, offset=STL_HEADER)["corners"]
    return corners.reshape(-1, 3).astype(np.float64), np.arange(3 * len(corners)).reshape(-1, 3)


def _check_stl(file: Path) -> tuple[bytes, bool, list[str]]:
    """Return the content of an STL file as readers know it, whether it is text, and what its header says.

    Refused where it is cut off.
    """
    content = file.read_bytes()
    is_text = content[:5].lower() == b"solid" and b"facet" in content[:1024].lower()
    if not is_text:
        _check_size(file, content)
        count = int(np.frombuffer(content, "<u4", 1, STL_HEADER - 4)[0])
        header, content = content[: STL_HEADER - 4], content[: STL_HEADER + STL_TRIANGLE * count]
    else:
        text = re.sub(
            r"\bend\s+(solid|facet|loop)\b", r"end\1", content.decode("utf-8", "replace"), flags=re.IGNORECASE
        )
        facets, ends = (len(re.findall(word, text, re.IGNORECASE)) for word in (r"\bfacet\s+normal\b", r"\bendfacet\b"))
        if facets != ends or "endsolid" not in text.lower():
            raise InputError("file", f"truncated: the text ends in facet {facets}", str(file), "endsolid at its end")
        header, content = content.split(b"\n", 1)[0], text.encode()
    said = [f"{key.upper()}={value}" for key, value in STATEMENT.findall(header.decode("ascii", "replace"))]
    notes = (
        [f"its header says {' and '.join(said)}, which changed nothing: coordinates are as they stand"] if said else []
    )
    return content, is_text, notes


def _check_size(file: Path, content: bytes) -> None:
    """Refuse a binary STL file that has not the size that its header says."""
    size, whole = len(content), f"an STL file of at least {STL_HEADER} bytes"
    if size < STL_HEADER:
        raise InputError("file", f"truncated: it has {size} bytes" if size else "is empty", str(file), whole)
    count = int(np.frombuffer(content, "<u4", 1, STL_HEADER - 4)[0])
    expected = STL_HEADER + STL_TRIANGLE * count
    if size < expected:
        problem = f"truncated: its header says {count} triangles, which need {expected} bytes, and it has {size}"
        raise InputError("file", problem, str(file), f"{expected} bytes")
    if count == 0:
        problem = "holds no triangles" if size == expected else "its header says 0 triangles, and there are more"
        raise InputError("file", problem, str(file), "a mesh with at least one triangle")
