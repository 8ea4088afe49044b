"""A map that is quick to make: two short segments beside a wall of balls."""

from typing import Any

import sinuous as sn

ROBOT = sn.Robot.uniform(2, length=(40, 60), max_bend=1.6, radius=4)
WALL = [sn.Sphere((45, y, 70), radius=18, name=f"ball {y}") for y in (-40, 0, 40)]
SPACING = 20.0


def made(**options: Any) -> sn.studies.Reach:
    return sn.studies.reach(ROBOT, WALL, SPACING, **{"directions": 26, **options})
