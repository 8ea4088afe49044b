"""Why there is no solution, in words: the number that proves it.

Bounds on lengths and bends come from `sinuous.measures`, without kernels; distances to obstacles from
`sinuous.scene.nearest`.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sinuous.measures.reach import bounds
from sinuous.measures.targets import backbone_end
from sinuous.scene.nearest import room_at

if TYPE_CHECKING:
    from sinuous.problem.problem import Problem


@dataclass(frozen=True)
class Reason:
    """A bound that no configuration can keep.

    Attributes
    ----------
    bound : str
        `length`: the target is farther away than the robot is long. `near`: it is nearer than lengths and bends allow.
        `aside`, `behind`: it lies farther aside of the base's tangent, or less far ahead, than bends and lengths reach.
        `turning`: the direction asks for more than all bends together. `target`, `base`: the body needs more room
        there than the obstacle leaves. `route`: no route from mount to target is wide enough.
    needed, available : float
        What the bound compares: lengths, for `turning` angles (rad), for `route` the radius of the body and the edge of
        the cells that free space was divided into.
    obstacle : str or None
        The nearest one, by name, where obstacles are the reason.
    """

    bound: str
    needed: float
    available: float
    obstacle: str | None = None

    def __str__(self) -> str:
        if self.bound == "route":
            return (
                f"route: none is wide enough for a body of radius {self.needed:.4g}, shown with cells of edge "
                f"{self.available:.3g}; the obstacle nearest to the target is {self.obstacle}"
            )
        at = "" if self.obstacle is None else f" at {self.obstacle}"
        remedy = "; the usual remedy is a longer mount of the robot" if self.bound == "base" else ""
        return f"{self.bound}{at}: {self.needed:.4g} needed, {self.available:.4g} available{remedy}"


def unreachable(problem: "Problem") -> Reason | None:
    """The first bound on lengths and bends that a target breaks; `None` when all keep them."""
    for target in problem.targets:
        for bound in bounds(problem.robot, target, problem.tolerance):
            if bound.needed > bound.available:
                return Reason(*bound)
    return None


def target_in(problem: "Problem") -> Reason | None:
    """The target whose body would overlap an obstacle the most."""
    robot, tolerance = problem.robot, problem.tolerance
    found: list[Reason] = []
    for target in problem.targets:
        if target.position is not None:
            last = len(robot) if target.segment is None else target.segment
            place, loose = backbone_end(robot, target, last, tolerance.angle)
            room = room_at(place, problem.scene)
            available = room.distance + loose + (tolerance.position or 0.0)
            found.append(Reason("target", robot.radii[last - 1], available, room.obstacle))
    return max(found, key=lambda reason: reason.needed - reason.available, default=None)


def base_in(problem: "Problem") -> Reason:
    """The obstacle that the body overlaps where it leaves its mount."""
    robot = problem.robot
    room = room_at(robot.base[:3, 3] + robot.mount * robot.base[:3, 2], problem.scene)
    return Reason("base", min(robot.radii), room.distance, room.obstacle)


def closed_in(problem: "Problem", cell: float) -> Reason:
    """The obstacle nearest to a target that no route leads to; `cell` is the edge of the cells that proved it."""
    place = next(target.position for target in reversed(problem.targets) if target.position is not None)
    return Reason("route", min(problem.robot.radii), cell, room_at(place, problem.scene).obstacle)
