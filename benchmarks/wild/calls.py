"""Public calls of odd robots in odd scenes: each ends in an answer, or in an `InputError` about what was given."""

import json
import math
import pickle
import tempfile
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.harness.lines import Goal, Line
from benchmarks.wild.obstacles import block_surface, pose_rotation
from benchmarks.wild.robots import robot_with_shapes
from benchmarks.wild.worlds import asked
from sinuous.checks import Floats
from sinuous.errors import InputError, SuspiciousInput
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.solution.solution import Solution

SECTION = "public calls of odd robots in odd scenes: whether each ends in an answer"

UNITS = (-9.0, 9.0)
"""Powers of ten between which a segment is long."""

OBSTACLES = (0, 0, 1, 2, 5, 20)

BUDGETS = (0.0, 1e-4, 0.01, 0.05)
"""Seconds of a call."""

WHY = 0.03
"""Seconds of an explanation."""

METHODS: tuple[Any, ...] = ("newton", "dls", "fabrikc", "fabrikx", "fabrik_avoid", "opti_path", "slinki", "monte_carlo")
"""Names of methods."""


class Called(NamedTuple):
    """What came of one call, and of everything that was asked of its answer.

    Attributes
    ----------
    what : str
        The call.
    answered : bool
        Whether there was an answer; else it was refused with words about an argument.
    false : str
        How it ended instead; empty where it did not.
    """

    what: str
    answered: bool
    false: str


def called(seed: int, number: int) -> Called:
    """Make one call, with a robot, a scene and arguments that can be meant."""
    rng = np.random.default_rng([seed, 21, number])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SuspiciousInput)
        robot = _robot(rng)
        scene = _scene(robot, rng)
    what = str(rng.choice(list(CALLS)))
    make, refusals = CALLS[what]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SuspiciousInput)  # much of it is
            make(robot, scene, rng)
    except InputError as error:
        if error.key.partition("[")[0].partition(".")[0] in (*refusals, "scene"):
            return Called(what, False, "")
        return Called(what, False, f"InputError {error}")
    except Exception as error:  # whatever it is, it is no answer
        return Called(what, False, f"{type(error).__name__} {error}")
    return Called(what, True, "")


def lines_of(kind: str, made: list[Called]) -> list[Line]:
    """Sum up calls: how many were answered, and which ended otherwise."""
    answered = sum(each.answered for each in made)
    wrong = [f"{i}: {each.what}: {each.false}" for i, each in enumerate(made) if each.false]
    return [
        Line(SECTION, f"{kind}: answered", 100.0 * answered / len(made), "%", None, None, (answered, len(made))),
        Line(SECTION, f"{kind}: exceptions", len(wrong), "", Goal(0, correctness=True), note=", ".join(wrong[:20])),
    ]


def _robot(rng: Generator) -> Robot:
    """A robot of the wild worlds, or one of which much is at the edge of what can be said."""
    if rng.random() < 0.3:
        return robot_with_shapes(1, rng, UNITS)[0]
    unit = 10.0 ** rng.uniform(*UNITS)
    count = int(rng.choice([1, 1, 2, 3, 5, 8, 15]))
    radius = float(rng.choice([0.0, 1e-6, 0.01, 0.1, 0.6])) * unit
    drive = str(rng.choice(["none", "none", "tendons", "chambers"]))
    segments = [_segment(unit, radius, drive, rng) for _ in range(count)]
    longest = sum(segment.length[1] for segment in segments)
    return Robot(
        segments,
        base=None if rng.random() < 0.5 else sn.pose(unit * rng.normal(size=3), rotation=rng.normal(size=4)),
        tool=_tool(unit, rng),
        mount=float(rng.choice([0.0, 0.0, 0.3, 1.0, 1.5])) * longest,
        self_collision="avoid" if rng.random() < 0.5 else "allow",
    )


def _segment(unit: float, radius: float, drive: str, rng: Generator) -> sn.Segment:
    own = unit * float(rng.choice([1e-3, 0.3, 1.0, 1.0, 3.0]))
    low = own * float(rng.choice([0.0, 1e-9, 0.5, 1.0, 1.0]))
    bend = float(rng.choice([0.0, 1e-9, 0.3, 2.0, math.pi, 7.0]))
    curvature = None if rng.random() < 0.7 else float(rng.choice([0.0, 0.1, 3.0])) / own
    own_radius = radius * float(rng.choice([0.0, 0.5, 1.0, 1.0, 1.0]))
    arm = 0.1 * unit
    tendons = sn.Tendons(3, arm, displacement=(-0.2 * unit, 0.2 * unit)) if drive == "tendons" else None
    chambers = sn.Chambers(3, arm, length=(0.5 * low, 1.5 * own)) if drive == "chambers" else None
    return sn.Segment((low, own), bend, curvature, own_radius, tendons, chambers)


def _tool(unit: float, rng: Generator) -> Floats | None:
    kind = rng.integers(4)
    if kind < 2:
        return None
    if kind == 2:
        return sn.pose((0.0, 0.0, 0.0), direction=(1e-8, 0.0, 1.0))
    return sn.pose(unit * rng.normal(size=3), rotation=rng.normal(size=4))


def _size(robot: Robot) -> float:
    return max(sum(segment.length[1] for segment in robot.segments), 1e-300)


def _scene(robot: Robot, rng: Generator) -> Scene:
    """Obstacles of every kind, anywhere: about the base, around everything, without any thickness."""
    unit = _size(robot)
    obstacles = [_obstacle(robot, unit, rng) for _ in range(int(rng.choice(OBSTACLES)))]
    scene = Scene(obstacles)
    try:
        scene.prepare()
    except InputError:  # a mesh that is refused as it is
        return Scene()
    return scene


def _obstacle(robot: Robot, unit: float, rng: Generator) -> Any:
    base = robot.base[:3, 3]
    place = base + unit * float(rng.choice([0.0, 0.3, 1.0])) * rng.normal(size=3)
    size = unit * 10.0 ** rng.uniform(-3.0, 0.5)
    turn, end = pose_rotation(rng.normal(size=4)), place + size * rng.normal(size=3)
    surface = block_surface(place, 0.3 * size * rng.uniform(0.1, 1.0, 3), turn)
    made: list[Callable[[], Any]] = [
        lambda: sn.Sphere(place, size),
        lambda: sn.Box(place, size * rng.choice([1e-6, 0.1, 1.0, 1.0], 3), turn),
        lambda: sn.Capsule(place, end, 0.2 * size),
        lambda: sn.Cylinder(place, end, 0.2 * size, inside=bool(rng.random() < 0.2)),
        lambda: sn.HalfSpace(place - unit * turn[:, 2], turn[:, 2]),
        lambda: sn.Sphere(base, 2.0 * unit, inside=True),
        lambda: sn.Mesh(surface.vertices, surface.faces[: len(surface.faces) - int(rng.integers(2))]),
        lambda: sn.PointCloud(place + size * rng.normal(size=(int(rng.choice([1, 30])), 3)), 0.05 * size),
        lambda: sn.Grid(rng.random((4, 3, 5)) < 0.2, place, 0.2 * size),
        lambda: sn.Field(partial(_ball, place, size), place - size, place + size, 0.5 * size),
        lambda: sn.Moving(sn.Sphere((0.0, 0.0, 0.0), size), [0.0, 1.0], [place, end]),
    ]
    return made[rng.integers(len(made))]()


def _ball(center: Floats, radius: float, places: Floats) -> Floats:
    return np.asarray(np.linalg.norm(places - center, axis=1) - radius)


def _shape(robot: Robot, rng: Generator) -> Floats:
    """A configuration within all limits; where actuators forbid what was drawn, a straight one of middle length."""
    low, high = np.array([segment.length for segment in robot.segments]).T
    for share in (1.0, 0.1, 0.0):
        lengths = low + (high - low) * (rng.random(len(robot)) if share else 0.5)
        caps = np.array([s.max_bend for s in robot.segments])
        with np.errstate(invalid="ignore"):
            caps = np.minimum(caps, np.nan_to_num(np.array(robot.curvatures) * lengths, nan=0.0))
        norms = share * (1.0 - 1e-9) * caps * rng.random(len(robot))
        angles = 2.0 * math.pi * rng.random(len(robot))
        q = np.stack([norms * np.cos(angles), norms * np.sin(angles), lengths], axis=-1)
        if not robot.violations(q):
            break
    return np.asarray(q)


def _target(robot: Robot, rng: Generator) -> list[sn.Target]:
    """What a shape of the robot meets, or anything else, or several of these."""
    if rng.random() < 0.6:
        return asked(robot, _shape(robot, rng)[None], rng)[0]
    unit, base = _size(robot), robot.base[:3, 3]
    place = base + unit * float(rng.choice([0.0, 1e-9, 0.5, 1.0, 1e3])) * rng.normal(size=3)
    kind = int(rng.integers(5))
    segment = None if rng.random() < 0.7 else int(rng.integers(1, len(robot) + 1))
    if kind == 0:
        return [sn.Target(place, segment=segment)]
    if kind == 1:
        return [sn.Target(place, direction=-robot.base[:3, 2], segment=segment)]
    if kind == 2:
        return [sn.Target(direction=rng.normal(size=3), segment=segment)]
    if kind == 3:
        return [sn.Target(place, rotation=rng.normal(size=4), segment=segment)]
    return [
        sn.Target(place),
        *[sn.Target(place + unit * rng.normal(size=3), segment=k + 1) for k in range(len(robot) - 1)],
    ]


def _tolerance(robot: Robot, rng: Generator) -> sn.Tolerance | None:
    return (
        None
        if rng.random() < 0.5
        else sn.Tolerance(_size(robot) * 10.0 ** rng.uniform(-12, 0), 10.0 ** rng.uniform(-12, 0))
    )


def _options(robot: Robot, rng: Generator) -> dict[str, Any]:
    """Options of a solve, most of them left out."""
    options: dict[str, Any] = {"time": float(rng.choice(BUDGETS)), "tolerance": _tolerance(robot, rng)}
    if rng.random() < 0.3:
        options["max_starts"] = int(rng.choice([1, 2, 10, 100]))
    if rng.random() < 0.2:
        options["routes"] = False
    if rng.random() < 0.2:
        start, bends, clearance = rng.choice([0.0, 1.0], 3).tolist()
        options["prefer"] = sn.Preferences(start, bends, 0.1 * clearance * _size(robot))
    return options


def _ask(answer: Solution) -> None:
    """Ask everything of a solution."""
    assert np.isfinite(answer.q).all(), "q is not finite"
    assert not answer.solved or answer.verify().ok, "verify refutes what is solved"
    str(answer), repr(answer), answer.worst, answer.binding, answer.reason
    json.dumps(answer.to_dict(), allow_nan=False)
    pickle.loads(pickle.dumps(answer))


def _ask_motion(motion: sn.Motion) -> None:
    """Ask everything of a motion, and write it."""
    str(motion), repr(motion), motion.worst
    json.dumps(motion.to_dict(), allow_nan=False)
    assert np.isfinite(motion.q).all(), "q is not finite"
    for solution in motion.solutions[:3]:
        _ask(solution)
    motion.reversed()
    if motion.solved:
        assert all(step.ok for step in motion.verify()), "verify refutes what is solved"
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "file"
        motion.to_csv(file)
        motion.to_npz(file)
        if len(motion.q):
            motion.to_ros(file, joints_per_segment=2)
            motion.at(motion.times[-1])
        if len(motion.q) > 1:
            motion.to_csv(file, rate=3.0 / (motion.times[-1] - motion.times[0]))


def _solve(robot: Robot, scene: Scene, rng: Generator) -> None:
    initial = _shape(robot, rng) if rng.random() < 0.4 else None
    _ask(sn.solve(robot, _target(robot, rng), scene, initial=initial, **_options(robot, rng)))


def _solve_by_method(robot: Robot, scene: Scene, rng: Generator) -> None:
    method = METHODS[rng.integers(len(METHODS))]
    initial = _shape(robot, rng) if rng.random() < 0.4 else None
    options = {**_options(robot, rng), "prefer": None, "max_starts": 3}
    _ask(sn.solve(robot, _target(robot, rng), scene, initial=initial, method=method, **options))


def _explain(robot: Robot, scene: Scene, rng: Generator) -> None:
    initial = _shape(robot, rng) if rng.random() < 0.3 else None
    found = sn.solve(robot, _target(robot, rng), scene, initial=initial, **{**_options(robot, rng), "time": 0.01})
    str(found.explain(WHY))


def _solve_all(robot: Robot, scene: Scene, rng: Generator) -> None:
    kind = [None, "route", "shape"][int(rng.integers(3))]
    options = _options(robot, rng)
    for answer in sn.solve_all(robot, _target(robot, rng), scene, count=3, by=kind, **options):  # type: ignore[arg-type]
        _ask(answer)


def _solve_many(robot: Robot, scene: Scene, rng: Generator) -> None:
    solver = sn.Solver(robot, scene, **_options(robot, rng))
    targets = [_target(robot, rng) for _ in range(4)]
    initial = _shape(robot, rng) if rng.random() < 0.4 else None
    for answer in solver.solve_many(targets, initial, workers=1):
        _ask(answer)


def _step(robot: Robot, scene: Scene, rng: Generator) -> None:
    solver = sn.Solver(robot, scene, **_options(robot, rng))
    q: Any = _shape(robot, rng)
    unit = _size(robot)
    rates = None if rng.random() < 0.5 else sn.Rates(float(rng.choice([1e-6, 1.0])), unit)
    for _ in range(3):
        if rng.random() < 0.5:
            twist = np.concatenate([rng.normal(size=3), unit * rng.normal(size=3)])
            step = solver.step(q, twist * float(rng.choice([0.0, 1.0, 1e3])), 0.01, rates=rates)
        else:
            step = solver.step(q, dt=0.01, target=_target(robot, rng), rates=rates)
        assert np.isfinite(step.q).all(), "q is not finite"
        str(step), repr(step), step.active
        q = step
    within = sn.Rates(1.0, unit) * float(rng.choice([1e-6, 0.1]))
    _ask(solver.solve(_target(robot, rng), np.array(q.q), within=within))


def _track(robot: Robot, scene: Scene, rng: Generator) -> None:
    start = _shape(robot, rng) if rng.random() < 0.6 else None
    path = [_target(robot, rng) for _ in range(int(rng.integers(1, 5)))]
    shortest = None if rng.random() < 0.8 else "configuration"
    _ask_motion(sn.track(robot, path, scene, start=start, shortest=shortest, **_options(robot, rng)))  # type: ignore[arg-type]


def _plan(robot: Robot, scene: Scene, rng: Generator) -> None:
    goal: Any = _shape(robot, rng) if rng.random() < 0.5 else _target(robot, rng)
    options = _options(robot, rng)
    if scene.snapshot().moves:
        options["duration"] = 1.0
    _ask_motion(sn.plan(robot, _shape(robot, rng), goal, scene, **options))


def _timed(robot: Robot, scene: Scene, rng: Generator) -> None:
    motion = sn.Motion(robot, [_shape(robot, rng) for _ in range(int(rng.integers(2, 8)))], scene)
    _ask_motion(motion)
    unit = _size(robot)
    acceleration = None if rng.random() < 0.3 else sn.Rates(1.0, unit)
    trajectory = motion.timed(
        sn.Rates(1.0, unit, acceleration=acceleration),
        0.0 if acceleration is None else float(rng.choice([0.0, 0.1])) * unit,
    )
    times = np.linspace(0.0, trajectory.duration, 20)
    for values in (trajectory.at(times), trajectory.velocity(times), trajectory.acceleration(times)):
        assert np.isfinite(values).all(), "not finite"
    with tempfile.TemporaryDirectory() as folder:
        trajectory.to_csv(Path(folder) / "file", rate=5.0 / trajectory.duration)
        trajectory.to_ros(Path(folder) / "file")


def _follow(robot: Robot, scene: Scene, rng: Generator) -> None:
    unit = _size(robot)
    staged = sn.on_stage(robot, unit) if robot.linear is None and rng.random() < 0.7 else robot
    base = staged.base
    away = (base[:3, 2] + 0.2 * rng.normal(size=3)) * unit * rng.uniform(0.2, 0.8)
    start = base[:3, 3] + unit * base[:3, 2]
    points = (
        np.stack([start, start + away]) if rng.random() < 0.5 else np.stack([base[:3, 3], base[:3, 3] + 1.5 * away])
    )
    motion = sn.follow_the_leader(staged, points, scene, time=0.01, tip_deviation=0.01 * unit)
    _ask_motion(motion)
    if len(motion.q) > 0:
        str(motion.deviation(points))


def _reach(robot: Robot, scene: Scene, rng: Generator) -> None:
    unit = _size(robot)
    found = sn.reach(robot, scene, spacing=0.9 * unit, directions=int(rng.choice([1, 6])), time=0.002, workers=1)
    str(found), repr(found)


def _check(robot: Robot, scene: Scene, rng: Generator) -> None:
    shapes = np.stack([_shape(robot, rng) for _ in range(2)])
    sn.check(robot, shapes * rng.choice([1.0, 1.3]), scene, _target(robot, rng))
    robot.from_actuators(robot.to_actuators(shapes), shapes)
    robot.jacobian(shapes[0])
    with tempfile.TemporaryDirectory() as folder:
        robot.to_urdf(Path(folder) / "arm.urdf", joints_per_segment=2)


def _job(robot: Robot, scene: Scene, rng: Generator) -> None:
    """Write a problem, and read it again."""
    job = sn.Job(robot, _target(robot, rng), scene, tolerance=_tolerance(robot, rng))
    with tempfile.TemporaryDirectory() as folder:
        job.save(Path(folder) / "job.yaml")
        again = sn.load(Path(folder) / "job.yaml", sn.Job)
    assert again.robot.equals(robot), "another robot was read"


Make = Callable[[Robot, Scene, Generator], None]

CALLS: dict[str, tuple[Make, tuple[str, ...]]] = {
    "solve": (_solve, ()),
    "solve by method": (_solve_by_method, ("method", "target", "targets", "robot")),
    "explain": (_explain, ()),
    "solve_all": (_solve_all, ()),
    "solve_many": (_solve_many, ()),
    "step": (_step, ()),
    "track": (_track, ()),
    "plan": (_plan, ()),
    "timed": (_timed, ("motion", "rates")),
    "follow_the_leader": (_follow, ("robot", "curve")),
    "reach": (_reach, ("spacing", "robot")),
    "check": (_check, ("q",)),
    "job": (_job, ("scene",)),
}
"""Each call, and the arguments about which it may be refused as they are drawn."""

KINDS = {"public calls of odd robots": called}
