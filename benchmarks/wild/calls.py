"""Public calls of odd robots in odd scenes: each ends in an answer, or in an `InputError` about what was given."""

import json
import pickle
import tempfile
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.harness.lines import Goal, Line
from benchmarks.wild import odd
from benchmarks.wild.trials import named

SECTION = "public calls of odd robots in odd scenes: whether each ends in an answer"

BUDGETS = (0.0, 1e-4, 0.01, 0.05)
"""Seconds of a call."""

WHY = 0.03
"""Seconds of an explanation."""

METHODS: tuple[Any, ...] = ("newton", "dls", "fabrikc", "fabrikx", "fabrik_avoid", "opti_path", "slinki", "monte_carlo")
"""Names of methods."""


OF_THE_DRAWN = ("scene", "load")
"""What any call may be refused about: an obstacle that moves where none may, and a load that no shape holds."""


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
        warnings.simplefilter("ignore", sn.SuspiciousInput)
        robot = odd.robot(rng)
        scene = odd.scene(robot, rng)
    what = str(rng.choice(list(CALLS)))
    make, refusals = CALLS[what]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # a warning that is not for the user is a defect
            warnings.simplefilter("ignore", sn.SuspiciousInput)  # much of it is
            make(robot, scene, rng)
    except sn.InputError as error:
        if error.key.partition("[")[0].partition(".")[0] in (*refusals, *OF_THE_DRAWN):
            return Called(what, False, "")
        return Called(what, False, f"InputError {error}")
    except Exception as error:  # whatever it is, it is no answer
        return Called(what, False, f"{type(error).__name__} {error}")
    return Called(what, True, "")


def lines_of(kind: str, shares: Sequence[Sequence[Sequence[Any]]]) -> list[Line]:
    """Sum up calls, of which shares hold plain values: how many were answered, and which ended otherwise."""
    made = [Called(*each) for share in shares for each in share]
    answered = sum(each.answered for each in made)
    wrong = [f"{i}: {each.what}: {each.false}" for i, each in enumerate(made) if each.false]
    return [
        Line(SECTION, f"{kind}: answered", 100.0 * answered / len(made), "%", None, None, (answered, len(made))),
        Line(SECTION, f"{kind}: exceptions", len(wrong), "", Goal(0, correctness=True), note=named(wrong)),
    ]


def _options(robot: sn.Robot, rng: Generator) -> dict[str, Any]:
    """Options of a solve, most of them left out."""
    options: dict[str, Any] = {"time": float(rng.choice(BUDGETS)), "tolerance": odd.tolerance(robot, rng)}
    if rng.random() < 0.3:
        options["max_starts"] = int(rng.choice([1, 2, 10, 100]))
    if rng.random() < 0.2:
        options["routes"] = False
    if rng.random() < 0.2:
        start, bends, clearance = rng.choice([0.0, 1.0], 3).tolist()
        options["prefer"] = sn.Preferences(start, bends, 0.1 * clearance * odd.size(robot))
    return options


def _ask(answer: sn.Solution) -> None:
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


def _solve(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    initial = odd.shape(robot, rng) if rng.random() < 0.4 else None
    _ask(sn.solve(robot, odd.target(robot, rng), scene, initial=initial, **_options(robot, rng)))


def _solve_by_method(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    method = METHODS[rng.integers(len(METHODS))]
    initial = odd.shape(robot, rng) if rng.random() < 0.4 else None
    options = {**_options(robot, rng), "prefer": None, "max_starts": 3}
    _ask(sn.solve(robot, odd.target(robot, rng), scene, initial=initial, method=method, **options))


def _explain(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    initial = odd.shape(robot, rng) if rng.random() < 0.3 else None
    found = sn.solve(robot, odd.target(robot, rng), scene, initial=initial, **{**_options(robot, rng), "time": 0.01})
    str(found.explain(WHY))


def _solve_all(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    kind = [None, "route", "shape"][int(rng.integers(3))]
    options = _options(robot, rng)
    for answer in sn.solve_all(robot, odd.target(robot, rng), scene, count=3, by=kind, **options):  # type: ignore[arg-type]
        _ask(answer)


def _solve_many(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    solver = sn.Solver(robot, scene, **_options(robot, rng))
    targets = [odd.target(robot, rng) for _ in range(4)]
    initial = odd.shape(robot, rng) if rng.random() < 0.4 else None
    for answer in solver.solve_many(targets, initial, workers=1):
        _ask(answer)


def _step(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    solver = sn.Solver(robot, scene, **_options(robot, rng))
    q: Any = odd.shape(robot, rng)
    unit = odd.size(robot)
    rates = None if rng.random() < 0.5 else sn.Rates(float(rng.choice([1e-6, 1.0])), unit)
    for _ in range(3):
        if rng.random() < 0.5:
            twist = np.concatenate([rng.normal(size=3), unit * rng.normal(size=3)])
            step = solver.step(q, twist * float(rng.choice([0.0, 1.0, 1e3])), 0.01, rates=rates)
        else:
            step = solver.step(q, dt=0.01, target=odd.target(robot, rng), rates=rates)
        assert np.isfinite(step.q).all(), "q is not finite"
        str(step), repr(step), step.active
        q = step
    within = sn.Rates(1.0, unit) * float(rng.choice([1e-6, 0.1]))
    _ask(solver.solve(odd.target(robot, rng), np.array(q.q), within=within))


def _track(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    start = odd.shape(robot, rng) if rng.random() < 0.6 else None
    path = [odd.target(robot, rng) for _ in range(int(rng.integers(1, 5)))]
    shortest = None if rng.random() < 0.8 else "configuration"
    _ask_motion(sn.track(robot, path, scene, start=start, shortest=shortest, **_options(robot, rng)))  # type: ignore[arg-type]


def _plan(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    goal: Any = odd.shape(robot, rng) if rng.random() < 0.5 else odd.target(robot, rng)
    options = _options(robot, rng)
    if scene.snapshot().moves:
        options["duration"] = 1.0
    _ask_motion(sn.plan(robot, odd.shape(robot, rng), goal, scene, **options))


def _timed(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    motion = sn.Motion(robot, [odd.shape(robot, rng) for _ in range(int(rng.integers(2, 8)))], scene)
    _ask_motion(motion)
    unit = odd.size(robot)
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


def _follow(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    unit = odd.size(robot)
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


def _reach(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    unit = odd.size(robot)
    found = sn.studies.reach(
        robot, scene, spacing=0.9 * unit, directions=int(rng.choice([1, 6])), time=0.002, workers=1
    )
    str(found), repr(found)


def _check(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    shapes = np.stack([odd.shape(robot, rng) for _ in range(2)])
    sn.check(robot, shapes * rng.choice([1.0, 1.3]), scene, odd.target(robot, rng))
    robot.from_actuators(robot.to_actuators(shapes), shapes)
    robot.jacobian(shapes[0])
    with tempfile.TemporaryDirectory() as folder:
        robot.to_urdf(Path(folder) / "arm.urdf", joints_per_segment=2)
        robot.to_mjcf(Path(folder) / "arm.xml", joints_per_segment=2)


def _job(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    """Write a problem, and read it again."""
    job = sn.Job(robot, odd.target(robot, rng), scene, tolerance=odd.tolerance(robot, rng))
    with tempfile.TemporaryDirectory() as folder:
        job.save(Path(folder) / "job.yaml")
        again = sn.load(Path(folder) / "job.yaml", sn.Job)
    assert again.robot.equals(robot), "another robot was read"


def _derivative(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    found = sn.solve(robot, odd.target(robot, rng), scene, **_options(robot, rng))
    if not found.solved:
        return
    own = found.derivative(["target", "base", "lengths", "obstacles"] if len(scene) else ["target", "base", "lengths"])
    str(own), repr(own), own.active
    if own.regular:
        assert all(np.isfinite(each).all() for each in own.q.values()), "a derivative is not finite"
        own.vjp(np.ones_like(found.q))


def _shape_under_load(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    unit = odd.size(robot)
    load = sn.Force(rng.normal(size=3) * 10.0 ** rng.uniform(-6.0, 2.0), unit * rng.normal(size=3))
    found = robot.shape(odd.shape(robot, rng), load)
    assert np.isfinite(found.tip).all(), "a tip is not finite"
    str(found), repr(found), found.tensions
    found.derivative()
    del scene


def _assess(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    tasks = {"one": odd.target(robot, rng), "path": sn.studies.Follow([odd.target(robot, rng) for _ in range(2)])}
    found = sn.studies.assess([robot, robot], tasks, scene, time=0.01)
    str(found), repr(found)


def _calibrate(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    shapes = np.stack([odd.shape(robot, rng) for _ in range(int(rng.choice([1, 5, 30])))])
    measured = robot.tip(shapes)[:, :3, 3] + 1e-3 * odd.size(robot) * rng.normal(size=(len(shapes), 3))
    found = sn.studies.calibrate(robot, robot.to_actuators(shapes), measured)
    str(found), repr(found), str(found.explain())
    del scene


def _design(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    size = odd.size(robot)
    vary = {"base.position[2]": (-0.1 * size, 0.1 * size)}
    if rng.random() < 0.5:
        vary = {"segments[0].radius": (0.0, 0.01 * size)}
    found = sn.studies.design(
        robot, [odd.target(robot, rng)], scene, vary=vary, minimise="length", robots=4, budget=0.1, time=0.01
    )
    str(found), repr(found)


def _remember(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    """Explore for a moment, keep it in a file, and solve and plan with it."""
    options = {**_options(robot, rng), "time": 0.02}
    found = sn.studies.explore(robot, scene, rounds=1, workers=1, **options)
    str(found), repr(found)
    with tempfile.TemporaryDirectory() as folder:
        found.memory.save(Path(folder) / "arm.memory")
        memory = sn.Memory.load(Path(folder) / "arm.memory")
    _ask(sn.solve(robot, odd.target(robot, rng), scene, memory=memory, **options))
    _ask_motion(sn.plan(robot, odd.shape(robot, rng), odd.target(robot, rng), scene, memory=memory, **options))


def _batch(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> None:
    places = robot.base[:3, 3] + odd.size(robot) * rng.normal(size=(5, 3))
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / f"out.{rng.choice(['npz', 'csv'])}"
        found = sn.studies.solve_batch(robot, {"positions": places}, scene, out, workers=1, **_options(robot, rng))
        str(found), repr(found)
        assert out.exists(), "nothing was written"


Make = Callable[[sn.Robot, sn.Scene, Generator], None]

CALLS: dict[str, tuple[Make, tuple[str, ...]]] = {
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
"""Each call, and the arguments about which it may be refused as they are drawn."""
