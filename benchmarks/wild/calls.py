"""Public calls of odd robots in odd scenes: each ends in an answer, or in an `InputError` about what was given.

Robots, scenes, and what may be asked of them: much is at the edge of what can be said.
"""

import json
import math
import pickle
import warnings
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.places import solids
from benchmarks.problems import random_configurations
from benchmarks.wild.worlds import Judged, asked, demanding, loaded_robot, pose_rotation, robot_with_shapes
from sinuous.base.checks import Floats
from sinuous.model.actuation import Actuator

OBSTACLES = (0, 0, 1, 2, 5, 20)


def odd_robot(rng: Generator) -> sn.Robot:
    """A robot of the wild worlds; of two in three much is at the edge of what can be said, and some have demands."""
    loaded = rng.random() < 0.25
    robot = loaded_robot(10.0 ** rng.uniform(-3.0, 3.0), rng) if loaded else robot_with_shapes(1, rng)[0]
    if rng.random() < 0.7:
        segments = [_edged(each, size_of(robot) / len(robot), rng) for each in robot.segments]
        with suppress(sn.InputError):  # what demands a clearance from itself has to avoid itself
            robot = robot.changed(
                segments=segments,
                tool=sn.pose((0.0, 0.0, 0.0), direction=(1e-8, 0.0, 1.0)) if rng.random() < 0.25 else robot.tool,
                mount=float(rng.choice([0.0, 0.0, 0.3, 1.0, 1.5])) * sum(each.length[1] for each in segments),
                self_collision="avoid" if rng.random() < 0.5 else "allow",
            )
    return demanding(robot, rng) if robot.self_collision == "avoid" and rng.random() < 0.3 else robot


def _edged(segment: sn.Segment, unit: float, rng: Generator) -> sn.Segment:
    """The segment with some of its numbers at an edge; what it refuses stays as it was."""
    own = segment.length[1]
    gain, offset = float(rng.choice([1.0, -1.0, 1e-3, 200.0])), float(rng.choice([0.0, 7.0]))
    motor: dict[str, Any] = {"gain": gain, "offset": offset}
    edges: dict[str, list[Any]] = {
        "length": [(0.0, own), (1e-9 * own, own), own, (1e-3 * own, 1e-3 * own)],
        "max_bend": [0.0, 1e-9, 0.3, math.pi, 7.0],
        "max_curvature": [0.0, 0.1 / own, 3.0 / own],
        "radius": [0.0, 1e-6 * unit, 0.6 * unit],
        "tendons": [sn.Tendons(3, 0.1 * unit, displacement=(-0.2 * unit, 0.2 * unit), **motor)],
        "chambers": [sn.Chambers(3, 0.1 * unit, length=(0.5 * segment.length[0], 1.5 * own), **motor)],
        "stiffness": [None],
    }
    for key, values in edges.items():
        if rng.random() < 0.2:
            with suppress(sn.InputError):
                segment = segment.changed(**{key: values[rng.integers(len(values))]})
    return segment


def size_of(robot: sn.Robot) -> float:
    """Return the longest length of a robot, or what is greater than 0."""
    return max(sum(segment.length[1] for segment in robot.segments), 1e-300)


def odd_scene(robot: sn.Robot, rng: Generator) -> sn.Scene:
    """Obstacles of every kind, anywhere: about the base, around everything, without any thickness."""
    unit = size_of(robot)
    obstacles = [_obstacle(robot, unit, rng) for _ in range(int(rng.choice(OBSTACLES)))]
    scene = sn.Scene(obstacles)
    try:
        scene.prepare()
    except sn.InputError:  # a mesh that is refused as it is
        return sn.Scene()
    return scene


def _obstacle(robot: sn.Robot, unit: float, rng: Generator) -> Any:
    base = robot.base[:3, 3]
    place = base + unit * float(rng.choice([0.0, 0.3, 1.0])) * rng.normal(size=3)
    size = unit * 10.0 ** rng.uniform(-3.0, 0.5)
    turn, end = pose_rotation(rng.normal(size=4)), place + size * rng.normal(size=3)
    surface = solids.cuboid(place, 0.6 * size * rng.uniform(0.1, 1.0, 3), turn)
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


BUDGETS = (0.0, 1e-4, 0.01, 0.05)
"""Seconds of a call."""

PATIENCE, STARTS = 20.0, 4
"""Seconds of a call that starts decide, not the clock; and how many these are."""

METHODS: tuple[Any, ...] = ("newton", "dls", "fabrikc", "fabrikx", "fabrik_avoid", "opti_path", "slinki", "monte_carlo")
"""Names of methods."""

OF_THE_DRAWN = ("scene", "load")
"""What any call may be refused about: an obstacle that moves where none may, and a load that no shape holds."""


class Drawn:
    """A robot and a scene, and what can be asked of them: much is at the edge of what can be said.

    Parameters
    ----------
    rng : Generator
    patient : bool
        Whether starts decide how long a call goes on, so that its answer is the same on every machine.
    """

    def __init__(self, rng: Generator, patient: bool = False) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", sn.SuspiciousInput)
            self.robot = odd_robot(rng)
            self.scene = odd_scene(self.robot, rng)
        self.rng, self.patient, self.unit = rng, patient, size_of(self.robot)

    def perhaps(self, share: float) -> bool:
        """Draw whether something is done that is done in such a share of the cases."""
        return bool(self.rng.random() < share)

    def target(self) -> list[sn.Target]:
        """Draw what a shape of the robot meets, or anything else, or several of these."""
        rng, robot, unit = self.rng, self.robot, self.unit
        if self.perhaps(0.6):
            return asked(robot, self._within_limits()[None], rng)[0]
        place = robot.base[:3, 3] + unit * float(rng.choice([0.0, 1e-9, 0.5, 1.0, 1e3])) * rng.normal(size=3)
        kind = int(rng.integers(5))
        segment = None if self.perhaps(0.7) else int(rng.integers(1, len(robot) + 1))
        if kind == 0:
            return [sn.Target(place, segment=segment)]
        if kind == 1:
            return [sn.Target(place, direction=-robot.base[:3, 2], segment=segment)]
        if kind == 2:
            return [sn.Target(direction=rng.normal(size=3), segment=segment)]
        if kind == 3:
            return [sn.Target(place, rotation=rng.normal(size=4), segment=segment)]
        others = [sn.Target(place + unit * rng.normal(size=3), segment=k + 1) for k in range(len(robot) - 1)]
        return [sn.Target(place), *others]

    def shape(self, share: float = 1.0) -> Any:
        """Draw a configuration (n, 3), in such a share of the cases, and else none."""
        return self._within_limits() if self.perhaps(share) else None

    def _within_limits(self) -> Floats:
        """A configuration within all limits; where actuators forbid what was drawn, a straight one of middle length."""
        q = random_configurations(self.robot, 1, self.rng)[0]
        for share in (1.0 - 1e-9, 0.1, 0.0):
            q[:, :2] *= share
            if share == 0.0:
                q[:, 2] = [0.5 * sum(segment.length) for segment in self.robot.segments]
            if not self.robot.violations(q):
                break
        return q

    def tolerance(self) -> sn.Tolerance | None:
        """Draw any tolerance, or none."""
        if self.perhaps(0.5):
            return None
        return sn.Tolerance(self.unit * 10.0 ** self.rng.uniform(-12, 0), 10.0 ** self.rng.uniform(-12, 0))

    def seconds(self, budget: float) -> float:
        """Return a budget, or one that is never used up."""
        return PATIENCE if self.patient else budget

    def few(self, budget: float) -> dict[str, Any]:
        """Return options of a study: a budget of each solve, or few starts."""
        return {"time": self.seconds(budget)} | ({"max_starts": 2} if self.patient else {})

    def options(self, budget: float | None = None, **more: Any) -> dict[str, Any]:
        """Draw options of a solve, most of them left out; `more` stand in their place."""
        drawn: dict[str, Any] = {"time": self.seconds(float(self.rng.choice(BUDGETS)) if budget is None else budget)}
        drawn["tolerance"] = self.tolerance()
        if self.perhaps(0.3) or self.patient:
            drawn["max_starts"] = STARTS if self.patient else int(self.rng.choice([1, 2, 10, 100]))
        if self.perhaps(0.2):
            drawn["routes"] = False
        if self.perhaps(0.2):
            start, bends, clearance = self.rng.choice([0.0, 1.0], 3).tolist()
            drawn["prefer"] = sn.Preferences(start, bends, 0.1 * clearance * self.unit)
        return drawn | more


def called(seed: int, number: int) -> Judged:
    """Make one call, with a robot, a scene and arguments that can be meant, and ask everything of its answer.

    Returns whether there was an answer; else it was refused with words about an argument, or it is said how it ended.
    """
    drawn = Drawn(np.random.default_rng([seed, 21, number]))
    what = str(drawn.rng.choice(list(CALLS)))
    make, refusals = CALLS[what]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # a warning that is not for the user is a defect
            warnings.simplefilter("ignore", sn.SuspiciousInput)  # much of it is
            ask(make(drawn))
    except sn.InputError as error:
        refused = error.key.partition("[")[0].partition(".")[0] in (*refusals, *OF_THE_DRAWN)
        return Judged(False, "" if refused else f"{what}: InputError {error}")
    except Exception as error:  # whatever it is, it is no answer
        return Judged(False, f"{what}: {type(error).__name__} {error}")
    return Judged(True, "")


def ask(found: Any) -> None:
    """Ask everything of answers: texts, files, checks; nothing may be infinite where a number is."""
    str(found), repr(found)
    if isinstance(found, sn.Motion):
        _ask_motion(found)
    elif isinstance(found, list | tuple | sn.answer.Solutions):
        for each in found:
            ask(each)
    elif isinstance(found, np.ndarray):
        assert np.isfinite(found).all(), "not finite"
    elif isinstance(found, sn.Solution):
        assert not found.solved or found.verify().ok, "verify refutes what is solved"
        ask([found.q, found.worst, found.binding, found.reason])
        json.dumps(found.to_dict(), allow_nan=False)
        pickle.loads(pickle.dumps(found))
    elif isinstance(found, sn.answer.Step):
        ask([found.q, found.active])
    elif isinstance(found, sn.answer.Derivative) and found.regular:
        ask(list(found.q.values()))


def _ask_motion(motion: sn.Motion) -> None:
    json.dumps(motion.to_dict(), allow_nan=False)
    ask([motion.worst, motion.q, *motion.solutions[:3]])
    motion.reversed()
    assert not motion.solved or motion.verify().ok, "verify refutes what is solved"
    with TemporaryDirectory() as folder:
        file = Path(folder) / "file"
        motion.to_csv(file)
        motion.to_npz(file)
        if len(motion.q):
            motion.to_ros(file, joints_per_segment=2)
            motion.at(motion.times[-1])
        if len(motion.q) > 1:
            motion.to_csv(file, rate=3.0 / (motion.times[-1] - motion.times[0]))


def _solve(d: Drawn) -> Any:
    return sn.solve(d.robot, d.target(), d.scene, initial=d.shape(0.4), **d.options())


def _solve_by_method(d: Drawn) -> Any:
    method = METHODS[d.rng.integers(len(METHODS))]
    options = d.options(prefer=None, max_starts=3)
    return sn.solve(d.robot, d.target(), d.scene, initial=d.shape(0.4), method=method, **options)


def _explain(d: Drawn) -> Any:
    found = sn.solve(d.robot, d.target(), d.scene, initial=d.shape(0.3), **d.options(0.01))
    return found, found.explain(d.seconds(0.03))


def _solve_all(d: Drawn) -> Any:
    kind: Any = [None, "route", "shape"][int(d.rng.integers(3))]
    return sn.solve_all(d.robot, d.target(), d.scene, count=3, by=kind, **d.options())


def _solve_many(d: Drawn) -> Any:
    targets = [d.target() for _ in range(4)]
    return list(sn.Solver(d.robot, d.scene, **d.options()).solve_many(targets, d.shape(0.4), workers=1))


def _step(d: Drawn) -> Any:
    solver, steps, q = sn.Solver(d.robot, d.scene, **d.options()), list[Any](), d.shape()
    rates = None if d.perhaps(0.5) else sn.Rates(float(d.rng.choice([1e-6, 1.0])), d.unit)
    for _ in range(3):
        if d.perhaps(0.5):
            twist = np.concatenate([d.rng.normal(size=3), d.unit * d.rng.normal(size=3)])
            steps.append(solver.step(q, twist * float(d.rng.choice([0.0, 1.0, 1e3])), 0.01, rates=rates))
        else:
            steps.append(solver.step(q, dt=0.01, target=d.target(), rates=rates))
        q = steps[-1]
    within = sn.Rates(1.0, d.unit) * float(d.rng.choice([1e-6, 0.1]))
    return steps, solver.solve(d.target(), np.array(q.q), within=within)


def _track(d: Drawn) -> Any:
    start, path = d.shape(0.6), [d.target() for _ in range(int(d.rng.integers(1, 5)))]
    shortest: Any = None if d.perhaps(0.8) else "configuration"
    return sn.track(d.robot, path, d.scene, start=start, shortest=shortest, **d.options())


def _plan(d: Drawn) -> Any:
    goal, more = d.shape() if d.perhaps(0.5) else d.target(), {"duration": 1.0} if d.scene.snapshot().moves else {}
    return sn.plan(d.robot, d.shape(), goal, d.scene, **d.options(**more))


def _timed(d: Drawn) -> Any:
    motion = sn.Motion(d.robot, [d.shape() for _ in range(int(d.rng.integers(2, 8)))], d.scene)
    acceleration = None if d.perhaps(0.3) else sn.Rates(1.0, d.unit)
    blend = 0.0 if acceleration is None else float(d.rng.choice([0.0, 0.1])) * d.unit
    trajectory = motion.timed(sn.Rates(1.0, d.unit, acceleration=acceleration), blend)
    with TemporaryDirectory() as folder:
        trajectory.to_csv(Path(folder) / "file", rate=5.0 / trajectory.duration)
        trajectory.to_ros(Path(folder) / "file")
    t = np.linspace(0.0, trajectory.duration, 20)
    return motion, trajectory.stops, [trajectory.at(t), trajectory.velocity(t), trajectory.acceleration(t)]


def _follow(d: Drawn) -> Any:
    staged = sn.on_stage(d.robot, d.unit) if d.robot.linear is None and d.perhaps(0.7) else d.robot
    base = staged.base
    away = (base[:3, 2] + 0.2 * d.rng.normal(size=3)) * d.unit * d.rng.uniform(0.2, 0.8)
    start, more = (base[:3, 3] + d.unit * base[:3, 2], 1.0) if d.perhaps(0.5) else (base[:3, 3], 1.5)
    points = np.stack([start, start + more * away])
    motion = sn.follow_the_leader(staged, points, d.scene, time=d.seconds(0.01), tip_deviation=0.01 * d.unit)
    return motion, str(motion.deviation(points)) if len(motion.q) else ""


def _reach(d: Drawn) -> Any:
    options: dict[str, Any] = {"spacing": 0.9 * d.unit, "directions": int(d.rng.choice([1, 6])), "workers": 1}
    return sn.studies.reach(d.robot, d.scene, **options, **d.few(0.002))


def _check(d: Drawn) -> Any:
    shapes = np.stack([d.shape() for _ in range(2)])
    checked = sn.check(d.robot, shapes * d.rng.choice([1.0, 1.3]), d.scene, d.target())
    values = d.robot.to_actuators(shapes)
    geometry = d.robot.forward(shapes), d.robot.tip(shapes), d.robot.jacobian(shapes[0]), d.robot.backbone(shapes, 4)
    with TemporaryDirectory() as folder:
        urdf, mjcf = Path(folder) / "arm.urdf", Path(folder) / "arm.xml"
        chain, driven = d.robot.to_urdf(urdf, joints_per_segment=2), d.robot.to_mjcf(mjcf, joints_per_segment=2)
        texts = urdf.read_text(), mjcf.read_text()
    drives = d.robot.from_actuators(values, shapes), chain.values(shapes[0]), driven.controls(shapes[0])
    return checked, geometry, values, drives, texts


def _job(d: Drawn) -> Any:
    """Write a problem, and read it again."""
    job = sn.Job(d.robot, d.target(), d.scene, tolerance=d.tolerance())
    with TemporaryDirectory() as folder:
        job.save(file := Path(folder) / "job.yaml")
        again, text = sn.load(file, sn.Job), file.read_text()
    assert again.robot.equals(d.robot), "another robot was read"
    return text


def _derivative(d: Drawn) -> Any:
    found = sn.solve(d.robot, d.target(), d.scene, **d.options())
    if not found.solved:
        return found
    own = found.derivative(["target", "base", "lengths", *(["obstacles"] if len(d.scene) else [])])  # type: ignore[list-item]
    return found, own, own.active, own.vjp(np.ones_like(found.q)) if own.regular else ""


def _shape_under_load(d: Drawn) -> Any:
    load = sn.Force(d.rng.normal(size=3) * 10.0 ** d.rng.uniform(-6.0, 2.0), d.unit * d.rng.normal(size=3))
    found = d.robot.shape(d.shape(), load)
    pulled = np.array([_gives(d.robot, actuator) for actuator in d.robot.actuators], bool)
    assert np.isnan(found.tensions[~pulled]).all(), "a tension of what runs through nothing that gives"
    return found, found.tip, found.tensions[pulled], found.derivative()


def _gives(robot: sn.Robot, actuator: Actuator) -> bool:
    """Whether a tendon, from the base on, or a chamber runs through a segment that gives way."""
    last = actuator.segment
    through = {"tendon": robot.segments[:last], "chamber": robot.segments[max(0, last - 1) : last]}
    return any(segment.stiffness is not None for segment in through.get(actuator.kind, ()))


def _assess(d: Drawn) -> Any:
    tasks = {"one": d.target(), "path": sn.studies.Follow([d.target() for _ in range(2)])}
    return sn.studies.assess([d.robot, d.robot], tasks, d.scene, **d.few(0.01))


def _calibrate(d: Drawn) -> Any:
    shapes = np.stack([d.shape() for _ in range(int(d.rng.choice([1, 5, 30])))])
    measured = d.robot.tip(shapes)[:, :3, 3] + 1e-3 * d.unit * d.rng.normal(size=(len(shapes), 3))
    found = sn.studies.calibrate(d.robot, d.robot.to_actuators(shapes), measured)
    return found, str(found.explain())


def _design(d: Drawn) -> Any:
    vary = {"base.position[2]": (-0.1 * d.unit, 0.1 * d.unit)}
    if d.perhaps(0.5):
        vary = {"segments[0].radius": (0.0, 0.01 * d.unit)}
    options: dict[str, Any] = {"vary": vary, "minimise": "length", "robots": 4, "budget": 600.0 if d.patient else 0.1}
    return sn.studies.design(d.robot, [d.target()], d.scene, **options, **d.few(0.01))


def _remember(d: Drawn) -> Any:
    """Explore for a moment, keep it in a file, and solve and plan with it."""
    options = d.options(0.02)
    found = sn.studies.explore(d.robot, d.scene, rounds=1, workers=1, **options)
    with TemporaryDirectory() as folder:
        found.memory.save(file := Path(folder) / "arm.memory")
        memory = sn.Memory.load(file)
    solved = sn.solve(d.robot, d.target(), d.scene, memory=memory, **options)
    return found, solved, sn.plan(d.robot, d.shape(), d.target(), d.scene, memory=memory, **options)


def _batch(d: Drawn) -> Any:
    places: Floats = d.robot.base[:3, 3] + d.unit * d.rng.normal(size=(5, 3))
    with TemporaryDirectory() as folder:
        out = Path(folder) / f"out.{d.rng.choice(['npz', 'csv'])}"
        found = sn.studies.solve_batch(d.robot, {"positions": places}, d.scene, out, workers=1, **d.options())
        assert out.exists(), "nothing was written"
    return found.counts


CALLS: dict[str, tuple[Callable[[Drawn], Any], tuple[str, ...]]] = {
    "solve": (_solve, ()),
    "solve by method": (_solve_by_method, ("method", "target", "targets", "robot")),
    "explain": (_explain, ()),
    "solve_all": (_solve_all, ()),
    "solve_many": (_solve_many, ()),
    "step": (_step, ("within",)),
    "track": (_track, ()),
    "plan": (_plan, ()),
    "timed": (_timed, ("motion", "rates", "gravity")),
    "follow_the_leader": (_follow, ("robot", "curve", "gravity")),
    "reach": (_reach, ("spacing", "robot")),
    "check": (_check, ("q",)),
    "job": (_job, ("scene",)),
    "derivative": (_derivative, ("gravity",)),
    "shape under load": (_shape_under_load, ("stiffness", "load")),
    "assess": (_assess, ()),
    "calibrate": (_calibrate, ("measured", "robot", "actuators")),
    "design": (_design, ("tasks",)),
    "remember": (_remember, ("gravity",)),
    "batch": (_batch, ()),
}
"""Each call, which returns its answers, and the arguments about which it may be refused as they are drawn."""
