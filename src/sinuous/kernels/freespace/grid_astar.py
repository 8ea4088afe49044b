"""Ways through free space: shortest paths on a lattice of cubes that is made as the search goes.

A cube is passable when its middle is farther than `least` from every obstacle. With `radius - HALF_DIAGONAL * cell`
this is so wherever a point of the backbone can lie in it, because distance changes by at most the distance moved:
where the search runs dry then, there is no way, for any robot. A way that is found may still be too narrow, at a price:
cubes cost more the less room they leave. Cubes are looked up by hashing, and their distances are asked for when they
are first met: in a narrow place, that is seldom.
"""

import math
from collections import namedtuple

import numpy as np

from sinuous.kernels.clock import now
from sinuous.kernels.compile import kernel
from sinuous.kernels.fields.distances import Scene, closest
from sinuous.kernels.maths.vectors import Array, Vec, add_scaled, dot, norm, sub

HALF_DIAGONAL = 0.5 * math.sqrt(3.0)

FOUND, CLOSED, FULL, LATE = range(4)

HEAP_SHARE = 4
"""Places in the queue for each cube in the table."""

OFFSET = 1 << 20
"""Coordinates of cubes are counted from here, so that they are positive; twenty-one bits each."""

NONE = -1

SMOOTHED = 0.9
"""What is left of the length of a way when its corners are cut: cubes are left along 26 directions only."""

FINEST = 0.1
"""Shortest step in the search for a wall between two cubes, of the way between them."""

Lattice = namedtuple("Lattice", ["keys", "before", "cost", "length", "distance", "extra", "done", "priority", "queue"])
"""A hash table of cubes, by slot: key (0: empty), slot that the way comes from, cost and length of the way, distance of
the middle to the obstacles, what other ways ask as a surcharge, whether its cost is final; a binary heap of slots."""

Corridor = namedtuple(
    "Corridor",
    [
        "origin",
        "cell",
        "least",
        "radius",
        "room",
        "reach",
        "start",
        "axis",
        "goal",
        "back",
        "turn",
        "around",
        "close",
        "haste",
        "care",
        "longest",
        "how",
    ],
)
"""What a search is about. `origin`: the robot's base, and middle of the cube (0, 0, 0) of edge `cell`; no way is
farther from it than `reach`. `least` distance that is passable, `radius` of the body, `room` beyond it that costs
nothing. Ways run from within `close` of `start`, where they leave along `axis`, to within `around` of `goal`, where
`back` points to where they come from (zero: anywhere); within `turn` of both nothing passes behind their backs. With
`haste` 1 the cheapest way is found; with more, one that costs at most so many times as much, sooner; `care` says how
much dearer narrow places are, and ways that will be longer than `longest` are given up. Distances are
asked for as `how` says (see `solids`); a proof asks for upper bounds: what can be passed must not be called a wall."""


def lattice_size(slots: int) -> int:
    """Numbers (float64) that a lattice of so many slots, a power of two, takes."""
    return (7 + 2 * HEAP_SHARE) * slots


@kernel
def carve_lattice(buffer: Array, slots: int) -> Lattice:
    t, h = slots, HEAP_SHARE * slots
    return Lattice(
        buffer[:t].view(np.int64),
        buffer[t : 2 * t].view(np.int64),
        buffer[2 * t : 3 * t],
        buffer[3 * t : 4 * t],
        buffer[4 * t : 5 * t],
        buffer[5 * t : 6 * t],
        buffer[6 * t : 7 * t],
        buffer[7 * t : 7 * t + h],
        buffer[7 * t + h : 7 * t + 2 * h].view(np.int64),
    )


@kernel
def clear(lattice: Lattice) -> None:
    """Forget all cubes."""
    for i in range(lattice.keys.shape[0]):
        lattice.keys[i] = 0


@kernel
def restart(lattice: Lattice) -> None:
    """Forget all ways, but keep distances and surcharges."""
    for i in range(lattice.keys.shape[0]):
        if lattice.keys[i] != 0:
            lattice.cost[i] = math.inf
            lattice.done[i] = 0.0


@kernel
def _key(x: int, y: int, z: int) -> int:
    return ((x + OFFSET) << 42) | ((y + OFFSET) << 21) | (z + OFFSET)


@kernel
def _unkey(key: int) -> tuple[int, int, int]:
    mask = 2 * OFFSET - 1
    return (key >> 42) - OFFSET, ((key >> 21) & mask) - OFFSET, (key & mask) - OFFSET


@kernel
def middle(corridor: Corridor, key: int) -> Vec:
    """Middle of the cube `key`."""
    x, y, z = _unkey(key)
    o, h = corridor.origin, corridor.cell
    return o[0] + h * x, o[1] + h * y, o[2] + h * z


@kernel
def cube_of(corridor: Corridor, p: Vec) -> int:
    """Key of the cube that the point `p` lies in."""
    o, h = corridor.origin, corridor.cell
    return _key(
        math.floor((p[0] - o[0]) / h + 0.5), math.floor((p[1] - o[1]) / h + 0.5), math.floor((p[2] - o[2]) / h + 0.5)
    )


@kernel
def find_slot(lattice: Lattice, key: int) -> int:
    """Slot of a cube, or the empty one where it belongs."""
    mask = lattice.keys.shape[0] - 1
    at = int((np.uint64(key) * np.uint64(0x9E3779B97F4A7C15)) >> np.uint64(20)) & mask
    while lattice.keys[at] != 0 and lattice.keys[at] != key:
        at = (at + 1) & mask
    return at


@kernel
def _behind(corridor: Corridor, p: Vec, place: Vec, axis: Vec) -> bool:
    """Whether `p` is behind the back of `place`, so near that nothing that comes out there can turn to it."""
    away = sub(p, place)
    return dot(away, axis) < -corridor.cell and dot(away, away) < corridor.turn * corridor.turn


@kernel
def _enter(lattice: Lattice, corridor: Corridor, scene: Scene, slot: int, key: int) -> None:
    """Take a new cube into the table; what cannot be passed has the distance -inf."""
    p = middle(corridor, key)
    lattice.keys[slot] = key
    lattice.cost[slot] = math.inf
    lattice.length[slot] = 0.0
    lattice.extra[slot] = 0.0
    lattice.done[slot] = 0.0
    h = corridor.cell
    # Whoever goes from one place to another in so much length stays within an ellipsoid about both.
    far = norm(sub(p, corridor.origin)) + max(0.0, norm(sub(p, corridor.goal)) - corridor.around)
    if far > corridor.reach + 2.0 * HALF_DIAGONAL * h:
        lattice.distance[slot] = -math.inf
        return
    d, _ = closest(scene, p, max(corridor.radius + corridor.room, 2.0 * h), corridor.how)
    barred = _behind(corridor, p, corridor.start, corridor.axis) or _behind(corridor, p, corridor.goal, corridor.back)
    lattice.distance[slot] = -math.inf if barred or d < corridor.least else d


@kernel
def price(corridor: Corridor, distance: float) -> float:
    """What a unit of length costs where there is this much room."""
    clear_by = distance - corridor.radius
    if clear_by >= corridor.room:
        return 1.0
    if clear_by >= 0.0:
        return 1.0 + 2.0 * corridor.care * (1.0 - clear_by / corridor.room)
    return 1.0 + corridor.care * (2.0 - 20.0 * clear_by / corridor.cell)


@kernel
def _push(lattice: Lattice, size: int, priority: float, slot: int) -> int:
    at = size
    while at > 0:
        up = (at - 1) >> 1
        if lattice.priority[up] <= priority:
            break
        lattice.priority[at], lattice.queue[at] = lattice.priority[up], lattice.queue[up]
        at = up
    lattice.priority[at], lattice.queue[at] = priority, slot
    return size + 1


@kernel
def _pop(lattice: Lattice, size: int) -> tuple[int, int]:
    """Take the cheapest slot out of the queue: the slot, and how many are left."""
    top = lattice.queue[0]
    size -= 1
    priority, slot = lattice.priority[size], lattice.queue[size]
    at = 0
    while True:
        child = 2 * at + 1
        if child >= size:
            break
        if child + 1 < size and lattice.priority[child + 1] < lattice.priority[child]:
            child += 1
        if lattice.priority[child] >= priority:
            break
        lattice.priority[at], lattice.queue[at] = lattice.priority[child], lattice.queue[child]
        at = child
    lattice.priority[at], lattice.queue[at] = priority, slot
    return top, size


@kernel
def _seed(lattice: Lattice, corridor: Corridor, scene: Scene, most: int) -> tuple[int, int]:
    """Put the cubes that the ball about the goal touches into the queue: its size, and cubes that are new.

    No more than `most` are taken: in a full table the search for a place would never end.
    """
    size = entered = 0
    h, around = corridor.cell, corridor.around
    span = math.ceil(around / h) + 1
    x, y, z = _unkey(cube_of(corridor, corridor.goal))
    for i in range(-span, span + 1):
        for j in range(-span, span + 1):
            for k in range(-span, span + 1):
                key = _key(x + i, y + j, z + k)
                off = norm(sub(middle(corridor, key), corridor.goal))
                if off > around + HALF_DIAGONAL * h:
                    continue
                slot = find_slot(lattice, key)
                if lattice.keys[slot] == 0:
                    if entered >= most:
                        return size, entered
                    _enter(lattice, corridor, scene, slot, key)
                    entered += 1
                if lattice.distance[slot] > -math.inf:
                    lattice.cost[slot] = off
                    lattice.length[slot] = off
                    lattice.before[slot] = NONE
                    size = _push(lattice, size, 0.0, slot)
    return size, entered


@kernel
def _walled(corridor: Corridor, scene: Scene, one: int, other: int) -> bool:
    """Whether a wall stands between two neighbours: asked where their own distances leave room for one.

    On the way from one to the other, steps are as long as the distance from what cannot be passed.
    """
    a, b = middle(corridor, one), middle(corridor, other)
    line = sub(b, a)
    way = norm(line)
    gone = 0.0
    while gone < way:
        d, _ = closest(scene, add_scaled(a, gone / way, line), 2.0 * way, corridor.how)
        if d < corridor.least:
            return True
        gone += max(d - corridor.least, FINEST * way)
    return False


@kernel
def _widen(lattice: Lattice, corridor: Corridor, scene: Scene, slot: int, size: int, entered: int) -> tuple[int, int]:
    """Look at the neighbours of a cube; returns the size of the queue and the number of cubes in the table."""
    x, y, z = _unkey(lattice.keys[slot])
    h = corridor.cell
    own = price(corridor, lattice.distance[slot]) + lattice.extra[slot]
    for i in range(-1, 2):
        for j in range(-1, 2):
            for k in range(-1, 2):
                key = _key(x + i, y + j, z + k)
                other = find_slot(lattice, key)
                if lattice.keys[other] == 0:
                    _enter(lattice, corridor, scene, other, key)
                    entered += 1
                d = lattice.distance[other]
                if d == -math.inf or lattice.done[other] != 0.0:
                    continue
                way = h * math.sqrt(i * i + j * j + k * k)
                if d + lattice.distance[slot] < way and _walled(corridor, scene, lattice.keys[slot], key):
                    continue
                cost = lattice.cost[slot] + 0.5 * way * (own + price(corridor, d) + lattice.extra[other])
                length = lattice.length[slot] + way
                rest = norm(sub(middle(corridor, key), corridor.start))
                if cost < lattice.cost[other] and SMOOTHED * length + rest <= corridor.longest:
                    lattice.cost[other] = cost
                    lattice.length[other] = length
                    lattice.before[other] = slot
                    size = _push(lattice, size, cost + corridor.haste * rest, other)
    return size, entered


@kernel
def explore(
    lattice: Lattice, corridor: Corridor, scene: Scene, clock: Array, deadline: float, entered: int
) -> tuple[int, int, int]:
    """Search from the cubes about the goal to those about the start (A*, Hart et al. 1968).

    `entered` cubes are in the table already. Returns FOUND, CLOSED (no way), FULL (the table or the queue is) or LATE;
    the slot that the way begins with; and how many cubes are in the table then.
    """
    most = lattice.keys.shape[0] // 2
    size, new = _seed(lattice, corridor, scene, most - entered)
    entered += new
    if entered >= most:
        return FULL, NONE, entered
    looks = 0
    while size > 0:
        if entered + 27 > most or size + 27 > lattice.queue.shape[0]:
            return FULL, NONE, entered
        looks += 1
        if looks % 64 == 0 and now(clock) > deadline:
            return LATE, NONE, entered
        slot, size = _pop(lattice, size)
        if lattice.done[slot] != 0.0:
            continue
        lattice.done[slot] = 1.0
        if norm(sub(middle(corridor, lattice.keys[slot]), corridor.start)) <= corridor.close:
            return FOUND, slot, entered
        size, entered = _widen(lattice, corridor, scene, slot, size, entered)
    return CLOSED, NONE, entered


@kernel
def surcharge(lattice: Lattice, corridor: Corridor, slot: int, amount: float, around: int) -> None:
    """Make the way that ends in `slot`, and what is near it, dearer, so that the next one differs."""
    while slot >= 0:
        x, y, z = _unkey(lattice.keys[slot])
        for i in range(-around, around + 1):
            for j in range(-around, around + 1):
                for k in range(-around, around + 1):
                    other = find_slot(lattice, _key(x + i, y + j, z + k))
                    if lattice.keys[other] != 0:
                        lattice.extra[other] = max(lattice.extra[other], amount)
        slot = lattice.before[slot]
