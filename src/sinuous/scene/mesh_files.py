"""Files of meshes: triangles as they stand in it, what its format says about axes, and what is wrong with it."""

import io
import re
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.scene.obstacles import check_file
from sinuous.scene.triangles import Integers

Y_UP = (".glb", ".gltf")
"""Files in which y is up, as their specification says."""

KINDS = (".stl", ".ply", ".obj", ".3mf", *Y_UP)

MODEL = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
"""What stands before the names of elements of a 3MF model."""

MODEL_PART = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
"""What a 3MF file calls the part that has its model."""

DEEPEST = 32
"""Components within components of a 3MF file, at most."""

COMMENTS = {".obj": b"#", ".ply": b"comment"}
"""How a line begins in which such a file may say what it likes."""

HEAD = 4096
"""Bytes in which comments are looked at."""

STL_HEADER = 84
"""Bytes before the triangles of a binary STL file: a text of 80, and how many there are."""

STL_TRIANGLE = 50
"""Bytes of a triangle of a binary STL file."""

STATEMENT = re.compile(r"\b(SPACE|UNITS?|UP(?:[ _-]?AXIS)?)\s*[=:]\s*(\w+)", re.IGNORECASE)
"""What headers and comments say of axes and units, where the format leaves it open; nothing is changed for it."""

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
    content, kind = None, file.suffix.lower()
    if kind == ".3mf":
        return _read_3mf(file)
    notes = said_of_file(file, COMMENTS[kind]) if kind in COMMENTS else []
    if kind == ".stl":
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
        text = END.sub(r"end\1", content.decode("utf-8", "replace"))
        facets, ends = (len(re.findall(word, text, re.IGNORECASE)) for word in (r"\bfacet\s+normal\b", r"\bendfacet\b"))
        if facets != ends or "endsolid" not in text.lower():
            raise InputError("file", f"truncated: the text ends in facet {facets}", str(file), "endsolid at its end")
        header, content = content.split(b"\n", 1)[0], text.encode()
    return content, is_text, said_of(header.decode("ascii", "replace"))


def said_of_file(file: Path, comment: bytes) -> list[str]:
    """Note what the first lines of a file that begin with `comment` say of axes and units."""
    with file.open("rb") as stream:
        lines = stream.read(HEAD).splitlines()
    return said_of(b"\n".join(line for line in lines if line.lstrip().startswith(comment)).decode("utf-8", "replace"))


def said_of(header: str) -> list[str]:
    """Note what a header says of axes and units; no line where it says nothing."""
    said = " and ".join(f"{key.upper()}={value}" for key, value in STATEMENT.findall(header))
    return [f"its header says {said}, which changed nothing: coordinates are as they stand"] if said else []


def _read_3mf(file: Path) -> tuple[Floats, Integers, list[str]]:
    """What a 3MF file builds, in the unit that it says: meshes, and components of meshes, each in its place."""
    try:
        with zipfile.ZipFile(file) as parts:
            links = ElementTree.fromstring(parts.read("_rels/.rels"))
            name = next(each.attrib["Target"] for each in links if each.attrib["Type"] == MODEL_PART)
            model = ElementTree.fromstring(parts.read(name.lstrip("/")))
        needs = model.get("requiredextensions", "")
        if needs:
            raise InputError(
                "file", f"requires the extensions {needs} of 3MF", str(file), "meshes and components alone"
            )
        objects = {each.attrib["id"]: each for each in model.iter(f"{MODEL}object")}
        built = [
            body
            for item in model.iter(f"{MODEL}item")
            for body in _bodies_3mf(objects, item.attrib["objectid"], _transform_3mf(item), DEEPEST)
        ]
    except InputError:
        raise
    except Exception as error:  # whatever a damaged archive or text makes its readers trip over
        reason = " ".join(str(error).split())[:100] or "it has no model"
        raise InputError("file", f"cannot be read: {reason}", str(file), "a 3MF file") from None
    if not sum(len(faces) for _, faces in built):
        raise InputError("file", "builds no triangles", str(file), "a mesh with at least one triangle")
    counts = np.cumsum([0, *(len(vertices) for vertices, _ in built)])
    faces = np.concatenate([own + first for (_, own), first in zip(built, counts, strict=False)])
    unit = model.get("unit", "millimeter")
    notes = [f"its unit is the {unit}; its lengths were multiplied by scale, and by nothing else"]
    return np.concatenate([vertices for vertices, _ in built]), faces, notes


def _bodies_3mf(
    objects: Mapping[str, Any], number: str, place: Floats, depth: int
) -> Iterator[tuple[Floats, Integers]]:
    """Yield vertices (v, 3) and triangles (f, 3) of an object of a 3MF model, placed by (4, 3): `(p, 1) @ place`."""
    if not depth:
        raise ValueError("components within themselves")
    own = objects[number]
    for mesh in own.iter(f"{MODEL}mesh"):
        places = [[float(p.attrib[axis]) for axis in "xyz"] for p in mesh.iter(f"{MODEL}vertex")]
        corners = [
            [int(each.attrib[corner]) for corner in ("v1", "v2", "v3")] for each in mesh.iter(f"{MODEL}triangle")
        ]
        faces = np.array(corners, np.int64).reshape(-1, 3)
        if faces.size and not 0 <= faces.min() <= faces.max() < len(places):
            raise ValueError("a triangle has a vertex that is not there")
        mirrored = np.linalg.det(place[:3]) < 0.0
        yield np.array(places).reshape(-1, 3) @ place[:3] + place[3], faces[:, ::-1] if mirrored else faces
    for part in own.iter(f"{MODEL}component"):
        inner = _transform_3mf(part)
        both = np.concatenate([inner[:3] @ place[:3], inner[3:] @ place[:3] + place[3]])
        yield from _bodies_3mf(objects, part.attrib["objectid"], both, depth - 1)


def _transform_3mf(item: Any) -> Floats:
    """Return what `(p, 1)` is multiplied with (4, 3), of an item or a component; one in another file is refused."""
    if any(key.endswith("}path") for key in item.attrib):
        raise ValueError("a part is in another file (production extension)")
    numbers = item.get("transform", "1 0 0 0 1 0 0 0 1 0 0 0").split()
    return np.array(numbers, np.float64).reshape(4, 3)


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
