"""Captions of several solutions differ, and say by what."""

import numpy as np

import sinuous as sn
from sinuous.view.display.results import caption_of, describe_solutions

ROBOT = sn.Robot.uniform(3, length=(0.8, 1.2), max_bend=2)


def test_lines_differ_also_of_shapes_that_bend_alike() -> None:
    q = np.array([[0.5, 0.2, 1.0], [-0.3, 0.1, 0.9], [0.2, 0.2, 1.1]])
    mirrored = q * [-1.0, -1.0, 1.0]
    longer = np.add(q, (0.0, 0.0, 0.05))
    found = [sn.solve(ROBOT, sn.Target(ROBOT.tip(each)), initial=each) for each in (q, mirrored, longer)]
    lines = describe_solutions(found)
    assert len(set(lines)) == 3
    assert caption_of(found) == "3 of 3 solved"
    assert lines[0].startswith("1: bends ")
    assert "by (" in lines[0]
    assert "by (" in lines[1]
    assert lines[2].endswith("length 3.15")
    assert "length" not in describe_solutions(found[:1])[0]


def test_a_motion_that_left_its_path_says_by_how_much() -> None:
    arm = sn.Robot.uniform(3, length=(50, 60), max_bend=0.8, radius=5)
    wall = [sn.Box((0, 0, 160), (20, 300, 14))]
    motion = sn.track(arm, [sn.Target((-40, 0, 160)), sn.Target((40, 0, 160))], wall, deviation=0.5)
    caption = caption_of([motion])
    assert caption.startswith("left path: in step")
    assert f"{motion.largest_deviation[0]:.3g} off the line" in caption
