"""`python -m benchmarks seams`: welds, seams and other paths, and whether they are followed whole.

Every waypoint of each can be reached by itself. A path counts as followed whole where `track` says `solved`. The judge
computes the tip by SciPy, at fine samples.
"""

from collections.abc import Iterator
from functools import partial
from time import process_time
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

import sinuous as sn
from benchmarks.harness import Goal, Line, Part, Plan, Times, in_processes, timed
from benchmarks.judges.judge import wrong_in
from benchmarks.judges.kinematics import tip_poses
from sinuous.base.checks import Floats

KINDS = ("pipe", "saddle", "corner", "straight", "circle", "helix", "wave")
"""Curves: around a pipe, where two pipes meet, along two edges, in a plane, around and along a pipe, and wavy."""

WELDS = KINDS[:4]

DEMANDS = ("axis", "axis", "axis", "place", "pose")
"""What is asked of the tool at a waypoint: to point along the normal, nothing, or all of its orientation."""

FINE, LOOKED_AT = 60, 12
"""Configurations in every step in which the tip is judged, and the body."""

PATIENCE = 400
"""Paths that are drawn for one that can be reached."""

STARTS = 60
"""Starts of the solve that shows that a waypoint can be reached."""

TURNED = 10.0
"""How far the tool may be turned from the line, in tolerances of angles (rad)."""


class Seam(NamedTuple):
    """A robot, the waypoints of its tip, and what stands around."""

    robot: sn.Robot
    path: list[sn.Target]
    scene: list[sn.Sphere | sn.Capsule]


class Followed(NamedTuple):
    """Statuses where the line may be left and where not; CPU seconds of the latter, and what the judge says of it."""

    plain: str
    status: str
    seconds: float
    off: float
    turned: float
    wrong: str


def curve(kind: str, size: float, count: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Places (m, 3) and inward normals (m, 3) of a curve about the origin."""
    begin = rng.uniform(0.0, 2.0 * np.pi)
    angles = begin + np.linspace(0.0, rng.uniform(1.0, 2.0) * np.pi, count)
    out = np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=-1)
    share = np.linspace(-1.0, 1.0, count)[:, None]
    up, across = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    places, normals = out, -out
    if kind == "saddle":
        wide = rng.uniform(1.05, 2.0)
        height = np.sqrt(wide**2 - np.sin(angles) ** 2)
        places = out + (height - wide)[:, None] * up
        normals = -out - np.stack([0.0 * angles, np.sin(angles), height], axis=-1) / wide
    elif kind == "corner":
        turn = rng.uniform(0.3, 2.0)
        places = np.where(share < 0.0, -share * across, share * np.array([np.cos(turn), np.sin(turn), 0.0]))
        lean, blend = rng.normal(0.0, 0.5, (2, 3)), np.clip(0.5 + 2.0 * share, 0.0, 1.0)
        normals = -up + (1.0 - blend) * lean[0] + blend * lean[1]
    elif kind == "straight":
        places, normals = share * across, np.tile(-up + rng.normal(0.0, 0.4, 3), (count, 1))
    elif kind == "circle":
        normals = -up + rng.uniform(-0.7, 0.7) * out
    elif kind == "helix":
        places = out + rng.uniform(0.3, 1.5) * share * up
    elif kind == "wave":
        places = np.concatenate([share, 0.4 * np.sin(3.0 * share + begin), 0.3 * np.cos(4.0 * share)], axis=-1)
        normals = -up + 0.6 * np.sin(2.0 * share + begin) * across
    return size * places, _unit(normals)


def _unit(vectors: Floats) -> Floats:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _arm(rng: np.random.Generator) -> sn.Robot:
    """An arm of 4 to 8 segments, 100 long each, in some scale, somewhere; some have lengths that are fixed."""
    scale, count = float(10.0 ** rng.uniform(-3.0, 3.0)), int(rng.integers(4, 9))
    share = float(rng.choice([0.2, 0.2, 0.1, 0.0]))
    length = (100.0 * scale * (1.0 - share), 100.0 * scale * (1.0 + share)) if share else 100.0 * scale
    base = np.eye(4)
    base[:3, :3], base[:3, 3] = Rotation.random(random_state=rng).as_matrix(), 300.0 * scale * rng.normal(size=3)
    most = float(rng.uniform(1.4, 2.4))
    return sn.Robot.uniform(count, length, max_bend=most, radius=8.0 * scale, base=base)


def _drawn(kind: str, welds: bool, rng: np.random.Generator) -> Seam:
    robot = _arm(rng)
    unit, length = robot.mean_length / len(robot), robot.mean_length
    size, count = float(rng.uniform(0.12, 0.25)) * length, int(rng.integers(12, 31))
    places, normals = curve(kind, size, count, rng)
    turn = Rotation.random(random_state=rng)
    center = length * np.array([*rng.uniform(-0.5, 0.5, 2), rng.uniform(0.2, 0.7)])
    along = turn.apply([0.0, 0.0, 1.0])
    places, normals = center + turn.apply(places), turn.apply(normals)
    spheres = center + _unit(rng.normal(size=(4, 3))) * size * rng.uniform(1.8, 3.5, (4, 1))
    scene: list[sn.Sphere | sn.Capsule] = []
    frame, shift = robot.base[:3, :3], robot.base[:3, 3]
    crowd = int(rng.integers(3))
    if crowd and kind in ("pipe", "helix", "saddle"):
        begin, end = (shift + frame @ (center + side * 1.8 * size * along) for side in (-1.0, 1.0))
        scene.append(sn.Capsule(begin, end, 0.6 * size))
    if crowd == 2:
        scene += [sn.Sphere(shift + frame @ place, float(rng.uniform(0.2, 0.6)) * unit) for place in spheres]
    demand = "axis" if welds else str(rng.choice(DEMANDS))
    places, normals = shift + places @ frame.T, normals @ frame.T
    return Seam(robot, _targets(demand, places, normals, rng), scene)


def _targets(demand: str, places: Floats, normals: Floats, rng: np.random.Generator) -> list[sn.Target]:
    if demand == "place":
        return [sn.Target(place) for place in places]
    if demand == "axis":
        return [sn.Target(place, direction=normal) for place, normal in zip(places, normals, strict=True)]
    side = _unit(rng.normal(size=3))
    x = _unit(np.cross(np.roll(side, 1), normals) if abs(normals @ side).max() > 0.95 else np.cross(side, normals))
    frames = np.stack([x, np.cross(normals, x), normals], axis=-1)
    return [sn.Target(place, rotation=frame) for place, frame in zip(places, frames, strict=True)]


def draw(kind: str, number: int, welds: bool = False) -> Seam:
    """Draw a path of which every waypoint can be reached by itself."""
    for i in range(PATIENCE):
        seam = _drawn(kind, welds, np.random.default_rng([43, KINDS.index(kind), number, i]))
        solver = sn.Solver(seam.robot, seam.scene, max_starts=STARTS, routes=False, time=5.0)
        ends = [seam.path[k] for k in (0, -1, len(seam.path) // 2)]
        if all(solver.solve(target).solved for target in (*ends, *seam.path)):
            return seam
    raise RuntimeError(f"no path that can be reached: {kind} {number}")


def follow(item: tuple[str, int, bool]) -> Followed:
    """Follow a path twice: where the line may be left, and where it may not."""
    robot, path, scene = draw(*item)
    sn.track(robot, path[:2], scene)  # compiled, or loaded
    plain = sn.track(robot, path, scene, reconfigure="allow")
    motion, seconds = timed(sn.track, robot, path, scene, clock=process_time)
    left = plain.solved and bool(plain.left_steps)
    status = "left_path" if left else str(plain.status)
    off, turned = judged(motion) if motion.solved else (0.0, 0.0)
    wrong = wrong_in(robot, sn.Scene(scene), motion.q, LOOKED_AT) if motion.solved else ""
    return Followed(status, str(motion.status), seconds, off, turned, wrong)


def judged(motion: sn.Motion) -> tuple[float, float]:
    """How far the tip is off the lines between waypoints (in allowed deviations), and turned (in allowed angles)."""
    most = 10.0 * (motion.solutions[0].problem.tolerance.position or 0.0)
    turned_most = TURNED * motion.solutions[0].problem.tolerance.angle
    off = turned = 0.0
    targets = [solution.problem.targets[0] for solution in motion.solutions]
    knots = [knot for knot in motion.waypoint_knots if knot is not None]
    assert len(knots) == len(targets)
    for i in range(len(targets) - 1):
        begin, end = targets[i], targets[i + 1]
        t = np.linspace(motion.times[knots[i]], motion.times[knots[i + 1]], FINE * (knots[i + 1] - knots[i]) + 1)
        poses = tip_poses(motion.robot, motion.at(t))
        assert begin.position is not None
        assert end.position is not None
        along, away = end.position - begin.position, poses[:, :3, 3] - begin.position
        share = np.clip(away @ along / (along @ along), 0.0, 1.0)
        off = max(off, float(np.linalg.norm(away - share[:, None] * along, axis=1).max()) / most)
        turned = max(turned, _turned(begin, end, share, poses) / turned_most)
    return off, turned


def _turned(begin: sn.Target, end: sn.Target, share: Floats, poses: Floats) -> float:
    if begin.rotation is not None and end.rotation is not None:
        asked = Slerp([0.0, 1.0], Rotation.from_matrix(np.stack([begin.rotation, end.rotation])))(share)
        return float((asked.inv() * Rotation.from_matrix(poses[:, :3, :3])).magnitude().max())
    if begin.direction is None or end.direction is None:
        return 0.0
    across = np.cross(begin.direction, end.direction)
    angle = float(np.arctan2(np.linalg.norm(across), begin.direction @ end.direction))
    axis = across / max(float(np.linalg.norm(across)), 1e-300)
    wanted: Floats = Rotation.from_rotvec(share[:, None] * angle * axis).apply(begin.direction.copy())
    sines = np.linalg.norm(np.cross(wanted, poses[:, :3, 2]), axis=1)
    return float(np.arctan2(sines, (wanted * poses[:, :3, 2]).sum(axis=1)).max())


def items(part: str, plan: Plan) -> list[tuple[str, int, bool]]:
    """Name the paths of a part by kind and number."""
    seed = 10_000 * plan.seed
    if part == "welds":
        return [(WELDS[i % 4], seed + 5000 + i // 4, True) for i in range(plan.count(40, 8))]
    return [(KINDS[i % 7], seed + i // 7, False) for i in range(plan.count(200, 14))]


def measure(plan: Plan, part: str) -> Iterator[Line]:
    """Follow the paths of a part."""
    asked = items(part, plan)
    found = list(in_processes(follow, asked, alone=plan.quick))
    count, section = len(found), f"{part}: {len(asked)} paths of which every waypoint can be reached"
    solved = [one for one in found if one.status == "solved"]
    ways = {"waypoint after waypoint": [one.plain for one in found], "track": [one.status for one in found]}
    for word in sorted({word for words in ways.values() for word in words}, key=lambda each: (each != "solved", each)):
        for way, words in ways.items():
            some = words.count(word)
            yield Line(section, f"{way}: {word}", 100.0 * some / count, "%", note=f"{some} of {count}")
    for suffices, word in ((True, "suffices"), (False, "does not suffice")):
        seconds = [one.seconds for one in found if (one.plain == "solved") is suffices]
        if seconds:
            times, what = Times.of(seconds), f"CPU time of track where waypoint after waypoint {word}"
            yield Line(section, what, times.median, "ms", times=times)
    off, turned = (max((getattr(one, name) for one in solved), default=0.0) for name in ("off", "turned"))
    right = Goal(1.0 + 1e-6, correctness=True)
    yield Line(section, "solved: largest distance of the tip from the line, in deviations", off, "", right)
    yield Line(section, "solved: largest angle of the tool from the line, in ten tolerances", turned, "", right)
    false = sum(bool(one.wrong) for one in solved)
    yield Line(section, "solved: motions in which a judge finds a collision", false, "", Goal(0.0, correctness=True))


PARTS: dict[str, Part] = {part: partial(measure, part=part) for part in ("welds", "paths")}
"""What is measured, in order."""
