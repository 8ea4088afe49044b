"""Motions come back from files as they were, and what is no motion is refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn

ROBOT = sn.Robot.uniform(3, (45, 70), max_bend=1.6, radius=4)
BALL = sn.Sphere((0, 100, 100), radius=10, name="ball")
PLACE = np.array([60.0, 0.0, 150.0])
MOVING = sn.Moving(BALL, [0, 1], [(0, 0, 0), (0, 3, 0)])


@pytest.mark.parametrize("scene", [None, BALL, MOVING], ids=["nothing", "ball", "moving"])
def test_motions_are_saved_and_loaded(scene: Any, tmp_path: Path) -> None:
    q = sn.solve(ROBOT, PLACE).q
    near = np.add(q, (0.01, 0.02, 0.3))
    motions = [
        sn.track(ROBOT, [PLACE, np.add(PLACE, (0, 9, 0))], scene, tolerance=sn.Tolerance(0.01)),
        sn.Motion(ROBOT, [q, near], scene),
        sn.plan(ROBOT, q, np.add(PLACE, (0, 9, 0)), scene, duration=2),
        sn.plan(ROBOT, q, near, scene, duration=2),
        sn.track(ROBOT, [PLACE, (0, 0, 900)], scene),
        sn.track(ROBOT, [PLACE, PLACE], sn.Sphere((0, 0, 50), radius=20), start=q),
    ]
    assert {str(motion.status) for motion in motions} == {"solved", "out_of_reach", "start_blocked"}
    for i, motion in enumerate(motions):
        for name in ("motion.yaml", "motion.json"):
            motion.save(tmp_path / name)
            again = sn.load(tmp_path / name, sn.Motion)
            assert again.equals(motion), (i, name)
            assert again.to_dict() == motion.to_dict()


def test_files_of_motions_are_checked(tmp_path: Path) -> None:
    sn.Motion(ROBOT, [[[0, 0.1, 55]] * 3, [[0, 0.2, 55]] * 3]).save(tmp_path / "motion.json")
    text = (tmp_path / "motion.json").read_text(encoding="utf-8")
    for old, new, key in (
        ('"steps": [', '"steps": [[1.0], ', "motion.steps"),
        ('"knots": [', '"knots": [[1.0], ', "motion.knots"),
        ('"remaining": 0', '"remaining": -1', "motion.remaining"),
    ):
        assert old in text
        (tmp_path / "wrong.json").write_text(text.replace(old, new), encoding="utf-8")
        with pytest.raises(sn.InputError, match=r"wrong\.json: motion\.\w+: expected") as caught:
            sn.load(tmp_path / "wrong.json")
        assert caught.value.key == key
    with pytest.raises(sn.InputError, match="file: expected a Robot"):
        sn.load(tmp_path / "motion.json", sn.Robot)
