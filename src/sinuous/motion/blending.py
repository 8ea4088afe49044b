"""The geometry of a path: straight pieces in configuration space, and parabolas that blend its corners.

A piece is `c0 + c1 s + c2 s^2` for s from 0 to its length. All pieces together have a continuous slope, except in
corners that are not blended. Under load it is a path of the drive, and corners are as round as the bound of
`statics.between` shows that the loaded body stays near its way.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.solver.certificates.steps import Steps
from sinuous.statics.between import bounded_aside, leave
from sinuous.statics.rest import Rest

STRAIGHT = 1e-9
"""Steps are one leg where no place of the body leaves them by more, in lengths of the body at its longest."""

ROUNDED = 1e-14
"""The same where less is proved to be free, and under load: the rounding of knots in one line."""

KEPT = 0.5
"""Share of the proved clearance that rounding a corner leaves."""

NOTHING = 1e-12
"""A straight piece between two blends is left out where it is no longer, of its leg: the rounding of its length."""

SHORT = 1e-6
"""A corner is not rounded where that would take less than so great a share of a step."""

PARTS = 8
"""Parts of a rounded corner at whose ends it is seen where the loaded body is; an even number."""

TRIES, NARROWER, WIDEST = 12, 0.1, 0.9
"""Arms that are tried under load, and the shares of one that the next may be."""


@dataclass(frozen=True)
class BlendedPath:
    """A path of pieces, each a polynomial of degree 2 in its length s.

    Attributes
    ----------
    pieces : ndarray (P, 3, n, 3)
        Coefficients c0, c1, c2.
    lengths : ndarray (P,)
        Greater than 0.
    stops : ndarray (P + 1,) of bool
        Whether the slope jumps where a piece begins, or ends; also at both ends of the path.
    """

    pieces: Floats
    lengths: Floats
    stops: np.ndarray

    def at(self, piece: np.ndarray, s: Floats, order: int = 0) -> Floats:
        """Places (..., n, 3) on pieces (...), or their first or second derivative by s."""
        c0, c1, c2 = np.moveaxis(self.pieces[piece], -3, 0)
        along = np.asarray(s)[..., None, None]
        return (c0 + along * (c1 + along * c2), c1 + 2.0 * along * c2, 2.0 * c2)[order]


@dataclass(frozen=True)
class Legs:
    """The straight legs of a path: steps that move, neighbours in one direction joined.

    Attributes
    ----------
    corners : ndarray (L + 1, n, 3)
    margins : ndarray (L,)
        How far places of the body may leave a leg, by its proved clearances; 0 where nothing is proved.
    sizes : ndarray (L,)
        How far a place of the body moves on a leg at most.
    """

    corners: Floats
    margins: Floats
    sizes: Floats


def legs_of(robot: Robot, q: Floats, steps: Steps) -> Legs:
    """Return the legs of knots (T, n, 3) whose steps are proved so far; without any for a robot that stands still."""
    levers = levers_of(robot, q)
    moves = np.diff(q, axis=0)
    sizes = reach_of(moves, levers)
    moving = sizes > 0.0
    free = steps_margins(robot, q, steps)
    # Where nothing is proved, no clearance has to be kept.
    most = ROUNDED if robot.has_external_load else STRAIGHT
    allowed = np.clip(np.where(steps.proved, 0.5 * free, np.inf), ROUNDED * levers[0], most * levers[0])
    first = np.flatnonzero(moving)[_leg_starts(moves[moving], sizes[moving], allowed[moving], levers)]
    margins = np.minimum.reduceat(np.where(moving, free, np.inf), first) if len(first) else first
    corners = np.concatenate([q[first], q[-1:]])
    return Legs(corners, np.asarray(margins, np.float64), reach_of(np.diff(corners, axis=0), levers))


def _leg_starts(moves: Floats, sizes: Floats, allowed: Floats, levers: Floats) -> list[int]:
    """Return the numbers of the steps (m, n, 3) that begin a leg: the others go on in the direction of its first step.

    By the lengths that the direction of steps differs from that of the first one, their ends leave the line of the
    leg by no more than the sum of these, and its chord by no more than twice that. This stays below what is `allowed`
    (m,) on each step of the leg. Sizes, levers and `allowed` are in the length unit, see `reach_of`.
    """
    units = moves / sizes[:, None, None]
    # A step that turns by more than is allowed on its own begins a leg, whatever came before it.
    turning = 2.0 * reach_of(np.diff(units, axis=0), levers) * sizes[1:] > allowed[1:]
    ends = [*(np.flatnonzero(turning) + 1).tolist(), len(moves)]
    starts, first = [], 0
    for end in ends:
        while first < end:
            starts.append(first)
            first = _leg_end(units[first:end], sizes[first:end], allowed[first:end], levers) + first
    return starts


def _leg_end(units: Floats, sizes: Floats, allowed: Floats, levers: Floats) -> int:
    """Return how many of these steps, of which each goes on nearly as the one before, are one leg: one at least."""
    count = 1
    while count < len(units):  # twice as many at a time: legs are as often short as long
        count = min(2 * count, len(units))
        aside = 2.0 * np.cumsum(reach_of(units[:count] - units[0], levers) * sizes[:count])
        leaving = np.flatnonzero(aside > np.minimum.accumulate(allowed[:count]))
        if len(leaving):
            return max(1, int(leaving[0]))
    return count


def steps_margins(robot: Robot, q: Floats, steps: Steps) -> Floats:
    """How far places of the body may leave each step (m,) and still be clear of obstacles and of the body itself.

    Where all places move by m at most, clearances shrink by m, and gaps of the body by 2 m. Where segments stretch,
    under load too, which places are pi radii apart along the body changes too, by m at most, and with it the gap: 3 m
    in all. With several radii any move may change which places concern each other, unless the body turns by less than
    a quarter turn at both knots, of q (m + 1, n, 3): then it does so wherever it may get to, and no two places do. How
    far a loaded body turns between knots is not looked at.
    """
    if len(set(robot.self_radii)) == 1:
        stretching = robot.has_external_load or any(segment.length[0] < segment.length[1] for segment in robot.rows)
        own = steps.room[1] / (3.0 if stretching else 2.0)
    else:
        turned = np.hypot(q[..., 0], q[..., 1]).sum(axis=1)
        slight = np.maximum(turned[1:], turned[:-1]) < 0.5 * np.pi
        never = not robot.avoids_itself or slight & (not robot.has_external_load)
        own = np.where(never, np.inf, 0.0)
    return KEPT * np.where(steps.proved, np.minimum(steps.room[0], own), 0.0)


def cut_at_jumps(robot: Robot, legs: Legs) -> Legs:
    """Return the same legs, cut where motors of elastic actuators would jump from one speed to another."""
    elastic, shares = robot.drive.elastic, []
    assert elastic is not None
    for q, move in zip(legs.corners[:-1], np.diff(legs.corners, axis=0), strict=True):
        shares.append([0.0, *elastic.speeds.breaks(q, move)])
    leg = np.repeat(np.arange(len(shares)), [len(own) for own in shares])
    begin = np.concatenate(shares)
    long = np.diff(np.append(leg + begin, len(shares)))
    moves = (legs.corners[leg + 1] - legs.corners[leg]) * begin[:, None, None]
    corners = np.concatenate([legs.corners[leg] + moves, legs.corners[-1:]])
    return Legs(corners, legs.margins[leg], long * legs.sizes[leg])


def stop_at_corners(legs: Legs) -> BlendedPath:
    """Return the path with all its corners, at each of which the robot stops."""
    pieces = np.zeros((len(legs.sizes), 3, *legs.corners.shape[1:]))
    pieces[:, 0], pieces[:, 1] = legs.corners[:-1], np.diff(legs.corners, axis=0) / legs.sizes[:, None, None]
    return BlendedPath(pieces, legs.sizes, np.ones(len(legs.sizes) + 1, bool))


def blend_corners(robot: Robot, legs: Legs, most: float) -> BlendedPath:
    """Return the path with its corners blended, so that no place of the body leaves the legs by more than `most`.

    Nor by more than half of what is proved to be free. A parabola lies in the triangle of its corner, so it keeps all
    limits, which are convex; it is farthest from the legs in its middle, by a quarter of the sum of both arms. Where
    the path turns by a right angle or more, the robot stops. Under load the same holds of the loaded body, and of legs
    on which it is; the robot stops where nothing bounds it.
    """
    slopes = np.diff(legs.corners, axis=0) / legs.sizes[:, None, None]
    bends = np.diff(slopes, axis=0)
    allowed = np.minimum(most, np.minimum(legs.margins[1:], legs.margins[:-1]))
    arms = 4.0 * allowed / reach_of(bends, levers_of(robot, legs.corners))
    shorter = np.minimum(legs.sizes[1:], legs.sizes[:-1])
    back = np.einsum("lnk,lnk->l", slopes[1:], slopes[:-1]) <= 0.0
    arms = np.where(back, 0.0, np.minimum(arms, 0.5 * shorter))
    if robot.has_external_load:
        corners = zip(legs.corners[1:-1], slopes[:-1], slopes[1:], strict=True)
        allowed = np.where(bounded_aside(robot), allowed, 0.0)
        own = zip(corners, arms.tolist(), allowed.tolist(), (SHORT * shorter).tolist(), strict=True)
        arms = np.array([_arm_under_load(robot, corner, *numbers) for corner, *numbers in own])
    arms = np.concatenate([[0.0], np.where(arms < SHORT * shorter, 0.0, arms), [0.0]])
    pieces, lengths, stops = [], [], [True]
    for i, slope in enumerate(slopes):
        rest = legs.sizes[i] - arms[i] - arms[i + 1]
        if rest > NOTHING * legs.sizes[i]:
            pieces.append([legs.corners[i] + arms[i] * slope, slope, np.zeros_like(slope)])
            lengths.append(rest)
            stops.append(bool(arms[i + 1] == 0.0))
        if arms[i + 1] > 0.0:
            turn = bends[i] / (4.0 * arms[i + 1])
            pieces.append([legs.corners[i + 1] - arms[i + 1] * slope, slope, turn])
            lengths.append(2.0 * arms[i + 1])
            stops.append(False)
    return BlendedPath(np.array(pieces), np.array(lengths), np.array(stops))


Corner = tuple[Floats, Floats, Floats]
"""A drive (n, 3), and the slopes (n, 3) of the legs that lead there and on."""


def _arm_under_load(robot: Robot, corner: Corner, arm: float, allowed: float, least: float) -> float:
    """The greatest of some arms, from this one on, that keeps the loaded body near the legs; 0 where none does."""
    for _ in range(TRIES):
        if arm < least or allowed <= 0.0:
            return 0.0
        off = _off_legs(robot, corner, arm, allowed)
        if off <= allowed:
            return arm
        arm *= min(WIDEST, max(NARROWER, WIDEST * allowed / off))
    return 0.0


def _off_legs(robot: Robot, corner: Corner, arm: float, enough: float) -> float:
    """How far places of the loaded body are off the legs, at most, on the parabola of so long an arm.

    Each part of it is held against one of the legs: by the shapes at the ends of both, and by how far the body may
    leave the ways between them. Where the ends alone are more than `enough` apart that is all. Infinite: not known.
    """
    place, before, after = corner
    shares = np.linspace(0.0, 1.0, PARTS + 1)[:, None, None]
    along = arm * (2.0 * shares - 1.0)
    on_legs = place + np.where(along < 0.0, along * before, along * after)
    rounded = place + arm * (shares**2 * after - (1.0 - shares) ** 2 * before)
    middle = Rest(robot, place)
    back = _led(robot, middle, on_legs[PARTS // 2 - 1 :: -1])
    legs = [*back[::-1], middle, *_led(robot, middle, on_legs[PARTS // 2 + 1 :])]
    curve = [legs[0], *_led(robot, legs[0], rounded[1:])]
    if any(each.states is None for each in (*legs, *curve)):
        return np.inf
    both = np.array([[each.arcs for each in way] for way in (legs, curve)])
    levers = levers_of(robot, both.reshape(-1, *both.shape[2:]))
    off = float(reach_of(both[1] - both[0], levers).max())
    if off > enough:
        return off
    bow = arm * np.abs(after - before) / (4.0 * PARTS**2)
    ways = [(leave(*pairs[0]), leave(*pairs[1], bow)) for pairs in zip(pairwise(legs), pairwise(curve), strict=True)]
    return off + max(leg.aside + own.aside for leg, own in ways)


def _led(robot: Robot, begin: Rest, drives: Floats) -> list[Rest]:
    """Bodies at rest at drives (k, n, 3), each looked for from the one before."""
    found = []
    for drive in drives:
        begin = Rest(robot, np.ascontiguousarray(drive), begin)
        found.append(begin)
    return found


def levers_of(robot: Robot, q: Floats) -> Floats:
    """Length (n,) of the body from the beginning of every segment to the tip, and to the tool, at most."""
    longest = q[..., 2].max(axis=0)
    return np.cumsum(longest[::-1])[::-1] + float(np.linalg.norm(robot.tool[:3, 3]))


def reach_of(moves: Floats, levers: Floats) -> Floats:
    """How far a place of the body moves at most (m,) when configurations change by `moves` (m, n, 3).

    A bend turns what lies beyond it by at most as much as it changes.
    """
    return np.hypot(moves[..., 0], moves[..., 1]) @ levers + np.abs(moves[..., 2]).sum(axis=-1)
