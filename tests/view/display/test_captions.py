"""Captions of several solutions differ, and say by what."""

import numpy as np

import sinuous as sn
from sinuous.view.display.results import describe_solutions

ROBOT = sn.Robot.uniform(3, length=(0.8, 1.2), max_bend=2)


def test_lines_differ_also_of_shapes_that_bend_alike() -> None:
    q = np.array([[0.5, 0.2, 1.0], [-0.3, 0.1, 0.9], [0.2, 0.2, 1.1]])
    mirrored = q * [-1.0, -1.0, 1.0]
    longer = np.add(q, (0.0, 0.0, 0.05))
    found = [sn.solve(ROBOT, sn.Target(ROBOT.tip(each)), initial=each) for each in (q, mirrored, longer)]
    lines = describe_solutions(found)
    assert len(set(lines)) == 3
    assert lines[0].startswith("1: bends ")
    assert "by (" in lines[0]
    assert "by (" in lines[1]
    assert lines[2].endswith("length 3.15")
    assert "length" not in describe_solutions(found[:1])[0]
