"""The robot: segments that bend and stretch, one after the other on a base."""

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, TypedDict, Unpack, get_args

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.arguments import (
    ActuatorValues,
    Batch,
    JointsAndBatch,
    JointValues,
    Limits,
    Number,
    OneEach,
    Pair,
    Rows,
    SelfCollision,
    Stack,
    Vector,
    Which,
    Whole,
)
from sinuous.base.checks import (
    MOST_SEGMENTS,
    Floats,
    each_segment,
    few,
    in_order,
    optional_name,
    refuse_repeated,
    segment_number,
)
from sinuous.base.documents import counted, described, write_document
from sinuous.base.entrance import Renamed, import_late
from sinuous.base.errors import InputError, answers_attributes, listed, number
from sinuous.base.frozen import Frozen, NotebookMixin, call, text
from sinuous.kernels import packing, tables
from sinuous.model.actuation import Actuation, Actuator, coupled_rows
from sinuous.model.actuators import Actuators, Chambers, Tendons
from sinuous.model.inverse import Inverse, answer_contradictions, fitting
from sinuous.model.joints import (
    Joint,
    RigidRow,
    RigidRows,
    each_row,
    is_pair,
    joined,
    joint_list,
    joint_names,
    mean_reach,
    on_rows,
    overlap_notes,
    rigid_rows,
    with_links,
)
from sinuous.model.limits import LimitSet, Violation
from sinuous.model.loads import Load, Loads, Payload, load_list, payload_list
from sinuous.model.poses import as_pose
from sinuous.model.segment import Locked, Segment, Stiffness, curvature_limits, held_back, segment_names, straight


class Uncertainty(Frozen):
    """A bound of the error of a model, as a calibration found it. Proofs thicken the body by it.

    Parameters
    ----------
    bound : float or array_like (n,)
        Distance by which places of the body may be off: of all segments, or one each.
    level : float, optional
        Share of the measurements for which it held.

    Raises
    ------
    InputError
        When the bound is negative, or the level is not between 0 and 1.
    """

    bound: float | tuple[float, ...]
    level: float

    def __init__(self, bound: OneEach, level: Number = 0.95) -> None:
        self._set(bound=checks.one_each("bound", bound, None))
        self._set(level=checks.number("level", level, above=0.0, high=1.0))

    @property
    def confidence(self) -> str:
        """At which level the bound holds: `at 95 %`."""
        return f"at {100.0 * self.level:.3g} %"

    def __str__(self) -> str:
        bounds = self.bound if isinstance(self.bound, tuple) else (self.bound,)
        return f"{listed(map(number, bounds))}, in the unit of the lengths, {self.confidence}"


if TYPE_CHECKING:
    import sinuous as sn


class WholeArguments(TypedDict, total=False):
    """Arguments of `Robot` that are not those of its segments."""

    mount: Number
    base: Rows | None
    tool: Rows | None
    self_collision: SelfCollision
    actuators: Actuators | None
    name: str | None
    clearance: OneEach
    self_clearance: OneEach
    uncertainty: Uncertainty | None
    stiffness: Stiffness | Number | None
    mass: Number | None
    arcs: Whole | None
    gravity: Vector | None
    payload: Payload | Iterable[Payload] | None


class RobotArguments(WholeArguments, total=False):
    """Arguments of `Robot`."""

    segments: Iterable[Segment]
    joints: Iterable[Joint]
    radius: Number | None


@answers_attributes(
    fk="robot.tip(q), and robot.forward(q) for the ends of all segments",
    forward_kinematics="robot.tip(q), and robot.forward(q) for the ends of all segments",
    ik="sn.solve(robot, target, scene)",
    inverse_kinematics="sn.solve(robot, target, scene)",
    solve="sn.solve(robot, target, scene)",
    plot="sn.plot(robot)",
    show="sn.show(robot)",
)
class Robot(NotebookMixin, Frozen):
    """A continuum robot: segments from base to tip, where it stands, and what it carries.

    A configuration `q` is an array (..., n, 3) with `bend_x`, `bend_y` (rad) and `length` of every segment.

    Parameters
    ----------
    segments : iterable of Segment
        Base to tip; at least one without joints, and not all of length 0.
    joints : iterable of Revolute, Prismatic, optional
        From the base to where the first segment begins: see `sinuous.read_joints`.
    radius : float, optional
        Radius of the body for all segments, instead of each one's own.
    mount : float
        Length of backbone from the base that obstacles do not concern.
    base : array_like (4, 4), optional
        Pose of the base in the world; its z axis is the tangent that the backbone leaves with.
    tool : array_like (4, 4), optional
        Pose of the tool in the frame of the tip. Targets of the tip mean the tool; the tool has no body.
    self_collision : str
        `avoid`: two places of the backbone are farther apart than the sum of their radii, unless they are neighbours
        along it, and no segment bends more tightly than with the curvature 1 / radius. Neighbours are, where the radius
        is the same between them, places nearer along the body than pi radii, and where it changes, places each of which
        lies ahead of the other. `allow`: the body may run through itself.
    actuators : Actuators, optional
        Actuators beside the tendons and chambers of the segments.
    name : str, optional
    clearance : float or array_like (n,)
        Least distance of the body from obstacles that every solution keeps: of all segments, or one each. Links of
        joints keep the least of these.
    self_clearance : float or array_like (n,)
        The same of the body from itself: two places keep the mean of what is demanded of their segments. It counts as
        half as much thickness on either side: in `self_collision` for the radius stands the radius and half of it.
    uncertainty : Uncertainty, optional
        By how much the body may be elsewhere, as a calibration found: where nothing may be touched, the body is thicker
        by it. Clearances that are reported are what is left then. It says nothing of the body against itself.
    stiffness, mass, arcs : optional
        For all segments, instead of each one's own.
    gravity : array_like (3,), optional
        In world axes. Masses times it are in the unit of force of `stiffness`: with N, kg and m (0, 0, -9.81).
    payload : Payload or list of Payload, optional
        What it carries.

    Attributes
    ----------
    segments : tuple of Segment
    segment_names : tuple of str
        By default `s1`, `s2`, ... from base to tip.
    rows : tuple of Segment
        What configurations have a row for: joints and capsules of their links, if there are any, then the segments.
    radii : tuple of float
        Radius of the body, per row.
    needed_radii, self_radii : tuple of float
        Within which the backbone of a segment needs to be free of obstacles, and of other places of the body with
        theirs: the radius, what is demanded of clearance and, of obstacles, the `uncertainty`.
    curvatures : tuple of float
        Largest curvature, per row: its own limit, or 1 / radius (of `self_radii`).
    linear : Actuators or None
        What was given as `actuators`.
    limits, actuation : ndarray (n, 35), (p, 7)
        Rows of segments (limits, scales, radii, links) and limits of actuators, as `sinuous.kernels.tables` lays them
        out, read-only.

    Raises
    ------
    InputError
        When there is no segment, nothing has a length, a pose is none, `self_collision` is another word, two segments
        or two actuators have the same name, `actuators` do not fit the robot, a clearance from itself is demanded of a
        body that may run through itself, or gravity pulls at nothing.
    """

    segments: tuple[Segment, ...]
    joints: tuple[Joint, ...]
    rows: tuple[Segment, ...]
    row_names: tuple[str, ...]
    segment_names: tuple[str, ...]
    radii: tuple[float, ...]
    needed_radii: tuple[float, ...]
    self_radii: tuple[float, ...]
    curvatures: tuple[float, ...]
    mount: float
    base: Floats
    tool: Floats
    self_collision: SelfCollision
    linear: Actuators | None
    name: str | None
    clearance: float | tuple[float, ...]
    self_clearance: float | tuple[float, ...]
    uncertainty: Uncertainty | None
    gravity: Floats | None
    payload: tuple[Payload, ...]
    limits: Floats
    actuation: Floats
    drive: Actuation
    _rigid: RigidRows

    _arguments: ClassVar[Mapping[str, str]] = {"actuators": "linear"}

    def __init__(
        self,
        segments: Iterable[Segment] = (),
        *,
        joints: Iterable[Joint] = (),
        radius: Number | None = None,
        mount: Number = 0.0,
        base: Rows | None = None,
        tool: Rows | None = None,
        self_collision: SelfCollision = "avoid",
        actuators: Actuators | None = None,
        name: str | None = None,
        clearance: OneEach = 0.0,
        self_clearance: OneEach = 0.0,
        uncertainty: Uncertainty | None = None,
        stiffness: Stiffness | Number | None = None,
        mass: Number | None = None,
        arcs: Whole | None = None,
        gravity: Vector | None = None,
        payload: Payload | Iterable[Payload] | None = None,
    ) -> None:
        checks.instance("segments", segments, Iterable, "a list of Segment")
        listed, given_joints = tuple(segments), joint_list(joints)
        rigid = rigid_rows(given_joints)
        if not (0 if rigid.links else 1) <= len(listed) <= MOST_SEGMENTS:
            raise InputError("segments", "", len(listed), f"1 to {MOST_SEGMENTS:,} segments")
        for k, segment in enumerate(listed):
            checks.instance(f"segments[{k}]", segment, Segment, "a Segment")
        if all(segment.length[1] == 0.0 for segment in listed) and not rigid.links:
            raise InputError("segments", "", listed, "at least one segment that can be longer than 0")
        shared = {"radius": radius, "stiffness": stiffness, "mass": mass, "arcs": arcs}
        given: Any = {key: value for key, value in shared.items() if value is not None}
        if given:
            listed = tuple(segment.changed(**given) for segment in listed)
        chain = (*rigid.rows, *listed)
        row_names = segment_names(chain)
        names = row_names[len(rigid.rows) :]
        if given_joints:
            kinds = ("joints", joint_names(given_joints)), ("segments", names)
            refuse_repeated((f"{kind}[{k}].name", each) for kind, all_of in kinds for k, each in enumerate(all_of))
        carried = () if payload is None else payload_list(payload, names)
        checks.choice("self_collision", self_collision, get_args(SelfCollision))
        checks.instance("actuators", actuators, Actuators | None, "Actuators or nothing")
        radii = tuple(segment.radius for segment in chain)
        away = each_segment("clearance", clearance, names)
        apart = each_segment("self_clearance", self_clearance, names)
        if self_collision == "allow" and np.any(apart):
            raise InputError("self_clearance", "cannot be combined with self_collision: allow", self_clearance, "0")
        checks.instance("uncertainty", uncertainty, Uncertainty | None, "Uncertainty or nothing")
        with checks.inside("uncertainty"):
            unsure = 0.0 if uncertainty is None else each_segment("bound", uncertainty.bound, names)
        of_rows = (each_row(rigid, each) for each in (away, unsure, apart))
        needed, own = _widths(radii, *of_rows)
        curvatures = curvature_limits(chain, own, self_collision == "avoid")
        coupling = None if actuators is None else on_rows(rigid, actuators, len(chain))
        drive = Actuation(chain, coupling, curvatures)
        held = drive.coordinates
        coupled = () if coupling is None else coupled_rows(coupling, drive.linear_scales, held)
        actuation = packing.actuator_table([*drive.limit_rows(), *coupled])
        self._set(
            segments=listed,
            joints=given_joints,
            rows=chain,
            _rigid=rigid,
            row_names=row_names,
            segment_names=names,
            self_collision=self_collision,
            curvatures=curvatures,
            mount=checks.number("mount", mount, low=0.0),
            base=as_pose("base", base),
            tool=as_pose("tool", tool),
            linear=actuators,
            name=optional_name(name),
            clearance=away,
            self_clearance=apart,
            uncertainty=uncertainty,
            gravity=None if gravity is None else _gravity(gravity, listed, carried),
            payload=carried,
            radii=radii,
            needed_radii=needed,
            self_radii=own,
            actuation=actuation,
            drive=drive,
        )
        homes = [packing.ANY_LENGTH] * len(held.bends)
        if not held.free:
            homes = self.limit_set.homes()
        rows = zip(held.lengths.tolist(), held.bends, curvatures, needed, own, homes, strict=True)
        self._set(limits=packing.segment_table(with_links([packing.segment_row(*row) for row in rows], rigid)))

    @classmethod
    def uniform(
        cls,
        count: Whole,
        length: Limits,
        max_bend: Number = math.pi,
        max_curvature: Number | None = None,
        radius: Number = 0.0,
        *,
        tendons: Tendons | None = None,
        chambers: Chambers | None = None,
        **whole: Unpack[WholeArguments],
    ) -> "Robot":
        """Make a robot of `count` equal segments.

        The rest as for `Segment`; and mount, base, tool, self_collision as for `Robot`.
        """
        number = checks.integer("count", count, 1, MOST_SEGMENTS)
        segment = Segment(length, max_bend, max_curvature, radius, tendons, chambers)
        return cls([segment] * number, **whole)

    def locked(self, coordinates: Mapping[Which, Locked | None]) -> "Robot":
        """Return the robot with coordinates that hold a value, as those of a section that is stuck.

        Parameters
        ----------
        coordinates : mapping from segments (their names, or numbers, 1 = first) to (bend_x, bend_y, length)
            None for a coordinate that is free, and None instead of all three frees a segment.

        Raises
        ------
        InputError
            When a segment is unknown, or cannot have these values: see `Segment`.
        """
        checks.instance("coordinates", coordinates, Mapping, "a mapping from segments to (bend_x, bend_y, length)")
        segments = list(self.segments)
        for which, held in coordinates.items():
            number = segment_number("coordinates", which, self.segment_names)
            with checks.inside(f"coordinates.{which}"):
                segments[number - 1] = segments[number - 1].changed(locked=held)
        return self.changed(segments=segments)

    def changed(self, **values: Unpack[RobotArguments]) -> "Robot":
        """Return the same robot with other values of some parameters."""
        return self._changed(values)

    def __len__(self) -> int:
        return len(self.rows)

    def __repr__(self) -> str:
        low, high = (sum(segment.length[i] for segment in self.segments) for i in (0, 1))
        name = [] if self.name is None else [text(self.name)]
        driven = [f"{len(self.drive)} actuators"] if len(self.drive) else []
        moved = [f"{len(self.joint_names)} joints"] if self.joints else []
        arcs = [f"{len(self.segments)} segments", f"total length {low:g} to {high:g}"] if self.segments else []
        return call("Robot", [*name, *moved, *arcs, *driven])

    @cached_property
    def straight(self) -> Floats:
        """The straight configuration (rows, 3) at mean lengths, with joints as near to 0 as they can be; read-only."""
        q = straight(self.rows)
        return checks.closed(self.drive.coordinates.project(q) if self.joints else q)

    @property
    def body_radii(self) -> tuple[float, ...]:
        """Radii of what has a body: capsules of links, and all segments."""
        return tuple(row.radius for row in self.rows if not isinstance(row, RigidRow) or row.has_body)

    @cached_property
    def mean_length(self) -> float:
        """Sum of the mean lengths of segments and links: the unit of relative tolerances.

        Of joints that all stand in one place it is how far the tool reaches, and 1 without a tool.
        """
        length = 0.5 * sum(sum(segment.length) for segment in self.segments) + mean_reach(self.joints)
        return length or float(np.linalg.norm(self.tool[:3, 3])) or 1.0

    @cached_property
    def longest(self) -> float:
        """How far its tip is from its base at most: lengths of segments, and those of links and prismatic joints."""
        return self.longest_up_to(len(self))

    def longest_up_to(self, last: int) -> float:
        """Return how far the end of row `last` (1 = first) is from the base at most."""
        links = float(self.limits[:last, tables.TAIL_LENGTH].sum())
        return sum(row.length[1] for row in self.rows[:last]) + links

    def end_row(self, segment: int | str | None) -> int:
        """Return the row (1 = first) of a segment (1 = first), or of a joint of this name; the last one for `None`."""
        if isinstance(segment, str):
            return self.row_names.index(segment) + 1
        return len(self) if segment is None else len(self._rigid.rows) + segment

    @cached_property
    def labels(self) -> tuple[Any, ...]:
        """What answers call each row: the number of a segment, 1 = first, the name of a joint, or of that of a link."""
        return *(row.owner for row in self._rigid.rows), *range(1, len(self.segments) + 1)

    @property
    def largest_bends(self) -> tuple[float, ...]:
        """Norm of the largest bend of each segment, rad; curvature may allow less."""
        return self.drive.coordinates.largest_bends

    @property
    def avoids_itself(self) -> bool:
        """Whether the body must not run through itself: it has a thickness, and `self_collision` is `avoid`."""
        return self.self_collision == "avoid" and max(self.self_radii) > 0.0

    @cached_property
    def _least_clearances(self) -> tuple[float, float]:
        """Clearance from obstacles, and from itself, that is demanded of all segments at least."""
        return float(np.min(self.clearance)), float(np.min(self.self_clearance))

    @cached_property
    def _group(self) -> Floats:
        """The robot as kernels read it, whatever loads it: to be copied."""
        tables = self.limits, self.actuation, self.base, self.tool
        return checks.closed(packing.robot_group(*tables, self.avoids_itself))

    @cached_property
    def _demands_clearance(self) -> bool:
        """Whether any clearance is demanded."""
        return bool(np.any(self.clearance) or np.any(self.self_clearance))

    @property
    def has_external_load(self) -> bool:
        """Whether gravity bends it: `gravity` is given, and a segment has a stiffness."""
        return self.gravity is not None and any(segment.stiffness is not None for segment in self.segments)

    def _refuse_load(self) -> None:
        """Refuse a robot that gravity bends, where shapes without load would be wrong.

        Raises
        ------
        InputError
        """
        if self.has_external_load:
            wanted = "none: take robot.changed(gravity=None, payload=None) for the robot without load"
            raise InputError("gravity", "this is computed without loads", self.gravity, wanted)

    hangs, least_demanded = Renamed("has_external_load"), Renamed("_least_clearances")
    demands, refuse_load = Renamed("_demands_clearance"), Renamed("_refuse_load")

    @property
    def notes(self) -> tuple[str, ...]:
        """What may surprise: segments too thick for their own limits, what `coordinate_notes` say, notes of joints."""
        return (*self.thick_notes, *self.coordinate_notes, *self.joint_notes)

    @property
    def thick_notes(self) -> list[str]:
        """Which segments may bend less than their own limits allow, because they are too thick."""
        before = len(self._rigid.rows)
        return held_back(self.segments, self.self_radii[before:], self.curvatures[before:])

    @cached_property
    def joint_notes(self) -> tuple[str, ...]:
        """What was decided where joints were read from a file, by joint; and which links overlap nearly everywhere."""
        pairs = zip(joint_names(self.joints), self.joints, strict=True)
        read = (f"{name}: {note}" for name, joint in pairs for note in joint.notes)
        return (*read, *overlap_notes(self._rigid, self.joint_names, self._begins))

    def _begins(self, joints: Floats) -> Floats:
        """Poses (m, r, 4, 4) in which rows of joints and links begin, at these values (m, j)."""
        ends = self.forward(straight(self.segments).reshape(-1, 3), joints)[:, : len(self._rigid.rows) - 1]
        return np.concatenate([np.broadcast_to(self.base, (len(ends), 1, 4, 4)), ends], axis=1)

    @cached_property
    def held_notes(self) -> tuple[str, ...]:
        """What is locked or bends in one plane, and why: what results say of it."""
        return tuple(self.drive.coordinates.notes(self.row_names))

    @cached_property
    def coordinate_notes(self) -> tuple[str, ...]:
        """What is locked or bends in one plane, and why; and lengths that no actuator moves."""
        loose = self._loose_lengths
        them = "it" if len(loose) == 1 else "them"
        said = (f"no actuator moves length of {few(loose)}; give {them} a stage, or one length",) if loose else ()
        return *self.held_notes, *self._open_notes, *said

    @property
    def _open_notes(self) -> tuple[str, ...]:
        """What actuators that bend the robot move, but do not determine; joints have motors of their own."""
        if not self.drive.jacobian.reshape(-1, len(self), 3)[..., :2].any():
            return ()
        lengths = {f"length of {name} (" for name in self._loose_lengths}
        own = tuple(f"joint {name!r}" for name in self.joint_names)
        left = [each for each in self.undetermined if not each.startswith((*lengths, *own))]
        return (f"actuators alone do not determine {few(left)}",) if left else ()

    @property
    def _loose_lengths(self) -> tuple[str, ...]:
        """Names of segments with a range of lengths that no actuator moves, where the robot has actuators."""
        if not len(self.drive):
            return ()
        moved = (self.drive.jacobian.reshape(-1, len(self), 3)[..., 2] != 0.0).any(axis=0)
        if self.drive.elastic is not None:
            own = self.drive.elastic.determined & self.drive.coordinates.stretches
            moved[self.drive.coordinates.owner[own]] = True
        low, high = self.drive.coordinates.lengths.T
        moved[: len(self._rigid.rows)] = True
        return tuple(self.row_names[k] for k in np.flatnonzero((low < high) & ~moved))

    def to_dict(self) -> dict[str, Any]:
        """Return the robot as a problem file says it: plain values that make an equal robot."""
        own = {
            "segments": counted([segment.to_dict() for segment in self.segments]),
            "joints": [joint.to_dict() for joint in self.joints],
        }
        return {key: value for key, value in (described(self) | own).items() if value != []}

    def save(self, file: str | Path) -> None:
        """Write the robot into a file, JSON when it is called so, YAML otherwise; `sinuous.load` reads it.

        Raises
        ------
        InputError
            When the file cannot be written.
        """
        write_document(file, self.to_dict())

    def to_urdf(self, file: str | Path, joints_per_segment: Whole = 8) -> "sn.files.JointChain":
        """Write a chain of joints that stands for the robot as URDF, which RViz, MuJoCo and PyBullet load.

        Its error shrinks with the square of `joints_per_segment`. Returns the chain, whose `values` are the joint
        values of a configuration.

        Raises
        ------
        InputError
            When the file cannot be written.
        """
        chain: sn.files.JointChain = import_late("files.joint_chain").JointChain(self, joints_per_segment)
        import_late("files.joint_chain").write_urdf(file, chain)
        return chain

    def to_mjcf(self, file: str | Path, joints_per_segment: Whole = 8, mass: Number = 1.0) -> "sn.files.DrivenChain":
        """Write the robot with its motors as MJCF, so that MuJoCo moves it by them.

        The controls are the values of the actuators, in the units of the motors. What no actuator determines has a
        servo of its own, under the name of the coordinate: `s1.bend_x`, `s1.length`. Returns the chain with its drives,
        whose `controls` are those of a configuration; the keyframe `rest` is the straight robot. The tip is off as that
        of `to_urdf`. Masses are nominal: the file is for motion and contact, not for forces.

        Parameters
        ----------
        file : path
        joints_per_segment : int
        mass : float
            Of the whole arm.

        Raises
        ------
        InputError
            When an argument is not what it should be, nothing can move, or the file cannot be written.
        """
        total = checks.number("mass", mass, above=0.0)
        chain = import_late("files.joint_chain").JointChain(self, joints_per_segment)
        driven: sn.files.DrivenChain = import_late("files.mjcf").DrivenChain(
            self, chain, self._inverse.undetermined, total
        )
        import_late("files.mjcf").write_mjcf(file, driven)
        return driven

    def configuration(
        self, key: str, q: JointsAndBatch | list[Pair] | Stack | None, joints: JointValues | None = None
    ) -> Floats:
        """Check configurations of all rows (..., rows, 3), or q (..., n, 3) with joints; limits are not looked at.

        Parameters
        ----------
        key : str
            What it is called where it is refused.
        q : array_like (..., r, 3), (..., n, 3), or a pair
            Of all r rows, or of the n segments. The pair has values (..., j) of the joints, then q (..., n, 3).
        joints : array_like (..., j), or mapping from names to array_like (...), optional
            Where `q` is that of the segments alone.
        """
        if not self._rigid.rows and joints is None:
            return checks.stack(key, q, (len(self), 3))
        return joined(self._rigid, len(self.segments), key, q, joints)

    def _one_configuration(self, key: str, given: Any) -> Floats:
        """Check one configuration (rows, 3), or a pair of joints (j,) and q (n, 3); limits are not looked at."""
        return checks.array(
            key, joined(self._rigid, len(self.segments), key, given) if self.joints else given, (len(self), 3)
        )

    def _one_velocity(self, key: str, given: Any) -> Floats:
        """Check how fast a configuration changes (rows, 3), or a pair of what joints (j,) and segments (n, 3) do."""
        still = np.zeros((len(self.segments), 3)), np.zeros(len(self.joint_names))
        return np.asarray(self._one_configuration(key, given) - (self.with_joints(*still) if is_pair(given) else 0.0))

    def arm_at(self, configuration: JointsAndBatch) -> tuple["Robot", Floats]:
        """Return the segments alone, on the joints as they stand in a configuration (rows, 3), and their q (n, 3)."""
        whole = self._one_configuration("configuration", configuration)
        if not self.joints:
            return self, whole
        base = self.forward(whole)[len(self._rigid.rows) - 1]
        return self.changed(joints=(), base=base), np.array(self.segments_of(whole))

    def with_joints(self, q: Batch | None, joints: JointValues) -> Floats:
        """Configurations (..., rows, 3) of the segments' q (..., n, 3) and the values (..., j) of the joints.

        `q` may be `None` for a robot without segments.

        Raises
        ------
        InputError
            When the shapes are others, or do not fit each other.
        """
        return self.configuration("q", q, joints)

    def segments_of(self, configuration: Floats) -> Floats:
        """Return the rows (..., n, 3) of the segments, of configurations (..., rows, 3): a view."""
        return configuration[..., len(self._rigid.rows) :, :] if self._rigid.rows else configuration

    def joints_of(self, configuration: Floats) -> Floats:
        """Return the values (..., j) of the joints, of configurations (..., rows, 3)."""
        return checks.closed(self._rigid.split(configuration)[0])

    def split(self, configuration: JointsAndBatch) -> tuple[Floats, Floats]:
        """Values (..., j) of the joints and q (..., n, 3) of the segments, of configurations (..., rows, 3)."""
        return self._rigid.split(self.configuration("configuration", configuration))

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints that move, in the order of their values; by default `j1`, `j2`, ..."""
        return tuple(self.row_names[row] for row in self._rigid.values)

    def forward(self, q: JointsAndBatch | None, joints: JointValues | None = None) -> Floats:
        """Poses (..., rows, 4, 4) of the ends of all rows in the world; the tool is not applied.

        Rows are the joints and the capsules of their links, if there are any, then the n segments. The end of a joint
        or capsule is where the next row begins.
        """
        _, frames, lead = self._frames(q, joints)
        return _poses_of(frames[:, 1:]).reshape(*lead, len(self), 4, 4)

    def tip(self, q: JointsAndBatch | None, joints: JointValues | None = None) -> Floats:
        """Pose (..., 4, 4) of the tool (of the tip, without one) in the world."""
        _, frames, lead = self._frames(q, joints)
        return _poses_of(frames[:, -1]).reshape(*lead, 4, 4) @ self.tool

    def backbone(self, q: JointsAndBatch | None, samples: Whole = 20, joints: JointValues | None = None) -> Floats:
        """Points (..., n * samples + 1, 3) of the backbone from base to tip, evenly spaced within each segment.

        Joints and capsules of links count as segments before them; the last n * samples points are those of the arm,
        without the place where its first segment begins.
        """
        from sinuous.kernels.chain import batch  # noqa: PLC0415

        count = checks.integer("samples", samples, 1, 100_000)
        flat, frames, lead = self._frames(q, joints)
        points = np.empty((len(flat), len(self) * count + 1, 3))
        batch.points_of(flat, frames, count, points)
        return points.reshape(*lead, *points.shape[1:])

    def jacobian(
        self, q: JointsAndBatch | None, segment: Which | None = None, joints: JointValues | None = None
    ) -> Floats:
        """Geometric Jacobian (..., 6, j + 3 n) of the end of a segment.

        `segment` is its number, 1 = first, or its name; the last one, which is the default, means the tool.
        Rows 0 to 2 are the angular velocity, rows 3 to 5 the velocity of that point, both in world axes; columns are
        the values of the joints, then `bend_x, bend_y, length` of the first segment, of the second, and so on.
        """
        number = None if segment is None else segment_number("segment", segment, self.segment_names)
        return self._of_values(self._row_jacobian(q, self.end_row(number), joints))

    def _of_values(self, of_rows: Floats) -> Floats:
        """Return the columns of joints, then of segments (..., j + 3 n), of columns (..., 3 rows)."""
        return of_rows[..., self._rigid.flat(len(self))] if self._rigid.rows else of_rows

    def _row_jacobian(self, q: JointsAndBatch | None, end: int, joints: JointValues | None = None) -> Floats:
        """Geometric Jacobian (..., 6, 3 rows) of the end of a row (1 = first)."""
        from sinuous.kernels.chain import batch  # noqa: PLC0415

        flat, frames, lead = self._frames(q, joints)
        out = np.zeros((len(flat), 6, 3 * len(self)))
        batch.jacobians_of(
            self.limits.copy(), flat, frames, packing.pose_row(self.tool), end - 1, np.empty((len(self), 18)), out
        )
        return out.reshape(*lead, 6, 3 * len(self))

    def _frames(
        self, q: JointsAndBatch | None, joints: JointValues | None = None
    ) -> tuple[Floats, Floats, tuple[int, ...]]:
        """Configurations (m, n, 3), the frames (m, n + 1, 12) of base and ends of segments, and axes in front."""
        from sinuous.kernels.chain import batch  # noqa: PLC0415

        checked = self.configuration("q", q, joints)
        lead = checked.shape[:-2]
        flat = np.array(checked.reshape(-1, len(self), 3))
        frames = np.empty((len(flat), len(self) + 1, 12))
        batch.frames_of(self.limits.copy(), flat, packing.pose_row(self.base), frames)
        return flat, frames, lead

    def shape(self, q: JointsAndBatch, load: Loads = ()) -> "sn.answer.Equilibrium":
        """Shape of the body under gravity, its payload and other loads, whose configuration without any would be `q`.

        Tendons and chambers keep their lengths, or stretch where they have a stiffness, and tendons that would have to
        push are slack. A segment without any keeps the moments that its drive exerts.

        Parameters
        ----------
        q : array_like (n, 3)
        load : Force, Payload, or list of these
            Beside gravity and payload of the robot.

        Returns
        -------
        Equilibrium
            A stable one where one is found nearby; else an unstable one, whose `stable` is false.

        Raises
        ------
        InputError
            When nothing has a stiffness, or no equilibrium was found for all of the load.
        """
        checked = self._one_configuration("q", q)
        return self._rest(load_list("load", load, self.segment_names), "q", checked, None)

    def equilibrium(
        self,
        actuators: ActuatorValues | None = None,
        forces: Loads = (),
        *,
        tensions: ActuatorValues | None = None,
        initial: JointsAndBatch | None = None,
    ) -> "sn.answer.Equilibrium":
        """Shape of the body under load at these values of the actuators (m,), or at these tensions (m,).

        Parameters
        ----------
        actuators : array_like (m,) or mapping, optional
            As for `from_actuators`; what they hold, they keep.
        forces : Force, Payload, or list of these
            Beside gravity and payload of the robot.
        tensions : array_like (m,) or mapping, optional
            Of tendons and chambers in the order of `actuators`, instead of values; positive pulls.
        initial : array_like (n, 3), optional
            Of what no actuator determines, its configuration without load.

        Returns
        -------
        Equilibrium

        Raises
        ------
        InputError
            As for `shape`; or when neither or both of `actuators` and `tensions` are given.
        """
        loads = load_list("forces", forces, self.segment_names)
        if (actuators is None) == (tensions is None):
            raise InputError("actuators", "", actuators, "either values of actuators, or tensions")
        if tensions is not None:
            q = None if initial is None else self._one_configuration("initial", initial)
            names = [each.name for each in self.actuators]
            ordered = in_order("tensions", tensions, names) if isinstance(tensions, Mapping) else tensions
            pulled = checks.array("tensions", ordered, (len(self.drive),))
            return self._rest(loads, "tensions", pulled, q)
        self.from_actuators(actuators, initial)  # values that contradict each other are told
        given: Any = actuators
        values, reference = self._fitting(given, initial)
        return self._rest(loads, "actuators", values, reference)

    def _rest(
        self, loads: tuple[Load, ...], drive: str, values: Floats, initial: Floats | None
    ) -> "sn.answer.Equilibrium":
        statics = import_late("statics.equilibrium")
        question = statics.EquilibriumQuestion(self, loads, drive, values, initial)
        found: sn.answer.Equilibrium = statics.find_equilibrium(question)
        return found

    def excess(self, q: JointsAndBatch) -> float:
        """Return by how much configurations (..., n, 3) are outside the limits, at worst; 0 within all of them.

        Bends and lengths count in their own units (rad, length unit), actuators in the length unit: by their
        displacements, of `Actuators` divided by their largest weight, those of bends relative to the mean length.
        """
        return self.limit_set.excess(self.configuration("q", q))

    def within_tensions(self, q: JointsAndBatch) -> NDArray[np.bool_]:
        """Whether tensions within their limits hold configurations (..., n, 3), as compiled solvers do not know."""
        return self.limit_set.held(self.configuration("q", q))

    def clamp(self, q: JointsAndBatch) -> Floats:
        """Return the configurations (..., n, 3) within all limits that are nearest to these.

        Bends count in rad, lengths in mean lengths of a segment. Limits of tensions under load are not looked at; where
        lengths change how much tension a bend takes, what is found is near, and within, but perhaps not the nearest.

        Raises
        ------
        InputError
            When none is found.
        """
        given = self.configuration("q", q)
        shapes = [self.limit_set.clamp(one) for one in given.reshape(-1, len(self), 3)]
        return np.array(shapes).reshape(given.shape)

    def violations(self, q: JointsAndBatch) -> list[Violation]:
        """List the limits that a configuration (n, 3) violates, each with its segment (1 = first) and by how much.

        Instead of a segment stands the name of a joint. `length` and `actuator` count in the length unit, `bend` and
        `curvature` in rad: the latter is the bend beyond what the curvature allows at this length.
        """
        found = self.limit_set.violations(self._one_configuration("q", q))
        return [(kind, self.labels[row - 1], amount) for kind, row, amount in found]

    @cached_property
    def limit_set(self) -> LimitSet:
        """All limits of the robot, as verbs ask them."""
        return LimitSet(self.rows, self.self_radii, self.curvatures, self.drive, self.mean_length)

    @property
    def actuators(self) -> tuple[Actuator, ...]:
        """All actuators: segment by segment tendons, chambers, the stage; at the end those of `Actuators`."""
        return self.drive.actuators

    def to_actuators(self, q: JointsAndBatch) -> Floats:
        """Values (..., m) of all actuators in configurations (..., n, 3), in the order of `actuators`.

        They are those of the motors: gain x displacement + offset. Without a gain, a tendon's value is its displacement
        (positive is pulled), that of a chamber or a stage its length, both in the length unit. Elastic tendons and
        chambers are displaced by their stretch, too, at the least tensions within their limits that hold the shape.
        """
        return self.drive.values(self.configuration("q", q))

    def from_actuators(
        self,
        actuators: ActuatorValues | None,
        initial: JointsAndBatch | None = None,
        tolerance: Number | Vector | None = None,
    ) -> Floats:
        """Configurations (..., n, 3) of the robot whose actuators have these values (..., m); limits are not looked at.

        Where values contradict each other (three tendons of an arc are one too many) it is the nearest: least squares
        of displacements, and that is said; `to_actuators(q) - actuators` is what is left. Elastic actuators take the
        shape of least energy, in which tendons that would have to push are slack (see `tensions`). Coordinates that
        cannot move are what they are.

        Parameters
        ----------
        actuators : array_like (..., m), or mapping from names to array_like (...)
            In the units of the motors; by name as `Solution.actuators` and `Solutions.actuators` give them.
        initial : array_like (..., n, 3), optional
            What no actuator determines stays as it is here: of all configurations with these values the nearest to
            this one (bends in rad, lengths relative to the mean length of their segment).
        tolerance : float or array_like (m,), optional
            By how much values may contradict each other, in the units of the motors: up to this nothing is said, and
            more is refused. By default what rounding does, and a `SuspiciousInput` warns of more, with the residual.

        Raises
        ------
        InputError
            When there is no `initial`, and actuators leave a coordinate open; all such coordinates are named. When
            values contradict each other by more than `tolerance`, or a name is missing or unknown.
        """
        values, reference = self._fitting(actuators, initial)
        if reference is None and self.undetermined:
            expected = f"a configuration for what no actuator determines: {few(self.undetermined)}"
            raise InputError("initial", "missing", None, expected)
        found = self.without_load(self.drive.motors.displacements(values), reference)
        answer_contradictions(self.drive, values, found, tolerance, self.mean_length)
        return found

    def _fitting(self, actuators: ActuatorValues | None, initial: Any) -> tuple[Floats, Floats | None]:
        """Check values (..., m) of actuators, and a reference (..., rows, 3) or none."""
        near = initial if initial is None or not self.joints else self.configuration("initial", initial)
        return fitting(actuators, near, [actuator.name for actuator in self.actuators], len(self))

    def without_load(self, displacements: Floats, reference: Floats | None) -> Floats:
        """Configurations (..., n, 3) that displacements (..., m) of all actuators make; see `from_actuators`."""
        found = self._inverse.configuration(displacements, reference)
        return found if self.drive.elastic is None else self.drive.elastic.shape(displacements, found)

    def tensions(self, actuators: ActuatorValues, initial: JointsAndBatch | None = None) -> Floats:
        """Tensions (..., m) of all actuators at these values (..., m): 0 where a tendon is slack, NaN of rigid ones.

        Parameters as for `from_actuators`. Positive pulls; a chamber that pushes has a negative tension. In the unit
        of force of `stiffness`.
        """
        q = self.from_actuators(actuators, initial)
        values, _ = self._fitting(actuators, initial)
        return self.drive.tensions(q, self.drive.motors.displacements(values))

    def slack(self, actuators: ActuatorValues, initial: JointsAndBatch | None = None) -> tuple[str, ...]:
        """Names of the elastic tendons that are slack at these values (m,)."""
        tensions = self.tensions(actuators, initial)
        if tensions.ndim != 1:
            raise InputError("actuators", f"shape {tensions.shape}", actuators, f"{len(self.drive)} values")
        return tuple(each.name for each, own in zip(self.actuators, tensions, strict=True) if own == 0.0)

    def actuator_jacobian(self, q: JointsAndBatch) -> Floats:
        """Derivative (..., m, j + 3 n) of the values of all actuators, read-only.

        Columns are those of `jacobian`. It is the same for every
        configuration, because all actuators are linear; of elastic ones the stretch is left out.
        """
        lead = self.configuration("q", q).shape[:-2]
        jacobian = self._of_values(self.drive.value_jacobian)
        return np.broadcast_to(jacobian, (*lead, *jacobian.shape))

    @cached_property
    def undetermined(self) -> tuple[str, ...]:
        """What no actuator determines, like `length of s2 (segment 2)`: `from_actuators` takes it from `initial`."""
        return tuple(self._inverse.named(self.row_names, len(self._rigid.rows)))

    @cached_property
    def _inverse(self) -> Inverse:
        return Inverse(self.drive)


def _poses_of(frames: Floats) -> Floats:
    """Poses (..., 4, 4) of frames (..., 12) as kernels have them."""
    poses = np.zeros((*frames.shape[:-1], 4, 4))
    poses[..., :3, :3] = frames[..., :9].reshape(*frames.shape[:-1], 3, 3)
    poses[..., :3, 3] = frames[..., 9:]
    poses[..., 3, 3] = 1.0
    return poses


def _widths(radii: Sequence[float], away: Any, unsure: Any, apart: Any) -> tuple[tuple[float, ...], ...]:
    """Radii that the backbone needs free of obstacles, and of other places of the body."""
    needed, own = np.add(np.add(radii, away), unsure), np.add(radii, np.multiply(0.5, apart))
    return tuple(needed.tolist()), tuple(own.tolist())


def _gravity(value: Vector, segments: tuple[Segment, ...], payload: tuple[Payload, ...]) -> Floats:
    if not any([*(each.mass for each in segments), *(each.mass for each in payload)]):
        raise InputError("gravity", "nothing has a mass", value, "mass of the segments, or a payload")
    return checks.array("gravity", value, (3,))


def robot_group(robot: Robot) -> Floats:
    """Return a robot as kernels read it, a new array; laid out as `sinuous.kernels.tables` says."""
    robot._refuse_load()
    return robot._group.copy()


def same_body(one: Robot, other: Robot) -> bool:
    """Whether two robots are the same, whatever clearances they demand."""
    free, also = (demanding(each, 0.0, 0.0) for each in (one, other))
    return free.equals(also)


def demanding(robot: Robot, clearance: OneEach | None, self_clearance: OneEach | None) -> Robot:
    """Return the robot with other clearances demanded, where they are given; the same one where nothing changes."""
    given = {"clearance": clearance, "self_clearance": self_clearance}
    asked = {key: each_segment(key, value, robot.segment_names) for key, value in given.items() if value is not None}
    changed: Any = {key: value for key, value in asked.items() if value != getattr(robot, key)}
    return robot.changed(**changed) if changed else robot
