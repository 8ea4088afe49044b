"""How a solve ended, in a word and in a sentence; and where that is proved, why: the number that proves it.

Bounds on lengths and bends come from `sinuous.measures`, without kernels; distances to obstacles from
`sinuous.scene.snapshot`.
"""

from dataclasses import dataclass, fields
from enum import StrEnum
from operator import itemgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous.base.arguments import BoundName
from sinuous.base.checks import Floats
from sinuous.base.documents import result_of
from sinuous.base.errors import number
from sinuous.base.frozen import ShortRepr
from sinuous.kernels import tables as t
from sinuous.measures.body import BodyPlace
from sinuous.measures.reach import backbone_end, bounds
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem
from sinuous.scene.snapshot import room_at


class Status(StrEnum):
    """How a solve ended. Where it says proved, one counterexample is a defect."""

    SOLVED = "solved"
    OUT_OF_REACH = "out_of_reach"
    TARGET_BLOCKED = "target_blocked"
    BASE_BLOCKED = "base_blocked"
    START_BLOCKED = "start_blocked"
    NO_ROUTE = "no_route"
    UNPROVED = "unproved"
    BLOCKED = "blocked"
    LIMIT_BOUND = "limit_bound"
    RATE_BOUND = "rate_bound"
    STALLED = "stalled"
    TIME_LIMIT = "time_limit"
    LEFT_PATH = "left_path"

    @property
    def sentence(self) -> str:
        """What the status means."""
        return _SENTENCES[self]


_SENTENCES = {
    Status.SOLVED: "all within tolerance and limits, whole body proved clear of obstacles and of itself",
    Status.OUT_OF_REACH: "proved: no configuration within the limits gets there",
    Status.TARGET_BLOCKED: "proved: the body would overlap an obstacle at the target",
    Status.BASE_BLOCKED: "proved: the body overlaps an obstacle where it leaves its mount",
    Status.START_BLOCKED: "the start overlaps an obstacle or itself, or violates a limit",
    Status.NO_ROUTE: "proved at the stated resolution: no route through free space is both no longer than the robot "
    "and wide enough for its body",
    Status.UNPROVED: "everything met as far as could be seen, clearance not proved",
    Status.BLOCKED: "not solved: the best found overlaps an obstacle or itself",
    Status.LIMIT_BOUND: "not solved: limits stop the best found",
    Status.RATE_BOUND: "not solved: the allowed changes lead no nearer",
    Status.STALLED: "not solved: no progress from any start",
    Status.TIME_LIMIT: "not solved within the time budget",
    Status.LEFT_PATH: "the tip left the line between two waypoints, where the robot could not follow it",
}

CODES = {
    Status.SOLVED: t.SOLVED,
    Status.UNPROVED: t.UNPROVED,
    Status.TIME_LIMIT: t.LATE,
    Status.OUT_OF_REACH: t.OUT_OF_REACH,
    Status.TARGET_BLOCKED: t.TARGET_BLOCKED,
    Status.BASE_BLOCKED: t.BASE_BLOCKED,
    Status.NO_ROUTE: t.NO_ROUTE,
    Status.RATE_BOUND: t.RATE_BOUND,
}
"""Codes by which kernels say how a search ended; all other statuses are FAILED, for different reasons."""

_OF_CODES = {code: status for status, code in CODES.items()}


def status_of(outcome: t.Outcome) -> Status:
    """Return the status that an outcome stands for."""
    status = _OF_CODES.get(outcome.code)
    if status is not None:
        return status
    if outcome.clearance < 0.0 or outcome.self_clearance < 0.0:
        return Status.BLOCKED
    return Status.LIMIT_BOUND if outcome.bound else Status.STALLED


_STATUSES = np.array(list(Status), object)
_PLACE = {status: place for place, status in enumerate(Status)}
_IN_ORDER = np.array([_PLACE[_OF_CODES.get(code, Status.STALLED)] for code in range(max(_OF_CODES) + 1)], np.uint8)


def statuses_of(records: Floats) -> NDArray[np.object_]:
    """Return the statuses (m,) that records (m, 11 or more) stand for, as `status_of` does for one."""
    return _STATUSES[places_of(records)]


def places_of(records: Floats) -> NDArray[np.uint8]:
    """Return the places (m,) of these statuses among all, in the order of `Status`."""
    codes = records[:, t.CODE].astype(np.int64)
    result: NDArray[np.uint8] = _IN_ORDER[codes]
    failed = codes == t.FAILED
    if failed.any():
        result[failed & (records[:, t.BOUND] != 0.0)] = _PLACE[Status.LIMIT_BOUND]
        crossed = (records[:, t.CLEARANCE] < 0.0) | (records[:, t.SELF_CLEARANCE] < 0.0)
        result[failed & crossed] = _PLACE[Status.BLOCKED]
    return result


@dataclass(frozen=True, repr=False)
class Reason(ShortRepr):
    """A bound that no configuration can keep.

    Attributes
    ----------
    bound : str
        `length`: the target is farther away than the robot is long. `near`: it is nearer than lengths and bends allow.
        `aside`, `behind`: it lies farther aside of the base's tangent, or less far ahead, than bends and lengths reach;
        or the base does so, seen back along the target's tangent. `turning`: the direction asks for more than all bends
        together. `target`, `base`: the body needs more room there than the obstacle leaves. `route`: no route from
        mount to target is both wide enough and no longer than the body.
    needed, available : float
        What the bound compares: lengths, for `turning` angles (rad), for `route` the radius of the body and the edge of
        the cells that free space was divided into.
    obstacle : str or None
        The nearest one, by name, where obstacles are the reason.
    pointing : bool
        Whether the direction that is asked for is part of the reason.
    longest : float or None
        For `route`: the greatest length of the body up to the target; longer routes were not looked at.
    inside : bool
        Whether the body has to stay inside the obstacle.
    clearance : float
        What is demanded of it, which is part of what is needed.
    place : BodyPlace or None
        For `target` and `base`: where the body needs more room.
    in_solid : bool
        For `base`: whether it lies within an obstacle that the body could have to stay inside instead.
    """

    bound: BoundName
    needed: float
    available: float
    obstacle: str | None = None
    pointing: bool = False
    longest: float | None = None
    inside: bool = False
    clearance: float = 0.0
    place: BodyPlace | None = None
    in_solid: bool = False

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values, in the order of the file format."""
        return result_of(self, "bound needed available obstacle place")

    def __str__(self) -> str:
        missing = number(self.needed - self.available)
        needed, available, obstacle = number(self.needed), number(self.available), self.obstacle
        this_way = " pointing this way" if self.pointing else ""
        body, overlap = (
            f"the body, of radius {needed},",
            f"{missing} {'outside' if self.inside else 'deep in'} {obstacle}",
        )
        thick, there = f"a body of radius {needed}", "" if self.place is None else f", {self.place}"
        remedy = "the usual remedy is a longer mount"
        if self.in_solid:
            remedy = f"where the body belongs inside {obstacle}, give that inside=True; else {remedy}"
        if self.clearance > 0.0:
            with_it = f"of radius {number(self.needed - self.clearance)} and with {number(self.clearance)} of clearance"
            body, overlap, thick = f"the body, {with_it},", f"{missing} too near to {obstacle}", f"a body {with_it}"
        return {
            "length": f"the target is {missing} farther from the base than the robot is long "
            f"({needed} away, the robot at most {available} long)",
            "near": f"the target is {missing} nearer to the base than the tip can come "
            f"({available} away, the tip at least {needed})",
            "aside": f"the target lies {missing} farther to the side than the tip can reach{this_way}",
            "behind": f"the target lies {missing} behind everything that the tip can reach{this_way}",
            "turning": f"the direction asks for a turn of {needed} rad, and all bends together make {available} at "
            f"most: {missing} rad too little",
            "target": f"at the target {body} would be {overlap}{there}",
            "base": f"where {body} leaves its mount it is {overlap}{there}; {remedy}",
            "route": f"no way from base to target is both wide enough for {thick} and at most "
            f"{number(self.longest)} long, the greatest length of the body up to the target (shown with cells of edge "
            f"{available}); the obstacle nearest to the target is {obstacle}",
        }[self.bound]


def unreachable(problem: Problem) -> Reason | None:
    """The first bound on lengths and bends that a target breaks; `None` when all keep them."""
    for target in problem.targets:
        for bound in bounds(problem.robot, target, problem.tolerance):
            if bound.needed > bound.available:
                return Reason(bound.name, bound.needed, bound.available, pointing=bound.pointing)
    return None


def target_in(problem: Problem) -> Reason | None:
    """The target whose body would overlap an obstacle the most."""
    robot, tolerance = problem.robot, problem.tolerance
    found: list[Reason] = []
    for target in problem.targets:
        if target.position is not None:
            last = robot.end_row(target.segment)
            place, loose = backbone_end(robot, target, last, tolerance.angle)
            room = room_at(place, problem.scene)
            available = room.distance + loose + (tolerance.position or 0.0)
            inside = _is_inside(problem, room.obstacle)
            own = robot.needed_radii[last - 1], available, room.obstacle
            clearance = robot.needed_radii[last - 1] - robot.radii[last - 1]
            there = BodyPlace.of(place, robot.labels[last - 1], 1.0)
            found.append(Reason("target", *own, inside=inside, clearance=clearance, place=there))
    return max(found, key=lambda reason: reason.needed - reason.available, default=None)


def base_in(problem: Problem) -> Reason:
    """The obstacle that the body overlaps where it leaves its mount."""
    robot = problem.robot
    mouth = mouth_of(robot)
    room = room_at(mouth, problem.scene)
    inside = _is_inside(problem, room.obstacle)
    needed, clearance = _thinnest(problem)
    there = BodyPlace.of(mouth, robot.labels[0], 0.0) if robot.mount == 0.0 else BodyPlace.of(mouth)
    own: dict[str, Any] = {"inside": inside, "clearance": clearance, "place": there}
    return Reason("base", needed, room.distance, room.obstacle, **own, in_solid=begun_in(problem) is not None)


def mouth_of(robot: Robot) -> Floats:
    """Where (3,) the body leaves its mount, if it is straight up to there."""
    mouth: Floats = robot.base[:3, 3] + robot.mount * robot.base[:3, 2]
    return mouth


def begun_in(problem: Problem) -> int | None:
    """Return the number (0 = first) of the obstacle that the body begins within, where it could have to stay inside.

    `None` where it begins within none, or within one that says so already or that nothing can be inside.
    """
    scene, mouth = problem.scene, mouth_of(problem.robot)
    nearest = int(scene.nearest(mouth))
    obstacle = scene.obstacles[nearest]
    closed = getattr(obstacle, "watertight", any(field.name == "inside" for field in fields(obstacle)))
    within = closed and not obstacle.inside and float(scene.distance(mouth)) < 0.0
    return nearest if within else None


def closed_in(problem: Problem, cell: float) -> Reason:
    """The obstacle nearest to the most distal target, where no route leads; `cell`: edge of cells that proved it."""
    ends = [(problem.robot.end_row(each.segment), each.position) for each in problem.targets]
    last, place = max(((end, place) for end, place in reversed(ends) if place is not None), key=itemgetter(0))
    longest = problem.robot.longest_up_to(last)
    needed, clearance = _thinnest(problem, last)
    nearest = room_at(place, problem.scene).obstacle
    return Reason("route", needed, cell, nearest, longest=longest, clearance=clearance)


def _thinnest(problem: Problem, last: int | None = None) -> tuple[float, float]:
    """Room that the least demanding of the first segments needs, and how much of it is clearance."""
    robot = problem.robot
    radii = zip(robot.needed_radii[:last], robot.radii[:last], strict=True)
    return min((needed, needed - radius) for needed, radius in radii)


def _is_inside(problem: Problem, name: str | None) -> bool:
    """Whether the obstacle of this name is one that the body has to stay inside."""
    return any(each.inside and problem.scene.name(i) == name for i, each in enumerate(problem.scene.obstacles))
