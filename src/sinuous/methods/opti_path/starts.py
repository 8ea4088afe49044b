"""Where `opti_path` begins: an initial configuration carried to the goal, the single arc, and other guesses."""

import math

from sinuous.kernels.chain.kinematics import forward, frame
from sinuous.kernels.chain.single_arc import arc_to
from sinuous.kernels.maths.vectors import (
    Array,
    Vec,
    across,
    add,
    add_scaled,
    copy,
    cross,
    dot,
    get_vec,
    norm,
    put_vec,
    scale,
    sub,
)
from sinuous.kernels.problem import Problem
from sinuous.kernels.tables import ARC, GIVEN, MAX_LENGTH, MIN_LENGTH, RANDOM
from sinuous.methods.opti_path.gradient import Setting
from sinuous.methods.opti_path.path import Aim, Path, Work, along_arc, put_points
from sinuous.methods.search import Check, Start, begin_own, own_number

BOWS = 8
"""Bows of a path that are tried: so many directions across the first tangent, by two heights."""


def carried(frames: Array, setting: Setting, aim: Aim, path: Path) -> None:
    """The points of the shape whose `frames` (n + 1, 12) these are, with its end moved to the goal.

    The shift is blended over the points by `(i / n) ^ blend`; 0 moves the last point alone.
    """
    n = path.arcs.shape[0]
    put_points(frames, path.points)
    shift = sub(aim.position, get_vec(path.points, n, 0))
    for i in range(1, n):
        if setting.blend > 0.0:
            share = (i / n) ** setting.blend
            put_vec(path.points, i, 0, add_scaled(get_vec(path.points, i, 0), share, shift))
    put_vec(path.points, n, 0, aim.position)


def _sides(path: Path, aim: Aim) -> tuple[Vec, Vec, float, float]:
    """First tangent, unit vector across it towards the goal, and how far the goal is aside and ahead."""
    t = get_vec(path.tangents, 0, 0)
    d = sub(aim.position, get_vec(path.points, 0, 0))
    ahead = dot(d, t)
    out = add_scaled(d, -ahead, t)
    aside = norm(out)
    side = scale(1.0 / aside, out) if aside > 1e-12 * norm(d) else across(t)[0]
    return t, side, aside, ahead


def reach(limits: Array) -> tuple[float, float]:
    """Least and largest length of a robot with these `limits` (n, 7)."""
    low = high = 0.0
    for k in range(limits.shape[0]):
        low += limits[k, MIN_LENGTH]
        high += limits[k, MAX_LENGTH]
    return low, high


def single(limits: Array, setting: Setting, aim: Aim, path: Path) -> float:
    """The arc from the base along its tangent to the goal, cut into pieces; returns its length.

    Pieces share it by the mean lengths in `limits` (n, 7). A goal straight ahead leaves the points on a line, which no
    gradient bends: `bow` moves them aside, by half a wave of that height.
    """
    n = path.arcs.shape[0]
    t, side, aside, ahead = _sides(path, aim)
    base = get_vec(path.points, 0, 0)
    half, length = arc_to(aside, ahead)
    low, high = reach(limits)
    height = setting.bow * aim.unit if aside < setting.bow * aim.unit else 0.0
    s = 0.0
    for i in range(1, n):
        s += (limits[i - 1, MIN_LENGTH] + limits[i - 1, MAX_LENGTH]) / (low + high)
        p = add(base, along_arc(t, side, 2.0 * half, length, s))
        put_vec(path.points, i, 0, add_scaled(p, height * math.sin(math.pi * s), side))
    put_vec(path.points, n, 0, aim.position)
    return length


def _cubic(a: Vec, b: Vec, c: Vec, d: Vec, s: float) -> Vec:
    """Point of a cubic Bezier curve."""
    r = 1.0 - s
    p = add_scaled(scale(r * r * r, a), 3.0 * r * r * s, b)
    return add_scaled(add_scaled(p, 3.0 * r * s * s, c), s * s * s, d)


def _curve_length(a: Vec, b: Vec, c: Vec, d: Vec) -> float:
    """Length of a cubic Bezier curve, by 32 chords."""
    length, before = 0.0, a
    for j in range(1, 33):
        p = _cubic(a, b, c, d, j / 32.0)
        length += norm(sub(p, before))
        before = p
    return length


def swung(limits: Array, aim: Aim, path: Path, angle: float) -> None:
    """A cubic curve to the goal, as long as a robot with these `limits` (n, 7) at mid-range, swung out to the side.

    It leaves along the first tangent, ends along the tangent that is asked for, and swings out at `angle` about the
    first tangent from the goal's side; how far is found by halving.
    """
    t, side, _, _ = _sides(path, aim)
    base = get_vec(path.points, 0, 0)
    other = cross(t, side)
    out = add(scale(math.cos(angle), side), scale(math.sin(angle), other))
    low, high = reach(limits)
    wanted = 0.5 * (low + high)
    near, far = 0.0, 2.0 * wanted
    b = c = base
    for _ in range(30):
        swing = 0.5 * (near + far)
        b = add_scaled(add_scaled(base, 0.4 * wanted, t), 0.5 * swing, out)
        if aim.directed:
            c = add_scaled(add_scaled(aim.position, -0.4 * wanted, aim.direction), 0.5 * swing, out)
        else:
            c = add_scaled(aim.position, swing, out)
        if _curve_length(base, b, c, aim.position) < wanted:
            near = swing
        else:
            far = swing
    _cut(limits, base, b, c, aim, path)


def _cut(limits: Array, a: Vec, b: Vec, c: Vec, aim: Aim, path: Path) -> None:
    """Put the points on a cubic curve, shared by the mean lengths of the segments in `limits` (n, 7)."""
    n = path.arcs.shape[0]
    low, high = reach(limits)
    total = _curve_length(a, b, c, aim.position)
    i, done, before = 1, 0.0, a
    share = (limits[0, MIN_LENGTH] + limits[0, MAX_LENGTH]) / (low + high)
    steps = 16 * n
    for j in range(1, steps + 1):
        p = _cubic(a, b, c, aim.position, j / steps)
        piece = norm(sub(p, before))
        while i < n and done + piece >= share * total:
            part = (share * total - done) / piece if piece > 0.0 else 0.0
            put_vec(path.points, i, 0, add_scaled(before, part, sub(p, before)))
            share += (limits[i, MIN_LENGTH] + limits[i, MAX_LENGTH]) / (low + high)
            i += 1
        done += piece
        before = p
    for rest in range(i, n + 1):
        put_vec(path.points, rest, 0, aim.position)


def bow(aim: Aim, path: Path, which: int) -> None:
    """Bow a path to one of the sides of its first tangent, by a third of a segment or, the next round, two thirds."""
    n = path.arcs.shape[0]
    a, b = across(get_vec(path.tangents, 0, 0))
    angle = 2.0 * math.pi * (which % BOWS) / BOWS
    height = aim.unit / 3.0 if which < BOWS else 2.0 * aim.unit / 3.0
    for i in range(1, n):
        lift = height * math.sin(math.pi * i / n)
        p = add_scaled(get_vec(path.points, i, 0), lift * math.cos(angle), a)
        put_vec(path.points, i, 0, add_scaled(p, lift * math.sin(angle), b))


def begin_path(problem: Problem, check: Check, work: Work, aim: Aim, start: Start) -> int:
    """Put a start into the path; its source, or -1 when there is no such start.

    Initial configurations, the single arc and, with the repairs, a swung curve (before the arc, when the arc is longer
    than the robot). With restarts also: the first initial configuration bowed to all sides, before the arc; the arc
    bowed; and the shapes that other methods start from too.
    """
    path, q, setting, _ = work
    initial, own = start.initial, own_number(start)
    again = setting.restarts != 0.0
    nudges = BOWS if again and initial.shape[0] > 0 else 0
    rotation, base = frame(check.frames, 0)
    put_vec(path.points, 0, 0, base)
    put_vec(path.tangents, 0, 0, (rotation[0][2], rotation[1][2], rotation[2][2]))
    if own < nudges:
        copy(initial[start.index if own < 0 else 0], q)
        forward(problem.limits, q, check.frames)
        carried(check.frames, setting, aim, path)
        if own >= 0:
            bow(aim, path, own)
        return GIVEN
    own -= nudges
    if own > 0 and not again and (own > 1 or setting.other_guess == 0.0):
        return -1
    if own < 2 + 2 * BOWS:
        length = single(problem.limits, setting, aim, path)
        if own > 1:
            bow(aim, path, own - 2)
        elif setting.other_guess != 0.0 and (length > reach(problem.limits)[1]) == (own == 0):
            swung(problem.limits, aim, path, 0.0)
        return ARC
    begin_own(problem, check, own - 1 - 2 * BOWS, start.seed, q)
    forward(problem.limits, q, check.frames)
    carried(check.frames, setting, aim, path)
    return RANDOM
