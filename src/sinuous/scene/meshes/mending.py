"""What may be wrong with triangles from a file: what is mended, what is only said."""

from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.scene.meshes import orientation, topology
from sinuous.scene.meshes.slivers import without_slivers
from sinuous.scene.meshes.topology import Integers


def mend(vertices: Floats, faces: Integers) -> tuple[Floats, Integers, bool, list[str]]:
    """Mend triangles as far as that is certain.

    Parameters
    ----------
    vertices : ndarray (v, 3)
    faces : ndarray (f, 3)

    Returns
    -------
    vertices, faces : ndarray
        Those worth keeping.
    solid : bool
        Whether they enclose a solid.
    defects : list of str
        What was not as it should be, and what became of it; last what keeps it from being a solid.

    Raises
    ------
    InputError
        When no triangle has an area.
    """
    defects = []
    if not topology.edges(faces).closed:
        vertices, faces = topology.merge_equal(vertices, faces)
    good = topology.are_triangles(vertices, faces)
    if not good.any():
        raise InputError("faces", "has only triangles without area", len(faces), "at least one triangle with an area")
    if not good.all():
        defects.append(f"{_counted(int((~good).sum()), 'triangle')} without area dropped")
        if topology.edges(faces).closed:
            faces = without_slivers(vertices, faces)
        faces = faces[topology.are_triangles(vertices, faces)]
    vertices, faces = topology.drop_unused(vertices, faces)
    edges = topology.edges(faces)
    if edges.clashing and not edges.border and not edges.crowded:
        faces, turned = orientation.turn_alike(faces)
        defects += _turned(turned, "another way than the neighbours")
        edges = topology.edges(faces)
    if edges.closed:
        faces, turned = orientation.turn_outwards(vertices, faces)
        defects += _turned(turned, "inwards")
    volume = topology.volume(vertices, faces)
    reason = _open(edges, volume)
    if reason:
        defects.append(f"{reason}, so it is used as a shell and not as a solid")
    return vertices, faces, not reason, defects


def _turned(count: int, how: str) -> list[str]:
    were = "was" if count == 1 else "were"
    return [f"{_counted(count, 'triangle')} faced {how} and {were} turned"] if count else []


def _open(edges: topology.Edges, volume: float) -> str:
    """Say why triangles enclose no solid; nothing when they do."""
    found = [
        f"{_counted(count, 'edge')} {what}"
        for count, what in (
            (edges.border, "with one triangle only (holes)"),
            (edges.crowded, "with more than two triangles (not manifold)"),
            (edges.clashing, "between triangles that face opposite ways"),
        )
        if count
    ]
    return ", ".join(found) or ("" if volume else "encloses no volume")


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
