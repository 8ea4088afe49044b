"""Which limits and obstacles hold the best configuration back, by the forces with which they do.

At the best configuration the targets pull against what holds it (Karush, Kuhn & Tucker): the gradient of the squared
residual is a sum of the normals of active limits and contacts, with multipliers that are not negative. The multipliers
are found by nonnegative least squares (Lawson & Hanson 1974) from the linearisation at the configuration alone, so that
a solve pays nothing for them. By as much as a multiplier says, the squared residual shrinks when its limit is widened.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from sinuous.answer.residual import descend_within_limits, residual_of
from sinuous.answer.worst import Contact, all_contacts
from sinuous.base.arguments import Constraint
from sinuous.base.checks import Floats
from sinuous.base.documents import result_of
from sinuous.base.errors import labelled, listed, number, one_of_body
from sinuous.base.frozen import ShortRepr
from sinuous.measures.body import BodyPlace
from sinuous.model.actuation import Actuator
from sinuous.model.limits import Limit, nonnegative_least_squares, normal
from sinuous.model.rates import Changes
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem

ACTIVE = 1e-6
"""Slack up to which a limit counts as active: rad, or lengths of a mean segment."""

NEARLY_ACTIVE = (1e-3, 0.1)
"""The same, one after the other, where no active limit stands against the targets: a search can stop short of it."""

LEAST_FORCE = 1e-3
"""Force, as a share of the largest, below which it is taken for rounding."""

PARALLEL = 1.0 - 1e-9
"""Cosine of the angle between normals from which on two limits forbid the same motion."""

MOST_ENTRIES = 4_000_000
"""Most numbers of the linear system; of more limits, those are kept that stand against the targets the most."""

RATES = {"bend_rate": "change of the bend", "length_rate": "change of the length", "actuator_rate": "change"}
"""What sentences call rates."""

OF_THICKNESS = {
    "radius": ", because the body is that thick",
    "self_clearance": ", because the body is that thick and must keep its distance from itself",
}
"""Why a curvature is limited, by the key of the limit."""

ENDS = {"length[0]": "least ", "length[1]": "greatest "}
"""What sentences call the ends of an interval of lengths."""


@dataclass(frozen=True, repr=False)
class Binding(ShortRepr):
    """A limit or an obstacle that holds a configuration back.

    Attributes
    ----------
    constraint : str
        `length`, `bend`, `curvature`, `actuator`, `clearance` of an obstacle, or `self_clearance`; with `within` also
        `length_rate`, `bend_rate` or `actuator_rate`.
    segment : int, str or None
        1 = first; or the name of a joint, or of the one whose link it is.
    obstacle : str or None
        Name of the obstacle, for `clearance`.
    value, limit : float
        What the configuration has, and what is allowed: lengths, rad for `bend`, 1 / length for `curvature`; for rates
        the change from where it began; for clearances the distance, and the one that is demanded.
    actuator : str or None
        Name of the tendon or chamber, for `actuator` and `actuator_rate`: `s1.t2`.
    key : str or None
        What the problem file calls the limit: `max_bend`, `length[1]` (the upper end), `rates.bend`.
    other_segment : int, str or None
        The segment that it touches, for `self_clearance`.
    fixed : bool
        Whether the limit leaves no choice: of a segment that cannot stretch, the length.
    inside : bool
        Whether the body has to stay inside the obstacle.
    motor : Actuator or None
        The actuator, where value and limit are those of its motor, in its unit, and not displacements.
    place : BodyPlace or None
        For clearances: the place of the backbone that is nearest, or deepest.
    """

    constraint: Constraint
    segment: int | str | None
    obstacle: str | None
    value: float
    limit: float
    actuator: str | None = None
    key: str | None = None
    other_segment: int | str | None = None
    fixed: bool = False
    inside: bool = False
    motor: Actuator | None = None
    place: BodyPlace | None = None

    @classmethod
    def of(cls, met: Limit | Contact, robot: Robot) -> "Binding":
        """Make it of a limit or a contact."""
        label = robot.labels[met.segment - 1]
        if isinstance(met, Limit):
            own = met.constraint, label, None, met.value, met.limit, met.actuator, met.key
            return cls(*own, fixed=met.fixed, motor=met.motor)
        other = None if met.other_segment is None else robot.labels[met.other_segment - 1]
        kind: Constraint = "clearance" if other is None else "self_clearance"
        there = kind, label, met.obstacle, met.clearance + met.demanded, met.demanded
        place = None if met.place is None else met.place.on_robot(robot.labels, np.ones(len(robot)))
        return cls(*there, other_segment=other, inside=met.inside, place=place)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values, in the order of the file format."""
        return result_of(self, "constraint segment obstacle value limit actuator other_segment place")


class _Force(NamedTuple):
    """A limit or contact, and the force (3 n,) with which it would push against the targets."""

    met: Limit | Contact
    push: Floats


def find_binding(problem: Problem, q: Floats, any_limit: bool = False) -> tuple[Binding, ...]:
    """List what holds the configuration `q` (n, 3) back, strongest first; empty when nothing does.

    Where the targets are met and the body overlaps an obstacle, that obstacle is the first, and the others are what
    keeps the body from coming free. Where no obstacle takes part, the configuration is first brought to rest. With
    `any_limit` at least one limit is named: if none takes part, the nearest one.
    """
    contacts = all_contacts(problem, q)
    if not contacts:
        q = descend_within_limits(problem, q)
    found = _balanced(problem, q, contacts, list(problem.robot.limit_set.sides(q)))
    if any_limit and all(each.key is None for each in found):
        return (*found, *nearest_limits(problem, q, 1))
    return found


def rate_binding(problem: Problem, q: Floats, initial: Floats, within: Changes) -> tuple[Binding, ...]:
    """List what holds `q` (n, 3) back, the best within some changes of `initial` (n, 3): rates are limits then."""
    rates = list(problem.robot.limit_set.used_up(q, initial, *within.spread(problem.robot)))
    return _balanced(problem, q, all_contacts(problem, q), [*rates, *problem.robot.limit_set.sides(q)])


def nearest_limits(problem: Problem, q: Floats, count: int = 3) -> tuple[Binding, ...]:
    """List the limits of which the configuration `q` (n, 3) has least left; what cannot move at all is left out."""
    unit = problem.robot.mean_length / len(problem.robot)
    left: dict[tuple[Any, ...], tuple[float, Limit]] = {}
    for limit in problem.robot.limit_set.sides(q):
        if not limit.fixed:
            share = limit.slack / _size(limit, unit)
            name = limit.constraint, limit.segment, limit.actuator, limit.key
            left[name] = min(left.get(name, (share, limit)), (share, limit), key=lambda pair: pair[0])
    nearest = sorted(left.values(), key=lambda pair: pair[0])[:count]
    return tuple(Binding.of(limit, problem.robot) for _, limit in nearest)


def _balanced(problem: Problem, q: Floats, touched: list[Contact], limits: list[Limit]) -> tuple[Binding, ...]:
    """List those of the contacts and limits whose forces balance the targets at `q` (n, 3), strongest first."""
    robot = problem.robot
    unit = robot.mean_length / len(robot)
    scale = np.tile([1.0, 1.0, unit], len(robot))
    contacts = [_Force(each, each.gradient * scale / robot.mean_length) for each in touched]
    residual = residual_of(problem, q)
    pull, free = scale * (residual.value @ residual.jacobian), np.empty((0, len(scale)))
    first: list[Limit | Contact] = []
    if residual.met and touched and touched[0].clearance < 0.0:  # the body would leave the deepest overlap
        pull, free, first = -touched[0].clearance * contacts[0].push, residual.jacobian * scale, [touched[0]]
        contacts = [each for each in contacts if _identity(each.met) != _identity(touched[0])]
    forces: list[tuple[float, Limit | Contact]] = []
    for slack in (ACTIVE, *NEARLY_ACTIVE):
        active = [each for each in limits if each.slack <= slack * _size(each, unit)]
        walls = [_Force(each, -normal(each, unit) / _size(each, unit)) for each in active]
        forces = _multipliers(pull, [*contacts, *walls], free)
        if forces or first:
            break
    return _ranked([*((math.inf, each) for each in first), *forces], touched, robot)


def _multipliers(pull: Floats, forces: Sequence[_Force], free: Floats) -> list[tuple[float, Limit | Contact]]:
    """Return the multipliers with which forces balance `pull` (3 n,), where they are more than rounding.

    Rows of `free` (m, 3 n) may push either way, and are not among them.
    """
    most = max(1, MOST_ENTRIES // len(pull))
    kept = sorted(forces, key=lambda force: force.push @ pull)[:most]
    if not kept or not pull.any():
        return []
    pushes = np.column_stack([each.push for each in kept])
    system = np.column_stack([pushes, free.T, -free.T])
    sizes = np.linalg.norm(pushes, axis=0)
    found = nonnegative_least_squares(system, -pull)[: len(kept)] * sizes
    units = pushes / np.maximum(sizes, 1e-300)
    # Limits that forbid the same motion share the force, whichever of them least squares chose.
    shared = [
        max(own, found[units.T @ unit > PARALLEL].max(initial=0.0)) for own, unit in zip(found, units.T, strict=True)
    ]
    least = LEAST_FORCE * max(float(found.max()), LEAST_FORCE * float(np.linalg.norm(pull)))
    return [(float(force), each.met) for force, each in zip(shared, kept, strict=True) if force > least]


def _ranked(
    forces: Iterable[tuple[float, Limit | Contact]], touched: Iterable[Contact], robot: Robot
) -> tuple[Binding, ...]:
    """Bindings by the sums of their forces, strongest first; every limit once, and every obstacle where it is deepest.

    `touched` are all contacts, deepest first.
    """
    sums: dict[Any, float] = {}
    known: dict[Any, Limit | Contact] = {}
    for each in touched:
        known.setdefault(_identity(each), each)
    for force, met in forces:
        name = _identity(met)
        sums[name] = sums.get(name, 0.0) + force
        known.setdefault(name, met)
    named = sorted(sums, key=lambda name: -sums[name])
    return tuple(Binding.of(known[name], robot) for name in named if not _is_rigid(known[name], robot))


def _is_rigid(met: Limit | Contact, robot: Robot) -> bool:
    """Whether it is what makes a row of a configuration a joint or a link, which nobody calls a limit."""
    return isinstance(met, Limit) and met.fixed and robot.rows[met.segment - 1].rigid


def _identity(met: Limit | Contact) -> tuple[Any, ...]:
    """What is told apart: every side of every limit, every obstacle, every pair of segments that touch."""
    if isinstance(met, Limit):
        return met.segment, met.actuator, met.key
    return (met.obstacle,) if met.other_segment is None else (met.segment, met.other_segment)


def _size(limit: Limit, unit: float) -> float:
    """Length of the normal of a limit."""
    return float(np.linalg.norm(normal(limit, unit)))


def in_words(binding: Iterable[Binding], count: int, values: bool = False) -> list[str]:
    """Name what holds a configuration back, in the same order: `bend of segments 1 and 2`, `displacement of s1.t4`.

    A limit of a joint is the joint alone: `joint 'roll'`.

    Segments and actuators with the same limit are named together; `count` is the number of the robot's segments. With
    `values` it is also said what there is, and what is allowed.
    """
    groups: dict[tuple[str, str], list[Binding]] = {}
    for each in binding:
        groups.setdefault((_what(each), _measured(each) if values else ""), []).append(each)
    return [
        f"{' of '.join(filter(None, (what, _whose(own, count))))}{': ' if values else ''}{measured}"
        for (what, measured), own in groups.items()
    ]


def _what(binding: Binding) -> str:
    """What is limited, or the name of the obstacle."""
    if binding.obstacle is not None:
        return binding.obstacle
    if binding.other_segment is not None:
        whom = "itself" if binding.other_segment == binding.segment else one_of_body(binding.other_segment)
        return f"{one_of_body(binding.segment)} touches {whom}"
    of_joint = isinstance(binding.segment, str) and binding.actuator is None
    if binding.constraint in RATES:
        return "change" if of_joint else RATES[binding.constraint]
    if of_joint or binding.key == "plane":
        return "" if of_joint else "bend across the plane"
    if binding.actuator is not None and binding.key is not None:
        name = binding.key.partition("[")[0]
        return "value" if name.endswith(".limits") or binding.motor else name.rpartition(".")[2]
    return f"{'fixed ' if binding.fixed else ENDS.get(binding.key or '', '')}{binding.constraint}"


def _whose(own: list[Binding], count: int) -> str:
    """The segments or actuators that share a limit."""
    if own[0].obstacle is not None or own[0].other_segment is not None:
        return ""
    if own[0].actuator is not None:
        return listed(sorted(each.actuator or "" for each in own))
    return labelled(dict.fromkeys(each.segment or 0 for each in own), count)


def _away(binding: Binding) -> str:
    """How far the body is from the obstacle, or how deep in it."""
    value, limit = binding.value, binding.limit
    where = one_of_body(binding.segment)
    if value < 0.0:
        return f"{where} is {number(-value)} {'outside it' if binding.inside else 'deep in it'}"
    if limit == 0.0:
        return f"{where} touches it"
    return f"{where} is {number(value)} away from it, at least {number(limit)} is demanded"


def _measured(binding: Binding) -> str:
    """What there is, and what is allowed."""
    value, limit = binding.value, binding.limit
    there = "" if binding.place is None else f", {binding.place}"
    if binding.other_segment is not None:
        return f"{number(max(0.0, limit - value))} too near{there}"
    if binding.obstacle is not None:
        return f"{_away(binding)}{there}"
    if binding.fixed:
        return number(limit)
    unit = f" {binding.motor.unit}" if binding.motor is not None and binding.motor.unit else ""
    thick = OF_THICKNESS.get(binding.key or "", "")
    if abs(value - limit) <= ACTIVE * max(1.0, abs(limit)) or binding.constraint in RATES:
        return f"at its limit of {number(limit)}{unit}{thick}"
    bound = "at least" if _is_lower(binding) else "at most"
    return f"{number(value)}{unit}, {bound} {number(limit)}{unit} is allowed"


def _is_lower(binding: Binding) -> bool:
    """Whether a limit is the least value that is allowed."""
    lower = binding.key is not None and binding.key.endswith("[0]")
    turned = binding.motor is not None and binding.motor.gain < 0.0 and ".limits" not in (binding.key or "")
    return lower != turned
