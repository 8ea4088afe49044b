"""Joints of a robot that a URDF describes: the chain from a root link to a tip link, with bodies as capsules.

`yourdfpy` reads the file. Fixed joints are folded: what they hold belongs to the link that moves. Collision shapes
become capsules that contain them.
"""

import io
import math
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Number
from sinuous.base.checks import Floats, readable
from sinuous.base.errors import InputError, counted, number, suggested
from sinuous.files import link_capsules
from sinuous.files.link_capsules import Shape
from sinuous.model.joints import Fixed, Joint, LinkCapsule, Prismatic, Revolute
from sinuous.scene.mesh_files import read_mesh

CAPSULE = "sinuous:capsule"
"""Name given to a collision whose shape is a capsule, which URDF does not have and some programs write."""

SKIPPED = ("visual", "transmission", "gazebo", "material")
"""Elements that say nothing of joints and bodies."""

ALIKE = 1.005
"""Up to this ratio a volume counts as the same."""

SAME = 1e-12
"""A pose that is as near to none as this, in any entry, is left out."""


def read_joints(
    urdf: str | Path,
    tip: str | None = None,
    root: str | None = None,
    srdf: str | Path | None = None,
    meshes: bool = True,
    scale: Number = 1.0,
) -> list[Joint]:
    """Read the joints of a robot from a URDF: `Robot(segments, joints=read_joints("arm.urdf", tip="tool0"))`.

    The first segment begins at the frame of the tip. Fixed joints are folded. Links that hang on fixed joints belong to
    the body, but for those that hang on the tip. Collision shapes become capsules that contain them; `joint.notes`, and
    `robot.notes`, say how much larger these are. A joint that turns without end (`continuous`) gets limits of -pi and
    pi. Speeds become `rate`.

    Parameters
    ----------
    urdf : path
        Without xacro: `xacro arm.urdf.xacro > arm.urdf` expands that.
    tip, root : str, optional
        Links at the ends of the chain; where they are left out, the only link at that end.
    srdf : path, optional
        Of MoveIt: links with `disable_collisions` may touch, where all links that move together with either may.
    meshes : bool
        Whether meshes become capsules, too; otherwise they are left out, which a note says.
    scale : float
        Length units in a metre: 1000 for a robot in mm.

    Returns
    -------
    list of Joint

    Raises
    ------
    InputError
        In one line that names the joint or link: when it moves with another one (`mimic`), floats, moves in a plane or
        has no limits; when there is no such link, a mesh cannot be read, `yourdfpy` is missing, or the file is no URDF.
    """
    factor = checks.number("scale", scale, above=0.0)
    with_meshes = checks.truth("meshes", meshes)
    file = Path(urdf)
    model = _read(file)
    with checks.in_file(file):
        chain = _chain(model, root, tip)
        folder = file.parent
        groups = _groups(model, chain, lambda link: _body(link, folder, with_meshes))
        allowed = _touching(groups, set() if srdf is None else _disabled(Path(srdf)))
        return list(_joints(groups, allowed, factor))


@dataclass
class _Group:
    """Links that move together, the joint that moves them, and the pose of the last one in the frame of the first."""

    joint: Any
    origin: Floats
    links: list[str] = field(default_factory=list)
    with_body: list[str] = field(default_factory=list)
    shapes: list[Shape] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    last: Floats = field(default_factory=lambda: np.eye(4))


def _read(file: Path) -> Any:
    """Return the robot of `yourdfpy`."""
    yourdfpy = checks.needed("yourdfpy", "urdf", "urdf", str(file))
    with readable(file, "urdf"):
        content = file.read_bytes()
    wanted = "a URDF, as ROS has it"
    with checks.in_file(file):
        try:
            tree = ElementTree.fromstring(content)
        except ElementTree.ParseError as error:
            raise InputError("urdf", f"no XML: {error}", str(file), wanted) from None
        if tree.tag != "robot":
            raise InputError("urdf", f"its first element is <{tree.tag}>", str(file), wanted)
        if any("xacro" in str(each.tag) for each in tree.iter()):
            raise InputError("urdf", "has macros of xacro", str(file), "a URDF: xacro FILE > arm.urdf")
        _clean(tree)
        try:
            text = io.BytesIO(ElementTree.tostring(tree))
            return yourdfpy.URDF.load(text, build_scene_graph=False, load_meshes=False).robot
        except Exception as error:  # whatever the reader trips over
            reason = " ".join(str(error).split())[:100] or type(error).__name__
            raise InputError("urdf", f"cannot be read: {reason}", str(file), wanted) from None


def _clean(tree: ElementTree.Element) -> None:
    """Take out what is not needed, and call capsules so."""
    for element in [tree, *tree.iter("link")]:
        for child in [child for child in element if child.tag in SKIPPED]:
            element.remove(child)
    for collision in tree.iter("collision"):
        for capsule in collision.findall("geometry/capsule"):
            capsule.tag = "cylinder"
            collision.set("name", CAPSULE)


def _chain(model: Any, root: str | None, tip: str | None) -> list[Any]:
    """Return the joints from the root link to the tip link; the link names are checked."""
    names = [link.name for link in model.links]
    before = {joint.child: joint for joint in model.joints}
    for key, value in (("root", root), ("tip", tip)):
        if value is not None and checks.text(key, value) not in names:
            raise InputError(key, "no link is called so", value, suggested(value, names))
    parents = {joint.parent for joint in model.joints}
    first = root or _only("root", [name for name in names if name not in before])
    at = last = tip or _only("tip", [name for name in names if name not in parents])
    chain: list[Any] = []
    while at != first:
        if at not in before or len(chain) > len(model.joints):
            raise InputError("tip", f"no joints lead to it from {first!r}", last, "a link beyond the root")
        chain.append(before[at])
        at = before[at].parent
    if not chain:
        raise InputError("tip", "is the root itself", last, "a link that joints lead to from the root")
    return chain[::-1]


def _only(key: str, names: Sequence[str]) -> str:
    if len(names) != 1:
        raise InputError(key, f"missing, and there are {len(names)}", list(names), "the name of a link")
    return names[0]


def _groups(model: Any, chain: Sequence[Any], body: Any) -> list[_Group]:
    """Fold fixed joints: groups of links that move together, the first of them the base."""
    links = {link.name: link for link in model.links}
    hanging: dict[str, list[Any]] = {}
    for joint in model.joints:
        if joint not in chain:
            hanging.setdefault(joint.parent, []).append(joint)
    groups = [_Group(None, np.eye(4))]
    tip = chain[-1].child

    def add(name: str, place: Floats) -> None:
        """Add a link, and those that hang on it."""
        own = groups[-1]
        own.links.append(name)
        shapes, notes = body(links[name])
        own.notes += notes
        if shapes:
            own.with_body.append(name)
            own.shapes += [_moved(shape, place) for shape in shapes]
        for joint in hanging.get(name, ()) if name != tip else ():
            if joint.type == "fixed":
                add(joint.child, place @ _origin(joint))
            else:
                own.notes.append(f"link {joint.child!r} hangs on joint {joint.name!r}, which is left out with it")

    add(chain[0].parent, np.eye(4))
    for joint in chain:
        if joint.type != "fixed":
            groups.append(_Group(joint, groups[-1].last @ _origin(joint)))
        else:
            groups[-1].last = groups[-1].last @ _origin(joint)
        add(joint.child, groups[-1].last)
    return groups


def _origin(joint: Any) -> Floats:
    return np.eye(4) if joint.origin is None else np.asarray(joint.origin, np.float64)


def _moved(shape: Shape, pose: Floats) -> Shape:
    """Return a shape in another frame."""
    turn, shift = pose[:3, :3].T, pose[:3, 3]
    return shape._replace(
        capsules=tuple(LinkCapsule(start @ turn + shift, end @ turn + shift, r) for start, end, r in shape.capsules)
    )


def _body(link: Any, folder: Path, meshes: bool) -> tuple[list[Shape], list[str]]:
    """Shapes of a link in its frame, and what is to be noted."""
    shapes, left = [], 0
    with checks.inside(f"link {link.name}"):
        for collision in link.collisions:
            geometry = collision.geometry
            if geometry.mesh is not None and not meshes:
                left += 1
                continue
            shapes.append(_shape(geometry, _origin(collision), collision.name == CAPSULE, folder))
    notes = [f"{left} of its shapes left out: meshes"] if left else []
    if shapes:
        capsules = [capsule for shape in shapes for capsule in shape.capsules]
        own, volume = math.fsum(shape.volume for shape in shapes), link_capsules.volume_of(capsules)
        larger = f", {number(volume / own, 3)} times the volume of its shapes" if volume > ALIKE * own > 0.0 else ""
        notes.append(f"{counted(len(capsules), 'capsule')}{larger}")
    return shapes, [f"link {link.name!r}: {note}" for note in notes]


def _shape(geometry: Any, pose: Floats, is_capsule: bool, folder: Path) -> Shape:
    """Return a shape in the frame of its link."""
    if geometry.box is not None:
        return link_capsules.box_shape(pose, np.asarray(geometry.box.size, np.float64))
    if geometry.sphere is not None:
        return link_capsules.sphere_shape(pose, float(geometry.sphere.radius))
    if geometry.cylinder is not None:
        kind = link_capsules.capsule_shape if is_capsule else link_capsules.cylinder_shape
        return kind(pose, float(geometry.cylinder.radius), float(geometry.cylinder.length))
    return _mesh_shape(geometry.mesh, pose, folder)


def _mesh_shape(mesh: Any, pose: Floats, folder: Path) -> Shape:
    name = checks.text("mesh", mesh.filename)
    file = next((file for file in _places(name, folder) if file.is_file()), None)
    if file is None:
        raise InputError(
            "mesh", "there is no such file", name, "a file beside the URDF, or meshes=False to leave it out"
        )
    with checks.inside("mesh"):
        vertices, faces, _ = read_mesh(file)
    trimesh = checks.needed("trimesh", "urdf", "mesh", name)
    surface = trimesh.Trimesh(vertices * (1.0 if mesh.scale is None else mesh.scale), faces)  # equal vertices merged
    points = np.asarray(surface.vertices, np.float64) @ pose[:3, :3].T + pose[:3, 3]
    if not surface.is_watertight:
        return link_capsules.solid_shape(points)
    return link_capsules.solid_shape(points, abs(float(surface.volume)), points[surface.edges_unique])


def _places(name: str, folder: Path) -> Iterator[Path]:
    """Yield where a mesh may be: as it stands, and for `package://` its path in each folder above, as ROS lays it."""
    path = name.partition("://")[2] if "://" in name else name
    yield folder / path
    if name.startswith("package://"):
        inner = Path(*Path(path).parts[1:])
        for above in (folder, *folder.resolve().parents):
            yield above / inner
            yield above / path


def _disabled(file: Path) -> set[frozenset[str]]:
    """Pairs of links of which an SRDF says that they may touch."""
    with readable(file, "srdf"):
        content = file.read_bytes()
    try:
        tree = ElementTree.fromstring(content)
    except ElementTree.ParseError as error:
        raise InputError("srdf", f"no XML: {error}", str(file), "an SRDF, as MoveIt writes it") from None
    pairs = [(each.get("link1"), each.get("link2")) for each in tree.iter("disable_collisions")]
    return {frozenset((one, other)) for one, other in pairs if one and other}


def _touching(groups: Sequence[_Group], disabled: Set[frozenset[str]]) -> dict[int, list[int]]:
    """Of each group those before it that it may touch: where all of their links that have a body may."""
    return {
        b: [
            a
            for a in range(b - 1)
            if groups[a].with_body
            and own.with_body
            and all(frozenset((one, other)) in disabled for one in groups[a].with_body for other in own.with_body)
        ]
        for b, own in enumerate(groups)
    }


def _joints(groups: Sequence[_Group], allowed: Mapping[int, list[int]], scale: float) -> Iterator[Joint]:
    """Yield the joints, their names as in the file; lengths in the unit of the robot."""
    base, *moving = groups
    names = [group.joint.name for group in moving]
    names.insert(0, _free(base.links[0], names))
    if base.shapes:
        yield Fixed(name=names[0], body=_capsules(base, scale)).noted(*base.notes)
    for b, group in enumerate(moving, 1):
        with checks.inside(f"joint {group.joint.name}"):
            yield _moving(group, [names[a] for a in allowed[b]], scale)
    if np.abs(groups[-1].last - np.eye(4)).max() > SAME:
        yield Fixed(_scaled(groups[-1].last, scale), _free(groups[-1].links[-1], names))


def _free(link: str, names: Sequence[str]) -> str:
    """Name of a joint that is called as a link: in a URDF a link and a joint may have the same name."""
    return link if link not in names else _free(f"{link}_link", names)


def _moving(group: _Group, touches: Sequence[str], scale: float) -> Joint:
    joint = group.joint
    if joint.mimic is not None:
        raise InputError("mimic", f"it moves with {joint.mimic.joint!r}", joint.type, "a joint that moves by itself")
    if joint.type not in ("revolute", "continuous", "prismatic"):
        raise InputError("type", "", joint.type, "one of revolute, continuous, prismatic, fixed")
    notes, unit = list(group.notes), scale if joint.type == "prismatic" else 1.0
    if joint.type == "continuous":
        limits = -math.pi, math.pi
        notes.insert(0, "turns without end in the file, and from -pi to pi here")
    elif joint.limit is None or joint.limit.lower is None or joint.limit.upper is None:
        raise InputError("limit", "missing", None, "lower and upper: see `limit` in the URDF")
    else:
        limits = unit * joint.limit.lower, unit * joint.limit.upper
    rate = None if joint.limit is None else joint.limit.velocity
    if rate is not None and rate <= 0.0:
        notes.append(f"its velocity of {number(rate)} is taken for none")
        rate = None
    kind = Prismatic if joint.type == "prismatic" else Revolute
    return kind(
        joint.axis,
        limits,
        origin=_scaled(group.origin, scale),
        name=joint.name,
        body=_capsules(group, scale),
        touches=touches,
        rate=None if rate is None else rate * unit,
    ).noted(*notes)


def _capsules(group: _Group, scale: float) -> list[LinkCapsule]:
    capsules = [capsule for shape in group.shapes for capsule in shape.capsules]
    return [LinkCapsule(scale * start, scale * end, scale * radius) for start, end, radius in capsules]


def _scaled(pose: Floats, scale: float) -> Floats:
    result = pose.copy()
    result[:3, 3] *= scale
    return result
