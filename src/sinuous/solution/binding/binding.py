"""Which limits and obstacles hold the best configuration back, by the forces with which they do.

At the best configuration the pull of the targets is balanced by what stands against it (Karush, Kuhn & Tucker): the
gradient of the residual is a sum of the normals of limits and contacts that are met, with weights that are not
negative. These weights, the multipliers, are found by nonnegative least squares (Lawson & Hanson 1974), from the
linearisation at the configuration alone, so that a solve pays nothing for them. By as much as a multiplier says, the
residual shrinks when its limit is widened.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from sinuous.arguments import Constraint
from sinuous.checks import Floats
from sinuous.problem.problem import Problem
from sinuous.reprs import ShortRepr
from sinuous.robot.rates import Changes
from sinuous.solution.binding.contacts import Contact, contacts_of, self_contacts_of
from sinuous.solution.binding.limits import Limit, limits_of, normal
from sinuous.solution.binding.nonnegative import nonnegative_least_squares
from sinuous.solution.binding.pull import pull_of
from sinuous.solution.binding.rates import rates_of
from sinuous.solution.binding.rest import at_rest

ACTIVE, WIDER = 1e-6, (1e-3, 0.1)
"""Slack up to which a limit counts as met: rad, or lengths of a mean segment; and where none is, up to which then."""

LEAST = 1e-3
"""Force, as a share of the largest, below which it is taken for rounding."""

PARALLEL = 1.0 - 1e-9
"""Cosine of the angle between normals from which on two limits are the same in effect."""

DENSE = 4_000_000
"""Most numbers of the linear system; of more limits, those are kept that stand against the pull the most."""


@dataclass(frozen=True, repr=False)
class Binding(ShortRepr):
    """A limit or an obstacle that holds a configuration back.

    Attributes
    ----------
    constraint : str
        `length`, `bend`, `curvature`, `actuator`, `clearance` of an obstacle, or `self_clearance`; with `within` also
        `length_rate`, `bend_rate` or `actuator_rate`.
    segment : int or None
        1 = first.
    obstacle : str or None
        Name of the obstacle, for `clearance`.
    value, limit : float
        What the configuration has, and what is allowed: lengths, rad for `bend`, 1 / length for `curvature`; for rates
        the change from where it began.
    actuator : str or None
        Name of the tendon or chamber, for `actuator` and `actuator_rate`: `s1.t2`.
    key : str or None
        What the problem file calls the limit: `max_bend`, `length[1]` (the upper end), `rates.bend`.
    other_segment : int or None
        The segment that it touches, for `self_clearance`.
    """

    constraint: Constraint
    segment: int | None
    obstacle: str | None
    value: float
    limit: float
    actuator: str | None = None
    key: str | None = None
    other_segment: int | None = None

    @classmethod
    def of(cls, met: Limit | Contact) -> "Binding":
        """Make it of a limit or a contact."""
        if isinstance(met, Contact):
            kind: Constraint = "clearance" if met.other_segment is None else "self_clearance"
            return cls(kind, met.segment, met.obstacle, met.clearance, 0.0, other_segment=met.other_segment)
        return cls(met.constraint, met.segment, None, met.value, met.limit, met.actuator, met.key)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values, in the order of the file format."""
        keys = "constraint", "segment", "obstacle", "value", "limit", "actuator", "other_segment"
        return {key: getattr(self, key) for key in keys}


class _Column(NamedTuple):
    """A constraint that is met, and the force (3 n,) with which it would push."""

    met: Limit | Contact
    force: Floats


def find_binding(problem: Problem, q: Floats, any_limit: bool = False) -> tuple[Binding, ...]:
    """What holds the configuration `q` (n, 3) back, strongest first; empty when nothing does.

    Where the targets are met and the body overlaps an obstacle, that obstacle is the first, and the others are what
    keeps the body from coming free. Where no obstacle takes part, the configuration is first brought to rest. With
    `any_limit` at least one limit is named: if none takes part, the nearest one.
    """
    contacts = _all_contacts(problem, q)
    if not contacts:
        q = at_rest(problem, q)
    found = _balanced(problem, q, contacts, list(limits_of(problem.robot, q)))
    if any_limit and all(each.key is None for each in found):
        return (*found, *nearest_limits(problem, q, 1))
    return found


def rate_binding(problem: Problem, q: Floats, initial: Floats, within: Changes) -> tuple[Binding, ...]:
    """What holds `q` (n, 3) back, the best that is within some changes of `initial` (n, 3): rates are limits then."""
    rates = list(rates_of(problem.robot, q, initial, within))
    return _balanced(problem, q, _all_contacts(problem, q), [*rates, *limits_of(problem.robot, q)])


def _balanced(problem: Problem, q: Floats, touched: list[Contact], limits: list[Limit]) -> tuple[Binding, ...]:
    """Those of the contacts and limits whose forces balance the pull of the targets at `q` (n, 3)."""
    robot = problem.robot
    unit = robot.mean_length / len(robot)
    scale = np.tile([1.0, 1.0, unit], len(robot))
    contacts = [_Column(c, c.gradient * scale / robot.mean_length) for c in touched]
    pull = pull_of(problem, q)
    wanted, free = scale * (pull.misses @ pull.rows), np.empty((0, len(scale)))
    first: list[Limit | Contact] = []
    deepest = contacts[0].met if contacts else None
    if pull.met and isinstance(deepest, Contact) and deepest.clearance < 0.0:
        wanted, free, first = -deepest.clearance * contacts[0].force, pull.rows * scale, [deepest]
        contacts = [each for each in contacts if _name(each.met) != _name(deepest)]
    for slack in (ACTIVE, *WIDER):
        met = [_Column(each, -force) for each, force in _met_limits(limits, unit, slack)]
        forces = _forces(wanted, [*contacts, *met], free)
        if forces or first:
            break
    return _ranked(first, forces)


def nearest_limits(problem: Problem, q: Floats, count: int = 3) -> tuple[Binding, ...]:
    """The limits of which the configuration `q` (n, 3) has least left; what cannot move at all is left out."""
    unit = problem.robot.mean_length / len(problem.robot)
    parts = problem.robot.segments
    left: dict[tuple[Any, ...], tuple[float, Limit]] = {}
    for each in limits_of(problem.robot, q):
        own = parts[each.segment - 1]
        if own.max_bend == 0.0 if each.key == "max_bend" else each.constraint == "length" and np.ptp(own.length) == 0.0:
            continue
        share = each.slack / _size(each, unit)
        name = each.constraint, each.segment, each.actuator, each.key
        left[name] = min(left.get(name, (share, each)), (share, each), key=lambda pair: pair[0])
    nearest = sorted(left.values(), key=lambda pair: pair[0])[:count]
    return tuple(Binding.of(each) for _, each in nearest)


def _size(limit: Limit, unit: float) -> float:
    """Length of the normal of a limit."""
    return float(np.linalg.norm(normal(limit, unit)))


def _met_limits(limits: Iterable[Limit], unit: float, slack: float) -> Iterator[tuple[Limit, Floats]]:
    """Yield the limits that are met, and their unit normals (3 n,)."""
    for each in limits:
        size = _size(each, unit)
        if each.slack <= slack * size:
            yield each, normal(each, unit) / size


def _forces(wanted: Floats, columns: Sequence[_Column], free: Floats) -> list[tuple[float, Limit | Contact]]:
    """The forces that balance `wanted` (3 n,); rows of `free` (m, 3 n) may push and pull, and are not among them."""
    most = max(1, DENSE // len(wanted))
    kept = sorted(columns, key=lambda column: column.force @ wanted)[:most]
    if not kept or not wanted.any():
        return []
    system = np.column_stack([*(column.force for column in kept), *free, *-free])
    weights = nonnegative_least_squares(system, -wanted)[: len(kept)]
    forces = weights * np.linalg.norm(system[:, : len(kept)], axis=0)
    largest = max(forces.max(), LEAST * float(np.linalg.norm(wanted)))
    units = system[:, : len(kept)] / np.maximum(np.linalg.norm(system[:, : len(kept)], axis=0), 1e-300)
    found = []
    for i, force in enumerate(forces):
        # Limits that forbid the same motion share the force, whichever of them least squares chose.
        same = forces[units.T @ units[:, i] > PARALLEL]
        if max(force, same.max(initial=0.0)) > LEAST * largest:
            found.append((float(max(force, same.max(initial=0.0))), kept[i].met))
    return found


def _all_contacts(problem: Problem, q: Floats) -> list[Contact]:
    """Contacts with obstacles and of the body with itself, deepest first."""
    contacts = [*contacts_of(problem, q), *self_contacts_of(problem, q)]
    return sorted(contacts, key=lambda contact: contact.clearance)


def _name(met: Limit | Contact) -> tuple[Any, ...]:
    """What is told apart: every side of every limit, every obstacle, every pair of segments that touch."""
    if isinstance(met, Limit):
        return met.segment, met.actuator, met.key
    return (met.obstacle,) if met.other_segment is None else (met.segment, met.other_segment)


def _ranked(first: Sequence[Limit | Contact], forces: Sequence[tuple[float, Limit | Contact]]) -> tuple[Binding, ...]:
    """Bindings by the sums of their forces, strongest first; every limit and every obstacle once."""
    sums: dict[Any, float] = {}
    known: dict[Any, Limit | Contact] = {}
    for force, met in [*((math.inf, each) for each in first), *forces]:
        name = _name(met)
        sums[name] = sums.get(name, 0.0) + force
        known.setdefault(name, met)
    return tuple(Binding.of(known[name]) for name in sorted(sums, key=lambda name: -sums[name]))
