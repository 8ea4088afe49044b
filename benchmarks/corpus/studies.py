"""Studies of robots: calibrations, designs, assessments, maps of the workspace, batches, memories, learned starts."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import sinuous as sn
from benchmarks.corpus.answers import Problem
from benchmarks.design import problem
from benchmarks.real import captured_robot, rows_of
from benchmarks.wild import audit, odd, worlds

BUDGET: dict[str, Any] = {"time": 20.0, "max_starts": 6}

TASKS = 8
"""Of a robot that is assessed."""


def calibrations() -> Iterator[Problem]:
    """Robots of motion capture and odd ones, fitted as told and by choice; settings that are worth measuring."""
    for name in ("v4", "v6"):
        robot = captured_robot(name)
        rows = rows_of(robot, f"{name}_train")
        given = rows.actuators[::40], rows.measured[::40]
        for fit in (["offsets"], ["lengths", "angles"], ["stretch", "offsets", "circles"]):
            yield Problem(f"{name}: {', '.join(fit)}", partial(sn.studies.calibrate, robot, *given, fit=fit))
        yield Problem(f"{name}: by choice", partial(sn.studies.calibrate, robot, *(each[::3] for each in given)))
    for number in range(16):
        rng = np.random.default_rng([81, number])
        drive: Any = sn.Tendons(3, radius=4.0) if number % 2 else sn.Chambers(3, radius=4.0)
        kind = {"tendons": drive} if number % 2 else {"chambers": drive}
        robot = sn.Robot.uniform(2, 60.0 if number % 2 else (50.0, 70.0), max_bend=1.6, radius=5.0, **kind)
        bends = rng.uniform(-0.8, 0.8, (16, 2, 2))
        shapes = np.concatenate([bends, np.full((16, 2, 1), 60.0)], axis=2)
        yield Problem(f"drawn {number}", partial(_calibrated, robot, shapes, rng.normal(0.0, 0.3, (16, 3))))
    for i in range(4):
        tendons = sn.Tendons(3, radius=4.0, displacement=(-8.0, 8.0))
        arm = sn.Robot.uniform(2 + i % 2, 60.0, max_bend=1.6, radius=5.0, tendons=tendons)
        yield Problem(f"suggested {i}", partial(sn.studies.suggest, arm, 5 + i, seed=i))


def _calibrated(robot: sn.Robot, shapes: Any, off: Any) -> Any:
    found = sn.studies.calibrate(robot, robot.to_actuators(shapes), robot.tip(shapes)[:, :3, 3] + off)
    some = robot.to_actuators(shapes[:5]), robot.tip(shapes[:5])[:, :3, 3]
    return found, found.bound(), found.predict(some[0]), found.for_motion(*some).to_dict()


def designs() -> Iterator[Problem]:
    """Robots for tasks: of every objective, and two at once."""
    for number in range(6):
        asked = problem(number, np.random.default_rng([82, number]))
        ask = partial(
            sn.studies.design, asked.template, asked.tasks[:3], asked.scene, vary=asked.vary, robots=10, budget=600.0
        )
        yield Problem(asked.name, partial(ask, minimise=asked.minimise, workers=1, **BUDGET))
        if number < 2:
            yield Problem(f"{asked.name}, and bend", partial(ask, minimise=("clearance", "bend"), workers=1, **BUDGET))


def assessments() -> Iterator[Problem]:
    """Variations of a robot, and odd robots, that do several kinds of tasks."""
    for number in range(8):
        asked = problem(number, np.random.default_rng([83, number]))
        if len(asked.tasks) < TASKS:
            continue
        robots = sn.studies.sweep(asked.template, {"segments.length": [90.0, 110.0], "radius": [3.0, 4.0]})
        tasks = {
            "one": asked.tasks[0],
            "path": sn.studies.Follow(asked.tasks[1:4]),
            "all": sn.studies.Cover(asked.tasks[4:TASKS], share=0.5),
        }
        yield Problem(asked.name, partial(sn.studies.assess, robots, tasks, asked.scene, **BUDGET))
    for number in range(30):
        rng = np.random.default_rng([84, number])
        robot = odd.robot(rng)
        scene, target = odd.scene(robot, rng), odd.target(robot, rng)
        yield Problem(
            f"odd {number}",
            partial(
                sn.studies.assess,
                robot,
                {"one": target, "path": sn.studies.Follow([target])},
                scene,
                time=20.0,
                max_starts=2,
            ),
        )


def maps() -> Iterator[Problem]:
    """Maps of what robots reach, among obstacles or not."""
    for number in range(16):
        world = audit.units(6, number)
        spacing = 0.4 * world.robot.mean_length
        yield Problem(f"{number}", partial(_map, world.robot, world.scene, spacing))


def _map(robot: sn.Robot, scene: sn.Scene, spacing: float) -> Any:
    found = sn.studies.reach(robot, scene, spacing=spacing, directions=6, time=20.0, max_starts=2, workers=2)
    return found, found.share, found.volume(), found.blame()


def batches() -> Iterator[Problem]:
    """Tables of targets: in memory, through files, from near to near, and in shards; with their derivatives."""
    for number in range(10):
        world = worlds.make(7, number)
        positions = world.robot.tip(world.hidden)[:, :3, 3]
        ask = partial(
            sn.studies.solve_batch, world.robot, {"positions": positions}, world.scene, chunk=8, workers=2, **BUDGET
        )
        yield Problem(f"{number}", ask)
        yield Problem(f"{number} warm", partial(ask, warm=True))
        for kind in ("npz", "csv"):
            yield Problem(f"{number} {kind}", partial(_table, ask, kind))


def _table(ask: Callable[..., Any], kind: str) -> Any:
    with TemporaryDirectory() as folder:
        out = Path(folder) / f"out.{kind}"
        counts = ask(out=out).counts
        if kind == "csv":
            head, *rows = [line.split(",") for line in out.read_text().splitlines()]
            return counts, [dict(zip(head, row, strict=True)) for row in rows]
        with np.load(out, allow_pickle=False) as table:
            return counts, dict(table)


def memories() -> Iterator[Problem]:
    """Memories that are filled ahead, kept in files, and used by solves and plans."""
    for number in range(12):
        world = worlds.make(8, number)
        yield Problem(f"{number}", partial(_remembered, world))


def _remembered(world: worlds.World) -> Any:
    found = sn.studies.explore(world.robot, world.scene, rounds=2, workers=1, time=600.0, max_starts=4)
    with TemporaryDirectory() as folder:
        found.memory.save(Path(folder) / "arm.memory")
        memory = sn.Memory.load(Path(folder) / "arm.memory")
    explored = found.memory.q, found.memory.edges, found.shapes, found.motions
    solver = sn.Solver(world.robot, world.scene, tolerance=world.tolerance, memory=memory, **BUDGET)
    solved = [solver.solve(targets) for targets in world.targets[:6]]
    plan = sn.plan(world.robot, world.hidden[0], world.hidden[-1], world.scene, memory=memory, time=20.0)
    return explored, solved, plan, memory.q


def learned() -> Iterator[Problem]:
    """The method that learns, and what it finds."""
    for i in range(2):
        yield Problem(f"{i}", partial(_learned, sn.Robot.uniform(3 + i, (45, 70), max_bend=2.0, radius=4.0), i))


def _learned(robot: sn.Robot, seed: int) -> Any:
    network = sn.methods.train(robot, samples=300, width=16, rounds=3, seed=seed)
    rng = np.random.default_rng([85, seed])
    targets = [sn.Target(place) for place in rng.uniform((-60, -60, 100), (60, 60, 160), (20, 3))]
    method = sn.methods.Learned(network=network)
    return [sn.solve(robot, target, method=method, time=20.0, max_starts=4) for target in targets]


PIECES: dict[str, Callable[[], Iterator[Problem]]] = {
    "calibrations": calibrations,
    "designs": designs,
    "assessments": assessments,
    "maps": maps,
    "batches": batches,
    "memories": memories,
    "learned": learned,
}
