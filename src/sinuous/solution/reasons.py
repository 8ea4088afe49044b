"""Why there is no solution: a sentence, and the number that proves it.

Bounds on lengths and bends come from `sinuous.measures`, without kernels; distances to obstacles from
`sinuous.scene.nearest`.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sinuous.arguments import BoundName
from sinuous.measures.reach import backbone_end, bounds
from sinuous.reprs import ShortRepr
from sinuous.scene.nearest import room_at
from sinuous.words import number

if TYPE_CHECKING:
    from sinuous.problem.problem import Problem


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
        mount to target is wide enough.
    needed, available : float
        What the bound compares: lengths, for `turning` angles (rad), for `route` the radius of the body and the edge of
        the cells that free space was divided into.
    obstacle : str or None
        The nearest one, by name, where obstacles are the reason.
    pointing : bool
        Whether the direction that is asked for is part of the reason.
    """

    bound: BoundName
    needed: float
    available: float
    obstacle: str | None = None
    pointing: bool = False

    def __str__(self) -> str:
        missing = number(self.needed - self.available)
        needed, available, obstacle = number(self.needed), number(self.available), self.obstacle
        this_way = " pointing this way" if self.pointing else ""
        return {
            "length": f"the target is {missing} farther from the base than the robot is long "
            f"({needed} away, the robot at most {available} long)",
            "near": f"the target is {missing} nearer to the base than the tip can come "
            f"({available} away, the tip at least {needed})",
            "aside": f"the target lies {missing} farther to the side than the tip can reach{this_way}",
            "behind": f"the target lies {missing} behind everything that the tip can reach{this_way}",
            "turning": f"the direction asks for a turn of {needed} rad, and all bends together make {available} at "
            f"most: {missing} rad too little",
            "target": f"at the target the body, of radius {needed}, would be {missing} deep in {obstacle}",
            "base": f"where the body, of radius {needed}, leaves its mount it is {missing} deep in {obstacle}; "
            "the usual remedy is a longer mount",
            "route": f"between base and target no way is wide enough for a body of radius {needed} (shown with cells "
            f"of edge {available}); the obstacle nearest to the target is {obstacle}",
        }[self.bound]


def unreachable(problem: "Problem") -> Reason | None:
    """The first bound on lengths and bends that a target breaks; `None` when all keep them."""
    for target in problem.targets:
        for bound in bounds(problem.robot, target, problem.tolerance):
            if bound.needed > bound.available:
                return Reason(bound.name, bound.needed, bound.available, pointing=bound.pointing)
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
