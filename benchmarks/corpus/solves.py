"""Solves: one target, several at once, all solutions, many targets, every method, under load; and derivatives."""

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Any

import numpy as np

import sinuous as sn
from benchmarks.corpus.answers import Problem
from benchmarks.derivatives import families
from benchmarks.places import FAMILIES, Place, make
from benchmarks.places.place import right
from benchmarks.problems import clutter, full_poses, paper_poses
from benchmarks.real import loaded_robot
from benchmarks.wild import audit, doors, odd, trials, worlds
from benchmarks.wild.worlds import World

BUDGET: dict[str, Any] = {"time": 30.0, "max_starts": 40}
"""Of a solve: the starts decide, not the seconds."""

FEW: dict[str, Any] = {"time": 30.0, "max_starts": 6}
"""The same where many problems are impossible."""

METHODS = ("newton", "dls", "fabrikc", "fabrikx", "fabrik_avoid", "opti_path", "slinki", "monte_carlo")


def places(names: Iterable[str], seeds: Iterable[int]) -> Iterator[Problem]:
    """Solve in intricate places."""
    for name in names:
        for seed in seeds:
            place = make(name, seed)
            yield Problem(f"{name} {seed}", partial(_in_place, place), partial(_right_in_place, place))


def _in_place(place: Place) -> sn.Solution:
    return sn.solve(place.robot, place.targets, place.scene, tolerance=place.tolerance, **BUDGET)


def _right_in_place(place: Place, found: sn.Solution) -> bool:
    return found.solved and right(place, found.q)


def wild(make: Callable[[int], World], numbers: Iterable[int], count: int) -> Iterator[Problem]:
    """Solve the first problems of wild worlds, each with one solver."""
    for number in numbers:
        world = make(number)
        solver = sn.Solver(world.robot, world.scene, tolerance=world.tolerance, **(BUDGET if world.possible else FEW))
        for i, targets in enumerate(world.targets[:count]):
            judge = partial(_right_in_world, world, i)
            yield Problem(f"{number}.{i}", partial(solver.solve, targets), judge)


def _right_in_world(world: World, i: int, found: sn.Solution) -> bool:
    return not trials.refuted(world, {i: found})[i]


def published() -> Iterator[Problem]:
    """Every method on problems of the literature and on random ones, from one start and from ten."""
    sets = {
        "paper": paper_poses(),
        "full poses": full_poses(0, 12),
        **{f"clutter {i}": clutter(i, 8) for i in range(4)},
    }
    for name, problems in sets.items():
        for method in METHODS:
            for starts in (1, 10):
                options: dict[str, Any] = {"method": method, "max_starts": starts, "time": 30.0, "routes": starts > 1}
                for i, target in enumerate(problems.targets):
                    ask = partial(sn.solve, problems.robot, target, problems.scene, tolerance=problems.tolerance)
                    yield Problem(f"{name} {i}, {method}, {starts} starts", partial(ask, **options))


def explained() -> Iterator[Problem]:
    """Problems of which half may be impossible, and why."""
    for seed in range(20):
        problems = clutter(100 + seed, 8)
        for i, target in enumerate(problems.targets):
            yield Problem(f"{seed}.{i}", partial(_explained, problems.robot, target, problems.scene))


def _explained(robot: sn.Robot, target: Any, scene: sn.Scene) -> Any:
    found = sn.solve(robot, target, scene, **FEW)
    return found, found.verify(), found.explain(time=60.0)


def several() -> Iterator[Problem]:
    """All solutions: of poses, through doors, by route and by shape."""
    for i, target in enumerate(full_poses(1, 40).targets):
        ask = partial(sn.solve_all, sn.Robot.uniform(3, 1.0, 3.0), target, count=16, **BUDGET)
        yield Problem(f"pose {i}", ask)
    for number in range(10):
        wall = doors.make(0, number)
        for by in ("route", "shape"):
            yield Problem(
                f"wall {number} by {by}", partial(sn.solve_all, doors.ROBOT, wall.target, wall.scene, by=by, **BUDGET)
            )
    for seed in range(10):
        problems = clutter(seed, 2)
        ask = partial(sn.solve_all, problems.robot, problems.targets[0], problems.scene, count=4, **FEW)
        yield Problem(f"clutter {seed}", ask)


def many() -> Iterator[Problem]:
    """Many targets at once, with and without initial shapes, by two workers."""
    for number in range(12):
        world = worlds.make(1, number)
        solver = sn.Solver(world.robot, world.scene, tolerance=world.tolerance, **FEW)
        ask = partial(solver.solve_many, world.targets[:24], workers=2)
        yield Problem(f"{number}", ask)
        yield Problem(f"{number} from a shape", partial(ask, world.hidden[0]))
    for number in range(6):
        world = audit.units(1, number)
        positions = world.robot.tip(world.hidden)[:, :3, 3]
        yield Problem(f"positions {number}", partial(_many_derived, world, positions))


def _many_derived(world: World, positions: Any) -> Any:
    found = sn.Solver(world.robot, world.scene, **FEW).solve_many(positions=positions, workers=1)
    return found, found.derivative(("target", "base"))


def preferring() -> Iterator[Problem]:
    """Answers that preferences choose, from an initial shape, within a change of it, with clearances demanded."""
    for number in range(24):
        world = audit.units(2, number)
        rng = np.random.default_rng([31, number])
        robot, scene, unit, near = world.robot, world.scene, world.robot.mean_length, world.hidden[-1]
        start, bends = rng.choice([0.0, 1.0], 2).tolist()
        prefer = sn.Preferences(start, bends, 0.05 * unit)
        ask = partial(sn.solve, robot, world.targets[0], scene)
        yield Problem(f"{number} preferring", partial(ask, initial=near, prefer=prefer, **FEW))
        yield Problem(f"{number} demanding", partial(ask, clearance=0.01 * unit, self_clearance=0.01 * unit, **FEW))
        within = sn.Rates(1.0, unit) * 0.1
        yield Problem(
            f"{number} within", partial(sn.Solver(robot, scene).solve, world.targets[0], near, within=within, time=30.0)
        )


def under_gravity() -> Iterator[Problem]:
    """Solves under load: of wild robots among obstacles, and of arms of several sections."""
    for number in range(30):
        world = audit.loaded(0, number)
        solver = sn.Solver(world.robot, world.scene, time=30.0, max_starts=20)
        for i, targets in enumerate(world.targets[:4]):
            yield Problem(f"{number}.{i}", partial(solver.solve, targets), partial(_right_in_world, world, i))
    for sections in (3, 5):
        robot, rng = loaded_robot(sections), np.random.default_rng(sections)
        balls = [sn.Sphere(place, 0.02) for place in rng.uniform(-0.35, 0.35, (12, 3)) if np.linalg.norm(place) > 0.15]
        for i, place in enumerate(rng.uniform((-0.2, -0.2, 0.1), (0.2, 0.2, 0.5), (20, 3))):
            yield Problem(
                f"{sections} sections {i}", partial(sn.solve, robot, sn.Target(place), balls, time=30.0, max_starts=12)
            )


def shapes() -> Iterator[Problem]:
    """Shapes under load, from configurations and from actuators, with derivatives; tensions of elastic tendons."""
    for i in range(40):
        yield Problem(f"equilibrium {i}", partial(_derived_load, i))
    for i in range(24):
        yield Problem(f"elastic {i}", partial(_elastic, i))


def _derived_load(i: int) -> Any:
    found = families.loaded(np.random.default_rng([41, i]))
    return found, found.backbone(6), found.derivative(("loads",)), found.others(4) if i % 4 == 0 else None


def _elastic(i: int) -> Any:
    rng = np.random.default_rng([42, i])
    tendons = sn.Tendons(3, 0.005, displacement=(-0.02, 0.02), stiffness=float(rng.uniform(50.0, 500.0)))
    robot = sn.Robot.uniform(
        2,
        0.1,
        max_bend=2.0,
        radius=0.006,
        tendons=tendons,
        stiffness=sn.Stiffness(0.01, 0.008),
        mass=0.05,
        arcs=3,
        gravity=(0.0, 0.0, -9.81),
    )
    q = np.column_stack([rng.uniform(-0.6, 0.6, (2, 2)), np.full(2, 0.1)])
    pulled = robot.to_actuators(q)
    return pulled, robot.from_actuators(pulled, q), robot.tensions(pulled), robot.slack(pulled)


def derived() -> Iterator[Problem]:
    """Derivatives of answers with something active, and what verification says of them."""
    for family in families.FAMILIES:
        for i in range(30):
            yield Problem(f"{family} {i}", partial(_derived, family, i))


def _derived(family: str, i: int) -> Any:
    found = families.draw(family, np.random.default_rng([51, i]))
    if found is None:
        return None
    wrt: Any = ("target", "base", "lengths", *(("obstacles",) if len(found.problem.scene) else ()))
    own = found.derivative(wrt)
    return found, found.verify(), own, own.vjp(np.ones_like(found.q)), own.labels("target")


def kinematics() -> Iterator[Problem]:
    """Poses, Jacobians, actuators and checks of shapes of odd robots in odd scenes."""
    for number in range(500):
        rng = np.random.default_rng([61, number])
        robot = odd.robot(rng)
        yield Problem(f"{number}", partial(_kinematics, robot, odd.scene(robot, rng), odd.shape(robot, rng)))


def _kinematics(robot: sn.Robot, scene: sn.Scene, q: Any) -> Any:
    pulled = robot.to_actuators(q)
    geometry = robot.forward(q), robot.tip(q), robot.jacobian(q), robot.backbone(q, 4), robot.to_dict()
    return (
        geometry,
        pulled,
        robot.from_actuators(pulled, q),
        sn.check(robot, 1.1 * q, scene.at(0.0)),
        robot.undetermined,
    )


def odd_solves() -> Iterator[Problem]:
    """Odd targets of odd robots in odd scenes: much is at an edge of what can be meant."""
    for number in range(500):
        rng = np.random.default_rng([62, number])
        robot = odd.robot(rng)
        scene, target, tolerance = odd.scene(robot, rng).at(0.0), odd.target(robot, rng), odd.tolerance(robot, rng)
        initial = odd.shape(robot, rng) if number % 3 == 0 else None
        ask = partial(sn.solve, robot, target, scene, initial=initial, tolerance=tolerance, time=30.0, max_starts=4)
        yield Problem(f"{number}", ask)


ALL = tuple(name for name, family in FAMILIES.items() if not family.joints)
TRAPS = tuple(name for name in ALL if FAMILIES[name].trap and not FAMILIES[name].judging)
OPEN = tuple(name for name in ALL if name not in TRAPS)

PIECES: dict[str, Callable[[], Iterator[Problem]]] = {
    "places": partial(places, OPEN[::2], range(5)),
    "more places": partial(places, OPEN[1::2], range(5)),
    "traps": partial(places, TRAPS[::2], range(4)),
    "more traps": partial(places, TRAPS[1::2], range(4)),
    "wild worlds": partial(wild, partial(worlds.make, 0), range(60), 12),
    "wild mounts": partial(wild, partial(audit.mounts, 0), range(12), 6),
    "wild units": partial(wild, partial(audit.units, 0), range(12), 6),
    "wild huge": partial(wild, partial(audit.huge, 0), range(60), 1),
    "wild bodies": partial(wild, partial(audit.bodies, 0), range(12), 6),
    "wild radii": partial(wild, partial(audit.radii, 0), range(12), 6),
    "wild bounds": partial(wild, partial(audit.bounds, 0), range(8), 4),
    "wild demands": partial(wild, partial(audit.demands, 0), range(12), 6),
    "curled": partial(wild, partial(worlds.thick_arm, 6, 0), range(2), 50),
    "odd solves": odd_solves,
    "methods": published,
    "explained": explained,
    "solve all": several,
    "solve many": many,
    "preferences": preferring,
    "under load": under_gravity,
    "equilibria": shapes,
    "derivatives": derived,
    "kinematics": kinematics,
}
