"""Where a solve begins, and where a plan ends: a configuration as numbers, or the result of an earlier solve."""

from pathlib import Path
from typing import Any

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.files.json_syntax import parse_json
from sinuous.files.text import read_text
from sinuous.robot.robot import Robot


def read_start(key: str, value: Any, robot: Robot, folder: Path) -> Floats:
    """Read `start` or `goal`: rows of `bend_x, bend_y, length`, a result, or the name of a file with one result in it.

    Parameters
    ----------
    key : str
        Which of them.
    value : object
        What the problem file says.
    robot : Robot
    folder : Path
        Where relative file names begin.

    Returns
    -------
    ndarray (n, 3)

    Raises
    ------
    InputError
        When it is none of these, or is for another number of segments.
    """
    if isinstance(value, str):
        file = folder / value
        text = read_text(file, key)
        try:
            return _configuration(parse_json(text), robot)
        except InputError as error:
            raise error.in_file(file) from None
    with checks.inside(key):
        return _configuration(value, robot)


def _configuration(value: Any, robot: Robot) -> Floats:
    if not isinstance(value, dict):
        return checks.array("", value, (len(robot), 3))
    if "knots" in value:  # a motion: where it ends
        knots = checks.rows("knots", value["knots"], len(robot), 3)
        if not len(knots):
            raise InputError("knots", "", value["knots"], "at least one configuration")
        last: Floats = knots[-1]
        return last
    if "q" not in value:
        raise InputError("q", "missing", value, "a result of an earlier solve")
    return checks.array("q", value["q"], (len(robot), 3))
