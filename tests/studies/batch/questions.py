"""A batch that is quick to solve: three segments beside a ball, some rows of which are no targets."""

import csv
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import sinuous as sn
from sinuous.base.checks import Floats

ROBOT = sn.Robot.uniform(
    3, length=(45, 70), max_bend=1.5, radius=4, name="arm", tendons=sn.Tendons(3, radius=4), self_collision="allow"
)
BALL = sn.Sphere((0, 60, 120), radius=25, name="ball")
OPTIONS: dict[str, Any] = {"max_starts": 4, "routes": False}
BAD = {3: (np.nan, 0.0, 1.0), 41: (np.inf, 0.0, 100.0)}
"""Rows that are no targets, 0 = first."""


def points(count: int, seed: int = 0) -> Floats:
    drawn = np.random.default_rng(seed).normal((0, 0, 150), 35, (count, 3))
    for row, point in BAD.items():
        if row < count:
            drawn[row] = point
    return drawn


def write_csv(file: Path, rows: Floats, header: str = "x,y,z") -> Path:
    with file.open("w", encoding="utf-8", newline="") as out:
        csv.writer(out).writerows([header.split(","), *rows.tolist()])
    return file


@cache
def loop(count: int) -> tuple[sn.answer.Solutions, list[int]]:
    """What `solve_many` says of the rows that are targets, and their numbers, 0 = first."""
    rows = [row for row in range(count) if row not in BAD]
    return sn.Solver(ROBOT, [BALL], **OPTIONS).solve_many(positions=points(count)[rows], workers=1), rows
