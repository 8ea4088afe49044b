"""The command calibrate: fit the robot of a file to a table of measurements."""

from dataclasses import replace
from pathlib import Path
from typing import get_args

import typer

from sinuous.base import checks
from sinuous.cli.app import Calibrate
from sinuous.cli.options import SOLVED, check_outputs
from sinuous.files.documents import json_line, read_part, read_values
from sinuous.files.nouns import read_robot
from sinuous.model.robot import Robot
from sinuous.studies.calibration.calibrate import Frame, calibrate
from sinuous.studies.calibration.measurements import read_table
from sinuous.studies.calibration.parameters import with_joint_motors
from sinuous.view.pictures.diagrams import plot_calibration
from sinuous.view.pictures.figures import check_picture


def calibrate_file(asked: Calibrate) -> int:
    """Fit the robot of a file to rows that were measured, and say what came of it; return the exit code.

    Rows of a motion bound the error of the robot that is written.
    """
    read = [asked.file, asked.measured, *([] if asked.motion is None else [str(asked.motion)])]
    check_outputs(read, out=asked.out, plot=asked.plot)
    if asked.plot is not None:
        check_picture("--plot", asked.plot, others=())
    robot = with_joint_motors(_robot_of(Path(asked.file)))
    actuators = [actuator.name for actuator in robot.actuators]
    table = read_table(Path(asked.measured), actuators)
    own = None if asked.motion is None else read_table(asked.motion, actuators)
    names = None if asked.fit is None else [name.strip() for each in asked.fit for name in each.split(",")]
    known = checks.choice("--frame", asked.frame, get_args(Frame))
    with checks.in_file(asked.measured):
        rows = table.actuators, table.measured
        found = calibrate(robot, *rows, fit=names, groups=table.groups, unit=asked.unit, frame=known)
    if own is not None:
        with checks.in_file(asked.motion):
            found = replace(found, robot=found.for_motion(own.actuators, own.measured, unit=asked.unit))
    if asked.out is not None:
        found.save(asked.out)
    if asked.plot is not None:
        plot_calibration(found, asked.plot)
    typer.echo(json_line(found.to_dict()) if asked.json else found.explain())
    if found.robot.uncertainty is not None and own is not None and not asked.json:
        typer.echo(f"bound of the robot, from {asked.motion}: {found.robot.uncertainty.bound:.3g}")
    return SOLVED


def _robot_of(file: Path) -> Robot:
    """The robot of a problem file, or of a file that holds a robot alone."""
    with checks.in_file(file):
        own = read_values(file)
        if isinstance(own, dict) and "robot" in own:
            return read_part("robot", own["robot"], file.parent, lambda values, _: read_robot(values))
        return read_robot(own)
