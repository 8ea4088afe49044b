"""The command calibrate: fit the robot of a file to a table of measurements."""

from dataclasses import replace
from pathlib import Path
from typing import get_args

import typer

from sinuous import checks
from sinuous.calibration.calibrate import Frame, calibrate
from sinuous.calibration.table import read_table
from sinuous.cli.options import SOLVED, check_outputs
from sinuous.files.documents import read_part, read_values
from sinuous.files.nouns import read_robot
from sinuous.files.results import json_line
from sinuous.pictures.charts import plot_calibration
from sinuous.robot.robot import Robot


def calibrate_file(
    file: str,
    measured: str,
    fit: str | None,
    unit: float,
    frame: str,
    motion: Path | None,
    out: Path | None,
    plot: Path | None,
    *,
    json: bool,
) -> int:
    """Fit the robot of `file` to the rows of `measured`, and say what came of it.

    Rows of a `motion` bound the error of the robot that is written.

    Returns
    -------
    int
        0; what is wrong is raised.
    """
    read = [file, measured] if motion is None else [file, measured, str(motion)]
    check_outputs(read, out=out, plot=plot)
    robot = _robot_of(Path(file))
    actuators = [actuator.name for actuator in robot.actuators]
    table = read_table(Path(measured), actuators)
    own = None if motion is None else read_table(motion, actuators)
    names = None if fit is None else [name.strip() for name in fit.split(",")]
    known = checks.choice("--frame", frame, get_args(Frame))
    with checks.in_file(measured):
        rows = table.actuators, table.measured
        found = calibrate(robot, *rows, fit=names, groups=table.groups, unit=unit, frame=known)
    if own is not None:
        with checks.in_file(motion):
            found = replace(found, robot=found.for_motion(own.actuators, own.measured, unit=unit))
    if out is not None:
        found.save(out)
    if plot is not None:
        plot_calibration(found, plot)
    typer.echo(json_line(found.to_dict()) if json else found.explain())
    if found.robot.uncertainty is not None and own is not None and not json:
        typer.echo(f"bound of the robot, from {motion}: {found.robot.uncertainty.bound:.3g}")
    return SOLVED


def _robot_of(file: Path) -> Robot:
    """The robot of a problem file, or of a file that holds a robot alone."""
    with checks.in_file(file):
        own = read_values(file)
        if isinstance(own, dict) and "robot" in own:
            return read_part("robot", own["robot"], file.parent, lambda values, _: read_robot(values))
        return read_robot(own)
