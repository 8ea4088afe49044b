"""Joints before the first segment, and how kernels see them: as rows of a configuration beside those of segments.

A revolute joint is a segment without length that bends in one plane, a prismatic joint a straight one that changes its
length, and a capsule of a link a straight one that does not. Each row ends where the next begins: at a fixed pose, its
tail. So steps, limits, proofs and plans of segments hold for joints, too.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Limits, Number, Rows, Vector
from sinuous.base.checks import Floats, closed, in_order, optional_name
from sinuous.base.documents import plain, pose_arguments
from sinuous.base.errors import InputError, counted, span, suggested
from sinuous.base.frozen import Noun
from sinuous.kernels import packing, tables
from sinuous.model.actuators import Actuators
from sinuous.model.poses import as_pose, pose, rotation_of
from sinuous.model.segment import Segment

MOST_LINKS = 48
"""Most links: which may touch is one number, with a bit for each."""

Body = Iterable["LinkCapsule | Mapping[str, Any] | Sequence[Any]"]


class LinkCapsule(NamedTuple):
    """A capsule of a link, in the frame of the link.

    Attributes
    ----------
    start, end : ndarray (3,)
    radius : float
    """

    start: Floats
    end: Floats
    radius: float

    def to_dict(self) -> dict[str, Any]:
        """Return it as a problem file says it."""
        return {"from": plain(self.start), "to": plain(self.end), "radius": plain(self.radius)}


class Joint(Noun):
    """What all joints have.

    Parameters
    ----------
    axis : array_like (3,)
        In the frame of the joint, of any length but 0.
    limits : (float, float), optional
        Least and largest value: rad, or the length unit.
    origin : array_like (4, 4) or (3,), optional
        Pose, or place, of the joint in the frame of the link before; for the first in that of the robot's base.
    name : str, optional
        By default `j1`, `j2`, ...
    body : list of {from, to, radius}, optional
        Capsules of the link after the joint, in the frame of that link.
    touches : list of str, optional
        Other joints whose links this one may touch. Neighbours always may, and links between which none has a body.
    rate, acceleration : float, optional
        Largest ones, per second and per second squared. Control steps keep them, and whatever is given `Rates`.

    Raises
    ------
    InputError
        When an argument is not what it should be.
    """

    own_limits: ClassVar[tuple[float, float]] = (0.0, 0.0)
    """Limits where none are given."""

    axis: Floats
    limits: tuple[float, float]
    origin: Floats
    name: str | None
    body: tuple[LinkCapsule, ...]
    touches: tuple[str, ...]
    rate: float
    acceleration: float
    _notes: tuple[str, ...] = ()

    def __init__(
        self,
        axis: Vector = (0.0, 0.0, 1.0),
        limits: Limits | None = None,
        origin: Rows | Vector | None = None,
        name: str | None = None,
        body: Body = (),
        touches: Iterable[str] = (),
        rate: Number | None = None,
        acceleration: Number | None = None,
    ) -> None:
        self._set(
            axis=checks.direction("axis", axis),
            limits=checks.interval("limits", self.own_limits if limits is None else limits),
            origin=_place("origin", origin),
            name=optional_name(name),
            body=_capsules(body),
            touches=tuple(checks.text(f"touches[{i}]", each) for i, each in enumerate(touches)),
            rate=math.inf if rate is None else checks.number("rate", rate, above=0.0),
            acceleration=math.inf if acceleration is None else checks.number("acceleration", acceleration, above=0.0),
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the joint as a problem file says it."""
        return {self.kind: {"axis": plain(self.axis), "limits": plain(self.limits)} | _said(self)}

    @property
    def kind(self) -> str:
        """`revolute`, `prismatic` or `fixed`: its key in a file."""
        return type(self).__name__.lower()

    @property
    def notes(self) -> tuple[str, ...]:
        """What reading it from a file had to decide."""
        return self._notes

    def noted(self, *notes: str) -> Self:
        """Return the same joint with such notes."""
        other = object.__new__(type(self))
        other._set(**{**vars(self), "_notes": notes})
        return other

    def __str__(self) -> str:
        """Kind, limits and what it carries, in words."""
        parts = [self.kind] if isinstance(self, Fixed) else [self.kind, span(self.limits)]
        return ", ".join([*parts, *([counted(len(self.body), "capsule")] if self.body else [])])


class Revolute(Joint):
    """A joint that turns about its axis. Values are in rad, by default from -pi to pi."""

    own_limits: ClassVar[tuple[float, float]] = (-math.pi, math.pi)


class Prismatic(Joint):
    """A joint that moves along its axis. Values are in the length unit."""


class Fixed(Joint):
    """A link that does not move against the one before: it has a place and a body, and no value."""

    def __init__(self, origin: Rows | Vector | None = None, name: str | None = None, body: Body = ()) -> None:
        super().__init__(origin=origin, name=name, body=body)

    def to_dict(self) -> dict[str, Any]:
        """Return it as a problem file says it."""
        return {self.kind: _said(self)}


class RigidRow(Segment):
    """What stands before the segments, as a row of a configuration: a joint, a capsule of a link, or a place.

    Attributes
    ----------
    tail : ndarray (4, 4)
        Pose in which the next row begins, in the frame of the end of this one.
    link : int
        Number of the link that it belongs to; 0 is the base.
    touches : int
        Sum of `2 ** link` of those that its link may touch.
    has_body : bool
    joint : int
        Number of the joint, from 0; -1 for what is none.
    low : float
        Value of a prismatic joint where its length is 0.
    owner : str
        Name of the joint, or of the one to whose link it belongs.
    """

    rigid: ClassVar[bool] = True

    tail: Floats
    link: int
    touches: int
    has_body: bool
    joint: int
    low: float
    owner: str


class RigidRows(NamedTuple):
    """Joints and links as rows.

    Attributes
    ----------
    rows : tuple of RigidRow
    values : ndarray of int (j,)
        Rows of the joints that move.
    columns : ndarray of int (j,)
        Which number of its row is the value of a joint: 0 or 2.
    shifts : ndarray (j,)
        What is added to that number: lengths begin at 0, values of prismatic joints at their least.
    moving : tuple of Joint
        Those that move.
    """

    rows: tuple[RigidRow, ...]
    values: Any
    columns: Any
    shifts: Floats
    moving: tuple[Joint, ...]

    def flat(self, rows: int) -> Any:
        """Return which numbers of a flat configuration (3 rows) are values of joints, then of the segments."""
        return np.concatenate([3 * self.values + self.columns, np.arange(3 * len(self.rows), 3 * rows)])

    @property
    def links(self) -> int:
        """How many links move, beside the base."""
        return len(self.values)

    def with_joints(self, q: Floats, joints: Floats) -> Floats:
        """Configurations (..., rows, 3) of q (..., n, 3) of the segments and values (..., j) of the joints."""
        lead = np.broadcast_shapes(q.shape[:-2], joints.shape[:-1])
        result = np.zeros((*lead, len(self.rows) + q.shape[-2], 3))
        result[..., : len(self.rows), 2] = [row.length[0] for row in self.rows]
        result[..., self.values, self.columns] = joints + self.shifts
        result[..., len(self.rows) :, :] = q
        return result

    def split(self, configuration: Floats) -> tuple[Floats, Floats]:
        """Values (..., j) of the joints, and q (..., n, 3) of the segments, of configurations (..., rows, 3)."""
        return (
            configuration[..., self.values, self.columns] - self.shifts,
            np.array(configuration[..., len(self.rows) :, :]),
        )


def joint_list(joints: Any) -> tuple[Joint, ...]:
    """Check joints."""
    checks.instance("joints", joints, Iterable, "a list of sn.Revolute and sn.Prismatic")
    listed = tuple(joints)
    for i, joint in enumerate(listed):
        checks.instance(f"joints[{i}]", joint, Revolute | Prismatic | Fixed, "sn.Revolute or sn.Prismatic")
    if len(listed) > MOST_LINKS:
        raise InputError("joints", f"{len(listed)} of them", None, f"at most {MOST_LINKS}")
    return listed


def mean_reach(joints: Sequence[Joint]) -> float:
    """Return how far joints reach from each to the next, prismatic ones in the middle of their range, all together."""
    slides = sum(0.5 * abs(sum(joint.limits)) for joint in joints if isinstance(joint, Prismatic))
    return slides + sum(float(np.linalg.norm(joint.origin[:3, 3])) for joint in joints)


def joint_names(joints: Sequence[Joint]) -> tuple[str, ...]:
    """Names of all joints; by default `j1`, `j2`, ... from the base on."""
    return tuple(joint.name or f"j{i}" for i, joint in enumerate(joints, 1))


def rigid_rows(joints: Sequence[Joint]) -> RigidRows:
    """Return the rows of joints and their links."""
    names, may_touch = joint_names(joints), _may_touch(joints)
    drafts: list[dict[str, Any]] = []
    values: list[int] = []
    columns: list[int] = []
    shifts: list[float] = []
    ahead: Floats = np.eye(4)
    link = 0

    def end(there: Floats) -> None:
        """Say where the last row ends, seen from where what moves it leaves it."""
        if drafts:
            drafts[-1]["tail"] = there
        elif not np.array_equal(there, np.eye(4)):
            drafts.append({"name": "origin", "link": 0, "tail": there})

    def add(begin: Floats, **own: Any) -> int:
        """Lay on a row that begins there, seen from the end of the one before; return its number."""
        end(begin)
        drafts.append({"link": link, "owner": name, **own})
        return len(drafts) - 1

    for joint, name in zip(joints, names, strict=True):
        ahead = ahead @ joint.origin
        if isinstance(joint, Revolute):
            link += 1
            turn = _frame(joint.axis, 1)
            values.append(add(ahead @ turn, name=name, joint=len(columns), max_bend=joint.limits, plane=0.0))
            ahead = turn.T
            columns.append(0)
            shifts.append(0.0)
        elif isinstance(joint, Prismatic):
            link += 1
            turn = _frame(joint.axis, 2)
            low, high = joint.limits
            begin = ahead @ turn @ pose((0.0, 0.0, low))
            values.append(add(begin, name=name, joint=len(columns), length=(0.0, high - low), low=low))
            ahead = turn.T
            columns.append(2)
            shifts.append(-low)
        for c, capsule in enumerate(joint.body, 1):
            along = capsule.end - capsule.start
            length = float(np.linalg.norm(along))
            begin = pose(capsule.start) @ (_frame(along / length, 2) if length > 0.0 else np.eye(4))
            one = {"name": f"{name}.body{c}", "length": length, "radius": capsule.radius, "has_body": True}
            add(ahead @ begin, **one)
            ahead = np.asarray(np.linalg.inv(begin @ pose((0.0, 0.0, length))), np.float64)
    end(ahead)
    rows = tuple(_row(may_touch, **draft) for draft in drafts)
    moving = tuple(joint for joint in joints if not isinstance(joint, Fixed))
    return RigidRows(rows, np.array(values, np.intp), np.array(columns, np.intp), np.array(shifts), moving)


def on_rows(rigid: RigidRows, coupling: Actuators, rows: int) -> Actuators:
    """Return actuators (m, j + 3 n) of joints and segments as those of configurations (m, 3 rows).

    Raises
    ------
    InputError
        When they have another number of columns.
    """
    if not rigid.rows:
        return coupling
    where, given = rigid.flat(rows), coupling.matrix
    if given.shape[1] != len(where):
        raise InputError("actuators", f"{given.shape[1]} columns", None, f"{len(where)}: one a joint, three a segment")
    matrix = np.zeros((len(given), 3 * rows))
    matrix[:, where] = given
    begins = given[:, : rigid.links] @ rigid.shifts  # what it is displaced where rows of prismatic joints are 0
    return coupling.changed(matrix=matrix, offset=coupling.motors.offset - coupling.motors.gain * begins)


def each_row(rigid: RigidRows, value: float | tuple[float, ...]) -> float | tuple[float, ...]:
    """One number for all rows, or one each, of one for each segment: links have the least of these."""
    return (*[min(value)] * len(rigid.rows), *value) if isinstance(value, tuple) else value


def joints_with(joints: Sequence[Joint], rigid: RigidRows, limits: Mapping[int, Any]) -> list[Joint]:
    """Return joints of which some have other limits: by the numbers of their rows, 1 = first."""
    row_of, result = iter(rigid.values.tolist()), []
    for joint in joints:
        own = None if isinstance(joint, Fixed) else limits.get(next(row_of) + 1)
        result.append(joint if own is None else joint.changed(limits=own))
    return result


def moved_joints(joints: Sequence[Joint], offsets: Floats) -> list[Joint]:
    """Return joints that stand where they would with so much (j,) more of each value."""
    more, result = iter(offsets.tolist()), list[Joint]()
    for joint in joints:
        if isinstance(joint, Fixed):
            result.append(joint)
            continue
        motion, offset = np.eye(4), next(more)
        if isinstance(joint, Prismatic):
            motion[:3, 3] = offset * joint.axis
        else:
            motion[:3, :3] = rotation_of(offset * joint.axis)
        result.append(joint.changed(origin=joint.origin @ motion))
    return result


def joined(rigid: RigidRows, count: int, key: str, q: Any, joints: Any = None) -> Floats:
    """Check configurations of all rows, or of `count` segments with joints; return those of all rows (..., rows, 3).

    Parameters
    ----------
    rigid : RigidRows
    count : int
        n, the number of segments.
    key : str
        What `q` is called where it is refused.
    q : array_like (..., r, 3), (..., n, 3), a pair, or a list of pairs
        Of all r rows, or of the n segments. The pair has values (..., j) of the joints, then q (..., n, 3).
        `None` is q where there are no segments.
    joints : array_like (..., j), or mapping from names to array_like (...), optional
        Where `q` is that of the segments alone.
    """
    if isinstance(q, list) and q and all(map(is_pair, q)):
        return np.stack([joined(rigid, count, f"{key}[{i}]", each) for i, each in enumerate(q)])
    if joints is None and is_pair(q):
        with checks.inside(key):
            return joined(rigid, count, "q", q[1], q[0])
    moving, rows = len(rigid.values), len(rigid.rows) + count
    if joints is None:
        if moving == 0 and np.shape(q)[-2:] == (count, 3):
            return rigid.with_joints(checks.stack(key, q, (count, 3)), np.zeros(0))
        wanted = f"finite numbers of shape (..., {rows}, 3), or (..., {count}, 3) with joints (..., {moving})"
        return checks.stack(key, q, (rows, 3), wanted)
    named = isinstance(joints, Mapping)
    ordered = in_order("joints", joints, [rigid.rows[k].name for k in rigid.values], "joint") if named else joints
    values = checks.stack("joints", ordered, (moving,))
    arcs = checks.stack(key, np.zeros((0, 3)) if q is None and count == 0 else q, (count, 3))
    checks.broadcast("joints", joints, arcs[..., 0, 0] if count else arcs.sum((-2, -1)), values.sum(-1))
    return rigid.with_joints(arcs, values)


def is_pair(value: Any) -> bool:
    """Whether a value is a pair of joints (..., j) and q (..., n, 3), rather than an array."""
    if not isinstance(value, tuple) or len(value) != 2:
        return False
    try:
        return value[1] is None or isinstance(value[0], Mapping) or np.ndim(value[1]) == np.ndim(value[0]) + 1
    except ValueError:
        return False


def _row(
    may_touch: Sequence[int],
    *,
    name: str,
    link: int,
    tail: Floats,
    owner: str = "base",
    low: float = 0.0,
    joint: int = -1,
    has_body: bool = False,
    length: Limits = 0.0,
    max_bend: Limits = 0.0,
    radius: float = 0.0,
    plane: float | None = None,
) -> RigidRow:
    row = RigidRow(length, max_bend, radius=radius, plane=plane, name=name)
    kept = closed(np.ascontiguousarray(tail))
    row._set(tail=kept, link=link, touches=may_touch[link], has_body=has_body, joint=joint, low=low, owner=owner)
    return row


def _may_touch(joints: Sequence[Joint]) -> list[int]:
    """Return for each link the sum of `2 ** link` of those that it may touch."""
    names, links, link, with_body = joint_names(joints), {}, 0, set()
    for joint, name in zip(joints, names, strict=True):
        link += not isinstance(joint, Fixed)
        links[name] = link
        with_body |= {link} if joint.body else set()
    pairs = {(i, i) for i in range(link + 1)} | {(i, i + 1) for i in range(link + 1)}
    pairs |= {*pairwise(sorted(with_body | {link + 1}))}  # the last is the first segment
    for k, (joint, name) in enumerate(zip(joints, names, strict=True)):
        for i, other in enumerate(joint.touches):
            if other not in links and other != "base":
                raise InputError(f"joints[{k}].touches[{i}]", "no joint is called so", other, suggested(other, links))
            pairs.add((links[name], links.get(other, 0)))
    return [sum({2**b for a, b in pairs | {(b, a) for a, b in pairs} if a == own}) for own in range(link + 1)]


def _frame(axis: Floats, column: int) -> Floats:
    """Pose (4, 4) at the origin of which one axis (1 = y, 2 = z) is the unit vector `axis`."""
    if axis[column] == 1.0:
        return np.eye(4)
    result = pose((0.0, 0.0, 0.0), direction=axis)  # its z axis
    if column == 2:
        return np.array(result)
    return np.array(result[:, [1, 2, 0, 3]])  # z comes to be y; the columns turn in a circle, so it stays right-handed


def _place(key: str, value: Any) -> Floats:
    """Check a pose (4, 4), or a place (3,)."""
    if value is not None and np.shape(value) == (3,):
        with checks.inside(key):
            return pose(value)
    return as_pose(key, value)


def _capsules(body: Body) -> tuple[LinkCapsule, ...]:
    """Check the capsules of a link."""
    checks.instance("body", body, Iterable, "a list of {from, to, radius}")
    found = []
    for i, value in enumerate(body):
        key = f"body[{i}]"
        if isinstance(value, Mapping):
            for name in value:
                if name not in ("from", "to", "radius"):
                    raise InputError(
                        f"{key}.{name}", "unknown key", None, suggested(str(name), ("from", "to", "radius"))
                    )
            parts: list[Any] = [value.get(name) for name in ("from", "to", "radius")]
        else:
            parts = list(value) if np.iterable(value) and not isinstance(value, str) else []
        if len(parts) != 3 or any(part is None for part in parts):
            raise InputError(key, "", value, "{from: [x, y, z], to: [x, y, z], radius: r}")
        start, end = (checks.array(f"{key}.{n}", p, (3,)) for n, p in zip(("from", "to"), parts[:2], strict=True))
        found.append(LinkCapsule(start, end, checks.number(f"{key}.radius", parts[2], above=0.0)))
    return tuple(found)


def _said(joint: Joint) -> dict[str, Any]:
    """What a file says of a joint beside its axis and limits."""
    said = {
        "origin": pose_arguments(joint.origin),
        "name": joint.name,
        "body": [capsule.to_dict() for capsule in joint.body],
        "touches": list(joint.touches),
        "rate": plain(joint.rate),
        "acceleration": plain(joint.acceleration),
    }
    return {key: value for key, value in said.items() if value}


NO_BODY = -1e100
"""Radius of a row that has no body: whatever is asked of a place of it holds."""


def with_links(table: list[list[float]], rigid: RigidRows) -> list[list[float]]:
    """Complete the rows of a robot: of joints and links their tails, and of all to which link they belong."""
    count = len(rigid.rows)
    here: Floats = np.eye(4)  # where a row begins, from where the last joint ends
    for row, own in zip(table, rigid.rows, strict=False):
        packing.make_rigid(row, own.tail, own.link, own.touches, own.joint >= 0)
        if not own.has_body:
            row[tables.RADIUS], row[tables.SELF_RADIUS] = NO_BODY, -1.0
        row[tables.ONWARD] = float(np.linalg.norm(here[:3, 3]))
        end = np.eye(4) if own.joint >= 0 else here @ pose((0.0, 0.0, own.length[0]))
        if own.joint < 0:
            row[tables.ONWARD] = max(row[tables.ONWARD], float(np.linalg.norm(end[:3, 3])))
        here = end @ own.tail
    for row in table[count : count + 1]:
        row[tables.ONWARD] = float(np.linalg.norm(here[:3, 3]))
    for k, row in enumerate(table[count:]):
        row[tables.BODY] = float(rigid.links + 1 + (k > 0)) if count else 0.0
    return table


OVERLAP_SAMPLES = 100
"""Random configurations in which it is looked whether links overlap."""

NEARLY_ALWAYS = 0.95
"""Share of them from which on an overlap is told."""


def overlap_notes(rigid: RigidRows, joint_names: Sequence[str], begins: Callable[[Floats], Floats]) -> Iterator[str]:
    """Yield a line for each pair of links that may not touch, and overlap nearly everywhere within the limits.

    `begins` tells of values (m, j) of the joints the poses (m, r, 4, 4) in which rows of joints and links begin.
    """
    rows = [(k, row) for k, row in enumerate(rigid.rows) if row.has_body]
    pairs: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for i, (_, one) in enumerate(rows):
        for j, (_, other) in enumerate(rows[:i]):
            if not one.touches >> other.link & 1:
                pairs.setdefault((other.link, one.link), []).append((j, i))
    if not pairs:
        return
    low, high = np.array([joint.limits for joint in rigid.moving]).T
    poses = begins(np.random.default_rng(0).uniform(low, high, (OVERLAP_SAMPLES, len(low))))
    capsules = []
    for k, row in rows:
        start = poses[:, k, :3, 3]
        capsules.append((start, start + row.length[1] * poses[:, k, :3, 2], row.radius))
    names = ("base", *joint_names)
    for (a, b), own in pairs.items():
        overlap = np.zeros(OVERLAP_SAMPLES, np.bool_)
        for i, j in own:
            (p, q, r), (u, v, s) = capsules[i], capsules[j]
            overlap |= segment_distances(p, q, u, v) < r + s
        if overlap.mean() >= NEARLY_ALWAYS:
            seen = f"overlap in {int(overlap.sum())} of {OVERLAP_SAMPLES} random configurations"
            yield f"links of {names[a]} and {names[b]} {seen}: `touches` of {names[b]}, or an SRDF, allows it"


def segment_distances(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    """Distances (m,) between segments from a to b and from c to d, each (m, 3).

    They are nearest in their insides, or at one of the four ends (Ericson 2005).
    """
    along, other, apart = b - a, d - c, a - c
    aa, ab, bb = (np.einsum("mi,mi->m", *pair) for pair in ((along, along), (along, other), (other, other)))
    x, y = np.einsum("mi,mi->m", along, apart), np.einsum("mi,mi->m", other, apart)
    tiny = np.finfo(np.float64).tiny
    area = aa * bb - ab * ab
    s = np.clip((ab * y - bb * x) / np.maximum(area, tiny), 0.0, 1.0)
    t = np.clip((s * ab + y) / np.maximum(bb, tiny), 0.0, 1.0)
    found = [np.linalg.norm(apart + s[:, None] * along - t[:, None] * other, axis=1)]
    for p, q, u in ((a, b, c), (a, b, d), (c, d, a), (c, d, b)):  # how far u is from what is between p and q
        line = q - p
        share = np.einsum("mi,mi->m", u - p, line) / np.maximum(np.einsum("mi,mi->m", line, line), tiny)
        found.append(np.linalg.norm(p + np.clip(share, 0.0, 1.0)[:, None] * line - u, axis=1))
    result: Floats = np.min(found, axis=0)
    return result
