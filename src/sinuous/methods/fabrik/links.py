"""Forward and backward reaching for arcs: every section is two links that meet at the joint of its end tangents.

The tangents at the two ends of a planar section that turns by less than half a turn meet in one point, its virtual
joint. From there it is `near` back to where the section begins and `far` on to where it ends; for an arc of length L
and angle t both are `L tan(t / 2) / t` (Zhang et al. 2018, FABRIKc). So the tangent between two sections is the line
through their joints, and the heuristic of Aristidou & Lasenby (2011) applies: put the end on the target and lay the
links back to the base, each towards the joint before it (`reach_back`); put the beginning on the base and lay them
out to the tip, each towards the joint after it (`reach_out`); repeat.

Chosen here, because no paper that could be had says it:

- a section that can stretch is as long as brings its other end closest to where the pass before had put it, within
  its range (fitting the joints instead took ten times as many iterations);
- a bend beyond its limit, or beyond `STEEPEST`, is turned back into the cone about the tangent that the pass came
  from, so bends keep their limits always and it is the target that is missed;
- a target that asks for no direction is approached along the line from the last joint.

A section is one segment or several in a row; see `Chain`.
"""

import math
from collections import namedtuple

import numpy as np

from sinuous.kernels.chain import arc
from sinuous.kernels.chain.kinematics import compose, frame, put_frame
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import (
    Array,
    Mat,
    Vec,
    across,
    add_scaled,
    cross,
    dot,
    get_vec,
    mat_mat,
    mat_vec,
    norm,
    put_vec,
    scale,
    sub,
    vec_mat,
)
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.limits import bend_cap, project_segment
from sinuous.kernels.step.targets import direction_vector
from sinuous.kernels.tables import GOAL, MAX_LENGTH, MIN_LENGTH, ORIENTATION, TARGET_POSITION

Chain = namedtuple("Chain", "first share part points joints tangents bends lengths low high")
"""Sections from the base to the end that has a target, and what they have in common with segments.

`first` (m + 1,): section i is made of the segments `first[i]` to `first[i + 1]`. `share` (n,) and `part` (n,): of its
section's bend and of its section's length, what each segment has. `points` (m + 1, 3): ends of sections. `joints`
(m, 3), `tangents` (m + 1, 3), `bends` (m,), `lengths` (m,): where it is now. `low`, `high` (m,): range of the lengths.
"""

STEEPEST = 0.95 * math.pi
"""Most that a section may turn: at half a turn its tangents are parallel and the links infinite."""

SMALL = 1e-5
"""Bend below which a section's links are those of this bend; they differ by 1e-11 of its length at most."""


def carve_chain(buffer: Array, n: int, m: int) -> Chain:
    """Lay out a chain in `buffer` (at least 16 n + 7), for n segments in m sections, m at most n."""
    share, part, rest = buffer[:n], buffer[n : 2 * n], buffer[2 * n :]
    first, rest = rest[: m + 1].view(np.int64), rest[m + 1 :]
    points, rest = cut(rest, m + 1, 3)
    joints, rest = cut(rest, m, 3)
    tangents, rest = cut(rest, m + 1, 3)
    of, _ = cut(rest, 4, m)
    return Chain(first, share, part, points, joints, tangents, of[0], of[1], of[2], of[3])


def group(chain: Chain, segments: int, pieces: int, taper: float) -> None:
    """Make sections of `pieces` segments each, the last of what is left; fills `first` and `share`.

    Within a section the bends of its p segments go as `1 + taper (2 (j + 1/2) / p - 1)`, j = 0 ... p - 1.
    """
    for i in range(chain.bends.shape[0]):
        begin, end = i * pieces, min((i + 1) * pieces, segments)
        chain.first[i], chain.first[i + 1] = begin, end
        for k in range(begin, end):
            chain.share[k] = (1.0 + taper * (2.0 * (k - begin + 0.5) / (end - begin) - 1.0)) / (end - begin)


def links(chain: Chain, i: int, bend: float) -> tuple[float, float]:
    """Links `near` and `far` of section i at this bend, for a length of one.

    The end of the section, in the plane of its bend, is at (x, z); the tangents there meet where
    `near + far cos(bend) = z`, `far sin(bend) = x`.
    """
    turn = max(bend, SMALL)
    begin, end = chain.first[i], chain.first[i + 1]
    if end - begin == 1:
        half = math.tan(0.5 * turn) / turn
        return half, half
    x = z = angle = 0.0
    for k in range(begin, end):
        side, _, ahead = arc.point(chain.share[k] * turn, 0.0, chain.part[k])
        cosine, sine = math.cos(angle), math.sin(angle)
        x += cosine * side + sine * ahead
        z += cosine * ahead - sine * side
        angle += chain.share[k] * turn
    far = x / math.sin(turn)
    return z - far * math.cos(turn), far


def cap_of(chain: Chain, limits: Array, i: int, length: float) -> float:
    """Largest bend (rad) of section i at this length, by the `limits` (n, 7) of its segments."""
    cap = STEEPEST
    for k in range(chain.first[i], chain.first[i + 1]):
        own = bend_cap(limits, k, chain.part[k] * length)
        if own < cap * chain.share[k]:
            cap = own / chain.share[k]
    return cap


def unit_or(a: Vec, other: Vec) -> Vec:
    """`a` as a unit vector; `other` where it has no direction."""
    length = norm(a)
    return scale(1.0 / length, a) if length > 1e-300 else other


def angle_between(a: Vec, b: Vec) -> float:
    """Angle between two unit vectors."""
    return math.atan2(norm(cross(a, b)), dot(a, b))


def cone(axis: Vec, wanted: Vec, cap: float) -> tuple[Vec, float]:
    """The unit vector closest to `wanted` that is within the angle `cap` of `axis`, and its angle."""
    angle = angle_between(axis, wanted)
    if angle <= cap:
        return wanted, angle
    side = unit_or(add_scaled(wanted, -dot(wanted, axis), axis), across(axis)[0])
    return add_scaled(scale(math.cos(cap), axis), math.sin(cap), side), cap


def _length(chain: Chain, i: int, links_sum: Vec, wanted: Vec) -> float:
    """The length, within its range, with which section i comes closest to spanning `wanted`."""
    length = dot(wanted, links_sum) / dot(links_sum, links_sum)
    return min(max(length, chain.low[i]), chain.high[i])


def reach_back(chain: Chain, limits: Array, goal: Vec, aim: Vec, aimed: bool) -> None:
    """Lay the links from the `goal` back towards the base; `aim` is the tangent there, if it is asked for.

    `limits` (n, 7) are those of the segments. Where the base comes to be, and with which tangent, is as it comes out;
    `reach_out` begins with the right ones.
    """
    m = chain.bends.shape[0]
    end = goal
    z = aim if aimed else unit_or(sub(goal, get_vec(chain.joints, m - 1, 0)), get_vec(chain.tangents, m, 0))
    put_vec(chain.points, m, 0, goal)
    for j in range(m):
        i = m - 1 - j
        length = chain.lengths[i]
        _, far = links(chain, i, chain.bends[i])
        joint = add_scaled(end, -far * length, z)
        before = get_vec(chain.joints, i - 1, 0) if i > 0 else get_vec(chain.points, 0, 0)
        wanted = unit_or(sub(joint, before), get_vec(chain.tangents, i, 0))
        toward, bend = cone(z, wanted, cap_of(chain, limits, i, length))
        near, far = links(chain, i, bend)
        span = add_scaled(scale(near, toward), far, z)
        length = _length(chain, i, span, sub(end, get_vec(chain.points, i, 0)))
        put_vec(chain.joints, i, 0, add_scaled(end, -far * length, z))
        end, z = add_scaled(end, -length, span), toward
        put_vec(chain.points, i, 0, end)
        chain.bends[i], chain.lengths[i] = bend, length


def reach_out(chain: Chain, limits: Array, base: Vec, tangent: Vec, aim: Vec, aimed: bool) -> None:
    """Lay the links from the base, with its tangent, out to the tip; `limits` (n, 7) of the segments."""
    m = chain.bends.shape[0]
    begin, z = base, tangent
    put_vec(chain.points, 0, 0, base)
    put_vec(chain.tangents, 0, 0, tangent)
    for i in range(m):
        length = chain.lengths[i]
        near, _ = links(chain, i, chain.bends[i])
        joint = add_scaled(begin, near * length, z)
        after = get_vec(chain.joints, i + 1, 0) if i < m - 1 else get_vec(chain.points, m, 0)
        wanted = aim if aimed and i == m - 1 else unit_or(sub(after, joint), z)
        toward, bend = cone(z, wanted, cap_of(chain, limits, i, length))
        near, far = links(chain, i, bend)
        span = add_scaled(scale(near, z), far, toward)
        length = _length(chain, i, span, sub(get_vec(chain.points, i + 1, 0), begin))
        cap = cap_of(chain, limits, i, length)
        if bend > cap:  # a shorter segment may bend less
            toward, bend = cone(z, wanted, cap)
            near, far = links(chain, i, bend)
            span = add_scaled(scale(near, z), far, toward)
        put_vec(chain.joints, i, 0, add_scaled(begin, near * length, z))
        begin, z = add_scaled(begin, length, span), toward
        put_vec(chain.points, i + 1, 0, begin)
        put_vec(chain.tangents, i + 1, 0, z)
        chain.bends[i], chain.lengths[i] = bend, length


def fold(limits: Array, chain: Chain, frames: Array, stretch: bool, q: Array) -> None:
    """Lay the links over a configuration, as far as sections can have it; the inverse of `unfold`.

    `q` (n, 3; rad and length unit) is brought within `limits` (n, 7). Fills the chain, the `frames` (n + 1, 12) after
    the first, and `q` anew. With `stretch` the lengths of sections may change from then on.
    """
    for i in range(chain.bends.shape[0]):
        begin, end = chain.first[i], chain.first[i + 1]
        bx = by = total = 0.0
        for k in range(begin, end):
            ux, uy, length = project_segment(limits, k, q[k, 0], q[k, 1], q[k, 2])
            bx, by, total = bx + ux, by + uy, total + length
            chain.part[k] = length
        low, high = 0.0, math.inf
        for k in range(begin, end):
            chain.part[k] = chain.part[k] / total if total > 0.0 and end - begin > 1 else 1.0 / (end - begin)
            if chain.part[k] > 0.0:
                low, high = (
                    max(low, limits[k, MIN_LENGTH] / chain.part[k]),
                    min(high, limits[k, MAX_LENGTH] / chain.part[k]),
                )
        chain.lengths[i] = total
        chain.low[i], chain.high[i] = (low, high) if stretch else (total, total)
        bend = math.hypot(bx, by)
        chain.bends[i] = min(bend, cap_of(chain, limits, i, total))
        _lay(chain, i, bx / bend if bend > 0.0 else 1.0, by / bend if bend > 0.0 else 0.0, frames, q)
        rotation, position = frame(frames, begin)
        near, _ = links(chain, i, chain.bends[i])
        put_vec(chain.joints, i, 0, add_scaled(position, near * total, axis_of(rotation)))
        put_vec(chain.points, i, 0, position)
        put_vec(chain.tangents, i, 0, axis_of(rotation))
    rotation, position = frame(frames, q.shape[0])
    put_vec(chain.points, chain.bends.shape[0], 0, position)
    put_vec(chain.tangents, chain.bends.shape[0], 0, axis_of(rotation))


def axis_of(rotation: Mat) -> Vec:
    """The z axis of a frame: the tangent of the backbone."""
    return rotation[0][2], rotation[1][2], rotation[2][2]


def _lay(chain: Chain, i: int, nx: float, ny: float, frames: Array, q: Array) -> None:
    """Write the segments of section i, bent towards (nx, ny), to `q` (n, 3) and `frames` (n + 1, 12)."""
    rotation, position = frame(frames, chain.first[i])
    for k in range(chain.first[i], chain.first[i + 1]):
        bend, length = chain.share[k] * chain.bends[i], chain.part[k] * chain.lengths[i]
        turn, shift = arc.pose(nx * bend, ny * bend, length)
        rotation, position = compose(rotation, position, turn, shift)
        put_frame(frames, k + 1, rotation, position)
        put_vec(q, k, 0, (nx * bend, ny * bend, length))


def unfold(chain: Chain, frames: Array, q: Array) -> None:
    """Write the configuration that the chain stands for to `q` (n, 3), and its `frames` (n + 1, 12)."""
    for i in range(chain.bends.shape[0]):
        local = vec_mat(get_vec(chain.tangents, i + 1, 0), frame(frames, chain.first[i])[0])
        side = math.hypot(local[0], local[1])
        nx, ny = (local[0] / side, local[1] / side) if side > 0.0 else (1.0, 0.0)
        _lay(chain, i, nx, ny, frames, q)


def end_goal(problem: Problem, frames: Array) -> tuple[Vec, Vec, bool]:
    """Where the target wants the end of the backbone, its tangent there, and whether that is asked for.

    A tool is brought along with the end that the robot has now, by its `frames` (n + 1, 12), turned by the least
    rotation that points the tool where it is wanted; without a tool this is the target itself.
    """
    goal = get_vec(problem.targets, 0, TARGET_POSITION)
    rotation, _ = frame(frames, frames.shape[0] - 1)
    aimed = problem.targets[0, ORIENTATION] != 0.0
    offset, shift = frame(problem.tool, 0)
    if aimed:
        wanted = get_vec(problem.targets, 0, GOAL)
        if offset[2][2] == 1.0 and shift[0] == 0.0 and shift[1] == 0.0:
            return add_scaled(goal, -shift[2], wanted), wanted, True
        turn = direction_vector(axis_of(mat_mat(rotation, offset)), wanted)
        rotation = mat_mat(rotation_of(turn), rotation)
    return sub(goal, mat_vec(rotation, shift)), axis_of(rotation), aimed


def rotation_of(turn: Vec) -> Mat:
    """The rotation by a rotation vector (Rodrigues)."""
    square = dot(turn, turn)
    S, G, _, _ = arc.coefficients(square)
    cosine = 1.0 - G * square
    x, y, z = turn
    return (
        (cosine + G * x * x, G * x * y - S * z, G * x * z + S * y),
        (G * x * y + S * z, cosine + G * y * y, G * y * z - S * x),
        (G * x * z - S * y, G * y * z + S * x, cosine + G * z * z),
    )
