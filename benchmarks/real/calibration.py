"""Calibration of two robots from motion capture, judged on motions that the fit did not see."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from time import perf_counter

import numpy as np

import sinuous as sn
from benchmarks.harness.experiment import Part
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.judges.kinematics import tip_poses
from sinuous.base.checks import Floats
from sinuous.files.documents import parse_yaml
from sinuous.files.nouns import read_robot
from sinuous.studies.calibration.table import Measured, read_table

DATA = Path(__file__).parent.parent / "data"

PUBLISHED = "published for their MuJoCo model: 4.1 % (arXiv 2606.22397)"

FAMILIES = ("pair12", "pair13", "pair23", "seg")
"""Kinds of motion of the rows with which robots are fitted; each is left out in turn."""

OF_IT = 40
"""Rows of a motion, evenly spread over it, that bound the errors of its other rows."""


def robot_of(name: str) -> sn.Robot:
    """A robot as drawn."""
    return read_robot(parse_yaml((DATA / f"{name}.yaml").read_text()))


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
    robot = robot_of(name)
    length, rows = robot.mean_length, rows_of(robot, f"{name}_train")
    groups = rows.groups or ()
    sn.studies.calibrate(robot, rows.actuators[:60], rows.measured[:60])  # kernels are loaded
    began = perf_counter()
    own = sn.studies.calibrate(robot, rows.actuators, rows.measured, groups=groups)
    where = f"{name}, {len(groups)} rows, {own.drawn.mean_length:g} mm"
    yield Line(where, "a fit that chooses its parameters", perf_counter() - began, "s", Goal(5.0), noise=1.0)
    yield Line(where, "mean error of the tip, fitted rows", 100.0 * off(own.robot, rows).mean() / length, "%")
    yield Line(where, "mean error, rows held back by the fit", 100.0 * own.expected.mean / length, "%")
    errors, bounds, likes, some = [], [], [], []
    for family in FAMILIES[: plan.count(len(FAMILIES), 1)]:
        other = np.array([family not in label for label in groups])
        labels = [label for label, kept in zip(groups, other, strict=True) if kept]
        part = sn.studies.calibrate(robot, rows.actuators[other], rows.measured[other], groups=labels)
        held = Measured(rows.actuators[~other], rows.measured[~other], None)
        errors.append(off(part.robot, held))
        bounds.append(errors[-1] <= part.bound())
        likes.append(errors[-1] <= part.bound(of="rows"))
        some.append(within_of_some(part, held, errors[-1]))
    each = ", ".join(f"{f} {100.0 * e.mean() / length:.1f}" for f, e in zip(FAMILIES, errors, strict=False))
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
        inside = 100.0 * float((errors_of <= own.bound()).mean())
        yield Line(where, "rows of these motions within the bound at 95 %", inside, "%", Goal(93.0, at_most=False))
        like = 100.0 * float((errors_of <= own.bound(of="rows")).mean())
        yield Line(where, "the same within the bound of rows at 95 %", like, "%")
        within = within_of_some(own, val, errors_of)
        what = f"the same within the bound of {OF_IT} of them (for_motion)"
        yield Line(where, what, within, "%", Goal(93.0, at_most=False))


PARTS: dict[str, Part] = {name: partial(fitted, name) for name in ("v4", "v6")}
"""One robot is one piece."""
