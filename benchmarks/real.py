"""`python -m benchmarks real`: robots as they are, each figure beside the published one.

Two robots are calibrated from motion capture, and judged on motions that the fit did not see. A tendon robot and rods
are held against what others computed, a soft tentacle against what was measured (facts of these projects:
`benchmarks/data/README.md`), and solves under gravity and payload against Cosserat rods;
control steps under load are timed.
"""

import csv
import math
from collections.abc import Iterator
from contextlib import suppress
from functools import partial
from itertools import islice
from pathlib import Path
from time import thread_time
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

import sinuous as sn
from benchmarks.harness import Goal, Line, Part, Plan, Times, timed
from benchmarks.judges.cosserat import shoot
from benchmarks.judges.kinematics import tip_poses
from benchmarks.motion.loops import stepped
from sinuous.base.checks import Floats
from sinuous.statics.equilibrium import run
from sinuous.studies.calibration.measurements import Measured, read_table

DATA = Path(__file__).parent / "data"

PUBLISHED = "published for their MuJoCo model: 4.1 % (arXiv 2606.22397)"

MOTIONS = ("pair12", "pair13", "pair23", "seg")
"""Kinds of motion of the rows with which robots are fitted; each is left out in turn."""

OF_IT = 40
"""Rows of a motion, evenly spread over it, that bound the errors of its other rows."""


def captured_robot(name: str) -> sn.Robot:
    """A robot as drawn."""
    return sn.load(DATA / f"{name}.yaml", sn.Robot)


def rows_of(robot: sn.Robot, name: str) -> Measured:
    """Measurements of a robot."""
    return read_table(DATA / f"tdcr_{name}.csv", [actuator.name for actuator in robot.actuators])


def off(robot: sn.Robot, rows: Measured) -> Floats:
    """Errors (N,) of the tip, with kinematics of the judges."""
    tips = tip_poses(robot, robot.from_actuators(rows.actuators))[:, :3, 3]
    result: Floats = np.linalg.norm(tips - rows.measured, axis=1)
    return result


def within_of_some(found: sn.studies.Calibration, rows: Measured, errors: Floats) -> float:
    """Percent of rows (N,) of a motion within the bound of some of it, the mean of all ways to spread these."""
    step, shares = max(2, len(errors) // OF_IT), []
    for first in range(step):
        some = np.arange(len(errors)) % step == first
        bound = found.for_motion(rows.actuators[some], rows.measured[some]).uncertainty
        assert bound is not None
        shares.append(float((errors[~some] <= bound.bound).mean()))
    return 100.0 * float(np.mean(shares))


def fitted(name: str, plan: Plan) -> Iterator[Line]:
    """Fit a robot to all its rows; hold back kinds of motion, and, of v4, motions that were never fitted."""
    robot = captured_robot(name)
    length, rows = robot.mean_length, rows_of(robot, f"{name}_train")
    groups = rows.groups or ()
    sn.studies.calibrate(robot, rows.actuators[:60], rows.measured[:60])  # kernels are loaded
    own, spent = timed(sn.studies.calibrate, robot, rows.actuators, rows.measured, groups=groups)
    where = f"{name}, {len(groups)} rows, {own.drawn.mean_length:g} mm"
    yield Line(where, "a fit that chooses its parameters", spent, "s", Goal(5.0))
    yield Line(where, "mean error of the tip, fitted rows", 100.0 * off(own.robot, rows).mean() / length, "%")
    yield Line(where, "mean error, rows held back by the fit", 100.0 * own.expected.mean / length, "%")
    errors, bounds, likes, some = [], [], [], []
    for family in MOTIONS[: plan.count(len(MOTIONS), 1)]:
        other = np.array([family not in label for label in groups])
        labels = [label for label, kept in zip(groups, other, strict=True) if kept]
        part = sn.studies.calibrate(robot, rows.actuators[other], rows.measured[other], groups=labels)
        held = Measured(rows.actuators[~other], rows.measured[~other], None)
        errors.append(off(part.robot, held))
        bounds.append(errors[-1] <= part.bound())
        likes.append(errors[-1] <= part.bound(of="rows"))
        some.append(within_of_some(part, held, errors[-1]))
    each = ", ".join(f"{f} {100.0 * e.mean() / length:.1f}" for f, e in zip(MOTIONS, errors, strict=False))
    mean = 100.0 * float(np.concatenate(errors).mean()) / length
    goal = Goal(4.0) if name == "v6" else None
    yield Line(where, "mean error, each kind of motion left out in turn", mean, "%", goal, note=each)
    for of, kept in (("patterns", bounds), ("rows", likes)):
        share = 100.0 * float(np.concatenate(kept).mean())
        yield Line(where, f"rows of these within the bound of {of} at 95 %", share, "%", Goal(93.0, at_most=False))
    what = f"the same within the bound of {OF_IT} of each kind (for_motion), the kind with least"
    yield Line(where, what, min(some), "%", Goal(93.0, at_most=False), note=f"most {max(some):.1f} %")
    if name == "v4":
        val = rows_of(robot, "v4_val")
        errors_of = off(own.robot, val)
        reached = 100.0 * float(errors_of.mean()) / length
        worst = f"worst {100.0 * errors_of.max() / length:.1f} %; {PUBLISHED}"
        yield Line(where, f"mean error, {len(errors_of)} rows of other motions", reached, "%", Goal(3.2), note=worst)
        later = sn.studies.calibrate(robot, rows.actuators, rows.measured, groups=groups, fit=[*own.groups, "play"])
        tips = later.predict(val.actuators, in_order=True)[:, :3, 3]
        mean = 100.0 * float(np.linalg.norm(tips - val.measured, axis=1).mean()) / length
        yield Line(where, "the same with play, rows in order", mean, "%", Goal(2.5), note=f"{later.play:.2g} mm")
        inside = 100.0 * float((errors_of <= own.bound()).mean())
        yield Line(where, "rows of these motions within the bound at 95 %", inside, "%", Goal(93.0, at_most=False))
        like = 100.0 * float((errors_of <= own.bound(of="rows")).mean())
        yield Line(where, "the same within the bound of rows at 95 %", like, "%")
        within = within_of_some(own, val, errors_of)
        what = f"the same within the bound of {OF_IT} of them (for_motion)"
        yield Line(where, what, within, "%", Goal(93.0, at_most=False))


CALIBRATED: dict[str, Part] = {name: partial(fitted, name) for name in ("v4", "v6")}


TENDON_ROBOT = "tendon robot of 0.4 m, 20 arcs, 77 loads, against VCref"
RODS = "one rod under gravity and two wrenches, 400 shapes each, against SoroSim"
TENTACLE = "soft tentacle, 22 loads, 4 markers"

ANOTHER = 5.0
"""Percent of the length from which on two shapes are other equilibria, not errors."""

REPEATS = 5


class Case(NamedTuple):
    """A row of the tendon robot: tensions (6,), force (3,), and tips by the name of the model."""

    tensions: Floats
    force: Floats
    tips: dict[str, Floats]


def tendon_robot(_: Plan) -> Iterator[Line]:
    """Distances of tips, and the time of one equilibrium from the straight robot."""
    robot = the_tendon_robot()
    errors, others, seconds, names = [], [], [], []
    for case in cases():
        load = sn.Force(case.force)
        found = robot.equilibrium(tensions=case.tensions, forces=load)
        seconds.append(_alone(found))
        off = {name: 250.0 * float(np.linalg.norm(found.tip[:3, 3] - tip)) for name, tip in case.tips.items()}
        if off["VCref"] > ANOTHER:
            models = ", ".join(f"{name} {value:.2g} %" for name, value in off.items() if name in ("PCC", "PRB", "VC"))
            names.append(
                f"q {case.tensions.tolist()} N, f {case.force.tolist()} N: another equilibrium ({models} away)"
            )
        errors.append(off["VCref"])
        others.append(250.0 * float(np.linalg.norm(case.tips["PCC"] - case.tips["VCref"])))
    note = "PCC there {:.2g} % in the median. {}".format(np.median(others), "; ".join(names))
    yield Line(TENDON_ROBOT, "distance of the tip, median", float(np.median(errors)), "%", Goal(0.1), note=note)
    yield Line(TENDON_ROBOT, "distance of the tip, 95 %", float(np.quantile(errors, 0.95)), "%", Goal(0.5))
    times, what = Times.of(seconds), "one equilibrium, from the straight robot"
    note = "there 18 to 1,900 ms; compiled code alone"
    yield Line(TENDON_ROBOT, what, times.median, "us", Goal(100e-6), times, note=note)


def _alone(found: sn.answer.Equilibrium) -> float:
    """Least seconds of the search for an equilibrium, without laying out tables."""
    return timed(run, found.robot, found._begin, runs=REPEATS, clock=thread_time)[1]


def the_tendon_robot() -> sn.Robot:
    """Two sections with ten disks each."""
    rod = sn.Stiffness(youngs_modulus=54e9, poisson=0.3, radius=0.7e-3)
    tendons = sn.Tendons(angles=[0.5 * math.pi, -math.pi / 6.0, 7.0 * math.pi / 6.0], radius=0.01, straight=True)
    stiffness = sn.Stiffness(rod.bend, rod.twist)
    return sn.Robot.uniform(2, 0.2, tendons=tendons, stiffness=stiffness, arcs=10)


def cases() -> list[Case]:
    """All loads of the data that the reference has an answer for."""
    found: dict[tuple[float, ...], dict[str, Floats]] = {}
    with (DATA / "tendon_robot_models.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["disks_per_segment"] == "10":
                key = tuple(float(row[name]) for name in ("q1", "q2", "q3", "q4", "q5", "q6", "fx", "fy", "fz"))
                tip = np.array([float(row[name]) for name in ("tip_x", "tip_y", "tip_z")])
                found.setdefault(key, {})[row["model"]] = tip
    return [Case(np.array(key[:6]), np.array(key[6:]), tips) for key, tips in found.items() if "VCref" in tips]


def _half(young: float, poisson: float, density: float, radius: float, length: float) -> sn.Segment:
    """Half of a rod, of which a wrench pulls the middle."""
    stiffness = sn.Stiffness(youngs_modulus=young, poisson=poisson, radius=radius)
    return sn.Segment(0.5 * length, stiffness=stiffness, mass=density * math.pi * radius**2)


HALF_RODS = {"springsteel": _half(200e9, 0.33, 7870.0, 0.8e-3, 0.6), "tpu": _half(70e6, 0.4, 1200.0, 5e-3, 0.4)}


def rods(name: str, plan: Plan) -> Iterator[Line]:
    """Distances of the tip with 8 and with 16 arcs."""
    half, asked = HALF_RODS[name], read_rods(name)[: plan.count(400, 40)]
    base = np.eye(4)
    base[:3, :3] = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    for arcs, goal in ((8, 0.2), (16, 0.05)):
        errors, segments = [], [half.changed(arcs=arcs // 2)] * 2
        for shape in asked:
            robot = sn.Robot(segments, gravity=shape[3:, 0], base=base)
            loads = [sn.Force(shape[3:, 1], shape[:3, 1], segment=1), sn.Force(shape[3:, 2], shape[:3, 2])]
            with suppress(sn.InputError):  # no equilibrium
                tip = robot.shape([[0.0, 0.0, half.length[1]]] * 2, loads).tip
                errors.append(100.0 * float(np.linalg.norm(tip[:3, 3] - shape[3:, -1])) / robot.mean_length)
        where, failed = f"{name}, {arcs} arcs", len(asked) - len(errors)
        yield Line(RODS, f"{where}: distance of the tip, median", float(np.median(errors)), "%", Goal(goal))
        yield Line(RODS, f"{where}: distance of the tip, largest", max(errors), "%")
        yield Line(RODS, f"{where}: no equilibrium found", float(failed), "shapes", Goal(0.0, correctness=True))


def read_rods(name: str) -> Floats:
    """Read shapes (m, 6, 17): moments or rotations, then forces or positions; gravity, two wrenches, 14 stations."""
    table = np.nan_to_num(np.genfromtxt(DATA / f"rod_{name}.csv", delimiter=",", skip_header=2))
    return table[:, 1:].reshape(-1, 6, table.shape[1] - 1)


MARKERS = np.array([0.1291, 0.2195, 0.2800, 0.3600])
OFFSETS = np.array([[0.0, 0.025, 0.0], [0.0, -0.021, 0.0], [0.0, 0.020, 0.0], [0.0, 0.0, 0.008]])
"""Arc lengths of the markers, and where they are in the frame of the body there, in m."""

TAPER = ((0.0, 15.41e-3), (0.305, 6.42e-3), (0.36, 4.80e-3))
"""Arc length and radius, in m; linear in between."""

TENDONS_END = 0.305
"""Arc length at which the tendons end, in m: `end_segment_index` of the makers' routing is their first segment."""

SLOPE = 0.0295
"""Of the tendons towards the backbone."""

NOMINAL = np.array([505e3, 1500.0, 0.45])
"""Young's modulus (Pa), density (kg / m^3), Poisson's ratio: as the makers state them, and as they fitted them."""

LOWEST, LARGEST = np.array([10e3, 1000.0, 0.4]), np.array([1e6, 2000.0, 0.5])
"""Within which they are fitted, as the makers did."""


def tentacle(_: Plan) -> Iterator[Line]:
    """Distances of markers with the nominal material, and with three parameters that are fitted."""
    loads, markers = read_tentacle()

    def residual(scale: Floats) -> Floats:
        return (_places(scale * NOMINAL, loads) - markers).ravel() * 1e3

    limits = LOWEST / NOMINAL, LARGEST / NOMINAL
    fit = least_squares(residual, (0.9, 0.8, 0.95), bounds=limits, diff_step=[1e-3], xtol=1e-4)
    note = ", ".join(f"{value:.4g}" for value in NOMINAL * fit.x) + " (Pa, kg / m^3); published 15.8 mm"
    what = "rms of markers, fitted E, density, Poisson's ratio"
    yield Line(TENTACLE, "rms of markers, nominal", _rms(residual(np.ones(3))), "mm", note="published 36.8 mm")
    yield Line(TENTACLE, what, _rms(fit.fun), "mm", Goal(15.8), note=note)


def _rms(residual: Floats) -> float:
    return float(np.sqrt(np.mean(np.sum(residual.reshape(-1, 3) ** 2, axis=1))))


def read_tentacle() -> tuple[Floats, Floats]:
    """Tensions (22, 2) in N and places of markers (22, 4, 3) in m."""
    numbers = np.genfromtxt(DATA / "soft_tentacle.csv", delimiter=",")[1:]
    return numbers[:, 2:4], numbers[:, 4:].reshape(-1, 4, 3)


def _places(material: Floats, tensions: Floats) -> Floats:
    """Places of the markers (m, 4, 3) at these tensions (m, 2)."""
    young, density, poisson = material
    parts = np.linspace(0.0, TENDONS_END, 13)[1:], np.linspace(TENDONS_END, 0.36, 4), MARKERS
    ends = np.unique(np.concatenate(parts).round(6))
    begins = np.concatenate([[0.0], ends[:-1]])
    segments = []
    for begin, end in zip(begins, ends, strict=True):
        middle = 0.5 * (begin + end)
        radius = float(np.interp(middle, *np.array(TAPER).T))
        # A tendon that comes nearer to the backbone: a line in each piece, all with the same tension.
        angles, circle = np.radians([30.0, 150.0]), 11.4e-3 - SLOPE * middle
        lines = sn.Chambers(angles=angles, radius=circle) if middle < TENDONS_END else None
        rod = sn.Stiffness(youngs_modulus=young, poisson=poisson, radius=radius)
        mass = density * math.pi * radius**2
        segments.append(sn.Segment(end - begin, chambers=lines, stiffness=rod, mass=mass))
    base = np.eye(4)
    base[:3, :3] = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]
    robot = sn.Robot(segments, base=base, gravity=(0.0, 0.0, -9.81))
    at = np.searchsorted(ends, MARKERS - 1e-6)
    result = []
    for pair in tensions:
        poses = robot.equilibrium(tensions=np.tile(pair, len(robot.actuators) // 2)).poses[at]
        result.append(poses[:, :3, 3] + np.einsum("mij,mj->mi", poses[:, :3, :3], OFFSETS))
    return np.array(result)


LOADED: dict[str, Part] = {
    "tendon-robot": tendon_robot,
    **{f"rod-{name}": partial(rods, name) for name in HALF_RODS},
    "tentacle": tentacle,
}


SECTION = "inverse kinematics under gravity and payload, sections of 4 arcs"

GRAVITY = np.array([0.0, 0.0, -9.81])

ROD = sn.Stiffness(bend=0.01, twist=0.008)

MASS, CARRIED = 0.05, 0.01
"""Of the body, kg / m; of the payload, kg. It moves the tips of these robots by some 30 % of their length."""

STIFF, STIFF_SECTION = 1e6, 100.0
"""EA of the judge's rod, N: it does not stretch; EI and GJ of what does not bend or twist."""

SHAPES = "shapes under gravity and payload: tapered sections, some stiff or in a plane"
BENT = "shapes under gravity and payload: five sections, bent much to all sides"

MOVED = {SHAPES: 40.0, BENT: math.inf}
"""By how much loads may move the tip of a robot that is drawn, in percent of its length."""

NEAR = 0.5
"""Percent of the length by which the judge's tip may be off."""


def loaded_robot(sections: int) -> sn.Robot:
    """A robot that hangs, stands or lies, as its drive makes it."""
    segment = sn.Segment((0.07, 0.13), max_bend=2.0, radius=0.005, stiffness=ROD, mass=MASS, arcs=4)
    return sn.Robot([segment] * sections, gravity=GRAVITY, payload=sn.Payload(CARRIED))


def solves(sections: int, spheres: int, goal: float, plan: Plan) -> Iterator[Line]:
    """Targets that are known to be reached by a loaded body that is clear; a few answers are computed as a rod."""
    count, judged, random = plan.count(60, 10), plan.count(8, 2), np.random.default_rng(sections + spheres)
    robot, scene = loaded_robot(sections), list(islice(_balls(random), spheres))
    solver, targets = sn.Solver(robot, scene), list(islice(_targets(random, robot, scene), count))
    solver.solve(targets[0])  # kernels are loaded
    answers, seconds = zip(*(timed(solver.solve, target, clock=thread_time) for target in targets), strict=True)
    answered = [(found, target) for found, target in zip(answers, targets, strict=True) if found.solved]
    solved, wrong = len(answered), sum(not found.verify().ok for found, _ in answered)
    errors = [_off(robot, found.q, target) for found, target in answered[:judged]]
    what = f"{sections} sections" + (f" among {spheres} spheres" if spheres else "")
    times = Times.of(seconds)
    told = f"{judged} answers; worst {max(errors):.2g} %"
    agrees = 100.0 * float(np.mean(np.array(errors) <= NEAR))
    yield Line(SECTION, f"{what}: a solve", times.median, "ms", Goal(goal), times, (solved, count))
    yield Line(SECTION, f"{what}: solved", 100.0 * solved / count, "%", Goal(99.9, at_most=False))
    yield Line(SECTION, f"{what}: answers that do not verify", float(wrong), "", Goal(0.0, correctness=True))
    yield Line(SECTION, f"{what}: tip of a Cosserat rod off by, median", float(np.median(errors)), "%")
    yield Line(SECTION, f"{what}: off by at most {NEAR} %", agrees, "% of answers", note=told)


def _balls(random: np.random.Generator) -> Iterator[sn.Sphere]:
    while True:
        place = random.uniform(-0.35, 0.35, 3)
        if np.linalg.norm(place) > 0.1:
            yield sn.Sphere(place, 0.025)


def _targets(random: np.random.Generator, robot: sn.Robot, scene: list[sn.Sphere]) -> Iterator[sn.Target]:
    while True:
        bends = random.uniform(-1.0, 1.0, (len(robot), 2))
        q = np.concatenate([bends, random.uniform(0.08, 0.12, (len(robot), 1))], axis=1)
        try:
            shape = robot.shape(q)
        except sn.InputError:
            continue
        if shape.stable and sn.check(robot, q, scene).ok:
            yield sn.Target(shape.tip[:3, 3])


def _off(robot: sn.Robot, q: Floats, target: sn.Target) -> float:
    """Distance of the judge's tip from the target, in percent of the length."""
    assert target.position is not None
    return 100.0 * float(np.linalg.norm(_rod_tip(robot, q) - target.position)) / robot.mean_length


def _rod_tip(robot: sn.Robot, q: Floats) -> Floats:
    """Tip (3,) of the rods that the robot stands for."""
    rests, loads = np.array([[-y / length, x / length, 0.0] for x, y, length in q]), np.zeros((len(q), 6))
    for load in robot.payload:
        loads[(load.segment or len(q)) - 1, :3] += load.mass * GRAVITY
    rods = [each.stiffness or sn.Stiffness(STIFF_SECTION) for each in robot.segments]
    stiffness = np.minimum([[rod.bend, rod.twist, rod.stretch] for rod in rods], [STIFF, STIFF_SECTION, STIFF])
    weights, reaction = np.array([each.mass * GRAVITY for each in robot.segments]), robot.shape(q).reaction
    guess = -np.concatenate([reaction[3:], reaction[:3]])
    return np.asarray(shoot(q[:, 2], stiffness, rests, weights, loads, robot.base, guess)[-1][:3, 3])


def against_rods(robots: str, arcs: int, goal: float, plan: Plan) -> Iterator[Line]:
    """Shapes of robots that are drawn, see `DRAWN`, and the time that one takes from the body without load."""
    random, made = np.random.default_rng(plan.seed), DRAWN[robots]
    errors: list[float] = []
    moved: list[float] = []
    seconds: list[float] = []
    while len(errors) < plan.count(60, 6):
        robot, q = made(random, arcs)
        shape, length = robot.shape(q), float(q[:, 2].sum())
        far = 100.0 * np.linalg.norm(shape.tip[:3, 3] - robot.tip(q)[:3, 3]) / length
        if shape.stable and far < MOVED[robots]:
            moved.append(float(far))
            errors.append(100.0 * float(np.linalg.norm(_rod_tip(robot, q) - shape.tip[:3, 3])) / length)
            seconds.append(_alone(shape))
    what, times = f"{arcs} arcs a section: tip of a Cosserat rod off by", Times.of(seconds)
    note = f"{len(errors)} that loads move by {np.median(moved):.0f} % in the median, {max(moved):.0f} % at most"
    yield Line(robots, f"{what}, median", float(np.median(errors)), "%", note=note)
    yield Line(robots, f"{what}, worst", max(errors), "%", Goal(goal))
    yield Line(robots, f"{arcs} arcs a section: one equilibrium, compiled code alone", times.median, "us", None, times)


def tapered(random: np.random.Generator, arcs: int) -> tuple[sn.Robot, Floats]:
    """One to five tapered sections, some stiff or in a plane, with two masses; and a drive."""
    count, bend = int(random.integers(1, 6)), ROD.bend
    sections, plane = [], float(random.random() < 0.7)
    for k in range(count):
        bend *= random.uniform(0.6, 1.0)
        rod = sn.Stiffness(bend, None if random.random() < 0.3 else random.uniform(0.6, 0.9) * bend)
        stiff = count > 1 and k == count // 2 and random.random() < 0.3
        own = sn.Segment((0.05, 0.2), max_bend=2.0, stiffness=None if stiff else rod, mass=MASS, arcs=arcs)
        sections.append(own)
    masses = [sn.Payload(CARRIED * random.uniform(0.3, 1.5), segment=k) for k in (count, max(1, count - 1))]
    robot = sn.Robot(sections, gravity=GRAVITY, payload=masses, base=sn.pose((0, 0, 0), direction=(1.0, 0.0, -1.0)))
    return robot, np.column_stack(
        [random.uniform(-1.0, 1.0, (count, 2)) * [1.0, plane], random.uniform(0.07, 0.13, count)]
    )


def much_bent(random: np.random.Generator, arcs: int) -> tuple[sn.Robot, Floats]:
    """Five sections on a base that is turned anyhow, which bend much to all sides; and a drive."""
    base = sn.pose((0, 0, 0), direction=random.normal(size=3))
    return loaded_robot(5).changed(arcs=arcs, base=base), np.column_stack(
        [random.uniform(-1.0, 1.0, (5, 2)), random.uniform(0.08, 0.12, 5)]
    )


DRAWN = {SHAPES: tapered, BENT: much_bent}
"""How robots and their drives are drawn."""


STEPPED = "control steps under gravity and payload, two sections of 8 arcs among 40 spheres"

DT = 0.02
"""Seconds of a control step."""


def control_steps(plan: Plan) -> Iterator[Line]:
    """Loops with twists that turn round, of a body under load and of the same robot without; each from where it is."""
    count, random = plan.count(1000, 100), np.random.default_rng(plan.seed)
    hanging = loaded_robot(2).changed(arcs=8)
    twists = 0.1 * random.normal(size=(count // 10 + 1, 3)).repeat(10, axis=0)
    scene, times = list(islice(_balls(random), 40)), []
    for robot in (hanging, hanging.changed(gravity=None, payload=None)):
        q = np.array([[0.5, 0.2, 0.1], [-0.4, 0.6, 0.1]])
        seconds, steps = stepped(sn.Solver(robot, scene), q, twists[:count], DT)
        times.append((Times.of(seconds), sum(step.proved for step in steps)))
    (loaded, proved), (free, _) = times
    yield Line(STEPPED, "a step: median", loaded.median, "ms", Goal(1e-3), loaded, note=f"{proved} of {count} proved")
    yield Line(STEPPED, "a step: p99", loaded.p99, "ms", Goal(5e-3), loaded)
    yield Line(STEPPED, "a step: worst", loaded.worst, "ms", None, loaded)
    yield Line(STEPPED, "the same without load: median", free.median, "us", None, free)
    yield Line(STEPPED, "a step under load, in steps without", loaded.median / free.median, "", Goal(10.0))


SOLVED: dict[str, Part] = {
    f"load-{sections}-{spheres}": partial(solves, sections, spheres, goal)
    for sections, spheres, goal in ((3, 0, 0.5e-3), (5, 0, 0.5e-3), (5, 40, 1e-3))
} | {
    "load-step": control_steps,
    **{f"arcs-{arcs}": partial(against_rods, SHAPES, arcs, goal) for arcs, goal in ((2, 1.0), (4, 0.3), (8, 0.1))},
    **{f"arcs-bent-{arcs}": partial(against_rods, BENT, arcs, goal) for arcs, goal in ((4, 1.2), (8, 0.3), (16, 0.1))},
}

PARTS: dict[str, Part] = {**CALIBRATED, **LOADED, **SOLVED}
"""What is measured, in order: calibrated robots, then shapes and solves under load."""
