"""From a configuration to links and back, and where a target wants the end of the backbone."""

import math

from sinuous.kernels.chain import arc
from sinuous.kernels.chain.kinematics import compose, frame, put_frame
from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import (
    Array,
    Mat,
    Vec,
    add_scaled,
    dot,
    get_vec,
    mat_mat,
    mat_vec,
    put_vec,
    sub,
    vec_mat,
)
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.limits import project_segment
from sinuous.kernels.step.targets import direction_vector
from sinuous.kernels.tables import GOAL, MAX_LENGTH, MIN_LENGTH, ORIENTATION, TARGET_POSITION
from sinuous.methods.fabrik.links import Chain, cap_of, links


@kernel
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


@kernel
def axis_of(rotation: Mat) -> Vec:
    """The z axis of a frame: the tangent of the backbone."""
    return rotation[0][2], rotation[1][2], rotation[2][2]


@kernel
def _lay(chain: Chain, i: int, nx: float, ny: float, frames: Array, q: Array) -> None:
    """Write the segments of section i, bent towards (nx, ny), to `q` (n, 3) and `frames` (n + 1, 12)."""
    rotation, position = frame(frames, chain.first[i])
    for k in range(chain.first[i], chain.first[i + 1]):
        bend, length = chain.share[k] * chain.bends[i], chain.part[k] * chain.lengths[i]
        turn, shift = arc.pose(nx * bend, ny * bend, length)
        rotation, position = compose(rotation, position, turn, shift)
        put_frame(frames, k + 1, rotation, position)
        put_vec(q, k, 0, (nx * bend, ny * bend, length))


@kernel
def unfold(chain: Chain, frames: Array, q: Array) -> None:
    """Write the configuration that the chain stands for to `q` (n, 3), and its `frames` (n + 1, 12)."""
    for i in range(chain.bends.shape[0]):
        local = vec_mat(get_vec(chain.tangents, i + 1, 0), frame(frames, chain.first[i])[0])
        side = math.hypot(local[0], local[1])
        nx, ny = (local[0] / side, local[1] / side) if side > 0.0 else (1.0, 0.0)
        _lay(chain, i, nx, ny, frames, q)


@kernel
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


@kernel
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
