"""How far a loaded body leaves the straight way between two of its shapes, while its motors run evenly: a proof.

From state `x0` at one drive to `x1` at another, let `x(s)` be linear. The equilibrium at `s` is the root of the
gradient `r(y; s)` of the energy. In the norm `|u|^2 = sum m_j u_j^2`, m the stiffness of every coordinate:

- `r(x(s); s)` is looked at in places of s; between two it is at most 1/8 of its largest second derivative more: R;
- where `u' H u >= c |u|^2` for the second derivative H of the energy all around, y of `|y - x(s)| <= rho`, and
  `R <= c rho`, there is exactly one root in that ball at every s (Kantorovich; monotone operators), and it is within
  `R / c`. As the roots go on steadily, they are the equilibria that the body passes through.

A drive on a parabola leaves the straight line, and takes the state without load with it: `x(s)` and `q(s)` are moved
aside together, and R and c hold as far aside as they come.

c is the least eigenvalue half-way, less what third derivatives can change. All of them are bounded by one rule: a
tangent of the body is a product of rotations, whose m-th derivative along `u` is at most `A^m`, A the sum of the angles
of u up to there. A line that follows the arcs pulls with a convex energy, where nothing twists, however taut it is.
"""

from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.statics import layout as t
from sinuous.model.robot import Robot
from sinuous.statics.body import Tables, body_of
from sinuous.statics.rest import Rest, Way

GROWTH = (1.25, 1.6, 2.5, 4.0)
"""Radii of the ball that are tried, in `R / c` of the first guess."""

PARTS = 4
"""Parts of the way between whose ends the gradient of the energy is looked at."""


class EndBounds(NamedTuple):
    """What bounds are made of: greatest values of both ends, and changes between them, of all arcs (N,) each.

    Attributes
    ----------
    bend, rest, twist, length : ndarray
        Sizes of bends (rad) with and without load, twists (rad) and lengths.
    bend_change, rest_change, twist_change, length_change : ndarray
    soft : ndarray (N, 3)
        Compliance of bend, twist and stretch, the greatest of both ends; 0 of what is rigid.
    growth : ndarray (N,)
        Change of the length without load, relative to the least; 0 of what is rigid.
    """

    bend: Floats
    rest: Floats
    twist: Floats
    length: Floats
    bend_change: Floats
    rest_change: Floats
    twist_change: Floats
    length_change: Floats
    soft: Floats
    growth: Floats


def bounded(robot: Robot) -> bool:
    """Whether the way of this robot between loaded shapes can be bounded: lines follow arcs that do not twist."""
    own = body_of(robot)
    twists = np.isfinite(own.stiffness[:, 1])
    within = np.arange(len(robot))
    through = (within >= own.lines.sections[:, :1]) & (within <= own.lines.sections[:, 1:])
    return not own.lines.straight.any() and not (through & twists).any()


def bounded_aside(robot: Robot) -> bool:
    """Whether it can also be bounded where the drive leaves the straight line: nothing stretches lines by itself."""
    return robot.drive.elastic is None and bounded(robot)


class Bows(NamedTuple):
    """How far the drive takes arcs (N,) aside of the straight way, at most.

    Attributes
    ----------
    bend, length : ndarray
        Sizes, rad and lengths.
    growth : ndarray
        The latter, relative to the least length there.
    """

    bend: Floats
    length: Floats
    growth: Floats


class Weights(NamedTuple):
    """Weights (N,) that the directions of arcs carry, at most, and how much these change, on the way and aside of it.

    Attributes
    ----------
    beyond, change, aside : ndarray
    offsets : ndarray
        Moments of what is carried beside the backbone, at the arcs at whose ends it is.
    share, long : ndarray
        The sum of angles up to an arc, and the change of its length, are at most so many times the size of a change.
    """

    beyond: Floats
    change: Floats
    aside: Floats
    offsets: Floats
    share: Floats
    long: Floats


class Leave(NamedTuple):
    """By how much a body leaves a way. Infinite: not bounded.

    Attributes
    ----------
    aside : float
        Any place of it.
    turn : float
        How far its end is turned, rad.
    state : float
        Its state, in the norm above.
    """

    aside: float
    turn: float
    state: float = 0.0


UNBOUNDED = Leave(np.inf, np.inf, np.inf)


def leave(one: Rest, other: Rest, bow: Floats | None = None) -> Leave:
    """How far the body leaves the way that is linear in `Rest.arcs`.

    Parameters
    ----------
    one, other : Rest
        Both in equilibrium, of one robot.
    bow : ndarray (n, 3), optional
        How far a drive on a parabola leaves the straight line between both, at most: every bend (rad) and length.
        Tendons that stretch are not bounded then: their stretch is not linear in the drive.
    """
    if one is other and bow is None:
        return Leave(0.0, 0.0)
    if not (bounded(one.robot) if bow is None else bounded_aside(one.robot)):
        return UNBOUNDED
    bows = _bows(one, other, np.zeros_like(one.q) if bow is None else bow)
    ends = _widened(_ends(one, other), bows)
    weights = _weights(one, other, bows, ends.soft)
    share, long = weights.share, weights.long
    way = Way(one, other)
    middle, gradient, softness = way.look(0.5, True)
    gradients = [gradient, *(way.look(i / PARTS)[1] for i in range(1, PARTS) if 2 * i != PARTS)]
    sizes = ends.soft[:, [0, 0, 1, 2]]
    seen = max(float(np.sqrt((sizes * each**2).sum())) for each in gradients)
    more = (_elastic(ends) + _pull(ends, weights)) / (8.0 * PARTS**2)
    left = seen + more + _slackening(one, other, ends) + _aside(ends, bows, weights)
    least = _least_eigenvalue(middle, softness)
    if not least > 0.0:
        return UNBOUNDED
    bent = np.cumsum(bows.bend)
    turns = np.cumsum(_unrolled(ends)) + bent
    for growth in GROWTH:
        radius = growth * left / least
        sure = _sure(ends, least, radius, weights)
        if left <= sure * radius:
            off = left / sure
            aside = off * ((ends.length + long * off) * share + long).sum() + (ends.length * turns + bows.length).sum()
            return Leave(float(aside), float(off * share[-1] + turns[-1]), off)
    return UNBOUNDED


def stretches_between(one: Rest, other: Rest, left: Leave) -> Floats:
    """Least and most (t, 2) that lines stretch on the way between two shapes, which the body leaves by so much.

    What a line would stretch by is linear in the state, and in the drive, which runs evenly; it is negative where the
    line is slack.
    """
    ends = np.array([_stretches(each) for each in (one, other)])
    soft = _ends(one, other).soft
    reach = left.state * np.array([_felt_by(line, soft) for line in one.tables.lines])
    return np.stack([ends.min(axis=0) - reach, ends.max(axis=0) + reach], axis=1)


def _stretches(rest: Rest) -> Floats:
    """What lines (t,) stretch by, negative of slack ones."""
    lines = enumerate(zip(rest.tables.lines, rest.tensions, strict=True))
    pulled = [own if line[t.PUSHES] > 0.0 or own > 0.0 else _slack(rest, i) for i, (line, own) in lines]
    return np.array(pulled) * rest.tables.lines[:, t.COMPLIANCE]


def _felt_by(line: Floats, soft: Floats) -> float:
    """By how much a line stretches at most for a change of the state by 1, in the norm above."""
    through = slice(int(line[t.FIRST_ARC]), int(line[t.LAST_ARC]) + 1)
    arm = float(np.hypot(line[t.ARM], line[t.ARM + 1]))
    return float(np.sqrt((arm * arm * soft[through, 0] + soft[through, 2]).sum()))


def _ends(one: Rest, other: Rest) -> EndBounds:
    assert one.states is not None
    assert other.states is not None
    states, arcs = np.stack([one.states, other.states]), np.stack([one.tables.arcs, other.tables.arcs])
    rests = arcs[..., t.REST_X : t.REST_LENGTH]
    change, size = states[1] - states[0], np.abs(states).max(axis=0)
    with np.errstate(divide="ignore"):
        soft = 1.0 / arcs[..., : t.REST_X].min(axis=0)
    length = arcs[..., t.REST_LENGTH]
    return EndBounds(
        np.hypot(states[..., 0], states[..., 1]).max(axis=0),
        np.hypot(rests[..., 0], rests[..., 1]).max(axis=0),
        size[:, t.TWIST],
        size[:, t.LENGTH],
        np.hypot(change[:, 0], change[:, 1]),
        np.hypot(*(rests[1] - rests[0]).T),
        np.abs(change[:, t.TWIST]),
        np.abs(change[:, t.LENGTH]),
        soft,
        soft.any(axis=1) * np.abs(length[1] - length[0]) / np.maximum(length.min(axis=0), 1e-300),
    )


def _bows(one: Rest, other: Rest, bow: Floats) -> Bows:
    own = body_of(one.robot)
    bend, length = np.hypot(bow[:, 0], bow[:, 1]) / own.counts, np.abs(bow[:, 2]) / own.counts
    least = np.minimum(one.q[:, 2], other.q[:, 2]) / own.counts - length
    growth = np.where(length > 0.0, length / np.maximum(least, 1e-300), 0.0)
    return Bows(bend[own.owners], length[own.owners], growth[own.owners])


def _widened(ends: EndBounds, bows: Bows) -> EndBounds:
    """The same of ways that are so far aside, either way."""
    bend, length, growth = bows.bend, bows.length, bows.growth * ends.soft.any(axis=1)
    return ends._replace(
        bend=ends.bend + bend,
        rest=ends.rest + bend,
        length=ends.length + length,
        bend_change=ends.bend_change + 2.0 * bend,
        rest_change=ends.rest_change + 2.0 * bend,
        length_change=ends.length_change + 2.0 * length,
        soft=ends.soft * (1.0 + growth)[:, None],
        growth=ends.growth + 2.0 * growth * (1.0 + ends.growth),
    )


def _weights(one: Rest, other: Rest, bows: Bows, soft: Floats) -> Weights:
    loads, count = one.tables.loads, len(soft)  # what is carried is the same at both ends
    at, pulls = loads[:, t.LOAD_ARC].astype(int), np.linalg.norm(loads[:, t.FORCE : t.MOMENT], axis=1)
    carried, offsets = np.zeros(count), np.zeros(count)
    np.add.at(carried, at, pulls)
    np.add.at(offsets, at, pulls * np.linalg.norm(loads[:, t.LOAD_OFFSET :], axis=1))
    both, aside = [], np.zeros(count)
    for each in (one, other):
        own = np.linalg.norm(each.tables.arcs[:, t.WEIGHT :], axis=1)
        aside = np.maximum(aside, np.cumsum((own * bows.growth)[::-1])[::-1])
        both.append(np.cumsum((own + carried)[::-1])[::-1])
    share, long = np.sqrt(np.cumsum(soft[:, 0] + soft[:, 1])), np.sqrt(soft[:, 2])
    change = np.abs(both[1] - both[0]) + 2.0 * aside
    return Weights(np.maximum(*both) + aside, change, aside, offsets, share, long)


def _stiffness(ends: EndBounds) -> Floats:
    """Stiffness (N, 3) of bend, twist and stretch, the greatest on the way; 0 of what is rigid."""
    soft = ends.soft
    return (1.0 + ends.growth)[:, None] * np.divide(1.0, soft, out=np.zeros_like(soft), where=soft > 0.0)


def _second(first: Floats, value: Floats, once: Floats, twice: Floats) -> Floats:
    """Second derivative of a stiffness that goes with 1 / length, times something; in units of that stiffness.

    `first`: relative growth; `value`, `once` and `twice` bound the other factor and its derivatives.
    """
    return twice + 2.0 * first * once + 2.0 * first * first * value


def _elastic(ends: EndBounds) -> float:
    """Second derivative by s of the moments and forces of the arcs themselves, in the dual norm."""
    v, c, dv, dc = ends.bend, ends.rest, ends.bend_change, ends.rest_change
    twists = ends.soft[:, 1] > 0.0
    tau, dtau = np.where(twists, ends.twist, 0.0), np.where(twists, ends.twist_change, 0.0)
    g, soft, stiff = ends.growth, ends.soft, _stiffness(ends)
    twice = 0.25 * c * dtau**2 + dc * dtau
    bend = stiff[:, 0] * _second(g, v + c, dv + dc + 0.5 * c * dtau, twice)
    once = 0.5 * (dv * c + v * dc + 0.5 * v * c * dtau)
    twice = 0.5 * (2.0 * dv * dc + (dv * c + v * dc) * dtau + 0.25 * v * c * dtau**2)
    turn = stiff[:, 0] * _second(g, 0.5 * v * c, once, twice) * twists + stiff[:, 1] * _second(g, tau, dtau, 0.0 * tau)
    pull = stiff[:, 2] * _second(g, ends.length, 2.0 * ends.length_change, 0.0 * tau)
    return float(np.sqrt((soft * np.stack([bend, turn, pull], axis=1) ** 2).sum()))


def _pull(ends: EndBounds, weights: Weights) -> float:
    """The same of weights and payloads."""
    beyond, change, _, offsets, share, long = weights
    A, dl = _angles(ends), ends.length_change
    once = ends.length * A * share + dl * share + A * long
    twice = ends.length * A**2 * share + 2.0 * dl * A * share + A**2 * long
    return float((beyond * twice + 2.0 * change * once + offsets * A**2 * share).sum())


def _angles(ends: EndBounds) -> Floats:
    """Sum of the angles by which the body changes, up to the end of every arc (N,)."""
    return np.cumsum(ends.bend_change + ends.twist_change)


def _aside(ends: EndBounds, bows: Bows, weights: Weights) -> float:
    """By how much the gradient of the energy changes aside of the straight way, in the dual norm."""
    b, dl, g = bows
    v, c, soft, stiff = ends.bend, ends.rest, ends.soft, _stiffness(ends)
    beyond, _, lost, offsets, share, long = weights
    twists = soft[:, 1] > 0.0
    bend = stiff[:, 0] * (2.0 * b + g * (v + c))
    turn = 0.5 * stiff[:, 0] * (b * (v + c) + g * v * c) * twists + stiff[:, 1] * g * ends.twist
    pull = stiff[:, 2] * g * ends.length
    elastic = np.sqrt((soft * np.stack([bend, turn, pull], axis=1) ** 2).sum())
    angles = np.cumsum(b)
    moved = ends.length * angles * share + dl * share + angles * long
    lighter = lost * (ends.length * share + long)
    return float(elastic + (beyond * moved + lighter + offsets * angles * share).sum())


def _slackening(one: Rest, other: Rest, ends: EndBounds) -> float:
    """By how much tensions leave the straight line where lines become slack or taut on the way, in the dual norm."""
    lines, total = one.tables.lines, 0.0
    for i, line in enumerate(lines):
        if line[t.PUSHES] > 0.0 or line[t.HELD] == 0.0:
            continue
        tensions = [each.tensions[i] if each.tensions[i] > 0.0 else _slack(each, i) for each in (one, other)]
        most, least = max(tensions), min(tensions)
        if most > 0.0 > least:
            total += _felt_by(line, ends.soft) * most * -least / (most - least)
    return total


def _slack(rest: Rest, i: int) -> float:
    """Tension that a slack line would have if it could push, negative."""
    assert rest.states is not None
    line, states = rest.tables.lines[i], rest.states
    through = slice(int(line[t.FIRST_ARC]), int(line[t.LAST_ARC]) + 1)
    long = states[through, t.LENGTH] - states[through, :2] @ line[t.ARM : t.ARM + 2]
    return min(0.0, float(long.sum() - line[t.LINE_VALUE]) / float(line[t.COMPLIANCE]))


def _least_eigenvalue(tables: Tables, softness: Floats) -> float:
    """Least eigenvalue of the second derivative, relative to the stiffness of the arcs; at most 1."""
    root = np.sqrt(np.stack([tables.arcs[:, max(0, j - 1)] for j in range(4)], axis=1).ravel())
    gives = np.flatnonzero(np.isfinite(root))
    values = np.linalg.eigvalsh(softness[np.ix_(gives, gives)] * root[gives] * root[gives][:, None])
    return 0.0 if values[0] <= 0.0 else min(1.0, 1.0 / float(values[-1]))


def _sure(ends: EndBounds, least: float, radius: float, weights: Weights) -> float:
    """Lower bound of the eigenvalues anywhere in the ball, at any time, in the norm of the softest stiffness.

    Half-way they are at `least`, and nothing is farther from there than half of the changes.
    """
    beyond, change, _, offsets, share, long = weights
    soft, stiff = ends.soft, _stiffness(ends)[:, 0]
    ends, change = _half(ends), 0.5 * change
    g = ends.growth
    angles = _angles(ends) + share * radius
    stretch = ends.length_change + long * radius
    length = ends.length + long * radius
    turned = beyond * (length * angles * share**2 + stretch * share**2 + 2.0 * long * angles * share)
    lighter = change * (length * share**2 + 2.0 * long * share)
    total = float((turned + lighter + offsets * angles * share**2).sum())
    twisted = ends.twist_change + np.sqrt(soft[:, 1]) * radius
    bent, c = ends.bend + np.sqrt(soft[:, 0]) * radius, ends.rest
    cross = 0.5 * (ends.rest_change + 0.5 * c * twisted + g * c)
    bent_change = ends.bend_change + np.sqrt(soft[:, 0]) * radius
    even = 0.25 * (bent_change * c + bent * ends.rest_change + 0.5 * bent * c * twisted + g * bent * c)
    coupled = stiff * (cross * np.sqrt(soft[:, 0] * soft[:, 1]) + even * soft[:, 1])
    return 1.0 + (least - 1.0) * (1.0 + float(g.max())) - total - float(coupled.max())


def _half(ends: EndBounds) -> EndBounds:
    """The same with half of the changes."""
    names = ("bend_change", "rest_change", "twist_change", "length_change", "growth")
    return ends._replace(**{name: 0.5 * getattr(ends, name) for name in names})


def _unrolled(ends: EndBounds) -> Floats:
    """By how much bends (N,), turned so that no arc is twisted, leave the straight way between both ends."""
    rolled = np.cumsum(ends.twist_change) - ends.twist_change
    return 0.125 * (ends.bend * rolled**2 + 2.0 * ends.bend_change * rolled)
