"""Starts that come through free space: ways from the base to a target, and the chain laid into them."""

import math

from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.clock import now
from sinuous.kernels.compile import entry, kernel
from sinuous.kernels.fields.distances import Scene, closest
from sinuous.kernels.fields.solids import ABOVE, EXACT, STEP
from sinuous.kernels.fitting.fit import lay
from sinuous.kernels.freespace.band import points_wanted, respace, span, tighten, trace
from sinuous.kernels.freespace.grid_astar import (
    CLOSED,
    FOUND,
    HALF_DIAGONAL,
    Corridor,
    Lattice,
    carve_lattice,
    clear,
    explore,
    restart,
    surcharge,
)
from sinuous.kernels.maths.vectors import ZERO, Array, Vec, add_scaled, copy, norm, sub
from sinuous.kernels.problem import Problem, read_problem
from sinuous.kernels.solve.verdicts import backbone_end
from sinuous.kernels.step.states import carve, pick
from sinuous.kernels.step.targets import end_segment, tangent_back
from sinuous.kernels.tables import MAX_BEND, MAX_LENGTH, MIN_LENGTH, RADIUS

PROVED_CLOSED = -1
"""In place of how a search ended: it was closed, and so it is for any robot of this radius, whatever its tangents."""

HASTE = 2.0
"""See `lattice.Corridor`: among obstacles a way costs more than its length, and an honest guess looks at far more."""

CARE = 0.2
"""See `lattice.Corridor`: little, because who shuns narrow places looks at all the room around them first."""

DETOUR = 2.0
"""Surcharge on cubes near a way that is known already."""


@kernel
def _straight(scene: Scene, place: Vec, axis: Vec, past: float, most: float, radius: float) -> Vec:
    """The point farthest along `axis`, from `past` up to `most`, that a body can reach straight."""
    way = past
    for i in range(1, 17):
        further = past + (most - past) * i / 16.0
        d, _ = closest(scene, add_scaled(place, further, axis), radius, STEP)
        if d < radius:
            break
        way = further
    return add_scaled(place, way, axis)


@kernel
def _measures(problem: Problem, last: int) -> tuple[float, float, float]:
    """Of the segments up to `last`: the smallest radius, the greatest length, and the tightest turn."""
    radius, reach, turn = math.inf, 0.0, math.inf
    for k in range(last + 1):
        radius = min(radius, problem.limits[k, RADIUS])
        low, high, bend = problem.limits[k, MIN_LENGTH], problem.limits[k, MAX_LENGTH], problem.limits[k, MAX_BEND]
        reach += high
        if bend > 0.0 and high > 0.0:
            turn = min(turn, (low if low > 0.0 else high) / bend)
    return radius, reach, min(turn, 0.25 * reach)


@kernel
def _lead(problem: Problem, last: int, length: float) -> float:
    """How far the robot runs straight ahead on a way of this length: its first segments, as far as they cannot bend."""
    low = high = others = 0.0
    leading = True
    for k in range(last + 1):
        leading = leading and problem.limits[k, MAX_BEND] == 0.0
        if leading:
            low += problem.limits[k, MIN_LENGTH]
            high += problem.limits[k, MAX_LENGTH]
        else:
            others += 0.5 * (problem.limits[k, MIN_LENGTH] + problem.limits[k, MAX_LENGTH])
    return min(high, max(low, length - others))


@kernel
def _corridor(
    problem: Problem, which: int, last: int, cell: float, least: float, room: float, lead: float, barred: bool, how: int
) -> Corridor:
    rotation, base = frame(problem.base, 0)
    axis = (rotation[0][2], rotation[1][2], rotation[2][2])
    radius, reach, turn = _measures(problem, last)
    goal, around = backbone_end(problem, which, last)
    back = tangent_back(problem.targets, which) if around == 0.0 else ZERO
    most = max(problem.mount, lead) + 0.5 * turn
    start = _straight(problem.scene, base, axis, problem.mount, most, radius)
    end = _straight(problem.scene, goal, back, 0.0, 0.5 * turn, radius) if norm(back) > 0.0 else goal
    longest = reach - norm(sub(start, base)) - norm(sub(end, goal)) + around + cell
    close = 0.9 * cell
    turn = 0.5 * turn if barred else 0.0
    return Corridor(
        base, cell, least, radius, room, reach, start, axis, end, back, turn, around, close, HASTE, CARE, longest, how
    )


@kernel
def _closed(
    problem: Problem, lattice: Lattice, which: int, last: int, cell: float, clock: Array, deadline: float
) -> tuple[int, int]:
    """Prove that no curve of the body's radius leads from the mount to the target, if it is so: how it ended, cubes."""
    _, base = frame(problem.base, 0)
    radius, reach, _ = _measures(problem, last)
    goal, around = backbone_end(problem, which, last)
    around += problem.position_tolerance + 1e-9 * problem.unit
    least = radius - HALF_DIAGONAL * cell
    corridor = Corridor(
        base,
        cell,
        least,
        radius,
        radius,
        reach,
        base,
        ZERO,
        goal,
        ZERO,
        0.0,
        around,
        problem.mount + HALF_DIAGONAL * cell,
        1.0,
        1.0,
        math.inf,
        ABOVE,
    )
    clear(lattice)
    ended, _, cubes = explore(lattice, corridor, problem.scene, clock, deadline, 0)
    return PROVED_CLOSED if ended == CLOSED else ended, cubes


@entry
def find(
    robot: Array,
    scene: Array,
    settings: Array,
    targets: Array,
    which: int,
    cell: float,
    least: float,
    room: float,
    exact: bool,
    prove: bool,
    seconds: float,
    buffer: Array,
    slots: int,
    lattice_buffer: Array,
    raw: Array,
    ways: Array,
    counts: Array,
    starts: Array,
) -> tuple[int, int, int, float]:
    """Fill `starts` (m, n, 3) with the chain laid into up to m ways to target number `which`.

    Fills `ways` (m, K, 3) with the ways, of `counts` points each. Cubes have the edge `cell` and are passable with a
    distance of `least`; `room` beyond the body's radius costs nothing. With `exact` no samples stand in for distances.
    Where no way is found, and with `prove`, it is tried to prove that there is none. Returns how many, how the last
    search ended (see `lattice.explore`, PROVED_CLOSED), how many cubes it looked at, and the seconds that it took.
    """
    problem = read_problem(robot, scene, settings, targets)
    states, work = carve(buffer, problem)
    lattice = carve_lattice(lattice_buffer, slots)
    clear(lattice)
    began = now(work.clock)
    deadline = began + seconds
    last = end_segment(targets, which, problem.limits.shape[0])
    goal, _ = backbone_end(problem, which, last)
    how = EXACT if exact else STEP
    lead, barred = 0.0, True
    corridor = _corridor(problem, which, last, cell, least, room, lead, barred, how)
    count = cubes = 0
    ended = FOUND
    straight = False
    while count < starts.shape[0]:
        ended, slot, cubes = explore(lattice, corridor, problem.scene, work.clock, deadline, cubes)
        if ended == CLOSED and count == 0 and barred:
            barred = False
            corridor = _corridor(problem, which, last, cell, least, room, lead, barred, how)
            clear(lattice)
            cubes = 0
            continue
        if ended != FOUND:
            break
        points = trace(lattice, corridor, slot, goal, raw)
        if points == 0:
            break
        way = ways[count]
        wanted = points_wanted(span(raw, points), cell, way.shape[0])
        respace(raw, points, way, wanted)
        gap = tighten(problem.scene, corridor, way, raw, wanted, norm(corridor.back) == 0.0)
        ahead = _lead(problem, last, gap * (wanted - 1))
        if not straight and ahead > problem.mount:
            straight, lead = True, ahead
            corridor = _corridor(problem, which, last, cell, least, room, lead, barred, how)
            clear(lattice)
            cubes = 0
            continue
        counts[count] = wanted
        at = lay(problem, states, work, way, wanted, gap)
        copy(pick(states, at).q, starts[count])
        count += 1
        surcharge(lattice, corridor, slot, DETOUR, 2)
        restart(lattice)
    if ended == CLOSED and count == 0 and prove:
        ended, cubes = _closed(problem, lattice, which, last, cell, work.clock, deadline)
    return count, ended, cubes, now(work.clock) - began
