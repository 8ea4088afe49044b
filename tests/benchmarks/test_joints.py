"""Poses of arms with joints, solved and judged."""

import pytest

from benchmarks import joints
from benchmarks.__main__ import main


def test_all_arms_are_solved_and_judged_right(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["joints", "--count", "5"]) == 0
    text = capsys.readouterr().out
    rows = [[cell.strip() for cell in line.split("|")] for line in text.splitlines() if line.startswith("| ")][2:]
    count = len(joints.FAMILIES)
    assert [row[1] for row in rows[:count]] == [family.name for family in joints.FAMILIES]
    assert all(row[2:5] == ["5", "5", "0"] for row in rows[:count])
    led, goal = rows[-2:]
    assert led[1:5] == ["5", "5", "0", "0.000"]
    assert float(led[5]) < float(goal[5])
