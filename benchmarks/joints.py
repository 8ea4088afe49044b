"""`python -m benchmarks joints`: inverse kinematics of arms with joints before the segments, or with joints alone.

And three segments that six axes lead along curves, follow the leader: along shapes of the arm itself, bent at random.

Poses are drawn by the judge's own kinematics from configurations within all limits, so each is reachable. What counts
is the time of the solve alone, the least of several runs, because the machine may be busy; answers are judged by code
that shares nothing with the kernels.
"""

import math
import time
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Annotated, Any, NamedTuple

import numpy as np
import typer
from scipy.spatial import cKDTree

import sinuous as sn
from benchmarks.harness.command import Record, command, give
from benchmarks.harness.lines import Times, table
from benchmarks.judges.judge import right
from benchmarks.judges.kinematics import arc_ends, arc_poses, body_places, link_poses, moving, tip_poses
from benchmarks.judges.motions import wrong_at
from benchmarks.mbm import CAPSULES, FLANGE, PANDA, panda_joints
from benchmarks.motion.leader import distances
from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.model.joints import Fixed, Joint, Prismatic, Revolute

TOLERANCE = sn.Tolerance(1e-6, 1e-6)
"""In m, and rad."""

RUNS = 5
"""Solves of each pose, of which the quickest counts."""

SPHERES, SPHERE = 40, 0.04
"""How many, and their radius in m."""


CURVES, BENT = 40, 1.0
"""Curves that an arm is led along, and largest bend of a segment in one, rad."""

FINE, GIVEN = 2000, 10
"""Points of a curve for each segment that it is measured against; and of these one in so many is given."""

LED, BETWEEN, PLACES = 3, 4, 25
"""Runs of each, of which the one with the least CPU time counts, configurations of each step that are judged, and
places of a segment."""


class Family(NamedTuple):
    """A kind of arm, among spheres or without; what it is to reach, in us."""

    name: str
    robot: Callable[[], sn.Robot]
    spheres: int
    goal: float


def rolled_and_fed() -> sn.Robot:
    """Roll and feed, then three inextensible segments: a bronchoscope, in m."""
    joints: list[Joint] = [Revolute((0.0, 0.0, 1.0), (-math.pi, math.pi)), Prismatic((0.0, 0.0, 1.0), (0.0, 0.3))]
    return sn.Robot([sn.Segment(0.1, 2.0, radius=0.005)] * 3, joints=joints)


def six_axes() -> sn.Robot:
    """Three segments on the first six joints of the Panda."""
    joints = panda_joints(CAPSULES)[:6]
    return sn.Robot([sn.Segment((0.08, 0.12), 2.0, radius=0.01)] * 3, joints=joints)


def six_axes_bare() -> sn.Robot:
    """The same without bodies of links."""
    return sn.Robot([sn.Segment((0.08, 0.12), 2.0)] * 3, joints=panda_joints(((),) * len(PANDA))[:6])


def panda() -> sn.Robot:
    """The Panda up to its flange, without bodies of links."""
    return sn.Robot(joints=[*panda_joints(((),) * len(PANDA)), Fixed((0.0, 0.0, FLANGE))])


FAMILIES = (
    Family("roll, feed, three segments", rolled_and_fed, 0, 12.0),
    Family("six axes, three segments", six_axes_bare, 0, 40.0),
    Family("six axes, three segments, among spheres", six_axes, SPHERES, 80.0),
    Family("seven axes of the Panda", panda, 0, 15.0),
)


class Result(NamedTuple):
    """What came of a family: seconds of what was solved, how many poses, and what was wrong."""

    family: Family
    seconds: list[float]
    asked: int
    wrong: list[str]


def draw(robot: sn.Robot, rng: np.random.Generator) -> Floats:
    """Return a configuration (n, 3) within all limits."""
    q = np.zeros((len(robot), 3))
    for k, row in enumerate(robot.rows):
        q[k, 2] = rng.uniform(*row.length)
        if not row.rigid:
            bend, angle = row.max_bend * math.sqrt(rng.uniform()), rng.uniform(0.0, 2.0 * math.pi)
            q[k, :2] = bend * math.cos(angle), bend * math.sin(angle)
        elif row.plane is not None:
            q[k, 0] = rng.uniform(*np.broadcast_to(row.own_max_bend, 2))
    return q


def examine(family: Family, count: int, seed: int) -> Result:
    """Solve so many poses of a family."""
    robot, rng = family.robot(), np.random.default_rng(seed)
    seconds, wrong, asked = list[float](), list[str](), 0
    while asked < count:
        q = draw(robot, rng)
        scene = sn.Scene()
        if family.spheres:
            centers = np.array((0.0, 0.0, 0.4)) + rng.uniform(-0.9, 0.9, (family.spheres, 3))
            scene = sn.Scene([sn.Sphere(center, SPHERE) for center in centers])
            if wrong_at(robot, scene, q[None]):
                continue  # nobody knows then whether the pose can be reached
        asked += 1
        pose = tip_poses(robot, q[None])[0]
        target = sn.Target(pose[:3, 3], rotation=pose[:3, :3])
        solver = sn.Solver(robot, scene, tolerance=TOLERANCE)
        runs = [solver.solve(target) for _ in range(RUNS)]
        found = runs[0].configuration[None]
        if not runs[0].solved:
            continue
        seconds.append(min(each.seconds for each in runs))
        if why := wrong_at(robot, scene, found) or "pose" * (not right(robot, [target], found, TOLERANCE).all()):
            wrong.append(why)
    return Result(family, seconds, asked, wrong)


def led_curves(robot: sn.Robot, count: int, rng: np.random.Generator) -> Iterator[tuple[Floats, Floats]]:
    """Yield points along shapes of the arm, all and those that are given, where its joints can carry it straight in."""
    alone = robot.changed(segments=())
    solver, length = sn.Solver(alone, max_starts=1, routes=False), sum(each.length[1] for each in robot.segments)
    lows, highs = np.array([joint.limits for joint in moving(robot.joints)]).T
    while count > 0:
        drawn = rng.uniform(lows, highs)
        carried = alone.with_joints(None, drawn)
        port, there = link_poses(robot, drawn[None])[0, -1], True
        for back in np.linspace(0.0, length, 31).tolist():
            found = solver.solve(sn.Target(port[:3, 3] - back * port[:3, 2], direction=port[:3, 2]), carried)
            carried, there = found.configuration, there and found.solved
        if not there:
            continue
        bend, side = rng.uniform(0.0, BENT, len(robot.segments)), rng.uniform(-np.pi, np.pi, len(robot.segments))
        at, points = port, [port[None, :3, 3]]
        for x, y, segment in zip(bend * np.cos(side), bend * np.sin(side), robot.segments, strict=True):
            shares = np.linspace(0.0, 1.0, FINE + 1)[1:, None] * (x, y, segment.length[1])
            points.append(at[:3, 3] + arc_ends(*shares.T) @ at[:3, :3].T)
            at = at @ arc_poses(*np.array([x, y, segment.length[1]]))
        whole = np.concatenate(points)
        behind = port[:3, 3] - np.linspace(length, 0.0, FINE, endpoint=False)[:, None] * port[:3, 2]
        yield np.concatenate([behind, whole]), whole[::GIVEN]
        count -= 1


def lead(count: int, seed: int) -> str:
    """Lead the arm along so many curves, judge it, and return a table."""
    robot, rng = six_axes().changed(segments=[sn.Segment(0.1, 2.0, radius=0.01)] * 3), np.random.default_rng(seed)
    length, wrong = sum(each.length[1] for each in robot.segments), 0
    seconds, found = list[float](), list[tuple[float, float, float]]()
    for fine, points in led_curves(robot, count, rng):
        spent = []
        for _ in range(LED):
            began = time.process_time()
            motion = sn.follow_the_leader(robot, points)
            spent.append(time.process_time() - began)
        if not motion.solved:
            continue
        seconds.append(min(spent))
        knots = np.arange((len(motion.times) - 1) * BETWEEN + 1) / BETWEEN
        q = motion.at(np.interp(knots, np.arange(len(motion.times)), motion.times))
        wrong += bool(wrong_at(robot, sn.Scene(), q))
        places = np.stack(
            [own for link, own, _ in body_places(robot, q, PLACES) if link > len(moving(robot.joints))], axis=1
        )
        off = distances(cKDTree(fine), fine, places.reshape(-1, 3)).reshape(places.shape[:-1]) / (0.01 * length)
        found.append((float(off[:, -1, -1].max()), float(off.mean()), float(off.max())))
    tip, shape, most = np.array(found).reshape(-1, 3).T
    times = Times.of([1e3 * each for each in seconds] or [math.nan])
    head = ["led, six axes and three segments", "of", "wrong", "tip, %, worst"]
    head += ["shape, %, mean", "worst", "median, ms", "p95"]
    figures = [f"{each:.3f}" for each in (tip.max(), shape.mean(), most.max())]
    cells = [[str(len(found)), str(count), str(wrong), *figures, f"{times.median:.3g}", f"{times.p95:.3g}"]]
    return table([head, *cells, ["goal", "", "0", "0.000", "1", "", "50", ""]])


def rigid_reference(count: int, seed: int) -> Times | None:
    """Times of an analytic solver for six axes, all branches, through Python; `None` where it is not installed."""
    try:
        reference: Any = import_module("eaik.IK_DH")
    except ImportError:
        return None
    from time import perf_counter  # noqa: PLC0415

    # The axes of a UR5, which has a spherical wrist's kind of solutions: standard Denavit-Hartenberg.
    alpha = np.array([0.5 * math.pi, 0.0, 0.0, 0.5 * math.pi, -0.5 * math.pi, 0.0])
    a, d = np.array([0.0, -0.425, -0.39225, 0.0, 0.0, 0.0]), np.array([0.089159, 0.0, 0.0, 0.10915, 0.09465, 0.0823])
    arm = reference.DhRobot(alpha, a, d)
    rng, seconds = np.random.default_rng(seed), []
    for _ in range(count):
        pose = arm.fwdKin(rng.uniform(-math.pi, math.pi, 6))
        spent = []
        for _ in range(RUNS):
            began = perf_counter()
            arm.IK(pose)
            spent.append(perf_counter() - began)
        seconds.append(min(spent))
    return Times.of(seconds)


def report(results: list[Result], reference: Times | None) -> str:
    """Return the table of all families."""
    cells = [["arm", "solved", "of", "wrong", "median, us", "p95", "worst", "goal, us"]]
    for result in results:
        times = Times.of([1e6 * each for each in result.seconds] or [math.nan])
        figures = [f"{figure:.3g}" for figure in (times.median, times.p95, times.worst)]
        counts = [str(len(result.seconds)), str(result.asked), str(len(result.wrong))]
        cells.append([result.family.name, *counts, *figures, f"{result.family.goal:g}"])
    lines = [table(cells)]
    if reference is not None:
        lines.append(
            f"EAIK, six axes, all branches, a call through Python: median {1e6 * reference.median:.3g} us, "
            f"p95 {1e6 * reference.p95:.3g}."
        )
    return "\n\n".join(lines)


def run(
    count: Annotated[int, typer.Option(help="Poses of each kind of arm.")] = 1000,
    seed: Annotated[int, typer.Option(help="Of the poses.")] = 0,
    record: Record = None,
) -> None:
    """Solve random reachable poses of arms with joints; the exit code is 1 when an answer was wrong."""
    checks.integer("--count", count, 1, 1_000_000)
    checks.integer("--seed", seed, 0, 2**31 - 1)
    facts = {
        "seed": str(seed),
        "protocol": f"time of the solve alone, the least of {RUNS}, from no start, to {TOLERANCE.position:g} m and "
        f"{TOLERANCE.angle:g} rad of a full pose; {SPHERES} spheres of {SPHERE:g} m, whole body proved clear",
    }
    results = [examine(family, count, seed) for family in FAMILIES]
    text = f"{report(results, rigid_reference(min(count, 500), seed))}\n\n{lead(min(count, CURVES), seed)}"
    give("joints", facts, text, record)
    raise typer.Exit(int(any(result.wrong for result in results)))


main = command(run, "benchmarks joints")
