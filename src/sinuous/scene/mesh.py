"""Obstacles made of triangles: solid when they are watertight, a shell otherwise."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Number, Orientation, Rows, Triangles, Truth, Vector
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.frozen import text
from sinuous.base.progress import estimated
from sinuous.scene.decimation import decimate
from sinuous.scene.mesh_files import Y_UP, read_mesh
from sinuous.scene.obstacles import Obstacle, Origin, Placement, box_around
from sinuous.scene.triangles import Integers, apart, cuts_itself, drop_unused, mend, pieces

TO_Z_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""The turn by a quarter about x that brings y up to z."""

Up = Literal["y", "z"]
"""Which axis of a file is up."""

ODD = 1000.0
"""By how many times a triangle may be longer than a robot, or a robot than a mesh, before a scale looks wrong."""


TRIANGLE_SECONDS, DECIMATION_SECONDS = 7e-6, 4e-5
"""Seconds that checking a triangle takes, about, and decimating."""


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Mesh(Obstacle):
    """Triangles: a solid where they are watertight, a surface otherwise.

    Watertight means that every edge has exactly two triangles, which run along it in opposite directions, and that the
    whole encloses a volume. Distances to a solid are negative inside; to a surface they are unsigned, less half of its
    `thickness`.

    Vertices that are exactly equal are taken for one unless the surface is closed without that (STL files repeat them).
    Triangles without area and vertices without a triangle are dropped. Bodies that face inwards, and single triangles
    that face another way than their neighbours, are turned.

    Parameters
    ----------
    vertices : array_like (v, 3)
        In the world.
    faces : array_like of int (f, 3)
        Vertices of every triangle, counterclockwise as seen from outside.
    thickness : float
        Of a surface that is not watertight: half of it lies on each side.
    inside : bool
        The body must stay within; for watertight meshes only.
    name : str, optional

    Attributes
    ----------
    vertices : ndarray (v, 3)
    faces : ndarray of int64 (f, 3)
        As used, after what is said above.
    watertight : bool
        Whether it is a solid.
    defects : tuple of str
        What is not as it should be, and what became of it; one sentence each.
    extent : float
        Length of the diagonal of its box; of a mesh that is one of several `bodies`, of all together.
    margin : float
        How far its surface may have been moved by `decimated`; that much about it counts as part of it.
    scale : float or None
        What the coordinates in its file were multiplied with; None when it comes from arrays.

    Raises
    ------
    InputError
        When there are no triangles, a vertex is not finite, a triangle has a vertex that is not there, or when
        `thickness` or `inside` do not fit to what the mesh is.
    """

    faces: Integers
    thickness: float
    inside: bool
    watertight: bool
    defects: tuple[str, ...]
    extent: float
    margin: float
    scale: float | None

    def __init__(
        self,
        vertices: Rows,
        faces: Triangles,
        *,
        thickness: Number = 0.0,
        inside: Truth = False,
        name: str | None = None,
    ) -> None:
        places = checks.points("vertices", vertices)
        numbers = _indices(faces, len(places))
        with estimated(f"checking {len(numbers):,} triangles", TRIANGLE_SECONDS * len(numbers)):
            clean, used, solid, defects = mend(places, numbers)
            cuts = solid and cuts_itself(clean, used)
        if cuts:
            solid = False
            defects.append("its surface cuts through itself, so it is used as a shell and not as a solid")
        width, within = checks.number("thickness", thickness, low=0.0), checks.truth("inside", inside)
        if width > 0.0 and solid:
            raise InputError("thickness", "is for open meshes", width, "none: this mesh is watertight, a solid")
        if within and not solid:
            raise InputError("inside", "needs a watertight mesh", within, f"another mesh: {defects[-1]}")
        self._keep(
            name,
            _vertices=checks.closed(clean),
            faces=checks.closed(used),
            thickness=width,
            inside=within,
            watertight=solid,
            defects=tuple(defects),
            extent=float(np.linalg.norm(np.ptp(clean, axis=0))),
            margin=0.0,
            scale=None,
        )

    @property
    def vertices(self) -> Floats:
        """Corners (v, 3) of the triangles, in the world."""
        own: Floats = vars(self)["_vertices"]
        return self._in_place(own)

    @classmethod
    def load(
        cls,
        file: str | Path,
        scale: Number,
        position: Vector | None = None,
        rotation: Orientation | None = None,
        thickness: Number = 0.0,
        inside: Truth = False,
        name: str | None = None,
        *,
        xyzw: Vector | None = None,
        up: Up | None = None,
        decimate: Number | None = None,
    ) -> "Mesh":
        """Read a mesh from an STL, PLY, OBJ, GLB, GLTF or 3MF file; all but binary STL and 3MF need the extra `mesh`.

        A vertex p of the file comes to lie at `rotation @ (scale * p) + position`. Of several bodies in a file all are
        used, as they are placed in it. In GLB and GLTF files y is up and lengths are in metres, as their specification
        says; they are turned so that z is up first, and `defects` says so, as it says the unit of a 3MF file.

        Parameters
        ----------
        file : path
        scale : float
            Length unit of the scene over that of the file, like 0.001 for a file in mm and a robot in m: most mesh
            files do not say it.
        position : array_like (3,), optional
            Where the origin of the file lies.
        rotation : array_like (3, 3) or (4,), or Rotation of SciPy, optional
            A matrix or a quaternion wxyz.
        thickness, inside, name
            See `Mesh`.
        xyzw : array_like (4,), optional
            A quaternion in the order of SciPy and ROS, instead of `rotation`.
        up : str, optional
            Which axis of the file is up, `y` or `z`; `y` is turned to z. By default `y` of GLB and GLTF, else `z`.
        decimate : float, optional
            How far the surface may be moved, in the unit of the scene, to have fewer triangles: see `decimated`. By
            default all triangles are used.

        Raises
        ------
        InputError
            When the package is missing, the file cannot be read, is cut off or holds no mesh, or as `Mesh` does.
        """
        placement = Placement(scale, position, rotation, xyzw)
        if up is not None:
            checks.choice("up", up, get_args(Up))
        vertices, faces, notes = read_mesh(Path(file))
        upwards = up or ("y" if Path(file).suffix.lower() in Y_UP else "z")
        if up is None and upwards == "y":
            notes.append(
                "y is up in such a file, so it was turned to have z up; up: z leaves it as it stands; "
                "its unit is the metre, and its lengths were multiplied by scale, and by nothing else"
            )
        try:
            turned = vertices @ TO_Z_UP.T if upwards == "y" else vertices
            moved = placement.apply(checks.points("vertices", turned))
            mesh = cls(moved, faces, thickness=thickness, inside=inside, name=name)
            mesh = mesh if decimate is None else mesh.decimated(decimate)
        except InputError as error:
            raise error.in_file(file) if error.key.startswith(("vertices", "faces")) else error from None
        said = {"thickness": mesh.thickness or None, "inside": mesh.inside or None, "up": up, "decimate": decimate}
        source = Origin.of(file, **placement.arguments, **said)
        mesh._keep(name, scale=placement.scale, defects=(*notes, *mesh.defects), _source=source)
        return mesh

    def decimated(self, most: Number) -> "Mesh":
        """Return a mesh of fewer triangles, whose surface was moved by at most `most`; needs the extra `mesh`.

        How far it was moved is proved, not estimated, and counts as part of the obstacle (`margin`): what is clear of
        the new mesh does not touch the surface of this one, and clearances are no larger than they are to this one.
        `defects` says how many triangles there were, and the margin. Where fewer triangles do not do, it is this mesh.

        Raises
        ------
        InputError
            When `most` is not greater than 0, the body must stay within, or the package is missing.
        """
        width = checks.number("decimate", most, above=0.0)
        if self.inside:
            raise InputError("decimate", "is for what the body stays out of", most, "inside: false, or all triangles")

        def solid(vertices: Floats, faces: Integers) -> bool:
            return not self.watertight or Mesh(vertices, faces).watertight

        with estimated(f"decimating {len(self.faces):,} triangles", DECIMATION_SECONDS * len(self.faces)):
            found = decimate(self.vertices, self.faces, width, solid)
        if found is None:
            return self
        fewer = Mesh(found.vertices, found.faces, thickness=self.thickness, inside=self.inside, name=self.name)
        note = (
            f"{len(self.faces):,} triangles were decimated to {len(fewer.faces):,}, which moved the surface by at most "
            f"{found.bound:.3g}: that much about it counts as part of it"
        )
        fewer._set(margin=found.bound + self.margin, defects=(*self.defects, note, *fewer.defects), scale=self.scale)
        return fewer

    def bodies(self) -> "tuple[Mesh, ...]":
        """Divide a solid whose bodies may overlap, like the parts of a machine, into solids within which none do.

        Distances to bodies that overlap are known to each of them only, not to their triangles taken together. A mesh
        that needs no dividing, is a shell, or is to be stayed within, is returned as it is. The first part has
        all defects.
        """
        whole = not self.watertight or self.inside or self.piece_count == 1
        groups = [] if whole else apart(self.vertices, self.faces)
        if len(groups) < 2:
            return (self,)
        own = super().source
        source = None if own is None else own._replace(parts=len(groups))
        return tuple(
            self._part(faces, defects=() if i else self.defects, _source=source, _together=len(groups))
            for i, faces in enumerate(groups)
        )

    def _part(self, faces: Integers, **told: Any) -> "Mesh":
        """Return a solid of some of the bodies; nothing of it is checked again."""
        vertices, used = drop_unused(self.vertices, faces)
        part = object.__new__(Mesh)
        part._set(**{name: value for name, value in vars(self).items() if name not in ("_longest", "piece_count")})
        part._set(_vertices=checks.closed(vertices), faces=checks.closed(used), _place=None, **told)
        return part

    @property
    def half_thickness(self) -> float:
        """How far it reaches beyond its triangles."""
        return 0.5 * self.thickness + self.margin

    @cached_property
    def piece_count(self) -> int:
        """How many pieces it has that hang together."""
        return int(pieces(vars(self)["_vertices"], self.faces).max()) + 1

    @property
    def together(self) -> int:
        """Of how many parts of one mesh it is one, see `bodies`; they share what samples one obstacle has."""
        return int(vars(self).get("_together", 1))

    @property
    def source(self) -> Origin | None:
        """See `Obstacle.source`; None where reading the file again would divide the mesh into several."""
        own = super().source
        return None if own is not None and own.parts == 1 and len(self.bodies()) > 1 else own

    @property
    def _box(self) -> Floats:
        return box_around(self.vertices[np.unique(self.faces)], self.half_thickness)

    def _content(self) -> dict[str, Any]:
        """What it is, without what is told of where it came from."""
        told = ("defects", "extent", "scale")
        own = {name: value for name, value in super()._content().items() if name not in told}
        return own | {"vertices": self.vertices}

    def _shown(self) -> Iterator[str]:
        yield f"{len(self.vertices)} vertices, {len(self.faces)} triangles, {'solid' if self.watertight else 'shell'}"
        yield from () if self.name is None else (f"name={text(self.name)}",)

    @cached_property
    def _longest(self) -> float:
        """The longest side of a triangle."""
        corners = vars(self)["_vertices"][self.faces]
        return float(np.sqrt(((np.roll(corners, -1, axis=1) - corners) ** 2).sum(axis=-1).max()))

    def check_size(self, length: float) -> None:
        """Refuse a mesh that no robot of this length can be meant to meet: its unit must be another one.

        Raises
        ------
        InputError
            When a triangle is `ODD` times as long as the robot, or the robot as the whole mesh.
        """
        longest = self._longest
        key, value = ("vertices", self.extent) if self.scale is None else ("scale", self.scale)
        expected = f"a mesh in the unit of the robot, which is {length:g} long"
        if longest > ODD * length:
            raise InputError(key, f"makes a triangle {longest:g} long", value, expected)
        if self.extent * ODD < length:
            raise InputError(key, f"makes the whole mesh only {self.extent:g} large", value, expected)


def _indices(faces: Any, count: int) -> Integers:
    """Check triangles as rows of three vertex numbers below `count`."""
    expected = f"rows of 3 whole numbers from 0 to {count - 1}"
    try:
        result = np.array(faces)
    except (ValueError, TypeError, OverflowError):
        raise InputError("faces", "", faces, expected) from None
    if result.size == 0:
        raise InputError("faces", "", faces, "at least one triangle")
    if result.dtype.kind not in "iu":
        raise InputError("faces", "", faces, expected)
    if result.ndim != 2 or result.shape[1] != 3:
        raise InputError("faces", f"shape {result.shape}", faces, expected)
    wrong = ((result < 0) | (result >= count)).any(axis=1)
    if wrong.any():
        first = int(wrong.argmax())
        raise InputError(f"faces[{first}]", "has a vertex that is not there", result[first].tolist(), expected)
    return result.astype(np.int64)
